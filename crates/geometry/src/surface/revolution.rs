//! A contour in the half-plane of distance from the z axis and height, turned about the axis.

use octray_math::bernstein::{Bernstein, change_of_sign};
use octray_math::{DVec2, DVec3};

use super::Side;
use super::found::Found;
use super::local_box::LocalBox;
use crate::profile::{Contour, Curve, changes};

/// Rounding allowance of bounds that skip a curve.
const SLACK: f64 = 1e-12;

/// In the half-plane of distance `r` and height `z` a line is a branch of a hyperbola. Which side
/// of it a point of the contour lies on is decided once per shared end, so that closed curves
/// change sides an even number of times. Steep lines reach every height once; on flat ones the two
/// arms, before and after the point nearest to the axis, are taken one by one.
pub(super) fn crossings(
    contour: &Contour,
    o: DVec3,
    d: DVec3,
    visit: &mut impl FnMut(f64),
) -> bool {
    let mut found = Found::new();
    let across = d.truncate().length();
    let shift = if d.z.abs() >= across {
        let shift = -o.dot(d) / d.length_squared();
        let line = Steep {
            p: o + d * shift,
            d,
        };
        contour
            .curves()
            .iter()
            .for_each(|c| line.cross(c, shift, &mut found));
        shift
    } else {
        let shift = -o.truncate().dot(d.truncate()) / (across * across);
        let p = o + d * shift;
        let line = Flat {
            height: p.z,
            rise: d.z,
            across,
            nearest: p.truncate().length(),
        };
        contour
            .curves()
            .iter()
            .for_each(|c| line.cross(c, shift, &mut found));
        shift
    };
    if shift.is_finite() {
        found.visit_sorted(visit);
    }
    false
}

/// A line that rises at least as much as it goes sideways.
struct Steep {
    p: DVec3,
    d: DVec3,
}

impl Steep {
    /// Times the rise, the place across the axis at a height.
    fn across(&self, z: f64) -> DVec2 {
        self.p.truncate() * self.d.z + self.d.truncate() * (z - self.p.z)
    }

    fn cross(&self, curve: &Curve, shift: f64, found: &mut Found) {
        let Self { p, d } = *self;
        let [low, high] = curve.bounds();
        let (a, b) = (self.across(low.y), self.across(high.y));
        let rise = d.z.abs();
        // The distance is convex in the height.
        let most = a.length().max(b.length());
        let along = (b - a).dot(-a) / (b - a).length_squared();
        let nearest = a
            + (b - a)
                * if along.is_finite() {
                    along.clamp(0.0, 1.0)
                } else {
                    0.0
                };
        let slack = SLACK * (most + rise * high.x);
        if rise * high.x < nearest.length() - slack || rise * low.x > most + slack {
            return;
        }
        let radius = curve.combined(1.0, 0.0, 0.0).scaled(rise);
        // p.x d.z + (z - p.z) d.x, and the same for y.
        let x = curve.combined(0.0, d.x, p.x * d.z - p.z * d.x);
        let y = curve.combined(0.0, d.y, p.y * d.z - p.z * d.y);
        let separator = radius
            .times(&radius)
            .minus(&x.times(&x))
            .minus(&y.times(&y));
        changes(
            &separator,
            |u| {
                let at = curve.at(u);
                at.x * rise - self.across(at.y).length()
            },
            |u| found.push(shift + (curve.at(u).y - p.z) / d.z),
        );
    }
}

/// A line that rises less than it goes sideways, from the point nearest to the axis.
struct Flat {
    height: f64,
    rise: f64,
    /// Length of the direction without the rise.
    across: f64,
    /// Distance of the nearest point from the axis.
    nearest: f64,
}

/// A point of a curve as a flat line sees it.
#[derive(Clone, Copy)]
struct Sight {
    u: f64,
    /// Farther from the axis than the line's nearest point.
    is_far: bool,
    /// Height above the arm before the nearest point, and above the one after it.
    above: [f64; 2],
}

impl Sight {
    /// Between the two arms.
    const fn is_between(&self) -> bool {
        (self.above[0] > 0.0) != (self.above[1] > 0.0)
    }
}

impl Flat {
    /// How far along, in both directions, the line is at this distance from the axis.
    fn half_chord(&self, r: f64) -> f64 {
        if r > self.nearest {
            ((r - self.nearest) * (r + self.nearest)).sqrt()
        } else {
            0.0
        }
    }

    fn above(&self, p: DVec2) -> [f64; 2] {
        let level = self.across * (p.y - self.height);
        let tilt = self.rise * self.half_chord(p.x);
        [level + tilt, level - tilt]
    }

