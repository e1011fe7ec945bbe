//! The SIMD room: plain arrays in, masks out.
//!
//! A kernel in `f32` proposes and never decides: what it reports is a superset of the truth, proven in
//! its documentation. Every kernel has a scalar twin with the same operations in the same order, so
//! both give the same bits: no fused multiply-add, no reciprocal estimates. The one in `f64` decides, with
//! the operations of the scalar function whose place it takes.

pub mod beam;
pub mod crossings;
mod lane;
pub mod slab;
pub mod triangles;

pub use beam::{BeamFrame, BeamTest, BeamTriangles, Bounds, Group, RayCandidates};
pub use crossings::{CrossingTest, Crossings, Pairs};
pub use fearless_simd::{Level, Simd, dispatch};
pub use slab::{BoxTest, Boxes8, Scalar, SlabRay, Vector};
pub use triangles::{Candidates, TriangleLine, TriangleTest};

/// How kernels run.
#[derive(Clone, Copy, Debug)]
pub enum Lanes {
    /// With the vector instructions of this machine.
    Vector(Level),
    /// One lane at a time.
    Scalar,
}

impl Lanes {
    /// The best that this machine offers.
    #[must_use]
    pub fn detect() -> Self {
        Self::Vector(Level::new())
    }
}

/// All kernels, run in one way.
pub trait Kernels: BoxTest + TriangleTest + BeamTest + CrossingTest {}

impl<T: BoxTest + TriangleTest + BeamTest + CrossingTest> Kernels for T {}
