//! Pictures of costs as heat maps.

use octray_math::DVec3;

use super::Image;

/// What one step (a cell, node or look-up), one surface and one triangle weigh in a heat map, in units
/// of a surface's time.
///
/// Measured on one core (AMD Zen 3): a step took about 10 ns, a surface 32 ns (least squares over 54
/// pictures of flakes of balls and drilled plates by ten methods), a triangle 20 ns (meshes by brute
/// force). What every ray costs anyway, 420 ns with its shading, is in no picture.
pub const COST_WEIGHTS: DVec3 = DVec3::new(0.3, 1.0, 0.6);

/// The share of the pixels that the colours tell apart; dearer ones all have the brightest.
const SHARE: f64 = 0.995;

/// A heat map of a picture of costs.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Display values: for [`View::Raw`](octray_scene::View::Raw).
    pub image: Image,
    /// The weighted cost of a sample that has the brightest colour; black is 0, and lightness grows
    /// evenly between them.
    pub top: f64,
}

impl HeatMap {
    /// Of a picture whose channels are those of [`cost_channels`](crate::cost_channels), up to the
    /// weighted cost that 99.5 % of the pixels do not exceed.
    #[must_use]
    pub fn of_costs(costs: &Image) -> Self {
        let sums = |pixel: &[f32; 3]| COST_WEIGHTS.dot(DVec3::from_array(pixel.map(f64::from)));
        let sums: Vec<f64> = costs.pixels().iter().map(sums).collect();
        let mut sorted = sums.clone();
        let last = (libm::ceil(SHARE * sorted.len() as f64) as usize).clamp(1, sorted.len()) - 1;
        let (_, top, _) = sorted.select_nth_unstable_by(last, f64::total_cmp);
        let top = *top;
        let shade = |sum: &f64| {
            // Where hardly anything cost anything, 0 is the end of the scale too.
            let heat = if *sum > 0.0 { sum / top } else { 0.0 };
            heat_color(heat.min(1.0)).to_array().map(|c| c as f32)
        };
        Self {
            image: Image {
                width: costs.width(),
                height: costs.height(),
                pixels: sums.iter().map(shade).collect(),
            },
            top,
        }
    }
}

/// The colour of a heat from 0 to 1 as display values: black, violet, red, orange, white. In Oklab
/// (Ottosson 2020) lightness is proportional to the heat and the hue turns evenly by 170 degrees, with as
/// much chroma as fits everywhere into what displays show.
#[must_use]
pub fn heat_color(heat: f64) -> DVec3 {
    let lightness = 0.97 * heat;
    let chroma = 0.5 * heat * (1.0 - heat) * (1.0 + 0.6 * heat);
    let hue = (290.0 + 170.0 * heat).to_radians();
    let (a, b) = (chroma * libm::cos(hue), chroma * libm::sin(hue));
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548 * b);
    let light = DVec3::new(
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s,
    );
    DVec3::from_array(light.to_array().map(octray_scene::linear_to_srgb))
}

#[cfg(test)]
mod tests {
    use octray_scene::srgb_to_linear;

    use super::*;

    #[test]
    fn hotter_is_lighter_by_even_steps_and_inside_the_gamut() {
        // Lightness as CIE 1976 defines it, independent of how the colours were made.
        let lightness = |heat: f64| {
            let color = heat_color(heat).to_array();
            assert!(
                color.iter().all(|c| (-1e-7..=1.0 + 1e-7).contains(c)),
                "{color:?}"
            );
            let [r, g, b] = color.map(srgb_to_linear);
            let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            if y > 216.0 / 24389.0 {
                116.0 * libm::cbrt(y) - 16.0
            } else {
                y * 24389.0 / 27.0
            }
        };
        let mut before = lightness(0.0);
        assert!(before.abs() < 1e-9);
        for step in 1..=100 {
            let now = lightness(f64::from(step) / 100.0);
            let gained = now - before;
            // Near black, CIE's lightness is flat.
            let least = if step <= 25 { 0.0 } else { 0.7 };
            assert!(gained > least && gained < 1.4, "{gained} at {step}");
            before = now;
        }
        assert!(before > 90.0);
    }

    #[test]
    fn the_scale_ends_where_the_dearest_half_percent_begin() {
        let costs: Vec<[f32; 3]> = (1..=1000u16).map(|i| [0.0, f32::from(i), 0.0]).collect();
        let map = HeatMap::of_costs(&Image::new(100, 10, costs).expect("a picture"));
        assert_eq!(map.top, 995.0 * COST_WEIGHTS.y);
        let pixels = map.image.pixels();
        let hottest = heat_color(1.0).to_array().map(|c| c as f32);
        assert!(pixels[994..].iter().all(|p| *p == hottest));
        assert_ne!(pixels[993], hottest);
    }

    #[test]
    fn nothing_costs_nothing() {
        for (pixels, expected) in [(vec![[0.0; 3]; 9], 0.0), (vec![[2.0, 0.0, 0.0]; 9], 1.0)] {
            let map = HeatMap::of_costs(&Image::new(3, 3, pixels).expect("a picture"));
            let color = heat_color(expected).to_array().map(|c| c as f32);
            assert!(map.image.pixels().iter().all(|p| *p == color));
        }
    }
}
