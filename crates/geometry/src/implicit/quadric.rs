//! What kind of quadric ten coefficients describe.
//!
//! The matrix of the squares is turned to its axes and the centre or vertex moved to the origin;
//! what is left is an affine image of one of a few forms. Matrices that are diagonal as given are
//! taken exactly; otherwise what is as small as the rounding of the coefficients counts as 0.

use octray_math::{Aabb, DAffine3, DMat3, DVec3, symmetric};

use crate::solid::finite;
use crate::surface::QuadricForm;
use crate::{Polynomial, Primitive, ShapeError, Solid};

/// Rounding of the coefficients and of the turn to the axes, relative to the largest.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// An axis may be this much longer than the others; beyond, a centre that is not at the origin would
/// take digits along, and the polynomial is kept as it is.
const LONGEST: f64 = 1024.0;

/// `sum of values[i] x_i^2 + slopes . x + constant` in the frame of `axes`.
#[derive(Clone, Copy)]
struct Turned {
    values: DVec3,
    axes: DMat3,
    slopes: DVec3,
    constant: f64,
}

pub(super) fn solid(coefficients: [f64; 10]) -> Result<Solid, ShapeError> {
    for value in coefficients {
        finite("coefficient", value)?;
    }
    let largest = coefficients.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let exponent = if largest > 0.0 {
        -libm::ilogb(largest)
    } else {
        0
    };
    let c = coefficients.map(|c| libm::ldexp(c, exponent));
    let [xx, yy, zz, xy, xz, yz, x, y, z, constant] = c;
    let linear = DVec3::new(x, y, z);
    let matrix = DMat3::from_cols(
        DVec3::new(xx, 0.5 * xy, 0.5 * xz),
        DVec3::new(0.5 * xy, yy, 0.5 * yz),
        DVec3::new(0.5 * xz, 0.5 * yz, zz),
    );
    if matrix == DMat3::ZERO {
        return flat(linear, constant);
    }
    let (mut values, axes) = symmetric::eigen(&matrix);
    let mut slopes = axes.transpose() * linear;
    if xy != 0.0 || xz != 0.0 || yz != 0.0 {
        let most = values.abs().max_element() * ROUNDING;
        let steep = linear.length() * ROUNDING;
        for axis in 0..3 {
            if values[axis].abs() <= most {
                values[axis] = 0.0;
                if slopes[axis].abs() <= steep {
                    slopes[axis] = 0.0;
                }
            }
        }
    }
    let turned = Turned {
        values,
        axes,
        slopes,
        constant,
    };
    let recognised = turned.recognised();
    if let Some(solid) = &recognised
        && turned.is_compact()
    {
        return Ok(solid.clone());
    }
    let ordered = [xx, xy, xz, x, yy, yz, y, zz, z, constant];
    let polynomial = Polynomial::new(2, &ordered)?;
    let bounds = recognised.map_or(Aabb::ALL, |solid| solid.bounds());
    let margin = 1e-6 * bounds.diagonal();
    let bounds = if bounds.is_empty() || !margin.is_finite() {
        Aabb::ALL
    } else {
        bounds.inflated(margin)
    };
    Ok(Solid::polynomial_within(polynomial, bounds))
}

/// Nothing, or everything.
fn constant_solid(everything: bool) -> Solid {
    if everything {
        Solid::empty().complement()
    } else {
        Solid::empty()
    }
}

/// `linear . x + constant < 0`.
fn flat(linear: DVec3, constant: f64) -> Result<Solid, ShapeError> {
    if linear == DVec3::ZERO {
        return Ok(constant_solid(constant < 0.0));
    }
    Solid::half_space(linear, -constant / linear.length())
}

impl Turned {
    /// The other side, eigenvalues in increasing order again.
    fn negated(&self) -> Self {
        let DMat3 {
            x_axis,
            y_axis,
            z_axis,
        } = self.axes;
        Self {
            values: -DVec3::new(self.values.z, self.values.y, self.values.x),
            axes: DMat3::from_cols(-z_axis, y_axis, x_axis),
            slopes: DVec3::new(self.slopes.z, -self.slopes.y, -self.slopes.x),
            constant: -self.constant,
        }
    }

    /// Whether the centre is not so far away along a long axis that it would take digits along.
    fn is_compact(&self) -> bool {
        let most = self.values.abs().max_element();
        (0..3).all(|i| {
            let value = self.values[i].abs();
            value == 0.0 || self.slopes[i] == 0.0 || value * (LONGEST * LONGEST) >= most
        })
    }

