//! Rays as arrays in, answers as arrays out.

mod crossings;
mod hits;
mod intersections;
mod rows;

use numpy::PyArrayDyn;
use octray::world::{BatchError, Region};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::scene::Scene;
use rows::{Method, Rays, Rows};

pub(crate) use crossings::{Crossings, crossings};
pub(crate) use hits::{Hits, cast_rays};
pub(crate) use intersections::{Intersections, list_intersections};

/// How many boundaries each ray crosses.
pub(crate) fn count_intersections<'py>(
    scene: &Bound<'py, Scene>,
    rays: &Bound<'py, PyAny>,
    whole_line: bool,
    method: Method<'_>,
) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
    let rays = Rays::new("rays", rays, method.1)?;
    let (_, counts) = rays.ask(scene, method, move |batch, rays| {
        let counts = batch.count_crossings(rays, whole_line)?;
        Ok(counts.into_iter().map(|count| count as i64).collect())
    })?;
    rays.shaped(scene.py(), counts)
}

/// Whether each ray meets anything, transparent or not, before `far`.
pub(crate) fn test_occlusions<'py>(
    scene: &Bound<'py, Scene>,
    rays: &Bound<'py, PyAny>,
    far: f64,
    method: Method<'_>,
) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
    if far.is_nan() {
        return Err(PyValueError::new_err("tfar must be a number"));
    }
    let rays = Rays::new("rays", rays, method.1)?;
    let (_, met) = rays.ask(scene, method, move |batch, rays| batch.meets_any(rays, far))?;
    rays.shaped(scene.py(), met)
}

/// What `answer` makes of the region of each point.
fn regions<'py, T: numpy::Element + Send + 'static>(
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    method: Method<'_>,
    answer: impl Fn(Region) -> T + Send + 'static,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let points = Rows::<3>::new("points", points, method.1)?;
    let (_, values) = points.ask(scene, method, move |batch, points| {
        let regions = batch.regions(points)?;
        Ok::<_, BatchError>(regions.into_iter().map(answer).collect())
    })?;
    points.shaped(scene.py(), values)
}

/// Whether each point lies in a solid.
pub(crate) fn compute_occupancy<'py>(
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    method: Method<'_>,
) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
    regions(scene, points, method, |r| r != Region::OUTSIDE)
}

/// The object whose region each point belongs to.
pub(crate) fn locate<'py>(
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    method: Method<'_>,
) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
    regions(scene, points, method, |r| {
        r.object().map_or(-1, |object| i64::from(object.0))
    })
}

/// How many rays are none: not finite, or without direction.
pub(crate) fn count_invalid_rays(
    scene: &Bound<'_, Scene>,
    rays: &Bound<'_, PyAny>,
    method: Method<'_>,
) -> PyResult<usize> {
    let rays = Rays::new("rays", rays, method.1)?;
    let (world, ()) = rays.ask(scene, method, |_, _| Ok(()))?;
    Ok(rows::count_invalid(&world, &rays.numbers))
}
