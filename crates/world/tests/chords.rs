//! Chords against point membership: of one object, and of what priorities and regions leave of it.

mod parts;
mod random;

use octray_geometry::{FaceId, Solid};
use octray_math::{DVec3, Ray};
use octray_scene::ObjectId;
use octray_world::{Chord, Counters, Hit, Method, Overlaps, RayQuery, Region, World};
use parts::world;
use proptest::prelude::*;
use random::{Model, model, point};

const ALL: [Overlaps; 3] = [Overlaps::Regions, Overlaps::Priorities, Overlaps::Objects];

fn chords(world: &World, ray: Ray, whole: bool, overlaps: Overlaps) -> Vec<Chord> {
    let mut chords = Vec::new();
    let mut counters = Counters::default();
    world.chords(
        &RayQuery::new(ray),
        whole,
        overlaps,
        &mut chords,
        &mut counters,
    );
    chords
}

/// The boundaries that priorities leave to be seen.
fn seen(world: &World, ray: Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    let mut counters = Counters::default();
    world.crossings(&RayQuery::new(ray), true, &mut hits, &mut counters);
    hits
}

/// Object, begin and end of every chord.
fn ends(chords: &[Chord]) -> Vec<(u32, f64, f64)> {
    let ends = |c: &Chord| (c.object.0, c.enter.t, c.exit.t);
    chords.iter().map(ends).collect()
}

fn ball(radius: f64, x: f64) -> Solid {
    let ball = Solid::sphere(radius).expect("valid");
    ball.translate(DVec3::new(x, 0.0, 0.0)).expect("finite")
}

#[test]
fn overlapping_solids_give_way_by_region_by_priority_or_not_at_all() {
    // Along x: 0 holds [-2, 2], 1 holds [1, 4]; 0 displaces 1.
    let overlapping = [(ball(2.0, 0.0), 1), (ball(1.5, 2.5), 0)];
    let ray = Ray::new(DVec3::new(-10.0, 0.0, 0.0), DVec3::X);
    for method in [Method::Auto, Method::Brute] {
        let world = world(&overlapping, method);
        let found = |overlaps| ends(&chords(&world, ray, false, overlaps));
        let displaced = [(0, 8.0, 12.0), (1, 12.0, 14.0)];
        assert_eq!(found(Overlaps::Regions), displaced);
        assert_eq!(found(Overlaps::Priorities), displaced);
        assert_eq!(found(Overlaps::Objects), [(0, 8.0, 12.0), (1, 11.0, 14.0)]);
        let second = chords(&world, ray, false, Overlaps::Regions)[1];
        assert!(second.enter.displaced && !second.exit.displaced);
        // Where the ray enters what is left of 1, the normal out of it points back.
        let query = RayQuery::new(ray);
        assert!((world.chord_normal(&query, &second.enter) + DVec3::X).length() < 1e-12);
        assert!((world.chord_normal(&query, &second.exit) - DVec3::X).length() < 1e-12);
    }
}

#[test]
fn a_ball_in_a_ball_cuts_its_chord_in_two_only_by_region() {
    let nested = [(ball(2.0, 0.0), 0), (ball(1.0, 0.0), 0)];
    let world = world(&nested, Method::Auto);
    let ray = Ray::new(DVec3::new(-10.0, 0.0, 0.0), DVec3::X * 2.0);
    let regions = ends(&chords(&world, ray, false, Overlaps::Regions));
    assert_eq!(regions, [(0, 4.0, 4.5), (1, 4.5, 5.5), (0, 5.5, 6.0)]);
    let objects = ends(&chords(&world, ray, false, Overlaps::Priorities));
    assert_eq!(objects, [(0, 4.0, 6.0), (1, 4.5, 5.5)]);
}

#[test]
fn a_start_inside_begins_at_0_and_a_half_space_never_ends() {
    let floor = Solid::half_space(DVec3::Z, 0.0).expect("valid");
    let world = world(&[(floor, 0), (ball(1.0, 0.0), 0)], Method::Auto);
    let down = Ray::new(DVec3::new(5.0, 0.0, 3.0), DVec3::NEG_Z);
    for whole in [false, true] {
        let found = chords(&world, down, whole, Overlaps::Objects);
        assert_eq!(ends(&found), [(0, 3.0, f64::INFINITY)]);
        assert_eq!(found[0].exit.face, FaceId::NONE);
    }
    let up = Ray::new(DVec3::new(5.0, 0.0, -3.0), DVec3::Z);
    let half = chords(&world, up, false, Overlaps::Objects);
    assert_eq!(ends(&half), [(0, 0.0, 3.0)]);
    assert_eq!(half[0].enter.face, FaceId::NONE);
    let whole = chords(&world, up, true, Overlaps::Objects);
    assert_eq!(ends(&whole), [(0, f64::NEG_INFINITY, 3.0)]);
    let from_centre = Ray::new(DVec3::ZERO, DVec3::Z);
    let both = chords(&world, from_centre, false, Overlaps::Regions);
    assert_eq!(ends(&both), [(1, 0.0, 1.0)]);
}

