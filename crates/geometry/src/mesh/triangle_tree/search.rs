//! How triangles are searched, what that needs and what it costs.

use octray_tree::traversal::Steps;
use octray_tree::{
    Criteria, Division, LvsiTable, Pending, WalkCost, WalkMemory, WideTree, WideTreeConfig,
};

use super::beam::{BeamMemory, Coherence};
use crate::Membership;

/// How the triangles that a line crosses are found. The answers are the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TriangleSearch {
    /// Every triangle is tested: the oracle.
    All,
    /// An octree with eight boxes to a node.
    Wide(WideTreeConfig),
    /// A sphere around each object is tested before all its triangles.
    Spheres,
    /// A box around each object is tested before all its triangles.
    Boxes,
    /// Cells of space, each with a list of the triangles that touch it.
    Cells {
        /// Which cells, and how they are walked.
        division: Division,
        /// How large a hash table is, where there is one.
        table: LvsiTable,
        /// How it is decided which triangles touch a cell.
        membership: Membership,
        /// When to divide an octree's cells, and how much memory there is.
        criteria: Criteria,
    },
}

/// What searches cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SearchCost {
    /// Nodes of the wide octree entered, and triangles tested by any search.
    pub walk: WalkCost,
    /// Cells entered and how they were found; of volumes, those tested.
    pub steps: Steps,
    /// Tests that the mailbox saved: the triangle had met the ray in an earlier cell.
    pub mailbox: u64,
}

impl SearchCost {
    /// The part of one of so many lines that travelled together in the wide octree.
    pub(super) const fn share(&self, index: usize, of: usize) -> Self {
        let (index, of) = (index as u64, of as u64);
        let mut part = *self;
        part.walk.nodes = self.walk.nodes / of + (index < self.walk.nodes % of) as u64;
        part.walk.items = self.walk.items / of + (index < self.walk.items % of) as u64;
        part
    }
}

/// Working memory of searches, kept from ray to ray by each thread.
#[derive(Clone, Debug, Default)]
pub struct SearchMemory {
    pub(super) walk: WalkMemory,
    pub(super) mailbox: Mailbox,
    stack: Vec<Pending>,
    /// Taken out while a beam is searched.
    pub(super) beams: Option<Box<BeamMemory>>,
    pub(super) coherence: Coherence,
}

impl SearchMemory {
    /// The rays to come are others than those that entered together last.
    pub const fn leave(&mut self) {
        self.walk.leave();
    }

    /// A slice of lines begins: what beams have cost in others does not count, so that costs depend on
    /// nothing but the slice.
    pub fn begin_slice(&mut self) {
        self.coherence = Coherence::default();
    }

    /// A stack for walks of this tree.
    #[inline]
    pub(super) fn stack(&mut self, tree: &WideTree) -> &mut [Pending] {
        if self.stack.len() < tree.stack_length() {
            self.stack.resize(tree.stack_length(), Pending::default());
        }
        &mut self.stack
    }
}

/// Which triangles have been tested with the ray at hand.
///
/// A triangle in several cells is tested once per ray (the mailbox of Arnaldi, Priol and Bouatouch
/// 1987; Martinka 1993, section 7). The stamps lie here and not with the triangles, so that any
/// number of threads can search one structure.
#[derive(Clone, Debug, Default)]
pub(super) struct Mailbox {
    stamps: Vec<u32>,
    /// Of the ray at hand.
    stamp: u32,
}

impl Mailbox {
    /// Forgets the last ray.
    pub(super) fn begin(&mut self, triangles: usize) {
        if self.stamps.len() < triangles {
            self.stamps.resize(triangles, 0);
        }
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.stamps.fill(0);
            self.stamp = 1;
        }
    }

    /// Whether the triangle comes for the first time.
    #[inline]
    pub(super) fn is_new(&mut self, triangle: u32) -> bool {
        let stamp = &mut self.stamps[triangle as usize];
        std::mem::replace(stamp, self.stamp) != self.stamp
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_that_wrap_around_are_not_mistaken() {
        let mut mailbox = Mailbox::default();
        mailbox.begin(3);
        assert!(mailbox.is_new(1) && !mailbox.is_new(1) && mailbox.is_new(2));
        mailbox.stamp = u32::MAX - 1;
        mailbox.begin(3);
        assert!(mailbox.is_new(1) && !mailbox.is_new(1));
        // The next stamp would be 0, and the one after it that of the first ray.
        for _ in 0..2 {
            mailbox.begin(3);
            assert!((0..3).all(|triangle| mailbox.is_new(triangle)));
        }
        mailbox.begin(5);
        assert!(mailbox.is_new(4) && !mailbox.is_new(4));
    }
}
