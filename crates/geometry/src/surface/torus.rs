//! The torus of major radius 1 about z: `hypot(rho - 1, z) = minor`.

use octray_math::roots::SignChanges;
use octray_math::{DVec3, roots};

use super::Side;
use super::local_box::{LocalBox, decide};

/// In units of length along the line, with the origin at its closest approach to the centre, the
/// quartic has no cubic term. Its turning points separate its roots; the sign of the distance
/// `hypot(rho - 1, z) - minor`, which is accurate for thin tubes where the quartic is not, decides
/// in which pieces there is a root and where. The ends lie outside the bounding sphere, so the
/// number of sign changes is even. A spindle's quartic also vanishes on the inner lemon, where
/// the distance does not change sign: those roots only add pieces.
pub(super) fn crossings(minor: f64, o: DVec3, d: DVec3) -> SignChanges {
    let length = d.length();
    let unit = d / length;
    let closest = -o.dot(unit);
    let p = o + unit * closest;
    let reach = 1.0 + minor;
    let limit_squared = reach * reach - p.length_squared();
    if !matches!(
        limit_squared.partial_cmp(&0.0),
        Some(std::cmp::Ordering::Greater)
    ) {
        return SignChanges::none(false);
    }
    let limit = limit_squared.sqrt();
    let distance = |u: f64| {
        let (x, y, z) = (p.x + unit.x * u, p.y + unit.y * u, p.z + unit.z * u);
        let from_ring = (x * x + y * y).sqrt() - 1.0;
        // The squares differ only where the product does: no square root is needed for the sign.
        from_ring * from_ring + z * z - minor * minor
    };
    let k = p.length_squared() + 1.0 - minor * minor;
    let a2 = unit.x * unit.x + unit.y * unit.y;
    let b = p.x * unit.x + p.y * unit.y;
    let (turning, count) =
        roots::depressed_quartic_turning_points(2.0 * k - 4.0 * a2, -8.0 * b, limit);
    let mut knots = [-limit, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    knots[1..=count].copy_from_slice(&turning[..count]);
    let mut knot_count = count + 1;
    if minor >= 1.0 {
        // The distance of a spindle may turn inside the lemon, at the point nearest to the axis.
        let axis = -b / a2;
        if axis.abs() < limit {
            let at = knots[..knot_count].partition_point(|&u| u < axis);
            knots.copy_within(at..knot_count, at + 1);
            knots[at] = axis;
            knot_count += 1;
        }
    }
    knots[knot_count] = limit;
    let mut changes = SignChanges::none(false);
    let (mut u0, mut f0) = (knots[0], 1.0_f64);
    for (i, &u1) in knots.iter().enumerate().take(knot_count + 1).skip(1) {
        let f1 = if i == knot_count { 1.0 } else { distance(u1) };
        if (f0 < 0.0) != (f1 < 0.0) && changes.count < 4 {
            changes.t[changes.count] = roots::bracketed(distance, u0, u1, f0, f1);
            changes.count += 1;
        }
        (u0, f0) = (u1, f1);
    }
    // At most four changes are real; an odd count cannot happen because both ends are outside.
    changes.count &= !1;
    changes.moved(closest / length, 1.0 / length)
}

/// `hypot(rho - 1, z) - minor`, which changes by at most the distance moved.
pub(super) fn classify(minor: f64, local: &LocalBox) -> Side {
    let distance = |rho: f64, z: f64| {
        let from_ring = rho - 1.0;
        (from_ring * from_ring + z * z).sqrt() - minor
    };
    let c = local.center;
    let value = distance((c.x * c.x + c.y * c.y).sqrt(), c.z);
    let radius = local.quadratic(DVec3::ONE).sqrt();
    let (near, far) = local.absolute_range();
    let rho_near = (near.x * near.x + near.y * near.y).sqrt();
    let rho_far = (far.x * far.x + far.y * far.y).sqrt();
    let ring_near = 1.0_f64.clamp(rho_near, rho_far);
    let ring_far = if 1.0 - rho_near > rho_far - 1.0 {
        rho_near
    } else {
        rho_far
    };
    let low = distance(ring_near, near.z).max(value - radius);
    let high = distance(ring_far, far.z).min(value + radius);
    decide(low, high, 1.0 + minor + c.length() + radius)
}

/// Of the distance to the ring, not normalised.
pub(super) fn gradient(p: DVec3) -> DVec3 {
    let rho = (p.x * p.x + p.y * p.y).sqrt();
    let ring = if rho > 0.0 {
        DVec3::new(p.x / rho, p.y / rho, 0.0)
    } else {
        DVec3::X
    };
    p - ring
}
