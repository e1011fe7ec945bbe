//! PLY files written here, with everything that the format allows, and with mistakes.

mod prism;

use std::fmt::Write as _;
use std::path::Path;

use octray_import::{Imported, InMemory, Options, ply};
use octray_math::DVec3;
use octray_scene::Pigment;
use prism::{Prism, check_refused, messages, only_mesh};

fn import(bytes: impl Into<Vec<u8>>) -> Imported {
    let files = InMemory::default();
    ply::import(
        Path::new("a.ply"),
        bytes.into(),
        &files,
        &Options::default(),
    )
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// Appends a number in the given format and type.
fn put(out: &mut Vec<u8>, format: &str, kind: &str, value: f64) {
    let mut number = |bytes: Vec<u8>| {
        if format == "binary_big_endian" {
            out.extend(bytes.into_iter().rev());
        } else {
            out.extend(bytes);
        }
    };
    if format == "ascii" {
        return out.extend(format!("{value} ").bytes());
    }
    match kind {
        "char" | "int8" => number((value as i8).to_le_bytes().to_vec()),
        "uchar" | "uint8" => number((value as u8).to_le_bytes().to_vec()),
        "short" | "int16" => number((value as i16).to_le_bytes().to_vec()),
        "ushort" | "uint16" => number((value as u16).to_le_bytes().to_vec()),
        "int" | "int32" => number((value as i32).to_le_bytes().to_vec()),
        "uint" | "uint32" => number((value as u32).to_le_bytes().to_vec()),
        "float" | "float32" => number((value as f32).to_le_bytes().to_vec()),
        "double" | "float64" => number(value.to_le_bytes().to_vec()),
        other => panic!("{other}"),
    }
}

fn end_row(out: &mut Vec<u8>, format: &str) {
    if format == "ascii" {
        out.push(b'\n');
    }
}

fn write(prism: &Prism, format: &str, coordinate: &str, count: &str, index: &str) -> Vec<u8> {
    let mut out = format!(
        "ply\r\nformat {format} 1.0\ncomment made by a test\nobj_info and more\n\
         element vertex {}\nproperty {coordinate} x\nproperty uchar spare\n\
         property {coordinate} y\nproperty {coordinate} z\n\
         element edge 1\nproperty list uchar short ends\n\
         element face {}\nproperty float quality\nproperty list {count} {index} vertex_indices\n\
         end_header\n",
        prism.positions.len(),
        prism.faces.len(),
    )
    .into_bytes();
    for p in &prism.positions {
        put(&mut out, format, coordinate, p.x);
        put(&mut out, format, "uchar", 7.0);
        put(&mut out, format, coordinate, p.y);
        put(&mut out, format, coordinate, p.z);
        end_row(&mut out, format);
    }
    for value in [2.0, 0.0, 1.0] {
        put(
            &mut out,
            format,
            if value == 2.0 { "uchar" } else { "short" },
            value,
        );
    }
    end_row(&mut out, format);
    for face in &prism.faces {
        put(&mut out, format, "float", 0.5);
        put(&mut out, format, count, face.len() as f64);
        for &i in face {
            put(&mut out, format, index, i as f64);
        }
        end_row(&mut out, format);
    }
    out
}

#[test]
fn every_format_and_type_gives_the_same_polyhedron() {
    let prism = Prism::star(7, 0.4, 2.0);
    for format in FORMATS {
        for (coordinate, tolerance) in [("double", 1e-12), ("float64", 1e-12), ("float", 1e-5)] {
            for count in ["uchar", "ushort", "int", "uint8", "uint32"] {
                for index in ["char", "uchar", "short", "uint16", "int", "uint32"] {
                    let imported = import(write(&prism, format, coordinate, count, index));
                    prism.check(only_mesh(&imported), tolerance);
                }
            }
        }
    }
}

#[test]
fn binary_and_ascii_agree_to_the_bit() {
    let prism = Prism::regular(12, 1.5);
    let [ascii, little, big] = FORMATS.map(|f| import(write(&prism, f, "double", "uchar", "int")));
    assert_eq!(only_mesh(&ascii), only_mesh(&little));
    assert_eq!(only_mesh(&ascii), only_mesh(&big));
}

#[test]
fn every_truncation_is_refused() {
    let prism = Prism::regular(3, 1.0);
    for format in FORMATS {
        let whole = write(&prism, format, "float", "uchar", "int");
        // The last byte of a text is a newline, the one before a blank.
        let shortest = whole.len() - if format == "ascii" { 2 } else { 0 };
        for length in 0..shortest {
            let imported = import(&whole[..length]);
            assert!(
                imported.scene.is_none(),
                "{format} cut at {length} of {}",
                whole.len()
            );
            assert!(imported.diagnostics.has_errors());
        }
    }
}

#[test]
fn numbers_of_rows_are_held_against_the_file() {
    for claim in ["4000000000", "18446744073709551615", "99999999999999999999"] {
        for format in FORMATS {
            let imported = import(format!(
                "ply\nformat {format} 1.0\nelement vertex {claim}\nproperty float x\n\
                 property float y\nproperty float z\nend_header\n1 2 3\n"
            ));
            let expected = if claim.starts_with("999") || claim.starts_with("184") {
                "a.ply:3:16: error: `"
            } else {
                "a.ply:3:1: error: `vertex` is said to have 4000000000 rows"
            };
            check_refused(&imported, &[expected]);
        }
    }
    let imported = import(
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
         property float z\nelement nothing 4000000000\nend_header\n",
    );
    assert_eq!(
        messages(&imported),
        ["a.ply: warning: the file holds no vertices"]
    );
}

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n";

#[test]
fn all_mistakes_are_reported_with_their_lines() {
    let imported = import(format!(
        "{HEADER}0 0 0\n1 nan 0\n1 x 0\n0 1\n3 0 1 4\n3 0 -1 2\n"
    ));
    check_refused(
        &imported,
        &[
            "a.ply:11:1: error: vertex 1 is not finite: (1, NaN, 0)",
            "a.ply:12:3: error: `x` is not a number",
            "a.ply:13:1: error: this row has no z",
            "a.ply:14:1: error: the face uses vertex 4, but there are 4 (from 0)",
            "a.ply:15:1: error: the face uses vertex -1, but there are 4 (from 0)",
        ],
    );
    let imported = import(format!(
        "{HEADER}0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n3 0 1 1.5\n"
    ));
    check_refused(
        &imported,
        &[
            "a.ply:14:1: error: a face has at least 3 corners, this one 2",
            "a.ply:15:1: error: the face uses vertex 1.5",
        ],
    );
}

#[test]
fn mistakes_in_binary_files_name_the_byte() {
    let mut prism = Prism::regular(3, 1.0);
    prism.positions[2].y = f64::INFINITY;
    prism.faces[1][0] = 77;
    let bytes = write(&prism, "binary_little_endian", "float", "uchar", "int");
    let body = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .expect("a header")
        + 11;
    let vertex = body + 2 * 13;
    // 6 vertices, an edge, a face of three corners.
    let face = body + 6 * 13 + 5 + 17;
    check_refused(
        &import(bytes),
        &[
            &format!("a.ply: error: at byte {vertex}: vertex 2 is not finite"),
            &format!("a.ply: error: at byte {face}: the face uses vertex 77, but there are 6"),
        ],
    );
}

#[test]
fn headers_with_mistakes() {
    for (text, expected) in [
        ("", "a.ply: error: the file is empty"),
        (
            "plyx\n",
            "a.ply:1:1: error: a PLY file begins with the line `ply`",
        ),
        (
            "ply\nformat ebcdic 1.0\nend_header\n",
            "a.ply:2:8: error: `ebcdic` is no format",
        ),
        (
            "ply\nend_header\n",
            "a.ply:1:1: error: the header has no `format`",
        ),
        (
            "ply\nformat ascii 1.0\n",
            "a.ply:3:1: error: the file ends inside the header",
        ),
        (
            "ply\nproperty float x\n",
            "a.ply:2:1: error: a property before the first element",
        ),
        (
            "ply\nelement vertex -1\n",
            "a.ply:2:16: error: `-1` is no number of rows",
        ),
        (
            "ply\nelement v 1\nproperty real x\n",
            "a.ply:3:10: error: `real` is no type of PLY",
        ),
        (
            "ply\nelement v 1\nproperty list float int x\n",
            "a.ply:3:1: error: the length of a list must have an integer type",
        ),
        (
            "ply\nelement vertex 1\nelement vertex 2\n",
            "a.ply:3:1: error: there are two elements `vertex`",
        ),
        ("ply\nhello\n", "a.ply:2:1: error: `hello` is no keyword"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
            "a.ply:3:1: error: the element `vertex` must have the properties x, y and z",
        ),
        (
            "ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n1\n",
            "a.ply:3:1: error: the element `face` must have a list of integers",
        ),
        (
            "\u{feff}ply\n",
            "a.ply:1:1: error: a PLY file begins with the line `ply`",
        ),
    ] {
        check_refused(&import(text), &[expected]);
    }
    check_refused(
        &import(*b"\xff\xfep\0l\0y\0"),
        &["a.ply: error: the file is UTF-16 text"],
    );
}

#[test]
fn triangle_strips_keep_their_orientation() {
    // A strip round a square tube, then -1 and the lids; every triangle must face outwards.
    let mut text = "ply\nformat ascii 1.0\nelement tristrips 1\n\
        property list int int vertex_indices\nelement vertex 8\nproperty int x\n\
        property int y\nproperty int z\nend_header\n\
        20 0 4 1 5 2 6 3 7 0 4 -1 0 1 3 2 -1 4 7 5 6\n"
        .to_owned();
    for z in 0..2 {
        for (x, y) in [(0, 0), (0, 1), (1, 1), (1, 0)] {
            writeln!(text, "{x} {y} {z}").expect("a string");
        }
    }
    let imported = import(text);
    let mesh = only_mesh(&imported);
    assert_eq!(mesh.check_closed(), Ok(()));
    let (volume, area) = prism::measure(mesh);
    assert!((volume - 1.0).abs() < 1e-12 && (area - 6.0).abs() < 1e-12);
}

#[test]
fn colours_become_materials_where_faces_have_one() {
    let file = |colors: [&str; 4]| {
        let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
        let mut text = HEADER.replace(
            "property float z\n",
            "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
        );
        for (corner, color) in corners.iter().zip(colors) {
            writeln!(text, "{corner} {color}").expect("a string");
        }
        import(text + "3 0 1 2\n3 0 2 3\n")
    };
    let red = file(["255 0 0"; 4]);
    let scene = red.scene.as_ref().expect("valid");
    let Pigment::Uniform(color) = &scene.material(scene.objects()[0].material).pigment else {
        panic!("one colour");
    };
    assert_eq!(color.rgb, DVec3::X);
    let varied = file(["255 0 0", "0 255 0", "0 0 255", "0 0 0"]);
    assert!(messages(&varied)[0].contains("vary within faces"));
    assert!(only_mesh(&varied).materials().is_none());

    let by_face = import(
        HEADER.replace(
            "vertex_indices\n",
            "vertex_indices\nproperty float red\nproperty float green\nproperty float blue\n",
        ) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 1 0 0\n3 0 2 3 0 1 0.25\n",
    );
    let mesh = only_mesh(&by_face);
    let materials = mesh.materials().expect("one per triangle");
    assert_eq!(materials.len(), 3);
    assert_eq!(materials[0], materials[1]);
    assert_ne!(materials[1], materials[2]);
}

#[test]
fn normals_and_texture_coordinates_are_kept_by_vertex() {
    let imported = import(
        HEADER.replace(
            "property float z\n",
            "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
             property float s\nproperty float t\n",
        ) + "0 0 0 0 0 1 0 0\n1 0 0 0 1 0 1 0\n1 1 0 nan 0 0 1 1\n0 1 0 1 0 0 0 1\n\
             3 0 1 2\n3 0 2 3\n",
    );
    let mesh = only_mesh(&imported);
    let normals = mesh.normals().expect("normals");
    assert_eq!(normals.values, [DVec3::Z, DVec3::Y, DVec3::ZERO, DVec3::X]);
    assert_eq!(normals.triangles, mesh.triangles());
    let uv = mesh.texcoords().expect("texture coordinates");
    assert_eq!(uv.values[2].to_array(), [1.0, 1.0]);
}
