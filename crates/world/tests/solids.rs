//! The world's answers about solids against independent oracles.

mod random;

use std::sync::Arc;

use octray_geometry::Solid;
use octray_math::{DVec3, Ray};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Criteria, Hit, Method, RayQuery, Region, World, WorldConfig};
use proptest::prelude::*;
use random::{Model, model, point};

fn world(solids: impl IntoIterator<Item = Solid>, method: Method, criteria: Criteria) -> World {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for solid in solids {
        builder.add_object(Object::solid("part", solid, material));
    }
    let scene = Arc::new(builder.build().expect("valid"));
    World::prepare(
        scene,
        &WorldConfig {
            method,
            criteria,
            ..WorldConfig::default()
        },
    )
    .expect("no meshes")
}

fn crossings(world: &World, ray: Ray, whole: bool) -> Vec<Hit> {
    let mut hits = Vec::new();
    world.crossings(
        &RayQuery::new(ray),
        whole,
        &mut hits,
        &mut Counters::default(),
    );
    hits
}

fn closest(world: &World, query: RayQuery) -> Hit {
    let mut hits = Vec::new();
    world.closest(&[query], &mut hits, &mut Counters::default());
    hits[0]
}

/// Criteria that divide small scenes as far as large ones.
fn deep() -> Criteria {
    Criteria {
        max_depth: 7,
        visit_cost: 0.1,
        ..Criteria::default()
    }
}

#[test]
fn a_drilled_plate_has_no_skin_over_its_hole() {
    let plate = Solid::cuboid(DVec3::ZERO, DVec3::splat(10.0)).expect("valid");
    let drill = Solid::cylinder(2.0, 0.0, 10.0).expect("valid");
    let drill = drill.translate(DVec3::new(5.0, 5.0, 0.0)).expect("finite");
    for method in [Method::Auto, Method::Brute] {
        let world = world(
            [Solid::difference([plate.clone(), drill.clone()])],
            method,
            deep(),
        );
        let down = |x: f64| Ray::new(DVec3::new(x, 5.0, 20.0), DVec3::NEG_Z);
        assert_eq!(crossings(&world, down(5.5), true).len(), 0);
        let through: Vec<f64> = crossings(&world, down(1.0), true)
            .iter()
            .map(|h| h.t)
            .collect();
        assert_eq!(through, [10.0, 20.0]);
    }
}

#[test]
fn touching_solids_have_no_wall_and_a_solid_minus_itself_is_empty() {
    let left = Solid::cuboid(DVec3::ZERO, DVec3::ONE).expect("valid");
    let right = left.translate(DVec3::X).expect("finite");
    let both = world([Solid::union([left.clone(), right])], Method::Auto, deep());
    let hits = crossings(&both, Ray::new(DVec3::new(-1.0, 0.3, 0.4), DVec3::X), true);
    assert_eq!(hits.iter().map(|h| h.t).collect::<Vec<_>>(), [1.0, 3.0]);
    let nothing = world(
        [Solid::difference([left.clone(), left])],
        Method::Auto,
        deep(),
    );
    assert!(
        crossings(
            &nothing,
            Ray::new(DVec3::new(-1.0, 0.3, 0.4), DVec3::X),
            true
        )
        .is_empty()
    );
}

#[test]
fn regions_follow_size_and_priority() {
    let outer = Solid::sphere(2.0).expect("valid");
    let inner = Solid::sphere(1.0).expect("valid");
    let both = world([outer, inner], Method::Auto, deep());
    let hits = crossings(&both, Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X), true);
    let regions: Vec<Option<u32>> = hits
        .iter()
        .map(|h| h.to.object().map(|object| object.0))
        .collect();
    assert_eq!(regions, [Some(0), Some(1), Some(0), None]);
    assert_eq!(hits[0].from, Region::OUTSIDE);
}

#[test]
fn a_half_space_is_met_anywhere() {
    let floor = Solid::half_space(DVec3::Z, 0.0).expect("valid");
    let ball = Solid::sphere(1.0)
        .expect("valid")
        .translate(DVec3::Z)
        .expect("finite");
    let world = world([floor, ball], Method::Auto, deep());
    for far in [0.0, 10.0, 1e7] {
        let from = DVec3::new(far, 3.0, 5.0);
        let hit = closest(&world, RayQuery::new(Ray::new(from, DVec3::NEG_Z)));
        assert!((hit.t - 5.0).abs() < 1e-9, "{far} {}", hit.t);
        assert_eq!(hit.to.object().map(|o| o.0), Some(0));
    }
}

