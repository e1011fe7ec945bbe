//! Affine transforms, built the way the users' languages state them.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DAffine3, DMat3, DVec3};

/// Rotation about the fixed axes by degrees: first x, then y, then z.
///
/// Multiples of 90 degrees are exact, so that a turned box stays axis-aligned to the bit.
#[must_use]
pub fn rotation_xyz_degrees(degrees: DVec3) -> DAffine3 {
    rotation_degrees(DVec3::Z, degrees.z)
        * rotation_degrees(DVec3::Y, degrees.y)
        * rotation_degrees(DVec3::X, degrees.x)
}

/// Right-handed rotation about `axis` (any non-zero length) by `degrees` (Rodrigues' formula).
#[must_use]
pub fn rotation_degrees(axis: DVec3, degrees: f64) -> DAffine3 {
    let (sin, cos) = sin_cos_degrees(degrees);
    let k = axis.normalize();
    let cross = DMat3::from_cols(
        DVec3::new(0.0, k.z, -k.y),
        DVec3::new(-k.z, 0.0, k.x),
        DVec3::new(k.y, -k.x, 0.0),
    );
    let outer = DMat3::from_cols(k * k.x, k * k.y, k * k.z);
    DAffine3::from_mat3(DMat3::IDENTITY * cos + cross * sin + outer * (1.0 - cos))
}

/// Sine and cosine of an angle in degrees, exact to the last bit at multiples of 30 and 45.
///
/// Angles that mirror each other give the same bits up to sign: corners of a regular polygon lie
/// on exactly horizontal and vertical lines.
#[must_use]
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees % 360.0;
    if !turn.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    let size = turn.abs();
    // The cosine is the same on the upper half of the circle, its size also on the right of that.
    let half = if size > 180.0 { 360.0 - size } else { size };
    let acute = if half > 90.0 { 180.0 - half } else { half };
    let (sin, cos) = match acute {
        0.0 => (0.0, 1.0),
        30.0 => (0.5, 0.75_f64.sqrt()),
        45.0 => (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
        60.0 => (0.75_f64.sqrt(), 0.5),
        90.0 => (1.0, 0.0),
        _ if acute > 45.0 => {
            let (cos, sin) = libm::sincos((90.0 - acute).to_radians());
            (sin, cos)
        }
        _ => libm::sincos(acute.to_radians()),
    };
    let below = (turn < 0.0) != (size > 180.0);
    let sign = |negative: bool, x: f64| if negative && x != 0.0 { -x } else { x };
    (sign(below, sin), sign(half > 90.0, cos))
}

/// Reflection in the plane through the origin with this normal (any non-zero length).
#[must_use]
pub fn mirror(normal: DVec3) -> DAffine3 {
    let n = normal.normalize();
    let outer = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
    DAffine3::from_mat3(DMat3::IDENTITY - outer * 2.0)
}

/// Whether the transform is finite and can be inverted with at least a few good digits.
///
/// The determinant is compared with the product of the column lengths, so uniform scale, however
/// large or small, does not matter.
#[must_use]
pub fn is_invertible(transform: &DAffine3) -> bool {
    let m = transform.matrix3;
    if !transform.is_finite() {
        return false;
    }
    let volume = m
        .x_axis
        .normalize_or_zero()
        .cross(m.y_axis.normalize_or_zero());
    volume.dot(m.z_axis.normalize_or_zero()).abs() > 1e-12 && transform.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let m = rotation_xyz_degrees(DVec3::new(90.0, 0.0, -270.0));
        assert_eq!(m.transform_vector3(DVec3::Y), DVec3::Z);
        assert_eq!(m.transform_vector3(DVec3::X), DVec3::Y);
    }

    #[test]
    fn x_turns_before_y_before_z() {
        let m = rotation_xyz_degrees(DVec3::new(90.0, 90.0, 0.0));
        // y -> z by the turn about x, z -> x by the turn about y.
        assert_eq!(m.transform_vector3(DVec3::Y), DVec3::X);
    }

    #[test]
    fn mirrored_angles_have_the_same_bits() {
        for eighth in -5760..=5760 {
            let degrees = f64::from(eighth) / 8.0;
            let (sin, cos) = sin_cos_degrees(degrees);
            let (exact_sin, exact_cos) = degrees.to_radians().sin_cos();
            assert!((sin - exact_sin).abs() < 1e-14, "sin {degrees}");
            assert!((cos - exact_cos).abs() < 1e-14, "cos {degrees}");
            assert_eq!(sin_cos_degrees(180.0 - degrees), (sin, -cos), "{degrees}");
            assert_eq!(sin_cos_degrees(-degrees), (-sin, cos), "{degrees}");
        }
        assert_eq!(sin_cos_degrees(150.0).0, 0.5);
        assert_eq!(sin_cos_degrees(-240.0).1, -0.5);
        assert_eq!(sin_cos_degrees(45.0).0, sin_cos_degrees(45.0).1);
        assert!(sin_cos_degrees(f64::INFINITY).0.is_nan());
    }

    #[test]
    fn flat_transforms_are_refused_and_tiny_ones_are_not() {
        assert!(!is_invertible(&DAffine3::from_scale(DVec3::new(
            1.0, 0.0, 1.0
        ))));
        assert!(is_invertible(&DAffine3::from_scale(DVec3::splat(1e-30))));
        assert!(!is_invertible(&DAffine3::from_translation(DVec3::NAN)));
    }
}
