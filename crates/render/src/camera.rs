//! Picture points to rays.

use octray_math::{DVec3, Ray};
use octray_scene::{Camera, Projection};

use crate::RenderError;

/// A scene camera fitted to a picture size: makes the primary rays.
#[derive(Clone, Copy, Debug)]
pub struct PrimaryRays {
    camera: Camera,
    size: (f64, f64),
}

impl PrimaryRays {
    /// The rays of a picture of `width x height` pixels, both positive.
    ///
    /// # Errors
    /// [`RenderError::BadCamera`] where the camera has a number that is not finite or axes that do
    /// not span space (only possible for cameras that no scene has validated).
    pub fn new(camera: &Camera, (width, height): (u32, u32)) -> Result<Self, RenderError> {
        let mut camera = *camera;
        let [forward, right, up] =
            [camera.forward, camera.right, camera.up].map(DVec3::normalize_or_zero);
        let spanned = forward.cross(right).dot(up).abs();
        // Written so that NaN fails.
        if !(camera.eye.is_finite() && spanned > 0.0 && spanned.is_finite()) {
            return Err(RenderError::BadCamera);
        }
        let size = (f64::from(width), f64::from(height));
        if camera.fit_aspect {
            camera.right *= size.0 / size.1;
        }
        let reach = camera.forward.abs() + camera.right.abs() + camera.up.abs();
        if !reach.length_squared().is_finite() {
            return Err(RenderError::BadCamera);
        }
        Ok(Self { camera, size })
    }

    /// The ray through `position` (in `[0, 1)^2`, from the top left) of the pixel `(x, y)`.
    #[must_use]
    pub fn ray(&self, (x, y): (u32, u32), position: (f64, f64)) -> Ray {
        let camera = &self.camera;
        let across = (f64::from(x) + position.0) / self.size.0 - 0.5;
        let upward = 0.5 - (f64::from(y) + position.1) / self.size.1;
        let offset = camera.right * across + camera.up * upward;
        match camera.projection {
            Projection::Perspective => Ray::new(camera.eye, camera.forward + offset),
            Projection::Orthographic => Ray::new(camera.eye + offset, camera.forward),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, 90.0_f64.to_radians()).expect("a camera")
    }

    #[test]
    fn the_middle_looks_forward_and_the_top_left_up_and_left() {
        let rays = PrimaryRays::new(&camera(), (200, 100)).expect("rays");
        let middle = rays.ray((100, 50), (0.0, 0.0));
        assert!((middle.direction - DVec3::X).length() < 1e-15);
        // 90 degrees high, twice as wide: the corner is at (1, 2, 1).
        let corner = rays.ray((0, 0), (0.0, 0.0));
        assert!((corner.direction - DVec3::new(1.0, 2.0, 1.0)).length() < 1e-12);
    }

    #[test]
    fn orthographic_rays_are_parallel() {
        let camera = Camera::orthographic(DVec3::ZERO, DVec3::X, DVec3::Z, 2.0).expect("a camera");
        let rays = PrimaryRays::new(&camera, (10, 10)).expect("rays");
        let corner = rays.ray((0, 0), (0.0, 0.0));
        assert!((corner.origin - DVec3::new(0.0, 1.0, 1.0)).length() < 1e-12);
        assert_eq!(corner.direction, rays.ray((9, 9), (0.5, 0.5)).direction);
    }

    #[test]
    fn flat_and_infinite_cameras_are_refused() {
        let flat = Camera {
            up: DVec3::X,
            ..camera()
        };
        assert!(PrimaryRays::new(&flat, (10, 10)).is_err());
        let lost = Camera {
            eye: DVec3::NAN,
            ..camera()
        };
        assert!(PrimaryRays::new(&lost, (10, 10)).is_err());
    }
}
