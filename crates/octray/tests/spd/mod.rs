//! The Standard Procedural Databases, rendered.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use octray_import::{Disk, Options, load};
use octray_render::{RenderConfig, Rendering, render};
use octray_scene::View;
use octray_world::{World, WorldConfig};

/// The folder of the databases, or `None` (said on the console) where there is none.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
pub(crate) fn databases() -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("OCTRAY_CORPUS").map_or(default, PathBuf::from);
    let folder = root.join("spd");
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}

/// Renders a file as it is, and says how its scene wants to be developed.
pub(crate) fn rendered(path: &Path, config: &RenderConfig) -> (Rendering, View) {
    let imported = load(path, &Disk, &Options::default());
    let scene = imported
        .scene
        .unwrap_or_else(|| panic!("{:?}", imported.diagnostics));
    let view = scene.settings().view;
    let world = World::prepare(Arc::new(scene), &WorldConfig::default()).expect("a world");
    (render(&world, None, config, &()).expect("a picture"), view)
}
