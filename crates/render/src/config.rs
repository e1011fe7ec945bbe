//! What is asked of a rendering, and what cannot be.

use octray_scene::Settings;
use thiserror::Error;

use crate::Film;

/// Pictures are at most this many pixels wide or high.
pub const MAX_EDGE: u32 = 1 << 24;
/// A pixel has at most this many samples.
pub const MAX_SPP: u32 = 1 << 16;
/// A ray tree has at most this many generations.
pub const MAX_GENERATIONS: u32 = 1 << 16;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shows {
    /// The light that arrives: [`Whitted`](crate::Whitted)'s recursive ray tracing.
    #[default]
    Light,
    /// What the same rays cost: see [`cost_channels`](crate::cost_channels).
    Cost,
}

/// What is asked of a rendering. What is `None` comes from the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderConfig {
    /// Width and height of the whole picture in pixels; the scene's, else 640 x 480.
    pub size: Option<(u32, u32)>,
    /// Samples per pixel; 1 is the pixel's centre.
    pub spp: u32,
    /// The part of the picture to render.
    pub crop: Option<Crop>,
    /// A branch of the ray tree ends after this many generations; primary rays are generation 1.
    pub max_generations: Option<u32>,
    /// A branch ends when its weight falls below this share; 0 never ends one.
    pub contribution_threshold: Option<f64>,
    /// Chooses among the equally good sets of random numbers.
    pub seed: u64,
    /// Render every 8th pixel first, then every 4th, 2nd, and the rest, so that a coarse picture
    /// exists after 1/64 of the work. The finished picture is the same.
    pub progressive: bool,
    /// What the film may take, in bytes.
    pub memory_limit: u64,
    /// What a pixel shows.
    pub shows: Shows,
}

impl Default for RenderConfig {
    fn default() -> Self {
        Self {
            size: None,
            spp: 1,
            crop: None,
            max_generations: None,
            contribution_threshold: None,
            seed: 0,
            progressive: false,
            memory_limit: 4 << 30,
            shows: Shows::Light,
        }
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Pixels left of it.
    pub x: u32,
    /// Pixels above it.
    pub y: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// Why a picture cannot be rendered.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RenderError {
    /// Neither the scene nor the caller has a camera.
    #[error("the scene has no camera")]
    NoCamera,
    /// The camera is not finite or flat.
    #[error("the camera has a number that is not finite, or axes that lie in one plane")]
    BadCamera,
    /// A picture without pixels, or with an absurd edge.
    #[error("a picture must be 1 to {MAX_EDGE} pixels wide and high, not {width} x {height}")]
    BadSize {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
    },
    /// The film would not fit in the memory allowed for it.
    #[error(
        "a picture of {width} x {height} pixels needs {} MiB for its film; {} MiB are allowed",
        needed.div_ceil(1 << 20),
        limit >> 20
    )]
    TooLarge {
        /// Width of what is to be rendered.
        width: u32,
        /// Height of what is to be rendered.
        height: u32,
        /// Bytes.
        needed: u64,
        /// Bytes.
        limit: u64,
    },
    /// No samples, or absurdly many.
    #[error("samples per pixel must be 1 to {MAX_SPP}, not {0}")]
    BadSpp(u32),
    /// The crop has no pixels or leaves the picture.
    #[error(
        "the crop of {}x{} pixels at ({}, {}) does not lie in the picture of {width} x {height} pixels",
        crop.width, crop.height, crop.x, crop.y
    )]
    BadCrop {
        /// What was asked.
        crop: Crop,
        /// Width of the picture.
        width: u32,
        /// Height of the picture.
        height: u32,
    },
    /// No generation, or absurdly many.
    #[error("the generation limit must be 1 to {MAX_GENERATIONS}, not {0}")]
    BadGenerations(u32),
    /// Not a share.
    #[error("the contribution threshold must be a number of at least 0, not {0}")]
    BadThreshold(f64),
}

/// A [`RenderConfig`] with everything decided and checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Width and height of the whole picture.
    pub size: (u32, u32),
    /// The part of it to render.
    pub crop: Crop,
    /// Samples per pixel.
    pub spp: u32,
    /// Generations of rays, 1 or more.
    pub max_generations: u32,
    /// Branches of less weight end.
    pub contribution_threshold: f64,
    /// Chooses the random numbers.
    pub seed: u64,
    /// Whether to begin with a coarse picture.
    pub progressive: bool,
    /// What a pixel shows.
    pub shows: Shows,
}

