//! Triangle meshes: storage, validation, and where lines cross them.

mod boundary;
mod exact_cross;
mod facets;
mod intersect;
mod placement;
mod position_ids;
mod solid;
mod triangle_mesh;
mod triangle_tree;
mod volume;

pub use boundary::{Flaw, FlawKind, MeshReport, MeshRule};
pub use facets::FacetPlanes;
pub use intersect::{MeshCrossing, TriangleHit, TriangleRay};
pub use placement::{Placement, TrianglePoint};
pub use solid::MeshSolid;
pub use triangle_mesh::{CornerAttribute, MeshError, TriangleMesh};
pub use triangle_tree::{
    NearestTriangle, SearchCost, SearchMemory, TriangleMarks, TriangleQuery, TriangleSearch,
    TriangleTree,
};
