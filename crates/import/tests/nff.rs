//! NFF files written here, with everything that the format has, and with mistakes.

mod prism;

use std::fmt::Write as _;
use std::path::Path;

use octray_geometry::{Sheet, SolidNode};
use octray_import::{Imported, InMemory, Options, nff};
use octray_math::{Aabb, DVec3};
use octray_scene::{Background, LightKind, Object, Pigment, Shape};
use prism::{Prism, check_refused, mesh_of, messages, only_mesh};

fn import(text: &str) -> Imported {
    let files = InMemory::default();
    let bytes = text.as_bytes().to_vec();
    nff::import(Path::new("a.nff"), bytes, &files, &Options::default())
}

const VIEW: &str = "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 90\nhither 0.1\nresolution 64 48\n";
const FILL: &str = "f 1 0.5 0.25 0.8 0 100000 0 0\n";

#[test]
fn the_viewpoint_is_a_camera() {
    let scene = import(VIEW).scene.expect("valid");
    let camera = scene.camera().expect("one");
    assert_eq!(camera.eye, DVec3::new(0.0, -5.0, 0.0));
    assert_eq!(camera.forward, DVec3::Y);
    // 90 degrees: the picture is as wide and high as twice the distance.
    assert!((camera.right - DVec3::X * 2.0).length() < 1e-12);
    assert!((camera.up - DVec3::Z * 2.0).length() < 1e-12);
    assert_eq!(scene.settings().size, Some((64, 48)));
    assert_eq!(scene.settings().up, DVec3::Z);
}

#[test]
fn lights_share_the_strength_unless_they_have_a_colour() {
    let text = format!("{VIEW}b 0.1 0.2 0.3\nl 1 2 3\nl 4 5 6 0.7 0.8 0.9\nl 7 8 9\nl 0 0 1\n");
    let scene = import(&text).scene.expect("valid");
    let colors: Vec<DVec3> = scene.lights().iter().map(|l| l.color).collect();
    let half = DVec3::splat(0.5);
    assert_eq!(colors, [half, DVec3::new(0.7, 0.8, 0.9), half, half]);
    let position = DVec3::new(4.0, 5.0, 6.0);
    assert_eq!(scene.lights()[1].kind, LightKind::Point { position });
    let expected = Background::Uniform(DVec3::new(0.1, 0.2, 0.3));
    assert_eq!(*scene.background(), expected);
}

#[test]
fn fills_are_materials() {
    let text = "f 1 0.5 0.25 0.8 0 100000 0 0\ns 0 0 0 1\nf 0 0 1 0.1 0.2 33 0.9 1.5\ns 3 0 0 1\n";
    let scene = import(text).scene.expect("valid");
    let [matte, glass] = scene.materials() else {
        panic!("two");
    };
    let color = |m: &octray_scene::Material| match m.pigment {
        Pigment::Uniform(color) => color,
        Pigment::Pattern { .. } => panic!("one colour"),
    };
    assert_eq!(color(matte).rgb, DVec3::new(1.0, 0.5, 0.25));
    assert!(!matte.pigment.is_transparent() && matte.finish.reflection.is_none());
    assert_eq!((matte.finish.diffuse, matte.interior.ior), (0.8, 1.0));
    // What the generators write for balls' floor: ambient 0.2, diffuse 0.8.
    assert!((matte.finish.ambient - 0.2).abs().max_element() < 1e-12);
    assert_eq!((color(glass).filter, color(glass).transmit), (0.9, 0.0));
    assert_eq!((glass.finish.phong_size, glass.interior.ior), (33.0, 1.5));
    assert_eq!(glass.finish.reflection.min, DVec3::splat(0.2));
    assert_eq!(glass.finish.ambient, DVec3::ZERO);
}

fn only_object(text: &str) -> Object {
    let scene = import(&format!("{FILL}{text}")).scene.expect("valid");
    assert_eq!(scene.objects().len(), 1);
    scene.objects()[0].clone()
}

#[test]
fn spheres_are_solids_whatever_side_is_meant() {
    for text in [
        "s 1 2 3 0.5\n",
        "s 1 2 3 -0.5",
        "s\n1 2\n# remark\n3 0.5 # another",
    ] {
        let object = only_object(text);
        assert!(matches!(object.shape, Shape::Solid(_)));
        let center = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(object.shape.bounds(), Aabb::new(center - 0.5, center + 0.5));
    }
}

/// Parts of a shell, both in world space.
fn shell(object: &Object) -> (&octray_geometry::Solid, &octray_geometry::Solid) {
    match &object.shape {
        Shape::Sheet(Sheet::Shell { solid, clip }) => (solid, clip),
        other => panic!("no shell: {other:?}"),
    }
}

