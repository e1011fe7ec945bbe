//! Quadrics and superellipsoids: surfaces with a parametrisation, divided where they are curved most.
//!
//! Most are a profile turned along a section: points `(r x, r y, z)` with `(r, z)` on one plane curve
//! and `(x, y)` on another. Seen from the axis, a piece of the section lies between so and so many times its
//! chord; so the profile, stretched by these, turned along the chord holds the piece.

use octray_math::{Aabb, DVec2, DVec3};

use super::ShellPatch;
use super::band::facet;
use super::plane_curve::{Conic, ConicKind, Lame, PlaneCurve};
use super::refine::refined;
use super::swept::Aim;
use crate::surface::QuadricForm;

/// A rectangle of parameters of a surface.
trait Cut: Sized {
    /// Both patches that hold its piece of the surface, and how far from the surface they may be because
    /// of the first and the second parameter.
    fn patches(&self) -> ([ShellPatch; 2], [f64; 2]);
    /// Both halves, along the first or second parameter.
    fn halves(&self, parameter: usize) -> [Self; 2];
}

/// A piece with what is made of it.
struct Made<T> {
    piece: T,
    patches: [ShellPatch; 2],
    errors: [f64; 2],
}

/// The patches of all pieces as far as they overlap `region`, and their error.
fn divided<T: Cut>(pieces: Vec<T>, region: &Aabb, aim: Aim) -> (Vec<ShellPatch>, f64) {
    let made = |piece: T| {
        let (patches, errors) = piece.patches();
        let is_seen = patches.iter().any(|p| p.bounds().overlaps(region));
        is_seen.then_some(Made {
            piece,
            patches,
            errors,
        })
    };
    let error_of = |made: &Made<T>| made.errors[0] + made.errors[1];
    let all = refined(
        pieces.into_iter().filter_map(made),
        error_of,
        aim.error,
        aim.limit / 2,
        |whole| {
            let parameter = usize::from(whole.errors[1] > whole.errors[0]);
            let halves = whole.piece.halves(parameter);
            halves.into_iter().filter_map(made).collect::<Vec<_>>()
        },
    );
    let error = all.iter().map(error_of).fold(0.0, f64::max);
    let patches = all.iter().flat_map(|made| made.patches);
    let seen = patches.filter(|p| p.bounds().overlaps(region));
    (seen.collect(), error)
}

/// A profile turned along a section, and mirrored.
#[derive(Clone, Copy)]
struct Turned<P, S> {
    profile: P,
    section: S,
    signs: DVec3,
}

impl<P: PlaneCurve + Copy, S: PlaneCurve + Copy> Cut for Turned<P, S> {
    fn patches(&self) -> ([ShellPatch; 2], [f64; 2]) {
        let (band, reach) = (self.profile.band(), self.section.reach());
        let chord = self.section.ends();
        let widest = chord[0].length().max(chord[1].length());
        let mut patches = facet(&band, chord, reach);
        for corner in patches
            .iter_mut()
            .flat_map(|p| p.inner.iter_mut().chain(&mut p.outer))
        {
            *corner *= self.signs;
        }
        let across = band.most_x() * widest * (reach[1] - reach[0]);
        (patches, [band.thickness() * widest.max(1.0), across])
    }

    fn halves(&self, parameter: usize) -> [Self; 2] {
        if parameter == 0 {
            let halves = self.profile.halves();
            halves.map(|profile| Self { profile, ..*self })
        } else {
            let halves = self.section.halves();
            halves.map(|section| Self { section, ..*self })
        }
    }
}

/// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) = 1`, the exponents `[e, n]`.
pub(super) fn superellipsoid(
    exponents: [f64; 2],
    region: &Aabb,
    aim: Aim,
) -> (Vec<ShellPatch>, f64) {
    let [section, profile] = exponents.map(|e| Lame::quarter(2.0 / e));
    let octant = |bits: u32| {
        let sign = |axis: u32| if bits >> axis & 1 == 1 { -1.0 } else { 1.0 };
        Turned {
            profile,
            section,
            signs: DVec3::new(sign(0), sign(1), sign(2)),
        }
    };
    divided((0..8).map(octant).collect(), region, aim)
}

/// A plane curve drawn out along an axis.
#[derive(Clone, Copy)]
struct DrawnOut {
    curve: Conic,
    /// Along z, or along y with z as the ordinate.
    along_z: bool,
    span: [f64; 2],
}

