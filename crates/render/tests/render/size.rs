//! The same picture of a scene of any size.

use octray_math::{DAffine3, DVec3};
use octray_render::Rendering;
use octray_scene::{Background, Camera, Color, Light, Material, Pattern, Pigment};

use crate::stage::*;

const WIDTH: u32 = 128;
const HEIGHT: u32 = 96;

fn shiny(rgb: DVec3) -> Material {
    let mut material = Material::matte("shiny", rgb);
    material.finish.specular = 0.5;
    material.finish.reflection.min = DVec3::splat(0.2);
    material.finish.reflection.max = DVec3::splat(0.6);
    material.finish.reflection.falloff = 2.0;
    material
}

/// Black and white tiles of the edge `k`.
fn tiles(k: f64) -> Material {
    let uniform = |v| Pigment::Uniform(Color::rgb(v, v, v));
    let mut material = shiny(DVec3::ONE);
    material.pigment = Pigment::Pattern {
        pattern: Pattern::Checker(Box::new([uniform(0.9), uniform(0.1)])),
        pattern_from_world: DAffine3::from_scale(DVec3::splat(1.0 / k)),
    };
    material
}

/// A drilled block, a ring, a cone, a ball of tinted glass and a mirror on tiles, all dimensions
/// times `k`: shadows, reflection, refraction and absorption.
fn still_life(k: f64) -> Rendering {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * k;
    let put = |solid: Solid, x, y, z| solid.translate(at(x, y, z)).expect("finite");
    let block = Solid::cuboid(at(-0.7, -0.7, 0.0), at(0.7, 0.7, 1.2)).expect("a box");
    let drill = Solid::cylinder(0.4 * k, 0.0, 1.2 * k).expect("a cylinder");
    let ring = Solid::torus(0.6 * k, 0.2 * k).expect("a torus");
    let cone = Solid::cone(0.5 * k, 0.1 * k, 0.0, 1.1 * k).expect("a cone");
    let mut glass = Material::glass("glass", 1.5);
    glass.interior.absorption = DVec3::new(0.9, 0.2, 0.5) / k;
    let mut stage = Stage::new()
        .solid(ground(0.0), tiles(k))
        .solid(
            put(Solid::difference([block, drill]), -1.2, 0.6, 0.0),
            shiny(DVec3::new(0.7, 0.3, 0.2)),
        )
        .solid(put(ring, 1.1, 0.9, 0.2), shiny(DVec3::new(0.2, 0.5, 0.3)))
        .solid(
            put(cone, 1.1, 0.9, 0.0),
            Material::mirror("steel", DVec3::splat(0.9)),
        )
        .solid(ball(at(0.1, -1.0, 0.6), 0.6 * k), glass)
        .light(Light::point(at(-3.0, -4.0, 6.0), DVec3::splat(0.8)))
        .light(Light::point(at(4.0, -2.0, 3.0), DVec3::new(0.2, 0.25, 0.4)));
    stage
        .builder
        .set_background(Background::Uniform(DVec3::new(0.3, 0.4, 0.6)));
    let up = DVec3::Z;
    let camera = Camera::look_at(at(0.6, -5.0, 2.6), at(0.0, 0.0, 0.5), up, 0.75);
    stage.builder.set_camera(camera.expect("a camera"));
    let mut config = small();
    config.size = Some((WIDTH, HEIGHT));
    config.contribution_threshold = Some(1.0 / 512.0);
    let rendering = shoot(&stage.world(), &config);
    let rays = &rendering.stats.rays;
    assert!(rays.reflected > 1000 && rays.refracted > 1000 && rays.shadow > 10_000);
    rendering
}

fn pixels(rendering: &Rendering) -> Vec<DVec3> {
    (0..HEIGHT)
        .flat_map(|y| (0..WIDTH).map(move |x| (x, y)))
        .map(|(x, y)| rendering.film.mean(x, y))
        .collect()
}

#[test]
fn scaled_by_a_power_of_two_it_has_the_same_bits() {
    let expected = pixels(&still_life(1.0));
    for exponent in [-30, 30] {
        let got = pixels(&still_life(libm::ldexp(1.0, exponent)));
        assert_eq!(got, expected, "2^{exponent}");
    }
}

#[test]
fn scaled_by_a_billion_or_a_billionth_it_is_the_same() {
    let expected = pixels(&still_life(1.0));
    for k in [1e-9, 1e9] {
        let got = pixels(&still_life(k));
        let off = |(a, b): &(&DVec3, &DVec3)| (**a - **b).abs().max_element() > 1.0 / 255.0;
        let differ = got.iter().zip(&expected).filter(off).count();
        // 10^-4 of the pixels.
        assert!(differ <= expected.len() / 10_000, "{k}: {differ}");
    }
}
