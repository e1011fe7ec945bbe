//! Shapes, arguments, operations, transforms and marks.

use octray_geometry::{Primitive, SolidNode};
use octray_math::{DVec3, transform};

use crate::reading::{clean, only, primitive, read, read_with};

#[test]
fn round_shapes_are_exact_without_fn() {
    let scene = clean("sphere($fn = 0, $fa = 12, $fs = 2, r = 10);");
    assert!(matches!(primitive(only(&scene)), Primitive::Sphere { radius } if *radius == 10.0));
    let scene = clean("cylinder(h = 4, r1 = 2, r2 = 2, center = true, $fn = 0);");
    assert!(matches!(
        primitive(only(&scene)),
        Primitive::Cylinder { radius, z } if *radius == 2.0 && *z == [-2.0, 2.0]
    ));
    let scene = clean("cylinder(h = 4, r1 = 2, r2 = 0);");
    assert!(matches!(
        primitive(only(&scene)),
        Primitive::Cone { radius, z } if *radius == [2.0, 0.0] && *z == [0.0, 4.0]
    ));
}

#[test]
fn round_shapes_are_polyhedra_with_fn_or_on_demand() {
    let faces = |text: &str, facets: bool| {
        let imported = read_with(text, facets);
        let scene = imported.scene.expect("a scene");
        match primitive(only(&scene)) {
            Primitive::Convex(polyhedron) => polyhedron.planes.len(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(faces("cylinder($fn = 6, h = 1, r1 = 1, r2 = 1);", false), 8);
    assert_eq!(faces("sphere($fn = 100, r = 25);", false), 100 * 49 + 2);
    // OpenSCAD: 2 pi r / $fs = 31.4 against 360 / $fa = 30 fragments, 15 rings.
    assert_eq!(
        faces("sphere($fn = 0, $fa = 12, $fs = 2, r = 10);", true),
        30 * 14 + 2
    );
    assert_eq!(faces("cylinder(h = 1, r = 1);", true), 5 + 2);
}

#[test]
fn arguments_go_by_name_or_by_position() {
    for text in [
        "cube(size = [1, 2, 3], center = true);",
        "cube([1, 2, 3], true);",
        "cube(center = true, [1, 2, 3]);",
        "cube(center=true,size=[1.0e0,2.,+3,]);",
        "cube(size = undef, size = [1, 2, 3], center = true, $fn = 3);",
    ] {
        let half = DVec3::new(0.5, 1.0, 1.5);
        let bounds = clean(text).bounds();
        assert_eq!((bounds.min, bounds.max), (-half, half), "{text}");
    }
    assert_eq!(clean("cube(2);").bounds().max, DVec3::splat(2.0));
    assert_eq!(clean("cube();").bounds().max, DVec3::ONE);
    assert_eq!(clean("sphere(d = 6);").bounds().max, DVec3::splat(3.0));
    let frustum = clean("cylinder(4, d1 = 2, r2 = 3);");
    assert!(matches!(
        primitive(only(&frustum)),
        Primitive::Cone {
            radius: [1.0, 3.0],
            ..
        }
    ));
    let (_, warnings) = read("cube(sise = 4);");
    assert!(warnings[0].starts_with("a.csg:1:6: warning: `cube` has no parameter `sise`"));
    let (scene, warnings) = read("sphere(r = \"big\");");
    assert!(
        warnings[0].contains("must be a number, not a string"),
        "{warnings:?}"
    );
    assert_eq!(scene.bounds().max, DVec3::ONE);
}

#[test]
fn shapes_without_inside_are_empty_with_a_warning() {
    for text in [
        "cube(size = [1, 0, 1]);",
        "cube(size = -1);",
        "cube(size = [1, inf, 1]);",
        "cube(size = [1, nan, 1]);",
        "sphere(r = 0);",
        "sphere(r = -inf, $fn = 8);",
        "cylinder(h = 0, r1 = 1, r2 = 1);",
        "cylinder(h = 1, r1 = 0, r2 = 0);",
        "cylinder(h = 1, r1 = -1, r2 = 1);",
        "cylinder(h = 1, r1 = 1, r2 = nan);",
        "polyhedron(points = undef, faces = undef);",
        "polyhedron(points = [[0, 0, 0]], faces = [[0, 1, 2]]);",
        "polyhedron(points = [[0, 0, 0], [inf, 0, 0]], faces = [[0, 1, 0]]);",
        "polyhedron(points = [[0, 0, 0], [0]], faces = [[0, 1, 0]]);",
        "polyhedron(points = 7, faces = \"x\");",
        "multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]) cube(1);",
        "multmatrix([[nan, 0, 0, 0]]) sphere(1);",
        "multmatrix([[1, 0, 0], [2, 0, 0], [0, 0, 1]]) difference() { cube(1); sphere(1); }",
    ] {
        let (scene, warnings) = read(text);
        assert!(scene.objects().is_empty(), "{text}");
        assert!(!warnings.is_empty(), "{text}");
        assert!(
            warnings.iter().all(|w| w.starts_with("a.csg:1:")),
            "{warnings:?}"
        );
    }
}

#[test]
fn empty_operands_count_as_in_openscad() {
    let count = |text: &str| read(text).0.objects().len();
    assert_eq!(count("difference() { group(); cube(1); }"), 0);
    assert_eq!(count("difference() { cube(1); group(); }"), 1);
    assert_eq!(count("intersection() { cube(1); group(); }"), 0);
    assert_eq!(count("intersection() { cube(1); hull(); }"), 0);
    assert_eq!(count("union() { cube(0); sphere(1); }"), 1);
    // Flat shapes take no part; what is switched off is not even first.
    assert_eq!(count("difference() { square(1); cube(1); }"), 1);
    assert_eq!(count("difference() { %cube(1); sphere(1); }"), 1);
    // Of something unknown nothing is left when known things are taken away.
    assert_eq!(count("difference() { hull() cube(1); sphere(1); }"), 0);
    assert_eq!(count("difference() { sphere(1); hull() cube(1); }"), 1);
}

#[test]
fn marks_switch_statements_off_and_on() {
    let names = |text: &str| -> Vec<String> {
        let scene = clean(text);
        scene.objects().iter().map(|o| o.name.to_string()).collect()
    };
    assert_eq!(
        names("%cube(1);\n*sphere(1);\n#cylinder(h = 1);\n%#cube(2);"),
        ["cylinder in line 3"]
    );
    assert_eq!(
        names("cube(1);\ngroup() {\n  sphere(1);\n! difference() { cube(2); sphere(1); }\n}"),
        ["difference in line 4"]
    );
}

#[test]
fn top_level_parts_are_objects_of_their_own() {
    let scene = clean(
        "group() { cube(1);\n  multmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {\n\
         render() { sphere(1); union() { cube(2); group(); } } } }",
    );
    let names: Vec<&str> = scene.objects().iter().map(|o| &*o.name).collect();
    assert_eq!(
        names,
        ["cube in line 1", "sphere in line 3", "cube in line 3"]
    );
    let bounds = scene.objects()[1].shape.bounds();
    assert_eq!(bounds.min, DVec3::new(4.0, -1.0, -1.0));
}

#[test]
fn transforms_compose_and_may_mirror() {
    let scene = clean(
        "multmatrix([[0, -1, 0, 10], [1, 0, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]) difference() {\n\
         multmatrix([[-1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]) cube([1, 2, 3]);\n\
         multmatrix([[1, 0, 0, 100], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(1); }",
    );
    let bounds = scene.bounds();
    assert_eq!(bounds.min, DVec3::new(6.0, 0.0, 6.0));
    assert_eq!(bounds.max, DVec3::new(8.0, 1.0, 12.0));
    // The lowest right number divides all others.
    let halved =
        clean("multmatrix([[1, 0, 0, 8], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]]) cube(2);");
    assert_eq!(halved.bounds().min, DVec3::new(4.0, 0.0, 0.0));
    assert_eq!(halved.bounds().max, DVec3::new(5.0, 1.0, 1.0));
}

#[test]
fn numbers_come_in_all_forms() {
    let scene =
        clean("cube(size = [1e+06, 2.5E-3, .5], center = false); /* c */ // d\nsphere(r = 7.);");
    assert_eq!(
        scene.objects()[0].shape.bounds().max,
        DVec3::new(1e6, 2.5e-3, 0.5)
    );
    let scene =
        clean("multmatrix([[-0, 1, 0, 0], [-1, -0, 0, 0], [0, 0, 1, -0], [0, 0, 0, 1]]) cube(1);");
    assert!(matches!(
        only(&scene).node(),
        SolidNode::Transformed { parent_from_child, .. } if transform::is_invertible(parent_from_child)
    ));
    // Not a number that f64 holds: infinite, so the cube is empty.
    assert!(read("cube(1e999);").0.objects().is_empty());
}
