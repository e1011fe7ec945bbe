//! Pictures in linear light, and what becomes of them: display colours, PNG, EXR.

mod develop;
mod exr;
mod heat;
mod neutral;
mod png;

pub use develop::{develop, develop_color};
pub use exr::encode_exr;
pub use heat::{COST_WEIGHTS, HeatMap, heat_color};
pub use neutral::neutral;
pub use png::encode_png;

use octray_math::DVec3;
use octray_scene::{Encoding, srgb_to_linear};
use thiserror::Error;

use crate::Film;

/// A picture in linear light with the primaries of Rec. 709, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

/// Why a picture could not be made or encoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImageError {
    /// The number of pixels is not width times height, or there is none.
    #[error("{count} pixels do not make a picture of {width} x {height}")]
    WrongCount {
        /// Width asked.
        width: u32,
        /// Height asked.
        height: u32,
        /// Pixels given.
        count: usize,
    },
    /// The encoder refused.
    #[error("the picture could not be encoded as {format}: {reason}")]
    Encoding {
        /// `PNG` or `EXR`.
        format: &'static str,
        /// What the encoder said.
        reason: String,
    },
}

impl Image {
    /// A picture of these pixels, in rows from the top.
    ///
    /// # Errors
    /// [`ImageError::WrongCount`].
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        let wanted = u64::from(width) * u64::from(height);
        if wanted == 0 || wanted != pixels.len() as u64 {
            return Err(ImageError::WrongCount {
                width,
                height,
                count: pixels.len(),
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// The picture on the film of a scene whose colours have this encoding. Pixels without
    /// samples are black.
    #[must_use]
    pub fn from_film(film: &Film, encoding: Encoding) -> Self {
        Self::from_pixels(film, encoding, |x, y| (x, y))
    }

    /// The same, where pixels without samples show the finished pixel that the coarser passes
    /// rendered for their block: the one above and left of them in the grid of every 2nd, 4th or
    /// 8th pixel.
    #[must_use]
    pub fn coarse_from_film(film: &Film, encoding: Encoding) -> Self {
        Self::from_pixels(film, encoding, |x, y| {
            let blocks = [1u32, 2, 4, 8].map(|edge| (x - x % edge, y - y % edge));
            let done = blocks.into_iter().find(|(x, y)| film.is_complete(*x, *y));
            done.unwrap_or((x, y))
        })
    }

    fn from_pixels(
        film: &Film,
        encoding: Encoding,
        source: impl Fn(u32, u32) -> (u32, u32),
    ) -> Self {
        let crop = film.crop();
        let mut pixels = Vec::with_capacity(crop.width as usize * crop.height as usize);
        for y in 0..crop.height {
            for x in 0..crop.width {
                let (sx, sy) = source(x, y);
                let light = scene_to_linear(film.mean(sx, sy), encoding);
                pixels.push(light.to_array().map(|channel| channel as f32));
            }
        }
        Self {
            width: crop.width,
            height: crop.height,
            pixels,
        }
    }

    /// Width in pixels.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, in rows from the top: red, green, blue in linear light.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }
}

/// The light that a value of the scene means.
///
/// Negative values (from negative lamps) keep their sign.
#[must_use]
pub fn scene_to_linear(value: DVec3, encoding: Encoding) -> DVec3 {
    let decode = |v: f64| match encoding {
        Encoding::Linear => v,
        Encoding::Gamma(gamma) => libm::pow(v.abs(), gamma).copysign(v),
        Encoding::Srgb => srgb_to_linear(v),
    };
    DVec3::from_array(value.to_array().map(decode))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_undone() {
        let v = DVec3::new(0.5, 0.25, -0.5);
        assert_eq!(scene_to_linear(v, Encoding::Linear), v);
        let light = scene_to_linear(v, Encoding::Gamma(2.0));
        assert_eq!(light, DVec3::new(0.25, 0.0625, -0.25));
        let light = scene_to_linear(v, Encoding::Srgb);
        assert!((light.x - 0.214_041_140_482_232_55).abs() < 1e-12);
        assert_eq!(light.z, -light.x);
    }

    #[test]
    fn a_picture_has_as_many_pixels_as_it_says() {
        assert!(Image::new(2, 2, vec![[0.0; 3]; 4]).is_ok());
        assert!(Image::new(2, 2, vec![[0.0; 3]; 3]).is_err());
        assert!(Image::new(0, 2, Vec::new()).is_err());
    }
}
