//! Materials.

use octray::math::{DAffine3, DVec3};
use octray::scene::{self, Color, Finish, Interior, Pattern, Pigment, Reflection, SceneBuilder};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::convert::{color, number_or_color, number_or_vector, value_error};

/// The look of a surface, and what fills the solid behind it (Whitted's model).
#[pyclass(frozen, eq, module = "octray")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Material {
    inner: scene::Material,
}

/// A material that a scene accepts; the first thing wrong with it otherwise.
fn checked(inner: scene::Material) -> PyResult<Material> {
    let mut builder = SceneBuilder::new();
    builder.add_material(inner.clone());
    match builder.build() {
        Ok(_) => Ok(Material { inner }),
        Err(errors) => Err(value_error(&errors[0])),
    }
}

/// The material of an argument: a `Material`, or a colour for a matte surface.
pub(crate) fn material(object: &Bound<'_, PyAny>) -> PyResult<scene::Material> {
    if let Ok(material) = object.cast::<Material>() {
        return Ok(material.get().inner.clone());
    }
    let rgb = color("material", object).map_err(|error| {
        if error.is_instance_of::<PyTypeError>(object.py()) {
            PyTypeError::new_err("material: expected a Material or a colour")
        } else {
            error
        }
    })?;
    checked(scene::Material::matte("matte", rgb)).map(|m| m.inner)
}

fn or<T>(
    given: Option<&Bound<'_, PyAny>>,
    default: T,
    convert: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
) -> PyResult<T> {
    given.map_or(Ok(default), convert)
}

#[pymethods]
impl Material {
    /// A material from its terms; what is left out is matte, opaque and light grey.
    #[new]
    #[pyo3(signature = (
        color = None, *, name = "material", ambient = None, emission = None, diffuse = 0.9,
        brilliance = 1.0, phong = 0.0, phong_size = 40.0, specular = 0.0, roughness = 0.05,
        metallic = 0.0, reflection = None, fresnel = false, filter = 0.0, transmit = 0.0,
        ior = 1.0, absorption = None
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "one for each term of the model, by keyword"
    )]
    fn new(
        color: Option<&Bound<'_, PyAny>>,
        name: &str,
        ambient: Option<&Bound<'_, PyAny>>,
        emission: Option<&Bound<'_, PyAny>>,
        diffuse: f64,
        brilliance: f64,
        phong: f64,
        phong_size: f64,
        specular: f64,
        roughness: f64,
        metallic: f64,
        reflection: Option<&Bound<'_, PyAny>>,
        fresnel: bool,
        filter: f64,
        transmit: f64,
        ior: f64,
        absorption: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let default = Finish::default();
        let rgb = or(color, DVec3::splat(0.8), |c| {
            crate::convert::color("color", c)
        })?;
        let mirror = or(reflection, DVec3::ZERO, |c| {
            number_or_color("reflection", c)
        })?;
        let reflection = if fresnel {
            Reflection {
                max: DVec3::ONE,
                fresnel: true,
                metallic,
                ..Reflection::constant(mirror)
            }
        } else {
            Reflection {
                metallic,
                ..Reflection::constant(mirror)
            }
        };
        checked(scene::Material {
            name: name.to_owned(),
            pigment: Pigment::Uniform(Color {
                rgb,
                filter,
                transmit,
            }),
            finish: Finish {
                ambient: or(ambient, default.ambient, |c| number_or_color("ambient", c))?,
                emission: or(emission, default.emission, |c| {
                    number_or_color("emission", c)
                })?,
                diffuse,
                brilliance,
                phong,
                phong_size,
                specular,
                roughness,
                metallic,
                reflection,
                conserve_energy: fresnel,
            },
            interior: Interior {
                ior,
                absorption: or(absorption, DVec3::ZERO, |c| {
                    number_or_color("absorption", c)
                })?,
                ..Interior::default()
            },
        })
    }

    /// A clear dielectric that reflects by Fresnel's equations and bends what it lets through.
    #[staticmethod]
    #[pyo3(signature = (ior = 1.5, *, absorption = None, name = "glass"))]
    fn glass(ior: f64, absorption: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Self> {
        let mut glass = scene::Material::glass(name, ior);
        glass.interior.absorption = or(absorption, DVec3::ZERO, |c| {
            number_or_color("absorption", c)
        })?;
        checked(glass)
    }

    /// A mirror of the given tint.
    #[staticmethod]
    #[pyo3(signature = (color = None, *, name = "mirror"))]
    fn mirror(color: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Self> {
        let rgb = or(color, DVec3::splat(0.9), |c| {
            crate::convert::color("color", c)
        })?;
        checked(scene::Material::mirror(name, rgb))
    }

    /// Cubes of two colours in turn, `size` wide (a number or three), matte.
    #[staticmethod]
    #[pyo3(signature = (first, second, size = None, *, reflection = None, name = "checker"))]
    fn checker(
        first: &Bound<'_, PyAny>,
        second: &Bound<'_, PyAny>,
        size: Option<&Bound<'_, PyAny>>,
        reflection: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> PyResult<Self> {
        let size = or(size, DVec3::ONE, |s| number_or_vector("size", s))?;
        if !(size.min_element() > 0.0 && size.is_finite()) {
            return Err(value_error("size must be finite and greater than 0"));
        }
        let uniform = |what, object| -> PyResult<Pigment> {
            let rgb = color(what, object)?;
            Ok(Pigment::Uniform(Color::rgb(rgb.x, rgb.y, rgb.z)))
        };
        let pair = [uniform("first", first)?, uniform("second", second)?];
        let mirror = or(reflection, DVec3::ZERO, |c| {
            number_or_color("reflection", c)
        })?;
        let mut checker = scene::Material::matte(name, DVec3::ONE);
        checker.pigment = Pigment::Pattern {
            pattern: Pattern::Checker(Box::new(pair)),
            pattern_from_world: DAffine3::from_scale(size.recip()),
        };
        checker.finish.reflection = Reflection::constant(mirror);
        checked(checker)
    }

    /// The name, for listings.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    fn __repr__(&self) -> String {
        format!("<octray.Material {:?}>", self.inner.name)
    }
}
