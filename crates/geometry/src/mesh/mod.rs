//! Triangle meshes: storage, validation, and where lines cross them.

mod closed;
mod exact_cross;
mod intersect;
mod triangle_mesh;

pub use intersect::{MeshCrossing, TriangleHit, TriangleRay};
pub use triangle_mesh::{CornerAttribute, MeshError, TriangleMesh};
