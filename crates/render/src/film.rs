//! Where light is added up.
//!
//! Every single contribution is rounded to a multiple of 2^-24 and added as an integer, so the
//! order of adding, and with it the number of threads, does not show in the result.

use octray_math::DVec3;

use crate::Crop;

/// One unit of light in the film's integers: `2^24`.
const SCALE: f64 = 16_777_216.0;

/// The largest single contribution, `2^20`: a pixel can take half a million of them.
pub const MAX_CONTRIBUTION: f64 = 1_048_576.0;

/// Light of one pixel: sums of its even and of its odd samples.
///
/// The halves are kept apart because their difference tells the noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSums {
    halves: [[i64; 3]; 2],
}

impl PixelSums {
    /// Adds one contribution; returns whether it had to be replaced: NaN by 0, what lies beyond
    /// [`MAX_CONTRIBUTION`] by the bound.
    pub fn add(&mut self, odd: bool, light: DVec3) -> bool {
        let mut replaced = false;
        for (sum, channel) in self.halves[usize::from(odd)]
            .iter_mut()
            .zip(light.to_array())
        {
            let bounded = if channel.is_nan() {
                0.0
            } else {
                channel.clamp(-MAX_CONTRIBUTION, MAX_CONTRIBUTION)
            };
            replaced |= bounded != channel;
            // Wrapping, because adding must never fail and must not depend on the order.
            *sum = sum.wrapping_add((bounded * SCALE).round_ties_even() as i64);
        }
        replaced
    }

    /// Adds the sums of another part of the same pixel.
    pub fn merge(&mut self, other: &Self) {
        for (half, theirs) in self.halves.iter_mut().zip(&other.halves) {
            for (sum, add) in half.iter_mut().zip(theirs) {
                *sum = sum.wrapping_add(*add);
            }
        }
    }

    /// Red, green and blue of the even samples, then of the odd ones, in units of 2^-24.
    #[must_use]
    pub const fn channels(&self) -> [i64; 6] {
        let [[a, b, c], [d, e, f]] = self.halves;
        [a, b, c, d, e, f]
    }

    /// What [`PixelSums::channels`] gave.
    #[must_use]
    pub const fn from_channels([a, b, c, d, e, f]: [i64; 6]) -> Self {
        Self {
            halves: [[a, b, c], [d, e, f]],
        }
    }

    /// Mean of `samples` samples, 0 for none.
    #[must_use]
    pub fn mean(&self, samples: u32) -> DVec3 {
        let [even, odd] = self.halves;
        Self::scaled(
            std::array::from_fn(|c| even[c].wrapping_add(odd[c])),
            samples,
        )
    }

    /// Means of the even and of the odd ones of `samples` samples, 0 where there is none.
    #[must_use]
    pub fn half_means(&self, samples: u32) -> [DVec3; 2] {
        [
            Self::scaled(self.halves[0], samples.div_ceil(2)),
            Self::scaled(self.halves[1], samples / 2),
        ]
    }

    fn scaled(sums: [i64; 3], samples: u32) -> DVec3 {
        if samples == 0 {
            return DVec3::ZERO;
        }
        DVec3::from_array(sums.map(|sum| sum as f64)) / (SCALE * f64::from(samples))
    }
}

/// The light of all pixels of the crop, in rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    crop: Crop,
    sums: Vec<PixelSums>,
    samples: Vec<u32>,
    samples_wanted: u32,
}

impl Film {
    /// Bytes per pixel.
    pub const PIXEL_BYTES: u64 = (size_of::<PixelSums>() + size_of::<u32>()) as u64;

    /// A dark film for the pixels of `crop`, complete when each has `samples_wanted` samples.
    ///
    /// The caller has checked that the size is reasonable.
    #[must_use]
    pub fn new(crop: Crop, samples_wanted: u32) -> Self {
        let count = crop.width as usize * crop.height as usize;
        Self {
            crop,
            sums: vec![PixelSums::default(); count],
            samples: vec![0; count],
            samples_wanted,
        }
    }

