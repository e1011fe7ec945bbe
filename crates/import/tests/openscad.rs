//! What OpenSCAD's dumps mean, statement by statement.

use std::path::Path;

use octray_geometry::{Primitive, Solid, SolidNode};
use octray_import::{Disk, Imported, Options, openscad};
use octray_math::{DVec3, transform};
use octray_scene::{Color, Object, Pigment, Scene, Shape};

fn read_with(text: &str, facets: bool) -> Imported {
    let options = Options {
        facets,
        ..Options::default()
    };
    openscad::import(Path::new("a.csg"), text.into(), &Disk, &options)
}

/// The scene of a text without mistakes, and its warnings as they are shown.
fn read(text: &str) -> (Scene, Vec<String>) {
    let imported = read_with(text, false);
    let shown = shown(&imported);
    (
        imported.scene.unwrap_or_else(|| panic!("{shown:#?}")),
        shown,
    )
}

fn shown(imported: &Imported) -> Vec<String> {
    let diagnostics = &imported.diagnostics;
    diagnostics.iter().map(|d| diagnostics.render(d)).collect()
}

/// The scene of a text that nothing is wrong with.
fn clean(text: &str) -> Scene {
    let (scene, warnings) = read(text);
    assert_eq!(warnings, Vec::<String>::new(), "{text}");
    scene
}

/// The first lines of all messages of a text with mistakes.
fn mistakes(text: &str) -> Vec<String> {
    let imported = read_with(text, false);
    assert!(imported.scene.is_none(), "{text}");
    let first = |message: String| message.lines().next().unwrap_or_default().to_owned();
    shown(&imported).into_iter().map(first).collect()
}

fn solid(object: &Object) -> &Solid {
    match &object.shape {
        Shape::Solid(solid) => solid,
        Shape::Sheet(_) => panic!("{} is a sheet", object.name),
    }
}

fn only(scene: &Scene) -> &Solid {
    assert_eq!(scene.objects().len(), 1);
    solid(&scene.objects()[0])
}

fn primitive(solid: &Solid) -> &Primitive {
    match solid.node() {
        SolidNode::Primitive(primitive) => primitive,
        SolidNode::Transformed { child, .. } | SolidNode::WithMaterial { child, .. } => {
            primitive(child)
        }
        other => panic!("not a primitive: {other:?}"),
    }
}

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
        scene.objects().iter().map(|o| o.name.clone()).collect()
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
    let names: Vec<&str> = scene.objects().iter().map(|o| o.name.as_str()).collect();
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

#[test]
fn polyhedra_are_convex_closed_or_open() {
    let cube = "points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], \
                [0, 1, 1], [1, 1, 1]], faces = [[6, 7, 5, 4], [0, 1, 3, 2], [4, 5, 1, 0], \
                [5, 7, 3, 1], [7, 6, 2, 3]";
    let closed = clean(&format!("polyhedron({cube}, [6, 4, 0, 2]]);"));
    let Primitive::Convex(polyhedron) = primitive(only(&closed)) else {
        panic!("not convex");
    };
    assert_eq!((polyhedron.planes.len(), polyhedron.vertices.len()), (6, 8));
    assert!(polyhedron.planes.contains(&(DVec3::X, 1.0)));
    let open = format!("polyhedron({cube}]);");
    let (scene, warnings) = read(&open);
    assert!(matches!(scene.objects()[0].shape, Shape::Sheet(_)));
    assert!(
        warnings[0].starts_with("a.csg:1:1: warning: the mesh is not closed"),
        "{warnings:?}"
    );
    let (scene, warnings) = read(&format!("difference() {{ sphere(1); {open} }}"));
    assert!(matches!(
        only(&scene).node(),
        SolidNode::Primitive(Primitive::Sphere { .. })
    ));
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].contains("left out of the difference"),
        "{warnings:?}"
    );
}

