//! Every surface on a ray, of solids and sheets, for the interface that trimesh's users know.

use numpy::{IntoPyArray, PyArray1};
use octray::scene::ObjectId;
use octray::world::{Hit, World};
use pyo3::prelude::*;

use super::rows::{Method, Rays, each};
use crate::scene::Scene;

/// Ray, number of the face, and `t` of every crossing.
pub(crate) type Crossings<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
);

/// The first `limit` surfaces on each ray, ordered by ray and `t`. Faces are numbered through all
/// objects, the triangles of each as in its mesh.
pub(crate) fn crossings<'py>(
    scene: &Bound<'py, Scene>,
    rays: &Bound<'py, PyAny>,
    limit: Option<usize>,
    method: Method<'_>,
) -> PyResult<Crossings<'py>> {
    let py = scene.py();
    let rays = Rays::new("rays", rays, method.1)?;
    let (world, found) = rays.ask(scene, method, move |batch, rays| {
        let mut found: Vec<(i64, Hit)> = Vec::new();
        if limit == Some(1) {
            let hits = batch.closest(rays)?.into_iter().zip(0..);
            found.extend(hits.filter(|(h, _)| !h.is_miss()).map(|(h, ray)| (ray, h)));
        } else {
            let lists = batch.crossings(rays, false)?;
            for ray in 0..lists.len() {
                let hits = lists.of(ray).iter().take(limit.unwrap_or(usize::MAX));
                found.extend(hits.map(|hit| (ray as i64, *hit)));
            }
        }
        Ok(found)
    })?;
    let number = Numbering::new(&world);
    let index_ray = each(py, method.1, &found, |(ray, _)| *ray)?;
    let index_face = each(py, method.1, &found, |(_, hit)| number.of(hit))?;
    let t = each(py, method.1, &found, |(_, hit)| hit.t)?;
    Ok((
        index_ray.into_pyarray(py),
        index_face.into_pyarray(py),
        t.into_pyarray(py),
    ))
}

/// Faces numbered object by object.
struct Numbering<'a> {
    world: &'a World,
    first: Vec<i64>,
}

impl<'a> Numbering<'a> {
    fn new(world: &'a World) -> Self {
        let objects = 0..world.scene().objects().len() as u32;
        let mut next = 0;
        let first = objects
            .map(|object| {
                let first = next;
                next += i64::from(world.face_count(ObjectId(object)));
                first
            })
            .collect();
        Self { world, first }
    }

    fn of(&self, hit: &Hit) -> i64 {
        let number = self.world.face_in_object(hit.face);
        number.map_or(-1, |(object, number)| {
            self.first[object.0 as usize] + i64::from(number)
        })
    }
}
