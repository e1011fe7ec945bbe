//! Lines aimed at points known to be inside: no surface is ever lost, however far away the line
//! starts and however thin the solid is; and crossings lie on the surface, by an evaluation in twice
//! the precision.
//!
//! `OCTRAY_CASES` multiplies the number of lines.

use std::f64::consts::TAU;
use std::sync::Arc;

use octray_math::{DAffine3, DVec3, Ray, hash_combine, unit_f64};

use super::double_double::Double;
use super::{FORMS, implicit_value};
use crate::Polynomial;
use crate::polynomial::powers;
use crate::surface::{Canonical, QuadricForm, Surface};

/// How many lines a test shoots that shoots `cases` of them by default.
pub(super) fn times(cases: u64) -> u64 {
    let factor = std::env::var("OCTRAY_CASES").ok();
    cases * factor.and_then(|f| f.parse().ok()).unwrap_or(1)
}

/// Random numbers that depend on a number alone.
pub(super) struct Random {
    key: u64,
    drawn: u64,
}

impl Random {
    pub(super) const fn new(key: u64) -> Self {
        Self { key, drawn: 0 }
    }

    pub(super) fn unit(&mut self) -> f64 {
        self.drawn += 1;
        unit_f64(hash_combine(self.key, self.drawn))
    }

    pub(super) fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Between two powers of ten.
    pub(super) fn power(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(self.range(low, high))
    }

    pub(super) fn direction(&mut self) -> DVec3 {
        let z = self.range(-1.0, 1.0);
        let (s, c) = libm::sincos(self.range(0.0, TAU));
        let rho = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(rho * c, rho * s, z)
    }
}

/// The torus of this tube as a polynomial: `(p^2 + 1 - r^2)^2 - 4 (x^2 + y^2)`.
pub(super) fn torus_polynomial(minor: f64) -> Canonical {
    let k = (1.0 - minor) * (1.0 + minor);
    let coefficients: Vec<f64> = powers(4)
        .map(|[i, j, l]| match [i.max(j), i.min(j), l] {
            [4, 0, 0] | [0, 0, 4] => 1.0,
            [2, 2, 0] | [2, 0, 2] => 2.0,
            [2, 0, 0] => 2.0 * k - 4.0,
            [0, 0, 2] => 2.0 * k,
            [0, 0, 0] => k * k,
            _ => 0.0,
        })
        .collect();
    Canonical::Polynomial(Arc::new(Polynomial::new(4, &coefficients).expect("valid")))
}

/// A surface in its own frame, and a point on its negative side at some depth: a part `depth` of
/// its own size away from the surface.
fn surface_and_point(kind: usize, depth: f64, random: &mut Random) -> (Canonical, DVec3) {
    let inward = 1.0 - depth;
    let (s, c) = libm::sincos(random.range(0.0, TAU));
    let around = |rho: f64, z: f64| DVec3::new(rho * c, rho * s, z);
    let z = random.range(-3.0, 3.0);
    match kind {
        0 => (Canonical::Sphere, random.direction() * inward),
        1 => (Canonical::Cylinder, around(inward, z)),
        2 => {
            let slope = -random.power(-12.0, 0.0);
            (
                Canonical::Cone { slope },
                around((1.0 + slope * z).abs() * inward, z),
            )
        }
        3 | 4 => {
            let minor = match random.range(0.0, 4.0) as u32 {
                0 => 1.0,
                1 => random.range(1.0, 3.0),
                _ => random.power(-3.0, 0.0),
            };
            let (ts, tc) = libm::sincos(random.range(0.0, TAU));
            let p = around(1.0 + inward * minor * tc, inward * minor * ts);
            // The lemon of a spindle is outside of its polynomial.
            if kind == 4 && minor < 1.0 {
                (torus_polynomial(minor), p)
            } else {
                (Canonical::Torus { minor }, p)
            }
        }
        5 => {
            let exponent = |random: &mut Random| match random.range(0.0, 4.0) as u32 {
                0 => 1.0,
                1 => random.power(-6.0, 0.0),
                2 => random.range(1.0, 2.0),
                _ => random.range(2.0, 5.0),
            };
            let exponents = [exponent(random), exponent(random)];
            let canonical = Canonical::Superellipsoid { exponents };
            let direction = random.direction();
            let reach = implicit_value(&local(canonical.clone()), direction) + 1.0;
            (canonical, direction * (inward / reach))
        }
        _ => {
            let form = FORMS[kind - 6];
            let [x, y] = [random.range(-2.0, 2.0), random.range(-2.0, 2.0)];
            let point = match form {
                QuadricForm::OneSheet => around((1.0 + z * z).sqrt() * inward, z),
                QuadricForm::TwoSheets => {
                    let z = z + 1.0_f64.copysign(z);
                    around((z * z - 1.0).sqrt() * inward, z)
                }
                QuadricForm::DoubleCone => around(z.abs() * inward, z),
                QuadricForm::EllipticParaboloid => around(z.abs().sqrt() * inward, z.abs()),
                QuadricForm::HyperbolicParaboloid => DVec3::new(x, y, x * x - y * y + depth),
                QuadricForm::HyperbolicCylinder => {
                    DVec3::new((1.0 + y * y).sqrt().copysign(x) * inward, y, z)
                }
                QuadricForm::ParabolicCylinder => DVec3::new(x, y, x * x + depth),
            };
            (Canonical::Quadric(form), point)
        }
    }
}