#[test]
fn cylinders_and_cones_are_open_sheets_between_their_circles() {
    for (text, radii) in [
        ("c 0 0 0 1 0 0 4 1\n", [1.0, 1.0]),
        ("c 0 0 0 -1 0 0 4 -1\n", [1.0, 1.0]),
        ("c 0 0 0 1 0 0 4 0.5\n", [1.0, 0.5]),
        ("c 0 0 0 0.5 0 0 4 1\n", [0.5, 1.0]),
        ("c 0 0 0 1 0 0 4 0\n", [1.0, 0.0]),
    ] {
        let object = only_object(text);
        let (solid, clip) = shell(&object);
        // The clip is the slab 0 <= z <= 4, and the solid's caps lie outside it (or at the tip).
        let SolidNode::Transformed { child, .. } = clip.node() else {
            panic!("moved");
        };
        assert!(matches!(child.node(), SolidNode::Intersection(two) if two.len() == 2));
        let bounds = solid.bounds();
        assert!(
            bounds.min.z < 0.0 && (bounds.max.z > 4.0 || radii[1] == 0.0),
            "{bounds:?}"
        );
        let widest = f64::max(radii[0], radii[1]);
        assert!(
            bounds.max.x >= widest && bounds.max.x < widest * 1.1,
            "{bounds:?}"
        );
    }
}

#[test]
fn polygons_of_one_fill_are_one_mesh() {
    let prism = Prism::star(6, 0.5, 1.0);
    let mut text = String::from(FILL);
    for face in &prism.faces {
        writeln!(text, "p {}", face.len()).expect("a string");
        for &i in face {
            let p = prism.positions[i];
            writeln!(text, "{} {} {}", p.x, p.y, p.z).expect("a string");
        }
    }
    let imported = import(&text);
    let mesh = only_mesh(&imported);
    prism.check(mesh, 1e-12);
    assert_eq!(mesh.positions().len(), 24);
    text += FILL;
    text += "p 3 0 0 0 1 0 0 0 1 0\n";
    assert_eq!(import(&text).scene.expect("valid").objects().len(), 2);
}

#[test]
fn patches_have_normals_and_polygons_their_own() {
    let object =
        only_object("pp 3\n0 0 0 0 0 1\n1 0 0 1 0 0\n0 1 0 0 1 0\np 3\n0 0 0\n1 0 0\n0 0 1\n");
    let mesh = mesh_of(&object);
    let normals = mesh.normals().expect("normals");
    let at = |t: usize| normals.triangles[t].map(|i| normals.values[i as usize]);
    assert_eq!(at(0), [DVec3::Z, DVec3::X, DVec3::Y]);
    assert_eq!(at(1), [DVec3::ZERO; 3]);
    assert_eq!(mesh.positions().len(), 4);
}

#[test]
fn all_mistakes_are_reported_with_line_and_column() {
    let imported = import(
        "v\nfrom 0 0 0\nat 0 0 0\nup 0 0 1\nangle 180\nresolution 1000000 0.5\nf 1 1 1\n\
         s 0 0 0 nan\ns 0 0 0\np 2\n0 0 0\n1 1 1\np 4 0 0 0 1 0 0 1 1 0\nx 1 2\n7\nb 1 1\n\
         c 0 0 0 1 0 0 inf 1\npp 3 0 0 0 0 0 1",
    );
    check_refused(
        &imported,
        &[
            "a.nff:5:1: error: the angle must lie between 0 and 180 degrees, not 180",
            "a.nff:6:1: error: a picture of 1000000 by 0.5 pixels cannot be made",
            "a.nff:7:1: error: `f` needs 8 numbers here; there are 3, then comes `s`",
            "a.nff:8:9: error: `nan` is not finite",
            "a.nff:9:1: error: `s` needs 4 numbers here; there are 3, then comes `p`",
            "a.nff:10:1: error: a polygon has at least 3 vertices, not 2",
            "a.nff:13:1: warning: no `f` comes before this: it gets the default material",
            "a.nff:13:1: error: the polygon has 4 vertices, but only 3 are complete",
            "a.nff:14:1: error: `x` is not an NFF entity",
            "a.nff:16:1: error: `b` needs 3 numbers here; there are 2, then comes `c`",
            "a.nff:17:15: error: `inf` is not finite",
            "a.nff:18:1: error: the polygon has 3 vertices, but only 1 are complete",
            "a.nff:1:1: error: a viewpoint needs `from`, `at`, `up` and `angle`",
        ],
    );
    let coinciding = VIEW.replace("-5", "0");
    check_refused(
        &import(&coinciding),
        &["a.nff:1:1: error: `from` and `at` must be apart"],
    );
}

#[test]
fn what_cannot_be_seen_is_passed_over_with_a_warning() {
    let imported = import(&format!(
        "{VIEW}{FILL}s 0 0 0 0\nc 1 1 1 1 1 1 1 1\nc 0 0 0 0 1 0 0 0\n"
    ));
    assert_eq!(
        messages(&imported),
        [
            "a.nff:9:1: warning: passed over: radius must be greater than 0, not 0",
            "a.nff:10:1: warning: passed over: axis must not be the zero vector",
            "a.nff:11:1: warning: passed over: largest radius must be greater than 0, not 0",
        ]
    );
    assert!(imported.scene.expect("valid").objects().is_empty());
}

#[test]
fn a_count_without_vertices_allocates_nothing() {
    for count in ["4000000000", "1e300", "18446744073709551616"] {
        let imported = import(&format!("{VIEW}{FILL}p {count}\n1 2 3\n"));
        check_refused(&imported, &["a.nff:9:1: error: the polygon has "]);
    }
}
