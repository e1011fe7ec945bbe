//! Scenes with copies, and the same scenes written out.

use std::sync::Arc;

use octray_geometry::{MaterialId, MeshRule, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3, Ray, transform};
use octray_scene::{
    Color, Instances, Material, Object, Pigment, Prototype, Scene, SceneBuilder, Shape,
};
use octray_world::{Method, World, WorldConfig};

/// Numbers that look random, in -1..1.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = octray_math::hash_u64(self.0.wrapping_add(1));
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.next() * 0.5 + 0.5) * count as f64) as usize % count
    }
}

pub(crate) fn tetrahedron() -> Arc<TriangleMesh> {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 1.5 - 0.4);
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = TriangleMesh::new(positions.to_vec(), triangles).expect("valid");
    let materials = [0, 1, 0, 1].map(MaterialId).to_vec();
    Arc::new(mesh.with_materials(materials).expect("one each"))
}

/// The lower part of a ball's surface.
fn open_ball() -> Sheet {
    let solid = Solid::sphere(1.0).expect("valid");
    let clip = Solid::half_space(DVec3::new(0.1, 0.2, 1.0), 0.3).expect("valid");
    Sheet::Shell { solid, clip }
}

/// Whose size in the scene is that of its box, turned as a box: a single first operand.
pub(crate) fn parts() -> Vec<Shape> {
    let ball = Solid::sphere(1.0).expect("valid");
    let bore = Solid::cylinder(0.4, -2.0, 2.0).expect("valid");
    let cube = Solid::cuboid(DVec3::splat(-0.7), DVec3::splat(0.8)).expect("valid");
    let torus = Solid::torus(0.8, 0.3).expect("valid");
    let mesh = Solid::mesh(tetrahedron(), MeshRule::Strict).expect("closed");
    let bitten = Solid::difference([mesh.clone(), Solid::sphere(0.5).expect("valid")]);
    vec![
        Shape::Solid(Solid::difference([ball, bore])),
        Shape::Solid(cube.with_material(MaterialId(1))),
        Shape::Solid(torus),
        Shape::Solid(mesh),
        Shape::Solid(bitten),
        Shape::Sheet(Sheet::mesh(tetrahedron())),
        Shape::Sheet(open_ball()),
    ]
}

/// Turned, stretched, mirrored and moved, of very different sizes.
pub(crate) fn transform_of(numbers: &mut Numbers) -> DAffine3 {
    let turned = transform::rotation_xyz_degrees(numbers.vector() * 180.0);
    let size = libm::exp2(numbers.next() * 1.5);
    let sign = if numbers.next() < 0.0 { -1.0 } else { 1.0 };
    let stretched = DVec3::new(sign, 1.0 + 0.4 * numbers.next(), 1.0 + 0.4 * numbers.next());
    let lean = DAffine3::from_cols(
        DVec3::X,
        DVec3::new(0.3 * numbers.next(), 1.0, 0.0),
        DVec3::Z,
        DVec3::ZERO,
    );
    DAffine3::from_translation(numbers.vector() * 5.0)
        * turned
        * lean
        * DAffine3::from_scale(stretched * size)
}

/// An object before it is decided how its copies are kept.
pub(crate) struct Kind {
    pub(crate) shape: Shape,
    pub(crate) priority: i32,
    pub(crate) copies: Vec<DAffine3>,
}

pub(crate) struct Recipe {
    pub(crate) transparent: bool,
    /// Without copies, kept as they are.
    pub(crate) plain: Vec<Kind>,
    pub(crate) copied: Vec<Kind>,
}

