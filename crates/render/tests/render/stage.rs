//! Scenes in few words.

use std::sync::Arc;

use octray_math::DVec3;
use octray_render::{RenderConfig, Rendering, render};
use octray_scene::{
    Background, Camera, Color, Finish, Material, MaterialId, Object, Pigment, Reflection, Scene,
    SceneBuilder,
};
use octray_world::{World, WorldConfig};

pub(crate) use octray_geometry::Solid;

/// A scene being set up; nothing shines unless it is said.
pub(crate) struct Stage {
    pub(crate) builder: SceneBuilder,
}

/// No light of its own, no mirror, opaque white.
pub(crate) fn dull() -> Material {
    Material {
        finish: Finish {
            ambient: DVec3::ZERO,
            diffuse: 0.0,
            ..Finish::default()
        },
        ..Material::matte("dull", DVec3::ONE)
    }
}

/// Lambert's surface only.
pub(crate) fn diffuse(share: f64) -> Material {
    let mut material = dull();
    material.finish.diffuse = share;
    material
}

/// Shines by itself and mirrors a constant share.
pub(crate) fn glowing_mirror(emission: f64, share: f64) -> Material {
    let mut material = dull();
    material.finish.emission = DVec3::splat(emission);
    material.finish.reflection = Reflection::constant(DVec3::splat(share));
    material
}

/// Lets everything through that Fresnel does not mirror; no highlights.
pub(crate) fn clear(ior: f64) -> Material {
    let mut material = Material::glass("clear", ior);
    material.finish.specular = 0.0;
    material
}

/// Lets `share` through without mirroring or bending.
pub(crate) fn veil(share: DVec3) -> Material {
    let mut material = dull();
    material.pigment = Pigment::Uniform(Color {
        rgb: share,
        filter: 1.0,
        transmit: 0.0,
    });
    material
}

impl Stage {
    pub(crate) fn new() -> Self {
        let mut builder = SceneBuilder::new();
        builder.settings_mut().contribution_threshold = 0.0;
        Self { builder }
    }

    pub(crate) fn solid(mut self, solid: Solid, material: Material) -> Self {
        let id = self.material(material);
        self.builder.add_object(Object::solid("solid", solid, id));
        self
    }

    pub(crate) fn material(&mut self, material: Material) -> MaterialId {
        self.builder.add_material(material)
    }

    pub(crate) fn light(mut self, light: octray_scene::Light) -> Self {
        self.builder.add_light(light);
        self
    }

    pub(crate) fn background(mut self, value: f64) -> Self {
        let color = Background::Uniform(DVec3::splat(value));
        self.builder.set_background(color);
        self
    }

    /// Sees along `direction` in parallel rays, `height` units high.
    pub(crate) fn parallel(mut self, eye: DVec3, direction: DVec3, height: f64) -> Self {
        let up = direction.any_orthogonal_vector();
        let camera = Camera::orthographic(eye, eye + direction, up, height);
        self.builder.set_camera(camera.expect("a camera"));
        self
    }

    /// Sees along `direction` with 60 degrees from bottom to top.
    pub(crate) fn pinhole(mut self, eye: DVec3, direction: DVec3) -> Self {
        let up = direction.any_orthogonal_vector();
        let camera = Camera::look_at(eye, eye + direction, up, 60.0_f64.to_radians());
        self.builder.set_camera(camera.expect("a camera"));
        self
    }

    pub(crate) fn scene(self) -> Scene {
        self.builder.build().expect("a valid scene")
    }

    pub(crate) fn world(self) -> World {
        prepare(self.scene())
    }
}

pub(crate) fn prepare(scene: Scene) -> World {
    World::prepare(Arc::new(scene), &WorldConfig::default()).expect("a world")
}

/// A small square picture, otherwise as the scene wants it.
pub(crate) fn small() -> RenderConfig {
    RenderConfig {
        size: Some((16, 16)),
        ..RenderConfig::default()
    }
}

pub(crate) fn shoot(world: &World, config: &RenderConfig) -> Rendering {
    let rendering = render(world, None, config, &()).expect("a picture");
    assert!(rendering.is_complete());
    rendering
}

/// All pixels, in rows from the top, red channel.
pub(crate) fn reds(rendering: &Rendering) -> Vec<f64> {
    let crop = rendering.plan.crop;
    (0..crop.height)
        .flat_map(|y| (0..crop.width).map(move |x| (x, y)))
        .map(|(x, y)| rendering.film.mean(x, y).x)
        .collect()
}

pub(crate) fn assert_all_near(rendering: &Rendering, expected: f64, tolerance: f64) {
    for (index, got) in reds(rendering).into_iter().enumerate() {
        assert!(
            (got - expected).abs() <= tolerance,
            "pixel {index}: {got}, not {expected}"
        );
    }
}

/// The half-space below the plane `z = height`.
pub(crate) fn ground(height: f64) -> Solid {
    Solid::half_space(DVec3::Z, height).expect("a half-space")
}

/// The half-space above the plane `z = height`.
pub(crate) fn ceiling(height: f64) -> Solid {
    Solid::half_space(DVec3::NEG_Z, -height).expect("a half-space")
}

/// A wide slab between two heights.
pub(crate) fn slab(bottom: f64, top: f64) -> Solid {
    let corner = |z| DVec3::new(1e3, 1e3, z);
    let other = DVec3::new(-1e3, -1e3, bottom);
    Solid::cuboid(other, corner(top)).expect("a box")
}

pub(crate) fn ball(center: DVec3, radius: f64) -> Solid {
    let ball = Solid::sphere(radius).expect("a sphere");
    ball.translate(center).expect("a sphere")
}