const KINDS: usize = 6 + FORMS.len();

fn local(canonical: Canonical) -> Surface {
    Surface::Curved {
        canonical,
        local_from_scene: DAffine3::IDENTITY,
    }
}

const fn is_bounded(canonical: &Canonical) -> bool {
    matches!(
        canonical,
        Canonical::Sphere
            | Canonical::Torus { .. }
            | Canonical::Polynomial(_)
            | Canonical::Superellipsoid { .. }
    )
}

fn crossings(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
    let mut t = Vec::new();
    let starts_negative = surface.crossings(ray, |s| t.push(s));
    (starts_negative, t)
}

/// Whether all points within `reach` along the axes are on the negative side.
fn is_clear(surface: &Surface, p: DVec3, reach: f64) -> bool {
    DVec3::AXES.iter().all(|axis| {
        [-reach, reach]
            .iter()
            .all(|&step| implicit_value(surface, p + *axis * step) < 0.0)
    })
}

#[test]
fn aimed_lines_never_miss() {
    for kind in 0..KINDS {
        let (cases, mut aimed) = (times(20_000), 0);
        for case in 0..cases {
            let mut random = Random::new(hash_combine(kind as u64, case));
            let depth = random.power(-4.0, 0.0);
            let (canonical, p) = surface_and_point(kind, depth, &mut random);
            let far = random.power(0.0, 6.0);
            let mut direction = random.direction();
            if case % 3 == 0 {
                // Along the surface, so that the chord is as short as it can be.
                let gradient = canonical.gradient(p).normalize_or_zero();
                direction = (direction - gradient * gradient.dot(direction)).normalize_or(DVec3::X);
            }
            let scale = DVec3::new(
                random.power(-3.0, 3.0),
                random.power(-0.5, 0.5),
                random.power(-0.5, 0.5),
            );
            let turn = random.direction() * 180.0;
            let offset = random.direction() * random.power(-3.0, 3.0);
            let scene_from_local = if case % 4 == 0 {
                DAffine3::IDENTITY
            } else {
                octray_math::transform::rotation_xyz_degrees(turn)
                    * DAffine3::from_translation(offset)
                    * DAffine3::from_scale(
                        scale.with_y(scale.x * scale.y).with_z(scale.x * scale.z),
                    )
            };
            let bounded = is_bounded(&canonical);
            let lost = 1e-13 * (far + 1.0 + scene_from_local.inverse().translation.length());
            let in_place = local(canonical.clone());
            if !is_clear(&in_place, p, 8.0 * lost) {
                continue;
            }
            aimed += 1;
            let surface = Surface::Curved {
                canonical,
                local_from_scene: scene_from_local.inverse(),
            };
            let ray = Ray::new(
                scene_from_local.transform_point3(p - direction * far),
                scene_from_local.transform_vector3(direction),
            );
            let (starts_negative, t) = crossings(&surface, &ray);
            assert!(
                t.windows(2).all(|pair| pair[0] < pair[1]),
                "{kind} {case} {t:?}"
            );
            let passed = t.iter().filter(|t| **t < far).count();
            let context = || format!("{kind} {case} {surface:?} {ray:?} far {far} {t:?}");
            assert!(starts_negative ^ (passed % 2 == 1), "missed: {}", context());
            if bounded {
                assert!(
                    !starts_negative && t.len().is_multiple_of(2),
                    "{}",
                    context()
                );
            }
        }
        assert!(aimed > cases / 2, "{kind}: {aimed} of {cases}");
    }
}

