//! A scene as plain dictionaries and lists, for listings and JSON.

use std::collections::BTreeMap;

use octray::geometry::{CompositeKind, Primitive, Sheet, Solid, SolidNode};
use octray::math::{Aabb, DVec3};
use octray::scene::{
    Background, Camera, Encoding, Light, LightKind, Material, Object, Pattern, Pigment, Projection,
    Scene, Shape, View,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// What one calls this primitive.
pub(crate) fn primitive_name(primitive: &Primitive) -> &'static str {
    match primitive {
        Primitive::Sphere { .. } => "sphere",
        Primitive::Box { .. } => "box",
        Primitive::Cylinder { .. } => "cylinder",
        Primitive::Cone { .. } => "cone",
        Primitive::Torus { .. } => "torus",
        Primitive::Quadric(_) => "quadric",
        Primitive::Polynomial { .. } => "polynomial",
        Primitive::Superellipsoid { .. } => "superellipsoid",
        Primitive::HalfSpace { .. } => "half_space",
        Primitive::Convex(_) => "polyhedron",
        Primitive::Composite(composite) => match composite.kind() {
            CompositeKind::Prism => "prism",
            CompositeKind::Lathe => "lathe",
            CompositeKind::Polyhedron => "polyhedron",
        },
        Primitive::Mesh(_) => "mesh",
    }
}

/// How many of what a shape is made of; of instances, one copy.
#[derive(Default)]
struct Parts {
    primitives: BTreeMap<&'static str, usize>,
    triangles: usize,
}

impl Parts {
    fn add(&mut self, solid: &Solid) {
        let mut stack = vec![solid];
        while let Some(solid) = stack.pop() {
            match solid.node() {
                SolidNode::Empty => {}
                SolidNode::Primitive(primitive) => {
                    *self
                        .primitives
                        .entry(primitive_name(primitive))
                        .or_default() += 1;
                    if let Primitive::Mesh(mesh) = primitive {
                        self.triangles += mesh.triangles().len();
                    }
                }
                SolidNode::Transformed { child, .. }
                | SolidNode::WithMaterial { child, .. }
                | SolidNode::Complement(child) => stack.push(child),
                SolidNode::Union(all)
                | SolidNode::Intersection(all)
                | SolidNode::Difference(all) => stack.extend(all),
            }
        }
    }

    fn of(shape: &Shape) -> Self {
        let mut parts = Self::default();
        parts.add_shape(shape);
        parts
    }

    fn add_shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Solid(solid) => self.add(solid),
            Shape::Sheet(Sheet::Mesh { mesh, .. }) => {
                *self.primitives.entry("mesh").or_default() += 1;
                self.triangles += mesh.triangles().len();
            }
            Shape::Sheet(Sheet::Shell { solid, clip }) => {
                self.add(solid);
                self.add(clip);
            }
            // Prototypes hold no instances.
            Shape::Instances(instances) => {
                for part in instances.prototype().parts().objects() {
                    self.add_shape(&part.shape);
                }
            }
        }
    }
}

/// `[[x, y, z], [x, y, z]]`, `None` where there is no such box of finite numbers.
fn corners(bounds: Aabb) -> Option<[[f64; 3]; 2]> {
    (bounds.is_bounded() && !bounds.is_empty())
        .then(|| [bounds.min.to_array(), bounds.max.to_array()])
}

fn object<'py>(py: Python<'py>, scene: &Scene, object: &Object) -> PyResult<Bound<'py, PyDict>> {
    let parts = Parts::of(&object.shape);
    let bounds = object.shape.bounds();
    let dict = PyDict::new(py);
    dict.set_item("name", &*object.name)?;
    let kind = match object.shape {
        Shape::Solid(_) => "solid",
        Shape::Sheet(_) => "sheet",
        Shape::Instances(_) => "instances",
    };
    dict.set_item("kind", kind)?;
    let copies = match &object.shape {
        Shape::Instances(instances) => Some(instances.world_from_prototype().len()),
        _ => None,
    };
    dict.set_item("instances", copies)?;
    dict.set_item("material", &scene.material(object.material).name)?;
    dict.set_item("primitives", parts.primitives)?;
    dict.set_item("triangles", parts.triangles)?;
    dict.set_item("bounds", corners(bounds))?;
    dict.set_item("unbounded", !bounds.is_bounded())?;
    dict.set_item("priority", object.priority)?;
    Ok(dict)
}

