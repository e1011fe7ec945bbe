//! Every stretch of every ray inside every solid.

use std::sync::Arc;

use numpy::{Element, IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use octray::geometry::FaceId;
use octray::math::DVec3;
use octray::world::{Batch, Chord, ChordEnd, Lists, Overlaps, RayRow, World};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PySlice, PySliceMethods};

use super::rows::{Method, Rays, count_invalid};
use crate::scene::Scene;

/// An array that is made when it is first asked for.
type Made<A> = PyOnceLock<Py<A>>;

/// The intervals of rays inside solids, as flat arrays ordered by ray and then by `t_enter`; those
/// of ray `i` (of `rays.reshape(-1, 6)`) stand at `offsets[i]:offsets[i + 1]`. `len()` is the number of
/// rays. `result[i]` is the same for one ray alone, `result[i:j]` for several.
#[pyclass(frozen, module = "octray")]
pub(crate) struct Intersections {
    world: Arc<World>,
    threads: Option<usize>,
    rays: Rays,
    chords: Arc<Lists<Chord>>,
    made: Arrays,
}

struct Arrays {
    offsets: Made<PyArray1<i64>>,
    counts: Made<PyArrayDyn<i64>>,
    ray_id: Made<PyArray1<i64>>,
    t_enter: Made<PyArray1<f64>>,
    t_exit: Made<PyArray1<f64>>,
    lengths: Made<PyArray1<f64>>,
    object_id: Made<PyArray1<i64>>,
    instance_id: Made<PyArray1<i64>>,
    material_id: Made<PyArray1<i64>>,
    face_enter: Made<PyArray1<i64>>,
    face_exit: Made<PyArray1<i64>>,
    normals: PyOnceLock<[Py<PyArrayDyn<f64>>; 2]>,
}

impl Arrays {
    const fn none() -> Self {
        Self {
            offsets: PyOnceLock::new(),
            counts: PyOnceLock::new(),
            ray_id: PyOnceLock::new(),
            t_enter: PyOnceLock::new(),
            t_exit: PyOnceLock::new(),
            lengths: PyOnceLock::new(),
            object_id: PyOnceLock::new(),
            instance_id: PyOnceLock::new(),
            material_id: PyOnceLock::new(),
            face_enter: PyOnceLock::new(),
            face_exit: PyOnceLock::new(),
            normals: PyOnceLock::new(),
        }
    }
}

/// The array in `place`, which is made of `values` first if need be.
fn made<'py, T: Element + Send>(
    py: Python<'py>,
    place: &Made<PyArray1<T>>,
    values: impl FnOnce() -> Vec<T> + Send,
) -> Bound<'py, PyArray1<T>> {
    let make = || py.detach(values).into_pyarray(py).unbind();
    place.get_or_init(py, make).bind(py).clone()
}

const fn face_number(end: &ChordEnd) -> i64 {
    match end.face {
        FaceId::NONE => -1,
        FaceId(number) => number as i64,
    }
}

/// The Euclidean length of a ray's direction; neither overflows nor vanishes on the way.
fn direction_length(ray: &RayRow) -> f64 {
    let direction = DVec3::new(ray[3], ray[4], ray[5]);
    let largest = direction.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        largest * (direction / largest).length()
    } else {
        0.0
    }
}

impl Intersections {
    fn items(&self) -> &[Chord] {
        &self.chords.items
    }

    /// One value for each interval.
    fn each<T>(&self, value: impl Fn(&Chord) -> T) -> Vec<T> {
        self.items().iter().map(value).collect()
    }

    fn material_of(&self, chord: &Chord) -> u32 {
        let objects = self.world.scene().objects();
        objects[chord.object.0 as usize].material.0
    }

    fn true_lengths(&self) -> Vec<f64> {
        let mut lengths = Vec::with_capacity(self.items().len());
        for (i, ray) in self.rays.numbers.iter().enumerate() {
            let unit = direction_length(ray);
            lengths.extend(self.chords.of(i).iter().map(|c| c.length() * unit));
        }
        lengths
    }

    fn normals(&self, py: Python<'_>) -> PyResult<&[Py<PyArrayDyn<f64>>; 2]> {
        self.made.normals.get_or_try_init(py, || {
            let chords = Arc::clone(&self.chords);
            let ask = move |batch: &Batch<'_>, rays: &[RayRow]| batch.chord_normals(rays, &chords);
            let normals = self.rays.ask_world(py, &self.world, self.threads, ask)?;
            let array = |which: usize| -> PyResult<Py<PyArrayDyn<f64>>> {
                let numbers = normals.items.iter().flat_map(|n| n[which].to_array());
                let flat: Vec<f64> = numbers.collect();
                let shape = [normals.items.len(), 3];
                Ok(flat.into_pyarray(py).reshape(shape.as_slice())?.unbind())
            };
            Ok([array(0)?, array(1)?])
        })
    }

