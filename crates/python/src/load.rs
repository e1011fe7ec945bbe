//! Scene files into scenes.

use std::path::{Path, PathBuf};

use octray::import::{Disk, FileSystem as _, Imported, Options, nff, obj, openscad, ply, pov, stl};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::diagnostics::{listed, scene_error};
use crate::scene::Scene;

fn import(path: &Path, options: &Options) -> std::io::Result<Imported> {
    let bytes = Disk.read(path, options.memory_budget)?;
    let suffix = path
        .extension()
        .and_then(|s| s.to_str())
        .unwrap_or_default();
    Ok(match suffix {
        "stl" => stl::import(path, bytes, &Disk, options),
        "ply" => ply::import(path, bytes, &Disk, options),
        "obj" => obj::import(path, bytes, &Disk, options),
        "nff" => nff::import(path, bytes, &Disk, options),
        "csg" => openscad::import(path, bytes, &Disk, options),
        _ => pov::import(path, bytes, &Disk, options),
    })
}

/// Reads a scene or mesh file. What it does not support is listed in `Scene.diagnostics`; what
/// makes a picture meaningless raises `SceneError`.
#[pyfunction]
#[pyo3(signature = (path, *, facets = false))]
pub(crate) fn load(py: Python<'_>, path: PathBuf, facets: bool) -> PyResult<Scene> {
    let options = Options {
        facets,
        ..Options::default()
    };
    let imported = py
        .detach(|| import(&path, &options))
        .map_err(|error| PyOSError::new_err(format!("{}: {error}", path.display())))?;
    match imported.scene {
        Some(scene) => Ok(Scene::imported(scene, listed(&imported.diagnostics))),
        None => Err(scene_error(py, &imported.diagnostics)),
    }
}
