//! Many small solids, whose tree of boxes `auto` chooses instead of cells: brute force is the oracle.

#[expect(dead_code, reason = "shared with the suite of all methods")]
mod answers;

use std::sync::Arc;

use answers::answers;
use octray_geometry::{Sheet, Solid};
use octray_math::{DAffine3, DMat3, DVec3, Ray};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{Method, World, WorldConfig};
use proptest::prelude::*;

/// A thing on a lattice, so that many touch, coincide or lie in one another.
#[derive(Clone, Debug)]
struct Thing {
    kind: u8,
    at: [i8; 3],
    size: u8,
    turned: bool,
    priority: i32,
    clear: bool,
    lets_light_pass: bool,
}

fn thing() -> impl Strategy<Value = Thing> {
    let odd = prop::bool::weighted(0.1);
    (
        0..6u8,
        [-4..=4i8, -4..=4, -4..=4],
        1..=4u8,
        any::<bool>(),
        0..3i32,
        odd,
        odd,
    )
        .prop_map(
            |(kind, at, size, turned, priority, clear, lets_light_pass)| Thing {
                kind,
                at,
                size,
                turned,
                priority,
                clear,
                lets_light_pass,
            },
        )
}

impl Thing {
    fn solid(&self) -> Solid {
        let r = 0.25 * f64::from(self.size);
        let solid = match self.kind {
            0 | 1 => Solid::sphere(r),
            2 => Solid::cylinder(r, -r, 2.0 * r),
            3 => Solid::cone(r, 0.5 * r, 0.0, r),
            _ => Solid::torus(r, 0.5 * r),
        };
        let solid = solid.expect("positive radii");
        let at = self.at.map(|x| 0.25 * f64::from(x));
        let axes = if self.turned {
            DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X)
        } else {
            DMat3::IDENTITY
        };
        let place = DAffine3::from_mat3_translation(axes, at.into());
        solid.transform(place).expect("invertible")
    }
}

/// How the things of a scene may differ beside their shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Variety {
    priorities: bool,
    materials: bool,
    sheets: bool,
    floor: bool,
}

fn scene(things: &[Thing], variety: Variety) -> Arc<Scene> {
    let mut builder = SceneBuilder::new();
    let matte = builder.add_material(Material::default());
    let glass = builder.add_material(Material::glass("glass", 1.5));
    for thing in things {
        let material = if thing.clear && variety.materials {
            glass
        } else {
            matte
        };
        let mut object = if variety.sheets && thing.kind == 5 {
            let at = thing.at.map(|x| 0.25 * f64::from(x));
            let disc = Sheet::disc(at.into(), DVec3::Z, 0.25 * f64::from(thing.size), 0.0);
            Object::sheet("disc", disc.expect("a radius"), material)
        } else {
            Object::solid("solid", thing.solid(), material)
        };
        if variety.priorities {
            object.priority = thing.priority;
        }
        object.casts_shadows = !(variety.materials && thing.lets_light_pass);
        builder.add_object(object);
    }
    if variety.floor {
        let floor = Solid::half_space(DVec3::Z, -0.5).expect("a normal");
        builder.add_object(Object::solid("floor", floor, matte));
    }
    Arc::new(builder.build().expect("valid"))
}

fn world(scene: &Arc<Scene>, method: Method) -> World {
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    World::prepare(Arc::clone(scene), &config).expect("no meshes")
}

fn lattice_or_anywhere() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        [-12..=12i8, -12..=12, -12..=12]
            .prop_map(|p| DVec3::from_array(p.map(|x| 0.25 * f64::from(x)))),
        [-3.0..3.0f64, -3.0..3.0, -3.0..3.0].prop_map(DVec3::from_array),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn small_solids_are_answered_as_by_brute_force(
        things in proptest::collection::vec(thing(), 9..40),
        rays in proptest::collection::vec((lattice_or_anywhere(), lattice_or_anywhere()), 60),
        [priorities, materials, sheets, floor] in any::<[bool; 4]>(),
    ) {
        let variety = Variety { priorities, materials, sheets, floor };
        let rays: Vec<Ray> = rays.into_iter().map(|(from, to)| Ray::new(from, to - from)).collect();
        let scene = scene(&things, variety);
        let by_tree = world(&scene, Method::Auto);
        // Discs have no bounds, and of things without any there may be few only.
        prop_assert!(sheets || by_tree.stats().cells.is_none(), "cells are not tested here");
        let found = answers(&by_tree, &rays);
        let expected = answers(&world(&scene, Method::Brute), &rays);
        prop_assert_eq!(found.closest, expected.closest);
        prop_assert_eq!(found.occluded, expected.occluded);
        prop_assert_eq!(found.dark, expected.dark);
        prop_assert_eq!(found.crossings, expected.crossings);
        prop_assert_eq!(found.chords, expected.chords);
        prop_assert_eq!(found.regions, expected.regions);
    }
}
