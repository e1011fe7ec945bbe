//! Real roots, found the way intersections need them: an even number of sign changes stays an
//! even number, whatever the rounding.

mod polynomial;

pub use polynomial::{MAX_DEGREE, SignChangeList, sign_changes};

/// The sign changes of `a t^2 + 2 b t + c`, in order, with the sign at `t = -inf`.
///
/// Double roots, and roots that round to one, are no sign change. The form that avoids
/// cancellation is used (Press et al., *Numerical Recipes*, section 5.6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignChanges {
    /// Whether the value is negative at `t = -inf`.
    pub starts_negative: bool,
    /// How many of `t` are used.
    pub count: usize,
    /// Where the sign changes, increasing.
    pub t: [f64; 4],
}

impl SignChanges {
    /// The sign never changes.
    #[must_use]
    pub const fn none(negative: bool) -> Self {
        Self {
            starts_negative: negative,
            count: 0,
            t: [0.0; 4],
        }
    }

    /// One change.
    #[must_use]
    pub const fn one(starts_negative: bool, t: f64) -> Self {
        Self {
            starts_negative,
            count: 1,
            t: [t, 0.0, 0.0, 0.0],
        }
    }

    /// Two changes at `t0` and `t1`; none if they are not apart.
    #[must_use]
    pub fn two(starts_negative: bool, t0: f64, t1: f64) -> Self {
        let (low, high) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
        if low < high {
            Self {
                starts_negative,
                count: 2,
                t: [low, high, 0.0, 0.0],
            }
        } else {
            Self::none(starts_negative)
        }
    }

    /// The changes found at `u`, now at `t = shift + u * scale`, `scale > 0`; pairs that round
    /// together vanish.
    #[must_use]
    pub fn moved(mut self, shift: f64, scale: f64) -> Self {
        let mut kept = 0;
        for i in 0..self.count {
            let t = shift + self.t[i] * scale;
            if kept > 0 && self.t[kept - 1] >= t {
                kept -= 1;
            } else {
                self.t[kept] = t;
                kept += 1;
            }
        }
        self.count = kept;
        self
    }

    /// Visits the changes, in order, and returns whether the value is negative before them.
    pub fn report(&self, visit: impl FnMut(f64)) -> bool {
        self.as_slice().iter().copied().for_each(visit);
        self.starts_negative
    }

    /// The parameters at which the sign changes.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.t[..self.count]
    }
}

/// Sign changes of the quadratic `a t^2 + 2 b t + c`.
///
/// Coefficients must be finite. A leading coefficient so small that its root overflows counts as 0.
#[must_use]
pub fn quadratic(a: f64, b: f64, c: f64) -> SignChanges {
    let linear = || {
        let t = -0.5 * c / b;
        if b == 0.0 || !t.is_finite() {
            SignChanges::none(c < 0.0)
        } else {
            SignChanges::one(b > 0.0, t)
        }
    };
    if a == 0.0 {
        return linear();
    }
    let discriminant = b * b - a * c;
    // Written so that NaN (from overflow) falls here too.
    if !matches!(
        discriminant.partial_cmp(&0.0),
        Some(std::cmp::Ordering::Greater)
    ) {
        return SignChanges::none(a < 0.0);
    }
    let root = discriminant.sqrt();
    let q = if b < 0.0 { root - b } else { -(root + b) };
    let (t0, t1) = (q / a, c / q);
    if !t0.is_finite() {
        return linear();
    }
    if !t1.is_finite() {
        return SignChanges::none(a < 0.0);
    }
    SignChanges::two(a < 0.0, t0, t1)
}

/// The root of a continuous function in `[low, high]` whose values at the ends differ in sign.
///
/// Chandrupatla's method (1997): inverse quadratic interpolation where it is safe, bisection
/// elsewhere. It ends when the interval cannot shrink further or the value is exactly 0, after at
/// most 200 steps; about 8 are usual.
pub fn bracketed(
    mut f: impl FnMut(f64) -> f64,
    low: f64,
    high: f64,
    f_low: f64,
    f_high: f64,
) -> f64 {
    let (mut a, mut b) = (high, low);
    let (mut fa, mut fb) = (f_high, f_low);
    let mut fraction = 0.5;
    for _ in 0..200 {
        let t = a + fraction * (b - a);
        let ft = f(t);
        let (c, fc) = if (ft < 0.0) == (fa < 0.0) {
            (a, fa)
        } else {
            let behind = (b, fb);
            (b, fb) = (a, fa);
            behind
        };
        a = t;
        fa = ft;
        let (best, f_best) = if fa.abs() < fb.abs() {
            (a, fa)
        } else {
            (b, fb)
        };
        let limit = 2.0 * f64::EPSILON * best.abs() + f64::MIN_POSITIVE;
        let shrink = limit / (b - a).abs();
        if shrink > 0.5 || f_best == 0.0 {
            return best;
        }
        let xi = (a - b) / (c - b);
        let phi = (fa - fb) / (fc - fb);
        fraction = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            fa / (fb - fa) * (fc / (fb - fc))
                + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
        } else {
            0.5
        };
        fraction = fraction.clamp(shrink, 1.0 - shrink);
    }
    a
}