#[test]
fn odd_rays_meet_nothing_and_long_or_short_directions_do_not_matter() {
    let world = world([Solid::sphere(1.0).expect("valid")], Method::Auto, deep());
    let origin = DVec3::new(-3.0, 0.0, 0.0);
    for direction in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert!(closest(&world, RayQuery::new(Ray::new(origin, direction))).is_miss());
    }
    for scale in [1e-300, 1e-9, 1.0, 1e150, 1e300] {
        let hit = closest(&world, RayQuery::new(Ray::new(origin, DVec3::X * scale)));
        assert!((hit.t * scale - 2.0).abs() < 1e-12, "{scale}");
    }
}

#[test]
fn a_lone_surface_is_not_followed_into_the_smallest_cells() {
    for solid in [
        Solid::torus(3.0, 1.0),
        Solid::sphere(1.0),
        Solid::cone(1.0, 0.0, 0.0, 2.0),
    ] {
        let method = "octree".parse().expect("a method");
        let world = world([solid.expect("valid")], method, Criteria::default());
        let cells = world.stats().cells.expect("an octree").cells;
        assert!(cells.occupied < 2000, "{cells:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn parity_along_a_line_is_membership(model in model(), origin in point(4.0), d in point(1.0)) {
        let Model { solid, recipe } = model;
        prop_assume!(d.length() > 0.1);
        let world = world([solid], Method::Auto, deep());
        let ray = Ray::new(origin, d);
        let hits = crossings(&world, ray, true);
        for pair in hits.windows(2) {
            prop_assert!(pair[0].t <= pair[1].t);
            prop_assert_ne!(pair[0].entering, pair[1].entering, "crossings alternate");
        }
        for i in -60..=60 {
            let t = f64::from(i) * 0.137;
            let (inside, margin) = recipe.contains(ray.at(t));
            if margin > 1e-6 {
                let found = match hits.iter().rev().find(|h| h.t < t) {
                    Some(hit) => hit.entering,
                    None => hits.first().map_or_else(
                        || recipe.contains(ray.at(-1e4)).0,
                        |first| !first.entering,
                    ),
                };
                prop_assert_eq!(found, inside, "t = {}", t);
            }
        }
    }

    #[test]
    fn the_octree_finds_what_brute_force_finds_to_the_bit(
        models in proptest::collection::vec(model(), 1..4),
        origins in proptest::collection::vec((point(4.0), point(1.0)), 40),
    ) {
        let solids: Vec<Solid> = models.into_iter().map(|m| m.solid).collect();
        let tree = world(solids.clone(), Method::Auto, deep());
        // Without cells, where the solids are small.
        let left_open = world(solids.clone(), Method::Auto, Criteria::default());
        let brute = world(solids, Method::Brute, deep());
        for (origin, direction) in origins {
            let ray = Ray::new(origin, direction);
            let expected = crossings(&brute, ray, true);
            prop_assert_eq!(crossings(&tree, ray, true), &expected[..]);
            prop_assert_eq!(crossings(&left_open, ray, true), expected);
            // Then along a chain of departures, through and off everything.
            let mut query = RayQuery::new(ray);
            for bounce in 0..6 {
                let hit = closest(&tree, query);
                prop_assert_eq!(hit, closest(&brute, query));
                prop_assert_eq!(hit, closest(&left_open, query));
                if hit.is_miss() {
                    break;
                }
                let surface = tree.interact(&query, &hit);
                prop_assert_eq!(surface, brute.interact(&query, &hit));
                let d = query.ray.direction;
                let mirrored = d - surface.normal * (2.0 * d.dot(surface.normal));
                let direction = if bounce % 2 == 0 { mirrored } else { d };
                query = RayQuery {
                    ray: Ray::new(surface.position, direction),
                    departure: hit.departure(direction.dot(surface.normal) > 0.0),
                    ..query
                };
            }
        }
    }

    #[test]
    fn a_continued_ray_meets_the_rest_of_the_boundaries_and_no_other(
        model in model(), origin in point(4.0), d in point(1.0),
    ) {
        prop_assume!(d.length() > 0.1);
        let world = world([model.solid], Method::Auto, deep());
        let expected = crossings(&world, Ray::new(origin, d), false);
        let mut query = RayQuery::new(Ray::new(origin, d));
        for hit in expected {
            let found = closest(&world, query);
            prop_assert_eq!(found.face, hit.face);
            let surface = world.interact(&query, &found);
            prop_assert!(surface.position.distance(Ray::new(origin, d).at(hit.t)) < 1e-9);
            query.ray = Ray::new(surface.position, d);
            query.departure = found.departure(!found.entering);
        }
        prop_assert!(closest(&world, query).is_miss());
    }

    #[test]
    fn the_structure_has_the_same_words_for_any_number_of_threads(
        models in proptest::collection::vec(model(), 1..4),
    ) {
        let solids: Vec<Solid> = models.into_iter().map(|m| m.solid).collect();
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("pool");
            let world = pool.install(|| world(solids.clone(), Method::Auto, deep()));
            world.words().collect::<Vec<u32>>()
        };
        prop_assert_eq!(with(1), with(4));
    }
}
