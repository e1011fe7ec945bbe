//! Meshes as arrays.

use std::sync::Arc;

use octray_math::bytes::{ByteReader, ByteWriter, BytesError};
use octray_math::{DVec2, DVec3};

use super::ShapeWriter;
use crate::{CornerAttribute, MaterialId, TriangleMesh};

/// Two empty arrays and three absent ones.
pub(super) const LEAST_BYTES: usize = 19;

impl ShapeWriter {
    /// Collects a mesh; gives its number.
    pub fn mesh(&mut self, mesh: &Arc<TriangleMesh>) -> u32 {
        let next = self.mesh_ids.len() as u32;
        let id = *self
            .mesh_ids
            .entry(Arc::as_ptr(mesh) as usize)
            .or_insert(next);
        if id == next {
            write(mesh, &mut self.meshes);
        }
        id
    }
}

fn write(mesh: &TriangleMesh, out: &mut ByteWriter) {
    out.f64s(bytemuck::cast_slice(mesh.positions()));
    out.u32s(mesh.triangles().as_flattened());
    out.bool(mesh.normals().is_some());
    if let Some(normals) = mesh.normals() {
        out.f64s(bytemuck::cast_slice(&normals.values));
        out.u32s(normals.triangles.as_flattened());
    }
    out.bool(mesh.texcoords().is_some());
    if let Some(uv) = mesh.texcoords() {
        out.f64s(bytemuck::cast_slice(&uv.values));
        out.u32s(uv.triangles.as_flattened());
    }
    out.bool(mesh.materials().is_some());
    if let Some(materials) = mesh.materials() {
        let ids: Vec<u32> = materials.iter().map(|id| id.0).collect();
        out.u32s(&ids);
    }
}

pub(super) fn read(reader: &mut ByteReader<'_>) -> Result<TriangleMesh, BytesError> {
    let mut mesh = TriangleMesh::new(points(reader)?, triples(reader)?)
        .map_err(|error| reader.error(error))?;
    if reader.bool()? {
        let normals = CornerAttribute {
            values: points(reader)?,
            triangles: triples(reader)?,
        };
        mesh = mesh
            .with_normals(normals)
            .map_err(|error| reader.error(error))?;
    }
    if reader.bool()? {
        let numbers = reader.f64s()?;
        let values = rows::<f64, 2>(reader, &numbers)?;
        let uv = CornerAttribute {
            values: values.into_iter().map(DVec2::from_array).collect(),
            triangles: triples(reader)?,
        };
        mesh = mesh
            .with_texcoords(uv)
            .map_err(|error| reader.error(error))?;
    }
    if reader.bool()? {
        let ids = reader.u32s()?.into_iter().map(MaterialId).collect();
        mesh = mesh
            .with_materials(ids)
            .map_err(|error| reader.error(error))?;
    }
    Ok(mesh)
}

fn points(reader: &mut ByteReader<'_>) -> Result<Vec<DVec3>, BytesError> {
    let numbers = reader.f64s()?;
    let rows = rows::<f64, 3>(reader, &numbers)?;
    Ok(rows.into_iter().map(DVec3::from_array).collect())
}

fn triples(reader: &mut ByteReader<'_>) -> Result<Vec<[u32; 3]>, BytesError> {
    let numbers = reader.u32s()?;
    rows::<u32, 3>(reader, &numbers)
}

fn rows<T: Copy, const N: usize>(
    reader: &ByteReader<'_>,
    numbers: &[T],
) -> Result<Vec<[T; N]>, BytesError> {
    let (rows, rest) = numbers.as_chunks::<N>();
    if rest.is_empty() {
        Ok(rows.to_vec())
    } else {
        Err(reader.error("an array that ends within a row"))
    }
}
