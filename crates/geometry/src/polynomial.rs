//! Polynomials in x, y and z: the functions whose zeros are algebraic surfaces.

use octray_math::DVec3;
use octray_math::roots::{MAX_DEGREE, SignChangeList, sign_changes};

use crate::ShapeError;

/// A polynomial of degree 1 to [`MAX_DEGREE`] in three variables.
///
/// Its coefficients are in the order that POV-Ray's `poly` has: by falling power of x, then of y,
/// then of z. So those of a quadratic belong to x², xy, xz, x, y², yz, y, z², z, 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    degree: usize,
    coefficients: Vec<f64>,
}

/// What a sum of products of coordinates can be computed in.
trait Sum: Copy {
    /// A coordinate.
    type Factor;
    const ZERO: Self;
    fn plus_constant(self, constant: f64) -> Self;
    fn plus(self, other: &Self) -> Self;
    fn times(self, factor: &Self::Factor) -> Self;
}

impl Sum for f64 {
    type Factor = Self;
    const ZERO: Self = 0.0;

    fn plus_constant(self, constant: f64) -> Self {
        self + constant
    }

    fn plus(self, other: &Self) -> Self {
        self + other
    }

    fn times(self, factor: &Self) -> Self {
        self * factor
    }
}

/// A polynomial of the line's parameter with `N` coefficients, lowest first.
#[derive(Clone, Copy)]
struct OnLine<const N: usize>([f64; N]);

impl<const N: usize> Sum for OnLine<N> {
    /// `p + d t`.
    type Factor = [f64; 2];
    const ZERO: Self = Self([0.0; N]);

    fn plus_constant(mut self, constant: f64) -> Self {
        self.0[0] += constant;
        self
    }

    fn plus(mut self, other: &Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a += b;
        }
        self
    }

    fn times(mut self, [p, d]: &[f64; 2]) -> Self {
        // The highest coefficient is 0 before: sums are multiplied as often as they have degrees.
        let mut below = 0.0;
        for c in &mut self.0 {
            (*c, below) = (*c * p + below * d, *c);
        }
        self
    }
}

/// Value, gradient and second derivatives (xx, yy, zz; yz, zx, xy).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) gradient: DVec3,
    pub(crate) squares: DVec3,
    pub(crate) mixed: DVec3,
}

impl Sum for Jet {
    /// A coordinate and which it is.
    type Factor = (f64, usize);
    const ZERO: Self = Self {
        value: 0.0,
        gradient: DVec3::ZERO,
        squares: DVec3::ZERO,
        mixed: DVec3::ZERO,
    };

    fn plus_constant(mut self, constant: f64) -> Self {
        self.value += constant;
        self
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            squares: self.squares + other.squares,
            mixed: self.mixed + other.mixed,
        }
    }

    fn times(self, &(x, axis): &(f64, usize)) -> Self {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut product = Self {
            value: self.value * x,
            gradient: self.gradient * x,
            squares: self.squares * x,
            mixed: self.mixed * x,
        };
        product.gradient[axis] += self.value;
        product.squares[axis] += 2.0 * self.gradient[axis];
        product.mixed[next] += self.gradient[last];
        product.mixed[last] += self.gradient[next];
        product
    }
}

/// How many coefficients a polynomial of this degree in three variables has.
const fn term_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) * (degree + 3) / 6
}

/// The powers of x, y and z to which the coefficients belong, in order.
pub(crate) fn powers(degree: usize) -> impl Iterator<Item = [usize; 3]> {
    let of_yz = |i: usize| (0..=i).flat_map(move |j| (0..=j).map(move |k| [i - j, j - k]));
    (0..=degree).flat_map(move |i| of_yz(i).map(move |[y, z]| [degree - i, y, z]))
}

impl Polynomial {
    /// From all coefficients in order, of which there are `(n + 1)(n + 2)(n + 3) / 6` for degree
    /// `n`: 10 for a quadratic, 20 for a cubic, 35 for a quartic.
    ///
    /// # Errors
    /// The degree is 0 or above [`MAX_DEGREE`], the number of coefficients is another, or one is
    /// not finite.
    pub fn new(degree: usize, coefficients: &[f64]) -> Result<Self, ShapeError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(ShapeError::BadDegree(degree));
        }
        if coefficients.len() != term_count(degree) {
            return Err(ShapeError::CoefficientCount {
                given: coefficients.len(),
                degree,
                expected: term_count(degree),
            });
        }
        let largest = coefficients.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        if let Some(&value) = coefficients.iter().find(|c| !c.is_finite()) {
            return Err(ShapeError::NotFinite {
                what: "coefficient",
                value,
            });
        }
        let terms = || powers(degree).zip(coefficients);
        let used = terms().filter(|(_, c)| **c != 0.0);
        let degree = used.map(|(p, _)| p.iter().sum()).max().unwrap_or(0).max(1);
        // By a power of two, so that neither huge nor tiny ones overflow: only signs matter.
        let exponent = if largest > 0.0 {
            -libm::ilogb(largest)
        } else {
            0
        };
        let scaled = terms()
            .filter(|(p, _)| p.iter().sum::<usize>() <= degree)
            .map(|(_, &c)| libm::ldexp(c, exponent))
            .collect();
        Ok(Self {
            degree,
            coefficients: scaled,
        })
    }

    /// The highest sum of powers with a coefficient that is not 0, at least 1.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// The coefficients, scaled by a power of two so that the largest lies between 1 and 2.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Horner's scheme in three variables.
    fn sum<S: Sum>(&self, [x, y, z]: &[S::Factor; 3], term: impl Fn(f64) -> f64) -> S {
        let mut terms = self.coefficients.iter();
        let mut whole = S::ZERO;
        for i in 0..=self.degree {
            let mut of_yz = S::ZERO;
            for j in 0..=i {
                let mut of_z = S::ZERO;
                for k in 0..=j {
                    if k > 0 {
                        of_z = of_z.times(z);
                    }
                    of_z = of_z.plus_constant(terms.next().map_or(0.0, |&c| term(c)));
                }
                of_yz = if j > 0 { of_yz.times(y) } else { of_yz }.plus(&of_z);
            }
            whole = if i > 0 { whole.times(x) } else { whole }.plus(&of_yz);
        }
        whole
    }

    /// The value at a point.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        self.sum::<f64>(&p.to_array(), |c| c)
    }

    /// Where the sign changes on the line `p + t d`.
    pub(crate) fn crossings(&self, p: DVec3, d: DVec3) -> SignChangeList {
        let factors = [[p.x, d.x], [p.y, d.y], [p.z, d.z]];
        if self.degree <= 4 {
            let line = self.sum::<OnLine<5>>(&factors, |c| c).0;
            sign_changes(&line[..=self.degree])
        } else {
            let line = self.sum::<OnLine<{ MAX_DEGREE + 1 }>>(&factors, |c| c).0;
            sign_changes(&line[..=self.degree])
        }
    }

    /// Value and derivatives at a point.
    pub(crate) fn jet(&self, p: DVec3) -> Jet {
        self.sum::<Jet>(&[(p.x, 0), (p.y, 1), (p.z, 2)], |c| c)
    }

    /// The same with every coefficient and coordinate replaced by its absolute value: bounds what
    /// each derivative is made of.
    pub(crate) fn majorant(&self, p: DVec3) -> Jet {
        let p = p.abs();
        self.sum::<Jet>(&[(p.x, 0), (p.y, 1), (p.z, 2)], f64::abs)
    }

    pub(crate) fn majorant_value(&self, p: DVec3) -> f64 {
        self.sum::<f64>(&p.abs().to_array(), f64::abs)
    }
}
