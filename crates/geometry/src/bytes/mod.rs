//! Solids and meshes as bytes, for other processes and machines.
//!
//! A solid is a list of nodes, each of which names earlier ones; what is shared stays shared. A
//! primitive is written as what it is made from, and read through the constructor that anybody
//! would use: what is read is valid, or an error. Prisms, lathes and concave polyhedra are made
//! anew from their outlines and faces, which gives the same bits.

mod mesh;
mod primitive;
mod profile;
mod solid;

use std::collections::BTreeMap;
use std::sync::Arc;

use octray_math::bytes::{ByteReader, ByteWriter, BytesError};

use crate::{Solid, TriangleMesh};

/// Nodes of all solids asked for together, those of shared subtrees counted at every use: whoever
/// walks them walks all.
const MAX_NODES: u64 = 1 << 28;

/// Collects solids and meshes, each once, however often it is used.
#[derive(Debug, Default)]
pub struct ShapeWriter {
    meshes: ByteWriter,
    solids: ByteWriter,
    /// By address: what is shared has one.
    mesh_ids: BTreeMap<usize, u32>,
    solid_ids: BTreeMap<usize, u32>,
}

impl ShapeWriter {
    /// Of nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes what has been collected.
    pub fn write(self, out: &mut ByteWriter) {
        out.align();
        for (count, part) in [
            (self.mesh_ids.len(), self.meshes),
            (self.solid_ids.len(), self.solids),
        ] {
            out.u64(count as u64);
            let bytes = part.into_bytes();
            out.raw(&bytes);
            out.align();
        }
    }
}

/// Solids and meshes as they were read.
#[derive(Debug)]
pub struct Shapes {
    meshes: Vec<Arc<TriangleMesh>>,
    solids: Vec<Solid>,
    /// Nodes of each solid, those of shared subtrees counted at every use.
    sizes: Vec<u64>,
    nodes_left: u64,
}

impl Shapes {
    /// Reads what a [`ShapeWriter`] wrote.
    ///
    /// # Errors
    /// The first thing that is not what it should be.
    pub fn read(reader: &mut ByteReader<'_>) -> Result<Self, BytesError> {
        let mut shapes = Self {
            meshes: Vec::new(),
            solids: Vec::new(),
            sizes: Vec::new(),
            nodes_left: MAX_NODES,
        };
        reader.align()?;
        for _ in 0..reader.count(mesh::LEAST_BYTES)? {
            shapes.meshes.push(Arc::new(mesh::read(reader)?));
        }
        reader.align()?;
        for _ in 0..reader.count(1)? {
            shapes.read_node(reader)?;
        }
        reader.align()?;
        Ok(shapes)
    }

    /// A solid by the number that its writer gave.
    ///
    /// # Errors
    /// There is none, or too much has been asked for.
    pub fn solid(&mut self, reader: &mut ByteReader<'_>) -> Result<Solid, BytesError> {
        let id = reader.u32()? as usize;
        let (Some(solid), Some(size)) = (self.solids.get(id), self.sizes.get(id)) else {
            return Err(reader.error(format_args!("solid {id}, which does not exist")));
        };
        match self.nodes_left.checked_sub(*size) {
            Some(left) => self.nodes_left = left,
            None => return Err(reader.error("solids that are too large together")),
        }
        Ok(solid.clone())
    }

    /// A mesh by the number that its writer gave.
    ///
    /// # Errors
    /// There is none.
    pub fn mesh(&self, reader: &mut ByteReader<'_>) -> Result<Arc<TriangleMesh>, BytesError> {
        let id = reader.u32()? as usize;
        let mesh = self.meshes.get(id).map(Arc::clone);
        mesh.ok_or_else(|| reader.error(format_args!("mesh {id}, which does not exist")))
    }
}
