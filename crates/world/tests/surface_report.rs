//! What the surface report says of scenes whose gaps are known.

use std::sync::Arc;

use octray_geometry::Solid;
use octray_math::{DAffine3, DVec3};
use octray_scene::{Material, Object, ObjectId, Scene, SceneBuilder};
use octray_world::{SurfaceReport, World, WorldConfig};

fn scene(solids: &[Solid]) -> Scene {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for solid in solids {
        builder.add_object(Object::solid("part", solid.clone(), material));
    }
    builder.build().expect("valid")
}

fn block(min: DVec3, max: DVec3) -> Solid {
    Solid::cuboid(min, max).expect("valid")
}

/// Two blocks stacked along z with this gap between them, at this place.
fn stack(gap: f64, place: DVec3) -> Scene {
    let lower = block(DVec3::new(-5.0, -5.0, 0.0), DVec3::new(5.0, 5.0, 4.0));
    let upper = block(
        DVec3::new(-3.0, -3.0, 4.0 + gap),
        DVec3::new(3.0, 3.0, 10.0),
    );
    let moved = DAffine3::from_translation(place);
    scene(&[lower, upper].map(|s| s.transform(moved).expect("valid")))
}

#[test]
fn a_gap_is_reported_between_the_tolerance_and_2_to_the_minus_20() {
    let report = SurfaceReport::new(&stack(0.0, DVec3::ZERO)).expect("few faces");
    assert_eq!((report.surfaces, report.merged), (11, 1));
    assert!(report.pairs.is_empty());
    assert!(report.tolerance > 9e-12 && report.tolerance < 1e-11);

    let merged = SurfaceReport::new(&stack(0.9 * report.tolerance, DVec3::ZERO));
    assert_eq!(merged.expect("few faces").merged, 1);

    for gap in [2.0 * report.tolerance, 1e-9, 1e-7, 0.99 * report.near] {
        let report = SurfaceReport::new(&stack(gap, DVec3::ZERO)).expect("few faces");
        assert_eq!(report.merged, 0);
        let [pair] = &report.pairs[..] else {
            panic!("one pair at {gap}, not {:?}", report.pairs);
        };
        assert_eq!(pair.objects, [ObjectId(0), ObjectId(1)]);
        assert!(pair.planes);
        assert!((pair.gap - gap).abs() < 1e-14);
        assert!(pair.position.distance(DVec3::new(0.0, 0.0, 4.0)) < 1e-14);
    }
    let apart = SurfaceReport::new(&stack(1.01 * report.near, DVec3::ZERO));
    assert!(apart.expect("few faces").pairs.is_empty());
}

#[test]
fn places_are_in_the_users_coordinates() {
    let place = DVec3::new(1e4, -2e4, 3e4);
    let report = SurfaceReport::new(&stack(1e-6, place)).expect("few faces");
    let expected = place + DVec3::new(0.0, 0.0, 4.0);
    assert_eq!(report.pairs.len(), 1);
    assert!(report.pairs[0].position.distance(expected) < 1e-9);
}

#[test]
fn the_report_counts_what_the_world_counts() {
    let bored = Solid::difference([
        block(DVec3::splat(-1.0), DVec3::ONE),
        Solid::cylinder(0.5, -1.0, 1.0).expect("valid"),
        Solid::cylinder(0.5 + 1e-7, -0.5, 1.0).expect("valid"),
    ]);
    let scene = scene(&[bored, block(DVec3::ONE, DVec3::splat(2.0))]);
    let report = SurfaceReport::new(&scene).expect("few faces");
    let world = World::prepare(Arc::new(scene), &WorldConfig::default()).expect("no meshes");
    let stats = world.stats();
    assert_eq!(report.surfaces, stats.surfaces);
    assert_eq!(report.merged, stats.merged_surfaces);
    let [pair] = &report.pairs[..] else {
        panic!("one pair, not {:?}", report.pairs);
    };
    assert!(!pair.planes);
    assert!((pair.gap - 1e-7).abs() < 1e-14);
    assert_eq!(pair.objects, [ObjectId(0), ObjectId(0)]);
}
