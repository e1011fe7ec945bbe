//! The superellipsoid `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) = 1` (Barr 1981).
//!
//! With `a = 2/e` and `c = 2/n` a point is inside where the width `r = (|x|^a + |y|^a)^(1/a)` is
//! less than the profile's `w(z) = (1 - |z|^c)^(1/c)`. Between two coordinate planes both are
//! functions of one curvature along a line: `r` is convex for `a >= 1` and concave for `a <= 1`,
//! `w` is concave for `c >= 1` and convex for `c <= 1`. Chords and tangents enclose such functions
//! up to the square of the interval's length, and so tell where `r - w` has no root or exactly one.

use octray_math::roots::{SignChangeList, bracketed};
use octray_math::{Aabb, DVec3, Ray};

use super::Side;
use super::local_box::LocalBox;

/// The exponents, as they are used.
#[derive(Clone, Copy, Debug)]
struct Shape {
    /// 2 / e.
    a: f64,
    /// 2 / n.
    c: f64,
}

/// Pieces of the line are divided at most this often: then they are as short as rounding.
const MAX_DEPTH: u32 = 60;

/// And into at most this many: a hundred are many for a line that grazes.
const MAX_SAMPLES: u32 = 2000;

impl Shape {
    const fn new(exponents: [f64; 2]) -> Self {
        Self {
            a: 2.0 / exponents[0],
            c: 2.0 / exponents[1],
        }
    }

    /// `(|x|^a + |y|^a)^(1/a)`.
    fn width(self, x: f64, y: f64) -> f64 {
        norm(self.a, x, y)
    }

    /// `(1 - |z|^c)^(1/c)`, 0 above and below.
    fn profile(self, z: f64) -> f64 {
        let z = z.abs();
        if z >= 1.0 {
            return 0.0;
        }
        let rest = -libm::expm1(self.c * libm::log(z));
        libm::pow(rest, 1.0 / self.c)
    }

    /// Negative inside, positive outside.
    fn difference(self, p: DVec3) -> f64 {
        let r = self.width(p.x, p.y);
        if p.z.abs() >= 1.0 {
            r.max(f64::MIN_POSITIVE)
        } else {
            r - self.profile(p.z)
        }
    }
}

/// `(|x|^p + |y|^p)^(1/p)`.
fn norm(power: f64, x: f64, y: f64) -> f64 {
    let (x, y) = (x.abs(), y.abs());
    let (most, least) = if x > y { (x, y) } else { (y, x) };
    if least == 0.0 {
        return most;
    }
    let sum = libm::log1p(libm::pow(least / most, power));
    most * libm::exp(sum / power)
}

/// A part of the line on which no coordinate changes its sign.
struct Octant {
    shape: Shape,
    /// The line, with all coordinates not negative on this part.
    p: DVec3,
    d: DVec3,
}

/// A function at the two ends of an interval.
#[derive(Clone, Copy, Debug)]
struct Linear([f64; 2]);

/// Both functions at one parameter.
#[derive(Clone, Copy, Debug)]
struct Sample {
    t: f64,
    /// `r - w`, or what it was decided to be.
    difference: f64,
    /// `[r, w]`.
    values: [f64; 2],
    /// Infinite or NaN at some coordinate planes.
    slopes: [f64; 2],
}

impl Octant {
    fn at(&self, t: f64) -> DVec3 {
        (self.p + self.d * t).max(DVec3::ZERO)
    }

    fn sample(&self, t: f64, difference: Option<f64>) -> Sample {
        let (Shape { a, c }, q, v) = (self.shape, self.at(t), self.d);
        let (r, w) = (self.shape.width(q.x, q.y), self.shape.profile(q.z));
        // The slope of r in x is `(x / r)^(a - 1)`, that of w in z `-(z / w)^(c - 1)`.
        let along = |speed: f64, ratio: f64, power: f64| {
            if speed == 0.0 {
                0.0
            } else {
                speed * libm::pow(ratio, power - 1.0)
            }
        };
        let r_slope = if r == 0.0 {
            self.shape.width(v.x, v.y).copysign(v.x + v.y)
        } else {
            along(v.x, q.x / r, a) + along(v.y, q.y / r, a)
        };
        Sample {
            t,
            difference: difference.unwrap_or_else(|| self.shape.difference(q)),
            values: [r, w],
            slopes: [r_slope, -along(v.z, q.z / w, c)],
        }
    }

