//! The databases' pictures as POV-Ray makes them from their own generators' output.

mod corpus;
mod spd;

use corpus::corpus;
use octray_render::{Image, RenderConfig, develop};
use spd::rendered;

/// Mean absolute difference of the channels, as a share of the whole range.
fn difference(name: &str) -> Option<f64> {
    let folder = corpus("spd")?;
    let reference = image::open(folder.join(name).with_extension("png")).expect("a picture");
    let reference = reference.to_rgb8();
    let config = RenderConfig {
        size: Some(reference.dimensions()),
        ..RenderConfig::default()
    };
    let (rendering, view) = rendered(&folder.join(name), &config);
    let bytes = develop(&Image::from_film(&rendering.film, rendering.encoding), view);
    assert_eq!(bytes.len(), reference.as_raw().len());
    let pairs = bytes.iter().zip(reference.as_raw());
    let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    Some(sum as f64 / bytes.len() as f64 / 255.0)
}

/// The limits are not far above what is measured: a change of the shading shows.
#[test]
fn pictures_agree_with_pov_ray() {
    for (name, most) in [
        ("balls_s2.nff", 0.0005),
        ("balls.nff", 0.001),
        // POV-Ray's glass triangles each have an inside of their own, ours share one.
        ("gears_s2.nff", 0.01),
        // Two where the highlight's amount is not in the file.
        ("mount_s2.nff", 0.002),
        ("rings_s2.nff", 0.01),
        ("teapot_s2.nff", 0.01),
        ("teapot.nff", 0.001),
        ("tetra_s2.nff", 0.0005),
        ("tree_s2.nff", 0.0005),
    ] {
        let Some(difference) = difference(name) else {
            return;
        };
        assert!(difference < most, "{name}: {:.3} %", 100.0 * difference);
    }
}
