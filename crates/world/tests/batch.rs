//! Batches of rays against one ray at a time.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use octray_geometry::{FaceId, MeshRule, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3};
use octray_scene::{Material, Object, ObjectId, SceneBuilder, Shape};
use octray_world::{BatchError, Counters, Overlaps, RayRow, Region, World, WorldConfig, row_query};
use rayon::ThreadPoolBuilder;

static GO: AtomicBool = AtomicBool::new(false);

fn tetrahedron() -> Arc<TriangleMesh> {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 2.0);
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    Arc::new(TriangleMesh::new(positions.to_vec(), triangles).expect("valid"))
}

/// A ball with a hole, a mesh as a solid, one with a bite, one as a sheet, and a floor.
fn world() -> World {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    let solid = |solid: Solid| Object::solid("part", solid, material);
    let ball = Solid::sphere(2.0).expect("valid");
    let bore = Solid::cylinder(0.5, -3.0, 3.0).expect("valid");
    let pyramid = Solid::mesh(tetrahedron(), MeshRule::Strict).expect("closed");
    let bitten = Solid::difference(vec![pyramid.clone(), Solid::sphere(1.0).expect("valid")]);
    builder.add_object(solid(Solid::difference(vec![ball, bore])));
    builder.add_object(solid(pyramid.translate(DVec3::X).expect("finite")));
    builder.add_object(Object {
        shape: Shape::Sheet(Sheet::Mesh {
            mesh: tetrahedron(),
            world_from_mesh: Box::new(DAffine3::from_translation(DVec3::splat(-3.0))),
        }),
        ..solid(Solid::half_space(DVec3::Z, 0.0).expect("valid"))
    });
    builder.add_object(solid(bitten.translate(DVec3::Y * 2.0).expect("finite")));
    builder.add_object(solid(Solid::half_space(DVec3::Z, -4.0).expect("valid")));
    let scene = builder.build().expect("valid");
    World::prepare(Arc::new(scene), &WorldConfig::default()).expect("closed meshes")
}

/// Numbers that look random, in -1..1.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// More than a few slices, with some that are no rays.
fn rays() -> Vec<RayRow> {
    let mut number = numbers();
    let mut rays: Vec<RayRow> = (0..5000)
        .map(|_| std::array::from_fn(|i| number() * if i < 3 { 6.0 } else { 1.0 }))
        .collect();
    rays[7] = [0.0; 6];
    rays[1030][4] = f64::NAN;
    rays[4999][0] = f64::INFINITY;
    rays
}

#[test]
fn batches_give_what_single_rays_give_for_any_number_of_threads() {
    let world = world();
    let rays = rays();
    let points: Vec<[f64; 3]> = rays.iter().map(|r| [r[0], r[1], r[2]]).collect();
    let mut counters = Counters::default();
    for threads in [1, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let batch = world.batch(&GO);
            let closest = batch.closest(&rays).expect("not cancelled");
            let met = batch.meets_any(&rays, 3.0).expect("not cancelled");
            let regions = batch.regions(&points).expect("not cancelled");
            let positions = batch.positions(&rays, &closest).expect("not cancelled");
            let normals = batch.normals(&rays, &closest).expect("not cancelled");
            let (mut found_regions, mut found_normals) = (0, 0);
            for whole in [false, true] {
                let counts = batch.count_crossings(&rays, whole).expect("not cancelled");
                let crossings = batch.crossings(&rays, whole).expect("not cancelled");
                assert_eq!(crossings.len(), rays.len());
                for overlaps in [Overlaps::Regions, Overlaps::Priorities, Overlaps::Objects] {
                    let lists = batch.chords(&rays, whole, overlaps).expect("not cancelled");
                    assert_eq!(lists.offsets.len(), rays.len() + 1);
                    assert!(lists.items.len() > 2000);
                    let mut one = Vec::new();
                    for (i, ray) in rays.iter().enumerate() {
                        let query = row_query(ray, f64::INFINITY);
                        world.chords(&query, whole, overlaps, &mut one, &mut counters);
                        assert_eq!(lists.of(i), one);
                    }
                }
                let mut hits = Vec::new();
                for (i, ray) in rays.iter().enumerate() {
                    let query = row_query(ray, f64::INFINITY);
                    world.crossings(&query, whole, &mut hits, &mut counters);
                    assert_eq!(crossings.of(i), hits);
                    let count = world.count_crossings(&query, whole, &mut counters);
                    assert_eq!(counts[i], count);
                }
            }
            let (mut hits, mut of_point) = (Vec::new(), Vec::new());
            for (i, ray) in rays.iter().enumerate() {
                world.closest(&[row_query(ray, f64::INFINITY)], &mut hits, &mut counters);
                assert_eq!(closest[i], hits[0]);
                assert_eq!(met[i], hits[0].t < 3.0);
                if hits[0].is_miss() {
                    assert!(positions[i].is_nan() && normals[i].is_nan());
                } else {
                    let surface = world.interact(&row_query(ray, f64::INFINITY), &hits[0]);
                    assert_eq!(positions[i], surface.position);
                    assert_eq!(normals[i], surface.normal);
                    found_normals += 1;
                }
                let point = DVec3::from_array(points[i]);
                world.regions(&[point], &mut of_point, &mut counters);
                assert_eq!(regions[i], of_point[0]);
                found_regions += usize::from(regions[i] != Region::OUTSIDE);
            }
            assert!(found_regions > 100 && found_normals > 1000);
        });
    }
}

