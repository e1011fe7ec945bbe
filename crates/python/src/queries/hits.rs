//! Rays as arrays in, answers as arrays out.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use octray::math::{DVec3, Ray};
use octray::world::{Counters, Hit, RayQuery, World};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use rayon::prelude::*;

use crate::arrays::{Shape, real_array};
use crate::pool::pool;
use crate::scene::Scene;
use crate::task;
use crate::world::prepared;

/// Rays that one thread takes at a time.
const SLICE: usize = 1024;

/// Rays `(ox, oy, oz, dx, dy, dz)`, with the axes that stood before the last.
struct Rays {
    numbers: Arc<Vec<[f64; 6]>>,
    shape: Vec<usize>,
    far: f64,
}

fn query(ray: &[f64; 6], far: f64) -> RayQuery {
    let [ox, oy, oz, dx, dy, dz] = *ray;
    RayQuery {
        t_max: far,
        ..RayQuery::new(Ray::new(DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz)))
    }
}

impl Rays {
    fn new(rays: &Bound<'_, PyAny>, far: f64) -> PyResult<Self> {
        if far.is_nan() {
            return Err(PyValueError::new_err("tfar must be a number"));
        }
        let array = real_array("rays", rays, Shape::any(6))?;
        let mut shape = array.shape().to_vec();
        shape.pop();
        Ok(Self {
            numbers: Arc::new(array.as_slice()?.as_chunks::<6>().0.to_vec()),
            shape,
            far,
        })
    }

    /// `answer` for all rays in slices, by all threads; in order, whatever the threads do.
    fn answer<T: Send + 'static>(
        &self,
        scene: &Bound<'_, Scene>,
        (accel, threads): (&str, Option<usize>),
        answer: impl Fn(&World, &[RayQuery], &mut Vec<T>) + Send + Sync + 'static,
    ) -> PyResult<(Arc<World>, Vec<T>)> {
        let world = prepared(scene, accel, threads)?.world;
        let pool = pool(threads)?;
        let (shared, numbers, far) = (Arc::clone(&world), Arc::clone(&self.numbers), self.far);
        let one_slice = move |rays: &[[f64; 6]], cancel: &AtomicBool| {
            let mut answers = Vec::with_capacity(rays.len());
            if !cancel.load(Ordering::Relaxed) {
                let queries: Vec<RayQuery> = rays.iter().map(|ray| query(ray, far)).collect();
                answer(&shared, &queries, &mut answers);
            }
            answers
        };
        let py = scene.py();
        // A few rays are answered before a thread would have started.
        let answers = if numbers.len() <= SLICE {
            py.detach(|| one_slice(&numbers, &AtomicBool::new(false)))
        } else {
            task::run(py, move |cancel| {
                pool.install(|| {
                    let slices: Vec<Vec<T>> = numbers
                        .par_chunks(SLICE)
                        .map(|rays| one_slice(rays, cancel))
                        .collect();
                    slices.into_iter().flatten().collect()
                })
            })?
        };
        Ok((world, answers))
    }

    fn shaped<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        values: Vec<T>,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        values.into_pyarray(py).reshape(self.shape.as_slice())
    }
}

/// The nearest surface on each ray. Arrays have the rays' leading axes; a ray that meets nothing
/// has `t` infinite and ids -1.
#[pyclass(frozen, module = "octray")]
pub(crate) struct Hits {
    world: Arc<World>,
    rays: Rays,
    hits: Vec<Hit>,
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
            let (positions, normals): (Vec<[f64; 3]>, Vec<[f64; 3]>) = py.detach(|| {
                let nowhere = [f64::NAN; 3];
                let rays = self.rays.numbers.iter();
                rays.zip(&self.hits)
                    .map(|(ray, hit)| {
                        if hit.is_miss() {
                            return (nowhere, nowhere);
                        }
                        let surface = self.world.interact(&query(ray, self.rays.far), hit);
                        (surface.position.to_array(), surface.normal.to_array())
                    })
                    .unzip()
            });
            let mut shape = self.rays.shape.clone();
            shape.push(3);
            let array = |rows: Vec<[f64; 3]>| -> PyResult<Py<PyArrayDyn<f64>>> {
                let flat = rows.into_flattened().into_pyarray(py);
                Ok(flat.reshape(shape.as_slice())?.unbind())
            };
            Ok(Surface {
                positions: array(positions)?,
                normals: array(normals)?,
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
    method: (&str, Option<usize>),
) -> PyResult<Hits> {
    let rays = Rays::new(rays, f64::INFINITY)?;
    let (world, hits) = rays.answer(scene, method, |world, queries, hits| {
        world.closest(queries, hits, &mut Counters::default());
    })?;
    Ok(Hits {
        world,
        rays,
        hits,
        surface: PyOnceLock::new(),
    })
}

/// How many boundaries each ray crosses.
pub(crate) fn count_intersections<'py>(
    scene: &Bound<'py, Scene>,
    rays: &Bound<'py, PyAny>,
    method: (&str, Option<usize>),
) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
    let rays = Rays::new(rays, f64::INFINITY)?;
    let (_, counts) = rays.answer(scene, method, |world, queries, counts| {
        let mut crossings = Vec::new();
        for query in queries {
            world.crossings(query, false, &mut crossings, &mut Counters::default());
            counts.push(crossings.len() as i64);
        }
    })?;
    rays.shaped(scene.py(), counts)
}

/// Whether each ray meets anything, transparent or not, before `far`.
pub(crate) fn test_occlusions<'py>(
    scene: &Bound<'py, Scene>,
    rays: &Bound<'py, PyAny>,
    far: f64,
    method: (&str, Option<usize>),
) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
    let rays = Rays::new(rays, far)?;
    let (_, blocked) = rays.answer(scene, method, |world, queries, blocked| {
        let mut hits = Vec::new();
        world.closest(queries, &mut hits, &mut Counters::default());
        blocked.extend(hits.iter().map(|hit| !hit.is_miss()));
    })?;
    rays.shaped(scene.py(), blocked)
}