impl Recipe {
    /// Plain solids and sheets among copies; with `priorities` of explicit ones that differ.
    pub(crate) fn random(seed: u64, transparent: bool, priorities: bool) -> Self {
        let mut numbers = Numbers(seed);
        let parts = parts();
        let mut kind = |copies: usize| Kind {
            shape: parts[numbers.below(parts.len())].clone(),
            priority: if priorities {
                numbers.below(3) as i32 - 1
            } else {
                0
            },
            copies: (0..copies).map(|_| transform_of(&mut numbers)).collect(),
        };
        let mut plain: Vec<Kind> = (0..3).map(|_| kind(1)).collect();
        let copied = vec![kind(12), kind(0), kind(7), kind(20)];
        let floor = Solid::half_space(DVec3::Z, -3.0).expect("valid");
        plain.push(Kind {
            shape: Shape::Solid(floor),
            priority: 0,
            copies: vec![DAffine3::IDENTITY],
        });
        Self {
            transparent,
            plain,
            copied,
        }
    }

    fn builder(&self) -> SceneBuilder {
        let mut builder = SceneBuilder::new();
        for name in ["a", "b"] {
            let mut material = Material {
                name: name.to_owned(),
                ..Material::default()
            };
            if self.transparent && name == "b" {
                material.pigment = Pigment::Uniform(Color {
                    transmit: 0.5,
                    ..Color::default()
                });
                material.interior.ior = 1.5;
            }
            builder.add_material(material);
        }
        for kind in &self.plain {
            for placed in &kind.copies {
                builder.add_object(object(kind, moved(&kind.shape, placed)));
            }
        }
        builder
    }

    /// Copies as copies.
    pub(crate) fn instanced(&self) -> Arc<Scene> {
        let mut builder = self.builder();
        for kind in &self.copied {
            let prototype = Prototype::new([kind.shape.clone()]).expect("bounded");
            let copies = Instances::new(Arc::new(prototype), kind.copies.clone());
            let shape = Shape::Instances(copies.expect("invertible"));
            builder.add_object(object(kind, shape));
        }
        Arc::new(builder.build().expect("valid"))
    }

    /// Every copy an object of its own.
    pub(crate) fn written_out(&self) -> Arc<Scene> {
        let mut builder = self.builder();
        for kind in &self.copied {
            for placed in &kind.copies {
                builder.add_object(object(kind, moved(&kind.shape, placed)));
            }
        }
        Arc::new(builder.build().expect("valid"))
    }

    /// For each object of the written-out scene, the object and the copy's number in it (-1: none).
    pub(crate) fn origins(&self) -> Vec<(u32, i64)> {
        let plain = (0..self.plain.len() as u32).map(|object| (object, -1));
        let first = self.plain.len() as u32;
        let copied = self.copied.iter().zip(first..).flat_map(|(kind, object)| {
            (0..kind.copies.len() as i64).map(move |copy| (object, copy))
        });
        plain.chain(copied).collect()
    }
}

fn object(kind: &Kind, shape: Shape) -> Object {
    let empty = Solid::empty();
    Object {
        shape,
        priority: kind.priority,
        ..Object::solid("object", empty, MaterialId(1))
    }
}

pub(crate) fn moved(shape: &Shape, placed: &DAffine3) -> Shape {
    match shape {
        Shape::Solid(solid) => Shape::Solid(solid.transform(*placed).expect("invertible")),
        Shape::Sheet(sheet) => Shape::Sheet(sheet.transform(*placed).expect("invertible")),
        Shape::Instances(_) => panic!("one level"),
    }
}

pub(crate) fn world(scene: &Arc<Scene>, method: Method) -> World {
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    World::prepare(Arc::clone(scene), &config).expect("closed meshes")
}

/// Rays through where the copies are.
pub(crate) fn rays(seed: u64, count: usize) -> Vec<Ray> {
    let mut numbers = Numbers(seed ^ 0x5555);
    let ray = |_| {
        let origin = numbers.vector() * 7.0;
        let target = numbers.vector() * 5.0;
        Ray::new(origin, target - origin)
    };
    (0..count).map(ray).collect()
}

/// How often more cases are wanted than usual.
pub(crate) fn cases(usual: u64) -> u64 {
    let times = std::env::var("OCTRAY_CASES").ok();
    let times: u64 = times.and_then(|text| text.parse().ok()).unwrap_or(1);
    usual * times.max(1)
}
