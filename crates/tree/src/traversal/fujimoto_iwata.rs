//! The traversal of Fujimoto and Iwata, *Accelerated Ray Tracing* (1985; Martinka 1993, section 7):
//! vertical search down the tree, and horizontally the 3DDDA through the 2 x 2 x 2 children of one
//! cell.

use octray_math::{CellKey, Interval, Ray};

use super::Steps;
use super::stepper::{Stepper, is_walkable};
use crate::cell_tree::{CellTree, Node};

/// The blocks on the way from the root to the cell one is in: working memory, kept from walk to
/// walk.
#[derive(Clone, Debug, Default)]
pub struct TreePath(Vec<u32>);

impl CellTree {
    /// Visits the occupied cells that the line meets in `within`, front to back, as
    /// [`CellTree::walk`] does.
    pub fn walk_neighbours(
        &self,
        ray: &Ray,
        within: Interval,
        TreePath(path): &mut TreePath,
        mut visit: impl FnMut(u32, Interval) -> f64,
    ) -> Steps {
        let mut steps = Steps::default();
        let root = self.root();
        if !is_walkable(root, ray) {
            return steps;
        }
        let Some(mut stepper) = Stepper::new(root, self.stats().depth, ray, within) else {
            return steps;
        };
        let mut limit = within.end;
        path.clear();
        let mut cell = CellKey::ROOT;
        let mut node = self.root_node();
        loop {
            // Vertical: down to the leaf that holds the unit.
            while let Node::Divided(block) = node {
                steps.lookups += 1;
                let octant = stepper.unit().octant_at(cell.depth + 1);
                path.push(block);
                cell = cell.child(octant);
                node = self.child(block, octant);
            }
            steps.cells += 1;
            if let Node::Occupied(leaf) = node {
                let part = stepper.part(cell);
                if !Stepper::is_past(&part, limit) {
                    limit = limit.min(visit(leaf, part));
                }
            }
            let Some(axis) = stepper.leave(cell, limit) else {
                return steps;
            };
            // Horizontal: to the sibling on the way, if there is one; else up, and on from there.
            let forward = ray.direction[axis] > 0.0;
            let at_end = |cell: CellKey| (cell.octant() >> axis & 1 == 1) == forward;
            while at_end(cell) {
                steps.lookups += 1;
                path.pop();
                match cell.parent() {
                    Some(parent) => cell = parent,
                    None => return steps,
                }
            }
            let Some(&block) = path.last() else {
                return steps;
            };
            steps.lookups += 1;
            let octant = stepper.unit().octant_at(cell.depth);
            cell = CellKey {
                index: stepper
                    .unit()
                    .index
                    .map(|i| i >> (stepper.unit().depth - cell.depth)),
                ..cell
            };
            node = self.child(block, octant);
        }
    }
}
