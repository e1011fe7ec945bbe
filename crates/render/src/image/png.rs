use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use octray_scene::View;

use super::{Image, ImageError, develop};

/// The developed picture as the bytes of a PNG file, 8 bits per channel.
///
/// The same picture gives the same bytes every time: no time, no host, no settings are written.
///
/// # Errors
/// [`ImageError::Encoding`] where the encoder refuses (a picture of more than 2^31 pixels an edge).
pub fn encode_png(image: &Image, view: View) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(
            &develop(image, view),
            image.width(),
            image.height(),
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| ImageError::Encoding {
            format: "PNG",
            reason: error.to_string(),
        })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_reads_back_as_what_was_developed() {
        let pixels = (0..35u8).map(|i| [f32::from(i) / 34.0, 0.5, 1.0 - f32::from(i) / 34.0]);
        let picture = Image::new(7, 5, pixels.collect()).expect("a picture");
        let bytes = encode_png(&picture, View::Standard).expect("a file");
        assert_eq!(bytes, encode_png(&picture, View::Standard).expect("a file"));
        let read = image::load_from_memory(&bytes).expect("a PNG");
        assert_eq!((read.width(), read.height()), (7, 5));
        assert_eq!(read.to_rgb8().into_raw(), develop(&picture, View::Standard));
    }
}
