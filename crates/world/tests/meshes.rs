//! Meshes as sheets and as operands, against brute force and the analytic truth.

#[expect(dead_code, reason = "this test makes its own solids")]
mod random;

use std::sync::Arc;

use octray_geometry::{MeshRule, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3, Ray};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{Counters, Hit, Method, RayQuery, World, WorldConfig};
use proptest::prelude::*;
use random::point;

/// The surface of a cube of edge 2 about the origin, each face divided `n` by `n`.
fn cube(n: u32) -> Arc<TriangleMesh> {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for (x, y, z) in [
        (DVec3::X, DVec3::Y, DVec3::Z),
        (DVec3::Y, DVec3::Z, DVec3::X),
        (DVec3::Z, DVec3::X, DVec3::Y),
    ] {
        for side in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for j in 0..=n {
                for i in 0..=n {
                    let at = |k: u32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
                    positions.push(x * at(i) + y * at(j) + z * side);
                }
            }
            for j in 0..n {
                for i in 0..n {
                    let a = first + j * (n + 1) + i;
                    let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
                    let pair = if side > 0.0 {
                        [[a, b, d], [a, d, c]]
                    } else {
                        [[a, d, b], [a, c, d]]
                    };
                    triangles.extend(pair);
                }
            }
        }
    }
    Arc::new(TriangleMesh::new(positions, triangles).expect("valid"))
}

fn scene(objects: Vec<(Option<Solid>, Option<Sheet>)>) -> Arc<Scene> {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for (solid, sheet) in objects {
        if let Some(solid) = solid {
            builder.add_object(Object::solid("solid", solid, material));
        }
        if let Some(sheet) = sheet {
            builder.add_object(Object::sheet("sheet", sheet, material));
        }
    }
    Arc::new(builder.build().expect("valid"))
}

fn world(scene: &Arc<Scene>, method: Method) -> World {
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    World::prepare(Arc::clone(scene), &config).expect("valid")
}

fn crossings(world: &World, ray: Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    world.crossings(
        &RayQuery::new(ray),
        true,
        &mut hits,
        &mut Counters::default(),
    );
    hits
}

fn frame() -> impl Strategy<Value = DAffine3> {
    (point(3.0), point(1.0), point(1.0), any::<bool>()).prop_map(|(turn, scale, shift, mirror)| {
        let side = if mirror { -1.0 } else { 1.0 };
        DAffine3::from_translation(shift)
            * DAffine3::from_rotation_x(turn.x)
            * DAffine3::from_rotation_z(turn.z)
            * DAffine3::from_scale((scale.abs() + 0.4) * DVec3::new(side, 1.0, 1.0))
    })
}

#[test]
fn a_ray_that_leaves_a_doubled_mesh_does_not_meet_its_twin() {
    let mesh = || {
        Sheet::mesh(cube(3))
            .transform(DAffine3::from_rotation_x(0.7))
            .expect("invertible")
    };
    let scene = scene(vec![(None, Some(mesh())), (None, Some(mesh()))]);
    let world = world(&scene, Method::Auto);
    let mut hits = Vec::new();
    for i in 0..5000 {
        let at = f64::from(i) * 2e-4 - 0.5;
        let query = RayQuery::new(Ray::new(
            DVec3::new(4.0, at, 0.3 * at),
            DVec3::new(-1.0, 0.1, 0.1 * at),
        ));
        world.closest(&[query], &mut hits, &mut Counters::default());
        let surface = world.interact(&query, &hits[0]);
        assert!(surface.entering);
        let away = RayQuery {
            ray: Ray::new(
                surface.position,
                surface.normal * 0.3 + DVec3::new(0.0, 1.0, 3.0 * at),
            ),
            departure: hits[0].departure(true),
            ..query
        };
        world.closest(&[away], &mut hits, &mut Counters::default());
        assert!(hits[0].is_miss(), "{at}: t = {}", hits[0].t);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn sheets_and_mesh_solids_agree_with_brute_force_to_the_bit(
        a in frame(), b in frame(), c in frame(),
        rays in proptest::collection::vec((point(4.0), point(1.0)), 60),
    ) {
        let mesh = cube(3);
        let mesh_solid = Solid::mesh(Arc::clone(&mesh), MeshRule::Strict).expect("sound");
        let cut = Solid::difference([
            mesh_solid.transform(a).expect("invertible"),
            Solid::sphere(1.0).expect("valid").transform(b).expect("invertible"),
            mesh_solid.transform(c).expect("invertible"),
        ]);
        let sheet = |m| Sheet::mesh(Arc::clone(&mesh)).transform(m).expect("invertible");
        let scene = scene(vec![(Some(cut), Some(sheet(b))), (None, Some(sheet(c)))]);
        let (tree, brute) = (world(&scene, Method::Auto), world(&scene, Method::Brute));
        let queries: Vec<RayQuery> =
            rays.iter().map(|(o, d)| RayQuery::new(Ray::new(*o, *d))).collect();
        let answers = |world: &World| {
            let (mut hits, mut blocked) = (Vec::new(), Vec::new());
            world.closest(&queries, &mut hits, &mut Counters::default());
            world.occluded(&queries, &mut blocked, &mut Counters::default());
            (hits, blocked)
        };
        let (fast, slow) = (answers(&tree), answers(&brute));
        prop_assert_eq!(&fast, &slow);
        for (query, hit) in queries.iter().zip(&fast.0) {
            prop_assert_eq!(crossings(&tree, query.ray), crossings(&brute, query.ray));
            if !hit.is_miss() {
                prop_assert_eq!(tree.interact(query, hit), brute.interact(query, hit));
            }
        }
    }

    #[test]
    fn a_mesh_cube_is_the_cube(
        m in frame(), rays in proptest::collection::vec((point(4.0), point(1.0)), 60),
    ) {
        let cuboid = Solid::cuboid(-DVec3::ONE, DVec3::ONE).expect("valid");
        let exact = scene(vec![(Some(cuboid.transform(m).expect("invertible")), None)]);
        let mesh = Solid::mesh(cube(2), MeshRule::Strict).expect("sound").transform(m).expect("invertible");
        let meshed = scene(vec![(Some(mesh), None)]);
        let (exact, meshed) = (world(&exact, Method::Auto), world(&meshed, Method::Auto));
        for (o, d) in rays {
            let ray = Ray::new(o, d);
            let (a, b) = (crossings(&exact, ray), crossings(&meshed, ray));
            // A line that grazes an edge within rounding may be seen by one and not the other.
            if a.len() == b.len() {
                for (a, b) in a.iter().zip(&b) {
                    prop_assert!((a.t - b.t).abs() * d.length() < 1e-9);
                    prop_assert_eq!(a.entering, b.entering);
                    let query = RayQuery::new(ray);
                    let (na, nb) = (exact.interact(&query, a).normal, meshed.interact(&query, b).normal);
                    prop_assert!(na.distance(nb) < 1e-9, "{} {}", na, nb);
                }
            } else {
                let chord: f64 = a.chunks(2).chain(b.chunks(2)).map(|p| p[1].t - p[0].t).sum();
                prop_assert!(chord * d.length() < 1e-9);
            }
        }
    }
}
