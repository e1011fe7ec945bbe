//! OpenSCAD's own examples and regression dumps: all are read, and what is left out is said.

use std::path::{Path, PathBuf};

use octray_import::{Disk, Imported, Options, Severity, openscad};

/// The folder of test files, or `None` (said on the console) where there is none.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
fn corpus(folder: &str) -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("OCTRAY_CORPUS").map_or(default, PathBuf::from);
    let folder = root.join(folder);
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}

fn dumps(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "csg"));
    paths.sort();
    paths
}

fn import(path: &Path, facets: bool) -> Imported {
    let bytes = std::fs::read(path).expect("a file");
    let options = Options {
        facets,
        ..Options::default()
    };
    openscad::import(path, bytes, &Disk, &options)
}

/// Words that only stand in dumps with modules that are not supported.
const UNSUPPORTED: [&str; 17] = [
    "circle(",
    "square(",
    "polygon(",
    "text(",
    "offset(",
    "fill(",
    "projection(",
    "import(",
    "linear_extrude(",
    "rotate_extrude(",
    "surface(",
    "hull(",
    "minkowski(",
    "resize(",
    "roof(",
    "glide(",
    "subdiv(",
];

#[test]
fn every_dump_is_read() {
    let mut read = 0;
    for folder in ["openscad/examples", "openscad/dump"] {
        let Some(folder) = corpus(folder) else { return };
        for path in dumps(&folder) {
            for facets in [false, true] {
                let imported = import(&path, facets);
                let name = path.display();
                let diagnostics = &imported.diagnostics;
                assert!(!diagnostics.has_errors(), "{name}: {diagnostics:?}");
                assert!(imported.scene.is_some(), "{name}");
                let text = std::fs::read_to_string(&path).expect("text");
                let uses_unsupported = UNSUPPORTED.iter().any(|word| text.contains(word));
                for diagnostic in diagnostics.iter() {
                    assert_eq!(diagnostic.severity, Severity::Warning);
                    assert!(diagnostic.span.is_some(), "{name}: {diagnostics:?}");
                    let about_support = diagnostic.message.contains("not supported");
                    assert!(
                        uses_unsupported || !about_support,
                        "{name}: {diagnostics:?}"
                    );
                }
            }
            read += 1;
        }
    }
    assert_eq!(read, 266);
}

#[test]
fn both_dialects_give_the_same_scene() {
    let Some(folder) = corpus("openscad/examples") else {
        return;
    };
    let mut compared = 0;
    for old in dumps(&folder) {
        let name = old.file_name().expect("a name").to_string_lossy();
        let Some(stem) = name.strip_suffix(".2021.csg") else {
            continue;
        };
        let new = folder.join(format!("{stem}.master.csg"));
        if !new.is_file() {
            continue;
        }
        let [old, new] = [&old, &new].map(|path| import(path, true).scene.expect("a scene"));
        let [old_box, new_box] = [&old, &new].map(octray_scene::Scene::bounds);
        assert_eq!(old_box, new_box, "{stem}");
        assert_eq!(old.objects().len(), new.objects().len(), "{stem}");
        assert_eq!(old.materials(), new.materials(), "{stem}");
        compared += 1;
    }
    assert!(compared >= 40, "{compared}");
}
