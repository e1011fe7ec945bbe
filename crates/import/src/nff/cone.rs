//! Cylinders and cones without end caps.

use octray_geometry::{ShapeError, Sheet, Solid};
use octray_math::{DAffine3, DVec3};

/// The lateral surface between two circles about the line from `base` to `apex`.
///
/// # Errors
/// Base and apex coincide, a radius is negative, or both are 0.
pub(super) fn open_cone(base: DVec3, r0: f64, apex: DVec3, r1: f64) -> Result<Sheet, ShapeError> {
    let height = (apex - base).length();
    let axis = (apex - base).try_normalize();
    let axis = axis.ok_or(ShapeError::ZeroVector { what: "axis" })?;
    // A capped solid that reaches a little further than the sheet at both ends, so that its caps
    // are clipped away; towards the tip of a cone at most half way.
    let reach = height / 16.0;
    let slope = (r1 - r0) / height;
    let tip = |radius: f64, outward: f64| {
        // Distance to the tip on this side, if the cone narrows there.
        if outward < 0.0 {
            0.5 * radius / -outward
        } else {
            f64::INFINITY
        }
    };
    let below = reach.min(tip(r0, -slope));
    let above = reach.min(tip(r1, slope));
    let solid = Solid::cone(
        (r0 - slope * below).max(0.0),
        (r1 + slope * above).max(0.0),
        -below,
        height + above,
    )?;
    let clip = Solid::intersection([
        Solid::half_space(DVec3::NEG_Z, 0.0)?,
        Solid::half_space(DVec3::Z, height)?,
    ]);
    let (x, y) = axis.any_orthonormal_pair();
    Sheet::Shell { solid, clip }.transform(DAffine3::from_cols(x, y, axis, base))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_little_larger_than_the_surface() {
        let tip = open_cone(DVec3::ZERO, 1.0, DVec3::Z * 2.0, 0.0).expect("a cone");
        let bounds = tip.bounds();
        assert!(bounds.max.z == 2.0 && bounds.min.z == -0.125, "{bounds:?}");
        assert!((bounds.max.x - 1.0625).abs() < 1e-12);
        let flat = open_cone(DVec3::ONE, 1.0, DVec3::ONE, 1.0);
        assert!(matches!(flat, Err(ShapeError::ZeroVector { .. })));
        assert!(open_cone(DVec3::ZERO, 0.0, DVec3::X, 0.0).is_err());
    }
}
