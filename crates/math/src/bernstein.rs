//! Polynomials on `[0, 1]` in Bernstein form: the coefficients enclose the values, so signs are
//! known without solving.

use crate::roots;

/// The highest degree: the square of a cubic.
const MAX_DEGREE: usize = 6;
/// Roots closer together than `2^-MAX_HALVINGS` of the interval are not told apart.
const MAX_HALVINGS: u32 = 34;
/// Half the width of the piece around every point of separation: a root there may be seen on
/// either side of it, by rounding, but not on either side of that piece.
const GUARD: f64 = 1.0 / (1_u64 << 37) as f64;

const BINOMIAL: [[f64; MAX_DEGREE + 1]; MAX_DEGREE + 1] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0, 0.0, 0.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, 1.0, 0.0],
    [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0],
];

/// `sum_i c_i binomial(n, i) u^i (1 - u)^(n - i)` for `u` in `[0, 1]`, of degree `n <= 6`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bernstein {
    degree: usize,
    coefficients: [f64; MAX_DEGREE + 1],
}

impl Bernstein {
    /// The polynomial with these coefficients, one more than its degree: from 1 to 7. Further
    /// ones are ignored.
    #[must_use]
    pub fn new(coefficients: &[f64]) -> Self {
        let mut all = [0.0; MAX_DEGREE + 1];
        let count = coefficients.len().clamp(1, MAX_DEGREE + 1);
        for (to, from) in all
            .iter_mut()
            .zip(&coefficients[..count.min(coefficients.len())])
        {
            *to = *from;
        }
        Self {
            degree: count - 1,
            coefficients: all,
        }
    }

    /// The coefficients.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// The value at `u`, by de Casteljau's algorithm; at 0 and 1 exactly the outer coefficients.
    #[must_use]
    pub fn evaluate(&self, u: f64) -> f64 {
        let mut c = self.coefficients;
        for level in (1..=self.degree).rev() {
            for i in 0..level {
                c[i] = mix(c[i], c[i + 1], u);
            }
        }
        c[0]
    }

    /// The product; degrees must add up to at most 6 (higher terms are dropped).
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let (m, n) = (self.degree, other.degree);
        let degree = (m + n).min(MAX_DEGREE);
        let mut product = [0.0; MAX_DEGREE + 1];
        for (i, a) in self.coefficients().iter().enumerate() {
            for (j, b) in other.coefficients().iter().enumerate() {
                if i + j <= degree {
                    product[i + j] += BINOMIAL[m][i] * BINOMIAL[n][j] * a * b;
                }
            }
        }
        for (k, c) in product.iter_mut().enumerate().take(degree + 1) {
            *c /= BINOMIAL[degree][k];
        }
        Self {
            degree,
            coefficients: product,
        }
    }

    /// `self - other`, of the same degree.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let mut result = *self;
        for (a, b) in result.coefficients.iter_mut().zip(other.coefficients) {
            *a -= b;
        }
        result
    }

    /// `self * factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut result = *self;
        result.coefficients.iter_mut().for_each(|c| *c *= factor);
        result
    }

    /// Visits, increasing, points in `(0, 1)` between any two of which the polynomial changes from
    /// positive to not positive or back at most once, except where such changes are closer
    /// together than 2^-34.
    ///
    /// By halving until the coefficients' signs vary at most once (Descartes' rule in Bernstein
    /// form; Lane and Riesenfeld 1981).
    pub fn separate(&self, visit: &mut impl FnMut(f64)) {
        self.separate_between(0.0, 1.0, MAX_HALVINGS, visit);
    }

    fn separate_between(&self, low: f64, high: f64, halvings: u32, visit: &mut impl FnMut(f64)) {
        if halvings == 0 || self.variations() <= 1 {
            return;
        }
        let (left, right) = self.halves();
        let middle = 0.5 * (low + high);
        left.separate_between(low, middle, halvings - 1, visit);
        visit(middle - GUARD);
        visit(middle + GUARD);
        right.separate_between(middle, high, halvings - 1, visit);
    }

    /// The same, but positive or not at 0 and 1 as said: for values there that another way of
    /// computing them, by its rounding, puts on the other side of 0.
    #[must_use]
    pub fn with_signs(mut self, positive_at_0: bool, positive_at_1: bool) -> Self {
        for (index, positive) in [(0, positive_at_0), (self.degree, positive_at_1)] {
            let c = &mut self.coefficients[index];
            if (*c > 0.0) != positive {
                *c = if positive {
                    f64::MIN_POSITIVE
                } else {
                    -f64::MIN_POSITIVE
                };
            }
        }
        self
    }

    /// How often neighbouring coefficients change between positive and not positive.
    fn variations(&self) -> usize {
        let all = self.coefficients();
        let pairs = all.windows(2);
        pairs.filter(|p| (p[0] > 0.0) != (p[1] > 0.0)).count()
    }

    /// The same polynomial over `[0, 1/2]` and `[1/2, 1]`, each as one over `[0, 1]`.
    fn halves(&self) -> (Self, Self) {
        let (mut left, mut right) = (*self, *self);
        let mut c = self.coefficients;
        for level in (1..=self.degree).rev() {
            for i in 0..level {
                c[i] = 0.5 * (c[i] + c[i + 1]);
            }
            left.coefficients[self.degree - level + 1] = c[0];
            right.coefficients[level - 1] = c[level - 1];
        }
        (left, right)
    }
}

