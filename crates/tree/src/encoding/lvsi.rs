//! The octree as a hash table of leaves: the Leveled Voxel Space Index of Sung, *A DDA Octree
//! Traversal Algorithm for Ray Tracing* (1991), as Martinka (1993), section 5, describes it.
//!
//! A cell of depth `L` is `L:(i,j,k)`, `0 <= i,j,k < 2^L`. Rows have eight slots, one for each child of
//! one parent:
//!
//! ```text
//! row  = ((i>>1) | (j>>1) << L | (k>>1) << 2L) mod TableSize      (64 bits: L up to 21)
//! slot = (i & 1) + 2 (j & 1) + 4 (k & 1)
//! ```
//!
//! Where this departs from the paper's text, which does not work as it stands:
//!
//! * Different parents fall on one row, also parents of different depths (`0:(0,0,0)` and
//!   `1:(0,0,0)` have the same number). A row carries its parent's key, and rows with one number form a
//!   chain.
//! * The paper's slot is the *sum* of the low bits, which puts eight children on four slots.
//! * Only full leaves are stored, so a search that passes the root has found empty space: see
//!   [`Found`]. [`LvsiStore::All`] also keeps the empty leaves, so that one search tells how far the
//!   emptiness reaches.
//! * A table size that is a power of two keeps only the low bits of `i`; see [`TableSize`].

use octray_math::{Aabb, CellKey, DVec3};

use crate::cell_tree::{CellTree, Node};

/// Which leaves a table keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LvsiStore {
    /// Those with contents: the paper's.
    #[default]
    Occupied,
    /// Empty ones too.
    All,
}

/// What number the table size is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableSize {
    /// The first prime at or above what the load asks for.
    #[default]
    Prime,
    /// The first power of two at or above it: the paper's hash function then sees only the low bits
    /// of `i`. Kept to show what that costs.
    PowerOfTwo,
}

/// How large the table is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LvsiTable {
    /// What number its size is.
    pub size: TableSize,
    /// Rows used for each row of the table, in [`LvsiTable::LOADS`] (taken as the nearest in it); less
    /// than asked for where the size is rounded up.
    pub load: f64,
}

impl LvsiTable {
    /// Loads that make sense, lowest and highest.
    pub const LOADS: [f64; 2] = [1.0 / 64.0, 64.0];

    /// The table size for so many rows.
    fn size_for(self, rows: u64) -> u64 {
        let [low, high] = Self::LOADS;
        // No NaN gets through.
        let load = if self.load >= low {
            self.load.min(high)
        } else {
            low
        };
        let wanted = (libm::ceil(rows as f64 / load) as u64).max(1);
        match self.size {
            TableSize::Prime => (wanted..).find(|n| is_prime(*n)).unwrap_or(wanted),
            TableSize::PowerOfTwo => wanted.next_power_of_two(),
        }
    }
}

impl Default for LvsiTable {
    fn default() -> Self {
        Self {
            size: TableSize::Prime,
            load: 0.75,
        }
    }
}

/// The answer of [`Lvsi::leaf_parent`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// The leaf that holds the cell, with its node.
    Leaf(CellKey, Node),
    /// No stored leaf holds it: it lies in empty space, of unknown extent.
    Nothing,
}

/// The children of one parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Row {
    /// The parent's number and the depth of the children (0: the root cell itself).
    parent: u64,
    depth: u32,
    /// The next row of the same chain, [`NO_ROW`] for the last.
    next: u32,
    /// Encoded nodes, [`ABSENT`] where no leaf is stored.
    slots: [u32; 8],
}

const NO_ROW: u32 = u32::MAX;
/// No leaf has this word: nodes that are leaves have the tag 0 or 1.
const ABSENT: u32 = u32::MAX;

/// See the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lvsi {
    heads: Vec<u32>,
    rows: Vec<Row>,
    depth: u32,
    leaves: u64,
}

/// What a table costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LvsiStats {
    /// Stored leaves.
    pub leaves: u64,
    /// Rows in use.
    pub rows: u64,
    /// Rows that the hash function can reach.
    pub table_size: u64,
    /// Of these, how many it does reach.
    pub heads_used: u64,
    /// Rows on the longest chain.
    pub longest_chain: u64,
    /// Of the table and its rows.
    pub bytes: u64,
}

/// The paper's number of a parent, and the depth of its children.
const fn parent_of(key: CellKey) -> (u64, u32) {
    let [i, j, k] = key.index;
    let bits = key.depth;
    let number = (i >> 1) as u64 | ((j >> 1) as u64) << bits | ((k >> 1) as u64) << (2 * bits);
    (number, key.depth)
}

