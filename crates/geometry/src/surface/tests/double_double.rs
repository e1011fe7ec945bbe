//! Numbers of twice the precision, for oracles: an unevaluated sum of two `f64` (Dekker 1971).

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    pub(super) const fn new(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }

    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        let low = (a - (high - part)) + (b - part);
        Self { high, low }
    }

    pub(super) const fn value(self) -> f64 {
        self.high
    }

    pub(super) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::new(0.0);
        }
        let root = Self::new(self.high.sqrt());
        let rest = self - root * root;
        root + Self::new(0.5 * rest.high / root.high)
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let Self { high, low } = Self::sum(self.high, other.high);
        let rest = Self::sum(self.low, other.low);
        let first = Self::sum(high, low + rest.high);
        Self::sum(first.high, first.low + rest.low)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        Self::sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

#[test]
fn products_and_roots_have_twice_the_digits() {
    let third = Double::new(1.0) + Double::new(f64::EPSILON) * Double::new(0.3);
    let square = third * third - Double::new(1.0);
    assert!((square.value() / f64::EPSILON - 0.6).abs() < 1e-15);
    let two = Double::new(2.0).sqrt();
    assert!((two * two - Double::new(2.0)).value().abs() < 1e-30);
}
