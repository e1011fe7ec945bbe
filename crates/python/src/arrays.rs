//! NumPy arrays in: shapes and kinds are checked here, and named when they are wrong.

use numpy::{
    PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

/// What an array may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Real,
    Integer,
}

/// `(3, 4)` as Python shows it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// Which shapes an array may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// The length of the last axis.
    pub(crate) width: usize,
    /// What stands before it: `"..."` for any axes, else the name of the only one.
    pub(crate) leading: &'static str,
}

impl Shape {
    /// Shape `(..., width)`.
    pub(crate) const fn any(width: usize) -> Self {
        let leading = "...";
        Self { width, leading }
    }

    /// Shape `(name, width)`.
    pub(crate) const fn rows(leading: &'static str, width: usize) -> Self {
        Self { width, leading }
    }

    fn fits(self, shape: &[usize]) -> bool {
        shape.last() == Some(&self.width) && (self.leading == "..." || shape.len() == 2)
    }
}

/// `object` as an array; a wrong shape or kind is a `ValueError` that says what was expected and what
/// came. An empty list has no shape of its own and counts as no rows.
fn checked<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    kind: Kind,
    wanted: Shape,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = object.py();
    let numpy = py.import("numpy")?;
    let expected = |found: String| {
        let numbers = match kind {
            Kind::Real => "real numbers",
            Kind::Integer => "integers",
        };
        PyValueError::new_err(format!(
            "{what} must be an array of {numbers} of shape ({}, {}), not {found}",
            wanted.leading, wanted.width
        ))
    };
    let array = numpy
        .call_method1("asarray", (object,))
        .map_err(|_| expected("a ragged sequence".to_owned()))?;
    let untyped = array.cast::<PyUntypedArray>()?;
    let shape = untyped.shape().to_vec();
    let dtype = untyped.dtype();
    let empty = shape.contains(&0);
    let good = match dtype.kind() {
        b'f' => kind == Kind::Real || empty,
        b'i' | b'u' => true,
        _ => false,
    };
    if !good {
        return Err(expected(format!("dtype {dtype}")));
    }
    if shape == [0] {
        let array = array.call_method1("reshape", ((0, wanted.width),))?;
        Ok(array.cast_into::<PyUntypedArray>()?)
    } else if wanted.fits(&shape) {
        Ok(array.cast_into::<PyUntypedArray>()?)
    } else {
        Err(expected(format!("shape {}", shape_text(&shape))))
    }
}

/// The same numbers in C order and of the type of this name; what is so already is not copied.
fn converted<'py>(
    array: &Bound<'py, PyUntypedArray>,
    target: &str,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = array.py();
    let options = [("dtype", target), ("order", "C")].into_py_dict(py)?;
    let numpy = py.import("numpy")?;
    let array = numpy.call_method("asarray", (array,), Some(&options))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// Real numbers in C order.
pub(crate) enum Reals<'py> {
    /// float32, which nobody has widened yet.
    Single(PyReadonlyArrayDyn<'py, f32>),
    /// float64.
    Double(PyReadonlyArrayDyn<'py, f64>),
}

/// Real numbers: float32 as they are, others as float64.
pub(crate) fn reals<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    shape: Shape,
) -> PyResult<Reals<'py>> {
    let array = checked(what, object, Kind::Real, shape)?;
    if array.is_c_contiguous()
        && let Ok(single) = array.cast::<PyArrayDyn<f32>>()
    {
        return Ok(Reals::Single(single.try_readonly()?));
    }
    let array = converted(&array, "float64")?;
    let double = array.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
    Ok(Reals::Double(double))
}

/// Real numbers as float64.
pub(crate) fn real_array<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    shape: Shape,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = converted(&checked(what, object, Kind::Real, shape)?, "float64")?;
    Ok(array.cast::<PyArrayDyn<f64>>()?.try_readonly()?)
}

/// Integers as int64.
pub(crate) fn integer_array<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    shape: Shape,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = converted(&checked(what, object, Kind::Integer, shape)?, "int64")?;
    Ok(array.cast::<PyArrayDyn<i64>>()?.try_readonly()?)
}
