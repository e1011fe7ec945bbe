//! Triangle meshes: storage, validation, and where lines cross them.

mod closed;
mod triangle_mesh;

pub use triangle_mesh::{CornerAttribute, MeshError, TriangleMesh};
