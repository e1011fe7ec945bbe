//! The scenes: the project's own, and those of the corpus that can be read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use octray::geometry::csg::Lowering;
use octray::geometry::{SceneFrame, Sheet};
use octray::import::{Disk, Options, load};
use octray::scene::{Scene, Shape};

use crate::corpus::corpus;

/// A scene and what it is made of.
#[derive(Debug)]
pub(crate) struct Specimen {
    pub(crate) name: String,
    pub(crate) scene: Arc<Scene>,
    /// Primitives of solids, and triangles.
    pub(crate) primitives: usize,
    /// Whether the file holds a mesh and nothing else.
    pub(crate) is_mesh: bool,
}

/// Scenes, and the names of what is no scene with the reason.
#[derive(Debug, Default)]
pub(crate) struct Collection {
    pub(crate) specimens: Vec<Specimen>,
    pub(crate) skipped: Vec<String>,
}

/// Folders of the corpus with files that may be scenes or meshes.
const FOLDERS: [&str; 9] = [
    "brlcad", "cornell", "mesh", "obj", "openscad", "ply", "pov", "spd", "stl",
];
const SUFFIXES: [&str; 7] = ["asc", "csg", "nff", "obj", "ply", "pov", "stl"];
const MESHES: [&str; 3] = ["obj", "ply", "stl"];

impl Collection {
    /// Everything there is, in the order of the names.
    pub(crate) fn all() -> Self {
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut collection = Self::default();
        collection.add_folder(&own, "scenes");
        for folder in FOLDERS {
            if let Some(path) = corpus(folder) {
                collection.add_folder(&path, folder);
            }
        }
        collection
    }

    fn add_folder(&mut self, folder: &Path, name: &str) {
        let mut files = Vec::new();
        find(folder, &mut files);
        for path in files {
            let inner = path.strip_prefix(folder).unwrap_or(&path);
            self.add(&path, format!("{name}/{}", inner.display()));
        }
    }

    fn add(&mut self, path: &Path, name: String) {
        let imported = load(path, &Disk, &Options::default());
        let Some(scene) = imported.scene else {
            let first = imported.diagnostics.iter().next();
            let reason = first.map_or("nothing is said", |d| &d.message);
            self.skipped.push(format!("{name}: {reason}"));
            return;
        };
        self.specimens.push(Specimen {
            name,
            primitives: primitives(&scene),
            is_mesh: MESHES.contains(&suffix(path).as_str()),
            scene: Arc::new(scene),
        });
    }
}

fn suffix(path: &Path) -> String {
    path.extension()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// All files in a folder and below that may be scenes, in order.
fn find(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            find(&path, files);
        } else if SUFFIXES.contains(&suffix(&path).as_str()) {
            files.push(path);
        }
    }
}

fn primitives(scene: &Scene) -> usize {
    let mut lowering = Lowering::new(&SceneFrame::new(&scene.bounds())).with_operands();
    let mut triangles = 0;
    for object in scene.objects() {
        match &object.shape {
            Shape::Solid(solid) => drop(lowering.lower(solid)),
            Shape::Sheet(Sheet::Shell { solid, clip }) => {
                drop(lowering.lower(solid));
                drop(lowering.lower(clip));
            }
            Shape::Sheet(Sheet::Mesh { mesh, .. }) => triangles += mesh.triangles().len(),
            // No file has any.
            Shape::Instances(_) => {}
        }
    }
    let lowered = lowering.finish();
    let of_meshes = lowered.meshes.iter().map(|m| m.mesh.triangles().len());
    lowered.operands.len() + of_meshes.sum::<usize>() + triangles
}
