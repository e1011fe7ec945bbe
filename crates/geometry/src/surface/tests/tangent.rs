//! Lines in special position: tangent, grazing, along axes. A bounded surface is crossed an even
//! number of times, whatever the rounding, and nothing is crossed that is not there.

use std::sync::Arc;

use octray_math::{DAffine3, DVec3, Ray, hash_combine};

use super::aimed::{Random, times, torus_polynomial};
use super::implicit_value;
use crate::Polynomial;
use crate::surface::{Canonical, Surface};

fn placed(canonical: Canonical, local_from_scene: DAffine3) -> Surface {
    Surface::Curved {
        canonical,
        local_from_scene,
    }
}

fn crossings(surface: &Surface, ray: &Ray) -> Vec<f64> {
    let mut t = Vec::new();
    let starts_negative = surface.crossings(ray, |s| t.push(s));
    assert!(!starts_negative, "{surface:?} {ray:?}");
    assert!(t.len().is_multiple_of(2), "{surface:?} {ray:?} {t:?}");
    assert!(t.windows(2).all(|pair| pair[0] < pair[1]), "{t:?}");
    t
}

/// A number a few units in the last place off.
fn nudged(x: f64, random: &mut Random) -> f64 {
    x + libm::trunc(random.range(-4.0, 4.0)) * f64::EPSILON * x.abs().max(0.5)
}

fn nudged_point(p: DVec3, random: &mut Random) -> DVec3 {
    DVec3::from_array(p.to_array().map(|x| nudged(x, random)))
}

fn exponents(random: &mut Random) -> [f64; 2] {
    let mut one = || match random.range(0.0, 5.0) as u32 {
        0 => 1.0,
        1 => 2.0,
        2 => random.power(-6.0, 0.0),
        3 => random.range(1.0, 2.0),
        _ => random.range(2.0, 8.0),
    };
    [one(), one()]
}

/// A point of a bounded surface.
fn bounded_surface(random: &mut Random) -> (Canonical, DVec3) {
    let direction = random.direction();
    match random.range(0.0, 4.0) as u32 {
        0 => (Canonical::Sphere, direction),
        which @ (1 | 2) => {
            let minor = match random.range(0.0, 3.0) as u32 {
                0 => 1.0,
                1 => random.power(-3.0, 0.0),
                _ => random.range(1.0, 3.0),
            };
            let outward = direction.with_z(0.0).normalize_or(DVec3::X);
            let p = outward
                + (outward * direction.x + DVec3::Z * direction.y).normalize_or(DVec3::Z) * minor;
            if which == 1 {
                (Canonical::Torus { minor }, p)
            } else {
                (torus_polynomial(minor), p)
            }
        }
        _ => {
            let canonical = Canonical::Superellipsoid {
                exponents: exponents(random),
            };
            // Often in the planes and on the axes, where creases and cusps are.
            let direction = match random.range(0.0, 4.0) as u32 {
                0 => direction.with_x(0.0),
                1 => direction.with_z(0.0),
                2 => direction.with_x(direction.y),
                _ => direction,
            };
            let surface = placed(canonical.clone(), DAffine3::IDENTITY);
            let reach = implicit_value(&surface, direction) + 1.0;
            (canonical, direction / reach)
        }
    }
}

#[test]
fn grazing_lines_cross_bounded_surfaces_an_even_number_of_times() {
    for case in 0..times(60_000) {
        let mut random = Random::new(hash_combine(7, case));
        let (canonical, p) = bounded_surface(&mut random);
        let gradient = canonical.gradient(p).normalize_or(DVec3::Z);
        let d = match case % 4 {
            // Along an axis, in a coordinate plane, or tangent.
            0 => DVec3::AXES[(case / 4 % 3) as usize],
            1 => random.direction().with_z(0.0),
            _ => {
                let d = random.direction();
                d - gradient * gradient.dot(d)
            }
        };
        let d = nudged_point(d.normalize_or(DVec3::X), &mut random);
        let far = random.power(-3.0, 6.0);
        let ray = Ray::new(nudged_point(p, &mut random) - d * far, d);
        let t = crossings(&placed(canonical.clone(), DAffine3::IDENTITY), &ray);
        // The same line, the other way round and of another length, may differ by rounding only;
        // its count is even too.
        let back = Ray::new(ray.at(2.0 * far), ray.direction * -3.0);
        crossings(&placed(canonical.clone(), DAffine3::IDENTITY), &back);
        if t.is_empty() {
            continue;
        }
        let local = placed(canonical, DAffine3::IDENTITY);
        // What is entered is really there: not outside in the middle, nor a rounding error nearer
        // to the coordinate planes, where a pinched solid may be as thin as that.
        let rounding = 1e-15 * (1.0 + far);
        for pair in t.chunks(2) {
            let middle = ray.at(0.5 * (pair[0] + pair[1])).abs();
            let value = implicit_value(&local, (middle - rounding).max(DVec3::ZERO));
            assert!(
                value < 1e-9 * (1.0 + far),
                "{case} {local:?} {ray:?} {t:?} {value}"
            );
        }
    }
}

