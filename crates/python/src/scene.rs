//! The scene: a builder that Python code adds to.

use octray::math::DVec3;
use octray::scene::{
    self, Background, Color, ColorStop, MaterialId, Object, SceneBuilder, SceneError,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::camera::Camera;
use crate::convert::{color, number_or_color, vector};
use crate::diagnostics::{Diagnostic, invalid_scene};
use crate::light::Light;
use crate::material::material;
use crate::solid::Solid;

/// Objects, lights, a camera and a background.
#[pyclass(module = "octray")]
#[derive(Debug, Default)]
pub(crate) struct Scene {
    builder: SceneBuilder,
    diagnostics: Vec<Diagnostic>,
    /// A scene file keeps the lights it has, or its darkness.
    imported: bool,
    /// Counts the changes, so that a world made meanwhile is known to be stale.
    revision: u64,
    prepared: Option<Prepared>,
}

impl Scene {
    pub(crate) fn imported(scene: scene::Scene, diagnostics: Vec<Diagnostic>) -> Self {
        Self {
            builder: scene.into_builder(),
            diagnostics,
            imported: true,
            ..Self::default()
        }
    }

    /// The scene as it stands, validated, with what a picture needs and it lacks.
    pub(crate) fn complete(&self, py: Python<'_>) -> PyResult<scene::Scene> {
        let built = self.builder.clone().build();
        let plain = built.map_err(|errors: Vec<SceneError>| invalid_scene(py, &errors))?;
        Ok(completed(plain, !self.imported))
    }

    pub(crate) fn settings(&self) -> &Settings {
        self.builder.so_far().settings()
    }

    pub(crate) fn own_camera(&self) -> Option<scene::Camera> {
        self.builder.so_far().camera().copied()
    }

    pub(crate) const fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn prepared(&self, accel: Accel) -> Option<&Prepared> {
        self.prepared.as_ref().filter(|p| p.accel == accel)
    }

    pub(crate) fn keep(&mut self, prepared: Prepared) {
        self.prepared = Some(prepared);
    }

    fn material_id(&mut self, wanted: scene::Material) -> MaterialId {
        let known = self.builder.so_far().materials();
        match known.iter().position(|m| *m == wanted) {
            Some(index) => MaterialId(index as u32),
            None => self.builder.add_material(wanted),
        }
    }

    /// The builder, for a change that a world made before does not know of.
    fn changed(&mut self) -> &mut SceneBuilder {
        self.revision += 1;
        self.prepared = None;
        &mut self.builder
    }

    fn add_named(&mut self, mut object: Object, common: &Common<'_, '_>) -> PyResult<u32> {
        if let Some(name) = common.name {
            name.clone_into(&mut object.name);
        } else if object.name.is_empty() {
            object.name = format!("object {}", self.builder.so_far().objects().len());
        }
        if let Some(given) = common.material.filter(|m| !m.is_none()) {
            object.material = self.material_id(material(given)?);
        }
        object.priority = common.priority;
        object.casts_shadows = common.shadows;
        Ok(self.changed().add_object(object).0)
    }
}

#[pymethods]
impl Scene {
    /// An empty scene; `units` is the unit of length, for reports.
    #[new]
    #[pyo3(signature = (*, units = "", up = None))]
    fn new(units: &str, up: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut scene = Self::default();
        scene.builder.settings_mut().units = units.to_owned();
        if let Some(up) = up {
            let direction = vector("up", up)?.try_normalize();
            scene.builder.settings_mut().up =
                direction.ok_or_else(|| PyValueError::new_err("up must be finite and not zero"))?;
        }
        Ok(scene)
    }

    /// Adds a solid; returns the object's id, which queries report.
    #[pyo3(signature = (solid, *, name = None, material = None, priority = 0, shadows = true))]
    fn add(
        &mut self,
        solid: &Bound<'_, PyAny>,
        name: Option<&str>,
        material: Option<&Bound<'_, PyAny>>,
        priority: i32,
        shadows: bool,
    ) -> PyResult<u32> {
        let solid = solid.cast::<Solid>().map_err(|_| {
            PyTypeError::new_err(
                "expected a solid; meshes are added with add_mesh, lights with add_light",
            )
        })?;
        let id = self.material_id(dress::default_material());
        let object = Object::solid("", solid.get().inner().clone(), id);
        let common = Common {
            name,
            material,
            priority,
            shadows,
        };
        self.add_named(object, &common)
    }

    /// Adds a mesh: the path of a mesh file, a pair (vertices, faces), or anything that has
    /// `.vertices` and `.faces`. With `solid` its inside is filled, and it must be closed.
    /// Returns the object's id; the objects of a file that holds several follow one another.
    #[pyo3(signature = (
        mesh, *, name = None, material = None, solid = false, priority = 0, shadows = true
    ))]
    #[expect(clippy::too_many_arguments, reason = "all but the first by keyword")]
    fn add_mesh(
        &mut self,
        mesh: &Bound<'_, PyAny>,
        name: Option<&str>,
        material: Option<&Bound<'_, PyAny>>,
        solid: bool,
        priority: i32,
        shadows: bool,
    ) -> PyResult<u32> {
        let common = Common {
            name,
            material,
            priority,
            shadows,
        };
        let parts = mesh::parts(mesh)?;
        self.diagnostics.extend(parts.diagnostics);
        let mut first = None;
        for part in parts.meshes {
            let ids: Vec<MaterialId> = part
                .materials
                .into_iter()
                .map(|m| self.material_id(m))
                .collect();
            let (triangles, material) = part.mesh.with_ids(&ids, common.material.is_some())?;
            let material = material.unwrap_or_else(|| self.material_id(dress::default_material()));
            let object = if solid {
                let filled = octray::geometry::Solid::mesh(triangles).map_err(value_error)?;
                Object::solid(part.name, filled, material)
            } else {
                Object::sheet(part.name, Sheet::mesh(triangles), material)
            };
            let id = self.add_named(object, &common)?;
            first.get_or_insert(id);
        }
        first.ok_or_else(|| PyValueError::new_err("the file has no mesh in it"))
    }

    /// Adds a light.
    fn add_light(&mut self, light: &Light) {
        self.changed().add_light(light.inner().clone());
    }

    /// The camera, or `None`: then a good place is chosen when the picture is taken.
    #[getter]
    fn camera(&self) -> Option<Camera> {
        self.builder.so_far().camera().copied().map(Camera::new)
    }

    #[setter]
    fn set_camera(&mut self, camera: &Camera) {
        self.changed().set_camera(*camera.inner());
    }

    /// What rays see that meet nothing: a colour, or a list of colours from straight down to
    /// straight up.
    #[setter]
    fn set_background(&mut self, background: &Bound<'_, PyAny>) -> PyResult<()> {
        let finite = |c: DVec3| {
            if c.is_finite() {
                Ok(c)
            } else {
                Err(PyValueError::new_err("background: colours must be finite"))
            }
        };
        let background = match number_or_color("background", background).and_then(finite) {
            Ok(rgb) => Background::Uniform(rgb),
            Err(error) => {
                let colors: Option<Vec<DVec3>> = background.try_iter().ok().and_then(|items| {
                    items
                        .map(|item| color("background", &item?).and_then(finite))
                        .collect::<PyResult<_>>()
                        .ok()
                });
                let stops = colors.filter(|c| c.len() >= 2).ok_or(error)?;
                let last = (stops.len() - 1) as f64;
                let stop = |(i, c): (usize, &DVec3)| ColorStop {
                    position: i as f64 / last,
                    color: Color::rgb(c.x, c.y, c.z),
                };
                Background::Gradient {
                    axis: self.builder.so_far().settings().up,
                    map: stops.iter().enumerate().map(stop).collect(),
                }
            }
        };
        self.changed().set_background(background);
        Ok(())
    }

    /// The names of the objects; an object's id is an index into it.
    #[getter]
    fn names(&self) -> Vec<&str> {
        let objects = self.builder.so_far().objects();
        objects.iter().map(|o| o.name.as_str()).collect()
    }

    /// The box around all bounded objects as (lowest corner, highest corner), or `None`.
    #[getter]
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let bounds = self.builder.so_far().bounds();
        (!bounds.is_empty()).then(|| (bounds.min.to_array(), bounds.max.to_array()))
    }

    /// What the importer said about the file that this scene came from.
    #[getter]
    fn diagnostics(&self) -> Vec<Diagnostic> {
        self.diagnostics.clone()
    }

    /// Everything in the scene as plain dictionaries, lists and numbers, ready for JSON.
    fn describe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        crate::describe::scene(py, self.builder.so_far())
    }

    fn __len__(&self) -> usize {
        self.builder.so_far().objects().len()
    }

    fn __repr__(&self) -> String {
        let scene = self.builder.so_far();
        format!(
            "<octray.Scene of {} objects, {} lights>",
            scene.objects().len(),
            scene.lights().len()
        )
    }
}
