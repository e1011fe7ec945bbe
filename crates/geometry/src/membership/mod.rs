//! Which cubes does an object touch? The ways to decide it that Martinka, *Using an octree to
//! accelerate ray tracing* (1993), section 6, describes, and one of ours.
//!
//! "Object" means one primitive, an operand of the solids, or one triangle. All of them may say
//! *touched* too often and never too seldom, so rays find the same surfaces whatever decides.

mod enclosure;
mod marks;
mod pieces;
pub mod shells;

pub use enclosure::Enclosure;
pub use marks::{Marker, MarkerStats, Marks, witnesses};
pub use pieces::{Fineness, LiveBytes};

/// How an octree's builder decides which objects a cell touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Membership {
    /// The surfaces themselves are classified against the cell, face by face (ours).
    #[default]
    Analytic,
    /// The axis-aligned box around the object (section 6.1).
    BoundingBox,
    /// The sphere around the object (section 6.1).
    BoundingSphere,
    /// Small boxes that cover the object's surface (section 6.1).
    BoundingCover,
    /// A temporary triangulation of the object's surface from inside and from outside, and what lies
    /// between (section 6.2).
    Shells,
}