    /// Which pixels of the picture it holds.
    #[must_use]
    pub const fn crop(&self) -> Crop {
        self.crop
    }

    /// Sets the finished pixel `(x, y)` of the crop.
    pub(crate) fn finish_pixel(&mut self, (x, y): (u32, u32), sums: PixelSums) {
        let index = self.index(x, y);
        self.sums[index] = sums;
        self.samples[index] = self.samples_wanted;
    }

    /// Whether all pixels of a tile have all their samples.
    #[must_use]
    pub fn has(&self, tile: &crate::Tile) -> bool {
        tile.pixels().all(|(x, y)| self.is_complete(x, y))
    }

    /// Mean light of the pixel `(x, y)` of the crop, 0 where nothing has been added.
    #[must_use]
    pub fn mean(&self, x: u32, y: u32) -> DVec3 {
        let index = self.index(x, y);
        self.sums[index].mean(self.samples[index])
    }

    /// Mean light of the even and of the odd samples of the pixel `(x, y)` of the crop.
    #[must_use]
    pub fn half_means(&self, x: u32, y: u32) -> [DVec3; 2] {
        let index = self.index(x, y);
        self.sums[index].half_means(self.samples[index])
    }

    /// Whether the pixel `(x, y)` of the crop has all its samples.
    #[must_use]
    pub fn is_complete(&self, x: u32, y: u32) -> bool {
        self.samples[self.index(x, y)] >= self.samples_wanted
    }

    /// How many pixels have all their samples.
    #[must_use]
    pub fn complete_pixels(&self) -> u64 {
        let complete = self.samples.iter().filter(|n| **n >= self.samples_wanted);
        complete.count() as u64
    }

    const fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.crop.width as usize + x as usize
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_order_of_adding_does_not_matter(
            mut light in prop::collection::vec((any::<bool>(), prop::array::uniform3(-3.0f64..1e5)), 1..40),
            turn in any::<prop::sample::Index>(),
        ) {
            let sum = |all: &[(bool, [f64; 3])]| {
                let mut sums = PixelSums::default();
                for (odd, rgb) in all {
                    sums.add(*odd, DVec3::from_array(*rgb));
                }
                sums
            };
            let there = sum(&light);
            let cut = turn.index(light.len());
            let mut parts = sum(&light[cut..]);
            parts.merge(&sum(&light[..cut]));
            prop_assert_eq!(parts, there);
            light.rotate_left(cut);
            light.reverse();
            prop_assert_eq!(sum(&light), there);
        }

        #[test]
        fn the_mean_is_the_mean(values in prop::collection::vec(0.0f64..100.0, 1..50)) {
            let mut sums = PixelSums::default();
            for (i, v) in values.iter().enumerate() {
                sums.add(i % 2 == 1, DVec3::splat(*v));
            }
            let n = values.len() as u32;
            let mean = values.iter().sum::<f64>() / f64::from(n);
            prop_assert!((sums.mean(n).x - mean).abs() < 1e-7);
            let even = values.iter().step_by(2);
            let even_mean = even.clone().sum::<f64>() / even.len() as f64;
            prop_assert!((sums.half_means(n)[0].y - even_mean).abs() < 1e-7);
        }
    }

    #[test]
    fn absurd_light_is_replaced_and_said() {
        let mut sums = PixelSums::default();
        assert!(!sums.add(false, DVec3::new(0.5, MAX_CONTRIBUTION, 0.0)));
        assert!(sums.add(false, DVec3::new(f64::NAN, 0.0, f64::INFINITY)));
        assert!(sums.add(true, DVec3::new(0.0, f64::NEG_INFINITY, 0.0)));
        assert_eq!(
            sums.mean(1),
            DVec3::new(0.5, 0.0, MAX_CONTRIBUTION),
            "infinite and negative infinite are bounded alike"
        );
    }
}
