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
    cuts: Vec<Cut>,
    at: [i8; 3],
    size: u8,
    turned: bool,
    priority: i32,
    clear: bool,
    lets_light_pass: bool,
}

/// Of the first kinds, which are of three faces at most, or of all.
fn thing(kinds: u8) -> impl Strategy<Value = Thing> {
    let odd = prop::bool::weighted(0.1);
    (
        0..kinds,
        proptest::collection::vec(cut(), 0..5),
        [-4..=4i8, -4..=4, -4..=4],
        1..=4u8,
        any::<bool>(),
        0..3i32,
        odd,
        odd,
    )
        .prop_map(
            |(kind, cuts, at, size, turned, priority, clear, lets_light_pass)| Thing {
                kind,
                cuts,
                at,
                size,
                turned,
                priority,
                clear,
                lets_light_pass,
            },
        )
}

/// What is cut out of a block, or put to it: on a lattice too, so that cutters touch faces and one another.
#[derive(Clone, Copy, Debug)]
struct Cut {
    kind: u8,
    at: [i8; 3],
    size: u8,
    axis: u8,
    /// Moved by this many units in the last place.
    nudge: i8,
    operation: u8,
}

fn cut() -> impl Strategy<Value = Cut> {
    let nudge = prop_oneof![4 => Just(0i8), 1 => -2..=2i8];
    (
        0..4u8,
        [-2..=2i8, -2..=2, -2..=2],
        1..=4u8,
        0..3u8,
        nudge,
        0..16u8,
    )
        .prop_map(|(kind, at, size, axis, nudge, operation)| Cut {
            kind,
            at,
            size,
            axis,
            nudge,
            operation,
        })
}

impl Cut {
    /// In a block that reaches from -`r` to `r`.
    fn solid(self, r: f64) -> Solid {
        let radius = 0.25 * r * f64::from(self.size) + f64::from(self.nudge) * r * f64::EPSILON;
        let solid = match self.kind {
            0 => Solid::sphere(radius),
            1 => Solid::cuboid(DVec3::splat(-radius), DVec3::new(radius, radius, 2.0 * r)),
            2 => Solid::cylinder(radius, -r, 2.0 * r),
            _ => Solid::cylinder(radius, -1.25 * r, 2.5 * r),
        };
        let at = self.at.map(|x| 0.5 * r * f64::from(x));
        let axes = match self.axis {
            0 => DMat3::IDENTITY,
            1 => DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X),
            _ => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        };
        let place = DAffine3::from_mat3_translation(axes, at.into());
        let solid = solid.expect("positive sizes");
        solid.transform(place).expect("invertible")
    }

    fn apply(self, to: Solid, r: f64) -> Solid {
        let with = self.solid(r);
        match self.operation {
            0 => Solid::union([to, with]),
            1 => Solid::intersection([to, with]),
            2 => Solid::difference([with, to]),
            3 => {
                let core = Solid::sphere(0.5 * r).expect("a radius");
                Solid::difference([to, Solid::difference([with, core])])
            }
            _ => Solid::difference([to, with]),
        }
    }
}

impl Thing {
    /// A box or a round with cutters.
    fn block(&self, r: f64) -> Solid {
        let corner = DVec3::splat(r);
        let first = match self.kind {
            6..=8 => Solid::cuboid(-corner, corner),
            9 => Solid::sphere(r),
            _ => Solid::cylinder(r, -r, 2.0 * r),
        };
        let first = first.expect("positive sizes");
        (self.cuts.iter()).fold(first, |solid, cut| cut.apply(solid, r))
    }

    fn solid(&self) -> Solid {
        let r = 0.25 * f64::from(self.size);
        let solid = match self.kind {
            0 | 1 => Solid::sphere(r),
            2 => Solid::cylinder(r, -r, 2.0 * r),
            3 => Solid::cone(r, 0.5 * r, 0.0, r),
            4..=5 => Solid::torus(r, 0.5 * r),
            _ => Ok(self.block(r)),
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

/// As many as `OCTRAY_CASES` times the usual number.
fn cases(usual: u32) -> ProptestConfig {
    let times = std::env::var("OCTRAY_CASES").map_or(1, |times| times.parse().expect("a number"));
    ProptestConfig::with_cases(usual * times)
}

fn rays() -> impl Strategy<Value = Vec<Ray>> {
    let ray = (lattice_or_anywhere(), lattice_or_anywhere());
    proptest::collection::vec(ray.prop_map(|(from, to)| Ray::new(from, to - from)), 60)
}

fn check(
    things: &[Thing],
    rays: &[Ray],
    variety: Variety,
    needs_tree: bool,
) -> Result<(), TestCaseError> {
    let scene = scene(things, variety);
    let by_tree = world(&scene, Method::Auto);
    prop_assert!(
        !needs_tree || by_tree.stats().cells.is_none(),
        "cells are not tested here"
    );
    let found = answers(&by_tree, rays);
    let expected = answers(&world(&scene, Method::Brute), rays);
    prop_assert_eq!(found.closest, expected.closest);
    prop_assert_eq!(found.occluded, expected.occluded);
    prop_assert_eq!(found.dark, expected.dark);
    prop_assert_eq!(found.crossings, expected.crossings);
    prop_assert_eq!(found.chords, expected.chords);
    prop_assert_eq!(found.regions, expected.regions);
    Ok(())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn small_solids_are_answered_as_by_brute_force(
        things in proptest::collection::vec(thing(6), 9..40),
        rays in rays(),
        [priorities, materials, sheets, floor] in any::<[bool; 4]>(),
    ) {
        let variety = Variety { priorities, materials, sheets, floor };
        // Discs have no bounds, and of things without any there may be few only.
        check(&things, &rays, variety, !sheets)?;
    }

    #[test]
    fn drilled_blocks_are_answered_as_by_brute_force(
        mut things in proptest::collection::vec(thing(11), 9..20),
        rays in rays(),
        [priorities, materials, sheets, floor, flat] in any::<[bool; 5]>(),
    ) {
        let variety = Variety { priorities, materials, sheets, floor };
        if flat {
            // Of a convex hull less convex holes there is always a tree.
            let cuts = things.iter_mut().flat_map(|thing| &mut thing.cuts);
            cuts.filter(|cut| cut.operation != 1).for_each(|cut| cut.operation = 4);
        }
        check(&things, &rays, variety, flat && !sheets)?;
    }
}
