//! Sign changes of a polynomial of one variable on the whole line.
//!
//! The line is taken in four pieces, each mapped to `[0, 1]`: `t` and `-t` between 0 and 1, and
//! `1 / t` and `-1 / t` beyond. So roots that lie far away, or at infinity because a leading
//! coefficient is tiny or 0, are found with bounded numbers. In each piece Descartes' rule in
//! Bernstein form (Collins & Akritas 1976) says cheaply that there is no root or exactly one;
//! otherwise the roots of the derivatives, from the highest down, separate those of the
//! polynomial. The signs at the ends of the pieces are decided once, so that the number of sign
//! changes always fits to the leading coefficient.

use super::bracketed;

/// The highest degree.
pub const MAX_DEGREE: usize = 15;
const TERMS: usize = MAX_DEGREE + 1;

/// Where the sign of a function on a line changes, in order.
#[derive(Clone, Copy, Debug)]
pub struct SignChangeList {
    /// Whether the value is negative at `t = -inf`.
    pub starts_negative: bool,
    count: usize,
    t: [f64; Self::CAPACITY],
}

impl SignChangeList {
    const CAPACITY: usize = 4 * TERMS;

    /// No change yet.
    #[must_use]
    pub const fn new(starts_negative: bool) -> Self {
        Self {
            starts_negative,
            count: 0,
            t: [0.0; Self::CAPACITY],
        }
    }

    /// Adds a change behind those that are there. Together with one that is not before it, it is
    /// none: pairs that round together vanish. A change at infinity is none either.
    pub fn push(&mut self, t: f64) {
        if !t.is_finite() {
            // At the beginning it is where the line comes from; at the end nothing lies behind it.
            self.starts_negative ^= self.count == 0 && t < 0.0;
            return;
        }
        let full = self.count == Self::CAPACITY;
        if full || (self.count > 0 && self.t[self.count - 1] >= t) {
            self.count -= 1;
        } else {
            self.t[self.count] = t;
            self.count += 1;
        }
    }

    /// Visits the changes, in order, and returns whether the value is negative before them.
    pub fn report(&self, visit: impl FnMut(f64)) -> bool {
        self.as_slice().iter().copied().for_each(visit);
        self.starts_negative
    }

    /// The parameters at which the sign changes, increasing.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.t[..self.count]
    }

    /// The changes found at `u`, now at `t = shift + u * scale`, `scale > 0`.
    #[must_use]
    pub fn moved(&self, shift: f64, scale: f64) -> Self {
        let mut moved = Self::new(self.starts_negative);
        for &u in self.as_slice() {
            moved.push(shift + u * scale);
        }
        moved
    }
}

/// The sign changes of `sum of coefficients[k] t^k`.
///
/// Of a polynomial that is 0 everywhere, or has a coefficient that is not finite, there are none.
///
/// # Panics
/// Never for up to [`MAX_DEGREE`] + 1 coefficients; more are ignored.
#[must_use]
pub fn sign_changes(coefficients: &[f64]) -> SignChangeList {
    let used = &coefficients[..coefficients.len().min(TERMS)];
    let largest = used.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let sum: f64 = used.iter().sum();
    let Some(degree) = used.iter().rposition(|&c| c != 0.0) else {
        return SignChangeList::new(false);
    };
    if !(largest.is_finite() && sum.is_finite()) {
        return SignChangeList::new(false);
    }
    if degree == 0 {
        return SignChangeList::new(used[0] < 0.0);
    }
    // By a power of two, exact but for coefficients that are too small to matter, and only where
    // sums could over- or underflow.
    let exponent = if (1e-60..1e60).contains(&largest) {
        0
    } else {
        -libm::ilogb(largest)
    };
    let mut forward = [0.0; TERMS];
    let mut backward = [0.0; TERMS];
    for (k, &c) in used.iter().enumerate().take(degree + 1) {
        forward[k] = if exponent == 0 {
            c
        } else {
            libm::ldexp(c, exponent)
        };
        backward[k] = if k % 2 == 0 { forward[k] } else { -forward[k] };
    }
    let (forward, backward) = (&forward[..=degree], &backward[..=degree]);
    // The leading coefficient as it is, for it may have been scaled to 0.
    let leads_negative = used[degree] < 0.0;
    let comes_negative = leads_negative != (degree % 2 == 1);
    let (at_one, at_minus_one) = (value(forward, 1.0), value(backward, 1.0));

    let mut changes = SignChangeList::new(comes_negative);
    let mut reversed = [0.0; TERMS];
    let reversed = &mut reversed[..=degree];
    reverse(backward, reversed);
    let piece = on_unit_interval(reversed, comes_negative, at_minus_one);
    piece.iter().for_each(|s| changes.push(-1.0 / s));
    let piece = on_unit_interval(backward, forward[0] < 0.0, at_minus_one);
    piece.iter().rev().for_each(|s| changes.push(-s));
    // Of roots that are so far away that numbers fail, one of a pair may be lost. The sign here is
    // certain: where the line comes from follows from it.
    changes.starts_negative = (forward[0] < 0.0) != (changes.count % 2 == 1);
    let piece = on_unit_interval(forward, forward[0] < 0.0, at_one);
    piece.iter().for_each(|&s| changes.push(s));
    reverse(forward, reversed);
    let piece = on_unit_interval(reversed, leads_negative, at_one);
    piece.iter().rev().for_each(|s| changes.push(1.0 / s));
    changes
}

