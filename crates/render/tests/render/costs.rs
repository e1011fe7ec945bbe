//! What rays cost, by kind of ray.

use std::sync::Arc;

use octray_math::DVec3;
use octray_render::{RenderConfig, RenderStats, Rendering, Shows, cost_channels};
use octray_scene::{Light, Scene};
use octray_world::{Counters, Criteria, Method, World, WorldConfig};

use crate::stage::*;

fn with_method(scene: &Arc<Scene>, method: Method) -> World {
    let config = WorldConfig {
        method,
        // As far as large scenes are divided.
        criteria: Criteria {
            visit_cost: 0.1,
            ..Criteria::default()
        },
        ..WorldConfig::default()
    };
    World::prepare(Arc::clone(scene), &config).expect("a world")
}

/// Five balls, one of them a mirror and one of glass, over a floor, with a lamp.
fn balls() -> Arc<Scene> {
    let at = |x: f64, y: f64| ball(DVec3::new(x, y, 0.0), 0.8);
    let stage = Stage::new()
        .solid(ground(-1.0), diffuse(0.8))
        .solid(at(0.0, 0.0), clear(1.5))
        .solid(at(-2.0, 0.5), glowing_mirror(0.1, 0.5))
        .solid(at(2.0, 0.0), diffuse(0.5))
        .solid(at(-1.0, 3.0), diffuse(0.5))
        .solid(at(1.0, 3.0), diffuse(0.5))
        .light(Light::point(DVec3::new(3.0, -4.0, 5.0), DVec3::ONE))
        .pinhole(DVec3::new(0.0, -5.0, 1.0), DVec3::new(0.0, 1.0, -0.1));
    Arc::new(stage.scene())
}

/// The surfaces of that scene.
const SURFACES: u64 = 6;

fn sum(stats: &RenderStats) -> Counters {
    let mut sum = Counters::default();
    for (_, counters) in stats.queries.named() {
        sum += *counters;
    }
    sum
}

#[test]
fn brute_force_tests_every_surface_with_every_ray_of_a_path() {
    let stats = shoot(&with_method(&balls(), Method::Brute), &small()).stats;
    for ((kind, cost), (_, rays)) in stats.queries.named().into_iter().zip(stats.rays.named()) {
        assert!(*rays > 0, "{kind}");
        assert_eq!(cost.triangle_tests + cost.nodes, 0);
        if kind != "shadow" {
            assert_eq!(cost.rays, *rays, "{kind}");
            assert_eq!(cost.surface_tests, rays * SURFACES, "{kind}");
        }
    }
    // A shadow ray that meets no opaque surface is traced through the glass, surface by surface.
    let shadow = stats.queries.shadow;
    let open = stats.rays.shadow - stats.hits.shadow;
    assert!(shadow.rays >= stats.rays.shadow + open);
    assert_eq!(shadow.surface_tests, shadow.rays * SURFACES);
    assert_eq!(stats.queries.total(), sum(&stats));
}

#[test]
fn an_octree_saves_tests_of_every_kind_of_ray_and_shows_the_same_picture() {
    let scene = balls();
    let brute = shoot(&with_method(&scene, Method::Brute), &small());
    let octree = shoot(&with_method(&scene, Method::Auto), &small());
    assert_eq!(brute.film, octree.film);
    assert_eq!(
        (brute.stats.rays, brute.stats.hits),
        (octree.stats.rays, octree.stats.hits)
    );
    let pairs = brute.stats.queries.named().into_iter();
    for ((kind, brute), (_, octree)) in pairs.zip(octree.stats.queries.named()) {
        assert!(octree.surface_tests < brute.surface_tests, "{kind}");
        assert!(octree.cells > 0, "{kind}");
        assert_eq!(octree.rays, brute.rays, "{kind}");
    }
}

/// A picture of costs, in a pool of so many threads.
fn cost_picture(world: &World, threads: usize) -> Rendering {
    let config = RenderConfig {
        size: Some((26, 19)),
        spp: 2,
        shows: Shows::Cost,
        ..RenderConfig::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build()
        .expect("a pool")
        .install(|| shoot(world, &config))
}

#[test]
fn the_pixels_of_a_cost_picture_add_up_to_the_counters() {
    for method in Method::all() {
        let world = with_method(&balls(), method);
        let one = cost_picture(&world, 1);
        let mut sum = DVec3::ZERO;
        for y in 0..19 {
            for x in 0..26 {
                sum += one.film.mean(x, y) * 2.0;
            }
        }
        // Whole numbers, and halves of them: exact.
        assert_eq!(sum, cost_channels(&one.stats.queries.total()), "{method}");
        let four = cost_picture(&world, 4);
        assert_eq!(one.film, four.film, "{method}");
        assert_eq!(one.stats, four.stats, "{method}");
    }
    let world = with_method(&balls(), Method::Auto);
    let light = RenderConfig {
        size: Some((26, 19)),
        spp: 2,
        ..RenderConfig::default()
    };
    let light = shoot(&world, &light);
    assert_eq!(light.stats, cost_picture(&world, 1).stats, "the same rays");
}

#[test]
fn brute_force_costs_every_surface_for_every_ray() {
    // Balls that neither mirror nor let light through, and no lamp: one ray per sample.
    let mut stage = Stage::new();
    for i in 0..7 {
        stage = stage.solid(ball(DVec3::new(f64::from(i), 0.0, 0.0), 0.4), diffuse(1.0));
    }
    let stage = stage.pinhole(DVec3::new(3.0, -5.0, 0.0), DVec3::Y);
    let world = with_method(&Arc::new(stage.scene()), Method::Brute);
    let costs = cost_picture(&world, 2);
    for y in 0..19 {
        for x in 0..26 {
            assert_eq!(costs.film.mean(x, y), DVec3::new(0.0, 7.0, 0.0));
        }
    }
}
