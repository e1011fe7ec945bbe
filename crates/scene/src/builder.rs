use std::sync::Arc;

use octray_geometry::{MaterialId, Primitive, ShapeError, Sheet, Solid, SolidNode, TriangleMesh};
use octray_math::{Aabb, DVec3};
use thiserror::Error;

use crate::{
    Background, Camera, Encoding, Light, LightKind, Material, Object, ObjectId, Shape, View,
};

/// A complete scene. Made by [`SceneBuilder::build`], valid for good.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shared with the scenes that this one was copied from.
    objects: Arc<Vec<Object>>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    camera: Option<Camera>,
    background: Background,
    settings: Settings,
}

/// What a scene says about how it wants to be rendered; every one can be overridden.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The direction that is up, unit length: for default cameras and lights.
    pub up: DVec3,
    /// Multiplies every [`crate::Finish::ambient`].
    pub ambient_light: DVec3,
    /// A branch of the ray tree ends after this many generations; primary rays are generation 1.
    pub max_generations: u32,
    /// A branch ends when its weight in the pixel falls below this share; 0 never does.
    pub contribution_threshold: f64,
    /// What the scene's colours mean.
    pub encoding: Encoding,
    /// How the picture is developed.
    pub view: View,
    /// Picture size in pixels (width, height), where the scene names one.
    pub size: Option<(u32, u32)>,
    /// Unit of length, for reports: `mm`, `m`, or empty.
    pub units: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            up: DVec3::Z,
            ambient_light: DVec3::ONE,
            max_generations: 10,
            contribution_threshold: 1.0 / 512.0,
            encoding: Encoding::default(),
            view: View::default(),
            size: None,
            units: String::new(),
        }
    }
}

/// Why a scene is not valid.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// A material id that no material has.
    #[error("object `{object}` uses material {material}, but there are only {count}")]
    UnknownMaterial {
        /// Name of the object.
        object: String,
        /// The id used.
        material: u32,
        /// How many materials there are.
        count: usize,
    },
    /// A number is NaN, infinite or out of its range.
    #[error("{owner}: {what} must be {requirement}, not {value}")]
    BadNumber {
        /// Whose it is: `material \`steel\``, `light 2`, `camera`, ...
        owner: String,
        /// Which number.
        what: &'static str,
        /// What it must be: `finite`, `positive`, ...
        requirement: &'static str,
        /// What it is.
        value: f64,
    },
    /// A camera's axes do not span space.
    #[error("the camera's forward, right and up vectors lie in one plane")]
    FlatCamera,
    /// An object's solid is too large to be worked on.
    #[error("object `{object}`: {error}")]
    BadSolid {
        /// Name of the object.
        object: String,
        /// What is wrong.
        error: ShapeError,
    },
    /// More objects than ids.
    #[error("the scene has {0} objects; at most 2^30 are supported")]
    TooManyObjects(usize),
}

impl Scene {
    /// All objects; an [`ObjectId`] is an index.
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// All materials; a [`MaterialId`] is an index.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The material of this id.
    ///
    /// # Panics
    /// If the id is not of this scene.
    #[must_use]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }

    /// All lights.
    #[must_use]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The camera, if the scene has one.
    #[must_use]
    pub const fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// What rays see that meet nothing.
    #[must_use]
    pub const fn background(&self) -> &Background {
        &self.background
    }

    /// Wishes about the rendering.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// A box around all bounded objects.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.objects
            .iter()
            .map(|object| object.shape.bounds())
            .filter(Aabb::is_bounded)
            .fold(Aabb::EMPTY, Aabb::union)
    }

    /// Whether any object is made of instances.
    #[must_use]
    pub fn has_instances(&self) -> bool {
        let is = |object: &Object| matches!(object.shape, Shape::Instances(_));
        self.objects.iter().any(is)
    }

    /// The scene as a builder, to change it.
    #[must_use]
    pub fn into_builder(self) -> SceneBuilder {
        SceneBuilder { scene: self }
    }
}

