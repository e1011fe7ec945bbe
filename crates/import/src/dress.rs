//! A good look for what comes without one: material, lights, camera and background.

use octray_geometry::Sheet;
use octray_math::{Aabb, DVec3};
use octray_scene::{
    Background, Camera, Color, ColorStop, Finish, Interior, Light, Material, Pigment, Scene,
    SceneBuilder, Shape,
};

/// Vertical field of view of default cameras, in radians: 30 degrees, a mild telephoto lens.
pub const VERTICAL_FOV: f64 = std::f64::consts::PI / 6.0;

/// The material of objects that name none: warm grey, slightly glossy.
#[must_use]
pub fn default_material() -> Material {
    Material {
        name: "default".to_owned(),
        pigment: Pigment::Uniform(Color::rgb(0.62, 0.56, 0.49)),
        finish: Finish {
            ambient: DVec3::splat(0.08),
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
    Camera::view_all(bounds, view_direction(up), up, VERTICAL_FOV)
}

/// The same of a scene, closer where its meshes do not fill the box around them. Unbounded objects
/// do not count; `None` if there are no others.
#[must_use]
pub fn view_scene(scene: &Scene) -> Option<Camera> {
    let up = scene.settings().up;
    Camera::view_points(outline(scene), view_direction(up), up, VERTICAL_FOV)
}

/// Where one looks at a part from, in a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At the front: from -y where z is up, from +z where y is up.
    Front,
    /// At the back.
    Back,
    /// At the side to the left of someone who looks at the front.
    Left,
    /// At the side to the right of someone who looks at the front.
    Right,
    /// From above, with the front below in the picture.
    Top,
    /// From below, with the front above in the picture.
    Bottom,
    /// Isometric, at the front, the right side and the top: equal lengths along the three axes look equal.
    Iso,
}

impl Side {
    /// All with their names.
    pub const ALL: [(&'static str, Self); 7] = [
        ("front", Self::Front),
        ("back", Self::Back),
        ("left", Self::Left),
        ("right", Self::Right),
        ("top", Self::Top),
        ("bottom", Self::Bottom),
        ("iso", Self::Iso),
    ];
}

/// A parallel projection that shows all of a scene from a side. Unbounded objects do not count;
/// `None` if there are no others.
#[must_use]
pub fn view_from(scene: &Scene, side: Side) -> Option<Camera> {
    let up = scene.settings().up.normalize_or(DVec3::Z);
    let (front, right) = horizontal_axes(up);
    let (towards, above) = match side {
        Side::Front => (front, up),
        Side::Back => (-front, up),
        Side::Left => (-right, up),
        Side::Right => (right, up),
        Side::Top => (up, -front),
        Side::Bottom => (-up, front),
        Side::Iso => (front + right + up, up),
    };
    Camera::project_points(outline(scene), -towards, above)
}

/// Points that have all bounded objects of a scene between them: vertices of meshes, corners of
/// boxes around others.
fn outline(scene: &Scene) -> impl Iterator<Item = DVec3> {
    scene.objects().iter().flat_map(|object| {
        let bounds = object.shape.bounds();
        let corners = bounds.corners().into_iter();
        let corners = corners.take(if bounds.is_bounded() && !bounds.is_empty() {
            8
        } else {
            0
        });
        let (corners, vertices) = match &object.shape {
            Shape::Sheet(Sheet::Mesh {
                mesh,
                world_from_mesh,
            }) => {
                let place = |p| world_from_mesh.transform_point3(p);
                (None, Some(mesh.used_positions().map(place)))
            }
            _ => (Some(corners), None),
        };
        corners
            .into_iter()
            .flatten()
            .chain(vertices.into_iter().flatten())
    })
}

/// From the front, a little from the right and from above.
fn view_direction(up: DVec3) -> DVec3 {
    let (front, right) = horizontal_axes(up);
    -front - right * 0.55 - up.normalize_or(DVec3::Z) * 0.5
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
    if scene.camera().is_some() {
        return scene;
    }
    match view_scene(&scene) {
        Some(camera) => rebuilt(scene, |builder| builder.set_camera(camera)),
        None => scene,
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
        -right * 0.9 + up * 1.0 - forward * 0.8,
        DVec3::new(1.12, 1.06, 0.98),
        true,
    );
    add(
        right + up * 0.1 - forward * 0.6,
        DVec3::new(0.17, 0.2, 0.25),
        false,
    );
    add(
        right * 0.8 + up * 0.9 + forward,
        DVec3::new(0.6, 0.64, 0.7),
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
        map: vec![stop(0.1, 0.06, 0.07, 0.09), stop(0.7, 0.42, 0.46, 0.52)],
    }
}

#[cfg(test)]
mod tests {
    use octray_geometry::Solid;
    use octray_scene::Object;

    use super::*;

    fn ball_at(center: DVec3, up: DVec3) -> Scene {
        let mut builder = SceneBuilder::new();
        builder.settings_mut().up = up;
        let material = builder.add_material(default_material());
        let ball = Solid::sphere(1.0).and_then(|s| s.translate(center));
        builder.add_object(Object::solid("ball", ball.expect("valid"), material));
        builder.build().expect("valid")
    }

    #[test]
    fn a_bare_scene_is_seen_from_the_front_right_above_and_lit_from_the_camera_s_side() {
        let center = DVec3::new(5.0, -3.0, 100.0);
        for (up, front, right) in [
            (DVec3::Z, DVec3::NEG_Y, DVec3::X),
            (DVec3::Y, DVec3::Z, DVec3::X),
        ] {
            let scene = dress(ball_at(center, up));
            let camera = scene.camera().expect("one");
            let from = camera.eye - center;
            assert!(from.dot(front) > from.dot(right) && from.dot(right) > 0.0);
            assert!(from.dot(up) > 0.0);
            assert!(camera.up.dot(up) > 0.0 && camera.right.dot(right) > 0.0);
            assert_eq!(scene.lights().len(), 3);
            let octray_scene::LightKind::Directional { direction } = scene.lights()[0].kind else {
                panic!("the key light comes from infinity");
            };
            assert!(direction.dot(camera.forward) > 0.0 && direction.dot(up) < 0.0);
        }
    }

    #[test]
    fn from_each_side_a_box_fills_the_drawing() {
        // Width, height and which way is up in the picture, of a box of 2 x 3 x 4 in a scene where
        // z is up: textbook first views of a part.
        let drawings = [
            (Side::Front, [2.0, 4.0], DVec3::Y, DVec3::Z),
            (Side::Back, [2.0, 4.0], DVec3::NEG_Y, DVec3::Z),
            (Side::Left, [3.0, 4.0], DVec3::X, DVec3::Z),
            (Side::Right, [3.0, 4.0], DVec3::NEG_X, DVec3::Z),
            (Side::Top, [2.0, 3.0], DVec3::NEG_Z, DVec3::Y),
            (Side::Bottom, [2.0, 3.0], DVec3::Z, DVec3::NEG_Y),
        ];
        let center = DVec3::new(7.0, -5.0, 30.0);
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(default_material());
        let part = Solid::cuboid(DVec3::new(-1.0, -1.5, -2.0), DVec3::new(1.0, 1.5, 2.0));
        let part = part.and_then(|s| s.translate(center)).expect("valid");
        builder.add_object(Object::solid("part", part, material));
        let scene = builder.build().expect("valid");
        for (side, [width, height], forward, above) in drawings {
            let camera = view_from(&scene, side).expect("bounded");
            assert_eq!(camera.projection, octray_scene::Projection::Orthographic);
            assert!(camera.forward.abs_diff_eq(forward, 1e-12), "{side:?}");
            assert!(camera.up.normalize().abs_diff_eq(above, 1e-12), "{side:?}");
            assert!(camera.right.dot(camera.forward).abs() < 1e-12);
            assert!(
                camera.right.cross(camera.up).dot(camera.forward) < 0.0,
                "not mirrored"
            );
            let shown = camera.up.length();
            assert!(
                (0.9..1.0).contains(&(f64::max(width, height) / shown)),
                "{side:?}"
            );
            let to_center = center - camera.eye;
            assert!(to_center.cross(camera.forward).length() < 1e-9, "{side:?}");
            assert!(
                to_center.dot(camera.forward) > 2.0,
                "{side:?}: stands outside"
            );
        }
        let iso = view_from(&scene, Side::Iso).expect("bounded");
        let lengths = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let across = [iso.right, iso.up].map(|side| side.normalize().dot(axis));
            across[0].hypot(across[1])
        });
        for length in lengths {
            assert!(
                (length - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12,
                "{lengths:?}"
            );
        }
    }

    #[test]
    fn what_a_scene_has_is_kept() {
        let mut builder = ball_at(DVec3::ZERO, DVec3::Z).into_builder();
        let camera = Camera::look_at(DVec3::X * 9.0, DVec3::ZERO, DVec3::Z, 1.0).expect("valid");
        builder.set_camera(camera);
        builder.add_light(Light::point(DVec3::X * 5.0, DVec3::ONE));
        let scene = dress(builder.build().expect("valid"));
        assert_eq!(scene.camera(), Some(&camera));
        assert_eq!(scene.lights().len(), 1);
        assert_eq!(*scene.background(), Background::default());
    }

    #[test]
    fn an_empty_scene_stays_empty() {
        let empty = SceneBuilder::new().build().expect("valid");
        assert!(view_scene(&empty).is_none());
        assert!(view_from(&empty, Side::Top).is_none());
        let dressed = dress(empty);
        assert!(dressed.camera().is_none() && dressed.lights().is_empty());
    }
}