fn material<'py>(py: Python<'py>, material: &Material) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &material.name)?;
    let pattern = match &material.pigment {
        Pigment::Uniform(color) => {
            dict.set_item("color", color.rgb.to_array())?;
            None
        }
        Pigment::Pattern { pattern, .. } => Some(match pattern {
            Pattern::Checker(_) => "checker",
            Pattern::Gradient { .. } => "gradient",
        }),
    };
    dict.set_item("pattern", pattern)?;
    dict.set_item("transparent", material.pigment.is_transparent())?;
    dict.set_item("reflection", material.finish.reflection.max.to_array())?;
    dict.set_item("ior", material.interior.ior)?;
    Ok(dict)
}

fn light<'py>(py: Python<'py>, light: &Light) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let (kind, position, direction) = match light.kind {
        LightKind::Point { position } => ("point", Some(position), None),
        LightKind::Spot {
            position,
            direction,
            ..
        } => ("spot", Some(position), Some(direction)),
        LightKind::Directional { direction } => ("directional", None, Some(direction)),
    };
    dict.set_item("kind", kind)?;
    dict.set_item("position", position.map(|p| p.to_array()))?;
    dict.set_item("direction", direction.map(|d| d.to_array()))?;
    dict.set_item("color", light.color.to_array())?;
    dict.set_item("shadows", light.casts_shadows)?;
    Ok(dict)
}

fn camera<'py>(py: Python<'py>, camera: &Camera) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let kind = match camera.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    };
    dict.set_item("kind", kind)?;
    dict.set_item("eye", camera.eye.to_array())?;
    dict.set_item("forward", camera.forward.to_array())?;
    dict.set_item("right", camera.right.to_array())?;
    dict.set_item("up", camera.up.to_array())?;
    // Whether `right` is still to be multiplied by the picture's width / height.
    dict.set_item("fit_aspect", camera.fit_aspect)?;
    Ok(dict)
}

/// The colours of a background from below to above.
pub(crate) fn background(background: &Background, up: DVec3) -> Vec<[f64; 3]> {
    match background {
        Background::Uniform(rgb) => vec![rgb.to_array()],
        Background::Gradient { map, .. } => map.iter().map(|s| s.color.rgb.to_array()).collect(),
        // What is seen straight up, level and straight down.
        sky @ Background::Sky { .. } => [up, up.any_orthonormal_vector(), -up]
            .map(|d| sky.at(d).to_array())
            .to_vec(),
    }
}

/// The whole scene.
pub(crate) fn scene<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Bound<'py, PyDict>> {
    let objects = PyList::empty(py);
    let mut triangles = 0;
    for item in scene.objects() {
        triangles += Parts::of(&item.shape).triangles;
        objects.append(object(py, scene, item)?)?;
    }
    let materials = PyList::empty(py);
    for item in scene.materials() {
        materials.append(material(py, item)?)?;
    }
    let lights = PyList::empty(py);
    for item in scene.lights() {
        lights.append(light(py, item)?)?;
    }
    let settings = scene.settings();
    let dict = PyDict::new(py);
    dict.set_item("objects", objects)?;
    dict.set_item("triangles", triangles)?;
    dict.set_item("bounds", corners(scene.bounds()))?;
    dict.set_item("materials", materials)?;
    dict.set_item("lights", lights)?;
    let seen = scene.camera().map(|c| camera(py, c)).transpose()?;
    dict.set_item("camera", seen)?;
    dict.set_item("background", background(scene.background(), settings.up))?;
    dict.set_item("size", settings.size)?;
    dict.set_item("up", settings.up.to_array())?;
    dict.set_item("units", &settings.units)?;
    let view = match settings.view {
        View::Neutral => "neutral",
        View::Standard => "standard",
        View::Raw => "raw",
    };
    dict.set_item("view", view)?;
    let encoding = match settings.encoding {
        Encoding::Linear => "linear".to_owned(),
        Encoding::Gamma(gamma) => format!("gamma {gamma}"),
        Encoding::Srgb => "srgb".to_owned(),
    };
    dict.set_item("encoding", encoding)?;
    dict.set_item("max_depth", settings.max_generations)?;
    dict.set_item("contribution_threshold", settings.contribution_threshold)?;
    Ok(dict)
}
