//! No cube that the surface meets is missing, and few are that it does not.

mod many_sides;
mod marked_cells;
mod points;
mod specimens;

use octray_math::{Aabb, DAffine3, DMat3, DVec3};

use super::{ShellPatch, StepCounts, cover, shells};
use crate::{Primitive, Solid, SolidNode};
use points::{Near, boundary_points};
use specimens::primitives;

/// Random numbers between 0 and 1.
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = octray_math::hash_combine(self.0, 11);
        octray_math::unit_f64(self.0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// The primitive of a solid, and where it is.
fn placed(solid: &Solid) -> (Primitive, DAffine3) {
    let mut map = DAffine3::IDENTITY;
    let mut at = solid;
    loop {
        match at.node() {
            SolidNode::Primitive(primitive) => return (primitive.clone(), map),
            SolidNode::Transformed {
                child,
                parent_from_child,
            } => {
                map *= *parent_from_child;
                at = child;
            }
            other => panic!("not a primitive: {other:?}"),
        }
    }
}

fn placements() -> Vec<(&'static str, DAffine3)> {
    let turn = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(1.9);
    let shear = DAffine3::from_mat3(DMat3::from_cols(
        DVec3::new(1.0, 0.2, 0.0),
        DVec3::new(0.4, 0.9, 0.1),
        DVec3::new(0.0, 0.3, -1.2),
    ));
    vec![
        ("as it is", DAffine3::IDENTITY),
        ("turned", turn),
        ("sheared and mirrored", shear),
        (
            "flattened",
            turn * DAffine3::from_scale(DVec3::new(1.0, 1e-4, 1.0)),
        ),
        ("tiny", turn * DAffine3::from_scale(DVec3::splat(1e-9))),
        ("huge", turn * DAffine3::from_scale(DVec3::splat(1e12))),
    ]
}

/// What is looked at: in the primitive's frame, and in the scene.
fn seen(primitive: &Primitive, map: &DAffine3) -> [Aabb; 2] {
    let window = Aabb::new(DVec3::splat(-3.0), DVec3::splat(3.0));
    let own = primitive.bounds().intersection(window);
    let whole = own.transformed(map);
    [own, whole.inflated(1e-3 * whole.diagonal())]
}

fn any_meets(patches: &[ShellPatch], cell: &Aabb) -> bool {
    let mut counts = StepCounts::default();
    patches
        .iter()
        .any(|p| p.bounds().overlaps(cell) && p.meets(cell, &mut counts))
}

/// Points per primitive and placement.
fn cases() -> usize {
    let factor = std::env::var("OCTRAY_CASES").ok();
    let factor = factor.map_or(1, |f| f.parse().expect("OCTRAY_CASES is a number"));
    300 * factor
}

/// With `OCTRAY_CASES=556` a million points per primitive.
#[test]
#[expect(clippy::print_stdout, reason = "the full run is reported")]
fn no_cell_that_the_surface_meets_is_missing() {
    std::thread::scope(|scope| {
        for (kind, (shape, solid)) in primitives().into_iter().enumerate() {
            scope.spawn(move || {
                let count = misses_nothing(shape, &solid, &mut Draw(7 + kind as u64));
                println!("{shape}: {count} points, none missed");
            });
        }
    });
}

/// The number of points.
fn misses_nothing(shape: &str, solid: &Solid, draw: &mut Draw) -> usize {
    let mut count = 0;
    for (pose, map) in placements() {
        let solid = solid.clone().transform(map).expect("invertible");
        let (primitive, map) = placed(&solid);
        let [own, within] = seen(&primitive, &map);
        let size = within.diagonal();
        let points = boundary_points(&solid, (&own, &map), cases(), draw);
        count += points.len();
        for (error, limit) in [(0.01, 1 << 14), (0.3, 100)] {
            let shells = shells(&primitive, &map, &within, error * size, limit);
            let boxes = cover(&primitive, &map, &within, error * size, limit);
            let bounds: Vec<Aabb> = shells.patches.iter().map(ShellPatch::bounds).collect();
            let near = [&bounds, &boxes].map(|boxes| Near::new(boxes, &within));
            for p in &points {
                let h = size * libm::exp2(draw.between(-20.0, 0.0));
                let share = DVec3::new(draw.unit(), draw.unit(), draw.unit());
                let low = *p - share * h;
                // Larger by less than cells are when their contents are decided.
                let cell = Aabb::new(low, low + h).inflated(1e-9 * size);
                // What holds the point is near it: nothing else may stand in for it.
                let meets = |i: usize| any_meets(&shells.patches[i..=i], &cell);
                assert!(
                    near[0].at(*p).any(meets),
                    "{shape} {pose}: {p} in {cell:?}, error {error}"
                );
                assert!(
                    near[1].at(*p).any(|i| boxes[i].overlaps(&cell)),
                    "{shape} {pose}: the cover misses {p}, error {error}"
                );
            }
        }
    }
    count
}

#[test]
fn shells_stay_as_close_to_the_surface_as_they_say() {
    let mut draw = Draw(9);
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        let [own, within] = seen(&primitive, &map);
        let size = within.diagonal();
        let points = boundary_points(&solid, (&own, &map), 5000, &mut draw);
        let shells = shells(&primitive, &map, &within, 0.02 * size, 1 << 16);
        assert!(
            shells.chord_error <= 0.021 * size,
            "{shape}: {}",
            shells.chord_error / size
        );
        // Corners of the shells are near the surface, as far as the sampling tells.
        let sampling = 0.1 * size;
        if primitive.bounds().is_bounded() {
            for patch in shells.patches.iter().step_by(7) {
                for corner in patch.inner.iter().chain(&patch.outer) {
                    let near = points.iter().map(|p| p.distance_squared(*corner));
                    let near = libm::sqrt(near.fold(f64::INFINITY, f64::min));
                    assert!(near <= shells.chord_error + sampling, "{shape}: {corner}");
                }
            }
        }
    }
}

#[test]
fn small_things_get_few_patches() {
    let within = Aabb::new(DVec3::splat(-1e6), DVec3::splat(1e6));
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        if !primitive.bounds().is_bounded() {
            continue;
        }
        let shells = shells(&primitive, &map, &within, 1e3, 1 << 20);
        assert!(
            shells.patches.len() <= 100,
            "{shape}: {}",
            shells.patches.len()
        );
    }
}

#[test]
fn odd_questions_have_answers() {
    let within = Aabb::new(DVec3::splat(-2.0), DVec3::splat(2.0));
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        assert!(
            shells(&primitive, &map, &Aabb::EMPTY, 0.1, 100)
                .patches
                .is_empty()
        );
        for (error, limit) in [(0.0, 1000), (f64::INFINITY, 1000), (1e-3, 0), (1e-3, 1)] {
            let shells = shells(&primitive, &map, &within, error, limit);
            assert!(
                shells.patches.len() <= limit.max(100),
                "{shape} {error} {limit}"
            );
            assert!(
                shells.patches.iter().all(|p| p.bounds().is_bounded()),
                "{shape}"
            );
            assert!(cover(&primitive, &map, &within, error, limit).len() <= limit.max(100));
        }
    }
}
