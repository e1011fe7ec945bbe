//! Meshes of files as solids: what is wrong with them is said with places, and they are shown.

use std::path::Path;

use octray_geometry::SolidNode;
use octray_import::{Imported, InMemory, Options, pov};
use octray_scene::Shape;

fn import(text: &str) -> Imported {
    let files = InMemory::default();
    pov::import(
        Path::new("s.pov"),
        text.as_bytes().to_vec(),
        &files,
        &Options::default(),
    )
}

fn warnings(imported: &Imported) -> Vec<String> {
    let all = imported.diagnostics.iter();
    all.map(|d| imported.diagnostics.render(d)).collect()
}

/// Tetrahedra with a corner at (s, s, s), 4 wide, cut by a sphere; without the last `left_out` faces.
fn cut_tetrahedra(shifts: &[f64], left_out: usize) -> String {
    let mut faces = Vec::new();
    for s in shifts {
        let corner = |x: u8, y: u8, z: u8| {
            let at = |i: u8| f64::from(i) + s;
            format!("<{}, {}, {}>", at(x), at(y), at(z))
        };
        let [o, x, y, z] = [
            corner(0, 0, 0),
            corner(4, 0, 0),
            corner(0, 4, 0),
            corner(0, 0, 4),
        ];
        for [a, b, c] in [[&o, &y, &x], [&o, &x, &z], [&o, &z, &y], [&x, &y, &z]] {
            faces.push(format!("triangle {{ {a}, {b}, {c} }}"));
        }
    }
    faces.truncate(faces.len() - left_out);
    let faces = faces.join("\n");
    format!("difference {{ mesh {{ {faces} inside_vector z }} sphere {{ 0, 1 }} }}")
}

fn operands(imported: &Imported) -> usize {
    let scene = imported.scene.as_ref().expect("a scene");
    let Shape::Solid(solid) = &scene.objects()[0].shape else {
        panic!("not a solid");
    };
    match solid.node() {
        SolidNode::Empty => 0,
        _ => solid.operands() as usize,
    }
}

#[test]
fn a_sound_mesh_is_an_operand_without_a_word() {
    for shifts in [vec![0.0], vec![0.0, 10.0]] {
        let imported = import(&cut_tetrahedra(&shifts, 0));
        assert_eq!(warnings(&imported), [""; 0]);
        assert_eq!(operands(&imported), 2);
    }
}

#[test]
fn a_mesh_that_crosses_itself_is_an_operand_with_a_warning_that_says_where() {
    let imported = import(&cut_tetrahedra(&[0.0, 0.5], 0));
    assert_eq!(operands(&imported), 2);
    let said = warnings(&imported);
    assert_eq!(said.len(), 1, "{said:?}");
    for part in [
        "s.pov:1:",
        "winding number",
        "crossings of triangles",
        "cross at (",
    ] {
        assert!(said[0].contains(part), "{part}: {said:?}");
    }
}

#[test]
fn an_open_mesh_is_left_out_and_its_hole_is_named() {
    let imported = import(&cut_tetrahedra(&[0.0], 1));
    let said = warnings(&imported);
    assert_eq!(said.len(), 1, "{said:?}");
    for part in ["left out", "3 open edges", "(4, 0, 0)", "(0, 4, 0)"] {
        assert!(said[0].contains(part), "{part}: {said:?}");
    }
}
