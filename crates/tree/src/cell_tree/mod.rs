//! A cube divided into cubes, as a pointer tree.
//!
//! Blocks of eight nodes stand in one flat array, level by level and in Morton order within a
//! level, so the same scene gives the same bytes whatever built it. A node is one word.

mod build;
mod criteria;
#[cfg(test)]
pub(crate) mod points;
#[cfg(test)]
mod tests;
mod walk;

use octray_math::{Aabb, CellKey, DVec3};

use crate::Tally;

pub use build::Subdivide;
pub use criteria::{Criteria, filled_share};
pub use walk::WalkStack;
pub(crate) use walk::{Slabs, Waiting};

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// No boundary passes through; the number says what is there instead.
    Empty(u32),
    /// Something must be tested; `cost` is the expected work of doing so.
    Occupied {
        /// In units of one plane intersected with a line.
        cost: f64,
        /// How many things there are that might come apart in smaller cells.
        parts: u32,
    },
}

/// One word of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// An empty cell with its state.
    Empty(u32),
    /// An occupied cell: the index of its contents.
    Occupied(u32),
    /// The index of a block of eight children.
    Divided(u32),
}

const TAG_BITS: u32 = 2;

impl Node {
    pub(crate) const fn encode(self) -> u32 {
        match self {
            Self::Empty(state) => state << TAG_BITS,
            Self::Occupied(leaf) => leaf << TAG_BITS | 1,
            Self::Divided(block) => block << TAG_BITS | 2,
        }
    }

    /// Whether the word of a node says that it is empty.
    pub(crate) const fn is_empty(word: u32) -> bool {
        word & 3 == 0
    }

    pub(crate) const fn decode(word: u32) -> Self {
        let payload = word >> TAG_BITS;
        match word & 3 {
            0 => Self::Empty(payload),
            1 => Self::Occupied(payload),
            _ => Self::Divided(payload),
        }
    }
}

/// The tree. Contents of occupied cells are kept beside it by whoever built it.
#[derive(Clone, Debug, PartialEq)]
pub struct CellTree {
    root: Aabb,
    root_node: u32,
    blocks: Vec<[u32; 8]>,
    stats: CellTreeStats,
}

/// What was built.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellTreeStats {
    /// Cells without contents.
    pub empty: u64,
    /// Cells with contents.
    pub occupied: u64,
    /// Cells with children.
    pub divided: u64,
    /// The deepest level that was reached; the root is 0.
    pub depth: u32,
    /// Empty leaves of each depth.
    pub empty_by_depth: Vec<u64>,
    /// Occupied leaves of each depth.
    pub occupied_by_depth: Vec<u64>,
    /// How many parts the occupied cells hold.
    pub parts: Tally,
    /// Bytes of nodes and contents.
    pub bytes: u64,
    /// Bytes of the nodes alone, as they are kept.
    pub node_bytes: u64,
    /// The most bytes that nodes and contents took while they were made, with what the builder keeps
    /// beside every cell.
    pub peak_bytes: u64,
    /// Cells that were left undivided because the depth limit was reached.
    pub stopped_by_depth: u64,
    /// Cells that were left undivided because the tree had become large for what it holds.
    pub stopped_by_size: u64,
    /// Whether it was the memory limit that stopped them.
    pub stopped_by_memory: bool,
}

impl CellTreeStats {
    /// Counts a leaf: of how many parts, if it is occupied.
    pub(crate) fn count_leaf(&mut self, depth: u32, parts: Option<u32>) {
        let by_depth = match parts {
            None => {
                self.empty += 1;
                &mut self.empty_by_depth
            }
            Some(parts) => {
                self.occupied += 1;
                self.parts.add(u64::from(parts));
                &mut self.occupied_by_depth
            }
        };
        let depth = depth as usize;
        if by_depth.len() <= depth {
            by_depth.resize(depth + 1, 0);
        }
        by_depth[depth] += 1;
    }
}

impl CellTree {
    /// The cube that the tree divides.
    #[must_use]
    pub const fn root(&self) -> &Aabb {
        &self.root
    }

    pub(crate) const fn root_node(&self) -> Node {
        Node::decode(self.root_node)
    }

    pub(crate) fn child(&self, block: u32, octant: u32) -> Node {
        Node::decode(self.blocks[block as usize][octant as usize])
    }

    /// Bytes of the nodes alone.
    pub(crate) fn node_bytes(&self) -> u64 {
        size_of_val(self.blocks.as_slice()) as u64
    }

    /// Figures about the tree.
    #[must_use]
    pub const fn stats(&self) -> &CellTreeStats {
        &self.stats
    }

    /// The nodes as they lie in memory, for hashing and comparing.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(self.root_node).chain(self.blocks.iter().flatten().copied())
    }

    /// Visits all leaves in Morton order.
    pub fn visit_leaves(&self, mut visit: impl FnMut(CellKey, Node)) {
        let mut stack = vec![(CellKey::ROOT, Node::decode(self.root_node))];
        while let Some((key, node)) = stack.pop() {
            match node {
                Node::Divided(block) => {
                    let children = &self.blocks[block as usize];
                    let decoded = (0..8).rev().map(|octant| {
                        let word = children[octant as usize];
                        (key.child(octant), Node::decode(word))
                    });
                    stack.extend(decoded);
                }
                leaf => visit(key, leaf),
            }
        }
    }

    /// The smallest cell that holds `point`, `None` outside the root.
    #[must_use]
    pub fn locate(&self, point: DVec3) -> Option<(CellKey, Node)> {
        if !self.root.contains(point) {
            return None;
        }
        let mut key = CellKey::ROOT;
        let mut node = Node::decode(self.root_node);
        let (mut min, mut size) = (self.root.min, self.root.size().x);
        while let Node::Divided(block) = node {
            size *= 0.5;
            let upper = point.cmpge(min + size);
            let octant = upper.bitmask();
            min += DVec3::new(
                f64::from(octant & 1),
                f64::from(octant >> 1 & 1),
                f64::from(octant >> 2 & 1),
            ) * size;
            key = key.child(octant);
            node = Node::decode(self.blocks[block as usize][octant as usize]);
        }
        Some((key, node))
    }
}

/// The cube around `bounds` whose cell faces are exact in `f64` down to the deepest level: its size
/// is a short multiple of a power of two, and its corner a multiple of the smallest cell.
#[must_use]
pub fn enclosing_cube(bounds: &Aabb) -> Aabb {
    let extent = bounds.size().max_element();
    let extent = if extent > 0.0 { extent } else { 1.0 };
    // The power of two at or below the extent; then the size in sixteenths of it.
    let unit = libm::ldexp(1.0, libm::ilogb(extent) - 4);
    let size = unit * (libm::ceil(extent / unit) + 1.0);
    let step = libm::ldexp(unit, -(octray_math::MAX_DEPTH as i32));
    let corner = bounds.center() - size * 0.5;
    let min = DVec3::from_array(corner.to_array().map(|x| libm::floor(x / step) * step));
    Aabb::new(min, min + size)
}
