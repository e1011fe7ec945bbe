//! The nearest surface on each ray.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use octray::world::{Batch, Hit, RayRow, World};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use super::rows::{Method, Rays, count_invalid};
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
    surface: PyOnceLock<Surface>,
}

/// What is computed only when someone asks, shape (..., 3) each.
struct Surface {
    positions: Py<PyArrayDyn<f64>>,
    normals: Py<PyArrayDyn<f64>>,
}

impl Hits {
    /// Positions and normals, computed when either is first asked for; NaN where there is no hit.
    fn surface(&self, py: Python<'_>) -> PyResult<&Surface> {
        self.surface.get_or_try_init(py, || {
            let hits = Arc::clone(&self.hits);
            let ask = move |batch: &Batch<'_>, rays: &[RayRow]| batch.surfaces(rays, &hits);
            let surfaces = self.rays.ask_world(py, &self.world, self.threads, ask)?;
            let array = |which: usize| -> PyResult<Py<PyArrayDyn<f64>>> {
                let vectors = surfaces.iter().map(|s| s[which].to_array()).collect();
                Ok(self.rays.shaped_vectors(py, vectors)?.unbind())
            };
            Ok(Surface {
                positions: array(0)?,
                normals: array(1)?,
            })
        })
    }

    fn ids<'py>(
        &self,
        py: Python<'py>,
        id: impl Fn(&Hit) -> Option<u32>,
    ) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let ids: Vec<i64> = self
            .hits
            .iter()
            .map(|hit| id(hit).filter(|_| !hit.is_miss()).map_or(-1, i64::from))
            .collect();
        self.rays.shaped(py, ids)
    }
}

#[pymethods]
impl Hits {
    /// Distances in units of the rays' directions, float64; infinite for a miss.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.rays
            .shaped(py, self.hits.iter().map(|hit| hit.t).collect())
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
        Ok(self.surface(py)?.normals.bind(py).clone())
    }

    /// Points of the surfaces, shape (..., 3); NaN for a miss.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        Ok(self.surface(py)?.positions.bind(py).clone())
    }

    /// Whether the ray met something, shape of `t`.
    #[getter]
    fn hit<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        self.rays
            .shaped(py, self.hits.iter().map(|hit| !hit.is_miss()).collect())
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
        let faces = self.hits.iter();
        let faces = faces.map(|hit| self.world.face_in_object(hit.face));
        let (geometries, primitives): (Vec<u32>, Vec<u32>) = faces
            .map(|face| face.map_or((OPEN3D_NONE, OPEN3D_NONE), |(object, n)| (object.0, n)))
            .unzip();
        let normals = self.normal(py)?.to_vec()?;
        let normals = normals
            .into_iter()
            .map(|x| if x.is_nan() { 0.0 } else { x });
        let mut shape = self.rays.shape.clone();
        shape.push(3);
        let normals = normals.collect::<Vec<f64>>().into_pyarray(py);
        let answers = PyDict::new(py);
        answers.set_item("t_hit", self.t(py)?)?;
        answers.set_item("geometry_ids", self.rays.shaped(py, geometries)?)?;
        answers.set_item("primitive_ids", self.rays.shaped(py, primitives)?)?;
        answers.set_item("primitive_normals", normals.reshape(shape.as_slice())?)?;
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
    let rays = Rays::new("rays", rays)?;
    let (world, hits) = rays.ask(scene, method, |batch, rays| batch.closest(rays))?;
    Ok(Hits {
        world,
        threads: method.1,
        rays,
        hits: Arc::new(hits),
        surface: PyOnceLock::new(),
    })
}