/// The cell in a slot of a row: what [`parent_of`] and the slot were made from.
fn child_of(parent: u64, depth: u32, slot: u32) -> CellKey {
    let mask = (1 << depth) - 1;
    let index = |axis: u32| {
        let half = (parent >> (axis * depth) & mask) as u32;
        half << 1 | slot >> axis & 1
    };
    CellKey {
        depth,
        index: [index(0), index(1), index(2)],
    }
}

impl Lvsi {
    /// The leaves of a tree.
    #[must_use]
    pub fn new(tree: &CellTree, store: LvsiStore, size: LvsiTable) -> Self {
        let mut leaves: Vec<(CellKey, Node)> = Vec::new();
        tree.visit_leaves(|key, node| {
            if store == LvsiStore::All || matches!(node, Node::Occupied(_)) {
                leaves.push((key, node));
            }
        });
        leaves.sort_by_key(|(key, _)| (parent_of(*key).1, parent_of(*key).0, key.octant()));
        let mut table = Self {
            heads: Vec::new(),
            rows: Vec::new(),
            depth: tree.stats().depth,
            leaves: leaves.len() as u64,
        };
        for (key, node) in leaves {
            let (parent, depth) = parent_of(key);
            let is_new = table
                .rows
                .last()
                .is_none_or(|row| (row.parent, row.depth) != (parent, depth));
            if is_new {
                table.rows.push(Row {
                    parent,
                    depth,
                    next: NO_ROW,
                    slots: [ABSENT; 8],
                });
            }
            if let Some(row) = table.rows.last_mut() {
                row.slots[key.octant() as usize] = node.encode();
            }
        }
        let size = size.size_for(table.rows.len() as u64);
        table.heads = vec![NO_ROW; size as usize];
        for index in (0..table.rows.len()).rev() {
            let head = (table.rows[index].parent % size) as usize;
            table.rows[index].next = table.heads[head];
            table.heads[head] = index as u32;
        }
        table
    }

    /// The depth of the Basic Traversal Units, the smallest cells of the tree.
    #[must_use]
    pub const fn depth(&self) -> u32 {
        self.depth
    }

    /// The leaf stored under exactly this key. `looked_at` counts the rows.
    fn get(&self, key: CellKey, looked_at: &mut u64) -> Option<Node> {
        let (parent, depth) = parent_of(key);
        let mut next = self.heads[(parent % self.heads.len() as u64) as usize];
        *looked_at += 1;
        while let Some(row) = self.rows.get(next as usize) {
            if (row.parent, row.depth) == (parent, depth) {
                let word = row.slots[key.octant() as usize];
                return (word != ABSENT).then(|| Node::decode(word));
            }
            next = row.next;
            *looked_at += u64::from(next != NO_ROW);
        }
        None
    }

    /// The paper's `GetLeafParent(L, i, j, k)`: looks the cell up, and while it is absent its
    /// parent. Adds the number of rows looked at to `looked_at`.
    pub fn leaf_parent(&self, cell: CellKey, looked_at: &mut u64) -> Found {
        let mut key = Some(cell);
        while let Some(at) = key {
            if let Some(node) = self.get(at, looked_at) {
                return Found::Leaf(at, node);
            }
            key = at.parent();
        }
        Found::Nothing
    }

    /// Visits the stored leaves, by depth and then by the paper's numbers.
    pub fn visit_leaves(&self, mut visit: impl FnMut(CellKey, Node)) {
        for row in &self.rows {
            for (slot, word) in (0_u32..).zip(row.slots) {
                if word != ABSENT {
                    visit(child_of(row.parent, row.depth, slot), Node::decode(word));
                }
            }
        }
    }

    /// The leaf at a point of the cube `root`, `None` if none is stored there.
    #[must_use]
    pub fn locate(&self, root: &Aabb, point: DVec3) -> Option<Node> {
        let unit = CellKey::containing(root, self.depth, point)?;
        match self.leaf_parent(unit, &mut 0) {
            Found::Leaf(_, node) => Some(node),
            Found::Nothing => None,
        }
    }