/// Collects a scene.
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    scene: Scene,
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneBuilder {
    /// An empty scene with the default settings.
    #[must_use]
    pub fn new() -> Self {
        Self {
            scene: Scene {
                objects: Arc::default(),
                materials: Vec::new(),
                lights: Vec::new(),
                camera: None,
                background: Background::default(),
                settings: Settings::default(),
            },
        }
    }

    /// Adds a material; its id is the number of materials before it.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(material);
        id
    }

    /// Adds an object; its id is the number of objects before it.
    pub fn add_object(&mut self, object: Object) -> ObjectId {
        let id = ObjectId(self.scene.objects.len() as u32);
        Arc::make_mut(&mut self.scene.objects).push(object);
        id
    }

    /// Adds a light.
    pub fn add_light(&mut self, light: Light) {
        self.scene.lights.push(light);
    }

    /// Sets the camera.
    pub fn set_camera(&mut self, camera: Camera) {
        self.scene.camera = Some(camera);
    }

    /// Sets what rays see that meet nothing.
    pub fn set_background(&mut self, background: Background) {
        self.scene.background = background;
    }

    /// The settings, to change them.
    pub const fn settings_mut(&mut self) -> &mut Settings {
        &mut self.scene.settings
    }

    /// The scene as it is: for parts that have been checked.
    pub(crate) fn into_scene(self) -> Scene {
        self.scene
    }

    /// What has been collected so far, not validated: for importers that fill in defaults.
    #[must_use]
    pub const fn so_far(&self) -> &Scene {
        &self.scene
    }

    /// The scene, if everything in it is valid.
    ///
    /// # Errors
    /// Everything that is wrong, in the order objects, materials, lights, camera.
    pub fn build(self) -> Result<Scene, Vec<SceneError>> {
        let mut errors = Vec::new();
        let scene = &self.scene;
        if scene.objects.len() > 1 << 30 {
            errors.push(SceneError::TooManyObjects(scene.objects.len()));
        }
        for object in scene.objects() {
            // The other checks walk the tree.
            if let Err(error) = check_size(&object.shape) {
                let object = object.name.to_string();
                errors.push(SceneError::BadSolid { object, error });
            } else {
                check_materials(object, scene.materials.len(), &mut errors);
            }
        }
        for material in &scene.materials {
            check_material(material, &mut errors);
        }
        for (index, light) in scene.lights.iter().enumerate() {
            check_light(index, light, &mut errors);
        }
        if let Some(camera) = &scene.camera {
            check_camera(camera, &mut errors);
        }
        if let Background::Sky { layers, .. } = &scene.background {
            let owner = "background".to_owned();
            let mut numbers = Numbers {
                owner,
                errors: &mut errors,
            };
            layers.iter().for_each(|l| check_pigment(l, &mut numbers));
        }
        if errors.is_empty() {
            Ok(self.scene)
        } else {
            Err(errors)
        }
    }
}

fn check_size(shape: &Shape) -> Result<(), ShapeError> {
    match shape {
        Shape::Solid(solid) => solid.check_size(),
        Shape::Sheet(Sheet::Shell { solid, clip }) => {
            solid.check_size()?;
            clip.check_size()
        }
        // The parts of a prototype have been checked.
        Shape::Sheet(Sheet::Mesh { .. }) | Shape::Instances(_) => Ok(()),
    }
}

fn check_materials(object: &Object, count: usize, errors: &mut Vec<SceneError>) {
    let mut check = |id: MaterialId| {
        if id.0 as usize >= count {
            errors.push(SceneError::UnknownMaterial {
                object: object.name.to_string(),
                material: id.0,
                count,
            });
        }
    };
    check(object.material);
    match &object.shape {
        Shape::Instances(instances) => {
            let parts = instances.prototype().parts().objects();
            parts
                .iter()
                .for_each(|p| face_materials(&p.shape, &mut check));
        }
        shape => face_materials(shape, &mut check),
    }
}

