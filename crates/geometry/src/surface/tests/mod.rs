//! All surfaces against their implicit functions.

mod aimed;
mod classify;
mod contours;
mod crossings;
mod double_double;
mod tangent;

use std::sync::Arc;

use octray_math::roots::MAX_DEGREE;
use octray_math::{DVec2, DVec3};
use proptest::prelude::*;

use super::{Canonical, QuadricForm, Surface};
use crate::Polynomial;
use crate::polynomial::powers;

/// All kinds of surface of [`QuadricForm`].
const FORMS: [QuadricForm; 7] = [
    QuadricForm::OneSheet,
    QuadricForm::TwoSheets,
    QuadricForm::DoubleCone,
    QuadricForm::EllipticParaboloid,
    QuadricForm::HyperbolicParaboloid,
    QuadricForm::HyperbolicCylinder,
    QuadricForm::ParabolicCylinder,
];

/// Any canonical surface that is neither sphere, cylinder, cone nor torus.
fn implicit() -> impl Strategy<Value = Canonical> {
    let coefficient = prop_oneof![Just(0.0), -1.0..1.0f64, Just(1.0), -1e-3..1e-3f64];
    let degree = prop_oneof![9 => 1..=6usize, 1 => Just(MAX_DEGREE)];
    let polynomial = degree.prop_flat_map(move |degree| {
        let count = powers(degree).count();
        proptest::collection::vec(coefficient.clone(), count).prop_map(move |c| {
            let polynomial = Polynomial::new(degree, &c).expect("valid");
            Canonical::Polynomial(Arc::new(polynomial))
        })
    });
    let exponent = prop_oneof![
        Just(1.0),
        Just(2.0),
        1.0..2.0f64,
        0.05..1.0f64,
        2.0..6.0f64,
        Just(1e-3),
        Just(1e-6),
        Just(20.0),
    ];
    prop_oneof![
        (0..FORMS.len()).prop_map(|i| Canonical::Quadric(FORMS[i])),
        polynomial,
        [exponent.clone(), exponent].prop_map(|exponents| Canonical::Superellipsoid { exponents }),
    ]
}

/// The function whose sign is the side, written down independently of the solvers.
pub(crate) fn implicit_value(surface: &Surface, p: DVec3) -> f64 {
    let (canonical, q) = match surface {
        Surface::Plane { normal, offset } => return normal.dot(p) - offset,
        Surface::Curved {
            canonical,
            local_from_scene,
        } => (canonical, local_from_scene.transform_point3(p)),
    };
    match canonical {
        Canonical::Sphere => q.length_squared() - 1.0,
        Canonical::Cylinder => q.x * q.x + q.y * q.y - 1.0,
        Canonical::Cone { slope } => libm::hypot(q.x, q.y) - (1.0 + slope * q.z).abs(),
        Canonical::Torus { minor } => libm::hypot(libm::hypot(q.x, q.y) - 1.0, q.z) - minor,
        Canonical::Quadric(form) => {
            let [x, y, z] = (q * q).to_array();
            match form {
                QuadricForm::OneSheet => x + y - z - 1.0,
                QuadricForm::TwoSheets => x + y - z + 1.0,
                QuadricForm::DoubleCone => x + y - z,
                QuadricForm::EllipticParaboloid => x + y - q.z,
                QuadricForm::HyperbolicParaboloid => x - y - q.z,
                QuadricForm::HyperbolicCylinder => x - y - 1.0,
                QuadricForm::ParabolicCylinder => x - q.z,
            }
        }
        Canonical::Polynomial(polynomial) => {
            let terms = powers(polynomial.degree()).zip(polynomial.coefficients());
            terms.fold(0.0, |sum, ([i, j, k], c)| {
                sum + c * q.x.powi(i as i32) * q.y.powi(j as i32) * q.z.powi(k as i32)
            })
        }
        Canonical::Superellipsoid { exponents: [e, n] } => {
            // Of first degree, like a distance, so that no power over- or underflows.
            let norm = |p: f64, u: f64, v: f64| {
                let most = u.abs().max(v.abs());
                let power = |x: f64| libm::pow((x / most).abs(), p);
                most * libm::pow(power(u) + power(v), 1.0 / p)
            };
            let round = if q.x == 0.0 && q.y == 0.0 {
                0.0
            } else {
                norm(2.0 / e, q.x, q.y)
            };
            if round == 0.0 && q.z == 0.0 {
                return -1.0;
            }
            norm(2.0 / n, round, q.z) - 1.0
        }
        Canonical::Extrusion(contour) => outside(contour.contains(q.truncate())),
        Canonical::Revolution(contour) => {
            outside(contour.contains(DVec2::new(q.truncate().length(), q.z)))
        }
    }
}

/// Only the sign means something.
fn outside(inside: bool) -> f64 {
    if inside { -1.0 } else { 1.0 }
}