/// The signed volume of the mesh of a solid.
fn mesh_volume(solid: &Solid) -> f64 {
    let Primitive::Mesh(mesh) = primitive(solid) else {
        panic!("not a mesh: {solid:?}");
    };
    let corner = |i: u32| mesh.positions()[i as usize];
    let tetrahedra = mesh.triangles().iter().map(|t| {
        let [a, b, c] = t.map(corner);
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.sum()
}

/// An L of 3 x 3 with a bay of 2 x 2, 5 high; `faces` as OpenSCAD wants them.
fn l_shape(order: impl Fn(Vec<u32>) -> Vec<u32>) -> String {
    let ring = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)];
    let points: Vec<String> = [0, 5]
        .iter()
        .flat_map(|z| ring.iter().map(move |(x, y)| format!("[{x}, {y}, {z}]")))
        .collect();
    let mut faces = vec![(0..6).collect::<Vec<u32>>(), (6..12).rev().collect()];
    faces.extend((0..6).map(|i| vec![i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6]));
    let faces: Vec<String> = faces
        .into_iter()
        .map(|f| format!("{:?}", order(f)))
        .collect();
    format!(
        "polyhedron(points = [{}], faces = [{}]);",
        points.join(","),
        faces.join(",")
    )
}

#[test]
fn concave_polyhedra_are_closed_meshes_that_look_out() {
    let scene = clean(&l_shape(|face| face));
    assert!((mesh_volume(only(&scene)) - 25.0).abs() < 1e-12);
    let reversed = |face: Vec<u32>| face.into_iter().rev().collect::<Vec<u32>>();
    let (scene, warnings) = read(&l_shape(reversed));
    assert!((mesh_volume(only(&scene)) - 25.0).abs() < 1e-12);
    assert!(warnings[0].contains("turned round"), "{warnings:?}");
    let (scene, warnings) = read(&l_shape(|f| {
        if f.contains(&9) && f.len() == 4 {
            reversed(f)
        } else {
            f
        }
    }));
    assert!((mesh_volume(only(&scene)) - 25.0).abs() < 1e-12);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn what_is_not_supported_is_said_once_per_use() {
    let (scene, warnings) = read(
        "cube(1);\nlinear_extrude(height = 3, scale = [1, 1]) {\n  square(1);\n}\n\
         union() {\n  circle(r = 1);\n  hull() { cube(1); }\n  sphere(1);\n}\n",
    );
    assert_eq!(scene.objects().len(), 2);
    let starts = ["a.csg:2:1: ", "a.csg:6:3: ", "a.csg:7:3: "];
    assert_eq!(warnings.len(), 3);
    for (warning, start) in warnings.iter().zip(starts) {
        assert!(
            warning.starts_with(&format!("{start}warning: `")),
            "{warning}"
        );
        assert!(warning.contains("not supported"), "{warning}");
    }
}

#[test]
fn all_mistakes_are_reported_at_once() {
    let found = mistakes(
        "cube(size = [1, 2);\nsphre(r = 1);\nunion() {\n  cube(1) sphere(1;\n  cylinder(h = ];\n}\n\
         sphere(r = 1)\n}\ncube(1);\nintersection( {",
    );
    let starts: Vec<&str> = found
        .iter()
        .map(|m| m.split(": ").next().unwrap_or(""))
        .collect();
    for place in [
        "a.csg:1:18",
        "a.csg:2:1",
        "a.csg:4:19",
        "a.csg:5:16",
        "a.csg:8:1",
        "a.csg:10:15",
    ] {
        assert!(starts.contains(&place), "{place}: {found:#?}");
    }
}

#[test]
fn unknown_modules_get_a_suggestion() {
    let help = |text: &str| shown(&read_with(text, false)).join("\n");
    assert!(help("cylindre(h = 1);").contains("did you mean `cylinder`?"));
    assert!(help("translate([1, 2, 3]) cube(1);").contains("openscad -o model.csg"));
    assert!(help("x = 3;").contains("openscad -o model.csg"));
    assert!(help("module a() { cube(1); }").contains("openscad -o model.csg"));
    let program = openscad::refuse_program(Path::new("dir/part.scad"), b"cube(1);".to_vec());
    assert!(program.scene.is_none());
    assert!(shown(&program)[0].contains("openscad -o part.csg dir/part.scad"));
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