fn face_materials(shape: &Shape, check: &mut impl FnMut(MaterialId)) {
    match shape {
        Shape::Sheet(Sheet::Mesh { mesh, .. }) => mesh_materials(mesh, check),
        Shape::Sheet(Sheet::Shell { solid, .. }) | Shape::Solid(solid) => {
            solid_materials(solid, check);
        }
        // Prototypes hold none.
        Shape::Instances(_) => {}
    }
}

fn mesh_materials(mesh: &TriangleMesh, check: &mut impl FnMut(MaterialId)) {
    // The highest id is out of range if any is.
    if let Some(&id) = mesh.materials().unwrap_or_default().iter().max() {
        check(id);
    }
}

fn solid_materials(solid: &Solid, check: &mut impl FnMut(MaterialId)) {
    let mut stack = vec![solid];
    while let Some(solid) = stack.pop() {
        match solid.node() {
            SolidNode::Primitive(Primitive::Mesh(mesh)) => mesh_materials(mesh, check),
            SolidNode::Empty | SolidNode::Primitive(_) => {}
            SolidNode::Transformed { child, .. } | SolidNode::Complement(child) => {
                stack.push(child);
            }
            SolidNode::WithMaterial { child, material } => {
                check(*material);
                stack.push(child);
            }
            SolidNode::Union(all) | SolidNode::Intersection(all) | SolidNode::Difference(all) => {
                stack.extend(all);
            }
        }
    }
}

/// Reports every number of one owner that breaks its rule.
struct Numbers<'a> {
    owner: String,
    errors: &'a mut Vec<SceneError>,
}

impl Numbers<'_> {
    fn require(&mut self, what: &'static str, value: f64, requirement: &'static str, ok: bool) {
        if !(ok && value.is_finite()) {
            let owner = self.owner.clone();
            self.errors.push(SceneError::BadNumber {
                owner,
                what,
                requirement,
                value,
            });
        }
    }

    fn finite(&mut self, what: &'static str, values: &[f64]) {
        for &value in values {
            self.require(what, value, "finite", true);
        }
    }

    fn positive(&mut self, what: &'static str, value: f64) {
        self.require(what, value, "finite and positive", value > 0.0);
    }
}

fn check_material(material: &Material, errors: &mut Vec<SceneError>) {
    let owner = format!("material `{}`", material.name);
    let mut numbers = Numbers { owner, errors };
    let f = &material.finish;
    numbers.finite("ambient", &f.ambient.to_array());
    numbers.finite("emission", &f.emission.to_array());
    numbers.finite("diffuse", &[f.diffuse]);
    numbers.finite("brilliance", &[f.brilliance]);
    numbers.finite(
        "highlight",
        &[f.phong, f.phong_size, f.specular, f.metallic],
    );
    numbers.positive("roughness", f.roughness);
    numbers.finite("reflection", &f.reflection.min.to_array());
    numbers.finite("reflection", &f.reflection.max.to_array());
    numbers.finite(
        "reflection falloff",
        &[f.reflection.falloff, f.reflection.metallic],
    );
    numbers.positive("index of refraction", material.interior.ior);
    numbers.finite("absorption", &material.interior.absorption.to_array());
    if let Some(fade) = &material.interior.fade {
        numbers.positive("fade distance", fade.half_distance);
        numbers.positive("fade power", fade.power);
        numbers.finite("fade colour", &fade.color.to_array());
    }
    check_pigment(&material.pigment, &mut numbers);
}

fn check_pigment(pigment: &crate::Pigment, numbers: &mut Numbers<'_>) {
    use crate::{Pattern, Pigment};
    let mut color = |c: &crate::Color| {
        numbers.finite("colour", &[c.rgb.x, c.rgb.y, c.rgb.z, c.filter, c.transmit]);
    };
    match pigment {
        Pigment::Uniform(c) => color(c),
        Pigment::Pattern {
            pattern,
            pattern_from_world,
        } => {
            let frame = if pattern_from_world.is_finite() {
                0.0
            } else {
                f64::NAN
            };
            match pattern {
                Pattern::Gradient { map, .. } => map.iter().for_each(|stop| color(&stop.color)),
                Pattern::Checker(pair) => pair.iter().for_each(|p| check_pigment(p, numbers)),
            }
            numbers.finite("pattern transform", &[frame]);
        }
    }
}

