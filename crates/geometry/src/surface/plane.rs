//! Planes, in world coordinates.

use octray_math::roots::SignChanges;
use octray_math::{Aabb, DVec3, Ray};

use super::Side;
use super::local_box::decide;

pub(super) fn crossings(normal: DVec3, offset: f64, ray: &Ray) -> SignChanges {
    let height = normal.dot(ray.origin) - offset;
    let slope = normal.dot(ray.direction);
    let t = -height / slope;
    if slope == 0.0 || !t.is_finite() {
        return SignChanges::none(height < 0.0);
    }
    SignChanges::one(slope > 0.0, t)
}

pub(super) fn classify(normal: DVec3, offset: f64, bounds: &Aabb) -> Side {
    let (center, half) = (bounds.center(), bounds.half_size());
    let height = normal.dot(center) - offset;
    let reach = normal.abs().dot(half);
    let magnitude = normal.abs().dot(center.abs()) + offset.abs() + reach;
    decide(height - reach, height + reach, magnitude)
}
