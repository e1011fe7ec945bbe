//! Leaves and figures of every division of space.

use octray_math::{Aabb, DVec3};
use proptest::prelude::*;

use super::*;
use crate::Tally;
use crate::cell_tree::points::Points;
use crate::encoding::TableSize;

const DIVISIONS: [Division; 6] = [
    Division::Octree(Encoding::Tree, Traversal::Ordered),
    Division::Octree(Encoding::Tree, Traversal::FujimotoIwata),
    Division::Octree(Encoding::Tree, Traversal::Sung),
    Division::Octree(Encoding::Lvsi(LvsiStore::All), Traversal::Sung),
    Division::Octree(Encoding::Lvsi(LvsiStore::Occupied), Traversal::Sung),
    Division::Grid(None),
];

fn build(
    points: &[DVec3],
    division: Division,
    criteria: &Criteria,
) -> (Partition, Vec<Vec<DVec3>>) {
    Partition::build(
        &Aabb::new(DVec3::splat(-1.0), DVec3::ONE),
        points.to_vec(),
        &Points,
        division,
        criteria,
        LvsiTable::default(),
    )
}

fn leaves(partition: &Partition) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    partition.visit_leaves(|leaf| leaves.push(leaf));
    leaves
}

fn volume(bounds: &Aabb) -> f64 {
    let size = bounds.size();
    size.x * size.y * size.z
}

fn points() -> impl Strategy<Value = Vec<DVec3>> {
    let x = || -1.0..1.0f64;
    let point = (x(), x(), x()).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    proptest::collection::vec(point, 0..60)
}

/// A lattice of `n` points on each axis.
fn lattice(n: u32) -> Vec<DVec3> {
    let at = |i: u32| (f64::from(i) + 0.37) * 2.0 / f64::from(n) - 1.0;
    let all = (0..n * n * n).map(|i| DVec3::new(at(i % n), at(i / n % n), at(i / n / n)));
    all.collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn leaves_fill_the_root_and_are_what_the_figures_count(points in points(), max_depth in 0..9u32) {
        let criteria = Criteria { max_depth, ..Criteria::default() };
        let tree = leaves(&build(&points, DIVISIONS[0], &criteria).0);
        for division in DIVISIONS {
            let (partition, contents) = build(&points, division, &criteria);
            let found = leaves(&partition);
            let stats = &partition.stats().cells;
            let is_occupied = |leaf: &&Leaf| matches!(leaf.node, Node::Occupied(_));
            let occupied = found.iter().filter(is_occupied).count() as u64;
            prop_assert_eq!(occupied, stats.occupied);
            prop_assert_eq!(stats.occupied, contents.len() as u64);
            prop_assert_eq!(stats.occupied, stats.occupied_by_depth.iter().sum::<u64>());
            prop_assert_eq!(stats.empty, stats.empty_by_depth.iter().sum::<u64>());
            let sizes: Tally = contents.iter().map(|c| c.len() as u64).collect();
            prop_assert_eq!(&stats.parts, &sizes);
            prop_assert!(stats.node_bytes <= stats.bytes && stats.bytes <= stats.peak_bytes);
            let only_occupied = matches!(division, Division::Octree(Encoding::Lvsi(LvsiStore::Occupied), _));
            if only_occupied {
                prop_assert_eq!(found.len() as u64, stats.occupied);
            } else {
                prop_assert_eq!(found.len() as u64, stats.occupied + stats.empty);
                let share: f64 = found.iter().map(|leaf| volume(&leaf.bounds)).sum::<f64>()
                    / volume(partition.bounds());
                prop_assert!((share - 1.0).abs() < 1e-9, "{share}");
            }
            // Every point lies in an occupied leaf that holds it, as `locate` says.
            for point in &points {
                let inside = |leaf: &&Leaf| leaf.bounds.contains(*point);
                let holds = |leaf: &Leaf| {
                    matches!(leaf.node, Node::Occupied(i) if contents[i as usize].contains(point))
                };
                prop_assert!(found.iter().filter(inside).all(holds));
                prop_assert!(found.iter().any(|leaf| leaf.bounds.contains(*point)));
                prop_assert!(matches!(partition.locate(*point), Some(Node::Occupied(_))));
            }
            // Whatever keeps them, they are the leaves of the tree.
            if let Division::Octree(..) = division {
                for leaf in &found {
                    prop_assert!(tree.contains(leaf));
                    let depth = leaf.key.depth as usize;
                    let by_depth = match leaf.node {
                        Node::Occupied(_) => &stats.occupied_by_depth,
                        _ => &stats.empty_by_depth,
                    };
                    prop_assert!(by_depth[depth] > 0);
                }
            }
        }
    }
}

