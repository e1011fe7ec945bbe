//! Bent light, against Snell, Fresnel, and Beer and Lambert.

use octray_math::{DAffine3, DVec3};
use octray_scene::{Background, Color, ColorStop, Material, Pattern, Pigment};

use crate::stage::*;

/// Black at `x = -50`, white at `x = 50`, shining.
pub(crate) fn ruler() -> Material {
    let stop = |position, v| ColorStop {
        position,
        color: Color::rgb(v, v, v),
    };
    let mut material = dull();
    material.finish.emission = DVec3::ONE;
    material.pigment = Pigment::Pattern {
        pattern: Pattern::Gradient {
            axis: DVec3::X,
            map: vec![stop(0.0, 0.0), stop(1.0, 1.0)],
        },
        pattern_from_world: DAffine3::from_translation(DVec3::X * 0.5)
            * DAffine3::from_scale(DVec3::splat(0.01)),
    };
    material
}

#[test]
fn a_slab_of_glass_shifts_what_lies_behind_it() {
    for (ior, degrees) in [(1.5, 30.0_f64), (1.5, 70.0), (2.4, 55.0), (1.0, 45.0)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut glass = clear(ior);
        glass.finish.reflection = octray_scene::Reflection::default();
        let see = |stage: Stage| {
            let world = stage
                .solid(ground(0.0), ruler())
                .parallel(DVec3::new(0.0, 0.0, 3.0), DVec3::new(sin, 0.0, -cos), 1e-9)
                .world();
            reds(&shoot(&world, &small()))[0] * 100.0 - 50.0
        };
        let straight = see(Stage::new());
        let bent = see(Stage::new().solid(slab(1.0, 2.0), glass));
        assert!((straight - 3.0 * sin / cos).abs() < 1e-5);
        // Inside the slab (1 high) it runs at the refracted angle.
        let sin_t = sin / ior;
        let shift = sin_t / (1.0 - sin_t * sin_t).sqrt() - sin / cos;
        assert!(
            (bent - straight - shift).abs() < 2e-5,
            "{bent} {straight} {shift}"
        );
    }
}

/// Looking up from inside an endless pool of index 1.5: white above, dark grey below.
fn pool(degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut stage = Stage::new().solid(ground(0.0), clear(1.5));
    let stop = |position, v| ColorStop {
        position,
        color: Color::rgb(v, v, v),
    };
    stage.builder.set_background(Background::Gradient {
        axis: DVec3::Z,
        map: vec![stop(0.0, 0.1), stop(0.5, 0.1), stop(0.5, 1.0)],
    });
    let world = stage
        .parallel(DVec3::new(0.0, 0.0, -1.0), DVec3::new(sin, 0.0, cos), 1e-9)
        .world();
    reds(&shoot(&world, &small()))[0]
}

#[test]
fn the_surface_seen_from_below_mirrors_by_fresnel_and_totally_beyond_the_critical_angle() {
    let critical = (1.0_f64 / 1.5).asin().to_degrees();
    for degrees in [0.0, 20.0, 33.69, 41.0, critical - 1e-3] {
        let (i, n) = (f64::to_radians(degrees), 1.5);
        let t = (n * i.sin()).asin();
        // Fresnel's equations in their other form.
        let share = if i == 0.0 {
            (0.5_f64 / 2.5).powi(2)
        } else {
            let s = (i - t).sin() / (i + t).sin();
            let p = (i - t).tan() / (i + t).tan();
            0.5 * (s * s + p * p)
        };
        let expected = (1.0 - share) + 0.1 * share;
        let got = pool(degrees);
        assert!((got - expected).abs() < 1e-6, "{degrees}: {got} {expected}");
    }
    for degrees in [critical + 1e-3, 60.0, 89.0] {
        assert!((pool(degrees) - 0.1).abs() < 1e-7, "{degrees}");
    }
}

#[test]
fn light_in_a_medium_fades_with_its_length() {
    let mut murky = veil(DVec3::ONE);
    murky.interior.absorption = DVec3::new(0.7, 0.0, 0.0);
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let world = Stage::new()
        .solid(slab(0.0, 2.0), murky)
        .background(1.0)
        .parallel(DVec3::new(0.0, 0.0, 5.0), direction, 0.1)
        .world();
    let rendering = shoot(&world, &small());
    let expected = (-0.7_f64 * 2.0 / 0.8).exp();
    assert_all_near(&rendering, expected, 1e-6);
    assert!((rendering.film.mean(3, 3).y - 1.0).abs() < 1e-7);
}

#[test]
fn a_fade_weakens_light_by_its_own_law() {
    // What is left after 2.5 units: colour + (1 - colour) / (1 + (2.5 / 2)^3), or exponentially.
    let way = 2.0 / 0.8;
    for (power, left) in [
        (3.0, 1.0 / (1.0 + f64::powi(way / 2.0, 3))),
        (1001.0, f64::exp(-way / 2.0)),
    ] {
        let mut murky = veil(DVec3::ONE);
        murky.interior.fade = Some(octray_scene::Fade {
            half_distance: 2.0,
            power,
            color: DVec3::new(0.25, 1.0, 0.0),
        });
        murky.interior.absorption = DVec3::new(0.1, 0.0, 0.0);
        let world = Stage::new()
            .solid(slab(0.0, 2.0), murky)
            .background(1.0)
            .parallel(DVec3::new(0.0, 0.0, 5.0), DVec3::new(0.6, 0.0, -0.8), 0.1)
            .world();
        let rendering = shoot(&world, &small());
        let expected = (0.25 + 0.75 * left) * f64::exp(-0.1 * way);
        assert_all_near(&rendering, expected, 1e-6);
        let seen = rendering.film.mean(3, 3);
        assert!(
            (seen.y - 1.0).abs() < 1e-7 && (seen.z - left).abs() < 1e-6,
            "{seen}"
        );
    }
}

#[test]
fn a_ball_of_glass_turns_the_world_upside_down() {
    let mut stage = Stage::new().solid(ball(DVec3::ZERO, 1.0), clear(1.5));
    let stop = |position, v| ColorStop {
        position,
        color: Color::rgb(v, v, v),
    };
    stage.builder.set_background(Background::Gradient {
        axis: DVec3::Z,
        map: vec![stop(0.0, 0.0), stop(0.5, 0.0), stop(0.5, 1.0)],
    });
    let world = stage
        .parallel(DVec3::new(0.0, -5.0, 0.0), DVec3::Y, 1.0)
        .world();
    let rendering = shoot(&world, &small());
    let camera = world.scene().camera().expect("a camera");
    for y in 0..16u32 {
        for x in 0..16u32 {
            let across = (f64::from(x) + 0.5) / 16.0 - 0.5;
            let upward = 0.5 - (f64::from(y) + 0.5) / 16.0;
            let height = (camera.right * across + camera.up * upward).z;
            let got = rendering.film.mean(x, y).x;
            assert_eq!(got > 0.5, height < 0.0, "{x} {y}: {got}");
        }
    }
}
