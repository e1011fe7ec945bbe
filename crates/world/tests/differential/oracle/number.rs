//! The two precisions in which clearances are computed: `f64`, and unevaluated sums of two of them.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the formulas of the primitives need.
pub(crate) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn sqrt(self) -> Self;
    /// Rounded to the nearest `f64`.
    fn rounded(self) -> f64;

    fn largest(self, other: Self) -> Self {
        if (self - other).rounded() < 0.0 {
            other
        } else {
            self
        }
    }

    fn squared(self) -> Self {
        self * self
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    fn rounded(self) -> f64 {
        self
    }
}

/// `high + low` with `|low| <= ulp(high) / 2`: about 106 bits (Dekker 1971).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twofold {
    high: f64,
    low: f64,
}

/// `a + b` and what rounding took from it (Knuth).
fn two_sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    let part = high - a;
    let low = (a - (high - part)) + (b - part);
    Twofold { high, low }
}

/// `a + b` for `|a| >= |b|`.
fn quick_two_sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    Twofold {
        high,
        low: b - (high - a),
    }
}

/// `a` as the sum of two numbers of 26 bits (Veltkamp); `|a|` must stay below 2^990.
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// `a * b` and what rounding took from it.
fn two_product(a: f64, b: f64) -> Twofold {
    let high = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let low = ((ah * bh - high) + ah * bl + al * bh) + al * bl;
    Twofold { high, low }
}

impl Add for Twofold {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Twofold {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Twofold {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let rest = self.high * other.low + self.low * other.high;
        quick_two_sum(product.high, product.low + rest)
    }
}

impl Div for Twofold {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::of(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::of(second);
        quick_two_sum(first, second) + Self::of(rest.high / other.high)
    }
}

impl Number for Twofold {
    fn of(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }

    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::of(0.0);
        }
        let root = Self::of(self.high.sqrt());
        // One Newton step doubles the digits.
        root + (self - root * root) / (root + root)
    }

    fn rounded(self) -> f64 {
        self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_twofold_keeps_what_a_double_loses() {
        let tiny = 2.0_f64.powi(-80);
        let sum = Twofold::of(1.0) + Twofold::of(tiny);
        assert_eq!((sum - Twofold::of(1.0)).rounded(), tiny);
        let third = Twofold::of(1.0) / Twofold::of(3.0);
        let error = third * Twofold::of(3.0) - Twofold::of(1.0);
        assert!(error.rounded().abs() < 2.0_f64.powi(-100));
        let root = Twofold::of(2.0).sqrt();
        assert!((root.squared() - Twofold::of(2.0)).rounded().abs() < 2.0_f64.powi(-100));
    }
}
