//! A good look for what comes without one: material, lights, camera and background.

use octray_math::{Aabb, DVec3};
use octray_scene::{
    Background, Camera, Color, ColorStop, Finish, Interior, Light, Material, Pigment, Scene,
    SceneBuilder,
};

/// Vertical field of view of default cameras, in radians: 30 degrees, a mild telephoto lens.
pub const VERTICAL_FOV: f64 = std::f64::consts::PI / 6.0;

/// The material of objects that name none: warm grey, slightly glossy.
#[must_use]
pub fn default_material() -> Material {
    Material {
        name: "default".to_owned(),
        pigment: Pigment::Uniform(Color::rgb(0.58, 0.54, 0.49)),
        finish: Finish {
            ambient: DVec3::splat(0.12),
            diffuse: 0.85,
            specular: 0.25,
            roughness: 0.03,
            ..Finish::default()
        },
        interior: Interior::default(),
    }
}

/// A camera that shows all of `bounds` from the front, a little from the right and from above.
///
/// `up` is the direction that is up in the scene; the front is the side of -y where z is up, of +z
/// where y is up. `None` for an empty or unbounded box.
#[must_use]
pub fn view_all(bounds: &Aabb, up: DVec3) -> Option<Camera> {
    let (front, right) = horizontal_axes(up);
    let direction = -front * 1.0 - right * 0.55 - up.normalize_or(DVec3::Z) * 0.5;
    Camera::view_all(bounds, direction, up, VERTICAL_FOV)
}

/// Unit directions to the scene's front and to the right of someone who looks at the front.
fn horizontal_axes(up: DVec3) -> (DVec3, DVec3) {
    let up = up.normalize_or(DVec3::Z);
    let front = if up.z.abs() > 0.7 {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    };
    let right = up.cross(front).normalize_or(DVec3::X);
    (right.cross(up), right)
}

/// Adds what the scene lacks: a camera that sees all of it, and, if it has no lights, three of
/// them and a background. Nothing that is there is changed.
#[must_use]
pub fn dress(scene: Scene) -> Scene {
    let scene = add_camera(scene);
    let Some(camera) = scene
        .camera()
        .copied()
        .filter(|_| scene.lights().is_empty())
    else {
        return scene;
    };
    let up = scene.settings().up;
    rebuilt(scene, |builder| {
        add_lights(builder, &camera);
        builder.set_background(backdrop(up));
    })
}

/// Adds a camera that sees all of the scene, if it has none.
#[must_use]
pub fn add_camera(scene: Scene) -> Scene {
    match view_all(&scene.bounds(), scene.settings().up) {
        Some(camera) if scene.camera().is_none() => {
            rebuilt(scene, |builder| builder.set_camera(camera))
        }
        _ => scene,
    }
}

/// The scene after a change, or as it was if the change cannot be (sizes near the end of the
/// range of numbers).
fn rebuilt(scene: Scene, change: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = scene.clone().into_builder();
    change(&mut builder);
    builder.build().unwrap_or(scene)
}

/// Key, fill and rim light, as a photographer places them about the camera.
fn add_lights(builder: &mut SceneBuilder, camera: &Camera) {
    let [forward, right, up] =
        [camera.forward, camera.right, camera.up].map(DVec3::normalize_or_zero);
    let mut add = |towards: DVec3, color: DVec3, shadows: bool| {
        if let Some(direction) = (-towards).try_normalize() {
            let mut light = Light::directional(direction, color);
            light.casts_shadows = shadows;
            light.makes_highlights = shadows;
            builder.add_light(light);
        }
    };
    // From the left above, warm; from the right, bluish and weak; from behind, along the edges.
    add(
        -right * 0.75 + up * 0.9 - forward,
        DVec3::new(1.0, 0.96, 0.9),
        true,
    );
    add(
        right + up * 0.15 - forward * 0.7,
        DVec3::new(0.22, 0.25, 0.3),
        false,
    );
    add(
        right * 0.4 + up * 0.6 + forward,
        DVec3::new(0.35, 0.37, 0.4),
        true,
    );
}

/// A soft gradient: darker below, light above.
fn backdrop(up: DVec3) -> Background {
    let stop = |position: f64, r: f64, g: f64, b: f64| ColorStop {
        position,
        color: Color::rgb(r, g, b),
    };
    Background::Gradient {
        axis: up.normalize_or(DVec3::Z),
        map: vec![stop(0.2, 0.32, 0.33, 0.35), stop(0.8, 0.86, 0.88, 0.9)],
    }
}
