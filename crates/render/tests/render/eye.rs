//! An eye in glass, and exactly on a surface.

use octray_math::DVec3;
use octray_scene::{Background, Color, ColorStop, Material, Reflection};

use crate::stage::*;

const GLASS: f64 = 1.5;

fn plain_glass() -> Material {
    let mut material = clear(GLASS);
    material.finish.reflection = Reflection::default();
    material
}

/// What comes out of a scene in which the background's value is `(1 + direction along y) / 2`, seen
/// from `eye` towards `(cos, sin, 0)`.
fn seen(stage: Stage, eye: DVec3, angle: f64) -> f64 {
    let stop = |position, v| ColorStop {
        position,
        color: Color::rgb(v, v, v),
    };
    let mut stage = stage;
    stage.builder.set_background(Background::Gradient {
        axis: DVec3::Y,
        map: vec![stop(0.0, 0.0), stop(1.0, 1.0)],
    });
    let toward = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let world = stage.parallel(eye, toward, 1e-15).world();
    2.0 * reds(&shoot(&world, &small()))[0] - 1.0
}

fn angles() -> impl Iterator<Item = f64> {
    // No multiple of a right angle.
    (0..72).map(|i| (f64::from(i) * 5.0 + 1.3).to_radians())
}

#[test]
fn an_eye_in_a_ball_of_glass_sees_out_by_snell() {
    let eye = DVec3::new(0.35, 0.0, 0.0);
    for angle in angles() {
        // Where the ray meets the unit sphere, and at which angle to the normal there.
        let (sin, cos) = angle.sin_cos();
        let along = -eye.x * cos + (1.0 - eye.x * eye.x * sin * sin).sqrt();
        let normal = (along * sin).atan2(eye.x + along * cos);
        let inside = angle - normal;
        let outside = (GLASS * inside.sin()).asin();
        let expected = (normal + outside).sin();
        let stage = Stage::new().solid(ball(DVec3::ZERO, 1.0), plain_glass());
        let got = seen(stage, eye, angle);
        assert!((got - expected).abs() < 1e-6, "{angle}: {got} {expected}");
    }
}

#[test]
fn an_eye_on_a_ball_of_glass_sees_the_world_or_through_the_ball() {
    for angle in angles() {
        let (sin, cos) = angle.sin_cos();
        let expected = if cos > 0.0 {
            // Away from the ball: straight.
            sin
        } else {
            // Through it: the angle to the normal is the same at both ends of the chord.
            let inside = std::f64::consts::PI - angle;
            let outside = GLASS * inside.sin();
            if outside.abs() >= 1.0 {
                continue;
            }
            (angle - inside + outside.asin()).sin()
        };
        for radius in [1.0, 3.0, 0.7] {
            let stage = Stage::new().solid(ball(DVec3::ZERO, radius), plain_glass());
            let got = seen(stage, DVec3::X * radius, angle);
            assert!(
                (got - expected).abs() < 1e-6,
                "{radius}, {angle}: {got} {expected}"
            );
        }
    }
}

#[test]
fn an_eye_on_a_block_of_glass_sees_the_world_or_through_the_block() {
    // The face x = 0.3 of an endless slab: what goes in comes out parallel on the other side only
    // to what it was inside.
    for angle in angles() {
        let corner = DVec3::new(1e3, 1e3, 1e3);
        let slab = Solid::cuboid(-corner, DVec3::new(0.3, 1e3, 1e3)).expect("a box");
        let thin = Solid::cuboid(DVec3::new(-0.5, -1e3, -1e3), corner).expect("a box");
        let stage = Stage::new().solid(Solid::intersection([slab, thin]), plain_glass());
        let (sin, cos) = angle.sin_cos();
        let outside = GLASS * sin;
        if cos < 0.0 && outside.abs() >= 0.999 {
            continue;
        }
        let expected = if cos > 0.0 { sin } else { outside };
        let got = seen(stage, DVec3::new(0.3, 0.1, -0.2), angle);
        assert!((got - expected).abs() < 1e-6, "{angle}: {got} {expected}");
    }
}

#[test]
fn an_eye_on_a_floor_sees_it_in_one_half_of_the_picture() {
    // Looking along the floor: above the horizon the background, below it the far sides of the floor
    // seen from inside, which are dark.
    for height in [0.0, 0.1, -7.3] {
        let eye = DVec3::new(0.4, -1.3, height);
        let world = Stage::new()
            .solid(slab(height - 1.0, height), dull())
            .background(1.0)
            .pinhole(eye, DVec3::NEG_Y)
            .world();
        let rendering = shoot(&world, &small());
        let camera = *world.scene().camera().expect("a camera");
        for y in 0..16u32 {
            for x in 0..16u32 {
                let across = (f64::from(x) + 0.5) / 16.0 - 0.5;
                let upward = 0.5 - (f64::from(y) + 0.5) / 16.0;
                let toward = camera.forward + camera.right * across + camera.up * upward;
                let got = rendering.film.mean(x, y).x;
                let expected = f64::from(u8::from(toward.z > 0.0));
                assert_eq!(got, expected, "{toward}");
            }
        }
    }
}
