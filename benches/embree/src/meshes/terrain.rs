//! A landscape: octaves of smoothed random heights over a square lattice.

use octray::math::{DMat3, DVec3, hash_combine, unit_f64};

use super::{Soup, Subject};

/// Corners along a side: 2 * 724^2 = 1,048,352 triangles.
const SIDE: usize = 725;
const OCTAVES: u64 = 9;

pub(super) fn make() -> Subject {
    let mut soup = Soup::default();
    let at = |k: usize| 2.0 * k as f64 / (SIDE - 1) as f64 - 1.0;
    soup.lattice((SIDE, SIDE), false, |i, j| {
        DVec3::new(at(j), at(i), height(at(j), at(i)))
    });
    let (positions, triangles) = soup.finish(&DMat3::IDENTITY);
    Subject {
        name: "terrain",
        positions,
        triangles,
        eye: DVec3::new(-1.15, -1.2, 0.85),
        target: DVec3::new(0.05, 0.05, 0.0),
        up: DVec3::Z,
        angle: 45.0,
        light: DVec3::new(1.5, -0.8, 1.6),
    }
}

fn height(x: f64, y: f64) -> f64 {
    (0..OCTAVES)
        .map(|octave| {
            let fine = f64::from(2 << octave);
            0.27 * 0.52f64.powi(octave as i32) * smooth(octave, x * fine, y * fine)
        })
        .sum()
}

/// Random values in [-1, 1] at whole numbers, smooth in between.
fn smooth(octave: u64, x: f64, y: f64) -> f64 {
    let corner = |dx: f64, dy: f64| {
        let [i, j] = [x.floor() + dx, y.floor() + dy].map(|k| (k as i64) as u64);
        2.0 * unit_f64(hash_combine(hash_combine(octave, i), j)) - 1.0
    };
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(x - x.floor()), ease(y - y.floor()));
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    mix(
        mix(corner(0.0, 0.0), corner(1.0, 0.0), u),
        mix(corner(0.0, 1.0), corner(1.0, 1.0), u),
        v,
    )
}
