//! Building level by level: the cells of a level are worked on in parallel and put down in Morton
//! order, so limits act at the same place whatever the number of threads.

use octray_math::{Aabb, CellKey, MAX_DEPTH};
use rayon::prelude::*;

use super::criteria::Criteria;
use super::{Cell, CellTree, CellTreeStats, Node};

/// Says what cells contain.
pub trait Subdivide: Sync {
    /// The contents of one cell while the tree is built.
    type Content: Send + Sync;

    /// The part of a parent's contents that matters in `cell`.
    ///
    /// `cell` is a little larger than the cell itself, see [`CellTree::CONTENT_MARGIN`].
    fn restrict(&self, parent: &Self::Content, cell: &Aabb) -> Self::Content;

    /// The same for several cells.
    fn restrict_each(&self, parent: &Self::Content, cells: &[Aabb]) -> Vec<Self::Content> {
        let restricted = cells.iter().map(|cell| self.restrict(parent, cell));
        restricted.collect()
    }

    /// What the cell is.
    fn describe(&self, content: &Self::Content) -> Cell;

    /// The memory that the contents will take in the finished tree.
    fn bytes(&self, content: &Self::Content) -> u64;

    /// The memory of the contents while the cell may still be divided.
    fn building_bytes(&self, content: &Self::Content) -> u64 {
        self.bytes(content)
    }

    /// Drops what only division needs, once a cell is a leaf.
    fn settle(&self, _content: &mut Self::Content) {}

    /// Whether to divide the cell, where it is not for the criteria to say. Limits of depth and
    /// memory still hold.
    fn prescribed(&self, _content: &Self::Content) -> Option<bool> {
        None
    }

    /// The share of the cell's volume that its objects occupy, for [`Criteria::max_share`]; see
    /// [`super::filled_share`]. What is not known counts for none.
    fn share(&self, _content: &Self::Content, _cell: &Aabb) -> f64 {
        0.0
    }
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
/// The cells of a level are worked on in batches of so many, or of so many bytes of contents, so that
/// not all children of a level exist before one knows whether there is room for them.
const BATCH_CELLS: usize = 1 << 14;
const BATCH_BYTES: u64 = 16 << 20;
/// What allocating the contents of a cell costs beside the contents.
const ALLOCATION_BYTES: u64 = 64;

struct Frontier<C> {
    key: CellKey,
    content: C,
    futile: u8,
}

/// Sizes of contents.
struct Sizes<'a, S>(&'a S);

