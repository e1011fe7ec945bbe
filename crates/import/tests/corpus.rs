//! Files of others: each is read, or refused with a message; what is read has the counts that
//! the files' headers or lines announce, taken here by means that know nothing of the readers.

mod prism;

use std::path::{Path, PathBuf};

use octray_geometry::Sheet;
use octray_import::{Disk, Imported, Options, Severity, load};
use octray_math::DVec3;
use octray_scene::{Object, Shape};
use prism::{measure, mesh_of, only_mesh};

/// The folder of test files, if there is one on this machine.
#[allow(clippy::print_stdout, reason = "a skipped test must say so")]
fn corpus() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("OCTRAY_CORPUS").map_or_else(default, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: there is no {}", folder.display());
    None
}

/// All files of a folder with one of the suffixes, in order.
fn files(folder: &Path, suffixes: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let suffix = path
                .extension()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if suffixes.contains(&suffix.as_str()) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "no {suffixes:?} in {}", folder.display());
    found
}

fn read(path: &Path) -> Imported {
    load(path, &Disk, &Options::default())
}

fn triangles(imported: &Imported) -> usize {
    let objects = imported.scene.as_ref().expect("valid").objects();
    objects.iter().map(|o| mesh_of(o).triangles().len()).sum()
}

#[test]
fn every_mesh_is_read_or_refused_with_positions() {
    let Some(corpus) = corpus() else { return };
    // Those that are not valid, and why.
    let invalid = [
        // Numbers like `3.1+e2`.
        "number_formats.obj",
        "box_UTF16BE.obj",
        // The list property belongs to the vertices, whose rows have no list.
        "issue623.ply",
    ];
    for folder in ["mesh", "obj", "ply", "stl"] {
        for path in files(&corpus.join(folder), &["ply", "obj", "stl"]) {
            let imported = read(&path);
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let accepted = imported.scene.is_some();
            assert_eq!(
                accepted,
                !invalid.contains(&&*name),
                "{name}: {:#?}",
                imported.diagnostics
            );
            let errors = imported
                .diagnostics
                .iter()
                .filter(|d| d.severity == Severity::Error);
            assert_eq!(errors.count() == 0, accepted, "{name}");
        }
    }
    for path in files(&corpus.join("malformed/assimp"), &["ply", "obj", "stl"]) {
        let imported = read(&path);
        assert!(imported.scene.is_none(), "{}", path.display());
        let is_empty = std::fs::metadata(&path).expect("a file").len() == 0;
        for message in imported.diagnostics.iter() {
            assert!(message.span.is_some() || is_empty, "{message:?}");
        }
    }
}

#[test]
fn meshes_have_the_published_sizes() {
    let Some(corpus) = corpus() else { return };
    for (file, expected, closed) in [
        ("bunny_bun_zipper.ply", 69451, false),
        ("armadillo.obj", 86482, true),
        ("dragon_22866.ply", 22866, true),
        ("spot.obj", 5856, true),
        ("suzanne.obj", 968, false),
        ("teapot.obj", 6320, false),
    ] {
        let imported = read(&corpus.join("mesh").join(file));
        let mesh = only_mesh(&imported);
        assert_eq!(mesh.triangles().len(), expected, "{file}");
        assert_eq!(mesh.check_closed().is_ok(), closed, "{file}");
        if file == "armadillo.obj" {
            let (volume, _) = measure(mesh);
            assert!((volume - 0.068_618_7).abs() < 1e-7, "{volume}");
        }
    }
}

#[test]
fn obj_faces_are_all_there() {
    let Some(corpus) = corpus() else { return };
    for path in files(&corpus.join("obj"), &["obj"]) {
        let imported = read(&path);
        let Some(scene) = &imported.scene else {
            continue;
        };
        let bytes = std::fs::read(&path).expect("a file");
        let text = String::from_utf8_lossy(&bytes)
            .replace("\\\r\n", " ")
            .replace("\\\n", " ");
        // A polygon of n corners gives n - 2 triangles.
        let face = |line: &str| line.trim_start().strip_prefix("f ").map(str::to_owned);
        let corners = |f: String| f.split('#').next().unwrap_or("").split_whitespace().count();
        let expected: usize = text.lines().filter_map(face).map(|f| corners(f) - 2).sum();
        let objects = scene.objects();
        let given: usize = objects.iter().map(|o| mesh_of(o).triangles().len()).sum();
        assert_eq!(given, expected, "{}", path.display());
    }
}

