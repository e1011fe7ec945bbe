//! octray shows, measures and proves exact solids: a ray tracer for constructive solid geometry
//! and triangle meshes, on an octree, with the same bits everywhere.
//!
//! This crate is what a Rust program depends on. It adds nothing of its own: each module below is
//! one of the project's crates under a short name.

pub use octray_geometry as geometry;
pub use octray_import as import;
pub use octray_math as math;
pub use octray_render as render;
pub use octray_scene as scene;
pub use octray_tree as tree;
pub use octray_world as world;