impl Cut for DrawnOut {
    fn patches(&self) -> ([ShellPatch; 2], [f64; 2]) {
        let band = self.curve.band();
        let patches = band.swept(|p, end| {
            if self.along_z {
                p.extend(self.span[end])
            } else {
                DVec3::new(p.x, self.span[end], p.y)
            }
        });
        (patches, [band.thickness(), 0.0])
    }

    fn halves(&self, _: usize) -> [Self; 2] {
        self.curve.halves().map(|curve| Self { curve, ..*self })
    }
}

/// `z = x^2 - y^2` over a rectangle of x and y.
#[derive(Clone, Copy)]
struct Saddle {
    low: DVec2,
    high: DVec2,
}

impl Cut for Saddle {
    fn patches(&self) -> ([ShellPatch; 2], [f64; 2]) {
        // The squares lie up to a quarter of the square of the step below their chords. The sum of both
        // chords is plane.
        let step = self.high - self.low;
        let sag = step * step * 0.25;
        let (a, c) = (self.low, self.high);
        let corners = [a, DVec2::new(c.x, a.y), c, DVec2::new(a.x, c.y)];
        let lifted = |by: f64| corners.map(|p| p.extend(p.x * p.x - p.y * p.y + by));
        let (lower, upper) = (lifted(-sag.x), lifted(sag.y));
        let patches = [[0, 1, 2], [0, 2, 3]].map(|t| ShellPatch {
            inner: t.map(|i| lower[i]),
            outer: t.map(|i| upper[i]),
        });
        (patches, sag.to_array())
    }

    fn halves(&self, parameter: usize) -> [Self; 2] {
        let (mut left, mut right) = (*self, *self);
        let middle = 0.5 * (self.low[parameter] + self.high[parameter]);
        left.high[parameter] = middle;
        right.low[parameter] = middle;
        [left, right]
    }
}

/// The quadric's part in a bounded region of its own frame.
pub(super) fn quadric(form: QuadricForm, region: &Aabb, aim: Aim) -> (Vec<ShellPatch>, f64) {
    let region = &region.inflated(1e-9 * region.diagonal());
    let (low, high) = (region.min, region.max);
    let farthest = low.abs().max(high.abs()).truncate().length();
    let height = low.z.abs().max(high.z.abs());
    let conic = |kind, axes, span| Conic { kind, axes, span };
    let (x, y) = (DVec2::X, DVec2::Y);
    let hyperbola = ConicKind::Hyperbola;
    let parabola = ConicKind::Parabola;
    // In the half-plane of the distance from the axis, and the height.
    let profiles = match form {
        QuadricForm::OneSheet => {
            let reach = libm::acosh(farthest.max(1.0));
            let span = [low.z, high.z].map(|z| libm::asinh(z).clamp(-reach, reach));
            vec![conic(hyperbola, [x, y], span)]
        }
        QuadricForm::TwoSheets => {
            let span = [0.0, libm::acosh(height.max(1.0)).min(libm::asinh(farthest))];
            vec![
                conic(hyperbola, [y, x], span),
                conic(hyperbola, [-y, x], span),
            ]
        }
        QuadricForm::DoubleCone => {
            let span = [0.0, height.min(farthest)];
            let line = |along| conic(parabola, [along, DVec2::ZERO], span);
            vec![line(x + y), line(x - y)]
        }
        QuadricForm::EllipticParaboloid => {
            let span = [0.0, high.z.max(0.0).sqrt().min(farthest)];
            vec![conic(parabola, [x, y], span)]
        }
        QuadricForm::HyperbolicParaboloid => {
            let [low, high] = [low.truncate(), high.truncate()];
            return divided(vec![Saddle { low, high }], region, aim);
        }
        QuadricForm::HyperbolicCylinder => {
            let span = [low.y, high.y].map(libm::asinh);
            let sheets = [x, -x].map(|x| DrawnOut {
                curve: conic(hyperbola, [x, y], span),
                along_z: true,
                span: [low.z, high.z],
            });
            return divided(sheets.to_vec(), region, aim);
        }
        QuadricForm::ParabolicCylinder => {
            let sheet = DrawnOut {
                curve: conic(parabola, [x, y], [low.x, high.x]),
                along_z: false,
                span: [low.y, high.y],
            };
            return divided(vec![sheet], region, aim);
        }
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    let sections = [0.0, 1.0, 2.0, 3.0].map(|i| {
        conic(
            ConicKind::Circle,
            [x, y],
            [quarter * i, quarter * (i + 1.0)],
        )
    });
    let turned = |profile: &Conic| {
        let profile = *profile;
        sections.map(|section| Turned {
            profile,
            section,
            signs: DVec3::ONE,
        })
    };
    divided(profiles.iter().flat_map(turned).collect(), region, aim)
}
