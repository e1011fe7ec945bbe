//! Building level by level: the cells of a level are worked on in parallel and put down in Morton
//! order, so limits act at the same place whatever the number of threads.

use octray_math::{Aabb, CellKey, MAX_DEPTH};
use rayon::prelude::*;

use super::{Cell, CellTree, CellTreeStats, Node};

/// Says what cells contain.
pub trait Subdivide: Sync {
    /// The contents of one cell while the tree is built.
    type Content: Send + Sync;

    /// The part of a parent's contents that matters in `cell`.
    ///
    /// `cell` is a little larger than the cell itself, see [`CellTree::CONTENT_MARGIN`].
    fn restrict(&self, parent: &Self::Content, cell: &Aabb) -> Self::Content;

    /// What the cell is.
    fn describe(&self, content: &Self::Content) -> Cell;

    /// The memory that the contents will take in the finished tree.
    fn bytes(&self, content: &Self::Content) -> u64;
}

/// When to divide.
///
/// A cell is divided when the expected cost of a ray that meets it falls: a ray that meets a cube
/// meets each of its octants with probability 1/4 (the ratio of surface areas, MacDonald & Booth
/// 1990). A cell of many parts may be divided a few times without gain, because many faces through
/// one octant need more than one division to come apart. (One part alone never comes apart, and
/// following it without gain would fill its whole surface with the smallest cells.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// No cell lies deeper; at most 21.
    pub max_depth: u32,
    /// Division stops before nodes and contents take more bytes.
    pub memory_limit: u64,
    /// It also stops when they take more than this many bytes for each part of the root's contents
    /// (beyond [`Criteria::FREE_BYTES`]): surfaces that hardly come apart, like the planes of a finely
    /// faceted ball, would be divided for ever smaller gains.
    pub bytes_per_part: u64,
    /// Cost of entering a cell, in units of one plane intersected with a line. The default was
    /// measured: a ray is as fast as with 1.5, the tree a tenth of the size.
    pub visit_cost: f64,
}

impl Default for Criteria {
    fn default() -> Self {
        Self {
            max_depth: 16,
            memory_limit: 4 << 30,
            bytes_per_part: 512,
            visit_cost: 4.0,
        }
    }
}

impl Criteria {
    /// Any tree may take this many bytes, if the memory limit allows.
    pub const FREE_BYTES: u64 = 8 << 20;
}

/// How often in a row a cell may be divided without gain, and how many parts it must have.
const FUTILE_LIMIT: u8 = 3;
const FUTILE_PARTS: u32 = 8;
/// The children of a cell of more parts are worked on in parallel.
const MANY_PARTS: u32 = 1000;
/// Passing an empty cell costs this share of entering an occupied one.
const EMPTY_SHARE: f64 = 0.2;

/// Eight words.
const BLOCK_BYTES: u64 = 32;

struct Frontier<C> {
    key: CellKey,
    content: C,
    futile: u8,
}

impl CellTree {
    /// Contents are decided for a cell grown by this share of the root's size on every side, and
    /// rays are clipped to a cell grown by half of it: a crossing that rounding moved out of its
    /// cell is still found, and found where the contents are right.
    pub const CONTENT_MARGIN: f64 = 1.0 / (1u64 << 20) as f64;

