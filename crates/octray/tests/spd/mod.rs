//! The Standard Procedural Databases, rendered.

use std::path::Path;
use std::sync::Arc;

use octray_import::{Disk, Options, load};
use octray_render::{RenderConfig, Rendering, render};
use octray_scene::View;
use octray_world::{World, WorldConfig};

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
