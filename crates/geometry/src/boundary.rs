//! What the boundaries of composites are made of, for those who cut them into triangles.

use std::sync::Arc;

use octray_math::DVec3;

use crate::composite::CompositeKind;
use crate::profile::{Piece, Turning};

/// The boundary of a composite: all of it lies where this says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Boundary {
    /// Of a polyhedron.
    Triangles {
        triangles: Arc<[[DVec3; 3]]>,
        source: Arc<Faces>,
    },
    /// Of a region between two heights; `scale[i]` times as large at height `z[i]`.
    Prism {
        /// Closed outlines, one after the other: inside is what an odd number of them goes round.
        pieces: Arc<[Piece]>,
        z: [f64; 2],
        scale: [f64; 2],
    },
    /// Of a region that turns about the z axis.
    Lathe {
        /// As for a prism; their x is the distance from the axis.
        pieces: Arc<[Piece]>,
        turning: Turning,
    },
}

/// What a polyhedron is made from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Faces {
    pub(crate) vertices: Vec<DVec3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub(crate) faces: Vec<Vec<u32>>,
}

impl Boundary {
    pub(crate) const fn kind(&self) -> CompositeKind {
        match self {
            Self::Triangles { .. } => CompositeKind::Polyhedron,
            Self::Prism { .. } => CompositeKind::Prism,
            Self::Lathe { .. } => CompositeKind::Lathe,
        }
    }
}
