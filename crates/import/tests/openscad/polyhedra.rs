//! Polyhedra: convex, concave, open, and looking the wrong way.

use octray_geometry::{Primitive, SolidNode};
use octray_math::DVec3;
use octray_scene::Shape;

use crate::reading::{clean, column_volume, only, primitive, read};

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
fn concave_polyhedra_are_solids_that_look_out() {
    let scene = clean(&l_shape(|face| face));
    assert!((column_volume(only(&scene), 0.5) - 25.0).abs() < 1e-12);
    let reversed = |face: Vec<u32>| face.into_iter().rev().collect::<Vec<u32>>();
    let (scene, warnings) = read(&l_shape(reversed));
    assert!((column_volume(only(&scene), 0.5) - 25.0).abs() < 1e-12);
    assert!(warnings[0].contains("turned round"), "{warnings:?}");
    let (scene, warnings) = read(&l_shape(|f| {
        if f.contains(&9) && f.len() == 4 {
            reversed(f)
        } else {
            f
        }
    }));
    assert!((column_volume(only(&scene), 0.5) - 25.0).abs() < 1e-12);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn polyhedra_that_pass_through_themselves_are_taken_by_winding_number_with_a_warning() {
    // Two tetrahedra in one polyhedron; the second is moved into the first or away from it.
    let pair = |shift: f64| {
        let corners = |s: f64| {
            [
                [0.0, 0.0, 0.0],
                [4.0, 0.0, 0.0],
                [0.0, 4.0, 0.0],
                [0.0, 0.0, 4.0],
            ]
            .map(|[x, y, z]| format!("[{}, {}, {}]", x + s, y + s, z + s))
            .join(",")
        };
        let faces = "[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]";
        let others = "[4, 5, 6], [4, 7, 5], [4, 6, 7], [5, 7, 6]";
        format!(
            "polyhedron(points = [{}, {}], faces = [{faces}, {others}]);",
            corners(0.0),
            corners(shift)
        )
    };
    let apart = clean(&pair(10.0));
    assert!(matches!(primitive(only(&apart)), Primitive::Composite(_)));
    let (scene, warnings) = read(&pair(0.5));
    assert!(matches!(primitive(only(&scene)), Primitive::Mesh(_)));
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("a.csg:1:1: warning: the mesh is solid where"));
    assert!(warnings[0].contains("crossings of triangles: triangles "));
}
