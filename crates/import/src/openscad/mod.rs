//! OpenSCAD's .csg dumps.

use std::path::Path;

use crate::{FileSystem, Imported, Options};

/// Reads the bytes of the file `path`; other files it names come from `files`.
#[must_use]
pub fn import(
    path: &Path,
    bytes: Vec<u8>,
    _files: &dyn FileSystem,
    _options: &Options,
) -> Imported {
    let mut diagnostics = crate::Diagnostics::default();
    diagnostics.add_source(path, bytes);
    diagnostics.error(None, "this format is not read yet");
    Imported {
        scene: None,
        diagnostics,
    }
}