impl<S: Subdivide> Sizes<'_, S> {
    /// What the builder keeps beside the contents of every cell that is not empty.
    const BESIDE: u64 = size_of::<Frontier<S::Content>>() as u64 + ALLOCATION_BYTES;

    /// In the finished tree.
    fn kept(&self, cells: &[Frontier<S::Content>]) -> u64 {
        cells.iter().map(|c| self.0.bytes(&c.content)).sum()
    }

    /// While the tree is built.
    fn held(&self, cells: &[Frontier<S::Content>]) -> u64 {
        let contents: u64 = (cells.iter())
            .map(|c| self.0.building_bytes(&c.content))
            .sum();
        contents + cells.len() as u64 * Self::BESIDE
    }
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
        let mut leaves = Vec::new();
        let mut keep = |leaf| leaves.push(leaf);
        let tree = Self::build_into(root, contents, subdivide, criteria, &mut keep);
        (tree, leaves)
    }

    /// Like [`CellTree::build`], but hands over the contents of the occupied cells one by one, in the
    /// order of their indices, as soon as they are known: then millions of them need not exist side
    /// by side.
    pub fn build_into<S: Subdivide>(
        root: Aabb,
        contents: S::Content,
        subdivide: &S,
        criteria: &Criteria,
        leaf: &mut impl FnMut(S::Content),
    ) -> Self {
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
        let limits = Limits {
            kept: criteria.size_limit(parts),
            held: criteria.memory_limit.min(Criteria::LARGEST_MEMORY),
        };
        let sizes = Sizes(subdivide);
        let mut leaves = 0;
        // Of finished leaves, as held.
        let mut leaf_bytes = 0;
        let mut level = vec![Frontier {
            key: CellKey::ROOT,
            content: contents,
            futile: 0,
        }];
        // What a division added to the tree on the level before, on average.
        let mut usual = None;
        // Where the words of this level go: 8 per block of the level above, the root by itself.
        let mut first_block = None;
        loop {
            // What the tree takes if nothing more is divided.
            let held = tree.node_bytes() + leaf_bytes + sizes.held(&level);
            let room = Limits {
                kept: limits
                    .kept
                    .saturating_sub(tree.stats.bytes + sizes.kept(&level)),
                held: limits.held.saturating_sub(held),
            };
            let mut divided = Vec::new();
            if level[0].key.depth < max_depth {
                let found = divide_level(&level, &root, subdivide, criteria, &room, usual);
                divided = found.cells;
                usual = found.usual;
                tree.stats.stopped_by_size += found.refused;
                tree.stats.stopped_by_memory |= found.out_of_memory;
                tree.stats.peak_bytes = tree.stats.peak_bytes.max(held + found.peak);
            }
            tree.stats.peak_bytes = tree.stats.peak_bytes.max(held);
            divided.resize_with(level.len(), || None);
            let mut next = Vec::new();
            let level_blocks = tree.blocks.len();
            for (index, (mut cell, division)) in level.into_iter().zip(divided).enumerate() {
                let depth = cell.key.depth;
                tree.stats.depth = tree.stats.depth.max(depth);
                let node = match (subdivide.describe(&cell.content), division) {
                    (Cell::Empty(state), _) => {
                        tree.stats.count_leaf(depth, None);
                        Node::Empty(state)
                    }
                    (Cell::Occupied { .. }, Some(children)) => {
                        let block = tree.blocks.len() as u32;
                        tree.blocks.push([0; 8]);
                        tree.stats.bytes += BLOCK_BYTES;
                        tree.stats.divided += 1;
                        next.extend(children);
                        Node::Divided(block)
                    }
                    (Cell::Occupied { parts, .. }, _) => {
                        tree.stats.count_leaf(depth, Some(parts));
                        tree.stats.stopped_by_depth += u64::from(depth == max_depth);
                        subdivide.settle(&mut cell.content);
                        let bytes = subdivide.bytes(&cell.content);
                        tree.stats.bytes += bytes;
                        leaf_bytes += bytes + Sizes::<S>::BESIDE;
                        leaf(cell.content);
                        leaves += 1;
                        Node::Occupied(leaves - 1)
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
                tree.stats.node_bytes = tree.node_bytes();
                return tree;
            }
            first_block = Some(level_blocks);
            level = next;
        }
    }
}

/// Bytes that may be taken: in the finished tree, and while it is built.
#[derive(Clone, Copy)]
struct Limits {
    kept: u64,
    held: u64,
}

/// A cell that is worth dividing.
struct Division<C> {
    /// Absent once there seemed to be no room for them.
    children: Option<Vec<Frontier<C>>>,
    /// What all rays through the root save by it, in expectation; without costs, how many parts it
    /// tells apart.
    gain: f64,
    /// What it adds to the tree, net of the cell's own contents.
    kept: u64,
    /// What it adds while the tree is built.
    held: u64,
}

/// The children of those cells of a level that are divided.
struct DividedLevel<C> {
    cells: Vec<Option<Vec<Frontier<C>>>>,
    /// How many were worth it and found no room.
    refused: u64,
    /// Whether it was memory that they found no room in.
    out_of_memory: bool,
    /// The most bytes held beside what there was before.
    peak: u64,
    /// How many bytes a division adds to the tree, on average.
    usual: Option<u64>,
}

/// Where far more cells could be divided than there is room for, so many times those that fit are
/// looked at: the ones that cost most.
const LOOKED_AT: u64 = 2;

/// Which cells of a level are worth looking at, and how many of the others are occupied: if divisions
/// add to the tree what they usually do, there is not nearly room for all.
fn promising<S: Subdivide>(
    level: &[Frontier<S::Content>],
    subdivide: &S,
    room: u64,
    usual: Option<u64>,
) -> (Vec<bool>, u64) {
    let fit = usual.map_or(u64::MAX, |usual| {
        LOOKED_AT.saturating_mul(room / usual.max(1))
    });
    let mut costs: Vec<(f64, usize)> = Vec::new();
    if fit < level.len() as u64 {
        let cost = |(index, cell): (usize, &Frontier<S::Content>)| match subdivide
            .describe(&cell.content)
        {
            Cell::Empty(_) => None,
            Cell::Occupied { cost, .. } => Some((cost, index)),
        };
        costs = level.iter().enumerate().filter_map(cost).collect();
    }
    if costs.len() as u64 <= fit {
        return (vec![true; level.len()], 0);
    }
    costs.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut wanted = vec![false; level.len()];
    let (first, others) = costs.split_at(fit as usize);
    for (_, index) in first {
        wanted[*index] = true;
    }
    (wanted, others.len() as u64)
}

/// Divides the cells of a level that are worth it; if there is no room for all, those that save most.
fn divide_level<S: Subdivide>(
    level: &[Frontier<S::Content>],
    root: &Aabb,
    subdivide: &S,
    criteria: &Criteria,
    room: &Limits,
    usual: Option<u64>,
) -> DividedLevel<S::Content> {
    let (wanted, unlikely) = promising(level, subdivide, room.kept, usual);
    let mut wanted = wanted.as_slice();
    let mut divided: Vec<Option<Division<S::Content>>> = Vec::with_capacity(level.len());
    let (mut held, mut kept, mut peak) = (0, 0, 0);
    let mut rest = level;
    while !rest.is_empty() {
        let mut bytes = 0;
        let fits = rest.iter().take(BATCH_CELLS).take_while(|cell| {
            let before = bytes;
            bytes += subdivide.building_bytes(&cell.content);
            before < BATCH_BYTES
        });
        let (batch, later) = rest.split_at(fits.count());
        rest = later;
        let (looked_at, later) = wanted.split_at(batch.len());
        wanted = later;
        let mut found: Vec<_> = (batch.par_iter().zip(looked_at))
            .map(|(cell, wanted)| {
                wanted
                    .then(|| divide(cell, root, subdivide, criteria))
                    .flatten()
            })
            .collect();
        let made: u64 = found.iter().flatten().map(|d| d.held).sum();
        peak = peak.max(held + made);
        for division in found.iter_mut().flatten() {
            // Beyond what the finished tree may take, not all will be divided.
            if held + division.held <= room.held && kept <= room.kept {
                held += division.held;
                kept += division.kept;
            } else {
                division.children = None;
            }
        }
        divided.append(&mut found);
    }
    let refused_by_size = unlikely + keep_most_useful(&mut divided, room.kept, |d| d.kept);
    let refused_by_memory = keep_most_useful(&mut divided, room.held, |d| d.held);
    let count = divided.iter().flatten().count() as u64;
    let kept: u64 = divided.iter().flatten().map(|d| d.kept).sum();
    let usual = (count > 0).then(|| kept / count);
    // Children that were given up too early are made once more.
    let children = |cell, division: Division<S::Content>| {
        let made = division.children;
        made.or_else(|| divide(cell, root, subdivide, criteria)?.children)
    };
    let cells = (level.par_iter().zip(divided))
        .map(|(cell, division)| children(cell, division?))
        .collect();
    DividedLevel {
        cells,
        refused: refused_by_size + refused_by_memory,
        out_of_memory: refused_by_memory > 0,
        peak,
        usual,
    }
}

/// Drops the divisions with the smallest gain per byte until the rest fits; returns how many.
fn keep_most_useful<C>(
    divided: &mut [Option<Division<C>>],
    bytes_left: u64,
    bytes: impl Fn(&Division<C>) -> u64,
) -> u64 {
    let total: u64 = divided.iter().flatten().map(&bytes).sum();
    if total <= bytes_left {
        return 0;
    }
    let value = |d: &Division<C>| d.gain / bytes(d).max(1) as f64;
    let mut order: Vec<(f64, usize)> = divided
        .iter()
        .enumerate()
        .filter_map(|(index, d)| d.as_ref().map(|d| (value(d), index)))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut kept = 0;
    let mut refused = 0;
    for (_, index) in order {
        let bytes = divided[index].as_ref().map_or(0, &bytes);
        if kept + bytes <= bytes_left {
            kept += bytes;
        } else {
            divided[index] = None;
            refused += 1;
        }
    }
    refused
}

/// The eight children of an occupied cell, if the criteria divide it.
fn divide<S: Subdivide>(
    cell: &Frontier<S::Content>,
    root: &Aabb,
    subdivide: &S,
    criteria: &Criteria,
) -> Option<Division<S::Content>> {
    let Cell::Occupied { cost, parts } = subdivide.describe(&cell.content) else {
        return None;
    };
    let is_full = || {
        let share = subdivide.share(&cell.content, &cell.key.bounds(root));
        share > criteria.max_share
    };
    let prescribed = subdivide.prescribed(&cell.content);
    let divides = prescribed
        .unwrap_or_else(|| parts > criteria.max_parts && !(criteria.max_share < 1.0 && is_full()));
    if !divides {
        return None;
    }
    let margin = root.size().x * CellTree::CONTENT_MARGIN;
    let keys: [CellKey; 8] = std::array::from_fn(|octant| cell.key.child(octant as u32));
    let bounds = keys.map(|key| key.bounds(root).inflated(margin));
    // The upper levels have fewer cells than there are threads.
    let contents: Vec<_> = if parts > MANY_PARTS {
        (bounds.par_iter())
            .map(|bounds| subdivide.restrict(&cell.content, bounds))
            .collect()
    } else {
        subdivide.restrict_each(&cell.content, &bounds)
    };
    let mut children: Vec<_> = (keys.into_iter().zip(contents))
        .map(|(key, content)| Frontier {
            key,
            content,
            futile: 0,
        })
        .collect();
    let mut expected = 0.5 * criteria.visit_cost;
    for child in &children {
        expected += 0.25
            * match subdivide.describe(&child.content) {
                Cell::Empty(_) => EMPTY_SHARE * criteria.visit_cost,
                Cell::Occupied { cost, .. } => criteria.visit_cost + cost,
            };
    }
    let mut saved = criteria.visit_cost + cost - expected;
    if !criteria.by_cost || prescribed.is_some() {
        saved = f64::from(parts);
    } else if saved <= 0.0 {
        if parts <= FUTILE_PARTS || cell.futile >= FUTILE_LIMIT {
            return None;
        }
        for child in &mut children {
            child.futile = cell.futile + 1;
        }
    }
    let sizes = Sizes(subdivide);
    // A ray through the root meets a cell of depth d with probability 4^-d.
    let reach = libm::ldexp(1.0, -2 * cell.key.depth as i32);
    let kept = BLOCK_BYTES + sizes.kept(&children);
    Some(Division {
        kept: kept.saturating_sub(subdivide.bytes(&cell.content)),
        held: BLOCK_BYTES + sizes.held(&children),
        children: Some(children),
        gain: saved.max(0.0) * reach,
    })
}
