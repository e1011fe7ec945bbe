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

/// `object` as a C-ordered array; a wrong shape or kind is a `ValueError` that says what was
/// expected and what came. An empty list has no shape of its own and counts as no rows.
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
    let array = if shape == [0] {
        array.call_method1("reshape", ((0, wanted.width),))?
    } else if wanted.fits(&shape) {
        array
    } else {
        return Err(expected(format!("shape {}", shape_text(&shape))));
    };
    let target = match kind {
        Kind::Real => "float64",
        Kind::Integer => "int64",
    };
    let options = [("dtype", target), ("order", "C")].into_py_dict(py)?;
    let array = numpy.call_method("asarray", (array,), Some(&options))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// Real numbers as float64.
pub(crate) fn real_array<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    shape: Shape,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = checked(what, object, Kind::Real, shape)?;
    Ok(array.cast::<PyArrayDyn<f64>>()?.try_readonly()?)
}

/// Integers as int64.
pub(crate) fn integer_array<'py>(
    what: &str,
    object: &Bound<'py, PyAny>,
    shape: Shape,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = checked(what, object, Kind::Integer, shape)?;
    Ok(array.cast::<PyArrayDyn<i64>>()?.try_readonly()?)
}
