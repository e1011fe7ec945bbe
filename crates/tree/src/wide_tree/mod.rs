//! Eight boxes at a time: octree topology with tight bounds.
//!
//! The tree is generic over what it holds ([`Items`]): it sees boxes, and names items by their
//! index. Boxes do the culling. Items are halved again and again, in Morton order at the planes of
//! an octree's cells ([`Quality::Fast`]) or at the planes where rays are expected to pay least
//! ([`Quality::Full`]); then the nodes of eight are made of the halves that cost least. With
//! [`Quality::Full`] large items may be cut in two, so that one stands in several leaves, each time
//! within a box around a part of it. Boxes alone (`[Aabb]`) are never cut: they stand in one leaf.
//!
//! Bounds are kept in `f32`, relative to the tree's centre, scaled by a power of two to `[-1, 1]`
//! and rounded outwards. They only rule out; the visitor decides in `f64`. So a search gives the
//! same answer as trying every item, bit for bit, if the visitor does its part: the point that it
//! reports for an item must lie at a point of the item itself (for boxes, in the box), up to `2^-43`
//! times the largest coordinate of a corner of the tree's bounds relative to the ray's origin. Every
//! point of an item lies in the box of one of its leaves at least, so the leaf is opened. (Bounds of
//! items whose parameters are less accurate must be inflated before the tree is built.) The reported
//! point of a triangle is a mean of its corners with the weights reported, so it is such a point
//! however thin the triangle and however flat the line runs over it.

mod beam;
mod build;
mod cost;
mod divide;
mod frame;
mod items;
mod morton;
mod reference;
mod region;
mod split;
mod subtree;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::atomic::AtomicU64;

use bytemuck::{Pod, Zeroable};
use octray_kernels::{Boxes8, Lanes};
use octray_math::{Aabb, DVec3};
use rayon::prelude::*;
use thiserror::Error;

use divide::Division;
use frame::Frame;
use reference::{PaddedBox, Reference};
use split::Piece;
use subtree::Plan;

pub use beam::{BEAM, Beam, BeamLine, BeamVisitor, GROUPS, PendingBeam};
pub use frame::LocalLine;
pub use items::{Coordinates, Items};
pub use walk::{LeafVisitor, Pending, WalkCost};

/// No way from the root has more nodes than this plus one, whatever the items.
const MAX_DEPTH: u32 = 73;
/// How many items a thread looks at in one go.
const SHARE: usize = 1 << 12;
/// So few items are not divided: finding out how is most of the work, and gains little.
const UNDIVIDED_FAST: u32 = 4;
const UNDIVIDED_FULL: u32 = 2;
/// The most items a leaf may hold.
const LARGEST_LEAF: u32 = 8;

/// How much time is spent on a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Soon ready: items are divided along the cells of an octree, in Morton order.
    Fast,
    /// Quick to search: items are divided where rays are expected to pay least.
    #[default]
    Full,
}

/// How to build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideTreeConfig {
    /// How much time is spent.
    pub quality: Quality,
    /// The most items in a leaf, 1 to 8 (taken as the nearest of these).
    pub leaf_size: u32,
    /// Bytes that the tree and its construction may take, the caller's boxes and about 2 MB for
    /// each thread aside.
    pub memory_limit: u64,
}

impl Default for WideTreeConfig {
    fn default() -> Self {
        Self {
            quality: Quality::default(),
            leaf_size: 8,
            memory_limit: 8 << 30,
        }
    }
}

/// Why there is no tree.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WideTreeError {
    /// An item extends to infinity.
    #[error("item {0} is unbounded")]
    Unbounded(usize),
    /// Links have 28 bits for an item.
    #[error("{0} items; a tree holds at most 2^28")]
    TooMany(usize),
    /// Known before the memory is taken.
    #[error(
        "a tree over {items} items takes at least {needed} bytes of memory, more than the limit of {limit}"
    )]
    Memory {
        /// How many items.
        items: usize,
        /// Bytes needed, or a lower bound.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
}

/// Eight children.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
struct WideNode {
    boxes: Boxes8,
    links: [u32; 8],
}

/// What a child is, in one word: the index of a node, or a leaf.
mod link {
    use std::ops::Range;

    const LEAF: u32 = 1 << 31;
    /// Items are counted in the three bits from here on, one less than there are.
    const COUNT_SHIFT: u32 = 28;
    pub(super) const MAX_ITEMS: usize = 1 << COUNT_SHIFT;

    pub(super) const fn node(index: usize) -> u32 {
        index as u32
    }