    /// The table as it lies in memory, for hashing and comparing.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let rows = self.rows.iter().flat_map(|row| {
            let parent = [row.parent as u32, (row.parent >> 32) as u32];
            let rest = [row.depth, row.next];
            parent.into_iter().chain(rest).chain(row.slots)
        });
        self.heads.iter().copied().chain(rows)
    }

    /// What the table costs.
    #[must_use]
    pub fn stats(&self) -> LvsiStats {
        let chain = |head: &u32| {
            let mut length = 0;
            let mut next = *head;
            while let Some(row) = self.rows.get(next as usize) {
                length += 1;
                next = row.next;
            }
            length
        };
        LvsiStats {
            leaves: self.leaves,
            rows: self.rows.len() as u64,
            table_size: self.heads.len() as u64,
            heads_used: self.heads.iter().filter(|head| **head != NO_ROW).count() as u64,
            longest_chain: self.heads.iter().map(chain).max().unwrap_or(0),
            bytes: (size_of_val(self.heads.as_slice()) + size_of_val(self.rows.as_slice())) as u64,
        }
    }
}

fn is_prime(n: u64) -> bool {
    n >= 2
        && (2..)
            .take_while(|d| d * d <= n)
            .all(|d| !n.is_multiple_of(d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell_tree::points::tree;
    use octray_math::MAX_DEPTH;
    use proptest::prelude::*;

    const PRIME: LvsiTable = LvsiTable {
        size: TableSize::Prime,
        load: 0.75,
    };
    const TWO: LvsiTable = LvsiTable {
        size: TableSize::PowerOfTwo,
        ..PRIME
    };

    fn point() -> impl Strategy<Value = DVec3> {
        let x = || -1.0..1.0f64;
        (x(), x(), x()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    /// The smallest cell at `depth` that holds a point.
    fn unit(tree: &CellTree, point: DVec3, depth: u32) -> CellKey {
        CellKey::containing(tree.root(), depth, point).expect("inside")
    }

    #[test]
    fn the_root_and_its_first_child_share_a_row_number_and_are_told_apart() {
        let alone = tree(&[], 4);
        let all = Lvsi::new(&alone, LvsiStore::All, PRIME);
        let mut rows = 0;
        assert_eq!(
            all.leaf_parent(CellKey::ROOT.child(0), &mut rows),
            Found::Leaf(CellKey::ROOT, Node::Empty(0))
        );
        assert_eq!(rows, 2);
        let only_full = Lvsi::new(&alone, LvsiStore::Occupied, PRIME);
        assert_eq!(
            only_full.leaf_parent(CellKey::ROOT.child(0), &mut rows),
            Found::Nothing
        );
        assert_eq!(only_full.stats().leaves, 0);
    }

    #[test]
    fn a_power_of_two_crowds_the_rows_that_a_prime_spreads() {
        let mut seed = 1;
        let mut real = || {
            seed = octray_math::hash_combine(seed, 7);
            octray_math::unit_f64(seed) * 2.0 - 1.0
        };
        // In a plane across x, where the hash function's lowest bits are all the same.
        let points: Vec<DVec3> = (0..3000).map(|_| DVec3::new(0.3, real(), real())).collect();
        let tree = tree(&points, 12);
        let prime = Lvsi::new(&tree, LvsiStore::Occupied, PRIME).stats();
        let two = Lvsi::new(&tree, LvsiStore::Occupied, TWO).stats();
        assert_eq!(prime.leaves, two.leaves);
        assert!(two.table_size >= prime.table_size);
        assert!(20 * two.heads_used < prime.heads_used, "{two:?} {prime:?}");
        assert!(two.longest_chain > 20 * prime.longest_chain);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_leaf_found_is_the_pointer_tree_s(
            points in proptest::collection::vec(point(), 1..40),
            asked in proptest::collection::vec(point(), 100),
            max_depth in 1..=MAX_DEPTH,
        ) {
            let tree = tree(&points, max_depth);
            for size in [PRIME, TWO] {
                let full = Lvsi::new(&tree, LvsiStore::Occupied, size);
                let all = Lvsi::new(&tree, LvsiStore::All, size);
                prop_assert_eq!(full.depth(), tree.stats().depth);
                for p in asked.iter().chain(&points) {
                    let (key, node) = tree.locate(*p).expect("inside");
                    let unit = unit(&tree, *p, full.depth());
                    let mut rows = 0;
                    prop_assert_eq!(all.leaf_parent(unit, &mut rows), Found::Leaf(key, node));
                    let expected = match node {
                        Node::Occupied(_) => Found::Leaf(key, node),
                        _ => Found::Nothing,
                    };
                    prop_assert_eq!(full.leaf_parent(unit, &mut rows), expected);
                }
            }
        }
    }
}
