//! octray shows, measures and proves exact solids: a ray tracer for constructive solid geometry
//! (CSG) and triangle meshes, on an octree, with the same bits everywhere.
//!
//! This crate is what a Rust program depends on. It adds nothing of its own: each module is one of
//! the project's crates under a short name. The way through them, from a file to a picture:
//!
//! | module       | what happens there                                                          |
//! |--------------|-----------------------------------------------------------------------------|
//! | [`import`]   | bytes of a scene or mesh file become a [`scene::Scene`] and diagnostics     |
//! | [`scene`]    | objects, materials, lights, camera: plain data, valid by construction       |
//! | [`geometry`] | solids (with an inside) and sheets (without), exact, as expressions         |
//! | [`world`]    | the scene made ready for rays: octrees, and what rays may ask               |
//! | [`tree`]     | the octrees themselves, which know no shapes                                |
//! | [`render`]   | slices of rays become light on a film, and the film a PNG or EXR            |
//! | [`math`]     | rays, boxes, transforms, roots                                              |
//!
//! # A tour
//!
//! Build a solid. Every operation returns a new one, and what cannot be is an error:
//!
//! ```
//! use octray::geometry::Solid;
//! use octray::math::DVec3;
//!
//! let block = Solid::cuboid(DVec3::splat(-1.0), DVec3::ONE)?;
//! let ball = Solid::sphere(1.3)?;
//! let part = Solid::difference([block, ball]);
//! assert!(Solid::sphere(-1.0).is_err());
//! # Ok::<(), octray::geometry::ShapeError>(())
//! ```
//!
//! Put it into a scene. [`scene::SceneBuilder::build`] reports everything that is wrong at once:
//!
//! ```
//! # use octray::geometry::Solid;
//! # use octray::math::DVec3;
//! use octray::scene::{Camera, Light, Material, Object, SceneBuilder};
//!
//! # let part = Solid::sphere(1.0)?;
//! let mut builder = SceneBuilder::new();
//! let blue = builder.add_material(Material::matte("blue", DVec3::new(0.1, 0.3, 0.7)));
//! builder.add_object(Object::solid("part", part, blue));
//! builder.add_light(Light::point(DVec3::new(4.0, -6.0, 8.0), DVec3::ONE));
//! let camera = Camera::look_at(DVec3::new(3.0, -5.0, 3.0), DVec3::ZERO, DVec3::Z, 0.7);
//! builder.set_camera(camera.expect("eye and target differ"));
//! let scene = builder.build().expect("all numbers are finite");
//! assert_eq!(&*scene.objects()[0].name, "part");
//! # Ok::<(), octray::geometry::ShapeError>(())
//! ```
//!
//! Ask it where rays go, and render it. Both give the same bits for any number of threads and for
//! any [`world::Method`]:
//!
//! ```
//! # use octray::geometry::Solid;
//! # use octray::scene::{Camera, Light, Material, Object, SceneBuilder};
//! use std::sync::Arc;
//!
//! use octray::math::{DVec3, Ray};
//! use octray::render::{RenderConfig, encode_png, render};
//! use octray::scene::View;
//! use octray::world::{Counters, RayQuery, World, WorldConfig};
//!
//! # let mut builder = SceneBuilder::new();
//! # let blue = builder.add_material(Material::matte("blue", DVec3::new(0.1, 0.3, 0.7)));
//! # builder.add_object(Object::solid("part", Solid::sphere(1.0)?, blue));
//! # builder.add_light(Light::point(DVec3::new(4.0, -6.0, 8.0), DVec3::ONE));
//! # let camera = Camera::look_at(DVec3::new(3.0, -5.0, 3.0), DVec3::ZERO, DVec3::Z, 0.7);
//! # builder.set_camera(camera.expect("eye and target differ"));
//! # let scene = builder.build().expect("all numbers are finite");
//! let world = World::prepare(Arc::new(scene), &WorldConfig::default())?;
//!
//! let down = RayQuery::new(Ray::new(DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z));
//! let mut hits = Vec::new();
//! world.closest(&[down], &mut hits, &mut Counters::default());
//! assert_eq!(hits[0].t, 8.0);
//!
//! let config = RenderConfig { size: Some((32, 24)), ..RenderConfig::default() };
//! let rendering = render(&world, None, &config, &())?;
//! let png = encode_png(&rendering.image(), View::Neutral)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Read a file instead. An importer never panics; it returns what it could read and everything
//! there is to say about the rest, with file, line and column:
//!
//! ```
//! use std::path::Path;
//!
//! use octray::import::{InMemory, Options, load};
//!
//! let mut files = InMemory::default();
//! files.insert("ball.csg", "sphere(r = 2);");
//! let imported = load(Path::new("ball.csg"), &files, &Options::default());
//! let scene = imported.scene.expect("nothing is wrong with it");
//! assert_eq!(scene.bounds().max.z, 2.0);
//! // A file without camera and lights gets some, so that it can be seen at once.
//! assert!(scene.camera().is_some());
//! ```

pub use octray_geometry as geometry;
pub use octray_import as import;
pub use octray_math as math;
pub use octray_render as render;
pub use octray_scene as scene;
pub use octray_tree as tree;
pub use octray_world as world;
