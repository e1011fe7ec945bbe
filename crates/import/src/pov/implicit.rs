//! Shapes that are formulas: quadrics, polynomials and superellipsoids.

use octray_geometry::{Polynomial, Solid};

use super::object::Geometry;
use super::reader::{Parsed, Reader};
use crate::Span;

/// The highest order that the language has.
const MAX_ORDER: usize = 35;

/// How many coefficients a polynomial in three variables of this order has.
const fn coefficient_count(order: usize) -> usize {
    (order + 1) * (order + 2) * (order + 3) / 6
}

impl Reader<'_> {
    /// `<A, B, C>, <D, E, F>, <G, H, I>, J`: inside is `A x^2 + B y^2 + C z^2 + D xy + E xz + F yz +
    /// G x + H y + I z + J < 0`.
    pub(super) fn quadric(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut coefficients = [0.0; 10];
        for first in [0, 3, 6] {
            let three = self.vector()?.to_array();
            coefficients[first..first + 3].copy_from_slice(&three);
            self.comma();
        }
        coefficients[9] = self.float()?;
        let made = Solid::quadric(coefficients).map(Geometry::Solid);
        Ok(self.usable("quadric", span, made))
    }

    /// `<e, n>`.
    pub(super) fn superellipsoid(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let exponents = self.terms()?.promoted(2).v;
        let made = Solid::superellipsoid(exponents[0], exponents[1]).map(Geometry::Solid);
        Ok(self.usable("superellipsoid", span, made))
    }

    /// All coefficients in order: `cubic { <20 numbers> }`, `quartic { <35> }`, `poly { order, <...> }`.
    pub(super) fn poly(&mut self, word: &str, span: Span) -> Parsed<Option<Geometry>> {
        let order = match word {
            "cubic" => 3,
            "quartic" => 4,
            _ => self.order()?,
        };
        let expected = coefficient_count(order);
        let open = self.expect("<")?;
        let mut coefficients = Vec::new();
        while !self.eat(">") {
            coefficients.push(self.float()?);
            if coefficients.len() > expected {
                let message = format!("a polynomial of order {order} has {expected} coefficients");
                return self.fail(open.span.to(self.last), message);
            }
            self.comma();
        }
        if coefficients.len() < expected {
            let given = coefficients.len();
            let message =
                format!("a polynomial of order {order} has {expected} coefficients, not {given}");
            return self.fail(open.span.to(self.last), message);
        }
        Ok(self.polynomial_solid(word, span, order, &coefficients))
    }

    /// `order, xyz(i, j, k): value, ...`: the coefficients that are not 0.
    pub(super) fn polynomial(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let order = self.order()?;
        let mut coefficients = vec![0.0; coefficient_count(order)];
        while self.eat_word("xyz") {
            let open = self.expect("(")?;
            let mut powers = [0; 3];
            for (axis, power) in powers.iter_mut().enumerate() {
                if axis > 0 {
                    self.comma();
                }
                *power = self.whole(0..=order, "a power")?;
            }
            self.expect(")")?;
            self.expect(":")?;
            let value = self.float()?;
            self.comma();
            let [i, j, k] = powers;
            if i + j + k > order {
                let message = format!("these powers sum up to more than the order {order}");
                return self.fail(open.span.to(self.last), message);
            }
            // By falling power of x, then of y, then of z.
            let (without_x, without_xy) = (order - i, order - i - j);
            let before_x = without_x * (without_x + 1) * (without_x + 2) / 6;
            let before_y = without_xy * (without_xy + 1) / 2;
            coefficients[before_x + before_y + without_xy - k] = value;
        }
        Ok(self.polynomial_solid("polynomial", span, order, &coefficients))
    }

    fn polynomial_solid(
        &mut self,
        word: &str,
        span: Span,
        order: usize,
        coefficients: &[f64],
    ) -> Option<Geometry> {
        let made = Polynomial::new(order, coefficients)
            .and_then(Solid::polynomial)
            .map(Geometry::Solid);
        self.usable(word, span, made)
    }

    fn order(&mut self) -> Parsed<usize> {
        let order = self.whole(2..=MAX_ORDER, "the order of a polynomial")?;
        self.comma();
        Ok(order)
    }

    /// A whole number in a range.
    fn whole(&mut self, range: std::ops::RangeInclusive<usize>, what: &str) -> Parsed<usize> {
        let start = self.peek().span;
        let value = self.float()?;
        let (low, high) = (*range.start(), *range.end());
        if value.fract() != 0.0 || !(low as f64..=high as f64).contains(&value) {
            let message =
                format!("{what} must be a whole number from {low} to {high}, not {value}");
            return self.fail(start.to(self.last), message);
        }
        Ok(value as usize)
    }
}
