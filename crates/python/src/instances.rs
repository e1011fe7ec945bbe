//! Many copies of one thing: what is copied, and where the copies stand.

use std::sync::Arc;

use numpy::PyUntypedArrayMethods;
use octray::geometry::{MeshRule, Sheet};
use octray::math::{DAffine3, DMat3, DVec3};
use octray::scene::{Instances, MaterialId, Prototype, Shape as ObjectShape};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays::{Shape, real_array, shape_text};
use crate::convert::value_error;
use crate::mesh::{Placed, Source};
use crate::scene::Scene;
use crate::solid::Solid;

/// The copies of `what` (a solid, a mesh, or a list of these) under the transforms.
pub(crate) fn instances(
    scene: &mut Scene,
    what: &Bound<'_, PyAny>,
    transforms: &Bound<'_, PyAny>,
    filled: Option<MeshRule>,
    material: Option<MaterialId>,
) -> PyResult<Instances> {
    let placed = world_from_prototype(transforms)?;
    let mut parts = Vec::new();
    match list_of_parts(what)? {
        Some(list) => {
            for part in list {
                add_part(scene, &part, filled, material, &mut parts)?;
            }
        }
        None => add_part(scene, what, filled, material, &mut parts)?,
    }
    let prototype = Prototype::new(parts).map_err(value_error)?;
    Instances::new(Arc::new(prototype), placed).map_err(value_error)
}

/// The things in a list, `None` for one thing: a list of two arrays is a mesh.
fn list_of_parts<'py>(what: &Bound<'py, PyAny>) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    let Ok(list) = what.cast::<PyList>() else {
        return Ok(None);
    };
    let mut parts = Vec::with_capacity(list.len());
    for part in list.iter() {
        parts.push(part);
    }
    let is_thing = |part: &Bound<'py, PyAny>| -> bool {
        part.cast::<Solid>().is_ok() || Source::is_whole(part)
    };
    Ok((parts.len() != 2 || parts.iter().any(is_thing)).then_some(parts))
}

fn add_part(
    scene: &mut Scene,
    part: &Bound<'_, PyAny>,
    filled: Option<MeshRule>,
    material: Option<MaterialId>,
    parts: &mut Vec<ObjectShape>,
) -> PyResult<()> {
    if let Ok(solid) = part.cast::<Solid>() {
        parts.push(ObjectShape::Solid(solid.get().inner().clone()));
        return Ok(());
    }
    match Source::of(part)? {
        Source::Arrays(mesh) => {
            let sheet = ObjectShape::Sheet(Sheet::mesh(mesh));
            let placed = Placed::of(&sheet).ok_or_else(not_a_mesh)?;
            parts.push(placed.shape(filled)?);
        }
        Source::File(path) => {
            let (file, said) = crate::load::read(part.py(), &path, false)?;
            if file.objects().is_empty() {
                return Err(PyValueError::new_err("the file has no mesh in it"));
            }
            for object in file.objects() {
                let placed = Placed::of(&object.shape).ok_or_else(not_a_mesh)?;
                // Triangles keep materials of their own unless one is given.
                let placed = match material {
                    Some(id) => placed.with_ids(|_| id)?,
                    None => {
                        let ids = scene.adopted(file.materials());
                        placed.with_ids(|old| ids[old.0 as usize])?
                    }
                };
                parts.push(placed.shape(filled)?);
            }
            scene.said(said);
        }
    }
    Ok(())
}

fn not_a_mesh() -> PyErr {
    PyValueError::new_err("expected a mesh; octray.load reads files of solids")
}

/// Affine maps from an array of shape (N, 4, 4) or (N, 3, 4), by rows.
fn world_from_prototype(transforms: &Bound<'_, PyAny>) -> PyResult<Arc<[DAffine3]>> {
    let array = real_array("transforms", transforms, Shape::any(4))?;
    let shape = array.shape();
    let rows = match *shape {
        // An empty list.
        [0, 4] => 3,
        [_, rows @ (3 | 4), 4] => rows,
        _ => {
            return Err(PyValueError::new_err(format!(
                "transforms must be an array of shape (N, 4, 4) or (N, 3, 4), not {}",
                shape_text(shape)
            )));
        }
    };
    let numbers = array.as_slice()?.as_chunks::<4>().0;
    if rows == 4 {
        let last = numbers.iter().skip(3).step_by(4);
        let projective = last.zip(0..).find(|(row, _)| **row != [0.0, 0.0, 0.0, 1.0]);
        if let Some((_, index)) = projective {
            return Err(PyValueError::new_err(format!(
                "transform {index} is not affine: its last row must be 0 0 0 1"
            )));
        }
    }
    let affine = |rows: &[[f64; 4]]| {
        let column = |i: usize| DVec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let matrix = DMat3::from_cols(column(0), column(1), column(2));
        DAffine3::from_mat3_translation(matrix, column(3))
    };
    Ok(numbers.chunks_exact(rows).map(affine).collect())
}
