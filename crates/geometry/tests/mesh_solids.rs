//! Closed meshes as solids: volumes, insides, and crossings that pair up.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use std::f64::consts::TAU;
use std::sync::Arc;

use meshes::{Random, cuboid, moved, nasty_ray, sphere, together, torus, zoo};
use octray_geometry::TriangleMesh;
use octray_geometry::mesh::{FlawKind, MeshCrossing, MeshError, MeshSolid};
use octray_math::{DAffine3, DVec3, Ray};
use octray_tree::{WalkCost, WideTreeConfig};

fn solid(mesh: &TriangleMesh) -> MeshSolid {
    let config = WideTreeConfig::default();
    MeshSolid::new(&Arc::new(mesh.clone()), &DAffine3::IDENTITY, Some(&config)).unwrap()
}

fn crossings(solid: &MeshSolid, ray: &Ray) -> Vec<MeshCrossing> {
    let mut out = Vec::new();
    solid.crossings(ray, &mut out, &mut WalkCost::default());
    out
}

#[test]
fn volumes_are_those_of_the_polyhedra() {
    let near = |volume: f64, wanted: f64| {
        assert!(
            (volume - wanted).abs() <= 1e-13 * wanted.abs(),
            "{volume} {wanted}"
        );
    };
    let brick = cuboid(DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 7.0));
    near(brick.signed_volume(), 8.0);
    near(brick.reversed().signed_volume(), -8.0);
    near(
        moved(&brick, |p| p * DVec3::new(-1.0, 1.0, 1.0)).signed_volume(),
        -8.0,
    );
    near(sphere(0).signed_volume(), 4.0 / 3.0);
    // Pappus for polygons: a regular 8-gon led around a regular 12-gon.
    let area = 8.0 / 2.0 * 0.25 * libm::sin(TAU / 8.0);
    near(
        torus(2.0, 0.5, 12, 8).signed_volume(),
        12.0 * libm::sin(TAU / 12.0) * 2.0 * area,
    );
    let cavity = together(
        &brick,
        &cuboid(DVec3::new(1.2, 2.5, 4.0), DVec3::new(1.7, 3.0, 6.0)).reversed(),
    );
    near(cavity.signed_volume(), 8.0 - 0.5);
    for (name, mesh) in zoo() {
        assert!(!mesh.is_inside_out(), "{name}");
        assert!(mesh.reversed().is_inside_out(), "{name}");
    }
    assert_eq!(
        TriangleMesh::new(Vec::new(), Vec::new())
            .unwrap()
            .signed_volume(),
        0.0
    );
}

#[test]
fn crossings_alternate_whatever_the_ray() {
    let mut crossed = 0;
    for (seed, (name, mesh)) in zoo().into_iter().enumerate() {
        let tree = solid(&mesh);
        let brute = MeshSolid::new(&Arc::new(mesh.clone()), &DAffine3::IDENTITY, None).unwrap();
        let mut random = Random::new(20 + seed as u64);
        for _ in 0..4000 {
            let ray = nasty_ray(&mesh, &mut random);
            let found = crossings(&tree, &ray);
            assert_eq!(found, crossings(&brute, &ray), "{name}: {ray:?}");
            assert_eq!(found.len() % 2, 0);
            assert!(
                found.windows(2).all(|w| w[0].t < w[1].t),
                "{name}: {found:?}"
            );
            let expected = (0..found.len()).map(|i| i % 2 == 0);
            assert!(
                found.iter().map(|c| c.entering).eq(expected),
                "{name}: {found:?}"
            );
            crossed += found.len();
        }
    }
    assert!(crossed > 50_000, "{crossed}");
}

#[test]
fn half_way_between_two_crossings_is_inside_as_they_say() {
    for (name, mesh) in [
        ("torus", torus(2.0, 0.5, 12, 8)),
        ("cube", cuboid(-DVec3::ONE, DVec3::ONE)),
        ("sphere", sphere(2)),
    ] {
        let solid = solid(&mesh);
        let mut random = Random::new(3);
        for _ in 0..3000 {
            let ray = Ray::new(random.point(3.0), random.point(1.0));
            let found = crossings(&solid, &ray);
            for pair in found.windows(2).filter(|w| w[1].t - w[0].t > 1e-9) {
                let middle = ray.at(0.5 * (pair[0].t + pair[1].t));
                assert_eq!(solid.contains(middle), pair[0].entering, "{name} {ray:?}");
            }
        }
    }
}

#[test]
fn the_share_of_points_inside_is_the_volume() {
    let mesh = torus(2.0, 0.5, 12, 8);
    let solid = solid(&mesh);
    let bounds = mesh.bounds();
    let (n, mut inside) = (40_000, 0);
    let mut random = Random::new(1);
    for _ in 0..n {
        let p = bounds.min + bounds.size() * (random.point(0.5) + 0.5);
        inside += u32::from(solid.contains(p));
    }
    let box_volume = bounds.size().element_product();
    let share = mesh.signed_volume() / box_volume;
    let error = (share * (1.0 - share) / f64::from(n)).sqrt();
    assert!((f64::from(inside) / f64::from(n) - share).abs() < 4.0 * error);
}

#[test]
fn shells_unite_and_shells_that_face_inwards_are_cavities() {
    let cube = |half: f64| cuboid(DVec3::splat(-half), DVec3::splat(half));
    let shifted = moved(&cube(1.0), |p| p + DVec3::new(1.0, 0.25, 0.125));
    let ray = Ray::new(DVec3::new(-5.0, 0.375, 0.25), DVec3::X);
    let ends = |mesh: &TriangleMesh| -> Vec<f64> {
        crossings(&solid(mesh), &ray).iter().map(|c| c.t).collect()
    };
    assert_eq!(ends(&together(&cube(1.0), &shifted)), [4.0, 7.0]);
    assert_eq!(
        ends(&together(&cube(1.0), &cube(0.5).reversed())),
        [4.0, 4.5, 5.5, 6.0]
    );
    // Touching in a face: nothing happens there.
    let beside = moved(&cube(1.0), |p| p + DVec3::new(2.0, 0.0, 0.0));
    assert_eq!(ends(&together(&cube(1.0), &beside)), [4.0, 8.0]);
}

#[test]
fn inside_out_meshes_and_mirrored_frames_are_put_right() {
    let mesh = Arc::new(sphere(2).reversed());
    for frame in [
        DAffine3::IDENTITY,
        DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0)),
    ] {
        let solid = MeshSolid::new(&mesh, &frame, None).unwrap();
        let ray = Ray::new(DVec3::new(0.1, 0.2, -4.0), DVec3::Z);
        let found = crossings(&solid, &ray);
        assert_eq!(found.len(), 2);
        let normal = |c: &MeshCrossing| solid.point(&ray, c.triangle, c.entering).unwrap().normal;
        assert!(normal(&found[0]).z < -0.9 && normal(&found[1]).z > 0.9);
    }
    let open = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let error = MeshSolid::new(&Arc::new(open), &DAffine3::IDENTITY, None).unwrap_err();
    let MeshError::NoInside(report) = error else {
        panic!("{error}");
    };
    assert_eq!(report.count(FlawKind::OpenEdge), 3);
}
