//! Triangle meshes from arrays, from anything that has them, and from files.

use std::path::PathBuf;
use std::sync::Arc;

use octray::geometry::{MeshRule, Primitive, Sheet, Solid, SolidNode, TriangleMesh};
use octray::import::polygon::Triangulator;
use octray::math::{DAffine3, DVec3};
use octray::scene::{MaterialId, Shape as ObjectShape};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::arrays::{Shape, integer_array, real_array};
use crate::convert::value_error;

/// What `add_mesh` is given.
pub(crate) enum Source {
    Arrays(Arc<TriangleMesh>),
    File(PathBuf),
}

impl Source {
    /// A path, a pair of arrays, or an object with `.vertices` and `.faces`.
    pub(crate) fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(path) = object.extract::<PathBuf>() {
            return Ok(Self::File(path));
        }
        let pair = is_pair(object)?;
        if pair {
            let (vertices, faces) = (object.get_item(0)?, object.get_item(1)?);
            return from_arrays(&vertices, &faces).map(Self::Arrays);
        }
        match (object.getattr("vertices"), object.getattr("faces")) {
            (Ok(vertices), Ok(faces)) => from_arrays(&vertices, &faces).map(Self::Arrays),
            _ => Err(PyTypeError::new_err(format!(
                "expected a path, a pair (vertices, faces), or an object that has both, not {}",
                object.get_type().name()?
            ))),
        }
    }

    /// Whether this names a mesh by itself: a path, a pair of arrays as a tuple, or an object with
    /// `.vertices` and `.faces`.
    pub(crate) fn is_whole(object: &Bound<'_, PyAny>) -> bool {
        let has = |name: &str| object.hasattr(name).unwrap_or(false);
        object.extract::<PathBuf>().is_ok()
            || (object.is_instance_of::<PyTuple>() && is_pair_of_arrays(object))
            || (has("vertices") && has("faces"))
    }
}

/// Whether it has two items.
fn is_pair(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    let pair = object.is_instance_of::<PyTuple>() || object.is_instance_of::<PyList>();
    Ok(pair && object.len()? == 2)
}

/// Whether it is a pair whose items have rows.
fn is_pair_of_arrays(object: &Bound<'_, PyAny>) -> bool {
    let has_rows = |i: usize| {
        let item = object.get_item(i).and_then(|item| item.get_item(0));
        item.is_ok_and(|row| row.len().is_ok())
    };
    is_pair(object).unwrap_or(false) && has_rows(0) && has_rows(1)
}

/// A mesh where it stands in the world.
pub(crate) struct Placed {
    pub(crate) mesh: Arc<TriangleMesh>,
    pub(crate) world_from_mesh: DAffine3,
    /// Whether it is the boundary of a solid already.
    pub(crate) solid: bool,
}

impl Placed {
    /// The mesh of an object, `None` for objects of another kind.
    pub(crate) fn of(shape: &ObjectShape) -> Option<Self> {
        match shape {
            ObjectShape::Sheet(Sheet::Mesh {
                mesh,
                world_from_mesh,
            }) => Some(Self {
                mesh: Arc::clone(mesh),
                world_from_mesh: **world_from_mesh,
                solid: false,
            }),
            ObjectShape::Solid(solid) => match solid.node() {
                SolidNode::Primitive(Primitive::Mesh(mesh)) => Some(Self {
                    mesh: Arc::clone(mesh),
                    world_from_mesh: DAffine3::IDENTITY,
                    solid: true,
                }),
                _ => None,
            },
            ObjectShape::Sheet(Sheet::Shell { .. }) | ObjectShape::Instances(_) => None,
        }
    }

    /// The same mesh with every triangle's material replaced by what `id` makes of it.
    pub(crate) fn with_ids(self, id: impl Fn(MaterialId) -> MaterialId) -> PyResult<Self> {
        let Some(materials) = self.mesh.materials() else {
            return Ok(self);
        };
        let materials = materials.iter().map(|&m| id(m)).collect();
        let mesh = TriangleMesh::clone(&self.mesh)
            .with_materials(materials)
            .map_err(value_error)?;
        Ok(Self {
            mesh: Arc::new(mesh),
            ..self
        })
    }

