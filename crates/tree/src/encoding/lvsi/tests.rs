//! The paper's arithmetic, and the leaves found against the pointer tree's.

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

/// A cell of any depth.
fn key() -> impl Strategy<Value = CellKey> {
    (0..=MAX_DEPTH, any::<[u32; 3]>()).prop_map(|(depth, seed)| CellKey {
        depth,
        index: seed.map(|i| i & ((1 << depth) - 1)),
    })
}

/// The paper's row before the remainder is taken, written with sums and powers of two in 128 bits
/// where nothing can overflow.
fn row_number(key: CellKey) -> u128 {
    let [i, j, k] = key.index.map(u128::from);
    let side = 2_u128.pow(key.depth);
    i / 2 + j / 2 * side + k / 2 * side * side
}

#[test]
fn in_32_bits_different_rows_would_become_one_from_depth_12_on() {
    // The halved k of depth L has L - 1 bits above bit 2L.
    let key = |depth: u32| CellKey {
        depth,
        index: [0, 0, 1 << (depth - 1)],
    };
    assert_eq!(parent_of(key(11)).0 as u32, 1 << 31);
    assert_eq!(parent_of(key(12)).0 as u32, 0);
    assert_ne!(
        parent_of(key(12)).0,
        parent_of(CellKey {
            index: [0; 3],
            ..key(12)
        })
        .0
    );
    assert_eq!(parent_of(key(21)).0, 1 << 61);
}

proptest! {
    #[test]
    fn rows_and_slots_are_the_paper_s_at_every_depth(cell in key(), table in 1..u64::from(u32::MAX)) {
        let (parent, depth) = parent_of(cell);
        prop_assert_eq!(u128::from(parent), row_number(cell));
        prop_assert_eq!(u128::from(parent % table), row_number(cell) % u128::from(table));
        prop_assert_eq!(depth, cell.depth);
        let [a, b, c] = cell.index.map(|i| i % 2);
        prop_assert_eq!(cell.octant(), a + 2 * b + 4 * c);
        prop_assert_eq!(child_of(parent, depth, cell.octant()), cell);
    }

    #[test]
    fn siblings_share_a_row_and_have_slots_of_their_own(cell in key(), octant in 0..8_u32) {
        prop_assume!(cell.depth < MAX_DEPTH);
        let child = cell.child(octant);
        prop_assert_eq!(child.parent(), Some(cell));
        prop_assert_eq!(child.octant(), octant);
        let [i, j, k] = cell.index;
        let bit = |axis: u32| octant >> axis & 1;
        prop_assert_eq!(child.index, [2 * i + bit(0), 2 * j + bit(1), 2 * k + bit(2)]);
        prop_assert_eq!(parent_of(child), parent_of(cell.child(octant ^ 7)));
    }

    #[test]
    fn the_way_up_ends_at_the_root(cell in key()) {
        let up: Vec<CellKey> = std::iter::successors(Some(cell), |key| key.parent()).collect();
        prop_assert_eq!(up.len() as u32, cell.depth + 1);
        prop_assert_eq!(up.last(), Some(&CellKey::ROOT));
        let down = up.iter().rev().skip(1).fold(CellKey::ROOT, |at, key| at.child(key.octant()));
        prop_assert_eq!(down, cell);
        for (above, key) in up.iter().enumerate() {
            prop_assert_eq!(key.index, cell.index.map(|i| i >> above));
        }
    }
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
        let loads = [0.25, 0.75, 4.0, 64.0];
        let sizes = loads.map(|load| [PRIME, TWO].map(|table| LvsiTable { load, ..table }));
        for size in sizes.concat() {
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
