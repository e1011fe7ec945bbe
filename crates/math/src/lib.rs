//! Numbers, vectors and the small geometry that every other crate stands on.
//!
//! Conventions of the whole project: right-handed coordinates, z up unless a scene says
//! otherwise, angles in radians inside and in degrees at the edges, `f64` wherever a result
//! reaches the user. A transform is named for what it maps: `world_from_object`.
//!
//! Nothing here depends on another crate of ours; but for [`bytes`], nothing allocates or can fail.

mod aabb;
pub mod bernstein;
pub mod bytes;
mod cell_key;
mod hash;
mod interval;
mod ray;
pub mod roots;
pub mod symmetric;
pub mod transform;

pub use aabb::Aabb;
pub use cell_key::{CellKey, MAX_DEPTH};
pub use hash::{hash_combine, hash_u64, unit_f64};
pub use interval::Interval;
pub use ray::Ray;

pub use glam::{DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4};
