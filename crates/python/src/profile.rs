//! Plane outlines, and the solids that are drawn out and turned from them.

use octray::geometry::Solid as Exact;
use octray::geometry::profile::{Edge, Outline as Drawn, Region, Turning};
use octray::math::DVec2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Shape, real_array};
use crate::convert::value_error;
use crate::solid::Solid;

type Pair = (f64, f64);

/// A closed curve in the plane, of straight lines, circular arcs and Bézier curves: the profile of
/// a prism or lathe. It begins at `(x, y)`; every method returns one that goes on further, and a
/// line closes it.
#[pyclass(frozen, module = "octray")]
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    inner: Drawn,
    edges: usize,
}

impl Outline {
    fn further(&self, edge: Edge, x: f64, y: f64) -> Self {
        let mut inner = self.inner.clone();
        inner.push(edge, DVec2::new(x, y));
        Self {
            inner,
            edges: self.edges + 1,
        }
    }
}

#[pymethods]
impl Outline {
    #[new]
    const fn new(x: f64, y: f64) -> Self {
        Self {
            inner: Drawn::starting_at(DVec2::new(x, y)),
            edges: 0,
        }
    }

    /// A circle.
    #[staticmethod]
    #[pyo3(
        signature = (r, center = (0.0, 0.0)),
        text_signature = "(r, center=(0.0, 0.0))"
    )]
    fn circle(r: f64, center: Pair) -> PyResult<Self> {
        if !(r > 0.0 && r.is_finite()) {
            let message = format!("radius must be greater than 0 and finite, not {r}");
            return Err(PyValueError::new_err(message));
        }
        Ok(Self {
            inner: Drawn::circle(center.into(), r),
            edges: 1,
        })
    }

    /// Straight on to `(x, y)`.
    fn line_to(&self, x: f64, y: f64) -> Self {
        self.further(Edge::Line, x, y)
    }

    /// A quadratic Bézier curve to `(x, y)` with one control point.
    fn quadratic_to(&self, control: Pair, x: f64, y: f64) -> Self {
        self.further(Edge::Quadratic(control.into()), x, y)
    }

    /// A cubic Bézier curve to `(x, y)` with two control points.
    fn cubic_to(&self, control1: Pair, control2: Pair, x: f64, y: f64) -> Self {
        self.further(Edge::Cubic(control1.into(), control2.into()), x, y)
    }

    /// A circular arc about `center` to `(x, y)`, which is as far from it as where the arc begins;
    /// a whole circle if it is the same point.
    #[pyo3(signature = (x, y, center, clockwise = false))]
    fn arc_to(&self, x: f64, y: f64, center: Pair, clockwise: bool) -> Self {
        let center = center.into();
        self.further(Edge::Arc { center, clockwise }, x, y)
    }

    fn __repr__(&self) -> String {
        format!("<octray.Outline of {} edges>", self.edges)
    }
}

/// An outline, or the corners of a polygon as an array of shape (N, 2).
fn outline(object: &Bound<'_, PyAny>) -> PyResult<Drawn> {
    if let Ok(outline) = object.extract::<PyRef<'_, Outline>>() {
        return Ok(outline.inner.clone());
    }
    let corners = real_array("profile", object, Shape::rows("N", 2))?;
    let corners: Vec<DVec2> = corners
        .as_slice()?
        .chunks_exact(2)
        .map(DVec2::from_slice)
        .collect();
    Ok(Drawn::polygon(&corners))
}

/// A profile: one outline, or a list in which at least one is an [`Outline`] or an array of more
/// than one axis.
fn region(profile: &Bound<'_, PyAny>) -> PyResult<Region> {
    let mut outlines = Vec::new();
    let is_several = !profile.is_instance_of::<Outline>()
        && profile
            .try_iter()
            .ok()
            .and_then(|mut items| items.next())
            .and_then(Result::ok)
            .is_some_and(|first| first.is_instance_of::<Outline>() || is_polygon(&first));
    if is_several {
        for item in profile.try_iter()? {
            outlines.push(outline(&item?)?);
        }
    } else {
        outlines.push(outline(profile)?);
    }
    Region::new(&outlines).map_err(value_error)
}

/// Whether it has rows: then it is no point.
fn is_polygon(object: &Bound<'_, PyAny>) -> bool {
    let first = object.try_iter().ok().and_then(|mut items| items.next());
    first
        .and_then(Result::ok)
        .is_some_and(|row| row.try_iter().is_ok())
}

/// A profile drawn out along z: the corners of a polygon, shape (N, 2), an `Outline`, or a list of
/// these; inside is what an odd number of them goes round.
///
/// `scale` is the size of the top in units of the bottom: 0 makes a pyramid.
#[pyfunction]
#[pyo3(signature = (profile, h, center = true, scale = 1.0))]
pub(crate) fn prism(
    profile: &Bound<'_, PyAny>,
    h: f64,
    center: bool,
    scale: f64,
) -> PyResult<Solid> {
    let region = region(profile)?;
    let z = if center {
        [h * -0.5, h * 0.5]
    } else {
        [0.0, h]
    };
    let prism = Exact::tapered_prism(&region, z, [1.0, scale]);
    prism.map(Solid::leaf).map_err(value_error)
}

/// A profile turned about the z axis by `angle` degrees, beginning at the x axis: its x is the
/// distance from the axis, its y becomes z.
#[pyfunction]
#[pyo3(signature = (profile, angle = 360.0))]
pub(crate) fn lathe(profile: &Bound<'_, PyAny>, angle: f64) -> PyResult<Solid> {
    let turning = Turning {
        sweep: angle,
        ..Turning::ROUND
    };
    let lathe = Exact::turned_lathe(&region(profile)?, turning);
    lathe.map(Solid::leaf).map_err(value_error)
}
