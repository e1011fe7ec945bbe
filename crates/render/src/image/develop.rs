//! Light to display values.

use std::sync::LazyLock;

use octray_math::DVec3;
use octray_scene::{View, linear_to_srgb, srgb_to_linear};

use super::{Image, neutral};

/// Red, green and blue bytes, in rows from the top.
///
/// A channel is clipped to `[0, 1]`, multiplied by 255 and rounded to the nearest integer,
/// halves upwards; NaN becomes 0.
#[must_use]
pub fn develop(image: &Image, view: View) -> Vec<u8> {
    image
        .pixels()
        .iter()
        .flat_map(|pixel| {
            let light = DVec3::from_array(pixel.map(f64::from));
            match view {
                View::Raw => light.to_array().map(to_byte),
                View::Standard => light.to_array().map(srgb_byte),
                View::Neutral => neutral(light.max(DVec3::ZERO)).to_array().map(srgb_byte),
            }
        })
        .collect()
}

/// One colour in linear light to display values, not clipped.
#[must_use]
pub fn develop_color(light: DVec3, view: View) -> DVec3 {
    let encoded = |light: DVec3| DVec3::from_array(light.to_array().map(linear_to_srgb));
    match view {
        View::Raw => light,
        View::Standard => encoded(light),
        View::Neutral => encoded(neutral(light.max(DVec3::ZERO))),
    }
}

fn to_byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// `to_byte(linear_to_srgb(light))`, without a power for each channel of each pixel.
fn srgb_byte(light: f64) -> u8 {
    // NaN has reached no step.
    SRGB_STEPS.partition_point(|step| *step <= light) as u8
}

/// The least light that has byte `b + 1`, for each `b`.
static SRGB_STEPS: LazyLock<[f64; 255]> = LazyLock::new(|| {
    std::array::from_fn(|below| {
        let reaches = |light| usize::from(to_byte(linear_to_srgb(light))) > below;
        let about = srgb_to_linear((below as f64 + 0.5) / 255.0);
        // The inverse is right to a few rounding errors; the step is found by halving what they leave.
        let (mut under, mut over) = (about * (1.0 - 1e-12), about * (1.0 + 1e-12));
        loop {
            let middle = under + 0.5 * (over - under);
            if middle <= under || middle >= over {
                return over;
            }
            if reaches(middle) {
                over = middle;
            } else {
                under = middle;
            }
        }
    })
});

#[cfg(test)]
mod tests {
    use octray_scene::Encoding;

    use super::super::scene_to_linear;
    use super::*;

    fn developed(rgb: [f64; 3], view: View) -> Vec<u8> {
        let image = Image::new(1, 1, vec![rgb.map(|c| c as f32)]).expect("one pixel");
        develop(&image, view)
    }

    #[test]
    fn bytes_are_rounded_and_clipped() {
        let rgb = [0.5, 1.7, -0.3];
        assert_eq!(developed(rgb, View::Raw), [128, 255, 0]);
        // 0.5 encoded is 0.735357: 187.5 rounds up to 188.
        assert_eq!(developed(rgb, View::Standard), [188, 255, 0]);
        assert_eq!(developed([f64::NAN; 3], View::Standard), [0, 0, 0]);
        assert_eq!(developed([f64::INFINITY; 3], View::Raw), [255, 255, 255]);
    }

    #[test]
    fn the_steps_are_where_the_curve_changes_its_byte() {
        for (below, step) in SRGB_STEPS.iter().enumerate() {
            assert_eq!(usize::from(to_byte(linear_to_srgb(*step))), below + 1);
            assert_eq!(
                usize::from(to_byte(linear_to_srgb(step.next_down()))),
                below
            );
        }
        for i in 0..=100_000 {
            let light = f64::from(i) / 90_000.0;
            assert_eq!(srgb_byte(light), to_byte(linear_to_srgb(light)), "{light}");
        }
        for light in [-1.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(srgb_byte(light), to_byte(linear_to_srgb(light)), "{light}");
        }
    }

    #[test]
    fn srgb_scenes_come_out_as_their_values_in_the_standard_view() {
        for byte in 0..=255u8 {
            let value = DVec3::splat(f64::from(byte) / 255.0);
            let light = scene_to_linear(value, Encoding::Srgb);
            assert_eq!(developed(light.to_array(), View::Standard), [byte; 3]);
        }
    }

    #[test]
    fn neutral_is_the_tone_mapper_and_then_the_curve() {
        let light = DVec3::new(3.0, 0.4, 0.2);
        let expected = neutral(light).to_array().map(linear_to_srgb);
        assert_eq!(develop_color(light, View::Neutral).to_array(), expected);
    }
}
