//! `camera { ... }`.

use octray_math::{DAffine3, DVec3};
use octray_scene::{Camera, Projection};

use super::reader::{Parsed, Reader};
use super::value::Value;
use crate::Span;

/// A camera as it is being read; the defaults are POV-Ray's.
#[derive(Clone, Copy, Debug)]
pub(super) struct CameraState {
    projection: Projection,
    location: DVec3,
    direction: DVec3,
    right: DVec3,
    up: DVec3,
    sky: DVec3,
    look_at: Option<DVec3>,
    /// Horizontal, in degrees.
    angle: Option<f64>,
    /// `right` or `up` was made from the size of the picture.
    from_image_size: bool,
    /// A kind that is not supported; its angle may be wider than a perspective can show.
    substitute: bool,
    world_from_camera: DAffine3,
}

impl Default for CameraState {
    fn default() -> Self {
        Self {
            projection: Projection::Perspective,
            location: DVec3::ZERO,
            direction: DVec3::Z,
            right: DVec3::new(1.33, 0.0, 0.0),
            up: DVec3::Y,
            sky: DVec3::Y,
            look_at: None,
            angle: None,
            from_image_size: false,
            substitute: false,
            world_from_camera: DAffine3::IDENTITY,
        }
    }
}

impl Reader<'_> {
    /// `{ ... }` behind `camera`.
    pub(super) fn camera_block(&mut self) -> Parsed<CameraState> {
        let mut made = CameraState::default();
        self.block("camera", |r| {
            if let Some(map) = r.transform_item()? {
                made.world_from_camera = map * made.world_from_camera;
                return Ok(());
            }
            r.camera_item(&mut made)
        })?;
        Ok(made)
    }

    fn camera_item(&mut self, made: &mut CameraState) -> Parsed<()> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            return self.unexpected("a camera");
        };
        if CAMERA_WORDS.contains(&&*word) {
            self.next();
        }
        match &*word {
            "location" => made.location = self.vector()?,
            "direction" => made.direction = self.vector()?,
            "right" | "up" => {
                self.read_image_size = false;
                let axis = self.vector()?;
                if &*word == "right" {
                    made.right = axis;
                } else {
                    made.up = axis;
                }
                made.from_image_size |= self.read_image_size;
            }
            "sky" => made.sky = self.vector()?,
            "look_at" => made.look_at = Some(self.vector()?),
            "angle" => {
                let angle = self.float()?;
                self.comma();
                made.angle = Some(angle);
            }
            "perspective" => made.projection = Projection::Perspective,
            "orthographic" => made.projection = Projection::Orthographic,
            "fisheye" | "ultra_wide_angle" | "omnimax" | "panoramic" | "spherical"
            | "mesh_camera" => {
                let message =
                    format!("the camera `{word}` is not supported: a perspective one is taken");
                self.warn(token.span, message);
                made.substitute = true;
            }
            "cylinder" => {
                made.substitute = true;
                self.float()?;
                self.warn(
                    token.span,
                    "the cylindrical camera is not supported: a perspective one is taken",
                );
            }
            "aperture" => {
                if self.float()? != 0.0 {
                    self.warn(
                        token.span,
                        "focal blur is not supported: everything is sharp",
                    );
                }
            }
            "focal_point" | "blur_samples" | "confidence" | "variance" => {
                self.terms()?;
                if self.at(",") {
                    self.next();
                    self.terms()?;
                }
            }
            "bokeh" | "normal" => {
                self.warn(token.span, format!("`{word}` of a camera is not supported"));
                self.skip_block()?;
            }
            _ => match self.reference()? {
                Value::Camera(camera) => *made = *camera,
                Value::Unknown | Value::Ignored(_) => {}
                other => {
                    let message = format!("expected a camera, found {}", other.describe());
                    return self.fail(token.span, message);
                }
            },
        }
        Ok(())
    }

    /// The camera of the scene; `None`, with an error, where it cannot be.
    pub(super) fn made_camera(&mut self, state: &CameraState, span: Span) -> Option<Camera> {
        let made = state.camera();
        if let Err(message) = &made {
            let _ = self.fail::<()>(span, *message);
        }
        made.ok()
    }
}

impl CameraState {
    fn camera(&self) -> Result<Camera, &'static str> {
        let [mut direction, mut right, mut up] = [self.direction, self.right, self.up];
        if let Some(target) = self.look_at {
            let view = (target - self.location)
                .try_normalize()
                .ok_or("the camera looks at the point where it stands")?;
            // The lengths and the handedness are kept; the directions follow from the sky.
            let left_handed = up.cross(direction).dot(right) > 0.0;
            let side = self
                .sky
                .cross(view)
                .try_normalize()
                .ok_or("the camera looks along its `sky`")?;
            up = view.cross(side) * up.length();
            right = side
                * if left_handed {
                    right.length()
                } else {
                    -right.length()
                };
            direction = view * direction.length();
        }
        if let Some(angle) = self.angle {
            let angle = if self.substitute {
                angle.min(120.0)
            } else {
                angle
            };
            if !(angle > 0.0 && angle < 180.0) {
                return Err("the camera's angle must lie between 0 and 180 degrees");
            }
            let half = libm::tan(0.5 * angle.to_radians());
            match self.projection {
                Projection::Perspective => {
                    direction = direction.normalize_or_zero() * (0.5 * right.length() / half);
                }
                Projection::Orthographic => {
                    // As wide as the perspective view is at the point looked at.
                    let distance = self.look_at.map_or(direction.length(), |target| {
                        (target - self.location).length()
                    });
                    let factor = 2.0 * half * distance / right.length();
                    (right, up) = (right * factor, up * factor);
                }
            }
        }
        if self.from_image_size {
            right *= super::IMAGE_SIZE.1 / super::IMAGE_SIZE.0;
        }
        let frame = self.world_from_camera;
        let [forward, right, up] = [direction, right, up].map(|v| frame.transform_vector3(v));
        let flat = forward
            .normalize_or_zero()
            .cross(right.normalize_or_zero())
            .dot(up.normalize_or_zero());
        if flat.is_nan() || flat.abs() < 1e-9 {
            return Err("the camera's direction, right and up lie in one plane");
        }
        Ok(Camera {
            projection: self.projection,
            eye: frame.transform_point3(self.location),
            forward,
            right,
            up,
            fit_aspect: self.from_image_size,
        })
    }
}

const CAMERA_WORDS: [&str; 23] = [
    "location",
    "direction",
    "right",
    "up",
    "sky",
    "look_at",
    "angle",
    "perspective",
    "orthographic",
    "fisheye",
    "ultra_wide_angle",
    "omnimax",
    "panoramic",
    "spherical",
    "mesh_camera",
    "cylinder",
    "aperture",
    "focal_point",
    "blur_samples",
    "confidence",
    "variance",
    "bokeh",
    "normal",
];