/// The points in `(-limit, limit)` that separate the monotone pieces of
/// `u^4 + p u^2 + q u + r`, increasing, at most three.
///
/// They are the zeros of the derivative, each isolated between those of the second derivative.
#[must_use]
pub fn depressed_quartic_turning_points(p: f64, q: f64, limit: f64) -> ([f64; 3], usize) {
    let slope = |u: f64| (4.0 * u * u + 2.0 * p) * u + q;
    let mut knots = [-limit, limit, 0.0, 0.0];
    let mut knot_count = 2;
    if p < 0.0 {
        let inflection = (-p / 6.0).sqrt();
        if inflection < limit {
            knots = [-limit, -inflection, inflection, limit];
            knot_count = 4;
        }
    }
    let mut turning = [0.0; 3];
    let mut count = 0;
    for pair in knots[..knot_count].windows(2) {
        let (low, high) = (slope(pair[0]), slope(pair[1]));
        if (low < 0.0) != (high < 0.0) {
            turning[count] = bracketed(slope, pair[0], pair[1], low, high);
            count += 1;
        }
    }
    (turning, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn double_roots_are_no_sign_change() {
        assert_eq!(quadratic(1.0, -1.0, 1.0), SignChanges::none(false));
        assert_eq!(quadratic(-1.0, 1.0, -1.0), SignChanges::none(true));
    }

    #[test]
    fn a_vanishing_leading_coefficient_leaves_the_near_root() {
        for a in [0.0, 1e-320, -1e-320] {
            let changes = quadratic(a, 1.0, -4.0);
            assert_eq!(changes.as_slice(), [2.0], "{a}");
            assert!(changes.starts_negative);
        }
    }

    proptest! {
        #[test]
        fn quadratic_roots_are_where_they_were_put(
            r0 in -1e6..1e6f64, gap in 1e-3..1e6f64, a in prop_oneof![-1e3..-1e-3f64, 1e-3..1e3f64],
        ) {
            let r1 = r0 + gap;
            let changes = quadratic(a, -0.5 * a * (r0 + r1), a * r0 * r1);
            let scale = r0.abs().max(r1.abs());
            // The coefficients themselves carry a rounding error, amplified by scale / gap.
            let tolerance = 1e-14 * scale * (1.0 + scale / gap);
            prop_assert_eq!(changes.count, 2);
            prop_assert!((changes.t[0] - r0).abs() <= tolerance);
            prop_assert!((changes.t[1] - r1).abs() <= tolerance);
            prop_assert_eq!(changes.starts_negative, a < 0.0);
        }

        #[test]
        fn bracketed_finds_the_root_of_a_steep_cubic(root in -10.0..10.0f64, k in 1e-6..1e6f64) {
            let f = |t: f64| { let d = t - root; d * (d * d + k) };
            let (low, high) = (-20.0, 30.0);
            let found = bracketed(f, low, high, f(low), f(high));
            prop_assert!((found - root).abs() <= 4.0 * f64::EPSILON * root.abs().max(1.0), "{}", found);
        }

        #[test]
        fn turning_points_separate_monotone_pieces(p in -10.0..10.0f64, q in -10.0..10.0f64) {
            let (turning, count) = depressed_quartic_turning_points(p, q, 10.0);
            let slope = |u: f64| (4.0 * u * u + 2.0 * p) * u + q;
            let mut knots = vec![-10.0];
            knots.extend(&turning[..count]);
            knots.push(10.0);
            for pair in knots.windows(2) {
                prop_assert!(pair[0] <= pair[1]);
                // The sign of the slope is the same at all inner points of a piece.
                let signs: Vec<bool> = (1..20)
                    .map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / 20.0)
                    .filter(|&u| slope(u).abs() > 1e-9)
                    .map(|u| slope(u) < 0.0)
                    .collect();
                prop_assert!(signs.windows(2).all(|s| s[0] == s[1]));
            }
        }
    }
}
