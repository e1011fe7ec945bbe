//! Rays that entered as a beam against the same rays walked one by one.

use octray_math::{DVec3, Interval, Ray};
use proptest::prelude::*;

use super::BeamMemory;
use crate::cell_tree::points::tree;
use crate::{CellTree, WalkStack};

type Run = Vec<(Ray, Interval)>;
/// Leaves with the bits of the parts of the line in them, in order.
type Visits = Vec<(u32, u64, u64)>;

/// What is visited if everything beyond the given leaf does not matter any more.
fn visits(last: usize, walk: impl FnOnce(&mut dyn FnMut(u32, Interval) -> f64) -> u64) -> Visits {
    let mut found = Vec::new();
    let cells = walk(&mut |leaf, part| {
        found.push((leaf, part.start.to_bits(), part.end.to_bits()));
        if found.len() > last {
            0.5 * (part.start + part.end)
        } else {
            f64::INFINITY
        }
    });
    assert!(found.len() as u64 <= cells);
    found
}

/// Whether the run has a beam; if it has, every ray must visit what it visits by itself, to the bit.
fn agrees(tree: &CellTree, run: &Run) -> bool {
    let mut memory = BeamMemory::default();
    if tree.enter(run, &mut memory).is_none() {
        return false;
    }
    let stack = &mut WalkStack::default();
    for (ray, within) in run {
        // In a face that it runs along, a ray meets the cells of both sides at once: in any order.
        let has_ties = ray.direction.to_array().contains(&0.0);
        for last in if has_ties {
            vec![usize::MAX]
        } else {
            vec![0, 1, usize::MAX]
        } {
            // The whole part, and the rest of it from somewhere on.
            for within in [*within, Interval::new(within.start.max(0.3), within.end)] {
                let mut alone = visits(last, |visit| tree.walk(ray, within, stack, visit));
                let mut together = visits(last, |visit| {
                    tree.walk_from(&memory, ray, within, stack, visit)
                });
                if has_ties {
                    alone.sort_unstable();
                    together.sort_unstable();
                }
                assert_eq!(together, alone, "{ray:?} {within:?}");
            }
        }
    }
    true
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1.0..1.0f64,
        (-4..=4i32).prop_map(|i| f64::from(i) * 0.25),
        Just(0.0)
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    (number(), number(), number()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// Neighbouring rays: from one point, to one point, parallel, or none of these.
fn run() -> impl Strategy<Value = Run> {
    let small = prop_oneof![Just(0.0), 1e-9..1e-3f64, 1e-3..0.3f64];
    let away = prop_oneof![Just(0.0), Just(0.5), 1.0..1e3f64];
    let scale = prop_oneof![Just(1.0), Just(2.0_f64.powi(-300)), Just(2.0_f64.powi(300))];
    let jitter = proptest::collection::vec((point(), point()), 1..30);
    (point(), point(), small, away, scale, jitter, 0..4).prop_map(
        |(origin, direction, small, away, scale, jitter, kind)| {
            let origin = origin - direction * away;
            let ray = |(a, b): (DVec3, DVec3)| {
                let (a, b) = (a * small, b * small);
                let ray = match kind {
                    0 => Ray::new(origin, direction + a),
                    // To the point `origin + direction`.
                    1 => Ray::new(origin + a, direction - a),
                    2 => Ray::new(origin + a, direction),
                    _ => Ray::new(origin + a, direction + b),
                };
                let ray = Ray::new(ray.origin, ray.direction * scale);
                let end = if kind == 1 {
                    1.0 / scale
                } else {
                    f64::INFINITY
                };
                (ray, Interval::new(0.0, end))
            };
            jitter.into_iter().map(ray).collect()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn rays_of_a_beam_visit_what_they_visit_alone(
        points in proptest::collection::vec(point(), 1..40), max_depth in 1..11u32, run in run(),
    ) {
        agrees(&tree(&points, max_depth), &run);
    }
}

/// A grid of points, so that there are leaves everywhere.
fn lattice() -> Vec<DVec3> {
    let at = |i: i32| f64::from(i % 12) / 6.0 - 0.93;
    (0..12 * 12 * 12)
        .map(|i| DVec3::new(at(i), at(i / 12), at(i / 144)))
        .collect()
}

/// A block of 8 x 8 rays.
fn block(ray: impl Fn(f64, f64) -> Ray) -> Run {
    (0..64)
        .map(|i| {
            let ray = ray(f64::from(i % 8), f64::from(i / 8));
            (ray, Interval::new(0.0, f64::INFINITY))
        })
        .collect()
}

#[test]
fn neighbouring_rays_have_a_beam_and_it_saves_cells() {
    let tree = tree(&lattice(), 9);
    let eye = DVec3::new(-4.0, 1.0, 2.0);
    let runs = [
        block(|i, j| Ray::new(eye, DVec3::new(1.0, -0.25 + 0.004 * i, -0.5 + 0.004 * j))),
        // Parallel to an axis, some of them in the faces of cells.
        block(|i, j| {
            Ray::new(
                DVec3::new(0.5 + i / 128.0, 0.25 - j / 128.0, 7.0),
                DVec3::NEG_Z,
            )
        }),
        // To a lamp.
        block(|i, j| {
            let from = DVec3::new(0.3 + 0.01 * i, -0.9, 0.01 * j);
            Ray::new(from, DVec3::new(3.0, 5.0, 4.0) - from)
        }),
        // From inside, all the same.
        block(|_, _| Ray::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(-0.3, 0.1, 1.0))),
    ];
    for run in runs {
        assert!(agrees(&tree, &run));
        let mut memory = BeamMemory::default();
        let shared = tree.enter(&run, &mut memory).expect("a beam");
        let stack = &mut WalkStack::default();
        let (mut alone, mut together) = (0, shared);
        for (ray, within) in &run {
            // As far as the first leaf, as a ray that meets something there.
            let met = |_, part: Interval| part.end;
            alone += tree.walk(ray, *within, stack, met);
            together += tree.walk_from(&memory, ray, *within, stack, met);
        }
        assert!(2 * together < alone, "{together} of {alone} cells");
    }
}

#[test]
fn rays_without_a_common_way_have_no_beam() {
    let tree = tree(&lattice(), 9);
    let from = DVec3::new(-4.0, 0.0, 0.0);
    let directions = |all: &[DVec3]| -> Run {
        let rays = all.iter().map(|d| Ray::new(from, *d));
        rays.map(|ray| (ray, Interval::new(0.0, f64::INFINITY)))
            .collect()
    };
    let none = &mut BeamMemory::default();
    let around_axis = [DVec3::new(1.0, 0.01, 0.0), DVec3::new(1.0, -0.01, 0.0)];
    assert_eq!(tree.enter(&directions(&around_axis), none), None);
    let wide = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.0, 0.2, 0.0)];
    assert_eq!(tree.enter(&directions(&wide), none), None);
    let turned = [DVec3::X, DVec3::Y];
    assert_eq!(tree.enter(&directions(&turned), none), None);
    assert_eq!(tree.enter(&directions(&[DVec3::ZERO]), none), None);
    assert_eq!(tree.enter(&directions(&[DVec3::NAN]), none), None);
    assert_eq!(tree.enter(&[], none), None);
    // All pass by: a beam that enters nothing.
    let past = [DVec3::new(0.01, 1.0, 0.0), DVec3::new(0.02, 1.0, 0.0)];
    assert_eq!(tree.enter(&directions(&past), none), Some(0));
    assert!(agrees(&tree, &directions(&past)));
}
