//! The scene made ready for rays, kept until the scene changes.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use octray::import::dress;
use octray::math::{Aabb, DVec3};
use octray::scene;
use octray::world::{
    CellList, CellListError, Method, MethodError, WideTreeError, World, WorldConfig, WorldError,
};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::building::usual;
use crate::diagnostics::invalid_scene;
use crate::files;
use crate::image::os_error;
use crate::pool::pool;
use crate::scene::Scene;
use crate::task;

/// A world, and how long it took to make it.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    pub(crate) world: Arc<World>,
    pub(crate) method: Method,
    pub(crate) duration: Duration,
}

/// The method of this name.
pub(crate) fn method_called(name: &str) -> PyResult<Method> {
    name.parse()
        .map_err(|error: MethodError| PyValueError::new_err(format!("accel: {error}")))
}

/// The names of all valid methods; a grid may also be given a number of voxels, as in `grid:64`.
#[pyfunction]
pub(crate) fn methods() -> Vec<String> {
    Method::all().iter().map(ToString::to_string).collect()
}

/// The full name of a method; refuses what is none.
#[pyfunction]
pub(crate) fn method_name(name: &str) -> PyResult<String> {
    method_called(name).map(|method| method.to_string())
}

/// The scene's world, made now unless it is still there from last time.
pub(crate) fn prepared(
    scene: &Bound<'_, Scene>,
    accel: &str,
    threads: Option<usize>,
) -> PyResult<Prepared> {
    let config = usual(accel)?;
    let known = scene.try_borrow()?.prepared(config.method).cloned();
    known.map_or_else(|| prepare(scene, config, None, threads), Ok)
}

/// The list of cells in a file.
pub(crate) fn read_cells(path: PathBuf) -> PyResult<(PathBuf, CellList)> {
    let bytes = std::fs::read(&path).map_err(|error| os_error(&path, &error))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        PyValueError::new_err(format!("{}: a list of cells is UTF-8 text", path.display()))
    })?;
    match CellList::parse(&text) {
        Ok(cells) => Ok((path, cells)),
        Err(error) => Err(unusable(&path, &error)),
    }
}

fn unusable(path: &Path, error: &CellListError) -> PyErr {
    PyValueError::new_err(format!("{}: {error}", path.display()))
}

/// Writes the cells of the octree over solids as a list.
pub(crate) fn write_cells(path: &Path, prepared: &Prepared) -> PyResult<()> {
    let list = prepared.world.cell_list().ok_or_else(|| {
        let method = prepared.method;
        PyValueError::new_err(format!(
            "`{method}` makes no octree over solids of this scene"
        ))
    })?;
    files::replace(path, list.to_string().as_bytes()).map_err(|error| os_error(path, &error))
}

/// The scene's world, made now and kept for the queries to come; along a list of cells if there is
/// one.
pub(crate) fn prepare(
    scene: &Bound<'_, Scene>,
    config: WorldConfig,
    cells: Option<(PathBuf, CellList)>,
    threads: Option<usize>,
) -> PyResult<Prepared> {
    let py = scene.py();
    let method = config.method;
    let pool = pool(threads)?;
    let (plain, revision) = {
        let scene = scene.try_borrow()?;
        (scene.complete(py)?, scene.revision())
    };
    let (path, cells) = cells.unzip();
    let start = Instant::now();
    let world = task::run(py, move |_| {
        pool.install(|| match &cells {
            Some(cells) => World::prepare_from_cells(Arc::new(plain), &config, cells),
            None => World::prepare(Arc::new(plain), &config),
        })
    })
    .inspect_err(|_| crate::pool::discard())?;
    let world = world.map_err(|error| match error {
        WorldError::Cells(error) => unusable(&path.unwrap_or_default(), &error),
        WorldError::Triangles(WideTreeError::Memory { .. })
        | WorldError::Instances(WideTreeError::Memory { .. }) => {
            PyMemoryError::new_err(error.to_string())
        }
        error => invalid_scene(py, &[error]),
    })?;
    let prepared = Prepared {
        world: Arc::new(world),
        method,
        duration: start.elapsed(),
    };
    let mut scene = scene
        .try_borrow_mut()
        .map_err(|_| PyRuntimeError::new_err("the scene is in use by another thread"))?;
    if scene.revision() == revision {
        scene.keep(prepared.clone());
    }
    Ok(prepared)
}

/// The scene with a camera, and, if `dressed` and it has no lights, with lights about it and a
/// background where it has none.
pub(crate) fn completed(scene: scene::Scene, dressed: bool) -> scene::Scene {
    let own_background =
        (*scene.background() != scene::Background::default()).then(|| scene.background().clone());
    let up = scene.settings().up;
    let mut scene = scene;
    if scene.camera().is_none() && dress::view_scene(&scene).is_none() {
        // Nothing to look at, or nothing bounded: look at the middle of the world.
        let middle = Aabb::new(DVec3::splat(-1.0), DVec3::ONE);
        if let Some(camera) = dress::view_all(&middle, up) {
            let mut builder = scene.clone().into_builder();
            builder.set_camera(camera);
            scene = builder.build().unwrap_or(scene);
        }
    }
    if !dressed {
        return dress::add_camera(scene);
    }
    let scene = dress::dress(scene);
    let Some(background) = own_background else {
        return scene;
    };
    let mut builder = scene.clone().into_builder();
    builder.set_background(background);
    builder.build().unwrap_or(scene)
}