#[test]
fn no_leaf_above_the_deepest_level_holds_more_parts_than_allowed() {
    let points = lattice(12);
    for max_parts in [1, 3, 20] {
        let criteria = Criteria {
            max_depth: 6,
            max_parts,
            by_cost: false,
            ..Criteria::default()
        };
        for division in &DIVISIONS[..5] {
            let (partition, contents) = build(&points, *division, &criteria);
            let cells = &partition.stats().cells;
            assert!(cells.parts.max() <= u64::from(max_parts));
            // None is divided that need not be: siblings together hold more.
            assert!(cells.divided > 0 && contents.len() < points.len().max(2) + 1);
            let tree = leaves(&build(&points, DIVISIONS[0], &criteria).0);
            for leaf in tree.iter().filter(|leaf| leaf.key.depth > 0) {
                let parent = leaf.key.parent().expect("below the root");
                let bounds = parent.bounds(partition.bounds());
                let margin = bounds.size().x * 1e-5;
                let near = bounds.inflated(margin);
                let held = points.iter().filter(|p| near.contains(**p)).count();
                assert!(held > max_parts as usize, "{leaf:?}");
            }
        }
    }
}

#[test]
fn without_cost_or_other_criteria_depth_and_memory_end_the_building() {
    let off = Criteria {
        by_cost: false,
        max_depth: 5,
        ..Criteria::default()
    };
    let points = lattice(8);
    let (partition, _) = build(&points, DIVISIONS[0], &off);
    let cells = &partition.stats().cells;
    assert_eq!(cells.occupied_by_depth, [0, 0, 0, 0, 0, cells.occupied]);
    assert_eq!(cells.stopped_by_depth, cells.occupied);
    let deep = Criteria {
        max_depth: 21,
        memory_limit: 3 << 20,
        ..off
    };
    let (partition, _) = build(&points, DIVISIONS[0], &deep);
    let cells = &partition.stats().cells;
    assert!(cells.stopped_by_memory && cells.stopped_by_size > 0);
    assert!(cells.bytes <= deep.memory_limit && cells.depth > 5);
    // One batch of cells may be divided before it is known that there is no room.
    assert!(cells.peak_bytes <= 4 * deep.memory_limit, "{cells:?}");
}

#[test]
fn what_saves_most_is_divided_however_late_it_comes() {
    // More cells on one level than are worked on at a time, the crowded ones last of all.
    let mut points = lattice(40);
    let mut seed = 3;
    let mut real = || {
        seed = octray_math::hash_combine(seed, 5);
        octray_math::unit_f64(seed)
    };
    let near_corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * 0.2 + 0.8;
    points.extend((0..4000).map(|_| near_corner(real(), real(), real())));
    let shallow = Criteria {
        max_depth: 5,
        ..Criteria::default()
    };
    let (partition, _) = build(&points, DIVISIONS[0], &shallow);
    let stats = &partition.stats().cells;
    assert!(stats.occupied > 1 << 14 && !stats.stopped_by_memory);
    let scarce = Criteria {
        memory_limit: stats.peak_bytes + stats.peak_bytes / 10,
        ..Criteria::default()
    };
    let (partition, _) = build(&points, DIVISIONS[0], &scarce);
    assert!(partition.stats().cells.stopped_by_memory);
    let mut left = [0, 0];
    for leaf in leaves(&partition) {
        if leaf.key.depth == 5 && matches!(leaf.node, Node::Occupied(_)) {
            let crowd = Aabb::new(DVec3::splat(0.8), DVec3::ONE);
            left[usize::from(crowd.contains_box(&leaf.bounds))] += 1;
        }
    }
    assert!(left[0] > 1000 && left[1] == 0, "{left:?}");
}

