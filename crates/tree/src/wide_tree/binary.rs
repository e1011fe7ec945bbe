//! Octants, split axis by axis: a binary radix tree over Morton codes.
//!
//! An octree cell is halved in z, then y, then x; halves without items are passed over. After
//! Karras (2012), node `i` is the one that separates the sorted items `i` and `i + 1`, so subtrees
//! own contiguous pieces of the array and are built in parallel without coordination.

use octray_math::{Aabb, DVec3, MAX_DEPTH};

use super::frame::{Frame, LocalBox};

/// Splits below a node: three times 63 by code (a cell full of items whose centres have the same
/// code gets a finer grid of its own, twice), then halves of up to 2^28 items.
pub(super) const MAX_HEIGHT: u32 = 3 * 3 * MAX_DEPTH + 28;
const REFINEMENTS: u32 = 2;
/// Below this many items a task is not worth its overhead.
pub(super) const SEQUENTIAL: usize = 4096;

/// An item by the place of its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    code: u64,
    pub(super) item: u32,
}

/// A part of the binary tree: an item, or an inner node with two parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subtree {
    pub(super) bounds: LocalBox,
    /// Of an inner node, its index.
    node: u32,
    /// The first item in the sorted order.
    pub(super) first: u32,
    pub(super) count: u32,
    /// Splits on the longest way down.
    pub(super) height: u32,
}

/// What all tasks read.
#[derive(Debug)]
pub(super) struct Source<'a> {
    pub(super) bounds: &'a [Aabb],
    pub(super) frame: Frame,
    pub(super) leaf_size: u32,
}

/// The finished binary tree.
#[derive(Debug)]
pub(super) struct Binary {
    pub(super) keys: Vec<Key>,
    nodes: Vec<[Subtree; 2]>,
    pub(super) root: Subtree,
}

/// The Morton code of a point of `[0, 1]^3`, 21 bits per axis, x lowest.
fn morton(unit: DVec3) -> u64 {
    let side = f64::from(1u32 << MAX_DEPTH);
    let spread = |x: f64| {
        // The conversion saturates, so a rounded 1 lands in the last cell.
        let mut v = ((x * side) as u64).min((1 << MAX_DEPTH) - 1);
        v = (v | v << 32) & 0x001f_0000_0000_ffff;
        v = (v | v << 16) & 0x001f_0000_ff00_00ff;
        v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
        v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(unit.x) | spread(unit.y) << 1 | spread(unit.z) << 2
}

/// Gives every item its code in the smallest cube around the centres. False if they coincide.
fn encode(keys: &mut [Key], source: &Source<'_>) -> bool {
    use rayon::prelude::*;
    let center = |key: &Key| {
        source
            .frame
            .point(source.bounds[key.item as usize].center())
    };
    let around = |part: &[Key]| Aabb::from_points(part.iter().map(center));
    let cube = keys
        .par_chunks(SEQUENTIAL)
        .map(around)
        .reduce(|| Aabb::EMPTY, Aabb::union);
    let size = cube.size().max_element();
    let distinct = size > 0.0;
    keys.par_chunks_mut(SEQUENTIAL).for_each(|part| {
        for key in part {
            key.code = if distinct {
                morton((center(key) - cube.min) / size)
            } else {
                0
            };
        }
    });
    distinct
}

impl Binary {
    /// `items` are distinct indices into the source's bounds, ascending, at least one.
    pub(super) fn build(items: impl Iterator<Item = u32>, source: &Source<'_>) -> Self {
        use rayon::prelude::*;
        let mut keys: Vec<Key> = items.map(|item| Key { code: 0, item }).collect();
        encode(&mut keys, source);
        keys.par_sort_unstable();
        let mut nodes = vec![[Subtree::BLANK; 2]; keys.len() - 1];
        let root = build(&mut keys, &mut nodes, 0, 0, source);
        Self { keys, nodes, root }
    }

    /// The two parts of a subtree of at least two items.
    pub(super) fn parts(&self, of: &Subtree) -> [Subtree; 2] {
        self.nodes[of.node as usize]
    }
}

impl Subtree {
    const BLANK: Self = Self {
        bounds: LocalBox {
            min: [0.0; 3],
            max: [0.0; 3],
        },
        node: 0,
        first: 0,
        count: 0,
        height: 0,
    };
}

/// Builds the tree over `keys` (sorted, not empty), which begin at `first` in the whole order.
/// `nodes` is one shorter than `keys`.
fn build(
    keys: &mut [Key],
    nodes: &mut [[Subtree; 2]],
    first: u32,
    refinement: u32,
    source: &Source<'_>,
) -> Subtree {
    let count = keys.len();
    if count == 1 {
        return Subtree {
            bounds: source.frame.outward(&source.bounds[keys[0].item as usize]),
            first,
            count: 1,
            ..Subtree::BLANK
        };
    }
    let differing = keys[0].code ^ keys[count - 1].code;
    let middle = if differing != 0 {
        let bit = 1u64 << differing.ilog2();
        keys.partition_point(|key| key.code & bit == 0)
    } else if refinement < REFINEMENTS && count > source.leaf_size as usize && encode(keys, source)
    {
        keys.sort_unstable();
        return build(keys, nodes, first, refinement + 1, source);
    } else {
        count / 2
    };
    let (left_keys, right_keys) = keys.split_at_mut(middle);
    let (left_nodes, rest) = nodes.split_at_mut(middle - 1);
    let (own, right_nodes) = rest.split_at_mut(1);
    let split = first + middle as u32;
    let mut left = || build(left_keys, left_nodes, first, refinement, source);
    let mut right = || build(right_keys, right_nodes, split, refinement, source);
    let parts: [Subtree; 2] = if count > SEQUENTIAL {
        rayon::join(left, right).into()
    } else {
        [left(), right()]
    };
    own[0] = parts;
    let [left, right] = parts;
    Subtree {
        bounds: left.bounds.union(&right.bounds),
        node: split - 1,
        first,
        count: count as u32,
        height: 1 + left.height.max(right.height),
    }
}
