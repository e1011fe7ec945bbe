//! Solids: every operation returns a new one.

use std::sync::Arc;

use octray::geometry::mesh::MeshRule;
use octray::geometry::{ConvexPolyhedron, ShapeError, SolidNode, TriangleMesh};
use octray::math::{DAffine3, DVec3, transform};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::convert::{Triple, affine, number_or_vector, value_error, vector};
use crate::mesh;

/// An exact solid: a primitive, a closed mesh, or a set operation on solids.
#[pyclass(frozen, module = "octray")]
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    inner: octray::geometry::Solid,
    /// Levels of the expression, and leaves when shared parts count every time they are used.
    depth: u32,
    operands: u64,
}

/// Deeper nesting than any hand or program makes on purpose; it keeps recursive walks of the
/// expression well within the stack of a thread.
const MAX_DEPTH: u32 = 1000;

/// More operands than memory has room for: copies share their storage in Python, but are places
/// of their own in the world, so doubling 30 times is quickly written and never finished.
const MAX_OPERANDS: u64 = 1 << 24;

fn checked(result: Result<octray::geometry::Solid, ShapeError>) -> PyResult<Solid> {
    result.map(Solid::leaf).map_err(value_error)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Operation {
    Union,
    Intersection,
    Difference,
}

impl Solid {
    pub(crate) const fn leaf(inner: octray::geometry::Solid) -> Self {
        Self {
            inner,
            depth: 1,
            operands: 1,
        }
    }

    pub(crate) const fn inner(&self) -> &octray::geometry::Solid {
        &self.inner
    }

    fn limited(inner: octray::geometry::Solid, depth: u32, operands: u64) -> PyResult<Self> {
        if depth > MAX_DEPTH {
            return Err(PyValueError::new_err(format!(
                "the solid is nested more than {MAX_DEPTH} operations deep; octray.union([...]) \
                 and octray.difference(a, b, c, ...) take any number of operands in one step"
            )));
        }
        if operands > MAX_OPERANDS {
            return Err(PyValueError::new_err(format!(
                "the solid has {operands} operands; at most {MAX_OPERANDS} are supported"
            )));
        }
        Ok(Self {
            inner,
            depth,
            operands,
        })
    }

    /// `first operation rest`; a chain such as `a + b + c` stays one flat node.
    fn combine(operation: Operation, first: &Self, rest: &[Self]) -> PyResult<Self> {
        let count = rest
            .iter()
            .fold(first.operands, |sum, s| sum.saturating_add(s.operands));
        let (mut operands, below) = match (operation, first.inner.node()) {
            (Operation::Union, SolidNode::Union(all))
            | (Operation::Intersection, SolidNode::Intersection(all))
            | (Operation::Difference, SolidNode::Difference(all)) => (all.clone(), first.depth - 1),
            _ => (vec![first.inner.clone()], first.depth),
        };
        operands.extend(rest.iter().map(|s| s.inner.clone()));
        let below = rest.iter().map(|s| s.depth).fold(below, u32::max);
        let inner = match operation {
            Operation::Union => octray::geometry::Solid::union(operands),
            Operation::Intersection => octray::geometry::Solid::intersection(operands),
            Operation::Difference => octray::geometry::Solid::difference(operands),
        };
        Self::limited(inner, below + 1, count)
    }

    fn moved(&self, parent_from_child: DAffine3) -> PyResult<Self> {
        let inner = self
            .inner
            .transform(parent_from_child)
            .map_err(value_error)?;
        // A move of a move is one node.
        let merged = matches!(self.inner.node(), SolidNode::Transformed { .. });
        Self::limited(inner, self.depth + u32::from(!merged), self.operands)
    }
}

#[pymethods]
impl Solid {
    fn __add__(&self, other: &Self) -> PyResult<Self> {
        Self::combine(Operation::Union, self, std::slice::from_ref(other))
    }

    fn __sub__(&self, other: &Self) -> PyResult<Self> {
        Self::combine(Operation::Difference, self, std::slice::from_ref(other))
    }

    fn __and__(&self, other: &Self) -> PyResult<Self> {
        Self::combine(Operation::Intersection, self, std::slice::from_ref(other))
    }

    fn __invert__(&self) -> PyResult<Self> {
        self.complement()
    }

    /// The points that are not in this solid.
    fn complement(&self) -> PyResult<Self> {
        Self::limited(self.inner.complement(), self.depth + 1, self.operands)
    }

    /// Moved by an offset.
    #[pyo3(signature = (x = 0.0, y = 0.0, z = 0.0))]
    fn translate(&self, x: f64, y: f64, z: f64) -> PyResult<Self> {
        self.moved(DAffine3::from_translation(DVec3::new(x, y, z)))
    }

    /// Turned by degrees about the fixed axes through the origin: first x, then y, then z.
    #[pyo3(signature = (x = 0.0, y = 0.0, z = 0.0))]
    fn rotate(&self, x: f64, y: f64, z: f64) -> PyResult<Self> {
        self.moved(transform::rotation_xyz_degrees(DVec3::new(x, y, z)))
    }

    /// Scaled about the origin by one factor, or by one for each axis.
    fn scale(&self, factor: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.moved(DAffine3::from_scale(number_or_vector("factor", factor)?))
    }

    /// Reflected in the plane through the origin with this normal.
    fn mirror(&self, normal: &Bound<'_, PyAny>) -> PyResult<Self> {
        let normal = vector("normal", normal)?;
        if normal == DVec3::ZERO {
            return Err(value_error(ShapeError::ZeroVector { what: "normal" }));
        }
        self.moved(transform::mirror(normal))
    }

    /// Under an affine map given as a 4x4 matrix by rows.
    fn transform(&self, matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.moved(affine(matrix)?)
    }

    /// A box around the solid as (lowest corner, highest corner): never too small, infinite where
    /// the solid is unbounded, `None` for an empty one.
    #[getter]
    fn bounds(&self) -> Option<(Triple, Triple)> {
        let bounds = self.inner.bounds();
        (!bounds.is_empty()).then(|| (bounds.min.into(), bounds.max.into()))
    }

    fn __repr__(&self) -> String {
        let kind = match self.inner.node() {
            SolidNode::Empty => "empty",
            SolidNode::Primitive(primitive) => crate::describe::primitive_name(primitive),
            SolidNode::Transformed { .. } => "transformed",
            SolidNode::WithMaterial { .. } => "painted",
            SolidNode::Union(_) => "union",
            SolidNode::Intersection(_) => "intersection",
            SolidNode::Difference(_) => "difference",
            SolidNode::Complement(_) => "complement",
        };
        format!("<octray.Solid {kind}>")
    }
}

/// The solids of one argument list: `f(a, b, c)` or `f([a, b, c])`.
fn operands(arguments: &Bound<'_, PyTuple>) -> PyResult<Vec<Solid>> {
    let mut solids = Vec::new();
    for argument in arguments {
        if let Ok(solid) = argument.cast::<Solid>() {
            solids.push(solid.get().clone());
            continue;
        }
        let wrong = || PyTypeError::new_err(format!("expected a solid, not {argument}"));
        for item in argument.try_iter().map_err(|_| wrong())? {
            solids.push(item?.cast::<Solid>().map_err(|_| wrong())?.get().clone());
        }
    }
    Ok(solids)
}

fn folded(operation: Operation, arguments: &Bound<'_, PyTuple>) -> PyResult<Solid> {
    match operands(arguments)?.split_first() {
        None => Ok(empty()),
        Some((first, [])) => Ok(first.clone()),
        Some((first, rest)) => Solid::combine(operation, first, rest),
    }
}

/// The points in any of the solids; of none, the empty solid.
#[pyfunction]
#[pyo3(signature = (*solids))]
pub(crate) fn union(solids: &Bound<'_, PyTuple>) -> PyResult<Solid> {
    folded(Operation::Union, solids)
}

/// The points in all of the solids; of none, the empty solid.
#[pyfunction]
#[pyo3(signature = (*solids))]
pub(crate) fn intersection(solids: &Bound<'_, PyTuple>) -> PyResult<Solid> {
    folded(Operation::Intersection, solids)
}

/// The points in the first solid and in none of the others; of none, the empty solid.
#[pyfunction]
#[pyo3(signature = (*solids))]
pub(crate) fn difference(solids: &Bound<'_, PyTuple>) -> PyResult<Solid> {
    folded(Operation::Difference, solids)
}

/// The solid without points.
#[pyfunction]
pub(crate) fn empty() -> Solid {
    Solid::leaf(octray::geometry::Solid::empty())
}

/// A box of the given size (a number or three) about the origin, or with a corner there.
#[pyfunction]
#[pyo3(name = "box", signature = (size, center = true))]
pub(crate) fn cuboid(size: &Bound<'_, PyAny>, center: bool) -> PyResult<Solid> {
    let size = number_or_vector("size", size)?;
    for (axis, what) in ["size along x", "size along y", "size along z"]
        .into_iter()
        .enumerate()
    {
        let value = size[axis];
        if value.is_nan() || value <= 0.0 {
            return Err(value_error(ShapeError::NotPositive { what, value }));
        }
    }
    let low = if center { size * -0.5 } else { DVec3::ZERO };
    let high = if center { size * 0.5 } else { size };
    checked(octray::geometry::Solid::cuboid(low, high))
}

/// A ball about the origin.
#[pyfunction]
pub(crate) fn sphere(r: f64) -> PyResult<Solid> {
    checked(octray::geometry::Solid::sphere(r))
}

/// The bottom and top of something of height `h`, about z = 0 or upon it.
fn z_range(h: f64, center: bool) -> (f64, f64) {
    if center {
        (-0.5 * h, 0.5 * h)
    } else {
        (0.0, h)
    }
}

/// A cylinder about the z axis.
#[pyfunction]
#[pyo3(signature = (r, h, center = true))]
pub(crate) fn cylinder(r: f64, h: f64, center: bool) -> PyResult<Solid> {
    let (low, high) = z_range(h, center);
    checked(octray::geometry::Solid::cylinder(r, low, high))
}

/// A cone or frustum about the z axis: radius `r1` at the bottom, `r2` at the top.
#[pyfunction]
#[pyo3(signature = (r1, r2, h, center = true))]
pub(crate) fn cone(r1: f64, r2: f64, h: f64, center: bool) -> PyResult<Solid> {
    let (low, high) = z_range(h, center);
    checked(octray::geometry::Solid::cone(r1, r2, low, high))
}

/// A torus about the z axis: `R` to the middle of the tube, `r` the tube's own radius.
#[pyfunction]
#[pyo3(name = "torus")]
#[expect(non_snake_case, reason = "R and r are what everyone calls them")]
pub(crate) fn torus(R: f64, r: f64) -> PyResult<Solid> {
    checked(octray::geometry::Solid::torus(R, r))
}

/// The points `p` with `normal . p <= d`, where the normal counts as a unit vector.
#[pyfunction]
#[pyo3(signature = (normal, d = 0.0))]
pub(crate) fn half_space(normal: &Bound<'_, PyAny>, d: f64) -> PyResult<Solid> {
    let normal = vector("normal", normal)?;
    checked(octray::geometry::Solid::half_space(normal, d))
}

/// A quadric from ten numbers: the points where `a x^2 + b y^2 + c z^2 + d x y + e x z + f y z +
/// g x + h y + i z + j <= 0`.
///
/// Ellipsoids, hyperboloids, paraboloids, cylinders, cones, pairs of planes, half-spaces: those that
/// are also a sphere, cylinder, cone or plane are the same surface as that one.
#[pyfunction]
pub(crate) fn quadric(coefficients: Vec<f64>) -> PyResult<Solid> {
    let given = coefficients.len();
    let ten: [f64; 10] = coefficients.try_into().map_err(|_| {
        PyValueError::new_err(format!("coefficients: expected 10 numbers, not {given}"))
    })?;
    checked(octray::geometry::Solid::quadric(ten))
}

/// The points where a polynomial of degree 3 is negative or 0: 20 coefficients, ordered as in
/// `polynomial`.
#[pyfunction]
pub(crate) fn cubic(coefficients: Vec<f64>) -> PyResult<Solid> {
    polynomial(3, coefficients)
}

/// The points where a polynomial of degree 4 is negative or 0: 35 coefficients, ordered as in
/// `polynomial`.
#[pyfunction]
pub(crate) fn quartic(coefficients: Vec<f64>) -> PyResult<Solid> {
    polynomial(4, coefficients)
}

/// The points where a polynomial in x, y and z of a degree up to 15 is negative or 0.
///
/// The `(n + 1)(n + 2)(n + 3) / 6` coefficients come by falling power of x, then of y, then of z:
/// for degree 2 those of x^2, xy, xz, x, y^2, yz, y, z^2, z, 1.
#[pyfunction]
#[expect(
    clippy::needless_pass_by_value,
    reason = "arguments are converted into a value"
)]
pub(crate) fn polynomial(degree: usize, coefficients: Vec<f64>) -> PyResult<Solid> {
    let polynomial = octray::geometry::Polynomial::new(degree, &coefficients);
    checked(polynomial.and_then(octray::geometry::Solid::polynomial))
}

/// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) <= 1`: round for e = n = 1, a box towards 0, an
/// octahedron for 2, pinched above; from -1 to 1 on every axis.
#[pyfunction]
pub(crate) fn superellipsoid(e: f64, n: f64) -> PyResult<Solid> {
    checked(octray::geometry::Solid::superellipsoid(e, n))
}

/// A polyhedron from its corners, shape (N, 3), and its plane faces: a list of lists of corner
/// indices in order round the face, counter-clockwise seen from outside (either way round if it
/// is convex). The rule is that of `mesh_solid`.
#[pyfunction]
#[pyo3(signature = (vertices, faces, rule = "strict"))]
pub(crate) fn polyhedron(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    rule: &str,
) -> PyResult<Solid> {
    let rule = mesh::rule(rule)?;
    let faces = mesh::polygons(faces)?;
    let vertices = mesh::positions(vertices)?;
    if let Ok(convex) = ConvexPolyhedron::from_faces(vertices.clone(), &faces) {
        return Ok(Solid::leaf(octray::geometry::Solid::convex(Arc::new(
            convex,
        ))));
    }
    let mesh = mesh::triangulated(vertices.clone(), &faces)?;
    let solid = octray::geometry::Solid::mesh(mesh, rule).map_err(value_error)?;
    // What may be a solid at all has exact planes, where it is not too large for that.
    let exact = octray::geometry::Solid::exact_polyhedron(&vertices, &faces);
    Ok(Solid::leaf(match exact {
        Ok(exact) if rule == MeshRule::Strict => exact,
        _ => solid,
    }))
}

/// The inside of a closed triangle mesh whose triangles run counter-clockwise seen from outside.
///
/// With the rule `"strict"` every edge must have two triangles, and nothing may cross, overlap or
/// face the wrong way: a `ValueError` says what is wrong where. With `"winding"` inside is where
/// the winding number is not 0, whatever crosses or overlaps and however the mesh is turned; it
/// must be closed.
#[pyfunction]
#[pyo3(signature = (vertices, faces, rule = "strict"))]
pub(crate) fn mesh_solid(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    rule: &str,
) -> PyResult<Solid> {
    let rule = mesh::rule(rule)?;
    let mesh: Arc<TriangleMesh> = mesh::from_arrays(vertices, faces)?;
    checked(octray::geometry::Solid::mesh(mesh, rule))
}