    /// `None` where the numbers do not allow a form of its own.
    fn recognised(&self) -> Option<Solid> {
        let count = |sign: f64| (0..3).filter(|&i| self.values[i] * sign > 0.0).count();
        let (plus, minus) = (count(1.0), count(-1.0));
        if minus > plus {
            return Some(self.negated().recognised()?.complement());
        }
        let (center, level, terms) = self.completed();
        let is_definite = minus == 0;
        // Between a cone and a hyperboloid with a waist of rounding there is no telling.
        let level = if !is_definite && level.abs() <= ROUNDING * terms {
            0.0
        } else {
            level
        };
        let [first, second, third] = [0, 1, 2].map(|i| self.axes.col(i));
        let value = self.values.abs();
        let length = |i: usize, numerator: f64| (numerator / value[i]).sqrt();
        match (plus, minus) {
            (3, 0) if level < 0.0 => {
                let [a, b, c] = [0, 1, 2].map(|i| length(i, -level));
                let frame = [first * a, second * b, third * c];
                Solid::sphere(1.0)
                    .ok()
                    .and_then(|s| self.placed(&s, frame, center))
            }
            (2, 0) if self.slopes.x == 0.0 && level < 0.0 => {
                let frame = [second * length(1, -level), third * length(2, -level), first];
                let cylinder = Solid::infinite_cylinder(1.0).ok()?;
                self.placed(&cylinder, frame, center)
            }
            (1, 0) if self.slopes.x == 0.0 && self.slopes.y == 0.0 && level < 0.0 => {
                let half = length(2, -level);
                let above = Solid::half_space(third, half + center.z).ok()?;
                let below = Solid::half_space(-third, half - center.z).ok()?;
                Some(Solid::intersection([above, below]))
            }
            (2, 1) => {
                let (form, size) = if level < 0.0 {
                    (QuadricForm::OneSheet, -level)
                } else if level > 0.0 {
                    (QuadricForm::TwoSheets, level)
                } else {
                    (QuadricForm::DoubleCone, value.max_element())
                };
                let [z, x, y] = [0, 1, 2].map(|i| length(i, size));
                self.form(form, [second * x, third * y, first * z], center)
            }
            (2, 0) if self.slopes.x != 0.0 => {
                let slope = self.slopes.x;
                let vertex = center.with_x(-level / slope);
                let unit = slope * slope / value.max_element();
                let frame = [
                    second * length(1, unit),
                    third * length(2, unit),
                    first * (-unit / slope),
                ];
                self.form(QuadricForm::EllipticParaboloid, frame, vertex)
            }
            (1, 1) if self.slopes.y != 0.0 => {
                let slope = self.slopes.y;
                let vertex = center.with_y(-level / slope);
                let unit = slope * slope / value.max_element();
                let frame = [
                    third * length(2, unit),
                    first * length(0, unit),
                    second * (-unit / slope),
                ];
                self.form(QuadricForm::HyperbolicParaboloid, frame, vertex)
            }
            (1, 1) if level > 0.0 => Some(self.negated().recognised()?.complement()),
            (1, 1) if level < 0.0 => {
                let frame = [third * length(2, -level), first * length(0, -level), second];
                self.form(QuadricForm::HyperbolicCylinder, frame, center)
            }
            (1, 1) => {
                let (x, y) = (third * value.z.sqrt(), first * value.x.sqrt());
                let point = self.axes * center;
                let half = |normal: DVec3| {
                    Solid::half_space(normal, normal.dot(point) / normal.length()).ok()
                };
                let (a, b) = (half(x - y)?, half(x + y)?);
                let only = |a: &Solid, b: &Solid| Solid::difference([a.clone(), b.clone()]);
                Some(Solid::union([only(&a, &b), only(&b, &a)]))
            }
            (1, 0) if self.slopes.x != 0.0 || self.slopes.y != 0.0 => {
                let slope = libm::hypot(self.slopes.x, self.slopes.y);
                let (along_x, along_y) = (self.slopes.x / slope, self.slopes.y / slope);
                let up = first * along_x + second * along_y;
                let back = -level / slope;
                let vertex = DVec3::new(along_x * back, along_y * back, center.z);
                let size = slope / value.z;
                let frame = [third * size, up.cross(third), up * -size];
                self.form(QuadricForm::ParabolicCylinder, frame, vertex)
            }
            _ => Some(Solid::empty()),
        }
    }

    /// Squares completed: the centre along the axes that have one, the constant that is left, and
    /// the sum of what it was made of.
    fn completed(&self) -> (DVec3, f64, f64) {
        let mut center = DVec3::ZERO;
        let (mut level, mut terms) = (self.constant, self.constant.abs());
        for i in 0..3 {
            if self.values[i] != 0.0 {
                center[i] = -0.5 * self.slopes[i] / self.values[i];
                let square = 0.5 * self.slopes[i] * center[i];
                level += square;
                terms += square.abs();
            }
        }
        (center, level, terms)
    }

    fn form(&self, form: QuadricForm, columns: [DVec3; 3], center: DVec3) -> Option<Solid> {
        let solid = Solid::primitive(Primitive::Quadric(form));
        self.placed(&solid, columns, center)
    }

    /// The columns are in the frame of the coefficients, the centre in that of the axes.
    fn placed(&self, solid: &Solid, columns: [DVec3; 3], center: DVec3) -> Option<Solid> {
        let [x, y, z] = columns;
        solid
            .transform(DAffine3::from_cols(x, y, z, self.axes * center))
            .ok()
    }
}

#[cfg(test)]
mod tests;
