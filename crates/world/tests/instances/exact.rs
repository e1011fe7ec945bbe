//! Transforms that round nothing: the same bits as written out.

use std::sync::Arc;

use octray_geometry::{MaterialId, Solid, TriangleMesh};
use octray_math::{DAffine3, DMat3, DVec3, Ray};
use octray_scene::{Instances, Material, Object, Prototype, SceneBuilder, Shape};
use octray_world::{Counters, Hit, Method, RayQuery, World};

use crate::scenes::{Numbers, moved, world};

/// Axes in another order and direction, times powers of two, and a short move.
fn exact_transform(numbers: &mut Numbers) -> DAffine3 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let first = numbers.below(3);
    let second = (first + 1 + numbers.below(2)) % 3;
    let order = [first, second, 3 - first - second];
    let column = |axis: usize, numbers: &mut Numbers| {
        let sign = if numbers.next() < 0.0 { -1.0 } else { 1.0 };
        axes[axis] * sign * libm::ldexp(1.0, numbers.below(4) as i32 - 2)
    };
    let [x, y, z] = order.map(|axis| column(axis, numbers));
    let short = (numbers.vector() * 32.0).round() * 0.5;
    DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), short)
}

fn short_tetrahedron() -> Arc<TriangleMesh> {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 2.0 - 0.5);
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    Arc::new(TriangleMesh::new(positions.to_vec(), triangles).expect("valid"))
}

fn closest(world: &World, ray: Ray) -> (RayQuery, Hit) {
    let query = RayQuery::new(ray);
    let mut hits = Vec::new();
    world.closest(&[query], &mut hits, &mut Counters::default());
    (query, hits[0])
}

#[test]
fn short_transforms_give_the_bits_of_what_is_written_out() {
    let cube = Solid::cuboid(DVec3::new(-1.0, -0.5, 0.0), DVec3::new(1.0, 1.5, 2.0));
    let slot = Solid::cuboid(DVec3::new(-0.25, -1.0, 0.5), DVec3::new(0.5, 2.0, 1.0));
    let slotted = Solid::difference([cube.expect("valid"), slot.expect("valid")]);
    let shapes = [
        Shape::Solid(slotted),
        Shape::Sheet(octray_geometry::Sheet::mesh(short_tetrahedron())),
    ];
    let mut numbers = Numbers(77);
    let mut found = 0;
    for shape in &shapes {
        let copies: Vec<DAffine3> = (0..40).map(|_| exact_transform(&mut numbers)).collect();
        let mut scenes = [SceneBuilder::new(), SceneBuilder::new()];
        for scene in &mut scenes {
            scene.add_material(Material::default());
            scene.add_material(Material::default());
        }
        let [instanced, written] = &mut scenes;
        for placed in &copies {
            let object = Object::solid("copy", Solid::empty(), MaterialId(0));
            let shape = moved(shape, placed);
            written.add_object(Object { shape, ..object });
        }
        let prototype = Arc::new(Prototype::new([shape.clone()]).expect("bounded"));
        let made = Instances::new(prototype, copies).expect("invertible");
        instanced.add_object(Object::instances("copies", made, MaterialId(0)));
        let [instanced, written] =
            scenes.map(|scene| world(&Arc::new(scene.build().expect("valid")), Method::Auto));
        for i in 0..4000 {
            // Never in a plane or through an edge, whatever the axes' order and scale.
            let aside = DVec3::new(3.0, 5.0, 7.0) / 256.0;
            let origin = (numbers.vector() * 64.0).round() * 0.25 + aside;
            let direction = match i % 3 {
                0 => DVec3::X,
                1 => -DVec3::Y * 4.0,
                _ => DVec3::Z * 0.5,
            };
            let ray = Ray::new(origin, direction);
            let ((query, a), (_, b)) = (closest(&instanced, ray), closest(&written, ray));
            assert_eq!(a.t.to_bits(), b.t.to_bits(), "{a:?} {b:?}");
            if a.is_miss() {
                continue;
            }
            found += 1;
            let (surface, same) = (instanced.interact(&query, &a), written.interact(&query, &b));
            assert_eq!(surface.position, same.position);
            if matches!(shape, Shape::Solid(_)) {
                assert_eq!(surface.normal, same.normal);
            }
            let copy = instanced.instance(a.instance).expect("a copy").1;
            let object = written.owner(b.face).expect("an object").0;
            assert_eq!(copy, object.0);
        }
    }
    assert!(found > 300, "{found}");
}

/// Three balls in a row.
fn row() -> World {
    let ball = Solid::sphere(1.0).expect("valid");
    let prototype = Arc::new(Prototype::new([Shape::Solid(ball)]).expect("bounded"));
    let at = [0.0, 4.0, 8.0].map(|x| DAffine3::from_translation(DVec3::X * x));
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    let copies = Instances::new(prototype, at.to_vec()).expect("invertible");
    builder.add_object(Object::instances("row", copies, material));
    world(&Arc::new(builder.build().expect("valid")), Method::Auto)
}

#[test]
fn a_ray_leaves_one_copy_and_meets_the_same_face_of_the_next() {
    let world = row();
    let mut query = RayQuery::new(Ray::new(DVec3::new(-3.0, 0.0, 0.0), DVec3::X));
    let mut met = Vec::new();
    loop {
        let mut hits = Vec::new();
        world.closest(&[query], &mut hits, &mut Counters::default());
        let hit = hits[0];
        if hit.is_miss() {
            break;
        }
        let position = query.ray.at(hit.t);
        met.push((position.x, hit.instance, hit.entering));
        query.ray.origin = position;
        query.departure = hit.departure(!hit.entering);
    }
    let expected = [
        (-1.0, 1, true),
        (1.0, 1, false),
        (3.0, 2, true),
        (5.0, 2, false),
        (7.0, 3, true),
        (9.0, 3, false),
    ];
    assert_eq!(met, expected);
}

#[test]
fn a_reflected_ray_does_not_meet_the_copy_that_it_leaves() {
    let world = row();
    let mut numbers = Numbers(9);
    for _ in 0..2000 {
        let target = DVec3::X * 4.0 + numbers.vector() * 0.99;
        let origin = numbers.vector() * 3.0 + DVec3::new(4.0, 0.0, 9.0);
        let (query, hit) = closest(&world, Ray::new(origin, target - origin));
        if hit.is_miss() || hit.instance != 2 {
            continue;
        }
        let surface = world.interact(&query, &hit);
        assert_eq!(surface.object.0, 0);
        let along = query.ray.direction;
        let reflected = along - surface.normal * (2.0 * along.dot(surface.normal));
        let mut next = Vec::new();
        let query = RayQuery {
            ray: Ray::new(surface.position, reflected),
            departure: hit.departure(true),
            ..query
        };
        world.closest(&[query], &mut next, &mut Counters::default());
        assert_ne!(next[0].instance, 2, "a ball has no second face ahead");
    }
}
