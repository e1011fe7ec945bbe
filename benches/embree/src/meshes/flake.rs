//! Spheres on spheres, each a third as large: the sphereflake of Haines' Standard Procedural
//! Databases (IEEE CG&A 7(11), 1987), of triangles.

use std::f64::consts::PI;

use octray::math::{DMat3, DVec3};

use super::{Soup, Subject, soup};

const GENERATIONS: u32 = 4;

pub(super) fn make() -> Subject {
    let mut soup = Soup::default();
    let sphere = soup::sphere(2);
    grow(&mut soup, &sphere, DVec3::ZERO, 0.5, DVec3::Z, GENERATIONS);
    // A floor, so that shadows fall on something.
    soup.block(DVec3::new(-6.0, -6.0, -0.6), DVec3::new(6.0, 6.0, -0.5));
    let (positions, triangles) = soup.finish(&DMat3::IDENTITY);
    Subject {
        name: "flake",
        positions,
        triangles,
        eye: DVec3::new(2.1, 1.3, 1.7),
        target: DVec3::new(0.0, 0.0, 0.05),
        up: DVec3::Z,
        angle: 38.0,
        light: DVec3::new(4.0, 3.0, 4.5),
    }
}

/// A sphere, six children around its equator and three above.
fn grow(
    soup: &mut Soup,
    sphere: &soup::Sphere,
    center: DVec3,
    radius: f64,
    pole: DVec3,
    generations: u32,
) {
    soup.sphere(center, radius, sphere);
    if generations == 0 {
        return;
    }
    let (x, y) = pole.any_orthonormal_pair();
    let low = (0..6).map(|k| (f64::from(k) * PI / 3.0, 0.0f64));
    let high = (0..3).map(|k| (PI / 6.0 + f64::from(k) * PI / 1.5, 0.96f64));
    for (around, above) in low.chain(high) {
        let side = x * around.cos() + y * around.sin();
        let direction = side * above.cos() + pole * above.sin();
        let place = center + direction * (radius * 4.0 / 3.0);
        grow(
            soup,
            sphere,
            place,
            radius / 3.0,
            direction,
            generations - 1,
        );
    }
}
