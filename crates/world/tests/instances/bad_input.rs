//! Copies at the end of what is reasonable: a message, or the answers of brute force.

use std::sync::Arc;

use octray_geometry::{MeshRule, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3, Ray};
use octray_scene::{Instances, Material, Object, Prototype, SceneBuilder, Shape};
use octray_world::{
    Counters, Hit, Method, RayQuery, WideTreeConfig, WideTreeError, World, WorldConfig, WorldError,
};

use crate::answers::{answers, rays_about};
use crate::scenes::{tetrahedron, world};

fn scene_of(shapes: Vec<Shape>, copies: Vec<DAffine3>) -> Arc<octray_scene::Scene> {
    let prototype = Arc::new(Prototype::new(shapes).expect("bounded"));
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    let second = builder.add_material(Material::default());
    assert_ne!(material, second);
    let copies = Instances::new(prototype, copies).expect("invertible");
    builder.add_object(Object::instances("copies", copies, material));
    Arc::new(builder.build().expect("valid"))
}

fn ball() -> Shape {
    Shape::Solid(Solid::sphere(1.0).expect("valid"))
}

fn conform(shapes: Vec<Shape>, copies: Vec<DAffine3>, center: DVec3, size: f64) -> Vec<Hit> {
    let scene = scene_of(shapes, copies);
    let rays = rays_about(center, size);
    let expected = answers(&world(&scene, Method::Brute), &rays);
    assert_eq!(answers(&world(&scene, Method::Auto), &rays), expected);
    expected.closest
}

#[test]
fn copies_of_nothing_and_no_copies_are_empty() {
    let misses = |hits: Vec<Hit>| assert!(hits.iter().all(Hit::is_miss));
    let some = vec![DAffine3::IDENTITY; 3];
    misses(conform(vec![ball()], Vec::new(), DVec3::ZERO, 1.0));
    misses(conform(Vec::new(), some.clone(), DVec3::ZERO, 1.0));
    let empty = vec![Shape::Solid(Solid::empty())];
    misses(conform(empty, some, DVec3::ZERO, 1.0));
}

#[test]
fn copies_at_one_place_are_one_behind_the_other_by_number() {
    let copies = vec![DAffine3::from_translation(DVec3::X); 300];
    let hits = conform(vec![ball()], copies, DVec3::X, 1.0);
    assert!(hits.iter().any(|hit| hit.instance == 1));
    assert!(hits.iter().take(100).all(|hit| hit.instance <= 1));
}

#[test]
fn huge_tiny_and_flat_copies_are_met() {
    let sizes = [1e-30, 1e-9, 1.0, 1e9, 1e30];
    for size in sizes {
        let scale = DAffine3::from_scale(DVec3::splat(size));
        let hits = conform(vec![ball()], vec![scale], DVec3::ZERO, size);
        assert!(
            hits.iter().filter(|hit| !hit.is_miss()).count() > 20,
            "{size}"
        );
        let far = DVec3::new(1e30, -1e30, 0.0);
        let far = DAffine3::from_translation(far) * DAffine3::from_scale(DVec3::splat(1e29));
        conform(vec![ball()], vec![scale, far], DVec3::ZERO, size);
    }
    let flat = DAffine3::from_rotation_x(0.4) * DAffine3::from_scale(DVec3::new(1.0, 1e-9, 1.0));
    let leaning = DAffine3::from_cols(
        DVec3::X,
        DVec3::X + DVec3::Y * 1e-9,
        DVec3::Z,
        DVec3::new(0.1, 0.2, 0.3),
    );
    let hits = conform(vec![ball()], vec![flat, leaning], DVec3::ZERO, 0.5);
    assert!(hits.iter().any(|hit| hit.instance == 1));
    assert!(hits.iter().any(|hit| hit.instance == 2));
}

#[test]
fn a_prototype_far_from_its_own_origin_is_copied_as_well() {
    let far = DVec3::new(1e6, 2e6, -3e6);
    let ball = Solid::sphere(1.0).expect("valid").translate(far);
    let shape = Shape::Solid(ball.expect("finite"));
    let back = |x: f64| DAffine3::from_translation(DVec3::X * x - far);
    let hits = conform(vec![shape], vec![back(0.0), back(1.5)], DVec3::ZERO, 1.0);
    let ahead = hits.iter().filter(|hit| !hit.is_miss()).count();
    assert!(ahead > 30, "{ahead}");
}

#[test]
fn an_octree_that_does_not_fit_is_refused_with_the_numbers() {
    let scene = scene_of(vec![ball()], vec![DAffine3::IDENTITY; 5000]);
    for limit in [1000, 300_000] {
        let config = WorldConfig {
            triangles: WideTreeConfig {
                memory_limit: limit,
                ..WideTreeConfig::default()
            },
            ..WorldConfig::default()
        };
        let error = World::prepare(Arc::clone(&scene), &config).expect_err("too small");
        let WorldError::Instances(WideTreeError::Memory {
            items,
            needed,
            limit: said,
        }) = error
        else {
            panic!("{error}");
        };
        assert_eq!((items, said), (5000, limit));
        assert!(needed > limit);
    }
}

#[test]
fn a_prototype_that_is_no_solid_is_refused_by_the_name_of_the_copies() {
    let open = tetrahedron().triangles()[1..].to_vec();
    let open = TriangleMesh::new(tetrahedron().positions().to_vec(), open).expect("valid");
    if let Ok(solid) = Solid::mesh(Arc::new(open), MeshRule::Winding) {
        let scene = scene_of(vec![Shape::Solid(solid)], vec![DAffine3::IDENTITY]);
        let error = World::prepare(scene, &WorldConfig::default()).expect_err("open");
        assert!(error.to_string().contains("copies"), "{error}");
    }
}

#[test]
fn strange_rays_meet_no_copies() {
    let world = world(
        &scene_of(vec![ball()], vec![DAffine3::IDENTITY; 4]),
        Method::Auto,
    );
    let strange = [
        Ray::new(DVec3::NAN, DVec3::X),
        Ray::new(DVec3::ZERO, DVec3::ZERO),
        Ray::new(DVec3::ZERO, DVec3::new(f64::INFINITY, 0.0, 0.0)),
        Ray::new(DVec3::splat(1e308), DVec3::splat(1e308)),
    ];
    let queries = strange.map(RayQuery::new);
    let mut hits = Vec::new();
    world.closest(&queries, &mut hits, &mut Counters::default());
    assert!(hits.iter().all(Hit::is_miss));
}