    /// The intersections of these rays alone.
    fn part(&self, rays: impl Iterator<Item = usize>) -> Self {
        let mut chords = Lists {
            offsets: vec![0],
            items: Vec::new(),
        };
        let mut numbers = Vec::new();
        for ray in rays {
            numbers.push(self.rays.numbers[ray]);
            chords.items.extend_from_slice(self.chords.of(ray));
            chords.offsets.push(chords.items.len() as u64);
        }
        Self {
            world: Arc::clone(&self.world),
            threads: self.threads,
            rays: Rays {
                shape: vec![numbers.len()],
                numbers: Arc::new(numbers),
            },
            chords: Arc::new(chords),
            made: Arrays::none(),
        }
    }
}

#[pymethods]
impl Intersections {
    /// Where the intervals of each ray begin, and at last how many there are: int64, (N + 1,).
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let offsets = &self.chords.offsets;
        made(py, &self.made.offsets, || {
            offsets.iter().map(|&o| o as i64).collect()
        })
    }

    /// How many intervals each ray has, int64, with the rays' leading axes.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let make = || -> PyResult<_> {
            let ends = self.chords.offsets.windows(2);
            let counts = ends.map(|w| (w[1] - w[0]) as i64).collect();
            Ok(self.rays.shaped(py, counts)?.unbind())
        };
        let counts = self.made.counts.get_or_try_init(py, make)?;
        Ok(counts.bind(py).clone())
    }

    /// The ray of each interval, int64, (M,).
    #[getter]
    fn ray_id<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.ray_id, || {
            let lengths = self.chords.offsets.windows(2).map(|w| w[1] - w[0]);
            let ids = (0_i64..).zip(lengths);
            ids.flat_map(|(id, n)| std::iter::repeat_n(id, n as usize))
                .collect()
        })
    }

    /// Where each interval begins, in units of the ray's direction: float64, (M,). 0 where the ray
    /// starts inside; -inf on a whole line that comes from infinitely far.
    #[getter]
    fn t_enter<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        made(py, &self.made.t_enter, || self.each(|c| c.enter.t))
    }

    /// Where each interval ends, in units of the ray's direction: float64, (M,). Infinite where the
    /// ray never leaves.
    #[getter]
    fn t_exit<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        made(py, &self.made.t_exit, || self.each(|c| c.exit.t))
    }

    /// How long each interval is, in the scene's unit of length: (t_exit - t_enter) times the length
    /// of the direction. float64, (M,).
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        made(py, &self.made.lengths, || self.true_lengths())
    }

    /// The solid of each interval, an index into `Scene.names`: int64, (M,).
    #[getter]
    fn object_id<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.object_id, || {
            self.each(|c| i64::from(c.object.0))
        })
    }

    /// Which copy of its object the solid is, from 0; -1 where the object is not made of instances:
    /// int64, (M,).
    #[getter]
    fn instance_id<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.instance_id, || {
            self.each(|c| {
                let copy = self.world.instance(c.instance);
                copy.map_or(-1, |(_, copy)| i64::from(copy))
            })
        })
    }

    /// The material that fills the solid, an index into `Scene.material_names`: int64, (M,).
    #[getter]
    fn material_id<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.material_id, || {
            self.each(|c| i64::from(self.material_of(c)))
        })
    }

    /// The face that is crossed where each interval begins: int64, (M,); -1 where the ray starts
    /// inside.
    #[getter]
    fn face_enter<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.face_enter, || {
            self.each(|c| face_number(&c.enter))
        })
    }

    /// The face that is crossed where each interval ends: int64, (M,); -1 where the ray never leaves.
    #[getter]
    fn face_exit<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        made(py, &self.made.face_exit, || {
            self.each(|c| face_number(&c.exit))
        })
    }

    /// Unit normals where the intervals begin, out of the solid (or of what others leave of it):
    /// float64, (M, 3); NaN where no face is crossed. Computed when first asked for.
    #[getter]
    fn normal_enter<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        Ok(self.normals(py)?[0].bind(py).clone())
    }

    /// Unit normals where the intervals end, as `normal_enter`.
    #[getter]
    fn normal_exit<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        Ok(self.normals(py)?[1].bind(py).clone())
    }

    /// How many of the rays are none, and so have no intervals: those with a NaN or an infinity, or
    /// without direction.
    #[getter]
    fn invalid_rays(&self, py: Python<'_>) -> usize {
        py.detach(|| count_invalid(&self.world, &self.rays.numbers))
    }

    /// How far each ray goes through each object (or each material, with by="material"), in the
    /// scene's unit of length: float64, the rays' leading axes and one more, over the objects of
    /// the scene. ValueError if `by` is something else.
    #[pyo3(signature = (by = "object"))]
    fn path_lengths<'py>(
        &self,
        py: Python<'py>,
        by: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let scene = self.world.scene();
        let by_material = match by {
            "object" => false,
            "material" => true,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "by must be \"object\" or \"material\", not {by:?}"
                )));
            }
        };
        let columns = if by_material {
            scene.materials().len()
        } else {
            scene.objects().len()
        };
        let mut shape = self.rays.shape.clone();
        shape.push(columns);
        // NumPy raises MemoryError where it does not fit.
        let zeros = py.import("numpy")?.call_method1("zeros", (shape,))?;
        let sums = zeros.cast_into::<PyArrayDyn<f64>>()?;
        let mut writable = sums.try_readwrite()?;
        let numbers = writable.as_slice_mut()?;
        for (i, ray) in self.rays.numbers.iter().enumerate() {
            let unit = direction_length(ray);
            for chord in self.chords.of(i) {
                let column = if by_material {
                    self.material_of(chord)
                } else {
                    chord.object.0
                };
                numbers[i * columns + column as usize] += chord.length() * unit;
            }
        }
        drop(writable);
        Ok(sums)
    }

    fn __len__(&self) -> usize {
        self.chords.len()
    }

    fn __iter__(slf: &Bound<'_, Self>) -> EachRay {
        EachRay {
            all: slf.clone().unbind(),
            next: 0,
        }
    }

    fn __getitem__(&self, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let count = self.chords.len();
        if let Ok(slice) = key.cast::<PySlice>() {
            let indices = slice.indices(count as isize)?;
            let place = |i: usize| (indices.start + i as isize * indices.step) as usize;
            return Ok(self.part((0..indices.slicelength).map(place)));
        }
        let index: isize = key.extract().map_err(|_| {
            PyTypeError::new_err("the index of a ray is an integer, or a slice of integers")
        })?;
        let from_start = if index < 0 {
            index + count as isize
        } else {
            index
        };
        if !(0..count as isize).contains(&from_start) {
            return Err(PyIndexError::new_err(format!(
                "there is no ray {index} among {count}"
            )));
        }
        Ok(self.part(std::iter::once(from_start as usize)))
    }

    fn __repr__(&self) -> String {
        format!(
            "<octray.Intersections {} intervals of {} rays>",
            self.items().len(),
            self.chords.len()
        )
    }
}

