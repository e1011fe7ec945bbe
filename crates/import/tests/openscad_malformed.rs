//! Bad dumps: a message, and never a panic, a hang, or memory without bounds.

use std::fmt::Write as _;
use std::path::Path;

use octray_import::{Disk, Imported, Options, openscad};
use proptest::prelude::*;

fn read(bytes: impl Into<Vec<u8>>, memory_budget: u64) -> Imported {
    let options = Options {
        facets: false,
        memory_budget,
    };
    let imported = openscad::import(Path::new("a.csg"), bytes.into(), &Disk, &options);
    // A picture or a reason.
    assert!(imported.scene.is_some() || imported.diagnostics.has_errors());
    assert!(imported.scene.is_none() || !imported.diagnostics.has_errors());
    imported
}

const MEBIBYTE: u64 = 1 << 20;

fn first(imported: &Imported) -> String {
    let diagnostics = &imported.diagnostics;
    let first = diagnostics.iter().next().expect("a message");
    diagnostics.render(first)
}

#[test]
fn deep_nesting_is_refused_with_its_place() {
    for (open, close) in [
        ("group() {", "}"),
        ("difference() { cube(1); ", "}"),
        ("color([1, 0, 0]) ", "cube(1);"),
        ("multmatrix([", "])"),
        ("cube([", "]);"),
        ("!%#*", ""),
        ("{", "}"),
        ("((((", "))))"),
        ("-", "1"),
    ] {
        for count in [10_000, 100_000] {
            let text = open.repeat(count) + &close.repeat(count);
            let message = first(&read(text, 1 << 30));
            assert!(message.starts_with("a.csg:1:"), "{open}: {message}");
            assert!(message.contains("error: "), "{open}: {message}");
        }
        read(open.repeat(100_000), 1 << 30);
    }
}

#[test]
fn the_solid_may_be_200_operations_deep() {
    // Transforms of transforms and unions of unions are flattened, a difference in second place
    // is not.
    let nested = |operation: &str, count: usize| {
        let text = format!(
            "difference() {{ {}",
            format!("{operation} {{ cube(1); ").repeat(count)
        );
        text + "sphere(1); " + &"}".repeat(count + 1)
    };
    assert!(read(nested("union()", 400), MEBIBYTE * 64).scene.is_some());
    assert!(
        read(nested("difference()", 190 / 2), MEBIBYTE * 64)
            .scene
            .is_some()
    );
    let refused = read(nested("difference()", 400), MEBIBYTE * 64);
    assert!(first(&refused).contains("nested deeper than 200 operations"));
    let errors = refused.diagnostics.iter().count();
    assert!(errors <= 3, "{errors} messages for one mistake");
}

#[test]
fn the_deepest_dump_fits_a_stack_of_one_mebibyte() {
    let deepest = "difference() { color([-1, -1, -1, 0.5]) {".repeat(249) + "cube([[[1]]]);";
    let text = deepest + &"}".repeat(2 * 249);
    let worker = std::thread::Builder::new()
        .stack_size(1 << 20)
        .spawn(move || read(text, 64 * MEBIBYTE).diagnostics.iter().count())
        .expect("a thread");
    assert!(worker.join().is_ok());
}

#[test]
fn absurd_resolutions_meet_the_memory_budget() {
    for text in [
        "sphere($fn = 1e300, r = 1);",
        "sphere($fn = 1e5, r = 1);",
        "cylinder($fn = 1e9, h = 1, r1 = 1, r2 = 1);",
        "cylinder($fn = 18446744073709551616, h = 1, r1 = 1, r2 = 1);",
    ] {
        let message = first(&read(text, 64 * MEBIBYTE));
        assert!(message.contains("memory budget of 64 MiB"), "{message}");
    }
    // Many small ones together, too.
    let many = "cylinder($fn = 1000, h = 1, r1 = 1, r2 = 1);".repeat(1000);
    assert!(first(&read(many, 64 * MEBIBYTE)).contains("memory budget"));
    let large = "cube(1);".repeat(100_000);
    assert!(first(&read(large, MEBIBYTE)).contains("memory budget of 1 MiB"));
}