fn check_light(index: usize, light: &Light, errors: &mut Vec<SceneError>) {
    let owner = format!("light {index}");
    let mut numbers = Numbers { owner, errors };
    numbers.finite("colour", &light.color.to_array());
    match light.kind {
        LightKind::Point { position } => numbers.finite("position", &position.to_array()),
        LightKind::Directional { direction } => numbers.positive("direction", direction.length()),
        LightKind::Spot {
            position,
            direction,
            inner,
            outer,
            tightness,
        } => {
            numbers.finite("position", &position.to_array());
            numbers.positive("direction", direction.length());
            numbers.finite("angle", &[inner, outer]);
            numbers.finite("tightness", &[tightness]);
        }
    }
    if let crate::Falloff::Fade { distance, power } = light.falloff {
        numbers.positive("fade distance", distance);
        numbers.finite("fade power", &[power]);
    }
}

fn check_camera(camera: &Camera, errors: &mut Vec<SceneError>) {
    let owner = "camera".to_owned();
    let mut numbers = Numbers { owner, errors };
    numbers.finite("eye", &camera.eye.to_array());
    for (what, v) in [
        ("forward", camera.forward),
        ("right", camera.right),
        ("up", camera.up),
    ] {
        numbers.positive(what, v.length());
    }
    let [f, r, u] = [camera.forward, camera.right, camera.up].map(DVec3::normalize_or_zero);
    if f.cross(r).dot(u).abs() < 1e-9 {
        errors.push(SceneError::FlatCamera);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_of_meshes_are_checked_wherever_the_mesh_is() {
        use std::sync::Arc;

        use octray_geometry::MeshRule;
        use octray_math::DAffine3;

        use crate::{Instances, Prototype};

        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = TriangleMesh::new(positions, triangles).expect("valid");
        let mesh = mesh.with_materials([0, 0, 9, 0].map(MaterialId).to_vec());
        let mesh = Arc::new(mesh.expect("one each"));
        let solid = Solid::mesh(Arc::clone(&mesh), MeshRule::Strict).expect("closed");
        let cut = Solid::difference([Solid::sphere(1.0).expect("valid"), solid.clone()]);
        let sheet = Shape::Sheet(Sheet::mesh(mesh));
        let prototype = Prototype::new([Shape::Solid(cut.clone())]).expect("bounded");
        let copies = Instances::new(Arc::new(prototype), [DAffine3::IDENTITY]);
        let copies = Shape::Instances(copies.expect("invertible"));
        for shape in [Shape::Solid(solid), Shape::Solid(cut), sheet, copies] {
            let mut builder = SceneBuilder::new();
            let material = builder.add_material(Material::default());
            builder.add_object(Object::new("mesh", shape, material));
            let errors = builder.build().expect_err("a material that is not there");
            let unknown =
                |e: &SceneError| matches!(e, SceneError::UnknownMaterial { material: 9, .. });
            assert!(errors.iter().all(unknown) && !errors.is_empty());
        }
    }

    #[test]
    fn everything_wrong_is_reported_at_once() {
        let mut builder = SceneBuilder::new();
        builder.add_object(Object::solid("ghost", Solid::empty(), MaterialId(7)));
        builder.add_light(Light::point(DVec3::NAN, DVec3::ONE));
        builder.set_camera(Camera {
            projection: crate::Projection::Perspective,
            eye: DVec3::ZERO,
            forward: DVec3::X,
            right: DVec3::X,
            up: DVec3::Z,
            fit_aspect: true,
        });
        let errors = builder.build().expect_err("three mistakes");
        assert!(
            errors
                .iter()
                .any(|e| matches!(e, SceneError::UnknownMaterial { material: 7, .. }))
        );
        assert!(errors.iter().any(|e| matches!(
            e,
            SceneError::BadNumber {
                what: "position",
                ..
            }
        )));
        assert!(errors.contains(&SceneError::FlatCamera));
    }
}
