//! `linear_extrude` of flat shapes.

use octray_geometry::{Primitive, SolidNode};
use octray_math::DVec3;

use crate::reading::{clean, mesh_volume, only, primitive, read};

#[test]
fn flat_shapes_are_drawn_out() {
    let of = |shape: &str| {
        let scene = clean(&format!(
            "linear_extrude(height = 4, center = true) {shape}"
        ));
        only(&scene).clone()
    };
    assert!(matches!(
        primitive(&of("circle($fn = 0, r = 2);")),
        Primitive::Cylinder { radius, z } if *radius == 2.0 && *z == [-2.0, 2.0]
    ));
    let Primitive::Convex(hexagon) = primitive(&of("circle($fn = 6, r = 2);")).clone() else {
        panic!("not convex");
    };
    assert_eq!((hexagon.planes.len(), hexagon.vertices.len()), (8, 12));
    let bounds = of("square(size = [3, 2], center = false);").bounds();
    assert_eq!(bounds.min, DVec3::new(0.0, 0.0, -2.0));
    assert_eq!(bounds.max, DVec3::new(3.0, 2.0, 2.0));
    // Heights stay, whatever a matrix says about them.
    let turned =
        of("multmatrix([[0, -1, 9, 5], [1, 0, 9, 0], [9, 9, 0, 9], [0, 0, 0, 1]]) square(1);");
    assert_eq!(turned.bounds().min, DVec3::new(4.0, 0.0, -2.0));
    assert_eq!(turned.bounds().max, DVec3::new(5.0, 1.0, 2.0));
    let concave = of("polygon(points = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]);");
    assert!((mesh_volume(&concave) - 20.0).abs() < 1e-12);
    let clockwise = of("polygon([[0, 3], [1, 3], [1, 1], [3, 1], [3, 0], [0, 0]], undef);");
    assert!((mesh_volume(&clockwise) - 20.0).abs() < 1e-12);
}

#[test]
fn paths_in_paths_are_holes_and_islands() {
    let ring = |r: i32| format!("[{0}, {0}], [{1}, {0}], [{1}, {1}], [{0}, {1}]", -r, r);
    let points = [9, 5, 7, 1].map(ring).join(", ");
    let paths = "[[0, 1, 2, 3], [4, 5, 6, 7], [11, 10, 9, 8], [12, 13, 14, 15]]";
    let scene = clean(&format!(
        "linear_extrude(height = 1) polygon(points = [{points}], paths = {paths}, convexity = 1);"
    ));
    // 9 without 7, and in that hole 5 without 1.
    let SolidNode::Difference(outer) = only(&scene).node() else {
        panic!("{:?}", only(&scene));
    };
    assert_eq!(outer[1].bounds().max, DVec3::new(1.0, 1.0, 1.0));
    let SolidNode::Union(filled) = outer[0].node() else {
        panic!("{:?}", outer[0]);
    };
    let SolidNode::Difference(frame) = filled[0].node() else {
        panic!("{:?}", filled[0]);
    };
    let sizes = [&frame[0], &frame[1], &filled[1]].map(|s| s.bounds().max.x);
    assert_eq!(sizes, [9.0, 7.0, 5.0]);
}

#[test]
fn polygons_that_enclose_nothing_clear_are_left_out() {
    for (polygon, words) in [
        ("[[0, 0], [2, 2], [2, 0], [0, 2]]", "without area"),
        ("[[0, 0], [4, 4], [4, 0], [0, 3]]", "edges that cross"),
        ("[[0, 0], [1, 1], [2, 2]]", "without area"),
        ("[[0, 0], [1, inf], [2, 2]]", "finite"),
        ("[[0, 0], [4, 0], [0, 4]], [[0, 1, 7]]", "does not have"),
        ("[[0, 0], [4, 0], [0, 4]], 8", "vectors of indices"),
    ] {
        let (scene, warnings) = read(&format!("linear_extrude(height = 1) polygon({polygon});"));
        assert!(scene.objects().is_empty(), "{polygon}");
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].contains(words), "{warnings:?}");
    }
}
