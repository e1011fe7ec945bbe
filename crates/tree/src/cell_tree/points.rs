//! Points as the contents of a tree, for tests.

use octray_math::{Aabb, DVec3};

use super::{Cell, CellTree, Criteria, Subdivide, enclosing_cube};

/// Points as contents: a cell holds the points in it.
pub(crate) struct Points;

impl Subdivide for Points {
    type Content = Vec<DVec3>;

    fn restrict(&self, parent: &Vec<DVec3>, cell: &Aabb) -> Vec<DVec3> {
        parent
            .iter()
            .copied()
            .filter(|p| cell.contains(*p))
            .collect()
    }

    fn describe(&self, content: &Vec<DVec3>) -> Cell {
        match content.len() as u32 {
            0 => Cell::Empty(0),
            // A cost that falls steeply, so that the tree follows every point down.
            n => Cell::Occupied {
                cost: 1e6 * f64::from(n),
                parts: n,
            },
        }
    }

    fn bytes(&self, content: &Vec<DVec3>) -> u64 {
        content.len() as u64
    }
}

/// A tree over [-1, 1]^3 that follows every point down to the deepest level.
pub(crate) fn tree(points: &[DVec3], max_depth: u32) -> CellTree {
    let cube = enclosing_cube(&Aabb::new(DVec3::splat(-1.0), DVec3::ONE));
    let criteria = Criteria {
        max_depth,
        ..Criteria::default()
    };
    CellTree::build(cube, points.to_vec(), &Points, &criteria).0
}
