//! Which operands does a cell touch? A [`Marker`] is built once and asked from cell to cell on the
//! way down: a cell only tests what its parent touched.

use octray_math::{Aabb, DVec3};

use super::{Enclosure, Membership};
use crate::csg::Operand;

/// The operands that a cell may touch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// Indices of operands, increasing.
    pub operands: Vec<u32>,
}

/// Decides by volumes around the operands which of them a cell touches.
#[derive(Debug)]
pub struct Marker {
    enclosures: Vec<Enclosure>,
}

impl Marks {
    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        size_of_val(self.operands.as_slice()) as u64
    }
}

impl Marker {
    /// For the operands of a scene. Their boundaries may be off by up to `slack`, because surfaces
    /// that nearly coincide are merged and coordinates are rounded. Covers and shells are not made
    /// here yet: boxes stand for them.
    #[must_use]
    pub fn new(operands: &[Operand], membership: Membership, slack: f64) -> Self {
        let enclosure = |operand: &Operand| match membership {
            Membership::BoundingSphere => Enclosure::sphere(operand, slack),
            _ => Enclosure::cuboid(operand, slack),
        };
        Self {
            enclosures: operands.iter().map(enclosure).collect(),
        }
    }

    /// The marks of the cell that all of these operands may touch (increasing).
    #[must_use]
    pub const fn all(&self, operands: Vec<u32>) -> Marks {
        Marks { operands }
    }

    /// What is left of marks if only these operands (increasing) still matter, and those of them
    /// that were not marked.
    #[must_use]
    pub fn keep(&self, marks: Marks, operands: Vec<u32>) -> Marks {
        drop(marks);
        Marks { operands }
    }

    /// Those operands that a cell touches, of those that its parent does.
    #[must_use]
    pub fn restrict(&self, parent: &Marks, cell: &Aabb) -> Marks {
        let touched = |operand: &&u32| !self.is_outside(**operand, cell);
        let operands = parent.operands.iter().filter(touched).copied().collect();
        Marks { operands }
    }

    /// Whether all of the cell lies outside of the volume around an operand.
    #[must_use]
    pub fn is_outside(&self, operand: u32, cell: &Aabb) -> bool {
        !self.enclosures[operand as usize].meets(cell)
    }

    /// Whether nothing is known about where an operand ends: then every cell touches it.
    #[must_use]
    pub fn is_unbounded(&self, operand: u32) -> bool {
        self.enclosures[operand as usize] == Enclosure::Everything
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