fn reverse(coefficients: &[f64], reversed: &mut [f64]) {
    for (r, c) in reversed.iter_mut().zip(coefficients.iter().rev()) {
        *r = *c;
    }
}

fn value(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// Some points of `[0, 1]`, increasing.
#[derive(Clone, Copy)]
struct Points {
    t: [f64; TERMS],
    count: usize,
}

impl std::ops::Deref for Points {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.t[..self.count]
    }
}

/// The sign changes between 0, where the sign is given, and 1, where the value is.
fn on_unit_interval(coefficients: &[f64], low_negative: bool, at_one: f64) -> Points {
    let none = Points {
        t: [0.0; TERMS],
        count: 0,
    };
    let (low, high) = (signed(coefficients[0], low_negative), at_one);
    match descartes(coefficients) {
        Some(0) if low_negative == (high < 0.0) => none,
        Some(1) if low_negative != (high < 0.0) => between(coefficients, &none, low, high),
        _ => {
            let mut knots = none;
            let mut derivative = [0.0; TERMS];
            for order in (1..coefficients.len()).rev() {
                let count = differentiate(coefficients, order, &mut derivative);
                let derivative = &derivative[..count];
                knots = between(derivative, &knots, derivative[0], value(derivative, 1.0));
            }
            between(coefficients, &knots, low, high)
        }
    }
}

/// A value with a sign that was decided elsewhere.
fn signed(value: f64, negative: bool) -> f64 {
    let size = value.abs().max(f64::MIN_POSITIVE);
    if negative { -size } else { size }
}

/// The derivative of some order; how many coefficients it has.
fn differentiate(coefficients: &[f64], order: usize, derivative: &mut [f64; TERMS]) -> usize {
    for (k, d) in derivative
        .iter_mut()
        .enumerate()
        .take(coefficients.len() - order)
    {
        // Without the factor order!, which changes no sign: binomial (k + order over k).
        let mut factor = 1.0;
        for j in 1..=order {
            factor *= (k + j) as f64 / j as f64;
        }
        *d = coefficients[k + order] * factor;
    }
    coefficients.len() - order
}

/// The sign changes in `[0, 1]`, at most one between neighbouring knots, given the values at the
/// ends.
fn between(coefficients: &[f64], knots: &Points, low: f64, high: f64) -> Points {
    let mut found = Points {
        t: [0.0; TERMS],
        count: 0,
    };
    let f = |t: f64| value(coefficients, t);
    let (mut t0, mut f0) = (0.0, low);
    for (i, t1) in knots.iter().copied().chain([1.0]).enumerate() {
        let f1 = if i == knots.count { high } else { f(t1) };
        if (f0 < 0.0) != (f1 < 0.0) && found.count < TERMS {
            found.t[found.count] = bracketed(f, t0, t1, f0, f1);
            found.count += 1;
        }
        (t0, f0) = (t1, f1);
    }
    found
}