#[test]
fn tori_in_special_position() {
    let frames = |k: u64| {
        let mut random = Random::new(k);
        match k % 3 {
            0 => DAffine3::IDENTITY,
            1 => DAffine3::from_scale(DVec3::splat(random.power(-6.0, 6.0))),
            _ => {
                octray_math::transform::rotation_xyz_degrees(random.direction() * 180.0)
                    * DAffine3::from_translation(random.direction() * 10.0)
            }
        }
    };
    for case in 0..times(3_000) {
        let mut random = Random::new(hash_combine(8, case));
        let minor = random.power(-3.0, 0.0) * 0.999;
        let local_from_scene = frames(case);
        let scene_from_local = local_from_scene.inverse();
        let far = random.power(0.0, 6.0);
        for canonical in [Canonical::Torus { minor }, torus_polynomial(minor)] {
            let surface = placed(canonical, local_from_scene);
            let count = |p: DVec3, d: DVec3| -> Vec<f64> {
                let origin = scene_from_local.transform_point3(p - d * far);
                let ray = Ray::new(origin, scene_from_local.transform_vector3(d));
                crossings(&surface, &ray).iter().map(|t| t - far).collect()
            };
            let near = |found: &[f64], expected: &[f64]| {
                let error = 1e-9 + 1e-13 * far / minor;
                // Tangency opens to a pair as wide as the root of the rounding.
                let wide = 4.0 * (1e-15 * (1.0 + far) * 20.0).sqrt() / minor.sqrt() + error;
                found
                    .iter()
                    .all(|t| expected.iter().any(|e| (t - e).abs() < wide))
            };
            assert_eq!(count(DVec3::ZERO, DVec3::Z), [0.0; 0], "the axis");
            assert_eq!(count(DVec3::ZERO, DVec3::X).len(), 4, "a diameter");
            // The plane z = r touches along a circle.
            let (above, r) = (DVec3::new(0.0, 0.0, minor), minor);
            assert!(near(&count(above, DVec3::X), &[-1.0, 1.0]), "{minor} {far}");
            // Tangent to the inner equator: the tangency, and two that must be there.
            let inner = count(DVec3::new(0.0, 1.0 - r, 0.0), DVec3::X);
            let ends = 2.0 * r.sqrt();
            assert!(
                inner.len() >= 2 && near(&inner, &[-ends, 0.0, ends]),
                "{minor} {far} {inner:?}"
            );
            // In a Villarceau plane, through the centre: tangent twice.
            let bitangent = DVec3::new(((1.0 - r) * (1.0 + r)).sqrt(), 0.0, r);
            let at = ((1.0 - r) * (1.0 + r)).sqrt();
            let found = count(DVec3::ZERO, bitangent);
            assert!(near(&found, &[-at, at]), "{minor} {far} {found:?}");
            // In that plane, across its two circles.
            let across = count(DVec3::new(0.0, 1.0, 0.0), bitangent);
            assert!(across.len() >= 2, "{minor} {far} {across:?}");
        }
    }
}

#[test]
fn quartics_with_double_lines_and_points_keep_their_parity() {
    // (x^2 + y^2 + z^2 - 1)^2: touched everywhere, crossed nowhere. And (x^2 + y^2 - 1) (z^2 - 1).
    let square = |[i, j, k]: [usize; 3]| match [i, j, k] {
        [4, 0, 0] | [0, 4, 0] | [0, 0, 4] | [0, 0, 0] => 1.0,
        [2, 2, 0] | [2, 0, 2] | [0, 2, 2] => 2.0,
        [2, 0, 0] | [0, 2, 0] | [0, 0, 2] => -2.0,
        _ => 0.0,
    };
    let product = |[i, j, k]: [usize; 3]| match [i, j, k] {
        [2, 0, 2] | [0, 2, 2] | [0, 0, 0] => 1.0,
        [2, 0, 0] | [0, 2, 0] | [0, 0, 2] => -1.0,
        _ => 0.0,
    };
    let quartic = |of: &dyn Fn([usize; 3]) -> f64| {
        let all: Vec<f64> = crate::polynomial::powers(4).map(of).collect();
        let polynomial = Polynomial::new(4, &all).expect("valid");
        placed(
            Canonical::Polynomial(Arc::new(polynomial)),
            DAffine3::IDENTITY,
        )
    };
    let (square, product) = (quartic(&square), quartic(&product));
    for case in 0..times(5_000) {
        let mut random = Random::new(hash_combine(9, case));
        let p = random.direction() * random.unit();
        let d = random.direction();
        let far = random.power(-3.0, 4.0);
        let ray = Ray::new(p - d * far, d);
        for pair in crossings(&square, &ray).chunks(2) {
            assert!(pair[1] - pair[0] < 1e-6 * (1.0 + far), "{pair:?}");
        }
        // Sign of the product: outside of one and inside of the other.
        let mut t = Vec::new();
        let mut negative = product.crossings(&ray, |s| t.push(s));
        assert!(!negative && t.len() == 4, "{t:?}");
        t.push(t[3] + 1.0);
        for pair in t.windows(2) {
            negative = !negative;
            let middle = implicit_value(&product, ray.at(0.5 * (pair[0] + pair[1])));
            assert!(negative == (middle < 0.0) || middle.abs() < 1e-10 * (1.0 + far));
        }
    }
}
