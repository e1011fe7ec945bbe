//! One suite for every method: each answers every query as brute force does, to the bit.

mod answers;
mod parts;
mod random;

use answers::{Answers, answers, methods, rays_about};
use octray_geometry::Solid;
use octray_math::{DVec3, Ray};
use octray_world::{Counters, Method, RayQuery};
use parts::world;
use proptest::prelude::*;
use random::{model, point};

/// The answers that all methods agree on.
fn conform(solids: &[(Solid, i32)], rays: &[Ray]) -> Answers {
    let expected = answers(&world(solids, Method::Brute), rays);
    for method in methods() {
        let found = answers(&world(solids, method), rays);
        // One by one: all answers together would fill pages.
        for (what, same) in [
            ("closest", found.closest == expected.closest),
            ("occluded", found.occluded == expected.occluded),
            ("dark", found.dark == expected.dark),
            ("crossings", found.crossings == expected.crossings),
            ("chords", found.chords == expected.chords),
            ("regions", found.regions == expected.regions),
        ] {
            assert!(same, "{what} by {method}");
        }
    }
    expected
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn every_method_answers_as_brute_force_does(
        models in proptest::collection::vec((model(), 0..2i32), 1..6),
        rays in proptest::collection::vec((point(4.0), point(1.0)), 30),
    ) {
        let solids: Vec<(Solid, i32)> = models.iter().map(|(m, p)| (m.solid.clone(), *p)).collect();
        let rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        let answers = conform(&solids, &rays);
        // And brute force itself knows who is where.
        for (ray, region) in rays.iter().zip(answers.regions) {
            let holds: Vec<_> = models.iter().map(|(m, _)| m.recipe.contains(ray.origin)).collect();
            if holds.iter().all(|(_, margin)| *margin > 1e-6) {
                let found = region.object().map(|object| holds[object.0 as usize].0);
                prop_assert_eq!(found.unwrap_or(true), found.is_some() || !holds.iter().any(|h| h.0));
            }
        }
    }
}

/// Rays that travel together: from one point, to one point, parallel, along an axis.
fn neighbours(from: DVec3, to: DVec3, spread: f64) -> Vec<Ray> {
    let grid = || (0..40).map(|i| (f64::from(i % 8) - 3.0, f64::from(i / 8) - 2.0));
    let aside = |(i, j): (f64, f64)| DVec3::new(i, j, i - j) * spread;
    let eye = grid().map(|at| Ray::new(from, to - from + aside(at)));
    let lamp = grid().map(|at| Ray::new(from + aside(at), to - from - aside(at)));
    let parallel = grid().map(|at| Ray::new(from + aside(at), to - from));
    let axis = grid().map(|at| Ray::new(from + aside(at), DVec3::Y * -from.y));
    eye.chain(lamp).chain(parallel).chain(axis).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5))]

    #[test]
    fn neighbouring_rays_are_answered_as_by_brute_force(
        models in proptest::collection::vec((model(), 0..2i32), 1..6),
        from in point(4.0), to in point(1.0), spread in prop_oneof![Just(0.0), 1e-6..0.1f64],
    ) {
        let solids: Vec<(Solid, i32)> = models.iter().map(|(m, p)| (m.solid.clone(), *p)).collect();
        conform(&solids, &neighbours(from, to, spread));
    }

    #[test]
    fn how_rays_are_sliced_does_not_show(
        models in proptest::collection::vec((model(), 0..2i32), 1..6),
        from in point(4.0), to in point(1.0), spread in 1e-6..0.1f64, length in 1..70usize,
    ) {
        let solids: Vec<(Solid, i32)> = models.iter().map(|(m, p)| (m.solid.clone(), *p)).collect();
        let beams = "octree:tree:beam".parse().expect("a method");
        let world = world(&solids, beams);
        let mut rays = neighbours(from, to, spread);
        // Rays to two lamps by turns, one that is none, and one that goes elsewhere.
        let turns = |i: usize| [rays[i], rays[i + 100]];
        let mut mixed: Vec<Ray> = (0..40).flat_map(turns).collect();
        mixed.insert(17, Ray::new(from, DVec3::ZERO));
        mixed.insert(33, Ray::new(to, from));
        rays.extend(mixed);
        let queries: Vec<RayQuery> = rays.iter().map(|ray| RayQuery::new(*ray)).collect();
        let (mut whole, mut part, mut sliced) = (Vec::new(), Vec::new(), Vec::new());
        let mut counters = Counters::default();
        world.closest(&queries, &mut whole, &mut counters);
        for slice in queries.chunks(length) {
            world.closest(slice, &mut part, &mut Counters::default());
            sliced.append(&mut part);
        }
        prop_assert_eq!(&sliced, &whole);
        // And what each ray cost adds up.
        let mut costs = Vec::new();
        world.closest_with_costs(&queries, &mut part, &mut costs);
        let mut sum = Counters::default();
        for cost in &costs {
            prop_assert_eq!(cost.rays, 1);
            sum += *cost;
        }
        prop_assert_eq!(sum, counters);
        prop_assert_eq!(&part, &whole);
        let (mut blocked, mut one_by_one) = (Vec::new(), Vec::new());
        world.occluded_with_costs(&queries, &mut blocked, &mut costs);
        for query in &queries {
            world.occluded(std::slice::from_ref(query), &mut one_by_one, &mut counters);
            prop_assert_eq!(one_by_one[0], blocked[one_by_one.len() - 1]);
            blocked.remove(0);
        }
        let stop = std::sync::atomic::AtomicBool::new(false);
        let rows: Vec<[f64; 6]> = rays
            .iter()
            .map(|ray| {
                let (o, d) = (ray.origin, ray.direction);
                [o.x, o.y, o.z, d.x, d.y, d.z]
            })
            .collect();
        prop_assert_eq!(&world.batch(&stop).closest(&rows), &Ok(whole.clone()));
        let met: Vec<bool> = whole.iter().map(|hit| !hit.is_miss()).collect();
        prop_assert_eq!(world.batch(&stop).meets_any(&rows, f64::INFINITY), Ok(met));
    }
}

