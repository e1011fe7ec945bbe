//! A vessel full of detail in the middle of a bowl of steps a thousand times its size.

use std::f64::consts::TAU;

use octray::math::{DMat3, DVec3};

use super::{Soup, Subject};

pub(super) fn make() -> Subject {
    let mut soup = Soup::default();
    // The body: flutes and beads, so that every square differs.
    let rows = 400;
    let profile: Vec<[f64; 2]> = (0..rows)
        .map(|i| {
            let s = f64::from(i) / f64::from(rows - 1);
            let belly = 0.15 + 0.55 * (std::f64::consts::PI * (0.1 + 0.82 * s)).sin();
            [belly, s]
        })
        .collect();
    soup.lathe(DVec3::ZERO, &profile, 250, |angle, z| {
        1.0 + 0.02 * (24.0 * angle + 9.0 * z).sin()
            + 0.012 * (90.0 * z).sin() * (40.0 * angle).cos()
    });
    tube(&mut soup, (160, 70), 0.09, |s| {
        DVec3::new(0.45 + 0.6 * s, 0.0, 0.3 + 0.5 * s * s)
    });
    tube(&mut soup, (220, 60), 0.06, |s| {
        let angle = TAU * (0.22 + 0.56 * s);
        DVec3::new(-0.55 + 0.35 * angle.cos(), 0.0, 0.5 + 0.3 * angle.sin())
    });
    // The bowl: a step is two rings, a riser and a tread, 10,000 squares in all.
    let steps = 50;
    let rings: Vec<[f64; 2]> = (0..steps)
        .flat_map(|k| {
            let (out, up) = (f64::from(k) * 14.0, f64::from(k) * 8.0);
            [[700.0 + out, up - 20.0], [714.0 + out, up - 20.0]]
        })
        .collect();
    soup.lathe(DVec3::ZERO, &rings, 100, |_, _| 1.0);
    soup.block(
        DVec3::new(-700.0, -700.0, -21.0),
        DVec3::new(700.0, 700.0, -20.0),
    );
    soup.block(DVec3::new(-2.0, -2.0, -20.0), DVec3::new(2.0, 2.0, -0.01));
    let (positions, triangles) = soup.finish(&DMat3::IDENTITY);
    Subject {
        name: "stadium",
        positions,
        triangles,
        eye: DVec3::new(-0.5, -2.5, 1.3),
        target: DVec3::new(0.1, 0.0, 0.5),
        up: DVec3::Z,
        angle: 42.0,
        light: DVec3::new(120.0, -340.0, 480.0),
    }
}

/// A pipe along a curve over `[0, 1]`.
fn tube(
    soup: &mut Soup,
    (rows, sectors): (usize, usize),
    radius: f64,
    curve: impl Fn(f64) -> DVec3,
) {
    soup.lattice((rows, sectors), true, |i, j| {
        let s = i as f64 / (rows - 1) as f64;
        let along = (curve(s + 1e-4) - curve(s - 1e-4)).normalize();
        let side = along.cross(DVec3::Y).normalize();
        let angle = TAU * j as f64 / sectors as f64;
        curve(s) + (side * angle.cos() + DVec3::Y * angle.sin()) * radius
    });
}
