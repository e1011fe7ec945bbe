//! Rays and points as arrays, and their way through the threads.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use octray::world::{Batch, BatchError, RayRow, World, row_query};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Reals, Shape, reals};
use crate::pool::pool;
use crate::scene::Scene;
use crate::task;
use crate::world::prepared;

/// Below this many, rows are answered before a thread would have started.
const FEW: usize = 1024;
/// Up to this many, answers are put into arrays before a thread would have woken up.
const MANY: usize = 16 * FEW;

/// How to answer: the name of the accelerator, and how many threads.
pub(crate) type Method<'a> = (&'a str, Option<usize>);

/// Rows of `W` numbers, with the axes that stood before the last.
#[derive(Clone)]
pub(crate) struct Rows<const W: usize> {
    pub(crate) numbers: Arc<Vec<[f64; W]>>,
    pub(crate) shape: Vec<usize>,
}

/// `(ox, oy, oz, dx, dy, dz)`.
pub(crate) type Rays = Rows<6>;

impl<const W: usize> Rows<W> {
    /// Copies an array, with the threads that will answer.
    pub(crate) fn new(
        what: &str,
        rows: &Bound<'_, PyAny>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let py = rows.py();
        let (numbers, mut shape) = match reals(what, rows, Shape::any(W))? {
            Reals::Single(array) => {
                let rows = array.as_slice()?.as_chunks::<W>().0;
                let numbers = each(py, threads, rows, |row| row.map(f64::from))?;
                (numbers, array.shape().to_vec())
            }
            Reals::Double(array) => {
                let rows = array.as_slice()?.as_chunks::<W>().0;
                (each(py, threads, rows, |row| *row)?, array.shape().to_vec())
            }
        };
        shape.pop();
        let numbers = Arc::new(numbers);
        Ok(Self { numbers, shape })
    }

    /// What `question` answers for all rows, in the scene as it stands.
    pub(crate) fn ask<T: Send + 'static>(
        &self,
        scene: &Bound<'_, Scene>,
        (accel, threads): Method<'_>,
        question: impl FnOnce(&Batch<'_>, &[[f64; W]]) -> Result<T, BatchError> + Send + 'static,
    ) -> PyResult<(Arc<World>, T)> {
        let world = prepared(scene, accel, threads)?.world;
        let answers = self.ask_world(scene.py(), &world, threads, question)?;
        Ok((world, answers))
    }

    /// The same of a world that is there already.
    pub(crate) fn ask_world<T: Send + 'static>(
        &self,
        py: Python<'_>,
        world: &Arc<World>,
        threads: Option<usize>,
        question: impl FnOnce(&Batch<'_>, &[[f64; W]]) -> Result<T, BatchError> + Send + 'static,
    ) -> PyResult<T> {
        let pool = pool(threads)?;
        let (numbers, world) = (Arc::clone(&self.numbers), Arc::clone(world));
        let answers = if numbers.len() <= FEW {
            py.detach(|| question(&world.batch(&AtomicBool::new(false)), &numbers))
        } else {
            task::run(py, move |cancel| {
                pool.install(|| question(&world.batch(cancel), &numbers))
            })?
        };
        answers.map_err(|error| match error {
            BatchError::OutOfMemory => PyMemoryError::new_err(error.to_string()),
            BatchError::Cancelled => PyRuntimeError::new_err(error.to_string()),
        })
    }

    /// One value for each row, in an array of the rows' shape.
    pub(crate) fn shaped<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        values: Vec<T>,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        values.into_pyarray(py).reshape(self.shape.as_slice())
    }

    /// Three numbers for each row.
    pub(crate) fn shaped_vectors<'py>(
        &self,
        py: Python<'py>,
        vectors: Vec<[f64; 3]>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let mut shape = self.shape.clone();
        shape.push(3);
        let flat = vectors.into_flattened().into_pyarray(py);
        flat.reshape(shape.as_slice())
    }
}

/// What `value` says of every item, in order; by the threads of the pool where there are many, for
/// most of the time goes into fetching new memory.
pub(crate) fn each<S: Sync, T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    items: &[S],
    value: impl Fn(&S) -> T + Send + Sync,
) -> PyResult<Vec<T>> {
    if items.len() <= MANY {
        return Ok(items.iter().map(value).collect());
    }
    let pool = pool(threads)?;
    if pool.current_num_threads() == 1 {
        return Ok(items.iter().map(value).collect());
    }
    let parts = items.par_iter().with_min_len(FEW);
    Ok(py.detach(|| pool.install(|| parts.map(value).collect())))
}

/// How many of the rays are none: not finite, or without direction.
pub(crate) fn count_invalid(world: &World, rays: &[RayRow]) -> usize {
    let is_none = |ray: &&RayRow| !world.is_ray(&row_query(ray, f64::INFINITY));
    rays.iter().filter(is_none).count()
}
