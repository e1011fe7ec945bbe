//! Where ray trees end, and what is counted.

use octray_math::DVec3;
use octray_render::{RenderConfig, RenderError, render};
use octray_scene::{Falloff, Light};

use crate::stage::*;

/// Between two parallel mirrors that shine by 1 and reflect a half.
fn between_mirrors() -> octray_world::World {
    Stage::new()
        .solid(ground(0.0), glowing_mirror(1.0, 0.5))
        .solid(ceiling(1.0), glowing_mirror(1.0, 0.5))
        .pinhole(DVec3::new(0.0, 0.0, 0.4), DVec3::new(0.1, 0.2, 1.0))
        .world()
}

#[test]
fn generations_between_two_mirrors_make_a_geometric_series() {
    let world = between_mirrors();
    for generations in 1..=12 {
        let mut config = small();
        config.max_generations = Some(generations);
        let rendering = shoot(&world, &config);
        let expected = 2.0 * (1.0 - 0.5_f64.powi(generations as i32));
        assert_all_near(&rendering, expected, 0.0);
        let pixels = 16 * 16;
        assert_eq!(rendering.stats.rays.primary, pixels);
        assert_eq!(
            rendering.stats.rays.reflected,
            pixels * u64::from(generations - 1)
        );
        assert_eq!(rendering.stats.ended_by_generation, pixels);
    }
}

#[test]
fn branches_below_the_threshold_end() {
    let world = between_mirrors();
    // Weights 1, 1/2, 1/4, 1/8: the branch of exactly the threshold goes on.
    for (threshold, terms) in [(0.2, 3), (0.25, 3), (0.125, 4), (0.6, 1)] {
        let mut config = small();
        config.max_generations = Some(50);
        config.contribution_threshold = Some(threshold);
        let rendering = shoot(&world, &config);
        let expected = 2.0 * (1.0 - 0.5_f64.powi(terms));
        assert_all_near(&rendering, expected, 0.0);
        assert_eq!(rendering.stats.ended_by_contribution, 16 * 16);
    }
}

#[test]
fn shadow_rays_go_only_to_lamps_that_could_be_seen() {
    let above = |x: f64| Light::point(DVec3::new(x, 0.0, 5.0), DVec3::ONE);
    let mut out_of_cone = above(0.0);
    out_of_cone.kind = octray_scene::LightKind::Spot {
        position: DVec3::new(0.0, 0.0, 5.0),
        direction: DVec3::Z,
        inner: 0.3,
        outer: 0.5,
        tightness: 0.0,
    };
    let mut shadowless = above(3.0);
    shadowless.casts_shadows = false;
    let world = Stage::new()
        .solid(ground(0.0), diffuse(1.0))
        .light(above(1.0))
        .light(above(2.0))
        .light(Light::point(DVec3::new(0.0, 0.0, -5.0), DVec3::ONE))
        .light(Light::point(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO))
        .light(out_of_cone)
        .light(shadowless)
        .parallel(DVec3::Z, DVec3::NEG_Z, 1.0)
        .world();
    let stats = shoot(&world, &small()).stats;
    assert_eq!((stats.rays.shadow, stats.hits.shadow), (2 * 256, 0));
    assert_eq!((stats.rays.primary, stats.hits.primary), (256, 256));
    assert_eq!((stats.rays.reflected, stats.rays.refracted), (0, 0));
}

#[test]
fn queues_stay_short_however_many_rays_there_are() {
    // Half mirrors, half veils: every ray splits in two at every surface.
    let mut half = veil(DVec3::splat(0.5));
    half.finish.reflection = octray_scene::Reflection::constant(DVec3::splat(0.5));
    let mut stage = Stage::new().background(1.0);
    for i in 0..20 {
        let bottom = -f64::from(i);
        stage = stage.solid(slab(bottom, bottom + 0.5), half.clone());
    }
    let world = stage
        .pinhole(DVec3::new(0.0, 0.0, -5.1), DVec3::NEG_Z)
        .world();
    let mut config = small();
    config.size = Some((32, 32));
    config.max_generations = Some(9);
    let stats = shoot(&world, &config).stats;
    let traced = stats.rays.total();
    assert!(traced > 200_000, "{traced} rays");
    assert!(
        stats.longest_queue < 10_000,
        "{} waited",
        stats.longest_queue
    );
}

#[test]
fn absurd_light_is_bounded_and_counted() {
    let mut light = Light::point(DVec3::new(0.0, 0.0, 1e-9), DVec3::splat(1e300));
    light.falloff = Falloff::InverseSquare;
    let world = Stage::new()
        .solid(ground(0.0), diffuse(1.0))
        .light(light)
        .parallel(DVec3::Z, DVec3::NEG_Z, 1.0)
        .world();
    let rendering = shoot(&world, &small());
    assert!(rendering.stats.replaced_contributions > 0);
    assert!(reds(&rendering).iter().all(|v| v.is_finite()));
}

#[test]
fn a_scene_without_camera_is_an_error() {
    let world = Stage::new().world();
    let error = render(&world, None, &RenderConfig::default(), &());
    assert_eq!(error.map(|_| ()), Err(RenderError::NoCamera));
}

#[test]
fn an_empty_scene_shows_its_background() {
    let world = Stage::new()
        .background(0.25)
        .pinhole(DVec3::ZERO, DVec3::X)
        .world();
    assert_all_near(&shoot(&world, &small()), 0.25, 0.0);
}
