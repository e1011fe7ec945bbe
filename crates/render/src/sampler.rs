//! Where in its pixel a sample lies, and the key that names it.
//!
//! A sample is a pure function of (scene, pixel, sample index): nothing here remembers anything.

use octray_math::{hash_combine, unit_f64};

/// The key of one sample of one pixel of the whole picture; every random number of the sample
/// descends from it.
#[must_use]
pub const fn sample_key(seed: u64, x: u32, y: u32, sample: u32) -> u64 {
    let pixel = (x as u64) | ((y as u64) << 32);
    hash_combine(hash_combine(seed, pixel), sample as u64)
}

/// Where in its pixel the sample lies, both coordinates in `[0, 1)`; `(0, 0)` is the top left.
///
/// A single sample per pixel is the pixel's centre. Otherwise the even and the odd samples are
/// two (0,2)-sequences in base 2 (Sobol' 1967), each with a digital shift of its own per pixel
/// and random digits below: any `2^k` even samples from the start have one in each of `2^k` equal
/// strata of every shape, the same holds for the odd ones, and the two halves are independent.
/// A longer sequence begins with the shorter one.
#[must_use]
pub fn pixel_position(seed: u64, pixel: (u32, u32), sample: u32, samples: u32) -> (f64, f64) {
    if samples <= 1 {
        return (0.5, 0.5);
    }
    let half = u64::from(sample & 1);
    let index = sample >> 1;
    let stream = hash_combine(
        sample_key(seed ^ POSITION_STREAM, pixel.0, pixel.1, 0),
        half,
    );
    let coordinate = |axis: u64, digits: u32| {
        let shift = hash_combine(stream, axis) & 0xffff_ffff_0000_0000;
        let below = hash_combine(hash_combine(stream, axis + 2), u64::from(index)) >> 32;
        unit_f64(((u64::from(digits) << 32) ^ shift) | below)
    };
    (
        coordinate(0, index.reverse_bits()),
        coordinate(1, sobol_second(index)),
    )
}

/// Keeps the positions' random numbers apart from those of the paths.
const POSITION_STREAM: u64 = 0x706f_7369_7469_6f6e;

/// The second dimension of Sobol's sequence: direction numbers of the polynomial `x + 1`.
const fn sobol_second(index: u32) -> u32 {
    let mut digits = 0;
    let mut direction = 1u32 << 31;
    let mut rest = index;
    while rest != 0 {
        if rest & 1 == 1 {
            digits ^= direction;
        }
        direction ^= direction >> 1;
        rest >>= 1;
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_the_centre() {
        assert_eq!(pixel_position(7, (3, 4), 0, 1), (0.5, 0.5));
    }

    #[test]
    fn every_half_is_stratified_in_every_shape_of_cell() {
        for pixel in [(0, 0), (17, 3), (4_000_000, 9)] {
            for half in 0..2 {
                let points: Vec<_> = (0..16)
                    .map(|i| pixel_position(1, pixel, 2 * i + half, 32))
                    .collect();
                for (columns, rows) in [(1, 16), (2, 8), (4, 4), (8, 2), (16, 1)] {
                    let mut seen = std::collections::BTreeSet::new();
                    for (x, y) in &points {
                        assert!((0.0..1.0).contains(x) && (0.0..1.0).contains(y));
                        seen.insert((
                            (x * f64::from(columns)) as u32,
                            (y * f64::from(rows)) as u32,
                        ));
                    }
                    assert_eq!(seen.len(), 16, "{columns} x {rows}");
                }
            }
        }
    }

    #[test]
    fn the_mean_position_over_pixels_is_the_centre() {
        let mut mean = (0.0, 0.0);
        let n = 4096;
        for i in 0..n {
            let (x, y) = pixel_position(0, (i % 64, i / 64), 5, 8);
            mean = (mean.0 + x / f64::from(n), mean.1 + y / f64::from(n));
        }
        assert!(
            (mean.0 - 0.5).abs() < 0.02 && (mean.1 - 0.5).abs() < 0.02,
            "{mean:?}"
        );
    }

    #[test]
    fn more_samples_begin_with_the_fewer_ones() {
        for i in 0..8 {
            assert_eq!(
                pixel_position(3, (5, 6), i, 8),
                pixel_position(3, (5, 6), i, 64)
            );
        }
    }
}
