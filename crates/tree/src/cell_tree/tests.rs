use octray_math::{Aabb, DVec3, Interval, Ray};
use proptest::prelude::*;

use super::*;

/// Boxes as contents: cells hold the boxes they meet.
struct Boxes(Vec<Aabb>);

impl Subdivide for Boxes {
    type Content = Vec<u32>;

    fn restrict(&self, parent: &Vec<u32>, cell: &Aabb) -> Vec<u32> {
        let meets = |i: &&u32| self.0[**i as usize].overlaps(cell);
        parent.iter().filter(meets).copied().collect()
    }

    fn describe(&self, content: &Vec<u32>) -> Cell {
        match content.len() {
            0 => Cell::Empty(0),
            n => Cell::Occupied {
                cost: n as f64,
                parts: n as u32,
            },
        }
    }

    fn bytes(&self, content: &Vec<u32>) -> u64 {
        4 * content.len() as u64
    }
}

fn build(boxes: &[Aabb], criteria: &Criteria) -> (CellTree, Vec<Vec<u32>>) {
    let bounds = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
    let all = (0..boxes.len() as u32).collect();
    CellTree::build(
        enclosing_cube(&bounds),
        all,
        &Boxes(boxes.to_vec()),
        criteria,
    )
}

fn point(range: f64) -> impl Strategy<Value = DVec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
    proptest::collection::vec((point(1.0), point(0.1), 0..8), 1..60).prop_map(|all| {
        all.into_iter()
            .map(|(c, h, e)| {
                let half = h.abs() / f64::from(1 << e);
                Aabb::new(c - half, c + half)
            })
            .collect()
    })
}

#[test]
fn the_cube_s_faces_are_exact_to_the_deepest_level() {
    for (center, size) in [(0.1, 0.3), (1e6, 1e-1), (-3e9, 7e3), (0.0, 1e-30)] {
        let c = DVec3::splat(center);
        let bounds = Aabb::new(c - size, c + size * 0.7);
        let cube = enclosing_cube(&bounds);
        assert!(cube.contains_box(&bounds), "{cube:?} {bounds:?}");
        assert!(cube.size().x < 2.5 * bounds.size().x);
        let cell = cube.size().x / f64::from(1u32 << octray_math::MAX_DEPTH);
        for i in [0u32, 1, 12345, (1 << octray_math::MAX_DEPTH) - 1] {
            let face = cube.min.x + f64::from(i) * cell;
            assert_eq!((face - cube.min.x) / cell, f64::from(i), "{center} {size}");
        }
    }
}

#[test]
fn limits_hold_and_are_reported() {
    let boxes: Vec<Aabb> = (0..4000)
        .map(|i| {
            let at = DVec3::new(
                f64::from(i % 20),
                f64::from(i / 20 % 20),
                f64::from(i / 400),
            );
            Aabb::new(at, at + 0.1)
        })
        .collect();
    let (free, _) = build(&boxes, &Criteria::default());
    assert!(free.stats().depth > 4 && !free.stats().stopped_by_memory);
    let shallow = Criteria {
        max_depth: 3,
        ..Criteria::default()
    };
    let (tree, _) = build(&boxes, &shallow);
    assert_eq!(tree.stats().depth, 3);
    assert!(tree.stats().stopped_by_depth > 0);
    let memory_limit = free.stats().bytes / 2;
    let (tree, _) = build(
        &boxes,
        &Criteria {
            memory_limit,
            ..Criteria::default()
        },
    );
    assert!(tree.stats().stopped_by_memory && tree.stats().bytes <= memory_limit);
}

proptest! {
    #[test]
    fn a_walk_meets_every_box_that_the_line_meets_in_order(
        boxes in boxes(), origin in point(3.0), target in point(1.0), axis in 0usize..6,
    ) {
        let (tree, leaves) = build(&boxes, &Criteria::default());
        let mut direction = target - origin;
        if axis < 3 {
            // Axis-parallel lines in some cases.
            direction = DVec3::ZERO;
            direction[axis] = 1.0;
        }
        prop_assume!(direction.length() > 1e-3);
        let ray = Ray::new(origin, direction);
        let mut found = vec![false; boxes.len()];
        let mut last = f64::NEG_INFINITY;
        let margin = tree.root().size().x * CellTree::CONTENT_MARGIN;
        let mut ordered = true;
        tree.walk(&ray, Interval::ALL, &mut WalkStack::default(), |leaf, span| {
            // Grown cells overlap by a margin.
            ordered &= span.start >= last - 2.0 * margin / direction.abs().max_element() * 2.0;
            last = last.max(span.start);
            for &i in &leaves[leaf as usize] {
                found[i as usize] = true;
            }
            f64::INFINITY
        });
        prop_assert!(ordered);
        for (i, b) in boxes.iter().enumerate() {
            prop_assert!(found[i] || b.clip(&ray).is_empty(), "box {} missed", i);
        }
    }

    #[test]
    fn nothing_beyond_the_limit_is_visited(boxes in boxes(), origin in point(3.0)) {
        let (tree, _) = build(&boxes, &Criteria::default());
        let ray = Ray::new(origin, -origin + DVec3::splat(1e-3));
        let mut limit = f64::INFINITY;
        let mut late = false;
        tree.walk(&ray, Interval::ALL, &mut WalkStack::default(), |_, span| {
            late |= span.start > limit;
            limit = span.end;
            limit
        });
        prop_assert!(!late);
    }

    #[test]
    fn the_tree_has_the_same_bytes_for_any_number_of_threads(boxes in boxes()) {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("pool");
            pool.install(|| build(&boxes, &Criteria::default()))
        };
        let (one, four) = (with(1), with(4));
        prop_assert!(one.0.words().eq(four.0.words()));
        prop_assert_eq!(one.1, four.1);
    }

    #[test]
    fn a_point_lies_in_the_cell_that_is_located(boxes in boxes(), p in point(1.0)) {
        let (tree, leaves) = build(&boxes, &Criteria::default());
        if let Some((key, node)) = tree.locate(p) {
            prop_assert!(key.bounds(tree.root()).contains(p));
            for (i, b) in boxes.iter().enumerate() {
                if b.contains(p) {
                    let holds = matches!(node, Node::Occupied(l) if leaves[l as usize].contains(&(i as u32)));
                    prop_assert!(holds);
                }
            }
        }
    }
}