impl RenderConfig {
    /// Everything decided and checked, nothing allocated yet.
    ///
    /// # Errors
    /// The first number that is out of its range.
    pub fn plan(&self, settings: &Settings) -> Result<Plan, RenderError> {
        let size = self.size.or(settings.size).unwrap_or((640, 480));
        let (width, height) = size;
        let edge = 1..=MAX_EDGE;
        if !(edge.contains(&width) && edge.contains(&height)) {
            return Err(RenderError::BadSize { width, height });
        }
        let crop = self.crop.unwrap_or(Crop {
            x: 0,
            y: 0,
            width,
            height,
        });
        crop.check(size)?;
        let pixels = u64::from(crop.width) * u64::from(crop.height);
        let needed = pixels.saturating_mul(Film::PIXEL_BYTES);
        // States name a pixel by 32 bits.
        if needed > self.memory_limit || pixels > u64::from(u32::MAX) {
            return Err(RenderError::TooLarge {
                width: crop.width,
                height: crop.height,
                needed,
                limit: self.memory_limit,
            });
        }
        if !(1..=MAX_SPP).contains(&self.spp) {
            return Err(RenderError::BadSpp(self.spp));
        }
        let max_generations = self.max_generations.unwrap_or(settings.max_generations);
        if !(1..=MAX_GENERATIONS).contains(&max_generations) {
            return Err(RenderError::BadGenerations(max_generations));
        }
        let contribution_threshold = self
            .contribution_threshold
            .unwrap_or(settings.contribution_threshold);
        // Written so that NaN fails.
        if !matches!(
            contribution_threshold.partial_cmp(&0.0),
            Some(std::cmp::Ordering::Greater | std::cmp::Ordering::Equal)
        ) {
            return Err(RenderError::BadThreshold(contribution_threshold));
        }
        Ok(Plan {
            size,
            crop,
            spp: self.spp,
            max_generations,
            contribution_threshold,
            seed: self.seed,
            progressive: self.progressive,
            shows: self.shows,
        })
    }
}

impl Crop {
    fn check(self, (width, height): (u32, u32)) -> Result<(), RenderError> {
        let fits = |start: u32, length: u32, whole: u32| {
            length > 0 && u64::from(start) + u64::from(length) <= u64::from(whole)
        };
        if fits(self.x, self.width, width) && fits(self.y, self.height, height) {
            Ok(())
        } else {
            Err(RenderError::BadCrop {
                crop: self,
                width,
                height,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(change: impl FnOnce(&mut RenderConfig)) -> Result<Plan, RenderError> {
        let mut config = RenderConfig::default();
        change(&mut config);
        config.plan(&Settings::default())
    }

    #[test]
    fn what_is_not_said_comes_from_the_scene() {
        let settings = Settings {
            size: Some((320, 200)),
            max_generations: 3,
            ..Settings::default()
        };
        let plan = RenderConfig::default().plan(&settings).expect("a plan");
        assert_eq!((plan.size, plan.max_generations), ((320, 200), 3));
        assert_eq!((plan.crop.width, plan.crop.height), (320, 200));
    }

    #[test]
    fn absurd_requests_are_refused_before_anything_is_allocated() {
        assert!(matches!(
            plan(|c| c.size = Some((1_000_000, 1_000_000))),
            Err(RenderError::TooLarge { .. })
        ));
        assert!(matches!(
            plan(|c| c.size = Some((0, 5))),
            Err(RenderError::BadSize { .. })
        ));
        assert!(matches!(
            plan(|c| c.size = Some((u32::MAX, 1))),
            Err(RenderError::BadSize { .. })
        ));
        assert_eq!(plan(|c| c.spp = 0), Err(RenderError::BadSpp(0)));
        assert_eq!(
            plan(|c| c.max_generations = Some(0)),
            Err(RenderError::BadGenerations(0))
        );
        assert!(plan(|c| c.contribution_threshold = Some(f64::NAN)).is_err());
        assert!(plan(|c| c.contribution_threshold = Some(-1.0)).is_err());
        for crop in [(0, 0, 0, 5), (639, 0, 2, 1), (u32::MAX, 0, u32::MAX, 1)] {
            let (x, y, width, height) = crop;
            let crop = Crop {
                x,
                y,
                width,
                height,
            };
            assert!(matches!(
                plan(|c| c.crop = Some(crop)),
                Err(RenderError::BadCrop { .. })
            ));
        }
    }

    #[test]
    fn a_message_says_what_would_be_needed() {
        let error = plan(|c| c.size = Some((1_000_000, 1_000_000))).expect_err("too large");
        assert_eq!(
            error.to_string(),
            "a picture of 1000000 x 1000000 pixels needs 49591065 MiB for its film; 4096 MiB are allowed"
        );
    }
}
