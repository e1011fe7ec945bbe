//! Crossings lie on the surface, and the sides between them are those of the implicit function.

use super::{implicit, implicit_value};
use crate::surface::{Canonical, Surface};
use octray_math::DAffine3;
use octray_math::{DVec3, Ray};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    (range.clone(), range.clone(), range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn local(canonical: Canonical) -> Surface {
    Surface::Curved {
        canonical,
        local_from_scene: DAffine3::IDENTITY,
    }
}

fn torus_surface(minor: f64) -> Surface {
    local(Canonical::Torus { minor })
}

/// Whether the line starts negative, and where it changes sides.
fn crossings(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
    let mut t = Vec::new();
    let negative = surface.crossings(ray, |s| t.push(s));
    (negative, t)
}

#[test]
fn sphere_chord_has_its_analytic_length() {
    let surface = Surface::Curved {
        canonical: Canonical::Sphere,
        local_from_scene: DAffine3::from_scale(DVec3::splat(0.5)),
    };
    for distance in [0.0, 1.0, 1.9, 1.999_999] {
        let ray = Ray::new(DVec3::new(-1e6, distance, 0.0), DVec3::X * 4.0);
        let (_, t) = crossings(&surface, &ray);
        let chord = (t[1] - t[0]) * 4.0;
        let exact = 2.0 * (4.0 - distance * distance).sqrt();
        assert!((chord - exact).abs() < 1e-9, "{chord} {exact}");
    }
}

#[test]
fn lines_through_a_torus_in_special_position() {
    let ring = torus_surface(0.25);
    let along = |o: DVec3, d: DVec3| crossings(&ring, &Ray::new(o, d)).1.len();
    // The axis misses; a diameter meets the tube twice; the plane z = r only touches.
    assert_eq!(along(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), 0);
    assert_eq!(along(DVec3::new(-5.0, 0.0, 0.0), DVec3::X), 4);
    assert_eq!(along(DVec3::new(-5.0, 0.0, 0.25), DVec3::X), 0);
    // Tangent to the inner equator: the double root there is no crossing, the outer two are.
    let (_, tangent) = crossings(&ring, &Ray::new(DVec3::new(-5.0, 0.75, 0.0), DVec3::X));
    let expected = 2.0 * (1.0_f64 * 0.25).sqrt();
    assert!(tangent.len() >= 2);
    assert!((tangent[tangent.len() - 1] - 5.0 - expected).abs() < 1e-12);
}

proptest! {
    #[test]
    fn roots_of_a_torus_lie_on_it(
        minor in prop_oneof![1e-3..1.0f64, 1.0..3.0f64],
        angle in 0.0..TAU, tube in 0.0..TAU, d in vector(-1.0..1.0), far in 0.0..1e3f64,
    ) {
        prop_assume!(d.length() > 1e-2);
        // Aim at a point inside the tube, so that the line must cross.
        let (s, c) = libm::sincos(angle);
        let rho = 1.0 + 0.9 * minor * libm::cos(tube);
        let target = DVec3::new(rho * c, rho * s, 0.9 * minor * libm::sin(tube));
        let ray = Ray::new(target - d * far, d);
        let (starts_negative, changes) = crossings(&torus_surface(minor), &ray);
        prop_assert!(changes.len() >= 2 && changes.len().is_multiple_of(2));
        prop_assert!(!starts_negative);
        let mut inside = false;
        for (i, &t) in changes.iter().enumerate() {
            let p = ray.at(t);
            let from_ring = (p.x * p.x + p.y * p.y).sqrt() - 1.0;
            let error = (from_ring * from_ring + p.z * p.z).sqrt() - minor;
            prop_assert!(error.abs() < 1e-12 * (1.0 + far), "{}", error);
            prop_assert!(i == 0 || changes[i - 1] < t);
            inside ^= t < far;
        }
        prop_assert!(inside, "the target is inside");
    }

    #[test]
    fn sides_between_crossings_are_those_of_the_implicit_function(
        surface in prop_oneof![
            Just(Canonical::Sphere).prop_map(local),
            Just(Canonical::Cylinder).prop_map(local),
            prop_oneof![Just(-1.0), -1.0..-1e-3, Just(-1e-9), Just(-f64::EPSILON)].prop_map(
                |slope| local(Canonical::Cone { slope }),
            ),
        ],
        o in vector(-3.0..3.0), d in vector(-1.0..1.0),
    ) {
        prop_assume!(d.length() > 1e-3);
        let ray = Ray::new(o, d);
        let (starts_negative, changes) = crossings(&surface, &ray);
        for i in -40..=40 {
            let t = f64::from(i) * 0.25;
            let p = ray.at(t);
            let value = implicit_value(&surface, p);
            let passed = changes.iter().filter(|&&c| c < t).count();
            let negative = starts_negative ^ (passed % 2 == 1);
            prop_assert!(value.abs() < 1e-9 || negative == (value < 0.0));
        }
    }

    #[test]
    fn sides_of_formulas_are_those_of_their_functions(
        canonical in implicit(), o in vector(-2.0..2.0), d in vector(-1.0..1.0),
        special in 0..6_usize, samples in proptest::collection::vec(-4.0..4.0f64, 60),
    ) {
        // Also lines along axes and in coordinate planes.
        let (o, d) = match special {
            0 => (o, DVec3::AXES[usize::from(o.x > 0.0)]),
            1 => (o.with_z(0.0), d.with_z(0.0)),
            2 => (DVec3::ZERO, d),
            _ => (o, d),
        };
        prop_assume!(d.length() > 1e-3);
        let d = d.normalize();
        let ray = Ray::new(o, d);
        let surface = local(canonical.clone());
        let (starts_negative, changes) = crossings(&surface, &ray);
        for t in samples {
            let p = ray.at(t);
            let value = implicit_value(&surface, p);
            let doubt = match &canonical {
                Canonical::Polynomial(polynomial) => 1e-13 * polynomial.majorant_value(p.abs() + 1.0),
                // Steep where it is pinched.
                Canonical::Superellipsoid { .. } if p.abs().min_element() < 1e-9 => 1e-2,
                _ => 1e-9,
            };
            let passed = changes.iter().filter(|&&c| c < t).count();
            let negative = starts_negative ^ (passed % 2 == 1);
            prop_assert!(value.abs() < doubt || negative == (value < 0.0), "{} {:?}", t, changes);
        }
    }
}
