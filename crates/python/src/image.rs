//! Pictures.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use octray::render::{self, encode_exr, encode_png};
use octray::scene::View;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::convert::value_error;
use crate::files;

/// A picture in linear light.
#[pyclass(frozen, module = "octray")]
#[derive(Debug)]
pub(crate) struct Image {
    inner: Arc<render::Image>,
    /// What a PNG shows, if that is not `inner` developed.
    heat: Option<Arc<render::Image>>,
    view: View,
    complete: bool,
    report: Option<Py<PyDict>>,
}

/// The view of this name.
pub(crate) fn view_named(name: &str) -> PyResult<View> {
    match name {
        "neutral" => Ok(View::Neutral),
        "standard" => Ok(View::Standard),
        "raw" => Ok(View::Raw),
        _ => Err(PyValueError::new_err(format!(
            "view must be \"neutral\", \"standard\" or \"raw\", not {name:?}"
        ))),
    }
}

impl Image {
    pub(crate) fn new(
        inner: render::Image,
        view: View,
        complete: bool,
        report: Option<Py<PyDict>>,
    ) -> Self {
        Self {
            inner: Arc::new(inner),
            heat: None,
            view,
            complete,
            report,
        }
    }

    /// The same with a heat map as what a PNG shows.
    pub(crate) fn with_heat(self, heat: render::Image) -> Self {
        let heat = Some(Arc::new(heat));
        Self { heat, ..self }
    }

    fn encoded(&self, py: Python<'_>, format: &str, view: Option<&str>) -> PyResult<Vec<u8>> {
        let view = view.map(view_named).transpose()?;
        let inner = Arc::clone(&self.inner);
        let encoded = match (format, &self.heat) {
            ("png", Some(_)) if view.is_some() => {
                return Err(PyValueError::new_err(
                    "a picture of costs is no light: it has one heat map and no view",
                ));
            }
            ("png", Some(heat)) => {
                let heat = Arc::clone(heat);
                py.detach(|| encode_png(&heat, View::Raw))
            }
            ("png", None) => py.detach(|| encode_png(&inner, view.unwrap_or(self.view))),
            ("exr", _) => py.detach(|| encode_exr(&inner)),
            _ => {
                return Err(PyValueError::new_err(format!(
                    "pictures are written as png or exr, not as {format:?}"
                )));
            }
        };
        encoded.map_err(value_error)
    }
}

#[pymethods]
impl Image {
    /// Width in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.inner.width()
    }

    /// Height in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.inner.height()
    }

    /// Width and height in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.inner.width(), self.inner.height())
    }

    /// Whether every pixel is finished; `False` after an interruption.
    #[getter]
    fn complete(&self) -> bool {
        self.complete
    }

    /// What the rendering cost: times, rays, trees, memory.
    ///
    /// `rays` and `hits` count by kind of ray: `primary`, `reflected`, `refracted`, `shadow`, and
    /// `total`. `tests_per_ray` says what one ray cost on average: `cells` of the solids' octree or
    /// grid entered (or bounding volumes tested), `lookups` of hash rows or tree nodes to find them,
    /// `nodes` of the triangles' octree entered, `surfaces` and `triangles` intersected.
    /// `tests_by_kind` says the same for each kind, with the number of its `rays`: the sums over the
    /// kinds of rays times tests are those of `tests_per_ray`. A shadow ray counts once, its tests
    /// behind transparent surfaces included.
    ///
    /// A picture of costs (`integrator="cost"`) has `cost`: what a step, a surface and a triangle weigh in
    /// its heat map (`weights`), and the weighted costs of a sample (1 is the time of one surface's test)
    /// at the ends of the scale: `low` is black, `high`, which 99.5 % of the pixels do not exceed, the
    /// brightest. For others it is `None`.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        match &self.report {
            Some(report) => report.bind(py).copy(),
            None => Ok(PyDict::new(py)),
        }
    }

    /// Linear light as a float32 array of shape (height, width, 3), row 0 at the top. Of a picture of
    /// costs: per sample, the steps (cells, nodes, look-ups), the surfaces and the triangles tested.
    fn to_numpy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let shape = [self.inner.height() as usize, self.inner.width() as usize, 3];
        let numbers = self.inner.pixels().as_flattened().to_vec();
        numbers.into_pyarray(py).reshape(shape)
    }

    /// NumPy's protocol: `np.asarray(image)`.
    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if copy == Some(false) {
            return Err(PyValueError::new_err(
                "a picture is always copied into an array",
            ));
        }
        let array = self.to_numpy(py)?.into_any();
        match dtype {
            Some(dtype) if !dtype.is_none() => array.call_method1("astype", (dtype,)),
            _ => Ok(array),
        }
    }

    /// The bytes of a PNG (8 bit, developed by `view`) or EXR (32-bit float, linear) file.
    #[pyo3(signature = (format = "png", *, view = None))]
    fn to_bytes<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        view: Option<&str>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.encoded(py, format, view)?))
    }

    /// Writes a PNG or EXR file, told by the suffix. The file appears complete or not at all.
    #[pyo3(signature = (path, *, view = None))]
    #[expect(clippy::needless_pass_by_value, reason = "how PyO3 takes paths")]
    fn save(&self, py: Python<'_>, path: PathBuf, view: Option<&str>) -> PyResult<()> {
        let suffix = path.extension().unwrap_or_default().to_string_lossy();
        let format = suffix.to_ascii_lowercase();
        if !matches!(format.as_str(), "png" | "exr") {
            return Err(PyValueError::new_err(format!(
                "{}: the name must end in .png or .exr",
                path.display()
            )));
        }
        let bytes = self.encoded(py, &format, view)?;
        py.detach(|| files::replace(&path, &bytes))
            .map_err(|error| os_error(&path, &error))
    }

    /// Notebooks show this.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.to_bytes(py, "png", None)
    }

    /// Whether both pictures have the same size and the same bits.
    fn equals(&self, other: &Self) -> bool {
        let bits = |image: &render::Image| -> Vec<u32> {
            let numbers = image.pixels().as_flattened();
            numbers.iter().map(|x| x.to_bits()).collect()
        };
        self.size() == other.size() && bits(&self.inner) == bits(&other.inner)
    }

    fn __repr__(&self) -> String {
        let state = if self.complete { "" } else { ", unfinished" };
        format!(
            "<octray.Image {}x{}{state}>",
            self.inner.width(),
            self.inner.height()
        )
    }
}

/// Python's own exception for a failed call to the system, with the file's name.
pub(crate) fn os_error(path: &std::path::Path, error: &std::io::Error) -> PyErr {
    let text = error.to_string();
    // `No such file or directory (os error 2)`: Python writes the number itself.
    let reason = text.split(" (os error").next().unwrap_or_default();
    // With a number, `OSError` becomes `FileNotFoundError`, `PermissionError` and so on.
    match error.raw_os_error() {
        Some(number) => pyo3::exceptions::PyOSError::new_err((
            number,
            reason.to_owned(),
            path.as_os_str().to_owned(),
        )),
        None => pyo3::exceptions::PyOSError::new_err(format!("{}: {reason}", path.display())),
    }
}
