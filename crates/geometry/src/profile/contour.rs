//! Closed curves as the boundary of one surface.

use octray_math::bernstein::change_of_sign;
use octray_math::{DVec2, roots};

use super::curve::Curve;
use crate::surface::Side;

/// Rounding allowance relative to the coordinates.
const SLACK: f64 = 1e-12;
/// Halvings of a curve when it is compared with a box.
const BOX_HALVINGS: u32 = 6;
/// Halvings of a curve when its point nearest to another is looked for, before the root finder.
const NEAREST_HALVINGS: u32 = 10;

/// One or more closed curves in the plane; inside is what an odd number of them goes round.
///
/// Where a curve ends another begins, with the same bits: whatever is evaluated at a shared end
/// has the same sign for both, so every line is crossed an even number of times.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    curves: Vec<Curve>,
    bounds: [DVec2; 2],
    /// Where the inside is of all curves, if on the same side of all.
    inside_is_left: Option<bool>,
}

impl Contour {
    /// Of curves each of whose ends another one shares; see the type.
    pub(crate) fn new(curves: Vec<Curve>, inside_is_left: Option<bool>) -> Self {
        let mut bounds = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        for curve in &curves {
            let [low, high] = curve.bounds();
            bounds = [bounds[0].min(low), bounds[1].max(high)];
        }
        Self {
            curves,
            bounds,
            inside_is_left,
        }
    }

    /// The curves.
    #[must_use]
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Lowest and highest corner of a box around it.
    #[must_use]
    pub const fn bounds(&self) -> [DVec2; 2] {
        self.bounds
    }

    /// Whether a point is inside; on the boundary, either.
    #[must_use]
    pub fn contains(&self, p: DVec2) -> bool {
        // The crossings of the ray to the right.
        let mut inside = false;
        for curve in &self.curves {
            let [low, high] = curve.bounds();
            if low.y > p.y || high.y <= p.y || high.x < p.x {
                continue;
            }
            let height = curve.combined(0.0, 1.0, -p.y);
            changes(
                &height,
                |u| height.evaluate(u),
                |u| {
                    inside ^= curve.at(u).x > p.x;
                },
            );
        }
        inside
    }

    /// The side of all points of a box.
    pub(crate) fn classify(&self, low: DVec2, high: DVec2) -> Side {
        let [least, most] = self.bounds;
        let size = least.abs().max(most.abs()).max(low.abs()).max(high.abs());
        let slack = DVec2::splat(SLACK * size.max_element());
        let around = [low - slack, high + slack];
        if apart([least, most], around) {
            return Side::Positive;
        }
        let mut curves = self.curves.iter();
        if curves.any(|curve| meets(curve, around, BOX_HALVINGS)) {
            Side::Both
        } else if self.contains((low + high) * 0.5) {
            Side::Negative
        } else {
            Side::Positive
        }
    }

    /// A vector out of the inside, normal to the curve that passes nearest to `p`.
    pub(crate) fn normal(&self, p: DVec2) -> DVec2 {
        let mut best = (f64::INFINITY, DVec2::X);
        for curve in &self.curves {
            if distance_to_box(curve.bounds(), p) < best.0 {
                let (distance, direction) = nearest(curve, p);
                if distance < best.0 {
                    best = (distance, direction);
                }
            }
        }
        let normal = -best.1.perp().normalize_or(DVec2::X);
        if let Some(left) = self.inside_is_left {
            return if left { normal } else { -normal };
        }
        let step = normal * ((self.bounds[1] - self.bounds[0]).max_element() * 1e-7);
        if self.contains(p + step) && !self.contains(p - step) {
            -normal
        } else {
            normal
        }
    }
}

/// Visits where `f` changes between positive and not positive along `[0, 1]`; `separator` has a
/// root wherever `f` does.
pub(crate) fn changes(
    separator: &octray_math::bernstein::Bernstein,
    mut f: impl FnMut(f64) -> f64,
    mut visit: impl FnMut(f64),
) {
    let (at_0, at_1) = (f(0.0), f(1.0));
    let (mut u0, mut f0) = (0.0, at_0);
    let mut piece = |u1: f64, f: &mut dyn FnMut(f64) -> f64| {
        let f1 = f(u1);
        if (f0 > 0.0) != (f1 > 0.0) {
            visit(change_of_sign(&mut *f, u0, u1, f0, f1));
        }
        (u0, f0) = (u1, f1);
    };
    let separator = separator.with_signs(at_0 > 0.0, at_1 > 0.0);
    separator.separate(&mut |u| piece(u, &mut f));
    piece(1.0, &mut f);
}

fn apart(a: [DVec2; 2], b: [DVec2; 2]) -> bool {
    a[0].cmpgt(b[1]).any() || b[0].cmpgt(a[1]).any()
}

/// Whether a curve may have a point in a box.
fn meets(curve: &Curve, around: [DVec2; 2], halvings: u32) -> bool {
    let own = curve.bounds();
    if apart(own, around) {
        return false;
    }
    let within = own[0].cmpge(around[0]).all() && own[1].cmple(around[1]).all();
    if halvings == 0 || within {
        return true;
    }
    let halves = curve.halves();
    halves.iter().any(|half| meets(half, around, halvings - 1))
}

fn distance_to_box(around: [DVec2; 2], p: DVec2) -> f64 {
    p.distance(p.clamp(around[0], around[1]))
}

/// The distance of a curve from a point, and its direction there.
fn nearest(curve: &Curve, p: DVec2) -> (f64, DVec2) {
    let mut best = (f64::INFINITY, 0.0);
    let mut stack = vec![(*curve, 0.0, 1.0, NEAREST_HALVINGS)];
    while let Some((part, low, high, halvings)) = stack.pop() {
        if distance_to_box(part.bounds(), p) >= best.0 {
            continue;
        }
        let middle = 0.5 * (low + high);
        for u in [low, middle, high] {
            let distance = curve.at(u).distance(p);
            if distance < best.0 {
                best = (distance, u);
            }
        }
        if halvings > 0 {
            let [left, right] = part.halves();
            stack.push((left, low, middle, halvings - 1));
            stack.push((right, middle, high, halvings - 1));
        }
    }
    let width = libm::ldexp(1.0, -(NEAREST_HALVINGS as i32));
    let (low, high) = ((best.1 - width).max(0.0), (best.1 + width).min(1.0));
    let along = |u: f64| (curve.at(u) - p).dot(curve.direction(u));
    let (before, after) = (along(low), along(high));
    let u = if before < 0.0 && after > 0.0 {
        roots::bracketed(along, low, high, before, after)
    } else {
        best.1
    };
    let mut direction = curve.direction(u);
    if direction == DVec2::ZERO {
        direction = curve.end() - curve.start();
    }
    (curve.at(u).distance(p), direction)
}
