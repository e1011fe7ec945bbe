//! Light neither lost nor made.

use octray_math::DVec3;
use octray_scene::{Falloff, Light};

use crate::stage::*;

#[test]
fn a_matte_plane_shows_intensity_times_cosine_over_squared_distance() {
    let height = 2.0;
    let lamp = DVec3::new(0.3, -0.2, height);
    let mut light = Light::point(lamp, DVec3::splat(5.0));
    light.falloff = Falloff::InverseSquare;
    let world = Stage::new()
        .solid(ground(0.0), diffuse(0.8))
        .light(light)
        .parallel(DVec3::new(0.0, 0.0, 10.0), DVec3::NEG_Z, 4.0)
        .world();
    let rendering = shoot(&world, &small());
    let camera = *world.scene().camera().expect("a camera");
    for y in 0..16u32 {
        for x in 0..16u32 {
            let across = (f64::from(x) + 0.5) / 16.0 - 0.5;
            let upward = 0.5 - (f64::from(y) + 0.5) / 16.0;
            let mut point = camera.eye + camera.right * across + camera.up * upward;
            point.z = 0.0;
            let d = (lamp - point).length();
            let expected = 0.8 * 5.0 * (height / d) / (d * d);
            let got = rendering.film.mean(x, y).x;
            assert!((got - expected).abs() < 1e-6, "{got} {expected}");
        }
    }
}

/// A camera in the middle of a ball: every ray meets the wall head on and comes back through the
/// middle, so the light seen is a geometric series.
fn inside_a_ball(lamps: u32) -> Stage {
    let mut wall = glowing_mirror(0.0, 0.5);
    wall.finish.diffuse = 0.25;
    let mut stage = Stage::new()
        .solid(ball(DVec3::ZERO, 1.0), wall)
        .pinhole(DVec3::ZERO, DVec3::new(1.0, 0.4, -0.3));
    for _ in 0..lamps {
        let mut light = Light::point(DVec3::ZERO, DVec3::splat(2.0 / f64::from(lamps)));
        light.falloff = Falloff::InverseSquare;
        stage = stage.light(light);
    }
    stage
}

#[test]
fn lamp_and_mirror_in_a_ball_make_the_whole_series() {
    // 0.25 * 2 * (1 + 1/2 + 1/4 + ...) = 1, and the same with the lamp split into four.
    for lamps in [1, 4] {
        let mut config = small();
        config.max_generations = Some(40);
        let rendering = shoot(&inside_a_ball(lamps).world(), &config);
        assert_all_near(&rendering, 1.0, 1e-5);
    }
}

#[test]
fn a_glowing_mirror_ball_seen_from_inside_is_uniform() {
    let world = Stage::new()
        .solid(ball(DVec3::ZERO, 1.0), glowing_mirror(0.5, 0.5))
        .pinhole(DVec3::new(0.3, 0.1, 0.2), DVec3::X)
        .world();
    let mut config = small();
    config.max_generations = Some(40);
    assert_all_near(&shoot(&world, &config), 1.0, 1e-6);
}

#[test]
fn a_white_mirror_in_a_white_world_cannot_be_seen() {
    let world = Stage::new()
        .solid(ball(DVec3::ZERO, 1.0), glowing_mirror(0.0, 1.0))
        .solid(slab(-1.5, -1.2), glowing_mirror(0.0, 1.0))
        .background(1.0)
        .pinhole(DVec3::new(0.0, -3.0, 1.0), DVec3::new(0.0, 3.0, -1.2))
        .world();
    let mut config = small();
    config.max_generations = Some(100);
    assert_all_near(&shoot(&world, &config), 1.0, 1e-9);
}

#[test]
fn clear_glass_in_a_white_world_cannot_be_seen() {
    let cup = Solid::difference([ball(DVec3::ZERO, 1.0), ball(DVec3::new(0.0, 0.0, 0.5), 0.8)]);
    for solid in [ball(DVec3::ZERO, 1.0), slab(-0.5, 0.5), cup] {
        let world = Stage::new()
            .solid(solid, clear(1.5))
            .background(1.0)
            .pinhole(DVec3::new(0.2, -3.0, 1.0), DVec3::new(0.0, 3.0, -1.0))
            .world();
        let mut config = small();
        // What is still inside the glass after so many generations is missing; with a threshold
        // the ray tree stays finite.
        config.max_generations = Some(200);
        config.contribution_threshold = Some(1e-7);
        let rendering = shoot(&world, &config);
        assert_all_near(&rendering, 1.0, 2e-5);
        assert!(rendering.stats.rays.refracted > 0);
    }
}

#[test]
fn ambient_light_is_weighted_by_opacity() {
    let mut veil = veil(DVec3::new(0.25, 1.0, 1.0));
    veil.finish.ambient = DVec3::splat(0.5);
    let octray_scene::Pigment::Uniform(color) = &mut veil.pigment else {
        unreachable!("a veil is uniform");
    };
    color.filter = 0.4;
    let mut stage = Stage::new();
    stage.builder.settings_mut().ambient_light = DVec3::splat(2.0);
    let world = stage
        .solid(ground(0.0), veil)
        .background(0.0)
        .parallel(DVec3::Z, DVec3::NEG_Z, 1.0)
        .world();
    // 0.25 * 0.5 * 2 * (1 - 0.4).
    assert_all_near(&shoot(&world, &small()), 0.15, 1e-7);
}
