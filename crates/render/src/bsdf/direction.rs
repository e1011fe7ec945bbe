//! Where mirrored and refracted light goes.

use octray_math::DVec3;

/// The mirrored direction; `normal` has unit length, the result the length of `direction`.
#[must_use]
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// The mirrored direction that surely leaves the surface.
///
/// An interpolated normal can send the mirrored ray below the true surface; it is then turned
/// back by mirroring it once more, at the true surface. Both normals have unit length and point
/// to the viewer's side.
#[must_use]
pub fn reflect_above(direction: DVec3, shading_normal: DVec3, normal: DVec3) -> DVec3 {
    if shading_normal == normal {
        return reflect(direction, normal);
    }
    let mirrored = reflect(direction, shading_normal);
    if mirrored.dot(normal) >= 0.0 {
        mirrored
    } else if mirrored.dot(shading_normal) < 0.0 {
        reflect(direction, normal)
    } else {
        reflect(mirrored, normal)
    }
}

/// The refracted direction by Snell's law, or `None` at total internal reflection.
///
/// `direction` and `normal` have unit length, `normal` points to the side the light comes from;
/// `eta` is the index on that side divided by the index behind. With `eta = 1` the direction is
/// returned as it is.
#[must_use]
pub fn refract(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    if eta == 1.0 {
        return Some(direction);
    }
    let cos_i = -direction.dot(normal);
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i).max(0.0);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some(direction * eta + normal * (eta * cos_i - cos_t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_obeys_snell() {
        let normal = DVec3::Z;
        for (from, to) in [(1.0_f64, 1.5_f64), (1.5, 1.0), (1.33, 1.5)] {
            for step in 0..89 {
                let angle = f64::from(step).to_radians();
                let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
                let sin_t = from / to * angle.sin();
                match refract(direction, normal, from / to) {
                    Some(bent) => {
                        assert!((bent.length() - 1.0).abs() < 1e-12);
                        assert!((bent.x - sin_t).abs() < 1e-12);
                        assert!(bent.z < 0.0 && bent.y == 0.0);
                    }
                    None => assert!(sin_t >= 1.0),
                }
            }
        }
    }

    #[test]
    fn reflection_keeps_the_tangent_and_turns_the_normal_part() {
        let d = DVec3::new(0.6, 0.0, -0.8);
        assert!((reflect(d, DVec3::Z) - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
    }

    #[test]
    fn a_mirrored_ray_never_goes_below_the_surface() {
        let normal = DVec3::Z;
        for tilt in -60..=60 {
            let t = f64::from(tilt).to_radians();
            let shading = DVec3::new(t.sin(), 0.0, t.cos());
            for step in 1..180 {
                let a = f64::from(step).to_radians();
                let d = DVec3::new(a.cos(), 0.0, -a.sin());
                assert!(
                    reflect_above(d, shading, normal).z >= -1e-12,
                    "{tilt} {step}"
                );
            }
        }
    }
}
