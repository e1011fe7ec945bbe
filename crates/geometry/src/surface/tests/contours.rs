//! Contours drawn out and turned: sides between crossings, even numbers of them, decided boxes.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec2, DVec3, Ray};
use proptest::prelude::*;

use super::implicit_value;
use crate::profile::{Contour, Curve};
use crate::surface::{Canonical, Side, Surface};

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// Closed curves at `x >= 0`: a cubic with its chord on the axis, a ring of arcs off the axis, and
/// a figure that crosses itself.
fn contour() -> impl Strategy<Value = Arc<Contour>> {
    let bulb = vec![
        Curve::bezier(&[at(0.0, -1.0), at(2.0, -0.7), at(0.2, 0.8), at(0.0, 1.0)]),
        Curve::line(at(0.0, 1.0), at(0.0, -1.0)),
    ];
    let center = at(1.2, 0.1);
    let rim = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|d| center + d * 0.7);
    let ring = (0..4).map(|i| Curve::arc(center, rim[i], rim[(i + 1) % 4]));
    let bow = [at(0.3, -1.0), at(1.5, 1.0), at(1.5, -1.0), at(0.3, 1.0)];
    let bow = vec![
        Curve::line(bow[0], bow[1]),
        Curve::bezier(&[bow[1], at(1.9, 0.0), bow[2]]),
        Curve::line(bow[2], bow[3]),
        Curve::line(bow[3], bow[0]),
    ];
    prop_oneof![Just(bulb), Just(ring.collect::<Vec<_>>()), Just(bow)]
        .prop_map(|curves| Arc::new(Contour::new(curves, None)))
}

fn surface(frame: DAffine3) -> impl Strategy<Value = Surface> {
    (contour(), any::<bool>()).prop_map(move |(contour, turned)| Surface::Curved {
        canonical: if turned {
            Canonical::Revolution(contour)
        } else {
            Canonical::Extrusion(contour)
        },
        local_from_scene: frame,
    })
}

fn vector(range: f64) -> impl Strategy<Value = DVec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// Any direction; often nearly or exactly along the axis or across it.
fn direction() -> impl Strategy<Value = DVec3> {
    let tiny = || {
        prop_oneof![
            Just(0.0),
            (1..18_i32).prop_map(|k| libm::pow(10.0, -f64::from(k)))
        ]
    };
    prop_oneof![
        2 => vector(1.0),
        1 => (vector(1.0), tiny()).prop_map(|(d, s)| DVec3::new(d.x, d.y, d.z * s)),
        1 => (vector(1.0), tiny()).prop_map(|(d, s)| DVec3::new(d.x * s, d.y * s, d.z)),
    ]
}

/// Anywhere; often on the axis or level with an end of a curve.
fn origin() -> impl Strategy<Value = DVec3> {
    let round = |x: f64| libm::round(x * 2.0) / 2.0;
    prop_oneof![
        3 => vector(2.0),
        1 => vector(2.0).prop_map(move |p| DVec3::new(round(p.x), round(p.y), round(p.z))),
        1 => vector(2.0).prop_map(|p| DVec3::new(0.0, 0.0, p.z)),
    ]
}

fn crossings(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
    let mut all = Vec::new();
    let starts_negative = surface.crossings(ray, |t| all.push(t));
    (starts_negative, all)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn sides_between_crossings_are_those_of_the_region(
        surface in surface(DAffine3::IDENTITY), o in origin(), d in direction(), far in 0.0..100.0f64,
    ) {
        prop_assume!(d.length() > 1e-3);
        let ray = Ray::new(o - d * far, d);
        let (starts_negative, changes) = crossings(&surface, &ray);
        prop_assert!(changes.windows(2).all(|w| w[0] < w[1]), "{:?}", changes);
        let along_z = d.x == 0.0 && d.y == 0.0;
        if !(along_z && starts_negative) {
            prop_assert!(changes.len().is_multiple_of(2), "{:?}", changes);
        }
        for i in -30..=30 {
            let t = far + f64::from(i) * 0.1;
            let p = ray.at(t);
            let near = DVec3::splat(1e-6);
            if surface.classify(&Aabb::new(p - near, p + near)) == Side::Both {
                continue;
            }
            let passed = changes.iter().filter(|&&c| c < t).count();
            let negative = starts_negative ^ (passed % 2 == 1);
            prop_assert_eq!(negative, implicit_value(&surface, p) < 0.0, "at {}: {:?}", t, changes);
        }
    }

    #[test]
    fn a_decided_box_has_all_its_points_on_that_side(
        surface in surface(
            DAffine3::from_rotation_x(0.4) * DAffine3::from_scale(DVec3::new(1.0, 0.7, 1.3)),
        ),
        center in vector(2.0), half in vector(1.0), exponent in 0..10,
        inside in proptest::collection::vec(vector(1.0), 16),
    ) {
        let half = half.abs() / f64::from(1 << exponent);
        let side = surface.classify(&Aabb::new(center - half, center + half));
        for s in inside.into_iter().chain(Aabb::new(-DVec3::ONE, DVec3::ONE).corners()) {
            let value = implicit_value(&surface, center + half * s);
            match side {
                Side::Positive => prop_assert!(value > 0.0),
                Side::Negative => prop_assert!(value < 0.0),
                Side::Both => {}
            }
        }
    }

    #[test]
    fn normals_point_out_of_what_is_entered(
        surface in surface(DAffine3::IDENTITY), o in vector(2.0), d in vector(1.0),
    ) {
        prop_assume!(d.length() > 0.1);
        let ray = Ray::new(o, d);
        let (_, changes) = crossings(&surface, &ray);
        for (i, &t) in changes.iter().enumerate() {
            let p = ray.at(t);
            let normal = surface.normal(p);
            prop_assert!((normal.length() - 1.0).abs() < 1e-12);
            // Away from corners, where the nearest curve may be another one.
            let sides = [1e-4, -1e-4].map(|step| implicit_value(&surface, p + normal * step));
            if sides[0] * sides[1] < 0.0 {
                prop_assert!(sides[0] > 0.0, "{} {}", p, normal);
                let cosine = normal.dot(d.normalize());
                prop_assert!(cosine.abs() < 1e-2 || (cosine < 0.0) == (i % 2 == 0));
            }
        }
    }
}