#[test]
fn odd_scenes_end_with_the_right_answers() {
    let ball = |radius: f64, at: DVec3| {
        let ball = Solid::sphere(radius).expect("valid");
        (ball.translate(at).expect("finite"), 0)
    };
    // Nothing; one object; all at one point; huge coordinates; flat; a needle; only unbounded.
    conform(&[], &rays_about(DVec3::ZERO, 1.0));
    conform(&[ball(1.0, DVec3::ONE)], &rays_about(DVec3::ONE, 1.0));
    let stacked: Vec<_> = (1..20)
        .map(|i| ball(f64::from(i) * 0.05, DVec3::ONE))
        .collect();
    conform(&stacked, &rays_about(DVec3::ONE, 1.0));
    let far = DVec3::new(1e30, -1e30, 3e29);
    conform(
        &[ball(1e29, far), ball(2e29, far * 0.9)],
        &rays_about(far, 1e29),
    );
    let slab = |size: DVec3| (Solid::cuboid(-size, size).expect("valid"), 0);
    conform(
        &[slab(DVec3::new(1.0, 1.0, 1e-9))],
        &rays_about(DVec3::ZERO, 1.0),
    );
    conform(
        &[slab(DVec3::new(1e6, 0.5, 0.5)), ball(1.0, DVec3::X)],
        &rays_about(DVec3::ZERO, 1.0),
    );
    let floor = (Solid::half_space(DVec3::Z, -0.5).expect("valid"), 0);
    conform(std::slice::from_ref(&floor), &rays_about(DVec3::ZERO, 1.0));
    conform(
        &[floor, ball(1.0, DVec3::ZERO)],
        &rays_about(DVec3::ZERO, 1.0),
    );
}

#[test]
fn what_lies_at_the_very_end_of_a_ray_does_not_stop_it() {
    let slab = |z: f64| Solid::cuboid(DVec3::new(-1.0, -1.0, z), DVec3::new(1.0, 1.0, z + 0.5));
    let solids = [0.0, 1.0].map(|z| (slab(z).expect("valid"), 0));
    for method in methods() {
        let world = world(&solids, method);
        let down = RayQuery::new(Ray::new(DVec3::new(0.25, 0.5, 0.75), DVec3::NEG_Z));
        let (mut hits, mut blocked) = (Vec::new(), Vec::new());
        world.closest(&[down], &mut hits, &mut Counters::default());
        // From the lower slab's top to just the upper one's bottom, and beyond.
        let up = [0.5, 0.75].map(|t_max| RayQuery {
            ray: Ray::new(DVec3::new(0.25, 0.5, 0.5), DVec3::Z),
            t_max,
            departure: hits[0].departure(true),
        });
        world.occluded(&up, &mut blocked, &mut Counters::default());
        assert_eq!(blocked, [false, true], "{method}");
    }
}
