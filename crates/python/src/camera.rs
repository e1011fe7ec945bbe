//! Cameras.

use octray::import::dress;
use octray::math::DVec3;
use octray::scene::{self, Projection, SceneBuilder};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::{Triple, vector};

/// Where a picture is taken from.
#[pyclass(frozen, eq, module = "octray")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Camera {
    inner: scene::Camera,
}

impl Camera {
    pub(crate) const fn new(inner: scene::Camera) -> Self {
        Self { inner }
    }

    pub(crate) const fn inner(&self) -> &scene::Camera {
        &self.inner
    }
}

/// The three points of a view, checked so far that a message can say what is wrong.
fn points(
    eye: &Bound<'_, PyAny>,
    target: Option<&Bound<'_, PyAny>>,
    up: Option<&Bound<'_, PyAny>>,
) -> PyResult<(DVec3, DVec3, DVec3)> {
    let eye = vector("eye", eye)?;
    let target = target.map_or(Ok(DVec3::ZERO), |t| vector("target", t))?;
    let up = up.map_or(Ok(DVec3::Z), |u| vector("up", u))?;
    let problem = if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
        "eye, target and up must be finite"
    } else if eye == target {
        "eye and target must be different points"
    } else if (target - eye).cross(up) == DVec3::ZERO {
        "up must not be zero or point along the view"
    } else {
        return Ok((eye, target, up));
    };
    Err(PyValueError::new_err(problem))
}

/// A camera that a scene accepts.
fn checked(camera: Option<scene::Camera>) -> PyResult<Camera> {
    let valid = camera.filter(|camera| {
        let mut builder = SceneBuilder::new();
        builder.set_camera(*camera);
        builder.build().is_ok()
    });
    valid
        .map(Camera::new)
        .ok_or_else(|| PyValueError::new_err("eye, target and up span no picture"))
}

/// A camera in front of a scene that sees everything.
pub(crate) fn view_all(scene: &scene::Scene) -> PyResult<Camera> {
    looking(dress::view_scene(scene))
}

/// A parallel projection of everything in a scene, from the side of this name.
pub(crate) fn view_from(scene: &scene::Scene, name: &str) -> PyResult<Camera> {
    let Some((_, side)) = dress::Side::ALL.iter().find(|(known, _)| *known == name) else {
        let names = dress::Side::ALL.map(|(name, _)| name).join(", ");
        return Err(PyValueError::new_err(format!(
            "a scene is viewed from one of {names}, not {name:?}"
        )));
    };
    looking(dress::view_from(scene, *side))
}

fn looking(camera: Option<scene::Camera>) -> PyResult<Camera> {
    camera
        .map(Camera::new)
        .ok_or_else(|| PyValueError::new_err("there is nothing bounded in the scene to look at"))
}

#[pymethods]
impl Camera {
    /// A pinhole at `eye` with `target` in the middle; `fov` is the vertical angle in degrees.
    #[staticmethod]
    #[pyo3(signature = (eye, target = None, up = None, fov = 40.0))]
    fn look_at(
        eye: &Bound<'_, PyAny>,
        target: Option<&Bound<'_, PyAny>>,
        up: Option<&Bound<'_, PyAny>>,
        fov: f64,
    ) -> PyResult<Self> {
        if !(fov > 0.0 && fov < 180.0) {
            return Err(PyValueError::new_err(format!(
                "fov must be between 0 and 180 degrees, not {fov}"
            )));
        }
        let (eye, target, up) = points(eye, target, up)?;
        checked(scene::Camera::look_at(eye, target, up, fov.to_radians()))
    }

    /// A parallel projection whose picture is `height` units of the scene high.
    #[staticmethod]
    #[pyo3(signature = (eye, target = None, up = None, *, height))]
    fn orthographic(
        eye: &Bound<'_, PyAny>,
        target: Option<&Bound<'_, PyAny>>,
        up: Option<&Bound<'_, PyAny>>,
        height: f64,
    ) -> PyResult<Self> {
        if !(height > 0.0 && height.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "height must be finite and greater than 0, not {height}"
            )));
        }
        let (eye, target, up) = points(eye, target, up)?;
        checked(scene::Camera::orthographic(eye, target, up, height))
    }

    /// Where the camera stands.
    #[getter]
    fn eye(&self) -> Triple {
        self.inner.eye.into()
    }

    fn __repr__(&self) -> String {
        let kind = match self.inner.projection {
            Projection::Perspective => "perspective",
            Projection::Orthographic => "orthographic",
        };
        let [x, y, z] = self.inner.eye.to_array();
        format!("<octray.Camera {kind} at ({x}, {y}, {z})>")
    }
}