#[test]
fn what_is_no_ray_is_told_apart() {
    let world = world();
    let rays = rays();
    let none: Vec<usize> = (0..rays.len())
        .filter(|&i| !world.is_ray(&row_query(&rays[i], f64::INFINITY)))
        .collect();
    assert_eq!(none, [7, 1030, 4999]);
}

#[test]
fn a_batch_stops_when_it_is_told_to() {
    let world = world();
    let stop = AtomicBool::new(true);
    let batch = world.batch(&stop);
    assert_eq!(batch.closest(&rays()), Err(BatchError::Cancelled));
    let lists = batch.chords(&rays(), true, Overlaps::Regions);
    assert_eq!(lists, Err(BatchError::Cancelled));
}

#[test]
fn no_rays_have_no_answers() {
    let world = world();
    let batch = world.batch(&GO);
    assert_eq!(batch.closest(&[]), Ok(Vec::new()));
    let lists = batch.chords(&[], false, Overlaps::Regions).expect("none");
    assert!(lists.is_empty() && lists.items.is_empty());
    assert_eq!(lists.offsets, [0]);
}

#[test]
fn faces_are_numbered_from_0_in_every_object_and_triangles_keep_their_places() {
    let world = world();
    let counts: Vec<u32> = (0..5).map(|o| world.face_count(ObjectId(o))).collect();
    // Ball and bore with its ends; a mesh; a sheet; a mesh and a ball; a floor.
    assert_eq!(counts, [4, 4, 4, 5, 1]);
    let mut numbers = vec![Vec::new(); 5];
    for face in 0..20 {
        // The second and the fourth object have a face each that stands for a mesh.
        if face == 4 || face == 5 {
            continue;
        }
        let (object, number) = world.face_in_object(FaceId(face)).expect("a face");
        assert_eq!(world.owner(FaceId(face)).map(|o| o.0), Some(object));
        numbers[object.0 as usize].push(number);
    }
    for (own, count) in numbers.iter_mut().zip(counts) {
        own.sort_unstable();
        assert_eq!(*own, (0..count).collect::<Vec<u32>>());
    }
    assert_eq!(world.face_in_object(FaceId(20)), None);
    assert_eq!(world.face_in_object(FaceId::NONE), None);
    // Straight down through the sheet's third triangle: x + y < 2, z = 0 below, the slope above.
    let down = [-2.5, -2.5, 50.0, 0.0, 0.0, -1.0];
    let hits = world.batch(&GO).crossings(&[down], false).expect("one ray");
    let numbers: Vec<_> = hits
        .of(0)
        .iter()
        .map(|h| world.face_in_object(h.face))
        .collect();
    let sheet = Some((ObjectId(2), 3));
    assert_eq!(
        numbers,
        [sheet, Some((ObjectId(2), 0)), Some((ObjectId(4), 0))]
    );
    // And through the mesh that is a solid, beside the ball.
    let down = [2.6, 0.2, 50.0, 0.0, 0.0, -1.0];
    let hits = world.batch(&GO).crossings(&[down], false).expect("one ray");
    let numbers: Vec<_> = hits
        .of(0)
        .iter()
        .map(|h| world.face_in_object(h.face))
        .collect();
    assert_eq!(
        numbers[..2],
        [Some((ObjectId(1), 3)), Some((ObjectId(1), 0))]
    );
}
