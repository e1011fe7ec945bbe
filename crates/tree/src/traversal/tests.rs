//! All traversals against the ordered one.

use octray_math::{Aabb, DVec3, Interval, Ray};
use proptest::prelude::*;

use super::{LeafSearch, Steps, TreePath};
use crate::cell_tree::points::{Points, tree};
use crate::encoding::{Lvsi, LvsiStore, LvsiTable};
use crate::{CellTree, Grid, Node, WalkStack};

type Visits = Vec<(u32, Interval)>;
type Visit<'a> = &'a mut dyn FnMut(u32, Interval) -> f64;

fn ordered(tree: &CellTree, ray: &Ray, within: Interval) -> Visits {
    let mut found = Vec::new();
    tree.walk(ray, within, &mut WalkStack::default(), |leaf, part| {
        found.push((leaf, part));
        f64::INFINITY
    });
    found
}

fn all_others(tree: &CellTree, ray: &Ray, within: Interval) -> Vec<(&'static str, Visits, Steps)> {
    let mut results = Vec::new();
    let mut run = |name, walk: &dyn Fn(Visit<'_>) -> Steps| {
        let mut found = Vec::new();
        let steps = walk(&mut |leaf, part| {
            found.push((leaf, part));
            f64::INFINITY
        });
        results.push((name, found, steps));
    };
    let root = tree.root();
    run("tree sung", &|visit| {
        tree.walk_units(root, ray, within, visit)
    });
    for (name, store) in [
        ("lvsi sung", LvsiStore::Occupied),
        ("lvsi-empty sung", LvsiStore::All),
    ] {
        let table = Lvsi::new(tree, store, LvsiTable::default());
        run(name, &|visit| table.walk_units(root, ray, within, visit));
    }
    run("tree fujimoto-iwata", &|visit| {
        tree.walk_neighbours(ray, within, &mut TreePath::default(), visit)
    });
    results
}

#[test]
fn a_grid_is_walked_through_the_voxels_that_the_line_meets() {
    let box_ = Aabb::new(DVec3::new(-1.0, -1.0, -0.5), DVec3::new(1.0, 1.0, 0.5));
    let points = [
        DVec3::new(-0.9, 0.1, 0.1),
        DVec3::new(0.1, 0.15, 0.1),
        DVec3::new(0.9, 0.1, 0.1),
        DVec3::new(0.9, -0.9, 0.4),
    ];
    let (grid, contents) = Grid::build(box_, points.to_vec(), &Points, [8, 8, 4], u64::MAX);
    assert_eq!(grid.occupied(), 4);
    let along = |origin: DVec3, direction: DVec3| {
        let mut found = Vec::new();
        let ray = Ray::new(origin, direction);
        let steps = grid.walk(&ray, Interval::new(0.0, f64::INFINITY), |leaf, part| {
            assert!(part.start <= part.end);
            found.push(contents[leaf as usize][0]);
            f64::INFINITY
        });
        (found, steps.cells)
    };
    let there = along(DVec3::new(-9.0, 0.1, 0.1), DVec3::X);
    assert_eq!(there, (points[..3].to_vec(), 8));
    let (back, _) = along(DVec3::new(9.0, 0.1, 0.1), DVec3::NEG_X);
    assert_eq!(back, [points[2], points[1], points[0]]);
    assert_eq!(along(DVec3::new(0.0, 0.1, 0.1), DVec3::X).0, points[1..3]);
    assert_eq!(along(DVec3::new(-9.0, 5.0, 0.1), DVec3::X), (vec![], 0));
    // A diagonal line changes its voxel once per face: 8 + 8 + 4 - 2 voxels, less shared faces.
    let corner = DVec3::new(-1.0, -1.0, -0.5);
    let (_, cells) = along(corner * 1.01, -corner + DVec3::new(0.01, 0.02, 0.0));
    assert!((8..=18).contains(&cells), "{cells}");
}

#[test]
fn grid_resolutions_follow_the_shape_and_the_limit() {
    let long = Aabb::new(DVec3::ZERO, DVec3::new(100.0, 1.0, 1.0));
    let [i, j, k] = Grid::resolution_for(&long, 1000, 1 << 30);
    assert!(i > 50 * j && j == k, "{i} {j} {k}");
    for things in [0, 1, 10, 100_000, u64::MAX / 4] {
        for limit in [1, 1000, 1 << 20] {
            let n = Grid::resolution_for(&long, things, limit);
            assert!(n.iter().map(|n| u64::from(*n)).product::<u64>() <= limit);
        }
    }
    let point = Aabb::new(DVec3::ONE, DVec3::ONE);
    assert_eq!(Grid::resolution_for(&point, 5, 100), [1; 3]);
}

/// Contents are decided for cells grown by a margin, so a line in the margin belongs to the cells beside it,
/// also while it moves away from them.
#[test]
fn lines_beside_the_cells_and_away_from_them_visit_those_they_pass() {
    let points: Vec<DVec3> = (0..8)
        .flat_map(|i| [-1.0, 1.0].map(|side| DVec3::new(side, -side, f64::from(2 * i - 7) / 7.0)))
        .collect();
    let tree = tree(&points, 4);
    let bounds = *tree.root();
    let (grid, _) = Grid::build(bounds, points.clone(), &Points, [8; 3], u64::MAX);
    let beside = bounds.size().x * CellTree::CONTENT_MARGIN / 8.0;
    for (side, rise) in [(-1.0, 1.0), (-1.0, -1.0), (1.0, 1.0), (1.0, -1.0)] {
        let out = DVec3::new(side, -side, 0.0);
        let edge = bounds.center() + out * (0.5 * bounds.size().x + beside);
        let drift = out * 1e-17;
        for outwards in [drift, -drift] {
            let ray = Ray::new(edge - DVec3::Z * (rise * 3.0), DVec3::Z * rise + outwards);
            let within = Interval::new(0.0, f64::INFINITY);
            let expected: Vec<u32> = ordered(&tree, &ray, within).iter().map(|v| v.0).collect();
            assert!(expected.len() >= 4, "{expected:?}");
            for (name, found, _) in all_others(&tree, &ray, within) {
                let found: Vec<u32> = found.iter().map(|v| v.0).collect();
                assert_eq!(found, expected, "{name}");
            }
            let mut voxels = 0;
            grid.walk(&ray, within, |_, _| {
                voxels += 1;
                f64::INFINITY
            });
            assert_eq!(voxels, 8);
        }
    }
}

