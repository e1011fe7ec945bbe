//! Triangle meshes: storage, validation, and where lines cross them.

mod closed;
mod exact_cross;
mod intersect;
mod placement;
mod solid;
mod triangle_mesh;

pub use intersect::{MeshCrossing, TriangleHit, TriangleRay};
pub use placement::{Placement, TrianglePoint};
pub use solid::MeshSolid;
pub use triangle_mesh::{CornerAttribute, MeshError, TriangleMesh};