#[test]
fn text_that_is_no_dump_has_a_message() {
    for (bytes, words) in [
        (
            &b"cube(1);\n\xff\xfe"[..],
            "a.csg:2:1: error: this is not UTF-8",
        ),
        (
            b"sphere(r = \"1",
            "a.csg:1:12: error: this string has no closing quote",
        ),
        (
            b"cube(1); /* no end",
            "a.csg:1:10: error: this comment has no end",
        ),
        (
            b"cube(1)",
            "a.csg:1:8: error: expected `;` or `{`, but the file ends here",
        ),
        (
            b"group() {\n cube(1);",
            "a.csg:1:9: error: this `{` is never closed",
        ),
        (b"}", "a.csg:1:1: error: this `}` closes nothing"),
        (b"\x00\x01\x02", "a.csg:1:1: error: expected a shape"),
        (
            b"cube(1 2);",
            "a.csg:1:8: error: expected `,` or `)`, found `2`",
        ),
        (b"cube(r = t);", "a.csg:1:10: error: `t` is not a value"),
        (
            "cube(\u{2620});".as_bytes(),
            "a.csg:1:6: error: expected a value",
        ),
        (b"%", "a.csg:1:2: error: expected a shape"),
    ] {
        let message = first(&read(bytes, 64 * MEBIBYTE));
        assert!(message.starts_with(words), "{message}\n{words}");
    }
}

#[test]
fn empty_files_are_empty_scenes() {
    for text in ["", "\u{feff}", ";;;", "// nothing", "group();\n"] {
        let imported = read(text, MEBIBYTE);
        assert!(
            imported
                .scene
                .is_some_and(|scene| scene.objects().is_empty())
        );
    }
}

#[test]
fn faces_with_many_corners_take_bounded_time() {
    // A star with 20 000 corners above and below: not convex, with 10 000 reflex corners.
    let count = 20_000;
    let mut points = String::new();
    for z in 0..2 {
        for i in 0..count {
            let angle = f64::from(i) / f64::from(count) * std::f64::consts::TAU;
            let radius = if i % 2 == 0 { 10.0 } else { 9.0 };
            let (x, y) = (radius * angle.cos(), radius * angle.sin());
            write!(points, "[{x}, {y}, {z}],").expect("a string");
        }
    }
    let bottom: Vec<i32> = (0..count).collect();
    let top: Vec<i32> = (count..2 * count).rev().collect();
    let mut faces = format!("{bottom:?}, {top:?}");
    for i in 0..count {
        let next = (i + 1) % count;
        write!(faces, ", [{i}, {}, {}, {next}]", i + count, next + count).expect("a string");
    }
    let text = format!("polyhedron(points = [{points}], faces = [{faces}]);");
    let imported = read(text, 1 << 30);
    assert!(
        imported
            .scene
            .is_some_and(|scene| scene.objects().len() == 1)
    );
}

fn token() -> impl Strategy<Value = String> {
    let words = [
        "cube",
        "sphere",
        "cylinder",
        "polyhedron",
        "group",
        "union",
        "difference",
        "color",
        "intersection",
        "multmatrix",
        "linear_extrude",
        "hull",
        "square",
        "render",
        "size",
        "r",
        "h",
        "r1",
        "points",
        "faces",
        "center",
        "$fn",
        "true",
        "false",
        "undef",
        "inf",
        "nan",
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ",",
        ";",
        "=",
        "-",
        "+",
        "%",
        "#",
        "*",
        "!",
        "/*",
        "*/",
        "//",
        "\n",
        "\"",
        "\"red\"",
        "\\",
        "0",
        "1",
        "2.5",
        "1e3",
        "1e999",
        "-0",
        "[1, 2, 3]",
        "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "cube(1);",
        "sphere(2);",
        "[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]",
        "[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]",
        "group() {",
        "difference() {",
        "() {",
        "\u{2620}",
    ];
    prop::sample::select(words.to_vec()).prop_map(str::to_owned)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_tokens_are_read_or_refused(tokens in prop::collection::vec(token(), 0..60), space: bool) {
        let text = tokens.join(if space { " " } else { "" });
        let imported = read(text, 64 * MEBIBYTE);
        for diagnostic in imported.diagnostics.iter() {
            prop_assert!(imported.diagnostics.render(diagnostic).starts_with("a.csg:"));
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read(bytes, MEBIBYTE);
    }

    #[test]
    fn a_dump_with_a_wrong_byte_is_read_or_refused(at in 0..200_usize, byte: u8) {
        let mut text = b"difference() {\n\tcolor([1, 0, 0, 1]) {\n\t\tsphere($fn = 8, $fa = 12, \
            $fs = 2, r = 25);\n\t}\n#\tmultmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], \
            [0, 0, 0, 1]]) {\n\t\tcylinder(h = 9, r1 = 1, r2 = 0, center = true);\n\t}\n}\n"
            .to_vec();
        let at = at % text.len();
        text[at] = byte;
        read(text, 64 * MEBIBYTE);
    }
}
