//! The unit sphere and the unit cylinder about z: `|W x|^2 = 1` for a diagonal `W` of ones and zeros.

use octray_math::DVec3;
use octray_math::roots::SignChanges;

use super::Side;
use super::local_box::{LocalBox, decide};

pub(super) const SPHERE: DVec3 = DVec3::ONE;
pub(super) const CYLINDER: DVec3 = DVec3::new(1.0, 1.0, 0.0);

pub(super) fn sphere(o: DVec3, d: DVec3) -> SignChanges {
    let a = d.length_squared();
    let shift = -o.dot(d) / a;
    let near = o + d * shift;
    symmetric(shift, a, near.length_squared() - 1.0)
}

pub(super) fn cylinder(o: DVec3, d: DVec3) -> SignChanges {
    let a = d.x * d.x + d.y * d.y;
    let shift = -(o.x * d.x + o.y * d.y) / a;
    if !shift.is_finite() {
        // Along the axis: inside or outside for good.
        return SignChanges::none(o.x * o.x + o.y * o.y < 1.0);
    }
    let (x, y) = (o.x + d.x * shift, o.y + d.y * shift);
    symmetric(shift, a, x * x + y * y - 1.0)
}

/// `|p|^2 < 1` on a line, given `p . d = 0` at `t = 0` after a shift: `a t^2 + c` with
/// `a = d . d > 0`, symmetric about the shift.
fn symmetric(shift: f64, a: f64, c: f64) -> SignChanges {
    let half_squared = -c / a;
    if half_squared > 0.0 && half_squared.is_finite() {
        let half = half_squared.sqrt();
        SignChanges::two(false, shift - half, shift + half)
    } else {
        SignChanges::none(false)
    }
}

pub(super) fn classify(weights: DVec3, local: &LocalBox) -> Side {
    let magnitude = local.center.length_squared() + local.reach.length_squared() + 1.0;
    let (near, far) = local.absolute_range();
    // Most are decided by the box around.
    let low = (near * weights).length_squared() - 1.0;
    let high = (far * weights).length_squared() - 1.0;
    let side = decide(low, high, magnitude);
    if side != Side::Both {
        return side;
    }
    let center = local.center * weights;
    let value = center.length_squared() - 1.0;
    let linear = local.linear(center * 2.0);
    decide(
        value - linear,
        value + linear + local.quadratic(weights),
        magnitude,
    )
}
