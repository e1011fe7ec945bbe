//! Scene files into scenes.

use std::path::{Path, PathBuf};

use numpy::PyReadonlyArray1;
use octray::import::{Disk, Options};
use octray::scene;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::convert::value_error;
use crate::diagnostics::{Diagnostic, listed, scene_error};
use crate::image::os_error;
use crate::scene::Scene;
use crate::system::available_memory;
use crate::task;

/// Reads any supported file; says what was wrong beside the scene, or instead of it.
pub(crate) fn read(
    py: Python<'_>,
    path: &Path,
    facets: bool,
) -> PyResult<(scene::Scene, Vec<Diagnostic>)> {
    // What is not there or may not be read is an `OSError`, as everywhere in Python.
    std::fs::File::open(path).map_err(|error| os_error(path, &error))?;
    let mut options = Options {
        facets,
        ..Options::default()
    };
    if let Some(bytes) = available_memory() {
        options.memory_budget = options.memory_budget.min(bytes);
    }
    let path = path.to_owned();
    let imported = task::run(py, move |_| octray::import::load(&path, &Disk, &options))?;
    match imported.scene {
        Some(scene) => Ok((scene, listed(&imported.diagnostics))),
        None => Err(scene_error(py, &imported.diagnostics)),
    }
}

/// The scene in bytes or in an array of them.
pub(crate) fn from_bytes(py: Python<'_>, data: &Bound<'_, PyAny>) -> PyResult<scene::Scene> {
    let read = |bytes: &[u8]| py.detach(|| scene::Scene::from_bytes(bytes));
    let scene = if let Ok(bytes) = data.cast::<PyBytes>() {
        read(bytes.as_bytes())
    } else {
        let array: PyReadonlyArray1<'_, u8> = data.extract().map_err(|_| {
            PyTypeError::new_err("expected bytes or a one-dimensional array of uint8")
        })?;
        read(array.as_slice()?)
    };
    scene.map_err(value_error)
}

/// Reads a scene or mesh file. What it does not support is listed in `Scene.diagnostics`; what
/// makes a picture meaningless raises `SceneError`.
#[pyfunction]
#[pyo3(signature = (path, *, facets = false))]
#[expect(clippy::needless_pass_by_value, reason = "how PyO3 takes paths")]
pub(crate) fn load(py: Python<'_>, path: PathBuf, facets: bool) -> PyResult<Scene> {
    let (scene, diagnostics) = read(py, &path, facets)?;
    Ok(Scene::imported(scene, diagnostics))
}