#[test]
fn a_grid_keeps_to_the_memory_and_says_so() {
    let points = lattice(6);
    let tight = Criteria {
        memory_limit: 40_000,
        ..Criteria::default()
    };
    let (free, _) = build(&points, Division::Grid(Some(64)), &Criteria::default());
    assert_eq!(free.stats().resolution, Some([64; 3]));
    assert!(!free.stats().cells.stopped_by_memory);
    let (small, contents) = build(&points, Division::Grid(Some(64)), &tight);
    let stats = small.stats();
    assert_eq!(stats.resolution, Some([16; 3]));
    assert!(stats.cells.stopped_by_memory && stats.cells.bytes <= tight.memory_limit);
    let held: usize = contents.iter().map(Vec::len).sum();
    assert!(held >= points.len());
    let none = Criteria {
        memory_limit: 0,
        ..Criteria::default()
    };
    for division in DIVISIONS {
        let (least, contents) = build(&points, division, &none);
        assert!(least.stats().cells.stopped_by_memory || division == Division::Grid(None));
        assert_eq!(contents, std::slice::from_ref(&points));
    }
}

#[test]
fn a_cell_that_its_objects_fill_is_not_divided() {
    /// One box that stands for an object.
    struct Block(Aabb);
    impl Subdivide for Block {
        type Content = bool;
        fn restrict(&self, parent: &bool, cell: &Aabb) -> bool {
            *parent && self.0.overlaps(cell)
        }
        fn describe(&self, content: &bool) -> crate::Cell {
            match content {
                false => crate::Cell::Empty(0),
                true => crate::Cell::Occupied {
                    cost: 1.0,
                    parts: 1,
                },
            }
        }
        fn bytes(&self, _: &bool) -> u64 {
            8
        }
        fn share(&self, content: &bool, cell: &Aabb) -> f64 {
            crate::filled_share(cell, content.then_some(self.0))
        }
    }
    let block = Block(Aabb::new(DVec3::splat(-0.9), DVec3::new(0.9, 0.9, -0.1)));
    let with = |max_share| {
        let criteria = Criteria {
            max_depth: 6,
            by_cost: false,
            max_share,
            ..Criteria::default()
        };
        let (tree, _) = CellTree::build(
            Aabb::new(DVec3::splat(-1.0), DVec3::ONE),
            true,
            &block,
            &criteria,
        );
        tree
    };
    let full = with(1.0);
    assert_eq!(full.stats().occupied, full.stats().stopped_by_depth);
    // A third of the root is filled, but almost all of its lower octants: they stay whole.
    let half = with(0.5);
    assert!(half.stats().divided >= 1 && half.stats().occupied < full.stats().occupied / 10);
    half.visit_leaves(|key, node| {
        let share = crate::filled_share(&key.bounds(half.root()), [block.0]);
        let occupied = matches!(node, Node::Occupied(_));
        assert!(
            !occupied || share > 0.5 || key.depth == 6,
            "{key:?} {share}"
        );
    });
    assert_eq!(with(0.1).stats().divided, 0);
}

#[test]
fn the_table_s_size_and_load_are_a_choice() {
    let points = lattice(10);
    let criteria = Criteria {
        by_cost: false,
        max_parts: 1,
        ..Criteria::default()
    };
    let bounds = Aabb::new(DVec3::splat(-1.0), DVec3::ONE);
    for load in [0.25, 1.0, 4.0] {
        for size in [TableSize::Prime, TableSize::PowerOfTwo] {
            let table = LvsiTable { size, load };
            let (partition, _) = Partition::build(
                &bounds,
                points.clone(),
                &Points,
                DIVISIONS[4],
                &criteria,
                table,
            );
            let stats = partition.stats().lvsi.expect("a table");
            let wanted = stats.rows as f64 / load;
            assert!(stats.table_size as f64 >= wanted);
            match size {
                TableSize::Prime => assert!((stats.table_size as f64) < 1.1 * wanted + 10.0),
                TableSize::PowerOfTwo => {
                    assert!(stats.table_size.is_power_of_two());
                    assert!((stats.table_size as f64) < 2.0 * wanted);
                }
            }
            assert_eq!(stats.bytes, 4 * stats.table_size + 48 * stats.rows);
        }
    }
}
