//! Solids given by a formula: quadrics, polynomials, superellipsoids.

mod bounds;
mod quadric;

use std::sync::Arc;

use octray_math::Aabb;

use crate::polynomial::powers;
use crate::{Polynomial, Primitive, ShapeError, Solid};

/// The exponents that superellipsoids are computed for.
const EXPONENTS: [f64; 2] = [1e-6, 1e3];

impl Solid {
    /// The points where `c0 x^2 + c1 y^2 + c2 z^2 + c3 xy + c4 xz + c5 yz + c6 x + c7 y + c8 z + c9`
    /// is negative: an ellipsoid, hyperboloid, paraboloid, cylinder, cone, pair of planes, half-space,
    /// nothing or everything.
    ///
    /// A sphere, cylinder or plane that is written this way is the same as any other: surfaces that
    /// coincide are recognised.
    ///
    /// # Errors
    /// A coefficient is not finite.
    pub fn quadric(coefficients: [f64; 10]) -> Result<Self, ShapeError> {
        quadric::solid(coefficients)
    }

    /// The points where a polynomial is negative: of degree 3 or 4, a cubic or quartic solid.
    /// Bounded or not: intersect it with a box where only a part of it is meant. Where the terms of
    /// the highest degree alone make it positive far away, as for a torus, a box round it is found.
    ///
    /// # Errors
    /// The polynomial is that of a plane too far away for its distance to be a number.
    pub fn polynomial(polynomial: Polynomial) -> Result<Self, ShapeError> {
        if polynomial.degree() > 2 {
            let bounds = bounds::of_negative_points(&polynomial);
            if bounds.is_empty() {
                return Ok(Self::empty());
            }
            return Ok(Self::polynomial_within(polynomial, bounds));
        }
        let mut quadric = [0.0; 10];
        for (powers, &c) in powers(polynomial.degree()).zip(polynomial.coefficients()) {
            let place = match powers {
                [2, 0, 0] => 0,
                [0, 2, 0] => 1,
                [0, 0, 2] => 2,
                [1, 1, 0] => 3,
                [1, 0, 1] => 4,
                [0, 1, 1] => 5,
                [1, 0, 0] => 6,
                [0, 1, 0] => 7,
                [0, 0, 1] => 8,
                _ => 9,
            };
            quadric[place] = c;
        }
        Self::quadric(quadric)
    }

    /// Like [`Solid::polynomial`], where the box is known to hold all its points.
    fn polynomial_within(polynomial: Polynomial, bounds: Aabb) -> Self {
        Self::primitive(Primitive::Polynomial {
            polynomial: Arc::new(polynomial),
            bounds,
        })
    }

    /// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) <= 1` (Barr, *Superquadrics and Angle-Preserving
    /// Transformations*, 1981): a ball for `e = n = 1`, a box towards 0, an octahedron for 2,
    /// pinched above.
    ///
    /// # Errors
    /// An exponent lies outside of 1e-6 to 1000.
    pub fn superellipsoid(e: f64, n: f64) -> Result<Self, ShapeError> {
        let [low, high] = EXPONENTS;
        for (what, value) in [("exponent e", e), ("exponent n", n)] {
            if !(low..=high).contains(&value) {
                return Err(ShapeError::OutOfRange {
                    what,
                    value,
                    low,
                    high,
                });
            }
        }
        if e == 1.0 && n == 1.0 {
            return Self::sphere(1.0);
        }
        let exponents = [e, n];
        Ok(Self::primitive(Primitive::Superellipsoid { exponents }))
    }
}
