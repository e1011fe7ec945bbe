//! `linear_extrude` and `rotate_extrude` of flat shapes.

use octray_geometry::{Primitive, Solid};
use octray_math::DVec3;

use crate::reading::{clean, column_volume, only, primitive, read};

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
    assert!((column_volume(&concave, 0.5) - 20.0).abs() < 1e-12);
    let clockwise = of("polygon([[0, 3], [1, 3], [1, 1], [3, 1], [3, 0], [0, 0]], undef);");
    assert!((column_volume(&clockwise, 0.5) - 20.0).abs() < 1e-12);
}

#[test]
fn paths_in_paths_are_holes_and_islands() {
    let ring = |r: i32| format!("[{0}, {0}], [{1}, {0}], [{1}, {1}], [{0}, {1}]", -r, r);
    let points = [9, 5, 7, 1].map(ring).join(", ");
    let paths = "[[0, 1, 2, 3], [4, 5, 6, 7], [11, 10, 9, 8], [12, 13, 14, 15]]";
    let scene = clean(&format!(
        "linear_extrude(height = 1) polygon(points = [{points}], paths = {paths}, convexity = 1);"
    ));
    // Squares of side 18 without 14, and in that hole 10 without 2.
    let expected = f64::from(18 * 18 - 14 * 14 + 10 * 10 - 2 * 2);
    assert!((column_volume(only(&scene), 0.5) - expected).abs() < 1e-12);
}

#[test]
fn outlines_that_cross_enclose_what_they_go_round_an_odd_number_of_times() {
    let bow_tie = "polygon([[0, 0], [4, 4], [4, 0], [0, 4]])";
    let scene = clean(&format!("linear_extrude(height = 2) {bow_tie};"));
    // Two triangles of 4; lines through the middles of squares take just their halves.
    let volume = column_volume(only(&scene), 1.0 / 64.0);
    assert!((volume / 16.0 - 1.0).abs() < 1e-2, "{volume}");
}

#[test]
fn a_scale_makes_frusta_and_pyramids_and_moves_what_lies_aside() {
    let of = |shape: &str| {
        let scene = clean(&format!("linear_extrude(height = 4, scale = 0.5) {shape}"));
        only(&scene).clone()
    };
    let moved = "multmatrix([[1, 0, 0, 2], [0, 1, 0, 6], [0, 0, 1, 0], [0, 0, 0, 1]])";
    let pyramid = of(&format!("{moved} square(2);"));
    // At the top the corner has moved from (2, 6) to (1, 3) and the side is 1 long.
    let top = Solid::cuboid(DVec3::new(0.0, 0.0, 3.999_999), DVec3::new(9.0, 9.0, 4.0));
    let cut = Solid::intersection([pyramid.clone(), top.expect("valid")]);
    assert!((column_volume(&cut, 1.0 / 256.0) / 1e-6 - 1.0).abs() < 0.03);
    let expected = 4.0 * 4.0 * (1.0 + 0.5 + 0.25) / 3.0;
    assert!((column_volume(&pyramid, 1.0 / 64.0) / expected - 1.0).abs() < 0.02);
    assert!(matches!(
        primitive(&of("circle($fn = 0, r = 2);")),
        Primitive::Cone { radius, .. } if *radius == [2.0, 1.0]
    ));
    let (_, warnings) = read("linear_extrude(height = 1, scale = [1, 2]) square(1);");
    assert!(warnings[0].contains("unequal scales"), "{warnings:?}");
}

#[test]
fn flat_shapes_are_turned_about_the_axis() {
    let of = |arguments: &str, shape: &str| {
        let scene = clean(&format!("rotate_extrude({arguments}) {shape}"));
        only(&scene).clone()
    };
    let moved = |x: f64| format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, 0]])");
    // A ring of a square section: pi (9 - 4) 2.
    let ring = of("angle = 360", &format!("{} square([1, 2]);", moved(2.0)));
    let exact = 10.0 * std::f64::consts::PI;
    assert!((column_volume(&ring, 1.0 / 64.0) / exact - 1.0).abs() < 5e-3);
    assert_eq!(ring.bounds().max, DVec3::new(3.0, 3.0, 2.0));
    // From the other side of the axis it is the same; a quarter is a quarter.
    let mirrored = of("angle = 360", &format!("{} square([1, 2]);", moved(-3.0)));
    assert!((column_volume(&mirrored, 1.0 / 64.0) / exact - 1.0).abs() < 5e-3);
    let quarter = of(
        "angle = 90, start = 0",
        &format!("{} square([1, 2]);", moved(2.0)),
    );
    assert!((column_volume(&quarter, 1.0 / 64.0) / (exact / 4.0) - 1.0).abs() < 1e-2);
    // With facets it is what OpenSCAD makes: here a square with corners on the axes.
    let square = of(
        "angle = 360, $fn = 4",
        &format!("{} square([1, 2]);", moved(2.0)),
    );
    let expected = 2.0 * 2.0 * (9.0 - 4.0);
    assert!((column_volume(&square, 1.0 / 64.0) / expected - 1.0).abs() < 5e-3);
    // A whole circle of which a square takes the part beyond the axis.
    let half = "difference() { circle(r = 2, $fn = 0); \
                multmatrix([[1, 0, 0, -4], [0, 1, 0, -2]]) square(4); }";
    let ball = column_volume(&of("", half), 1.0 / 32.0);
    let exact = 32.0 / 3.0 * std::f64::consts::PI;
    assert!((ball / exact - 1.0).abs() < 5e-3, "{ball} {exact}");
    let torus = of("", &format!("{} circle(r = 1, $fn = 0);", moved(3.0)));
    assert_eq!(torus.bounds().max, DVec3::new(4.0, 4.0, 1.0));
}

#[test]
fn polygons_that_enclose_nothing_are_left_out() {
    for (polygon, words) in [
        ("[[0, 0], [0, 1], [0, 2]]", "no area"),
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
