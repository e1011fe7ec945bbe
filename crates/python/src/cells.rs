//! The cells of a structure as arrays.

use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use octray::world::{CellsOf, World, WorldCell};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::Triple;
use crate::scene::Scene;
use crate::world::prepared;

/// The leaves of an octree, or the voxels of a grid: one row each. Of `octree:lvsi` only those with
/// contents, which are all it stores.
#[pyclass(frozen, module = "octray")]
pub(crate) struct Cells {
    root: (Triple, Triple),
    cells: Vec<WorldCell>,
}

impl Cells {
    fn column<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&WorldCell) -> T,
    ) -> Bound<'py, PyArray1<T>> {
        self.cells
            .iter()
            .map(value)
            .collect::<Vec<T>>()
            .into_pyarray(py)
    }
}

#[pymethods]
impl Cells {
    /// The box that is divided: lowest corner, highest corner.
    #[getter]
    const fn root(&self) -> (Triple, Triple) {
        self.root
    }

    /// Lowest and highest corners in the scene's coordinates, shape (n, 2, 3).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let corners = |c: &WorldCell| [c.bounds.min.to_array(), c.bounds.max.to_array()];
        let flat: Vec<f64> = self.cells.iter().flat_map(corners).flatten().collect();
        flat.into_pyarray(py)
            .reshape([self.cells.len(), 2, 3].as_slice())
    }

    /// Depth, int64; 0 is the whole box. Of voxels 0.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.column(py, |cell| i64::from(cell.key.depth))
    }

    /// L, i, j, k of the Leveled Voxel Space Index, int64, shape (n, 4): depth, and the cell's place
    /// among the 2^L cells on each axis. Of a voxel 0 and its place among the grid's.
    #[getter]
    fn key<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let key = |c: &WorldCell| {
            let [i, j, k] = c.key.index;
            [c.key.depth, i, j, k].map(i64::from)
        };
        let flat: Vec<i64> = self.cells.iter().flat_map(key).collect();
        flat.into_pyarray(py)
            .reshape([self.cells.len(), 4].as_slice())
    }

    /// `"empty"` or `"occupied"`.
    #[getter]
    fn kind<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let numpy = py.import("numpy")?;
        let occupied = self.column(py, |cell| cell.objects.is_some());
        numpy.call_method1("where", (occupied, "occupied", "empty"))
    }

    /// How many objects a cell holds whose surface may pass through it, int64.
    #[getter]
    fn objects<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.column(py, |cell| i64::from(cell.objects.unwrap_or(0)))
    }

    /// How many surfaces (or triangles) may pass through a cell, int64.
    #[getter]
    fn parts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.column(py, |cell| i64::from(cell.parts))
    }

    fn __len__(&self) -> usize {
        self.cells.len()
    }

    fn __repr__(&self) -> String {
        format!("<octray.Cells of {} cells>", self.cells.len())
    }
}

fn list(world: &World, of: CellsOf) -> Option<Cells> {
    let root = world.root(of)?;
    let mut cells = Vec::new();
    world.visit_cells(of, |cell| cells.push(cell));
    Some(Cells {
        root: (root.min.into(), root.max.into()),
        cells,
    })
}

/// The cells that a method makes over the solids or the triangles of a scene.
pub(crate) fn cells(
    scene: &Bound<'_, Scene>,
    accel: &str,
    kind: &str,
    threads: Option<usize>,
) -> PyResult<Cells> {
    let of = match kind {
        "solids" => CellsOf::Solids,
        "triangles" => CellsOf::Triangles,
        other => {
            return Err(PyValueError::new_err(format!(
                "kind must be \"solids\" or \"triangles\", not {other:?}"
            )));
        }
    };
    let prepared = prepared(scene, accel, threads)?;
    let world = &prepared.world;
    if let Some(cells) = scene.py().detach(|| list(world, of)) {
        return Ok(cells);
    }
    let method = prepared.method;
    Err(PyValueError::new_err(if method.division().is_none() {
        format!("the method {method} divides no space into cells: use octree or grid")
    } else {
        format!("the method {method} makes no cells over {kind} of this scene")
    }))
}