#[test]
fn the_two_spiders_are_the_same() {
    let Some(corpus) = corpus() else { return };
    let [ascii, binary] = ["Spider_ascii.stl", "Spider_binary.stl"]
        .map(|name| read(&corpus.join("stl/assimp").join(name)));
    let (a, b) = (only_mesh(&ascii), only_mesh(&binary));
    assert_eq!(a.triangles(), b.triangles());
    for (p, q) in a.positions().iter().zip(b.positions()) {
        assert!((*p - *q).abs().max_element() < 1e-6, "{p} {q}");
    }
}

#[test]
fn a_concave_polygon_is_covered_once() {
    let Some(corpus) = corpus() else { return };
    for name in ["concave_polygon.obj", "space_in_material_name.obj"] {
        let imported = read(&corpus.join("obj/assimp").join(name));
        let mesh = only_mesh(&imported);
        let (_, area) = measure(mesh);
        // The vector area of the outline is what the triangles would have without overlap.
        let whole: DVec3 = mesh
            .triangles()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
                (b - a).cross(c - a) * 0.5
            })
            .sum();
        assert!(
            (area - whole.length()).abs() < 1e-6 * area,
            "{area} {whole}"
        );
    }
}

#[test]
fn databases_have_the_numbers_of_primitives_of_their_lines() {
    let Some(corpus) = corpus() else { return };
    for path in files(&corpus.join("spd"), &["nff"]) {
        let imported = read(&path);
        let name = path.display();
        assert_eq!(
            imported.diagnostics.iter().count(),
            0,
            "{name}: {:?}",
            imported.diagnostics
        );
        let scene = imported.scene.as_ref().expect("valid");
        let text = std::fs::read_to_string(&path).expect("text");
        let words = || {
            text.lines()
                .filter_map(|line| line.split_whitespace().next())
        };
        let lines = |word: &str| words().filter(|w| *w == word).count();
        let count = |kind: fn(&Object) -> bool| scene.objects().iter().filter(|o| kind(o)).count();
        assert_eq!(
            count(|o| matches!(o.shape, Shape::Solid(_))),
            lines("s"),
            "{name}"
        );
        let is_shell = |o: &Object| matches!(o.shape, Shape::Sheet(Sheet::Shell { .. }));
        assert_eq!(count(is_shell), lines("c"), "{name}");
        assert_eq!(
            (scene.lights().len(), scene.materials().len()),
            (lines("l"), lines("f"))
        );
        assert!(scene.camera().is_some());
        let corners = |line: &str| {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("p" | "pp") => words.next()?.parse::<usize>().ok(),
                _ => None,
            }
        };
        let expected: usize = text.lines().filter_map(corners).map(|n| n - 2).sum();
        let is_mesh = |o: &&Object| matches!(o.shape, Shape::Sheet(Sheet::Mesh { .. }));
        let meshes = scene.objects().iter().filter(is_mesh);
        let given: usize = meshes.map(|o| mesh_of(o).triangles().len()).sum();
        assert_eq!(given, expected, "{name}");
    }
}

#[test]
fn ply_faces_are_all_there() {
    let Some(corpus) = corpus() else { return };
    for (name, expected) in [
        ("cube.ply", 12),
        ("cube_binary.ply", 12),
        ("cube_binary_header_with_RN_newline.ply", 12),
        ("cube_binary_starts_with_nl.ply", 12),
        ("cube_uv.ply", 12),
        ("float-color.ply", 1),
        ("points.ply", 0),
    ] {
        assert_eq!(
            triangles(&read(&corpus.join("ply").join(name))),
            expected,
            "{name}"
        );
    }
}