    pub(super) const fn leaf(first: u32, count: u32) -> u32 {
        LEAF | (count - 1) << COUNT_SHIFT | first
    }

    /// The places of the items of a leaf, `None` for a node.
    #[inline]
    pub(super) fn items(word: u32) -> Option<Range<usize>> {
        if word & LEAF == 0 {
            return None;
        }
        let first = (word & (MAX_ITEMS as u32 - 1)) as usize;
        Some(first..first + (word >> COUNT_SHIFT & 7) as usize + 1)
    }

    /// A link into arrays that were appended to others of so many nodes and items.
    pub(super) const fn rebased(word: u32, nodes: usize, items: usize) -> u32 {
        if word & LEAF == 0 {
            word + nodes as u32
        } else {
            word + items as u32
        }
    }
}

/// Figures about a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WideTreeStats {
    /// Items that can be met; empty ones are left out.
    pub items: u64,
    /// Items in leaves; more than there are where items stand in several.
    pub references: u64,
    /// Nodes of eight children.
    pub nodes: u64,
    /// Leaves with at least one item.
    pub leaves: u64,
    /// Depth of the deepest node; the root is 0.
    pub depth: u32,
    /// Bytes of nodes and items.
    pub bytes: u64,
}

/// The tree. It holds indices; the items stay with whoever built it.
#[derive(Clone, Debug)]
pub struct WideTree {
    frame: Frame,
    nodes: Vec<WideNode>,
    items: Vec<u32>,
    bounds: Aabb,
    stats: WideTreeStats,
    lanes: Lanes,
}

impl WideTree {
    /// A tree over items with these boxes; see [`WideTree::over`].
    ///
    /// # Errors
    /// As there.
    pub fn build(bounds: &[Aabb], config: &WideTreeConfig) -> Result<Self, WideTreeError> {
        Self::over(bounds, config)
    }

    /// A tree over items, built in the current thread pool; the same bytes whatever its size.
    ///
    /// # Errors
    /// An item is unbounded, or there are too many for the format or for the memory limit.
    pub fn over<I: Items + ?Sized>(
        items: &I,
        config: &WideTreeConfig,
    ) -> Result<Self, WideTreeError> {
        let count = items.count();
        if count > link::MAX_ITEMS {
            return Err(WideTreeError::TooMany(count));
        }
        let lacking = |needed: u64| WideTreeError::Memory {
            items: count,
            needed,
            limit: config.memory_limit,
        };
        let reference_bytes = |count: usize| (count * size_of::<Reference>()) as u64;
        let mut preparing = reference_bytes(count);
        if config.quality == Quality::Fast {
            preparing += morton::bytes(count);
        }
        if preparing > config.memory_limit {
            return Err(lacking(preparing));
        }
        let (whole, met) = Self::measure(items)?;
        let mut tree = Self {
            frame: Frame::new(&whole),
            nodes: Vec::new(),
            items: Vec::new(),
            bounds: whole,
            stats: WideTreeStats::default(),
            lanes: Lanes::detect(),
        };
        if met == 0 {
            return Ok(tree);
        }
        let mut references = tree.references(items, met);
        let codes = match config.quality {
            Quality::Fast => morton::sort(&mut references),
            Quality::Full => Vec::new(),
        };
        let mut division = None;
        if I::DIVISIBLE && config.quality == Quality::Full {
            let root = PaddedBox::outward(&tree.frame, &whole);
            let how = Division::new(items, Coordinates(tree.frame), &root);
            let room = how.room(&references).min(link::MAX_ITEMS - met);
            // Those that are added stand beside the others for a while.
            let with_room = preparing + 2 * reference_bytes(room);
            if room > 0 && with_room <= config.memory_limit {
                preparing = with_room;
                references.reserve_exact(room);
                references.resize(met + room, Reference::BLANK);
                division = Some(how);
            }
        }
        let leaf_size = config.leaf_size.clamp(1, LARGEST_LEAF);
        let undivided = match config.quality {
            Quality::Fast => UNDIVIDED_FAST,
            Quality::Full => UNDIVIDED_FULL,
        };
        let plan = Plan {
            leaf_size,
            undivided: leaf_size.min(undivided) as usize,
            division,
            // There is a second copy of nodes and items at the end, but no references any more.
            bytes: (config.memory_limit - preparing).min(config.memory_limit / 2),
            taken: AtomicU64::new(0),
        };
        let root = build::divide(Piece::new(&mut references, met, &codes), &plan);
        drop((references, codes));
        // A lone leaf needs a node, too.
        let size = root.bytes() + size_of::<WideNode>() as u64;
        if size > plan.bytes {
            return Err(lacking((2 * size).max(preparing + size)));
        }
        let built = build::collect(root);
        (tree.nodes, tree.items) = (built.nodes, built.items);
        tree.stats.depth = built.depth;
        let links = tree.nodes.iter().flat_map(|node| {
            let used = node.boxes.planes[0].map(|x| x < f32::INFINITY);
            node.links.into_iter().zip(used)
        });
        let leaves = links.filter(|&(link, used)| used && link::items(link).is_some());
        tree.stats.leaves = leaves.count() as u64;
        tree.stats.items = met as u64;
        tree.stats.references = tree.items.len() as u64;
        tree.stats.nodes = tree.nodes.len() as u64;
        let [nodes, items] = tree.bytes();
        tree.stats.bytes = (nodes.len() + items.len()) as u64;
        Ok(tree)
    }

