//! What reaches a lit surface.

use octray_math::DVec3;
use octray_scene::{Light, Material, Object};

use crate::stage::*;

/// A matte floor lit straight from above through `obstacle`, seen below it from the side.
fn floor_under(obstacle: Option<(Solid, Material)>, light: Light) -> Stage {
    let mut stage = Stage::new()
        .solid(ground(0.0), diffuse(1.0))
        .light(light)
        .parallel(DVec3::new(0.0, -1.0, 0.2), DVec3::new(0.0, 1.0, -0.2), 0.02);
    if let Some((solid, material)) = obstacle {
        stage = stage.solid(solid, material);
    }
    stage
}

fn sun() -> Light {
    Light::directional(DVec3::NEG_Z, DVec3::ONE)
}

/// So far away that its light comes straight down on what is seen.
fn lamp() -> Light {
    Light::point(DVec3::new(0.0, 0.0, 1e4), DVec3::ONE)
}

fn assert_floor(stage: Stage, expected: f64) {
    assert_all_near(&shoot(&stage.world(), &small()), expected, 1e-6);
}

#[test]
fn opaque_things_cast_shadows_and_lamps_may_ignore_them() {
    for light in [sun(), lamp()] {
        let roof = || Some((slab(1.0, 1.1), dull()));
        assert_floor(floor_under(None, light.clone()), 1.0);
        assert_floor(floor_under(roof(), light.clone()), 0.0);
        let mut fill = light;
        fill.casts_shadows = false;
        assert_floor(floor_under(roof(), fill), 1.0);
    }
}

#[test]
fn what_is_behind_the_lamp_casts_no_shadow() {
    let light = Light::point(DVec3::new(0.0, 0.0, 1e4), DVec3::ONE);
    assert_floor(floor_under(Some((slab(2e4, 3e4), dull())), light), 1.0);
}

#[test]
fn veils_filter_once_per_surface() {
    for light in [sun(), lamp()] {
        let veiled = Some((slab(1.0, 1.1), veil(DVec3::splat(0.5))));
        assert_floor(floor_under(veiled, light), 0.25);
    }
}

#[test]
fn an_opaque_thing_behind_a_veil_still_casts_its_shadow() {
    let stage = floor_under(Some((slab(1.0, 1.1), veil(DVec3::ONE))), lamp());
    assert_floor(stage.solid(slab(2.0, 2.1), dull()), 0.0);
}

#[test]
fn absorbing_media_dim_shadow_rays_by_length() {
    for light in [sun(), lamp()] {
        let mut murky = veil(DVec3::ONE);
        murky.interior.absorption = DVec3::splat(2.0);
        let stage = floor_under(Some((slab(1.0, 1.5), murky)), light);
        // Half a unit of it: exp(-2 * 0.5).
        assert_floor(stage, (-1.0_f64).exp());
    }
}

#[test]
fn a_lamp_in_a_medium_reaches_a_floor_in_it() {
    let mut murky = veil(DVec3::ONE);
    murky.interior.absorption = DVec3::splat(0.5);
    let light = Light::point(DVec3::new(0.0, 0.0, 1.0), DVec3::ONE);
    // The camera is in it too: 0.01 of it lie between eye and floor, 1.0 between floor and lamp.
    let mut stage = Stage::new()
        .solid(slab(-1.0, 5.0), murky)
        .light(light)
        .parallel(DVec3::new(0.0, 0.0, 0.01), DVec3::NEG_Z, 1e-3);
    let id = stage.material(diffuse(1.0));
    let mut floor = Object::solid("floor", ground(0.0), id);
    floor.priority = 1;
    stage.builder.add_object(floor);
    let world = stage.world();
    let expected = (-0.5_f64 * 1.01).exp();
    assert_all_near(&shoot(&world, &small()), expected, 1e-6);
}

#[test]
fn a_thing_that_casts_no_shadow_is_not_there_for_light() {
    for material in [dull(), veil(DVec3::splat(0.5))] {
        let mut stage = floor_under(Some((slab(3.0, 3.1), veil(DVec3::splat(0.5)))), sun());
        let id = stage.material(material);
        let mut object = Object::solid("ghost", slab(1.0, 1.1), id);
        object.casts_shadows = false;
        stage.builder.add_object(object);
        assert_floor(stage, 0.25);
    }
}

#[test]
fn the_inside_of_a_closed_box_is_dark() {
    let room = Solid::difference([ball(DVec3::ZERO, 2.0), ball(DVec3::ZERO, 1.9)]);
    let world = Stage::new()
        .solid(room, diffuse(1.0))
        .light(Light::point(DVec3::new(0.0, 0.0, 5.0), DVec3::ONE))
        .light(Light::directional(DVec3::X, DVec3::ONE))
        .pinhole(DVec3::ZERO, DVec3::X)
        .world();
    assert_all_near(&shoot(&world, &small()), 0.0, 0.0);
}

#[test]
fn curved_surfaces_have_no_acne() {
    // A ball lit from the eye: every seen point is lit, however grazing.
    let eye = DVec3::new(0.0, -10.0, 0.0);
    let world = Stage::new()
        .solid(ball(DVec3::ZERO, 1.0), diffuse(1.0))
        .light(Light::point(eye, DVec3::ONE))
        .pinhole(eye, DVec3::Y)
        .world();
    let mut config = small();
    config.size = Some((200, 200));
    let stats = shoot(&world, &config).stats;
    assert!(stats.hits.primary > 200);
    assert_eq!(stats.rays.shadow, stats.hits.primary);
    assert_eq!(stats.hits.shadow, 0);
}