/// Goes through the rays one by one.
#[pyclass(module = "octray")]
struct EachRay {
    all: Py<Intersections>,
    next: usize,
}

#[pymethods]
impl EachRay {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&mut self) -> Option<Intersections> {
        let all = self.all.get();
        (self.next < all.chords.len()).then(|| {
            self.next += 1;
            all.part(std::iter::once(self.next - 1))
        })
    }
}

/// Whose intervals are listed where solids overlap.
fn overlaps_named(name: &str) -> PyResult<Overlaps> {
    match name {
        "regions" => Ok(Overlaps::Regions),
        "priorities" => Ok(Overlaps::Priorities),
        "objects" => Ok(Overlaps::Objects),
        _ => Err(PyValueError::new_err(format!(
            "overlaps must be \"regions\", \"priorities\" or \"objects\", not {name:?}"
        ))),
    }
}

/// Every interval of every ray.
pub(crate) fn list_intersections(
    scene: &Bound<'_, Scene>,
    rays: &Bound<'_, PyAny>,
    whole_line: bool,
    overlaps: &str,
    method: Method<'_>,
) -> PyResult<Intersections> {
    let overlaps = overlaps_named(overlaps)?;
    let rays = Rays::new("rays", rays, method.1)?;
    let ask = move |batch: &Batch<'_>, rays: &[RayRow]| batch.chords(rays, whole_line, overlaps);
    let (world, chords) = rays.ask(scene, method, ask)?;
    Ok(Intersections {
        world,
        threads: method.1,
        rays,
        chords: Arc::new(chords),
        made: Arrays::none(),
    })
}