    /// Its shape, as a solid if there is a rule for that or if it was one.
    pub(crate) fn shape(&self, filled: Option<MeshRule>) -> PyResult<ObjectShape> {
        let mesh = Arc::clone(&self.mesh);
        // What came as a solid was taken by its winding number, and that was said.
        let was_solid = self.solid.then_some(MeshRule::Winding);
        if let Some(rule) = filled.or(was_solid) {
            let solid = Solid::mesh(mesh, rule).map_err(value_error)?;
            let placed = if self.world_from_mesh == DAffine3::IDENTITY {
                solid
            } else {
                solid.transform(self.world_from_mesh).map_err(value_error)?
            };
            return Ok(ObjectShape::Solid(placed));
        }
        Ok(ObjectShape::Sheet(Sheet::Mesh {
            mesh,
            world_from_mesh: Box::new(self.world_from_mesh),
        }))
    }
}

/// `"strict"` or `"winding"`.
pub(crate) fn rule(name: &str) -> PyResult<MeshRule> {
    match name {
        "strict" => Ok(MeshRule::Strict),
        "winding" => Ok(MeshRule::Winding),
        _ => Err(PyValueError::new_err(format!(
            "the rule for meshes as solids is \"strict\" or \"winding\", not {name:?}"
        ))),
    }
}

/// Whether and by what rule a mesh is filled: a boolean (true is strict) or the name of a rule.
pub(crate) fn filling(solid: &Bound<'_, PyAny>) -> PyResult<Option<MeshRule>> {
    if let Ok(name) = solid.extract::<String>() {
        return rule(&name).map(Some);
    }
    match solid.extract::<bool>() {
        Ok(filled) => Ok(filled.then_some(MeshRule::Strict)),
        Err(_) => Err(PyTypeError::new_err(format!(
            "solid must be a boolean, \"strict\" or \"winding\", not {}",
            solid.get_type().name()?
        ))),
    }
}

/// Vertices from an array of shape (N, 3).
pub(crate) fn positions(vertices: &Bound<'_, PyAny>) -> PyResult<Vec<DVec3>> {
    let array = real_array("vertices", vertices, Shape::rows("N", 3))?;
    let rows = array.as_slice()?.as_chunks::<3>().0;
    Ok(rows.iter().copied().map(DVec3::from_array).collect())
}

/// A mesh from vertices of shape (N, 3) and triangles of shape (M, 3).
pub(crate) fn from_arrays(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<Arc<TriangleMesh>> {
    let positions = positions(vertices)?;
    let faces = integer_array("faces", faces, Shape::rows("M", 3))?;
    let mut triangles = Vec::with_capacity(faces.as_slice()?.len() / 3);
    for (triangle, corners) in faces.as_slice()?.as_chunks::<3>().0.iter().enumerate() {
        let mut indices = [0; 3];
        for (index, &corner) in indices.iter_mut().zip(corners) {
            *index = u32::try_from(corner).map_err(|_| {
                PyValueError::new_err(format!(
                    "triangle {triangle} uses vertex {corner}, but there are only {}",
                    positions.len()
                ))
            })?;
        }
        triangles.push(indices);
    }
    TriangleMesh::new(positions, triangles)
        .map(Arc::new)
        .map_err(value_error)
}

/// A mesh whose faces are plane polygons.
pub(crate) fn triangulated(corners: Vec<DVec3>, faces: &[Vec<u32>]) -> PyResult<Arc<TriangleMesh>> {
    let mut triangulator = Triangulator::new();
    let mut triangles = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        let place = |&i: &u32| corners.get(i as usize).copied();
        let outline: Option<Vec<DVec3>> = face.iter().map(place).collect();
        let outline = outline.ok_or_else(|| {
            PyValueError::new_err(format!(
                "face {number} uses a corner that is not there: there are only {}",
                corners.len()
            ))
        })?;
        let split = triangulator.triangulate(&outline).map_err(value_error)?;
        triangles.extend(split.iter().map(|t| t.map(|i| face[i as usize])));
    }
    TriangleMesh::new(corners, triangles)
        .map(Arc::new)
        .map_err(value_error)
}

/// Polygons of any number of corners: an iterable of iterables of vertex indices.
pub(crate) fn polygons(faces: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    let polygon = |face: Bound<'_, PyAny>| -> PyResult<Vec<u32>> {
        face.try_iter()?.map(|corner| corner?.extract()).collect()
    };
    let all = |faces: &Bound<'_, PyAny>| -> PyResult<Vec<Vec<u32>>> {
        faces.try_iter()?.map(|face| polygon(face?)).collect()
    };
    all(faces).map_err(|error| {
        PyValueError::new_err(format!(
            "faces must be lists of vertex indices, from 0 ({error})"
        ))
    })
}
