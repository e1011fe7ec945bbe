//! Triangle meshes from arrays and from anything that has them.

use std::sync::Arc;

use octray::geometry::TriangleMesh;
use octray::math::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Shape, integer_array, real_array};
use crate::convert::value_error;

/// Vertices from an array of shape (N, 3).
pub(crate) fn positions(vertices: &Bound<'_, PyAny>) -> PyResult<Vec<DVec3>> {
    let array = real_array("vertices", vertices, Shape::rows("N", 3))?;
    Ok(array
        .as_slice()?
        .as_chunks::<3>()
        .0
        .iter()
        .copied()
        .map(DVec3::from_array)
        .collect())
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
