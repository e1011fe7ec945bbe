//! The nearest surface on each ray.

use std::sync::Arc;

use numpy::PyArrayDyn;
use octray::math::DVec3;
use octray::scene::ObjectId;
use octray::world::{Batch, BatchError, Hit, RayRow, World};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use super::rows::{Method, Rays, count_invalid, each};
use crate::scene::Scene;

/// What Open3D writes where a ray meets nothing.
const OPEN3D_NONE: u32 = u32::MAX;

/// The nearest surface on each ray. Arrays have the rays' leading axes; a ray that meets nothing
/// has `t` infinite and ids -1.
#[pyclass(frozen, module = "octray")]
pub(crate) struct Hits {
    world: Arc<World>,
    threads: Option<usize>,
    rays: Rays,
    hits: Arc<Vec<Hit>>,
    // Computed when someone asks, shape (..., 3) each.
    positions: PyOnceLock<Py<PyArrayDyn<f64>>>,
    normals: PyOnceLock<Py<PyArrayDyn<f64>>>,
}

impl Hits {
    /// What `question` answers about all hits.
    fn vectors(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&Batch<'_>, &[RayRow], &[Hit]) -> Result<Vec<DVec3>, BatchError>
        + Send
        + 'static,
    ) -> PyResult<Vec<DVec3>> {
        let hits = Arc::clone(&self.hits);
        let ask = move |batch: &Batch<'_>, rays: &[RayRow]| question(batch, rays, &hits);
        self.rays.ask_world(py, &self.world, self.threads, ask)
    }

    /// Vectors as an array of shape (..., 3), each changed by `value`.
    fn shaped<'py>(
        &self,
        py: Python<'py>,
        vectors: &[DVec3],
        value: impl Fn(DVec3) -> DVec3 + Send + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let vectors = each(py, self.threads, vectors, |v| value(*v).to_array())?;
        self.rays.shaped_vectors(py, vectors)
    }

    /// What `value` says of every hit, in an array of the rays' shape.
    fn array<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&Hit) -> T + Send + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        self.rays
            .shaped(py, each(py, self.threads, &self.hits, value)?)
    }

    fn ids<'py>(
        &self,
        py: Python<'py>,
        id: impl Fn(&Hit) -> Option<u32> + Send + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        self.array(py, |hit| {
            id(hit).filter(|_| !hit.is_miss()).map_or(-1, i64::from)
        })
    }
}

#[pymethods]
impl Hits {
    /// Distances in units of the rays' directions, float64; infinite for a miss.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.array(py, |hit| hit.t)
    }

    /// Ids of the objects (indices into `Scene.names`), int64; -1 for a miss.
    #[getter]
    fn object_id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        self.ids(py, |hit| {
            self.world.owner(hit.face).map(|(object, _)| object.0)
        })
    }

    /// Which copy of its object each ray met, from 0, int64; -1 for a miss and where the object is
    /// not made of instances.
    #[getter]
    fn instance_id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        self.ids(py, |hit| {
            self.world.instance(hit.instance).map(|(_, copy)| copy)
        })
    }

    /// Ids of the faces, unique in the scene, int64; -1 for a miss.
    #[getter]
    fn face_id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        self.ids(py, |hit| Some(hit.face.0))
    }

    /// Unit normals that point out of the solid, shape (..., 3); NaN for a miss.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.normals.get_or_try_init(py, || {
            let normals = self.vectors(py, |batch, rays, hits| batch.normals(rays, hits))?;
            PyResult::Ok(self.shaped(py, &normals, |normal| normal)?.unbind())
        })?;
        Ok(made.bind(py).clone())
    }

    /// Points of the surfaces, shape (..., 3); NaN for a miss.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.positions.get_or_try_init(py, || {
            let positions = self.vectors(py, |batch, rays, hits| batch.positions(rays, hits))?;
            PyResult::Ok(self.shaped(py, &positions, |position| position)?.unbind())
        })?;
        Ok(made.bind(py).clone())
    }

    /// Whether the ray met something, shape of `t`.
    #[getter]
    fn hit<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        self.array(py, |hit| !hit.is_miss())
    }

    /// How many of the rays are none, and so miss: those with a NaN or an infinity, or without
    /// direction.
    #[getter]
    fn invalid_rays(&self, py: Python<'_>) -> usize {
        py.detach(|| count_invalid(&self.world, &self.rays.numbers))
    }

    /// A dictionary with the keys and conventions of Open3D's `RaycastingScene.cast_rays`: `t_hit`
    /// (float64, infinite for a miss), `geometry_ids` and `primitive_ids` (uint32, 4294967295 for a
    /// miss; a primitive is a triangle of its mesh or a face of its solid, counted from 0), and
    /// `primitive_normals` (float64, (..., 3), 0 for a miss). There are no `primitive_uvs`: exact
    /// surfaces have no triangles.
    fn to_open3d<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let faces = each(py, self.threads, &self.hits, |hit| {
            self.world.face_in_object(hit.face)
        })?;
        let column = |id: fn((ObjectId, u32)) -> u32| {
            let ids = each(py, self.threads, &faces, |face| {
                face.map_or(OPEN3D_NONE, id)
            })?;
            self.rays.shaped(py, ids)
        };
        let normals = self.vectors(py, |batch, rays, hits| batch.normals(rays, hits))?;
        let seen = |normal: DVec3| if normal.is_nan() { DVec3::ZERO } else { normal };
        let answers = PyDict::new(py);
        answers.set_item("t_hit", self.t(py)?)?;
        answers.set_item("geometry_ids", column(|(object, _)| object.0)?)?;
        answers.set_item("primitive_ids", column(|(_, number)| number)?)?;
        answers.set_item("primitive_normals", self.shaped(py, &normals, seen)?)?;
        Ok(answers)
    }

    fn __len__(&self) -> usize {
        self.hits.len()
    }

    fn __repr__(&self) -> String {
        let met = self.hits.iter().filter(|hit| !hit.is_miss()).count();
        format!("<octray.Hits {met} of {} rays>", self.hits.len())
    }
}

/// The nearest surface on each ray.
pub(crate) fn cast_rays(
    scene: &Bound<'_, Scene>,
    rays: &Bound<'_, PyAny>,
    method: Method<'_>,
) -> PyResult<Hits> {
    let rays = Rays::new("rays", rays, method.1)?;
    let (world, hits) = rays.ask(scene, method, |batch, rays| batch.closest(rays))?;
    Ok(Hits {
        world,
        threads: method.1,
        rays,
        hits: Arc::new(hits),
        positions: PyOnceLock::new(),
        normals: PyOnceLock::new(),
    })
}
