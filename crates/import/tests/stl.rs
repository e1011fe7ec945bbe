//! STL files written here, ascii and binary, whole and broken.

mod prism;

use std::fmt::Write as _;
use std::path::Path;

use octray_import::{Imported, InMemory, Options, stl};
use octray_math::DVec3;
use prism::{Prism, check_refused, mesh_of, messages, only_mesh};

fn import(bytes: impl Into<Vec<u8>>) -> Imported {
    let files = InMemory::default();
    stl::import(
        Path::new("a.stl"),
        bytes.into(),
        &files,
        &Options::default(),
    )
}

/// Triangles of a prism over a convex outline, with coordinates that are exact as 32-bit floats.
fn triangles(prism: &Prism) -> Vec<[DVec3; 3]> {
    let rounded = |i: usize| {
        let p = prism.positions[i].to_array().map(|x| f64::from(x as f32));
        DVec3::from_array(p)
    };
    let fan = |face: &Vec<usize>| {
        let (first, rest) = (face[0], face[1..].to_vec());
        let pair = |w: &[usize]| [first, w[0], w[1]].map(rounded);
        rest.windows(2).map(pair).collect::<Vec<_>>()
    };
    prism.faces.iter().flat_map(fan).collect()
}

fn ascii(name: &str, triangles: &[[DVec3; 3]]) -> String {
    let mut text = format!("solid {name}\n");
    for corners in triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for p in corners {
            writeln!(text, "      vertex {:e} {} {}", p.x, p.y, p.z).expect("a string");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid\n"
}

fn binary(header: &[u8], triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        for p in corners {
            for x in p.to_array() {
                bytes.extend((x as f32).to_le_bytes());
            }
        }
        bytes.extend([0xab, 0xcd]);
    }
    bytes
}

#[test]
fn ascii_and_binary_give_the_same_closed_mesh() {
    let prism = Prism::regular(10, 1.0);
    let triangles = triangles(&prism);
    let text = import(ascii("part", &triangles));
    prism.check(only_mesh(&text), 1e-5);
    // 20 corners, each once.
    assert_eq!(only_mesh(&text).positions().len(), 20);
    for header in [&b"solid part"[..], b"", b"\xff\xfe", b"COLOR=abcd"] {
        let other = import(binary(header, &triangles));
        assert_eq!(only_mesh(&other), only_mesh(&text));
    }
}

#[test]
fn keywords_may_be_in_capitals_and_lines_may_end_in_any_way() {
    let text = ascii("part", &triangles(&Prism::regular(4, 1.0)));
    let expected = import(text.clone());
    for variant in [
        text.to_uppercase(),
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace("  ", "\t"),
        text.replace("facet normal 0 0 0", "facet normal nan nan nan"),
        format!("\n  {text}"),
    ] {
        assert_eq!(only_mesh(&import(variant)), only_mesh(&expected));
    }
}

#[test]
fn every_solid_is_an_object() {
    let all = triangles(&Prism::regular(4, 1.0));
    let text = ascii("one", &all[..2]) + &ascii("", &[]) + &ascii("the other", &all[2..]);
    let scene = import(text).scene.expect("valid");
    let names: Vec<&str> = scene.objects().iter().map(|o| &*o.name).collect();
    assert_eq!(names, ["one", "the other"]);
    assert_eq!(
        mesh_of(&scene.objects()[1]).triangles().len(),
        all.len() - 2
    );
    let nameless = import(ascii("", &all)).scene.expect("valid");
    assert_eq!(&*nameless.objects()[0].name, "a");
}

#[test]
fn every_truncation_of_a_binary_file_is_refused() {
    let whole = binary(b"solid", &triangles(&Prism::regular(3, 1.0)));
    for length in 0..whole.len() {
        let imported = import(&whole[..length]);
        assert!(
            imported.scene.is_none(),
            "cut at {length} of {}",
            whole.len()
        );
    }
    let short = import(&whole[..150]);
    check_refused(
        &short,
        &[
            "a.stl: error: the header announces 8 triangles (484 bytes), but the file ends at byte \
           150, after 1 triangles",
        ],
    );
    let mut long = whole.clone();
    long.push(0);
    let imported = import(long);
    assert!(messages(&imported)[0].contains("1 bytes after the last"));
    assert_eq!(only_mesh(&imported), only_mesh(&import(whole)));
}

#[test]
fn a_count_without_triangles_allocates_nothing() {
    let mut bytes = vec![0; 80];
    bytes.extend(u32::MAX.to_le_bytes());
    bytes.extend([0; 50]);
    check_refused(
        &import(bytes),
        &["a.stl: error: the header announces 4294967295 triangles"],
    );
}

#[test]
fn degenerate_triangles_are_kept_and_infinite_ones_refused() {
    let mut all = triangles(&Prism::regular(3, 1.0));
    all.push([DVec3::ONE; 3]);
    all.push([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]);
    assert_eq!(only_mesh(&import(ascii("x", &all))).triangles().len(), 10);
    assert_eq!(only_mesh(&import(binary(b"x", &all))).triangles().len(), 10);
    all[1][2].y = f64::INFINITY;
    all[2][0].x = f64::NAN;
    check_refused(
        &import(binary(b"x", &all)),
        &[
            "a.stl: error: at byte 170: corner 3 of triangle 2 is not finite: (",
            "a.stl: error: at byte 196: corner 1 of triangle 3 is not finite: (NaN, ",
        ],
    );
    check_refused(
        &import(ascii("x", &all)),
        &["a.stl:13:", "a.stl:18:14: error: `NaN` is not finite"],
    );
}

#[test]
fn all_mistakes_of_a_text_are_reported_with_line_and_column() {
    let imported = import(
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 x 0\nendloop\nendfacet\n\
         vertex 1 1 1\nendloop\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nfacets\n\
         outer loop\nvertex 0 0 0\nendfacet\nouter\nvertex 1 2 3\n",
    );
    check_refused(
        &imported,
        &[
            "a.stl:4:1: error: a vertex has 3 coordinates, this one 2",
            "a.stl:5:10: error: `x` is not a number",
            "a.stl:8:1: error: this vertex is not in an `outer loop`",
            "a.stl:9:1: error: `endloop` without `outer loop`",
            "a.stl:10:1: error: a loop has 3 vertices, this one 2",
            "a.stl:14:1: error: `facets` is no keyword of STL",
            "a.stl:15:1: error: this loop has no `endloop`",
            "a.stl:18:1: error: `outer` must be followed by `loop`",
            "a.stl:20:1: error: the file ends inside a facet",
        ],
    );
}

#[test]
fn what_is_no_stl_at_all_is_said_so() {
    check_refused(&import(""), &["a.stl: error: the file is empty"]);
    check_refused(&import("hello\n"), &["a.stl: error: this is no STL file"]);
    check_refused(
        &import(*b"\xff\xfes\0o\0"),
        &["a.stl: error: the file is UTF-16 text"],
    );
    check_refused(
        &import([7, 0, 9]),
        &["a.stl: error: the file ends after 3 bytes"],
    );
    let empty = import("solid nothing\nendsolid nothing\n");
    assert_eq!(
        messages(&empty),
        ["a.stl: warning: the file holds no triangles"]
    );
    assert!(empty.scene.is_some());
}