    /// Linear functions below and above `r` (0) or `w` (1) between two samples.
    fn enclosure(&self, which: usize, s0: &Sample, s1: &Sample) -> [[Linear; 2]; 2] {
        let (v0, v1) = (s0.values[which], s1.values[which]);
        let step = s1.t - s0.t;
        let chord = Linear([v0, v1]);
        let tangents = [
            Linear([v0, v0 + s0.slopes[which] * step]),
            Linear([v1 - s1.slopes[which] * step, v1]),
        ];
        let convex = if which == 0 {
            self.shape.a >= 1.0
        } else {
            self.shape.c <= 1.0
        };
        if convex {
            [tangents, [chord; 2]]
        } else {
            [[chord; 2], tangents]
        }
    }

    /// How wrong `r - w` may be.
    fn rounding(&self, sample: &Sample) -> f64 {
        let Shape { a, c } = self.shape;
        4.0 * f64::EPSILON * (1.0 + 1.0 / a + 1.0 / c) * sample.values[0].max(1.0)
    }

    /// Whether `r - w` bends to one side only, and is clear of 0 at both samples: then it changes
    /// its sign at most once if it does at all. (Where it is 0 at an end, but for rounding, it may
    /// change there and once more.)
    fn bends_once(&self, s0: &Sample, s1: &Sample) -> bool {
        let Shape { a, c } = self.shape;
        let clear = |s: &Sample| s.difference.abs() > self.rounding(s);
        ((a >= 1.0 && c >= 1.0) || (a <= 1.0 && c <= 1.0)) && clear(s0) && clear(s1)
    }

    /// Whether `r - w` does not change its sign between two samples that agree: it is not 0 in
    /// between, or 0 but for rounding all the way.
    fn excludes(&self, s0: &Sample, s1: &Sample) -> bool {
        let [r_below, r_above] = self.enclosure(0, s0, s1);
        let [w_below, w_above] = self.enclosure(1, s0, s1);
        let gaps = |r: [Linear; 2], w: [Linear; 2]| {
            let gap = |r: Linear, w: Linear| [r.0[0] - w.0[0], r.0[1] - w.0[1]];
            [
                gap(r[0], w[0]),
                gap(r[0], w[1]),
                gap(r[1], w[0]),
                gap(r[1], w[1]),
            ]
        };
        // A bound that is NaN bounds nothing.
        let least = gaps(r_below, w_above)
            .map(|[a, b]| if (a + b).is_nan() { f64::NAN } else { a.min(b) })
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        let most = gaps(r_above, w_below)
            .map(|[a, b]| if (a + b).is_nan() { f64::NAN } else { a.max(b) })
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let rounding = self.rounding(s0).max(self.rounding(s1));
        least > 0.0 || most < 0.0 || (least >= -rounding && most <= rounding)
    }

    /// Whether `r - w` has at most one root between two samples: it rises or falls all the way.
    fn is_monotone(s0: &Sample, s1: &Sample) -> bool {
        let ([r0, w0], [r1, w1]) = (s0.slopes, s1.slopes);
        // Every slope between lies between those at the ends.
        let rises = r0 > w0 && r0 > w1 && r1 > w0 && r1 > w1;
        rises || (r0 < w0 && r0 < w1 && r1 < w0 && r1 < w1)
    }

    /// Whether both functions are straight between two samples, as far as rounding tells. On a line
    /// in a flat part of the surface their difference is nothing but rounding: no division ends.
    fn is_straight(s0: &Sample, s1: &Sample) -> bool {
        let step = s1.t - s0.t;
        (0..2).all(|which| {
            let (v0, v1) = (s0.values[which], s1.values[which]);
            let rise = v1 - v0;
            let least = 8.0 * f64::EPSILON * v0.abs().max(v1.abs());
            let bend = |s: &Sample| (s.slopes[which] * step - rise).abs();
            bend(s0) <= least && bend(s1) <= least
        })
    }