#[test]
fn solids_that_touch_are_two_crossings_and_two_chords() {
    let cube = Solid::cuboid(DVec3::ZERO, DVec3::ONE).expect("valid");
    let next = cube.translate(DVec3::X).expect("finite");
    let world = world(&[(cube, 0), (next, 0)], Method::Auto);
    let ray = Ray::new(DVec3::new(-1.0, 0.3, 0.4), DVec3::X);
    for overlaps in ALL {
        let found = chords(&world, ray, false, overlaps);
        assert_eq!(ends(&found), [(0, 1.0, 2.0), (1, 2.0, 3.0)]);
        assert!(
            found
                .iter()
                .all(|c| !c.enter.displaced && !c.exit.displaced)
        );
    }
    let mut counters = Counters::default();
    let query = RayQuery::new(ray);
    let count = world.count_crossings(&query, false, &mut counters);
    assert_eq!(count, 4);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn chords_are_where_the_objects_are(
        models in proptest::collection::vec((model(), 0..3i32), 1..4),
        lines in proptest::collection::vec((point(4.0), point(1.0)), 12),
    ) {
        let solids: Vec<(Solid, i32)> =
            models.iter().map(|(Model { solid, .. }, p)| (solid.clone(), *p)).collect();
        let (tree, brute) = (world(&solids, Method::Auto), world(&solids, Method::Brute));
        for (origin, d) in lines {
            prop_assume!(d.length() > 0.1);
            let ray = Ray::new(origin, d);
            prop_assert_eq!(seen(&tree, ray), seen(&brute, ray));
            for (whole, overlaps) in [false, true].into_iter().flat_map(|w| ALL.map(|o| (w, o))) {
                let found = chords(&tree, ray, whole, overlaps);
                prop_assert_eq!(&found, &chords(&brute, ray, whole, overlaps));
                prop_assert!(found.iter().all(|c| c.enter.t < c.exit.t));
                if overlaps == Overlaps::Regions {
                    prop_assert!(found.windows(2).all(|c| c[0].exit.t <= c[1].enter.t));
                }
                for i in -30..=30 {
                    let t = f64::from(i) * 0.273;
                    if t <= 0.0 && !whole {
                        continue;
                    }
                    check_membership(&tree, &models, &found, ray.at(t), t, overlaps)?;
                }
            }
        }
    }
}

/// At `t` exactly those objects have a chord that should.
fn check_membership(
    world: &World,
    models: &[(Model, i32)],
    found: &[Chord],
    point: DVec3,
    t: f64,
    overlaps: Overlaps,
) -> Result<(), TestCaseError> {
    let inside: Vec<(bool, f64)> = models
        .iter()
        .map(|(m, _)| m.recipe.contains(point))
        .collect();
    if inside.iter().any(|(_, margin)| *margin < 1e-6) {
        return Ok(());
    }
    let best = (0..models.len())
        .filter(|&i| inside[i].0)
        .map(|i| models[i].1)
        .max();
    let mut regions = Vec::new();
    world.regions(&[point], &mut regions, &mut Counters::default());
    for (index, (_, priority)) in models.iter().enumerate() {
        let id = ObjectId(index as u32);
        let held = found
            .iter()
            .any(|c| c.object == id && c.enter.t < t && t < c.exit.t);
        let expected = inside[index].0
            && match overlaps {
                Overlaps::Objects => true,
                Overlaps::Priorities => Some(*priority) == best,
                Overlaps::Regions => regions[0] == Region::of(id),
            };
        prop_assert_eq!(held, expected, "object {} at {}", index, t);
    }
    let region_holds = regions[0]
        .object()
        .map(|o| inside[o.0 as usize].0 && Some(models[o.0 as usize].1) == best);
    prop_assert_eq!(region_holds.unwrap_or(best.is_none()), true);
    Ok(())
}
