//! Numbers, vectors, colours and transforms as Python writes them.

use octray::math::{DAffine3, DMat3, DVec3};
use octray::scene::srgb_to_linear;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// A point or vector as Python gets it.
pub(crate) type Triple = (f64, f64, f64);

/// `ValueError` with the text of any error.
pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A short text for "not ..." in messages.
fn shown(object: &Bound<'_, PyAny>) -> String {
    let text = object
        .repr()
        .map_or_else(|_| "that".to_owned(), |r| r.to_string());
    if text.chars().count() <= 80 {
        text
    } else {
        let head: String = text.chars().take(77).collect();
        format!("{head}...")
    }
}

/// Up to `limit` items of any iterable that is not text; `None` for everything else.
fn items<'py>(object: &Bound<'py, PyAny>, limit: usize) -> Option<Vec<Bound<'py, PyAny>>> {
    if object.extract::<std::borrow::Cow<'_, str>>().is_ok() {
        return None;
    }
    object
        .try_iter()
        .ok()?
        .take(limit)
        .collect::<PyResult<_>>()
        .ok()
}

fn numbers(object: &Bound<'_, PyAny>, limit: usize) -> Option<Vec<f64>> {
    items(object, limit)?
        .iter()
        .map(|item| item.extract::<f64>().ok())
        .collect()
}

/// Three numbers: a tuple, a list or an array.
pub(crate) fn vector(what: &str, object: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    match numbers(object, 4).as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        Some(_) => Err(PyValueError::new_err(format!(
            "{what}: expected three numbers, not {}",
            shown(object)
        ))),
        None => Err(PyTypeError::new_err(format!(
            "{what}: expected three numbers, not {}",
            shown(object)
        ))),
    }
}

/// One number for all three axes, or three numbers.
pub(crate) fn number_or_vector(what: &str, object: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    match object.extract::<f64>() {
        Ok(number) => Ok(DVec3::splat(number)),
        Err(_) => vector(what, object),
    }
}

/// A colour in linear light: three numbers as they are, or `"#rrggbb"` / `"#rgb"` in sRGB.
pub(crate) fn color(what: &str, object: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    let Ok(text) = object.extract::<String>() else {
        return vector(what, object);
    };
    hex_color(&text).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{what}: expected three numbers or text like \"#b8c4d0\", not {text:?}"
        ))
    })
}

/// One number for a grey, or a colour.
pub(crate) fn number_or_color(what: &str, object: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    match object.extract::<f64>() {
        Ok(number) => Ok(DVec3::splat(number)),
        Err(_) => color(what, object),
    }
}

fn hex_color(text: &str) -> Option<DVec3> {
    let digits: Option<Vec<u32>> = text
        .strip_prefix('#')?
        .chars()
        .map(|c| c.to_digit(16))
        .collect();
    let bytes: [u32; 3] = match digits?.as_slice() {
        [r, g, b] => [17 * r, 17 * g, 17 * b],
        [a, b, c, d, e, f] => [16 * a + b, 16 * c + d, 16 * e + f],
        _ => return None,
    };
    Some(DVec3::from_array(
        bytes.map(|byte| srgb_to_linear(f64::from(byte) / 255.0)),
    ))
}

/// A 4x4 (or 3x4) matrix by rows that maps column vectors; its last row must be `0 0 0 1`.
pub(crate) fn affine(object: &Bound<'_, PyAny>) -> PyResult<DAffine3> {
    let rows: Option<Vec<Vec<f64>>> =
        items(object, 5).and_then(|rows| rows.iter().map(|row| numbers(row, 5)).collect());
    let shape = || {
        PyValueError::new_err(format!(
            "a transform is a 4x4 matrix of numbers by rows, not {}",
            shown(object)
        ))
    };
    let rows = rows.ok_or_else(shape)?;
    if !matches!(rows.len(), 3 | 4) || rows.iter().any(|row| row.len() != 4) {
        return Err(shape());
    }
    if rows.len() == 4 && rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err(PyValueError::new_err(format!(
            "the last row of a transform must be 0 0 0 1, not {:?}",
            rows[3]
        )));
    }
    let column = |i: usize| DVec3::new(rows[0][i], rows[1][i], rows[2][i]);
    Ok(DAffine3::from_mat3_translation(
        DMat3::from_cols(column(0), column(1), column(2)),
        column(3),
    ))
}