/// The implicit function in twice the precision: exact in all its digits for our purposes.
fn exact_value(canonical: &Canonical, [x, y, z]: [Double; 3]) -> Double {
    let number = Double::new;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    match canonical {
        Canonical::Sphere => xx + yy + zz - number(1.0),
        Canonical::Cylinder => xx + yy - number(1.0),
        Canonical::Cone { slope } => {
            let radius = number(1.0) + number(*slope) * z;
            xx + yy - radius * radius
        }
        Canonical::Torus { minor } => {
            let from_ring = (xx + yy).sqrt() - number(1.0);
            from_ring * from_ring + zz - number(*minor) * number(*minor)
        }
        Canonical::Quadric(form) => match form {
            QuadricForm::OneSheet => xx + yy - zz - number(1.0),
            QuadricForm::TwoSheets => xx + yy - zz + number(1.0),
            QuadricForm::DoubleCone => xx + yy - zz,
            QuadricForm::EllipticParaboloid => xx + yy - z,
            QuadricForm::HyperbolicParaboloid => xx - yy - z,
            QuadricForm::HyperbolicCylinder => xx - yy - number(1.0),
            QuadricForm::ParabolicCylinder => xx - z,
        },
        Canonical::Polynomial(polynomial) => {
            let power = |x: Double, n: usize| (0..n).fold(number(1.0), |product, _| product * x);
            let terms = powers(polynomial.degree()).zip(polynomial.coefficients());
            terms.fold(number(0.0), |sum, ([i, j, k], c)| {
                sum + number(*c) * power(x, i) * power(y, j) * power(z, k)
            })
        }
        Canonical::Superellipsoid { .. } | Canonical::Extrusion(_) | Canonical::Revolution(_) => {
            unreachable!("has no exact oracle")
        }
    }
}

/// How wrong the position of a crossing may be: `f` there, at most this.
fn allowance(canonical: &Canonical, p: DVec3, size: f64) -> f64 {
    let rounding = 8.0 * f64::EPSILON * size;
    let slope = 2.0 * canonical.gradient(p).length();
    // What the terms of the function are made of counts where they cancel.
    let terms = match canonical {
        Canonical::Polynomial(polynomial) => polynomial.majorant_value(p) * 8.0 * f64::EPSILON,
        _ => (p.length_squared() + 1.0) * 4.0 * f64::EPSILON,
    };
    slope * rounding + 64.0 * rounding * rounding + terms
}

#[test]
fn crossings_lie_on_the_surface_in_twice_the_precision() {
    let mut worst = 0.0_f64;
    for kind in (0..KINDS).filter(|&kind| kind != 5) {
        for case in 0..times(5_000) {
            let mut random = Random::new(hash_combine(kind as u64 + 100, case));
            // Half of the lines graze.
            let grazing = if case % 2 == 0 { 1e-15 } else { 1e-3 };
            let depth = random.range(-1.0, 1.0) * grazing;
            let (canonical, p) = surface_and_point(kind, depth, &mut random);
            let gradient = canonical.gradient(p).normalize_or(DVec3::Z);
            let mut direction = random.direction();
            if case % 2 == 0 {
                direction = (direction - gradient * gradient.dot(direction)).normalize_or(DVec3::X);
            }
            let far = random.power(-1.0, 4.0);
            let ray = Ray::new(p - direction * far, direction * random.power(-2.0, 2.0));
            let (_, t) = crossings(&local(canonical.clone()), &ray);
            for &t in &t {
                let position = ray.at(t);
                if position.length() > 1e6 {
                    continue;
                }
                let exact = |axis: usize| {
                    Double::new(ray.origin[axis])
                        + Double::new(ray.direction[axis]) * Double::new(t)
                };
                let f = exact_value(&canonical, [exact(0), exact(1), exact(2)]).value();
                let size = ray.origin.length() + position.length() + 1.0;
                let allowed = allowance(&canonical, position, size);
                worst = worst.max(f.abs() / allowed);
                assert!(
                    f.abs() <= allowed,
                    "{kind} {case} {canonical:?} {ray:?} {t} {f} {allowed}"
                );
            }
        }
    }
    // The allowance is not a mile wide of what happens.
    assert!(worst > 0.01, "{worst}");
}
