//! Sung's traversal (1991; Martinka 1993, section 7): the 3DDDA over Basic Traversal Units, with a
//! search for the leaf that holds each unit.

use octray_math::{Aabb, CellKey, Interval, Ray};

use super::Steps;
use super::stepper::{Stepper, is_walkable};
use crate::cell_tree::{CellTree, Node};
use crate::encoding::{Found, Lvsi};

/// Something that knows the leaf in which a unit lies.
pub trait LeafSearch {
    /// Depth of the units that are asked for.
    fn depth(&self) -> u32;

    /// The leaf that holds `unit`. Adds what the search cost to `lookups`.
    fn leaf_parent(&self, unit: CellKey, lookups: &mut u64) -> Found;

    /// Visits the occupied leaves that the line meets in `within`, front to back, as
    /// [`CellTree::walk`] does.
    ///
    /// Where the search does not know how far emptiness reaches, the walk goes through it unit by unit:
    /// up to `3 * 2^depth` steps.
    fn walk_units(
        &self,
        root: &Aabb,
        ray: &Ray,
        within: Interval,
        mut visit: impl FnMut(u32, Interval) -> f64,
    ) -> Steps
    where
        Self: Sized,
    {
        let mut steps = Steps::default();
        if !is_walkable(root, ray) {
            return steps;
        }
        let Some(mut stepper) = Stepper::new(root, self.depth(), ray, within) else {
            return steps;
        };
        let mut limit = within.end;
        loop {
            steps.cells += 1;
            let unit = stepper.unit();
            let cell = match self.leaf_parent(unit, &mut steps.lookups) {
                Found::Leaf(cell, Node::Occupied(leaf)) => {
                    let part = stepper.part(cell);
                    if !Stepper::is_past(&part, limit) {
                        limit = limit.min(visit(leaf, part));
                    }
                    cell
                }
                Found::Leaf(cell, _) => cell,
                Found::Nothing => unit,
            };
            if stepper.leave(cell, limit).is_none() {
                return steps;
            }
        }
    }
}

impl LeafSearch for Lvsi {
    fn depth(&self) -> u32 {
        Self::depth(self)
    }

    fn leaf_parent(&self, unit: CellKey, lookups: &mut u64) -> Found {
        Self::leaf_parent(self, unit, lookups)
    }
}

impl LeafSearch for CellTree {
    fn depth(&self) -> u32 {
        self.stats().depth
    }

    /// Down from the root by the bits of the unit's index.
    fn leaf_parent(&self, unit: CellKey, lookups: &mut u64) -> Found {
        let mut cell = CellKey::ROOT;
        let mut node = self.root_node();
        while let Node::Divided(block) = node {
            *lookups += 1;
            let octant = unit.octant_at(cell.depth + 1);
            cell = cell.child(octant);
            node = self.child(block, octant);
        }
        Found::Leaf(cell, node)
    }
}