/// `a` at `u = 0`, `b` at `u = 1`, exactly.
fn mix(a: f64, b: f64, u: f64) -> f64 {
    if u < 0.5 {
        a + (b - a) * u
    } else {
        b - (b - a) * (1.0 - u)
    }
}

/// Where a function that is positive at exactly one of two points changes between positive and not
/// positive; 0 counts as not positive, so a zero at the end of a stretch of negative values is no
/// change.
#[must_use]
pub fn change_of_sign(
    mut f: impl FnMut(f64) -> f64,
    low: f64,
    high: f64,
    f_low: f64,
    f_high: f64,
) -> f64 {
    let below = |value: f64| {
        if value == 0.0 {
            -f64::MIN_POSITIVE
        } else {
            value
        }
    };
    roots::bracketed(|u| below(f(u)), low, high, below(f_low), below(f_high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn double_and_triple_roots_end() {
        // (u - 0.3)^2 touches; its coefficients are 0.09, -0.21, 0.49.
        let square = Bernstein::new(&[0.09, -0.21, 0.49]);
        let sixth = square.times(&square).times(&square);
        let mut count = 0;
        sixth.separate(&mut |_| count += 1);
        assert!(count < 1000, "{count}");
    }

    #[test]
    fn a_zero_at_the_end_is_told_from_the_change_behind_it() {
        // Zero at 0, negative, then positive from 2/3 on.
        let p = Bernstein::new(&[0.0, -1.0, 1.0]);
        let u = change_of_sign(|u| p.evaluate(u), 0.0, 1.0, 0.0, 1.0);
        assert!((u - 2.0 / 3.0).abs() < 1e-15, "{u}");
        // Positive from 0 on.
        let q = Bernstein::new(&[0.0, 1.0, 1.0]);
        let u = change_of_sign(|u| q.evaluate(u), 0.0, 1.0, 0.0, 1.0);
        assert!(u < 1e-15, "{u}");
    }

    proptest! {
        #[test]
        fn products_and_halves_have_the_values_they_should(
            a in proptest::collection::vec(-1.0..1.0f64, 1..=4),
            b in proptest::collection::vec(-1.0..1.0f64, 1..=4),
            u in 0.0..=1.0f64,
        ) {
            let (p, q) = (Bernstein::new(&a), Bernstein::new(&b));
            let product = p.times(&q);
            prop_assert!((product.evaluate(u) - p.evaluate(u) * q.evaluate(u)).abs() < 1e-13);
            let (left, right) = p.halves();
            prop_assert!((left.evaluate(u) - p.evaluate(0.5 * u)).abs() < 1e-14);
            prop_assert!((right.evaluate(u) - p.evaluate(0.5 + 0.5 * u)).abs() < 1e-14);
            prop_assert_eq!(p.evaluate(0.0), a[0]);
            prop_assert_eq!(p.evaluate(1.0), a[a.len() - 1]);
        }

        #[test]
        fn separated_pieces_have_one_root_each(
            roots in proptest::collection::vec(0.01..0.99f64, 1..=6),
        ) {
            let mut p = Bernstein::new(&[1.0]);
            for r in &roots {
                p = p.times(&Bernstein::new(&[-r, 1.0 - r]));
            }
            let mut sorted = roots;
            sorted.sort_by(f64::total_cmp);
            prop_assume!(sorted.windows(2).all(|w| w[1] - w[0] > 1e-2));
            let mut knots = vec![0.0];
            p.separate(&mut |u| knots.push(u));
            knots.push(1.0);
            for piece in knots.windows(2) {
                prop_assert!(piece[0] < piece[1]);
                let inside = sorted.iter().filter(|r| (piece[0]..piece[1]).contains(*r)).count();
                prop_assert!(inside <= 1);
            }
        }
    }
}