    /// Adds the sign changes between two samples.
    /// `left` counts down the samples that may still be taken.
    fn crossings(
        &self,
        s0: &Sample,
        s1: &Sample,
        depth: u32,
        left: &mut u32,
        changes: &mut SignChangeList,
    ) {
        let change = (s0.difference < 0.0) != (s1.difference < 0.0);
        let middle = 0.5 * (s0.t + s1.t);
        let decided = Self::is_monotone(s0, s1)
            || (change && self.bends_once(s0, s1))
            || (!change && self.excludes(s0, s1))
            || Self::is_straight(s0, s1)
            || depth == 0
            || *left == 0
            || !(s0.t < middle && middle < s1.t);
        if !decided {
            *left -= 1;
            let between = self.sample(middle, None);
            self.crossings(s0, &between, depth - 1, left, changes);
            self.crossings(&between, s1, depth - 1, left, changes);
        } else if change {
            let f = |t: f64| self.shape.difference(self.at(t));
            changes.push(bracketed(f, s0.t, s1.t, s0.difference, s1.difference));
        }
    }
}

pub(super) fn crossings(exponents: [f64; 2], o: DVec3, d: DVec3) -> SignChangeList {
    let shape = Shape::new(exponents);
    let length = d.length();
    let unit = d / length;
    let closest = -o.dot(unit);
    let p = o + unit * closest;
    let mut changes = SignChangeList::new(false);
    let span = Aabb::new(-DVec3::ONE, DVec3::ONE).clip(&Ray::new(p, unit));
    if span.is_empty() || span.start == span.end {
        return changes;
    }
    // Coordinate planes, in order.
    let mut knots = [span.start, span.end, span.end, span.end, span.end];
    for (knot, t) in knots[1..4].iter_mut().zip((-p / unit).to_array()) {
        if span.start < t && t < span.end {
            *knot = t;
        }
    }
    knots[1..4].sort_by(f64::total_cmp);
    // The solid does not reach out of its box.
    let outside = |t: f64| shape.difference(p + unit * t).max(f64::MIN_POSITIVE);
    let mut low = outside(span.start);
    let mut left = MAX_SAMPLES;
    for (i, pair) in knots.windows(2).enumerate() {
        if pair[0] == pair[1] {
            continue;
        }
        let middle = p + unit * (0.5 * (pair[0] + pair[1]));
        let signs = DVec3::ONE.copysign(middle);
        let octant = Octant {
            shape,
            p: p * signs,
            d: unit * signs,
        };
        let is_last = i == 3 || pair[1] >= span.end;
        let end = is_last.then(|| outside(pair[1]));
        let (s0, s1) = (
            octant.sample(pair[0], Some(low)),
            octant.sample(pair[1], end),
        );
        octant.crossings(&s0, &s1, MAX_DEPTH, &mut left, &mut changes);
        low = s1.difference;
    }
    changes.moved(closest / length, 1.0 / length)
}

pub(super) fn classify(exponents: [f64; 2], local: &LocalBox) -> Side {
    let shape = Shape::new(exponents);
    // The functions may be infinitely steep: rounding of the coordinates is part of the box.
    let rounding = (local.center.abs() + local.reach) * 1e-15;
    let (near, far) = local.absolute_range();
    let (near, far) = ((near - rounding).max(DVec3::ZERO), far + rounding);
    let (r_low, r_high) = (shape.width(near.x, near.y), shape.width(far.x, far.y));
    let (w_low, w_high) = (shape.profile(far.z), shape.profile(near.z));
    // Powers carry a few rounding errors times their exponent.
    let slack = |r: f64| 1e-13 * (1.0 + 1.0 / shape.a + 1.0 / shape.c) * (r + 1.0);
    if near.z > 1.0 || r_low - w_high > slack(r_low) {
        Side::Positive
    } else if r_high - w_low < -slack(r_high) {
        Side::Negative
    } else {
        Side::Both
    }
}

/// Of the function to the power `1 / c` of its value, which has degree 1.
pub(super) fn gradient(exponents: [f64; 2], p: DVec3) -> DVec3 {
    let Shape { a, c } = Shape::new(exponents);
    let r = norm(a, p.x, p.y);
    if r == 0.0 {
        return DVec3::new(0.0, 0.0, p.z);
    }
    let whole = norm(c, r, p.z);
    // Where the surface ends in a crease the slope is infinite.
    let part = |base: f64, power: f64| libm::pow(base, power - 1.0).min(1e100);
    let outward = part(r / whole, c);
    DVec3::new(
        (outward * part((p.x / r).abs(), a)).copysign(p.x),
        (outward * part((p.y / r).abs(), a)).copysign(p.y),
        part((p.z / whole).abs(), c).copysign(p.z),
    )
}
