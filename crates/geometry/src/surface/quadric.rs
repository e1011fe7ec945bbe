//! The quadrics that are neither sphere nor circular cylinder, each in the affine frame in which
//! its coefficients are 1, -1 and 0.

use octray_math::roots::SignChanges;
use octray_math::{DVec3, roots};

use super::Side;
use super::local_box::{LocalBox, decide};

/// Which quadric; the negative side is where its function is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadricForm {
    /// `x^2 + y^2 - z^2 - 1`: the hyperboloid of one sheet, negative round the axis.
    OneSheet,
    /// `x^2 + y^2 - z^2 + 1`: the hyperboloid of two sheets, negative inside both.
    TwoSheets,
    /// `x^2 + y^2 - z^2`: the double cone, negative inside both nappes.
    DoubleCone,
    /// `x^2 + y^2 - z`.
    EllipticParaboloid,
    /// `x^2 - y^2 - z`: the saddle.
    HyperbolicParaboloid,
    /// `x^2 - y^2 - 1`: negative between the two sheets.
    HyperbolicCylinder,
    /// `x^2 - z`.
    ParabolicCylinder,
}

impl QuadricForm {
    /// Coefficients of the squares, of z, and the constant.
    pub(super) const fn coefficients(self) -> (DVec3, f64, f64) {
        match self {
            Self::OneSheet => (DVec3::new(1.0, 1.0, -1.0), 0.0, -1.0),
            Self::TwoSheets => (DVec3::new(1.0, 1.0, -1.0), 0.0, 1.0),
            Self::DoubleCone => (DVec3::new(1.0, 1.0, -1.0), 0.0, 0.0),
            Self::EllipticParaboloid => (DVec3::new(1.0, 1.0, 0.0), -1.0, 0.0),
            Self::HyperbolicParaboloid => (DVec3::new(1.0, -1.0, 0.0), -1.0, 0.0),
            Self::HyperbolicCylinder => (DVec3::new(1.0, -1.0, 0.0), 0.0, -1.0),
            Self::ParabolicCylinder => (DVec3::X, -1.0, 0.0),
        }
    }

    /// 1 for the coordinates that occur.
    const fn occurring(self) -> DVec3 {
        match self {
            Self::HyperbolicCylinder => DVec3::new(1.0, 1.0, 0.0),
            Self::ParabolicCylinder => DVec3::new(1.0, 0.0, 1.0),
            _ => DVec3::ONE,
        }
    }
}

pub(super) fn crossings(form: QuadricForm, o: DVec3, d: DVec3) -> SignChanges {
    let (squares, linear, constant) = form.coefficients();
    let across = d * form.occurring();
    let shift = -o.dot(across) / across.length_squared();
    // Along the axis of a cylinder nothing changes.
    let shift = if shift.is_finite() { shift } else { 0.0 };
    let p = o + d * shift;
    let a = (squares * d).dot(d);
    let b = (squares * p).dot(d) + 0.5 * linear * d.z;
    let c = (squares * p).dot(p) + linear * p.z + constant;
    roots::quadratic(a, b, c).moved(shift, 1.0)
}

pub(super) fn classify(form: QuadricForm, local: &LocalBox) -> Side {
    let (squares, linear, constant) = form.coefficients();
    let (plus, minus) = (squares.max(DVec3::ZERO), (-squares).max(DVec3::ZERO));
    let c = local.center;
    let value = (squares * c).dot(c) + linear * c.z + constant;
    let slope = local.linear(squares * c * 2.0 + DVec3::Z * linear);
    let (near, far) = local.absolute_range();
    let (near, far) = (near * near, far * far);
    let height = linear * c.z + constant;
    let reach = linear.abs() * local.reach.z;
    let low = (plus.dot(near) - minus.dot(far) + height - reach)
        .max(value - slope - local.quadratic(minus));
    let high = (plus.dot(far) - minus.dot(near) + height + reach)
        .min(value + slope + local.quadratic(plus));
    let used = form.occurring();
    let magnitude = 1.0 + ((c * used).length_squared() + (local.reach * used).length_squared());
    decide(low, high, magnitude)
}

pub(super) fn gradient(form: QuadricForm, p: DVec3) -> DVec3 {
    let (squares, linear, _) = form.coefficients();
    squares * p * 2.0 + DVec3::Z * linear
}
