//! The double cone `x^2 + y^2 = (1 + slope z)^2`.

use octray_math::roots::SignChanges;
use octray_math::{DVec3, roots};

use super::Side;
use super::local_box::{LocalBox, decide};

/// With the radius as third coordinate the surface is `x^2 + y^2 = r^2` with its apex at the
/// origin, however far away that is in space. From the point of the line nearest to it, all three
/// coefficients are as small as the line is near: a line that passes the apex closely keeps its
/// digits, and one through it only touches.
pub(super) fn crossings(slope: f64, o: DVec3, d: DVec3) -> SignChanges {
    let origin = DVec3::new(o.x, o.y, 1.0 + slope * o.z);
    let v = DVec3::new(d.x, d.y, slope * d.z);
    let shift = -origin.dot(v) / v.length_squared();
    let apart = |rho: f64, radius: f64| (rho - radius) * (rho + radius);
    let across = |p: DVec3| (p.x * p.x + p.y * p.y).sqrt();
    if !shift.is_finite() {
        // Along the axis of a cone that is a cylinder as far as the line goes.
        return SignChanges::none(apart(across(origin), origin.z) < 0.0);
    }
    let p = origin + v * shift;
    let a = apart(across(v), v.z);
    let b = p.x * v.x + p.y * v.y - p.z * v.z;
    let c = apart(across(p), p.z);
    roots::quadratic(a, b, c).moved(shift, 1.0)
}

pub(super) fn classify(slope: f64, local: &LocalBox) -> Side {
    let (near, far) = local.absolute_range();
    let c = local.center;
    let radius = 1.0 + slope * c.z;
    let growth = (slope * local.reach.z).abs();
    let (least, most) = ((radius.abs() - growth).max(0.0), radius.abs() + growth);
    let value = c.x * c.x + c.y * c.y - radius * radius;
    let linear = local.linear(DVec3::new(c.x, c.y, -slope * radius) * 2.0);
    let across = DVec3::new(1.0, 1.0, 0.0);
    let low = ((near * across).length_squared() - most * most)
        .max(value - linear - local.quadratic(DVec3::Z * slope));
    let high = ((far * across).length_squared() - least * least)
        .min(value + linear + local.quadratic(across));
    // The height enters the radius with its own rounding.
    let height = slope * (c.z.abs() + local.reach.z);
    let magnitude = c.length_squared() + local.reach.length_squared() + height * height + 1.0;
    decide(low, high, magnitude)
}

pub(super) fn gradient(slope: f64, p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.y, -slope * (1.0 + slope * p.z))
}
