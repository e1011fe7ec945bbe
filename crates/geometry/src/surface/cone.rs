//! The double cone `x^2 + y^2 = (1 + slope z)^2`.

use octray_math::roots::SignChanges;
use octray_math::{DVec3, roots};

use super::Side;
use super::local_box::{LocalBox, decide};

pub(super) fn crossings(slope: f64, o: DVec3, d: DVec3) -> SignChanges {
    let shift = -o.dot(d) / d.length_squared();
    let p = o + d * shift;
    let (radius, growth) = (1.0 + slope * p.z, slope * d.z);
    let a = d.x * d.x + d.y * d.y - growth * growth;
    let b = p.x * d.x + p.y * d.y - radius * growth;
    let rho = (p.x * p.x + p.y * p.y).sqrt();
    let c = (rho - radius) * (rho + radius);
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
