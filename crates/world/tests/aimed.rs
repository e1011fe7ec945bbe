//! Lines aimed into curved solids of a whole scene, from near and far: none is lost on the way
//! through coordinates, octree and sweep. `OCTRAY_CASES` multiplies the number of lines.

use std::f64::consts::TAU;
use std::sync::Arc;

use octray_geometry::{Polynomial, Solid};
use octray_math::{DVec3, Ray, hash_combine, unit_f64};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Hit, RayQuery, World, WorldConfig};

/// `R`, `r` of the tori: a thin ring, a horn, a spindle.
const TORI: [[f64; 2]; 3] = [[1.0, 1e-3], [1.0, 1.0], [0.5, 1.25]];

/// The coefficients of `(x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2)`.
fn quartic([major, minor]: [f64; 2]) -> Solid {
    let (square, k) = (major * major, (major - minor) * (major + minor));
    let mut all = [0.0; 35];
    for place in [0, 20, 30] {
        all[place] = 1.0;
    }
    for place in [4, 7, 23] {
        all[place] = 2.0;
    }
    for place in [9, 25] {
        all[place] = 2.0 * k - 4.0 * square;
    }
    (all[32], all[34]) = (2.0 * k, k * k);
    let polynomial = Polynomial::new(4, &all).expect("valid");
    Solid::polynomial(polynomial).expect("valid")
}

/// A point inside, from random numbers by their index.
type Inside = fn(&dyn Fn(u64) -> f64) -> DVec3;

/// Solids of about unit size, and a point inside each for a key.
fn solids() -> Vec<(Solid, Inside)> {
    fn in_torus([major, minor]: [f64; 2], u: &dyn Fn(u64) -> f64) -> DVec3 {
        let (s, c) = libm::sincos(TAU * u(0));
        let (ts, tc) = libm::sincos(TAU * u(1));
        let tube = 0.95 * minor * u(2);
        let rho = major + tube * tc;
        DVec3::new(rho * c, rho * s, tube * ts)
    }
    let torus = |i: usize| Solid::torus(TORI[i][0], TORI[i][1]).expect("valid");
    let ellipsoid = [1.0, 4.0, 1e4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    vec![
        (torus(0), |u| in_torus(TORI[0], u)),
        (torus(1), |u| in_torus(TORI[1], u)),
        (torus(2), |u| in_torus(TORI[2], u)),
        (quartic(TORI[0]), |u| in_torus(TORI[0], u)),
        (quartic(TORI[1]), |u| in_torus(TORI[1], u)),
        (Solid::quadric(ellipsoid).expect("valid"), |u| {
            let p = DVec3::new(u(0), u(1), u(2)) * 2.0 - 1.0;
            p / p.length().max(1.0) * 0.99 * DVec3::new(1.0, 0.5, 0.01)
        }),
        (Solid::superellipsoid(0.1, 0.3).expect("valid"), |u| {
            (DVec3::new(u(0), u(1), u(2)) * 2.0 - 1.0) * 0.8
        }),
        (Solid::superellipsoid(2.0, 2.0).expect("valid"), |u| {
            let p = DVec3::new(u(0), u(1), u(2)) * 2.0 - 1.0;
            p * (0.99 / p.abs().element_sum().max(1.0))
        }),
    ]
}

#[test]
fn no_line_loses_a_solid() {
    let factor = std::env::var("OCTRAY_CASES").ok();
    let lines = 3000 * factor.and_then(|f| f.parse().ok()).unwrap_or(1_u64);
    let spacing = DVec3::new(5.0, 1.7, -2.3);
    let all = solids();
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for (index, (solid, _)) in all.iter().enumerate() {
        let placed = solid.translate(spacing * index as f64).expect("finite");
        builder.add_object(Object::solid("part", placed, material));
    }
    let scene = Arc::new(builder.build().expect("valid"));
    let world = World::prepare(scene, &WorldConfig::default()).expect("no meshes");
    let mut hits: Vec<Hit> = Vec::new();
    for (index, (_, inside)) in all.iter().enumerate() {
        for case in 0..lines {
            let key = hash_combine(index as u64, case);
            let unit = |k: u64| unit_f64(hash_combine(key, k));
            let target = spacing * index as f64 + inside(&unit);
            let direction = DVec3::new(unit(10), unit(11), unit(12)) * 2.0 - 1.0;
            let direction = direction.normalize_or(DVec3::X);
            let far = libm::exp10(6.0 * unit(13));
            let ray = Ray::new(target - direction * far, direction);
            hits.clear();
            world.crossings(
                &RayQuery::new(ray),
                true,
                &mut hits,
                &mut Counters::default(),
            );
            assert!(hits.len().is_multiple_of(2), "{index} {case}");
            let last = hits.iter().rev().find(|hit| hit.t < far);
            let region = last.and_then(|hit| hit.to.object()).map(|object| object.0);
            assert_eq!(region, Some(index as u32), "{index} {case} {ray:?} {far}");
        }
    }
}
