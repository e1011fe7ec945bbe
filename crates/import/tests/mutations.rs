//! Broken files: valid ones of every format, mutated and cut off, must give a scene or messages,
//! and never more than a multiple of what they contain.

use std::path::{Path, PathBuf};

use octray_geometry::Sheet;
use octray_import::{InMemory, Options, load};
use octray_scene::{Scene, Shape};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Valid files of one format, made for this.
fn seeds(folder: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    let entries = std::fs::read_dir(root.join(folder)).expect("seeds");
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    let read = |path: PathBuf| {
        let bytes = std::fs::read(&path).expect("a seed");
        (PathBuf::from(path.file_name().expect("a name")), bytes)
    };
    paths.into_iter().map(read).collect()
}

/// A change to a file.
#[derive(Clone, Debug)]
enum Mutation {
    Cut(Index),
    Set(Index, u8),
    Remove(Index, u8),
    Repeat(Index, u8),
    /// Puts a word in place of the word at a place.
    Word(Index, &'static str),
}

const WORDS: [&str; 20] = [
    "0",
    "-1",
    "nan",
    "-inf",
    "1e308",
    "-1e-320",
    "4294967295",
    "4294967296",
    "1000000",
    "18446744073709551616",
    "0.5",
    "x",
    "{",
    "}",
    "(",
    "[",
    "\"",
    "#",
    "\\",
    "",
];

fn mutation() -> impl Strategy<Value = Mutation> {
    prop_oneof![
        any::<Index>().prop_map(Mutation::Cut),
        (any::<Index>(), any::<u8>()).prop_map(|(at, byte)| Mutation::Set(at, byte)),
        (any::<Index>(), any::<u8>()).prop_map(|(at, n)| Mutation::Remove(at, n)),
        (any::<Index>(), any::<u8>()).prop_map(|(at, n)| Mutation::Repeat(at, n)),
        (any::<Index>(), select(&WORDS[..])).prop_map(|(at, word)| Mutation::Word(at, word)),
        (any::<Index>(), select(&WORDS[..])).prop_map(|(at, word)| Mutation::Word(at, word)),
    ]
}

fn apply(bytes: &mut Vec<u8>, mutation: &Mutation) {
    if bytes.is_empty() {
        return;
    }
    let length = bytes.len();
    let range = |at: &Index, n: u8| {
        let start = at.index(length);
        start..(start + 1 + usize::from(n)).min(length)
    };
    match mutation {
        Mutation::Cut(at) => bytes.truncate(at.index(length)),
        Mutation::Set(at, byte) => bytes[at.index(length)] = *byte,
        Mutation::Remove(at, n) => {
            bytes.drain(range(at, *n));
        }
        Mutation::Repeat(at, n) => {
            let range = range(at, *n);
            let piece = bytes[range.clone()].to_vec();
            bytes.splice(range.start..range.start, piece);
        }
        Mutation::Word(at, word) => {
            let at = at.index(length);
            let ends = |b: &u8| b" \n\t,;()[]{}<>=".contains(b);
            let start = bytes[..at].iter().rposition(ends).map_or(0, |i| i + 1);
            let end = bytes[at..].iter().position(ends).map_or(length, |i| at + i);
            bytes.splice(start..end, word.bytes());
        }
    }
}

/// Loads a file from memory; the same bytes are its material library.
fn survives(path: &Path, bytes: &[u8]) -> Option<Scene> {
    let mut files = InMemory::default();
    files.insert(path, bytes);
    files.insert("a.mtl", bytes);
    let options = Options {
        memory_budget: 64 << 20,
        ..Options::default()
    };
    let imported = load(path, &files, &options);
    assert_eq!(imported.scene.is_none(), imported.diagnostics.has_errors());
    for diagnostic in imported.diagnostics.iter() {
        let shown = imported.diagnostics.render(diagnostic);
        assert!(
            !shown.is_empty() && !diagnostic.message.ends_with('.'),
            "{shown}"
        );
    }
    imported.scene
}

/// Vertices and triangles of all meshes.
fn mesh_size(scene: &Scene) -> usize {
    let size = |shape: &Shape| match shape {
        Shape::Sheet(Sheet::Mesh { mesh, .. }) => mesh.positions().len() + mesh.triangles().len(),
        _ => 0,
    };
    scene.objects().iter().map(|o| size(&o.shape)).sum()
}

fn check(folder: &str, mutations: &[Mutation]) {
    for (path, mut bytes) in seeds(folder) {
        for mutation in mutations {
            apply(&mut bytes, mutation);
        }
        if let Some(scene) = survives(&path, &bytes) {
            assert!(mesh_size(&scene) <= bytes.len());
        }
    }
}

#[test]
fn seeds_are_valid_and_so_is_no_beginning_of_a_mesh_with_a_count() {
    for folder in ["nff", "obj", "ply", "stl"] {
        for (path, bytes) in seeds(folder) {
            assert!(survives(&path, &bytes).is_some(), "{}", path.display());
        }
    }
    for (path, bytes) in seeds("ply") {
        for length in 0..bytes.len() - 2 {
            assert!(
                survives(&path, &bytes[..length]).is_none(),
                "{} {length}",
                path.display()
            );
        }
    }
}

#[test]
fn a_mesh_that_does_not_fit_into_the_budget_is_refused() {
    for folder in ["nff", "obj", "ply", "stl"] {
        for (path, bytes) in seeds(folder) {
            let mut files = InMemory::default();
            files.insert(&path, bytes.clone());
            let options = Options {
                // Enough to read the file, not to keep what is in it.
                memory_budget: bytes.len() as u64,
                ..Options::default()
            };
            let imported = load(&path, &files, &options);
            assert!(imported.scene.is_none(), "{}", path.display());
            let mut messages = imported.diagnostics.iter().map(|d| &d.message);
            assert!(
                messages.any(|m| m.contains("memory budget")),
                "{}",
                path.display()
            );
        }
    }
}

macro_rules! mutated {
    ($($name:ident),*) => {
        $(
            proptest! {
                #![proptest_config(ProptestConfig::with_cases(400))]
                #[test]
                fn $name(mutations in vec(mutation(), 1..6)) {
                    check(stringify!($name), &mutations);
                }
            }
        )*
    };
}

mutated!(pov, openscad, nff, ply, obj, stl);

proptest! {
    #[test]
    fn any_bytes_with_any_suffix(
        bytes in vec(any::<u8>(), 0..300),
        suffix in select(&["pov", "csg", "nff", "ply", "obj", "stl", "", "xyz"][..]),
    ) {
        survives(&Path::new("a").with_extension(suffix), &bytes);
    }

    #[test]
    fn any_words_with_any_suffix(
        words in vec(select(&["v", "f", "p", "s", "c", "l", "1", "-1", "0.5", "3", "\n", "vertex",
            "facet", "element", "property", "list", "float", "ply", "end_header", "{", "}", "(",
            ")", "[", "]", "<", ">", ",", ";", "=", "sphere", "union", "#declare", "#while"][..]), 0..200),
        suffix in select(&["pov", "csg", "nff", "ply", "obj", "stl"][..]),
    ) {
        survives(&Path::new("a").with_extension(suffix), words.join(" ").as_bytes());
    }
}
