//! Objects with their materials into a scene.

use octray::geometry::MeshRule;
use octray::import::dress;
use octray::scene::{self, MaterialId, Object, Shape};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::material::material;
use crate::mesh;
use crate::scene::Scene;

/// What is said about an object of any kind.
pub(crate) struct Common<'a, 'py> {
    pub(crate) name: Option<&'a str>,
    pub(crate) material: Option<&'a Bound<'py, PyAny>>,
    pub(crate) priority: i32,
    pub(crate) shadows: bool,
}

impl Scene {
    fn material_id(&mut self, wanted: scene::Material) -> MaterialId {
        let known = self.so_far().materials();
        match known.iter().position(|m| *m == wanted) {
            Some(index) => MaterialId(index as u32),
            None => self.changed().add_material(wanted),
        }
    }

    /// Adds an object of any kind; returns its id.
    pub(crate) fn add_shape(
        &mut self,
        shape: Shape,
        name: &str,
        material: MaterialId,
        common: &Common<'_, '_>,
    ) -> u32 {
        let name = match common.name.unwrap_or(name) {
            "" => format!("object {}", self.so_far().objects().len()).into(),
            name => name.into(),
        };
        let object = Object {
            name,
            shape,
            material,
            priority: common.priority,
            casts_shadows: common.shadows,
        };
        self.changed().add_object(object).0
    }

    /// Adds a mesh, filled if there is a rule for that, that stands alone (`look` is `None`) or in a file with materials of its own.
    pub(crate) fn adopt(
        &mut self,
        shape: &Shape,
        name: &str,
        look: Option<(&[scene::Material], MaterialId)>,
        filled: Option<MeshRule>,
        common: &Common<'_, '_>,
    ) -> PyResult<u32> {
        let placed = mesh::Placed::of(shape).ok_or_else(|| {
            PyValueError::new_err(format!(
                "`{name}` is no mesh; octray.load reads files of solids"
            ))
        })?;
        let given = common.material.map(|m| self.wanted_material(Some(m)));
        let (placed, material) = match (given.transpose()?, look) {
            (Some(id), _) => (placed.with_ids(|_| id)?, id),
            (None, Some((materials, own))) => {
                let ids = self.adopted(materials);
                let new = |old: MaterialId| ids[old.0 as usize];
                (placed.with_ids(new)?, new(own))
            }
            (None, None) => (placed, self.wanted_material(None)?),
        };
        Ok(self.add_shape(placed.shape(filled)?, name, material, common))
    }

    /// The ids that a file's materials get here.
    pub(crate) fn adopted(&mut self, materials: &[scene::Material]) -> Vec<MaterialId> {
        let own = materials.iter().map(|m| self.material_id(m.clone()));
        own.collect()
    }

    /// The material of an argument, or the usual one.
    pub(crate) fn wanted_material(
        &mut self,
        given: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<MaterialId> {
        let wanted = match given {
            Some(object) => material(object)?,
            None => dress::default_material(),
        };
        Ok(self.material_id(wanted))
    }
}
