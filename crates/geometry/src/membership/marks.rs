//! Which operands does a cell touch? A [`Marker`] is built once and asked from cell to cell on the
//! way down: a cell only tests what its parent touched.

use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use octray_math::{Aabb, DVec3};

use super::pieces::{Fineness, Pieces};
use super::shells::StepCounts;
use super::{Enclosure, Membership};
use crate::csg::Operand;

/// The operands that a cell may touch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// Indices of operands, increasing.
    pub operands: Vec<u32>,
    /// Those pieces of their boundaries that the cell touches, increasing; none where volumes around
    /// operands decide.
    pieces: Vec<u32>,
}

/// Decides which operands a cell touches: by volumes around them, or by pieces of their boundaries.
#[derive(Debug)]
pub struct Marker {
    enclosures: Vec<Enclosure>,
    pieces: Option<Pieces>,
    slack: f64,
}

/// What deciding took. All of it but the counts is gone after the build.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerStats {
    /// Occurrences of primitives.
    pub operands: u64,
    /// Boxes of the covers, or pairs of triangles.
    pub pieces: u64,
    /// Their bytes.
    pub piece_bytes: u64,
    /// How far apart the shells are at most, in the scene; 0 where there are none.
    pub chord_error: f64,
    /// What decided whether pairs of triangles meet cells.
    pub steps: StepCounts,
}

impl Marks {
    /// These operands (increasing), without pieces: for markers that have none.
    #[must_use]
    pub const fn of(operands: Vec<u32>) -> Self {
        Self {
            operands,
            pieces: Vec::new(),
        }
    }

    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.operands.as_slice()) + size_of_val(self.pieces.as_slice())) as u64
    }
}

impl Marker {
    /// For the operands of a scene. Their boundaries may be off by up to `slack`, because surfaces
    /// that nearly coincide are merged and coordinates are rounded. `gauge` shows the bytes of the
    /// temporary pieces while there are any. Works inside the current thread pool.
    #[must_use]
    pub fn new(
        operands: &[Operand],
        membership: Membership,
        slack: f64,
        fineness: &Fineness,
        gauge: &Arc<AtomicU64>,
    ) -> Self {
        let enclosure = |operand: &Operand| match membership {
            Membership::BoundingSphere => Enclosure::sphere(operand, slack),
            _ => Enclosure::cuboid(operand, slack),
        };
        Self {
            enclosures: operands.iter().map(enclosure).collect(),
            pieces: Pieces::new(operands, membership, slack, fineness, gauge),
            slack,
        }
    }

    /// What deciding has taken so far.
    #[must_use]
    pub fn stats(&self) -> MarkerStats {
        let operands = self.enclosures.len() as u64;
        self.pieces.as_ref().map_or(
            MarkerStats {
                operands,
                ..MarkerStats::default()
            },
            |pieces| MarkerStats {
                operands,
                pieces: pieces.len(),
                piece_bytes: pieces.bytes(),
                chord_error: pieces.chord_error,
                steps: pieces.steps(),
            },
        )
    }

    /// The marks of the cell that all of these operands may touch (increasing).
    #[must_use]
    pub fn all(&self, operands: Vec<u32>) -> Marks {
        let pieces = self.pieces.as_ref().map(|pieces| pieces.of(&operands));
        Marks {
            operands,
            pieces: pieces.unwrap_or_default(),
        }
    }

    /// What is left of marks if only these operands (increasing) still matter. Some of them may not have
    /// been marked: the cells below do not touch them either.
    #[must_use]
    pub fn keep(&self, marks: Marks, operands: Vec<u32>) -> Marks {
        let mut left = marks.pieces;
        if let Some(pieces) = &self.pieces {
            pieces.keep_those_of(&mut left, &operands);
        }
        Marks {
            operands,
            pieces: left,
        }
    }

    /// Those operands that a cell touches, of those that its parent does.
    #[must_use]
    pub fn restrict(&self, parent: &Marks, cell: &Aabb) -> Marks {
        let touched = |operand: &&u32| !self.is_outside(**operand, cell);
        let operands: Vec<u32> = parent.operands.iter().filter(touched).copied().collect();
        let Some(pieces) = &self.pieces else {
            return Marks {
                operands,
                pieces: Vec::new(),
            };
        };
        let (operands, pieces) = pieces.touching(&operands, &parent.pieces, cell, self.slack);
        Marks { operands, pieces }
    }

    /// Whether all of the cell lies outside of the volume around an operand.
    #[must_use]
    pub fn is_outside(&self, operand: u32, cell: &Aabb) -> bool {
        !self.enclosures[operand as usize].meets(cell)
    }

    /// Whether nothing is known about where an operand ends: then every cell touches it.
    #[must_use]
    pub fn is_unbounded(&self, operand: u32) -> bool {
        self.pieces.is_none() && self.enclosures[operand as usize] == Enclosure::Everything
    }
}

/// Two points of a cell at which to ask whether an operand holds the cell, if its boundary does not
/// pass: the centre, and one beside it, because the centre may lie on one of the surfaces that go on
/// beyond the operand's boundary.
#[must_use]
pub fn witnesses(cell: &Aabb) -> [DVec3; 2] {
    let aside = DVec3::new(0.293, -0.411, 0.177) * cell.half_size();
    [cell.center(), cell.center() + aside]
}
