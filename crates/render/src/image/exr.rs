use std::io::Cursor;

use exr::prelude::{Encoding, Image as ExrImage, LayerAttributes, SpecificChannels, WritableImage};

use super::{Image, ImageError};

/// The picture as the bytes of an OpenEXR file: channels R, G, B, 32-bit float, linear light with
/// the primaries of Rec. 709 (the format's default).
///
/// The same picture gives the same bytes every time: no time, no host, no settings are written.
///
/// # Errors
/// [`ImageError::Encoding`] where the encoder refuses.
pub fn encode_exr(image: &Image) -> Result<Vec<u8>, ImageError> {
    let width = image.width() as usize;
    let pixels = image.pixels();
    let channels = SpecificChannels::rgb(|position: exr::math::Vec2<usize>| {
        let [r, g, b] = pixels[position.y() * width + position.x()];
        (r, g, b)
    });
    let mut bytes = Vec::new();
    let size = (width, image.height() as usize);
    // Lines from the top and ZIP: what every program reads.
    let layer = exr::prelude::Layer::new(
        size,
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    ExrImage::from_layer(layer)
        .write()
        // Compressing in order keeps the file's bytes independent of the threads.
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| ImageError::Encoding {
            format: "EXR",
            reason: error.to_string(),
        })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels, ReadLayers, read};

    use super::*;

    #[test]
    fn an_exr_reads_back_bit_for_bit() {
        let value = |i: u16| {
            [
                f32::from(i) * 0.1,
                1.0 / (f32::from(i) + 1.0),
                -1e6 * f32::from(i),
            ]
        };
        let pixels: Vec<[f32; 3]> = (0..63).map(value).collect();
        let picture = Image::new(9, 7, pixels.clone()).expect("a picture");
        let bytes = encode_exr(&picture).expect("a file");
        assert_eq!(bytes, encode_exr(&picture).expect("a file"));
        let read = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                |size, _| vec![vec![[0.0f32; 3]; size.width()]; size.height()],
                |rows, at, (r, g, b): (f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b],
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(&bytes))
            .expect("an EXR");
        assert_eq!(read.layer_data.channel_data.pixels.concat(), pixels);
        let attributes = &read.layer_data.attributes;
        assert!(attributes.capture_date.is_none() && attributes.software_name.is_none());
    }
}