    /// The tree over the cube `root` and the contents of its occupied cells.
    ///
    /// Works inside the current thread pool; the result does not depend on it.
    pub fn build<S: Subdivide>(
        root: Aabb,
        contents: S::Content,
        subdivide: &S,
        criteria: &Criteria,
    ) -> (Self, Vec<S::Content>) {
        let max_depth = criteria.max_depth.min(MAX_DEPTH);
        let mut tree = Self {
            root,
            root_node: 0,
            blocks: Vec::new(),
            stats: CellTreeStats::default(),
        };
        let parts = match subdivide.describe(&contents) {
            Cell::Empty(_) => 0,
            Cell::Occupied { parts, .. } => u64::from(parts),
        };
        let size_limit = Criteria::FREE_BYTES + criteria.bytes_per_part.saturating_mul(parts);
        let budget = criteria.memory_limit.min(size_limit);
        let mut leaves = Vec::new();
        let mut level = vec![Frontier {
            key: CellKey::ROOT,
            content: contents,
            futile: 0,
        }];
        // Where the words of this level go: 8 per block of the level above, the root by itself.
        let mut first_block = None;
        loop {
            let mut divided: Vec<Option<Division<S::Content>>> = level
                .par_iter()
                .map(|cell| {
                    (cell.key.depth < max_depth)
                        .then(|| divide(cell, &root, subdivide, criteria))
                        .flatten()
                })
                .collect();
            // What the tree takes if nothing more is divided.
            let undivided: u64 = level.iter().map(|c| subdivide.bytes(&c.content)).sum();
            let bytes_left = budget.saturating_sub(tree.stats.bytes + undivided);
            let refused = keep_most_useful(&mut divided, bytes_left);
            tree.stats.stopped_by_size += refused;
            tree.stats.stopped_by_memory |= refused > 0 && budget == criteria.memory_limit;
            let mut next = Vec::new();
            let level_blocks = tree.blocks.len();
            for (index, (cell, division)) in level.into_iter().zip(divided).enumerate() {
                tree.stats.depth = tree.stats.depth.max(cell.key.depth);
                let node = match (subdivide.describe(&cell.content), division) {
                    (Cell::Empty(state), _) => {
                        tree.stats.empty += 1;
                        Node::Empty(state)
                    }
                    (Cell::Occupied { .. }, Some(division)) => {
                        let block = tree.blocks.len() as u32;
                        tree.blocks.push([0; 8]);
                        tree.stats.bytes += BLOCK_BYTES;
                        tree.stats.divided += 1;
                        next.extend(division.children);
                        Node::Divided(block)
                    }
                    (Cell::Occupied { .. }, _) => {
                        tree.stats.occupied += 1;
                        tree.stats.stopped_by_depth += u64::from(cell.key.depth == max_depth);
                        tree.stats.bytes += subdivide.bytes(&cell.content);
                        leaves.push(cell.content);
                        Node::Occupied(leaves.len() as u32 - 1)
                    }
                };
                match first_block {
                    None => tree.root_node = node.encode(),
                    Some(first) => {
                        let block: usize = first;
                        tree.blocks[block + index / 8][index % 8] = node.encode();
                    }
                }
            }
            if next.is_empty() {
                return (tree, leaves);
            }
            first_block = Some(level_blocks);
            level = next;
        }
    }
}

/// A cell that is worth dividing.
struct Division<C> {
    children: Vec<Frontier<C>>,
    /// What all rays through the root save by it, in expectation.
    gain: f64,
    /// What it adds to the tree, net of the cell's own contents.
    bytes: u64,
}

/// Drops the divisions with the smallest gain per byte until the rest fits; returns how many.
fn keep_most_useful<C>(divided: &mut [Option<Division<C>>], bytes_left: u64) -> u64 {
    let total: u64 = divided.iter().flatten().map(|d| d.bytes).sum();
    if total <= bytes_left {
        return 0;
    }
    let mut order: Vec<(f64, usize)> = divided
        .iter()
        .enumerate()
        .filter_map(|(index, d)| {
            d.as_ref()
                .map(|d| (d.gain / (d.bytes.max(1)) as f64, index))
        })
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut kept = 0;
    let mut refused = 0;
    for (_, index) in order {
        let bytes = divided[index].as_ref().map_or(0, |d| d.bytes);
        if kept + bytes <= bytes_left {
            kept += bytes;
        } else {
            divided[index] = None;
            refused += 1;
        }
    }
    refused
}

/// The eight children of an occupied cell, if dividing it pays.
fn divide<S: Subdivide>(
    cell: &Frontier<S::Content>,
    root: &Aabb,
    subdivide: &S,
    criteria: &Criteria,
) -> Option<Division<S::Content>> {
    let Cell::Occupied { cost, parts } = subdivide.describe(&cell.content) else {
        return None;
    };
    let margin = root.size().x * CellTree::CONTENT_MARGIN;
    let child = |octant: u32| {
        let key = cell.key.child(octant);
        let content = subdivide.restrict(&cell.content, &key.bounds(root).inflated(margin));
        Frontier {
            key,
            content,
            futile: 0,
        }
    };
    // The upper levels have fewer cells than there are threads.
    let mut children: Vec<_> = if parts > MANY_PARTS {
        (0..8).into_par_iter().map(child).collect()
    } else {
        (0..8).map(child).collect()
    };
    let mut expected = 0.5 * criteria.visit_cost;
    for child in &children {
        expected += 0.25
            * match subdivide.describe(&child.content) {
                Cell::Empty(_) => EMPTY_SHARE * criteria.visit_cost,
                Cell::Occupied { cost, .. } => criteria.visit_cost + cost,
            };
    }
    let saved = criteria.visit_cost + cost - expected;
    if saved <= 0.0 {
        if parts <= FUTILE_PARTS || cell.futile >= FUTILE_LIMIT {
            return None;
        }
        for child in &mut children {
            child.futile = cell.futile + 1;
        }
    }
    let contents: u64 = children.iter().map(|c| subdivide.bytes(&c.content)).sum();
    // A ray through the root meets a cell of depth d with probability 4^-d.
    let reach = libm::ldexp(1.0, -2 * cell.key.depth as i32);
    Some(Division {
        children,
        gain: saved.max(0.0) * reach,
        bytes: (BLOCK_BYTES + contents).saturating_sub(subdivide.bytes(&cell.content)),
    })
}