    fn cross(&self, curve: &Curve, shift: f64, found: &mut Found) {
        let [low, high] = curve.bounds();
        if high.x <= self.nearest {
            return;
        }
        let tilt = self.rise.abs() * self.half_chord(high.x);
        let (below, above) = (low.y - self.height, high.y - self.height);
        let slack = SLACK * (tilt + self.across * (below.abs() + above.abs()));
        if self.across * below - tilt > slack || self.across * above + tilt < -slack {
            return;
        }
        // rise^2 (r^2 - nearest^2) - across^2 (z - height)^2.
        let far = curve.combined(1.0, 0.0, self.nearest);
        let beyond = curve.combined(1.0, 0.0, -self.nearest);
        let level = curve.combined(0.0, 1.0, -self.height).scaled(self.across);
        let arms = far
            .times(&beyond)
            .scaled(self.rise * self.rise)
            .minus(&level.times(&level));
        let (start, end) = (self.sight(curve, 0.0), self.sight(curve, 1.0));
        // As the ends are seen, so must the separators have them.
        let beyond = beyond.with_signs(start.is_far, end.is_far);
        let is_above = |p: DVec2| self.across * (p.y - self.height) > 0.0;
        let level = level.with_signs(is_above(curve.start()), is_above(curve.end()));
        let arms = arms.with_signs(start.is_between(), end.is_between());
        let mut last = start;
        let mut piece = |u: f64| {
            let next = self.sight(curve, u);
            self.between(curve, last, next, shift, found);
            last = next;
        };
        merged(&[beyond, level, arms], &mut piece);
        piece(1.0);
    }

    fn sight(&self, curve: &Curve, u: f64) -> Sight {
        let p = curve.at(u);
        Sight {
            u,
            is_far: p.x > self.nearest,
            above: self.above(p),
        }
    }

    /// The crossings of a piece with each arm at most once.
    fn between(&self, curve: &Curve, from: Sight, to: Sight, shift: f64, found: &mut Found) {
        let (mut from, mut to) = (from, to);
        if !from.is_far && !to.is_far {
            return;
        }
        if from.is_far != to.is_far {
            // Only what is far is met; where it begins both arms are one point.
            let distance = |u: f64| curve.at(u).x - self.nearest;
            let u = change_of_sign(distance, from.u, to.u, distance(from.u), distance(to.u));
            let level = self.across * (curve.at(u).y - self.height);
            let edge = Sight {
                u,
                is_far: true,
                above: [level; 2],
            };
            if from.is_far {
                to = edge;
            } else {
                from = edge;
            }
        }
        for (arm, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let (f0, f1) = (from.above[arm], to.above[arm]);
            if (f0 > 0.0) != (f1 > 0.0) {
                let height = |u: f64| self.above(curve.at(u))[arm];
                let u = change_of_sign(height, from.u, to.u, f0, f1);
                found.push(shift + self.parameter(curve, curve.at(u), sign));
            }
        }
    }

    /// From the nearest point: by the distance from the axis or by the height, whichever carries
    /// the smaller rounding error.
    fn parameter(&self, curve: &Curve, p: DVec2, sign: f64) -> f64 {
        let chord = self.half_chord(p.x);
        let by_chord = p.x * p.x / (chord * self.across);
        // A height is as exact as the largest one it was mixed from.
        let [low, high] = curve.bounds();
        let size = low.y.abs().max(high.y.abs());
        let by_height = (size + self.height.abs()) / self.rise.abs();
        if by_height < by_chord {
            let t = (p.y - self.height) / self.rise;
            // On its own arm.
            if t * sign > 0.0 { t } else { 0.0 }
        } else {
            sign * chord / self.across
        }
    }
}

/// Visits, increasing, the separators of all polynomials.
fn merged(polynomials: &[Bernstein], visit: &mut impl FnMut(f64)) {
    let mut knots = [0.0; 64];
    let mut count = 0;
    let mut spilled = Vec::new();
    for polynomial in polynomials {
        polynomial.separate(&mut |u| {
            if count < knots.len() {
                knots[count] = u;
                count += 1;
            } else {
                spilled.push(u);
            }
        });
    }
    if spilled.is_empty() {
        knots[..count].sort_unstable_by(f64::total_cmp);
        knots[..count].iter().for_each(|&u| visit(u));
    } else {
        spilled.extend(&knots[..count]);
        spilled.sort_unstable_by(f64::total_cmp);
        spilled.iter().for_each(|&u| visit(u));
    }
}

/// Of the distances from the axis and the heights in the box.
pub(super) fn classify(contour: &Contour, local: &LocalBox) -> Side {
    let flat = DVec3::new(1.0, 1.0, 0.0);
    let (near, far) = local.absolute_range();
    let center = (local.center * flat).length();
    let radius = local.quadratic(flat).sqrt();
    let low = (near * flat).length().max(center - radius);
    let high = (far * flat).length().min(center + radius);
    contour.classify(
        DVec2::new(low, local.center.z - local.reach.z),
        DVec2::new(high, local.center.z + local.reach.z),
    )
}

pub(super) fn gradient(contour: &Contour, p: DVec3) -> DVec3 {
    let distance = p.truncate().length();
    let normal = contour.normal(DVec2::new(distance, p.z));
    let outward = if distance > 0.0 {
        p.truncate() / distance
    } else {
        DVec2::X
    };
    (outward * normal.x).extend(normal.y)
}
