//! Lights: one class for each kind, `Light` for all of them.

use octray::math::DVec3;
use octray::scene::{self, Falloff, LightKind, SceneBuilder};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::{color, value_error, vector};

/// A light without extent.
#[pyclass(frozen, subclass, module = "octray")]
#[derive(Clone, Debug)]
pub(crate) struct Light {
    inner: scene::Light,
}

impl Light {
    pub(crate) const fn inner(&self) -> &scene::Light {
        &self.inner
    }

    fn checked(
        kind: LightKind,
        tint: Option<&Bound<'_, PyAny>>,
        strength: f64,
        falloff: &str,
        shadows: bool,
    ) -> PyResult<Self> {
        let rgb = tint.map_or(Ok(DVec3::ONE), |c| color("color", c))?;
        let inner = scene::Light {
            falloff: match falloff {
                "none" => Falloff::None,
                "inverse_square" => Falloff::InverseSquare,
                _ => {
                    return Err(PyValueError::new_err(format!(
                        "falloff must be \"none\" or \"inverse_square\", not {falloff:?}"
                    )));
                }
            },
            casts_shadows: shadows,
            ..scene::Light::new(kind, rgb * strength)
        };
        let mut builder = SceneBuilder::new();
        builder.add_light(inner.clone());
        match builder.build() {
            Ok(_) => Ok(Self { inner }),
            Err(errors) => Err(value_error(&errors[0])),
        }
    }
}

fn unit(what: &str, v: DVec3) -> PyResult<DVec3> {
    v.try_normalize()
        .ok_or_else(|| PyValueError::new_err(format!("{what} must be finite and not zero")))
}

/// A light that shines from a point in all directions.
#[pyclass(frozen, extends = Light, module = "octray")]
#[derive(Debug)]
pub(crate) struct PointLight;

#[pymethods]
impl PointLight {
    #[new]
    #[pyo3(signature = (
        position, color = None, *, strength = 1.0, falloff = "none", shadows = true
    ))]
    fn new(
        position: &Bound<'_, PyAny>,
        color: Option<&Bound<'_, PyAny>>,
        strength: f64,
        falloff: &str,
        shadows: bool,
    ) -> PyResult<PyClassInitializer<Self>> {
        let position = vector("position", position)?;
        let kind = LightKind::Point { position };
        Ok(
            PyClassInitializer::from(Light::checked(kind, color, strength, falloff, shadows)?)
                .add_subclass(Self),
        )
    }
}

/// A light that shines from a point in a cone about the line to `target`.
#[pyclass(frozen, extends = Light, module = "octray")]
#[derive(Debug)]
pub(crate) struct SpotLight;

#[pymethods]
impl SpotLight {
    #[new]
    #[pyo3(signature = (
        position, target, color = None, *, inner = 20.0, outer = 30.0, tightness = 0.0,
        strength = 1.0, falloff = "none", shadows = true
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "all but the first three by keyword"
    )]
    fn new(
        position: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        color: Option<&Bound<'_, PyAny>>,
        inner: f64,
        outer: f64,
        tightness: f64,
        strength: f64,
        falloff: &str,
        shadows: bool,
    ) -> PyResult<PyClassInitializer<Self>> {
        if !(0.0 <= inner && inner <= outer && outer <= 180.0) {
            return Err(PyValueError::new_err(format!(
                "the half angles must be 0 <= inner <= outer <= 180 degrees, not {inner} and {outer}"
            )));
        }
        let position = vector("position", position)?;
        let direction = unit("target - position", vector("target", target)? - position)?;
        let kind = LightKind::Spot {
            position,
            direction,
            inner: inner.to_radians(),
            outer: outer.to_radians(),
            tightness,
        };
        Ok(
            PyClassInitializer::from(Light::checked(kind, color, strength, falloff, shadows)?)
                .add_subclass(Self),
        )
    }
}

/// Light from infinitely far that travels along `direction`.
#[pyclass(frozen, extends = Light, module = "octray")]
#[derive(Debug)]
pub(crate) struct DirectionalLight;

#[pymethods]
impl DirectionalLight {
    #[new]
    #[pyo3(signature = (direction, color = None, *, strength = 1.0, shadows = true))]
    fn new(
        direction: &Bound<'_, PyAny>,
        color: Option<&Bound<'_, PyAny>>,
        strength: f64,
        shadows: bool,
    ) -> PyResult<PyClassInitializer<Self>> {
        let direction = unit("direction", vector("direction", direction)?)?;
        let kind = LightKind::Directional { direction };
        Ok(
            PyClassInitializer::from(Light::checked(kind, color, strength, "none", shadows)?)
                .add_subclass(Self),
        )
    }
}