    /// A box around all items, and how many of them are not empty.
    fn measure<I: Items + ?Sized>(items: &I) -> Result<(Aabb, usize), WideTreeError> {
        let nothing = || (Aabb::EMPTY, 0, None::<u32>);
        let indices = (0..items.count() as u32).into_par_iter();
        let (whole, met, unbounded) = indices
            .with_min_len(SHARE)
            .fold(nothing, |(whole, met, unbounded), item| {
                let bounds = items.bounds(item);
                if !bounds.is_bounded() {
                    (whole, met, unbounded.or(Some(item)))
                } else if bounds.is_empty() {
                    (whole, met, unbounded)
                } else {
                    (whole.union(bounds), met + 1, unbounded)
                }
            })
            .reduce(nothing, |(a, m, first), (b, n, second)| {
                (a.union(b), m + n, first.or(second))
            });
        match unbounded {
            Some(item) => Err(WideTreeError::Unbounded(item as usize)),
            None => Ok((whole, met)),
        }
    }

    /// References to the items that are not empty; `met` is how many those are.
    fn references<I: Items + ?Sized>(&self, items: &I, met: usize) -> Vec<Reference> {
        let reference = |item: u32, bounds: &Aabb| {
            Reference::new(PaddedBox::outward(&self.frame, bounds), item)
        };
        let indices = 0..items.count() as u32;
        if met == items.count() {
            let indices = indices.into_par_iter().with_min_len(SHARE);
            return indices
                .map(|item| reference(item, &items.bounds(item)))
                .collect();
        }
        let all = indices.map(|item| (item, items.bounds(item)));
        let with_extent = all.filter(|(_, bounds)| !bounds.is_empty());
        with_extent
            .map(|(item, bounds)| reference(item, &bounds))
            .collect()
    }

    /// A box around all items.
    #[must_use]
    pub const fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Figures about the tree.
    #[must_use]
    pub const fn stats(&self) -> &WideTreeStats {
        &self.stats
    }

    /// Nodes and items as they lie in memory, for hashing and comparing.
    #[must_use]
    pub fn bytes(&self) -> [&[u8]; 2] {
        [
            bytemuck::cast_slice(&self.nodes),
            bytemuck::cast_slice(&self.items),
        ]
    }

    /// The items, leaf by leaf. Places in this list are what a [`LeafVisitor`] is shown.
    #[must_use]
    pub fn items(&self) -> &[u32] {
        &self.items
    }

    /// The places of the items of each leaf, in no particular order.
    pub fn leaves(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        self.nodes.iter().flat_map(|node| {
            let used = node.boxes.planes[0].map(|x| x < f32::INFINITY);
            let links = node.links.into_iter().zip(used);
            links.filter_map(|(link, used)| link::items(link).filter(|_| used))
        })
    }

    /// A point in the tree's coordinates, rounded to the nearest.
    #[must_use]
    pub fn local(&self, point: DVec3) -> [f32; 3] {
        self.frame.point(point).to_array().map(|x| x as f32)
    }

    /// How the kernels run.
    #[must_use]
    pub const fn lanes(&self) -> Lanes {
        self.lanes
    }

    /// The same tree with kernels that run as given. No answer depends on it.
    #[must_use]
    pub const fn with_lanes(mut self, lanes: Lanes) -> Self {
        self.lanes = lanes;
        self
    }

    /// Kernels run as given from now on. No answer depends on it.
    pub const fn set_lanes(&mut self, lanes: Lanes) {
        self.lanes = lanes;
    }
}
