//! Solids where a polynomial is negative, quadrics among them.

use octray_geometry::Primitive;
use octray_geometry::surface::QuadricForm;

use super::number::Number;

/// A coefficient and the powers of x, y and z.
pub(super) type Term = (f64, [usize; 3]);

/// Rounding of the engine's value of a polynomial, in units of the sum of its terms' sizes.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The polynomial of a primitive that is defined by one.
pub(super) fn terms(primitive: &Primitive) -> Option<Vec<Term>> {
    let (x, y, z) = ([2, 0, 0], [0, 2, 0], [0, 0, 2]);
    let (height, one) = ([0, 0, 1], [0, 0, 0]);
    let quadric = |form: &QuadricForm| match form {
        QuadricForm::OneSheet => vec![(1.0, x), (1.0, y), (-1.0, z), (-1.0, one)],
        QuadricForm::TwoSheets => vec![(1.0, x), (1.0, y), (-1.0, z), (1.0, one)],
        QuadricForm::DoubleCone => vec![(1.0, x), (1.0, y), (-1.0, z)],
        QuadricForm::EllipticParaboloid => vec![(1.0, x), (1.0, y), (-1.0, height)],
        QuadricForm::HyperbolicParaboloid => vec![(1.0, x), (-1.0, y), (-1.0, height)],
        QuadricForm::HyperbolicCylinder => vec![(1.0, x), (-1.0, y), (-1.0, one)],
        QuadricForm::ParabolicCylinder => vec![(1.0, x), (-1.0, height)],
    };
    match primitive {
        Primitive::Quadric(form) => Some(quadric(form)),
        Primitive::Polynomial { polynomial, .. } => {
            // By falling power of x, then of y, then of z.
            let degree = polynomial.degree();
            let powers = (0..=degree).rev().flat_map(move |i| {
                let rest = degree - i;
                let below = (0..=rest).rev();
                below.flat_map(move |j| (0..=rest - j).rev().map(move |k| [i, j, k]))
            });
            let all = polynomial.coefficients().iter().copied().zip(powers);
            Some(all.filter(|(c, _)| *c != 0.0).collect())
        }
        _ => None,
    }
}

/// The value of the polynomial.
pub(super) fn value<N: Number>(terms: &[Term], q: [N; 3]) -> N {
    let power = |x: N, n: usize| (0..n).fold(N::of(1.0), |product, _| product * x);
    let mut value = N::of(0.0);
    for (c, powers) in terms {
        let product = (0..3).fold(N::of(*c), |p, axis| p * power(q[axis], powers[axis]));
        value = value + product;
    }
    value
}

/// A distance within which the polynomial keeps its sign, with that sign.
pub(super) fn clearance<N: Number>(terms: &[Term], q: [N; 3]) -> N {
    let value = value(terms, q);
    let at = q.map(Number::rounded);
    let reach = at.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let degree = |powers: &[usize; 3]| powers.iter().sum::<usize>() as i32;
    let sizes = terms.iter().map(|(c, p)| c.abs() * reach.powi(degree(p)));
    let noise = ROUNDING * sizes.sum::<f64>();
    let clear = value.rounded().abs() - noise;
    if clear <= 0.0 {
        return N::of(0.0);
    }
    N::of(distance(&steps(terms, at), clear).copysign(value.rounded()))
}

/// How much the terms of each degree of the Taylor expansion change per power of the distance.
fn steps(terms: &[Term], at: [f64; 3]) -> Vec<f64> {
    let mut gradient = [0.0; 3];
    let mut sums: Vec<f64> = Vec::new();
    let highest = terms.iter().map(|(_, p)| p.iter().sum::<usize>()).max();
    let side = highest.unwrap_or(0) + 1;
    let mut expanded = vec![0.0; side * side * side];
    for (c, powers) in terms {
        for i in 0..=powers[0] {
            let x = c * choose(powers[0], i) * at[0].powi((powers[0] - i) as i32);
            for j in 0..=powers[1] {
                let y = x * choose(powers[1], j) * at[1].powi((powers[1] - j) as i32);
                for k in 0..=powers[2] {
                    let z = y * choose(powers[2], k) * at[2].powi((powers[2] - k) as i32);
                    expanded[(i * side + j) * side + k] += z;
                }
            }
        }
    }
    sums.resize(side, 0.0);
    for i in 0..side {
        for j in 0..side - i {
            for k in 0..side - i - j {
                let c = expanded[(i * side + j) * side + k];
                match i + j + k {
                    0 => {}
                    1 => gradient[j + 2 * k] = c,
                    n => sums[n] += c.abs(),
                }
            }
        }
    }
    if let Some(first) = sums.get_mut(1) {
        *first = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    }
    sums
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64)
}

/// The distance at which the steps add up to `change`.
fn distance(steps: &[f64], change: f64) -> f64 {
    let alone = steps.iter().enumerate().skip(1).filter(|(_, s)| **s > 0.0);
    let alone = alone.map(|(n, step)| libm::pow(change / step, 1.0 / n as f64));
    let mut m = alone.fold(1e300, f64::min);
    for _ in 0..40 {
        // Newton's method from above stays above.
        let (mut sum, mut slope) = (0.0, 0.0);
        for &step in steps.iter().skip(1).rev() {
            slope = slope * m + (sum + step);
            sum = (sum + step) * m;
        }
        let next = m - (sum - change) / slope;
        if next.is_nan() || next >= m * (1.0 - 1e-12) {
            break;
        }
        m = next;
    }
    m * (1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clearance_is_not_beyond_the_surface() {
        let terms = terms(&Primitive::Quadric(QuadricForm::OneSheet)).expect("a quadric");
        // From the axis the waist is 1 away.
        let from_axis = clearance(&terms, [0.0, 0.0, 0.0]);
        assert!((-1.0..-0.5).contains(&from_axis), "{from_axis}");
        let beyond = clearance(&terms, [3.0, 0.0, 0.0]);
        assert!(beyond > 0.8 && beyond < 2.0, "{beyond}");
        assert_eq!(clearance(&terms, [1.0, 0.0, 0.0]), 0.0);
    }
}