fn point() -> impl Strategy<Value = DVec3> {
    let x = || prop_oneof![-1.0..1.0f64, (-4..=4i32).prop_map(|i| f64::from(i) * 0.25)];
    (x(), x(), x()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_traversal_visits_the_cells_that_the_ordered_one_visits(
        points in proptest::collection::vec(point(), 1..40),
        origin in point(), direction in point(), away in prop_oneof![Just(0.0), Just(0.5), 1.0..1e6f64],
        max_depth in 1..9u32,
        from in prop_oneof![Just(f64::NEG_INFINITY), Just(0.0)],
    ) {
        prop_assume!(direction != DVec3::ZERO);
        let tree = tree(&points, max_depth);
        let ray = Ray::new(origin - direction * away, direction);
        let within = Interval::new(from, f64::INFINITY);
        let expected = ordered(&tree, &ray, within);
        // A cell that the line only grazes may be left out: what counts lies in its neighbours too.
        let slack = tree.root().size().x * CellTree::CONTENT_MARGIN / direction.length();
        // So is one whose inside, a margin away from its faces, the line does not meet.
        let margin = tree.root().size().x * CellTree::CONTENT_MARGIN;
        let mut insides = Vec::new();
        tree.visit_leaves(|key, node| {
            if let Node::Occupied(leaf) = node {
                let inner = key.bounds(tree.root()).inflated(-2.0 * margin);
                let inside = inner.clip(&ray).intersection(&within);
                insides.push((leaf, inside.end - inside.start));
            }
        });
        insides.sort_by_key(|(leaf, _)| *leaf);
        let grazed = |leaf: u32, part: &Interval| {
            let (_, length) = insides[leaf as usize];
            length.is_nan() || length <= 8.0 * slack || part.end - part.start <= 8.0 * slack
        };
        for (name, found, steps) in all_others(&tree, &ray, within) {
            prop_assert!(found.windows(2).all(|w| w[0].1.start <= w[1].1.start + 4.0 * slack), "{}", name);
            for (leaf, part) in &found {
                let same = expected.iter().find(|(l, _)| l == leaf);
                prop_assert!(same.is_some() || grazed(*leaf, part), "{} visits {}", name, leaf);
            }
            for (leaf, part) in &expected {
                let same = found.iter().any(|(l, _)| l == leaf);
                prop_assert!(same || grazed(*leaf, part), "{} misses {}", name, leaf);
            }
            prop_assert!(found.len() as u64 <= steps.cells);
        }
        let bounds = Aabb::new(DVec3::splat(-1.0), DVec3::ONE);
        let (grid, contents) = Grid::build(bounds, points.clone(), &Points, [7, 5, 1 + max_depth], u64::MAX);
        let mut found: Vec<DVec3> = Vec::new();
        grid.walk(&ray, within, |leaf, _| {
            found.extend(&contents[leaf as usize]);
            f64::INFINITY
        });
        // Every point that the line passes closely lies in a voxel that was visited.
        for p in &points {
            let s = ray.closest_approach(*p);
            let near = ray.at(s).distance(*p) < 1e-9;
            prop_assert!(!near || s < from + 1e-9 || found.contains(p));
        }
    }
}

#[test]
fn nothing_is_visited_outside_the_limits() {
    let tree = tree(&[DVec3::new(0.5, 0.5, 0.5), DVec3::new(-0.5, 0.5, 0.5)], 6);
    let ray = Ray::new(DVec3::new(-5.0, 0.5, 0.5), DVec3::X);
    for within in [Interval::new(0.0, 1.0), Interval::new(7.0, 9.0)] {
        for (name, found, _) in all_others(&tree, &ray, within) {
            assert!(found.is_empty(), "{name}");
        }
    }
    let aside = Ray::new(DVec3::new(-5.0, 7.0, 0.5), DVec3::X);
    let flat = Aabb::new(DVec3::ZERO, DVec3::ZERO);
    assert_eq!(
        tree.walk_units(&flat, &aside, Interval::ALL, |_, _| 0.0),
        Steps::default()
    );
    for (name, found, steps) in all_others(&tree, &aside, Interval::ALL) {
        assert_eq!((found.len(), steps.cells), (0, 0), "{name}");
    }
}

#[test]
fn a_walk_stops_where_it_is_told_to() {
    let tree = tree(&[DVec3::new(0.5, 0.5, 0.5), DVec3::new(-0.5, 0.5, 0.5)], 6);
    let ray = Ray::new(DVec3::new(-5.0, 0.5, 0.5), DVec3::X);
    let mut visits = 0;
    let mut first_only = |_: u32, _: Interval| {
        visits += 1;
        0.0
    };
    tree.walk_units(tree.root(), &ray, Interval::ALL, &mut first_only);
    tree.walk_neighbours(
        &ray,
        Interval::ALL,
        &mut TreePath::default(),
        &mut first_only,
    );
    assert_eq!(visits, 2);
}