/// The number of sign variations of the coefficients in Bernstein form, which is the number of
/// roots in `(0, 1)` plus an even number. `None` where rounding leaves a sign open.
fn descartes(coefficients: &[f64]) -> Option<usize> {
    let mut shifted = [0.0; TERMS];
    let shifted = &mut shifted[..coefficients.len()];
    reverse(coefficients, shifted);
    let degree = coefficients.len() - 1;
    let total: f64 = coefficients.iter().map(|c| c.abs()).sum();
    // `(1 + x)^n p(1 / (1 + x))`, by additions only: their partial sums stay below 2^n total.
    for first in 0..degree {
        for k in (first..degree).rev() {
            shifted[k] += shifted[k + 1];
        }
    }
    let doubt = (degree as f64) * f64::EPSILON * libm::ldexp(total, degree as i32);
    let mut variations = 0;
    for pair in shifted.windows(2) {
        if pair[0].abs() <= doubt {
            return None;
        }
        variations += usize::from((pair[0] < 0.0) != (pair[1] < 0.0));
    }
    (shifted[degree].abs() > doubt).then_some(variations)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn roots_at_the_end_of_the_world_do_not_change_the_sign_nearby() {
        // Negative at 0, with changes at about -6.5e16 and 1.4e-17 / last.
        for last in [-1e-30, -1e-40, -1e-60, -2.3e-83, -1e-120, -1e-300] {
            let changes = sign_changes(&[-0.68, -0.97, -0.91, -1.4e-17, last]);
            let passed = changes.as_slice().iter().filter(|t| **t < 0.0).count();
            assert!(
                changes.starts_negative != (passed % 2 == 1),
                "{last} {changes:?}"
            );
        }
    }

    /// The coefficients of the polynomial with these roots.
    fn product(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |p, r| {
            let mut next = vec![0.0; p.len() + 1];
            for (k, c) in p.iter().enumerate() {
                next[k] -= c * r;
                next[k + 1] += c;
            }
            next
        })
    }

    #[test]
    fn degenerate_polynomials_have_no_changes() {
        assert!(sign_changes(&[]).as_slice().is_empty());
        assert!(sign_changes(&[0.0, 0.0]).as_slice().is_empty());
        assert!(sign_changes(&[-2.0, 0.0, 0.0]).starts_negative);
        assert!(sign_changes(&[f64::NAN, 1.0]).as_slice().is_empty());
        assert!(sign_changes(&[f64::INFINITY, 1.0]).as_slice().is_empty());
    }

    #[test]
    fn even_multiplicity_is_no_change_and_odd_is_one() {
        for root in [0.0, 0.5, -0.25, 3.0, -4.0, 1.0] {
            let double = sign_changes(&product(&[root, root]));
            assert_eq!(double.as_slice(), [0.0; 0], "{root}");
            let triple = sign_changes(&product(&[root; 3]));
            assert_eq!(triple.as_slice().len() % 2, 1, "{root}");
            assert!(triple.as_slice().iter().all(|t| (t - root).abs() < 1e-4));
            assert!(triple.starts_negative);
        }
    }

    #[test]
    fn a_vanishing_leading_coefficient_leaves_the_near_roots() {
        for tiny in [0.0, 1e-30, -1e-30, 1e-320] {
            let changes = sign_changes(&[-4.0, 2.0, 0.0, 0.0, tiny]);
            let near: Vec<f64> = changes
                .as_slice()
                .iter()
                .copied()
                .filter(|t| t.abs() < 1e6)
                .collect();
            assert_eq!(near, [2.0], "{tiny}");
            let passed = changes.as_slice().iter().filter(|t| **t < 0.0).count();
            assert!(changes.starts_negative ^ (passed % 2 == 1), "negative at 0");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn separated_roots_are_all_found(
            gaps in proptest::collection::vec(0.5..2.0f64, 1..9), start in -8.0..2.0f64,
            scale in prop_oneof![Just(1.0), 1e-3..1e3f64], factor in prop_oneof![Just(-3.0), Just(1e-200), Just(1e200)],
        ) {
            let mut at = start;
            let roots: Vec<f64> = gaps.iter().map(|gap| { at += gap; at * scale }).collect();
            let coefficients: Vec<f64> = product(&roots).iter().map(|c| c * factor).collect();
            prop_assume!(coefficients.iter().all(|c| c.is_finite() && (*c == 0.0 || c.abs() > 1e-290)));
            let changes = sign_changes(&coefficients);
            prop_assert_eq!(changes.as_slice().len(), roots.len());
            for (found, root) in changes.as_slice().iter().zip(&roots) {
                prop_assert!((found - root).abs() < 1e-5 * scale * (1.0 + at.abs()), "{} {}", found, root);
            }
            prop_assert_eq!(changes.starts_negative, (factor < 0.0) != (roots.len() % 2 == 1));
        }

        #[test]
        fn signs_between_changes_are_those_of_the_polynomial(
            coefficients in proptest::collection::vec(
                prop_oneof![-1.0..1.0f64, Just(0.0), -1e-9..1e-9f64, -1e9..1e9f64], 1..=16),
        ) {
            let changes = sign_changes(&coefficients);
            let parity = coefficients.iter().rposition(|c| *c != 0.0).map_or(0, |degree| degree % 2);
            prop_assert_eq!(changes.as_slice().len() % 2, parity);
            for i in -200..200 {
                let t = libm::sinh(f64::from(i) * 0.05 + 0.01);
                let size = coefficients.iter().rev().fold(0.0, |sum, c| sum * t.abs() + c.abs());
                let v = value(&coefficients, t);
                let passed = changes.as_slice().iter().filter(|c| **c < t).count();
                let negative = changes.starts_negative ^ (passed % 2 == 1);
                prop_assert!(v.abs() < 1e-13 * size || negative == (v < 0.0), "{} {}", t, v);
            }
        }
    }
}
