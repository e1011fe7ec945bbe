//! Whose colour counts.

use octray_geometry::{Solid, SolidNode};
use octray_math::DVec3;
use octray_scene::{Color, Pigment, Scene};

use crate::reading::{clean, only, read};

/// Colours of the materials that a solid's primitives have, in order; `None` is the object's.
fn colors(scene: &Scene, solid: &Solid, around: Option<DVec3>) -> Vec<Option<DVec3>> {
    match solid.node() {
        SolidNode::Empty => Vec::new(),
        SolidNode::Primitive(_) => vec![around],
        SolidNode::Transformed { child, .. } | SolidNode::Complement(child) => {
            colors(scene, child, around)
        }
        SolidNode::WithMaterial { child, material } => {
            let Pigment::Uniform(Color { rgb, .. }) = scene.material(*material).pigment else {
                panic!("a pattern");
            };
            colors(scene, child, Some(rgb))
        }
        SolidNode::Union(all) | SolidNode::Intersection(all) | SolidNode::Difference(all) => {
            all.iter().flat_map(|s| colors(scene, s, around)).collect()
        }
    }
}

const RED: Option<DVec3> = Some(DVec3::X);

const BLUE: Option<DVec3> = Some(DVec3::Z);

#[test]
fn the_outermost_complete_colour_counts() {
    let of = |text: &str| {
        let scene = clean(text);
        let material = scene.material(scene.objects()[0].material);
        let Pigment::Uniform(color) = material.pigment else {
            panic!("a pattern");
        };
        let own = colors(&scene, only(&scene), None);
        (Some(color.rgb), color.transmit, own)
    };
    let (object, _, own) = of("color(\"red\") color([0, 0, 1, 1]) cube(1);");
    assert_eq!((object, own), (RED, vec![None]));
    let (object, transmit, _) = of("color([-1, -1, -1, -1]) color(\"blue\", 0.25) cube(1);");
    assert_eq!((object, transmit), (BLUE, 0.75));
    // A colour that leaves channels open gives way to one further in, as a whole.
    let (object, transmit, _) = of("color([-1, -1, -1, 0.5]) color([1, 0, 0, 1]) cube(1);");
    assert_eq!((object, transmit), (RED, 0.0));
    let (_, transmit, _) = of("color([-1, -1, -1, 0.5]) cube(1);");
    assert_eq!(transmit, 0.5);
    // Inside an operation the innermost material is nearest, so the outer one must be alone.
    let text = "difference() { color([1, 0, 0]) color([0, 0, 1]) cube(1); sphere(1); }";
    assert_eq!(of(text).2[0], RED);
}

#[test]
fn what_is_cut_without_colour_shows_it() {
    let scene = clean(
        "difference() { cube(9);\n sphere(1);\n color(\"blue\") sphere(2);\n\
         difference() { sphere(3); sphere(1); } }",
    );
    let found = colors(&scene, only(&scene), None);
    let cut = found[1];
    assert_eq!(found[0], None);
    assert!(
        cut.is_some_and(|c| c.y > c.x && c.y > c.z),
        "green: {cut:?}"
    );
    assert_eq!((found[2], found[3]), (BLUE, cut));
    // What is taken away from what is taken away stays.
    assert!(found[4].is_some_and(|c| c.x > c.y), "yellow: {found:?}");
    let colored = clean("color([1, 0, 0]) difference() { cube(9); sphere(1); }");
    assert_eq!(colors(&colored, only(&colored), None), [None, None]);
}

#[test]
fn colours_that_are_none_are_ignored_with_a_warning() {
    for bad in [
        "[]",
        "\"rod\"",
        "7",
        "[1, 2]",
        "[1, true, 1]",
        "[0, 0, 300]",
    ] {
        let (scene, warnings) = read(&format!("color({bad}) cube(1);"));
        assert_eq!(warnings.len(), 1, "{bad}: {warnings:?}");
        assert!(
            warnings[0].starts_with("a.csg:1:7: warning: "),
            "{warnings:?}"
        );
        assert_eq!(scene.objects().len(), 1);
    }
}
