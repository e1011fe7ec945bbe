//! Exact solids and meshes: what a scene is made of, and where lines cross it.
//!
//! A [`Solid`] has an inside: it is a tree of set operations over [`Primitive`]s. A [`Sheet`] has
//! two sides and no inside. Both are immutable and cheap to clone, and valid by construction:
//! every constructor refuses what it cannot represent with a [`ShapeError`].

mod boundary;
mod bytes;
mod composite;
pub mod csg;
mod frame;
mod identity;
mod implicit;
pub mod membership;
pub mod mesh;
pub mod polygon;
mod polyhedron;
mod polynomial;
mod primitive;
pub mod profile;
mod sheet;
mod solid;
pub mod surface;

pub use bytes::{ShapeWriter, Shapes};
pub use composite::{Composite, CompositeFace, CompositeKind};
pub use frame::{SceneFrame, finite_box};
pub use identity::{FaceId, MaterialId, SurfaceId};
pub use membership::Membership;
pub use mesh::{CornerAttribute, MeshError, MeshRule, TriangleMesh};
pub use polynomial::Polynomial;
pub use primitive::{ConvexPolyhedron, Primitive, ShapeError};
pub use sheet::Sheet;
pub use solid::{MAX_NESTING, MAX_OPERANDS, Solid, SolidNode};
