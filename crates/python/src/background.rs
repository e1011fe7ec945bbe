//! What rays see that meet nothing.

use octray::math::DVec3;
use octray::scene::{Background, Color, ColorStop};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::{color, number_or_color};

/// One colour, or a gradient of two or more from straight down to straight up.
pub(crate) fn background(given: &Bound<'_, PyAny>, up: DVec3) -> PyResult<Background> {
    let finite = |c: DVec3| {
        if c.is_finite() {
            Ok(c)
        } else {
            Err(PyValueError::new_err("background: colours must be finite"))
        }
    };
    Ok(
        match number_or_color("background", given).and_then(finite) {
            Ok(rgb) => Background::Uniform(rgb),
            Err(error) => {
                let colors: Option<Vec<DVec3>> = given.try_iter().ok().and_then(|items| {
                    items
                        .map(|item| color("background", &item?).and_then(finite))
                        .collect::<PyResult<_>>()
                        .ok()
                });
                let stops = colors.filter(|c| c.len() >= 2).ok_or(error)?;
                let last = (stops.len() - 1) as f64;
                let stop = |(i, c): (usize, &DVec3)| ColorStop {
                    position: i as f64 / last,
                    color: Color::rgb(c.x, c.y, c.z),
                };
                Background::Gradient {
                    axis: up,
                    map: stops.iter().enumerate().map(stop).collect(),
                }
            }
        },
    )
}
