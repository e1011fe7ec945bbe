//! The closed set of primitive solids, each in its own frame.

use std::sync::Arc;

use octray_math::{Aabb, DVec3};
use thiserror::Error;

use crate::Polynomial;
use crate::composite::Composite;
use crate::mesh::{MeshError, TriangleMesh};
use crate::polyhedron::corners_of;
use crate::surface::QuadricForm;

/// Why a shape cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ShapeError {
    /// A length, radius or coordinate is NaN or infinite.
    #[error("{what} must be finite, not {value}")]
    NotFinite {
        /// The parameter.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A length or radius that must be positive is not.
    #[error("{what} must be greater than 0, not {value}")]
    NotPositive {
        /// The parameter.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A direction or normal has no length.
    #[error("{what} must not be the zero vector")]
    ZeroVector {
        /// The parameter.
        what: &'static str,
    },
    /// A transform flattens space or is not finite.
    #[error("the transform is singular: it has no inverse")]
    SingularTransform,
    /// A polynomial's degree is not one that is supported.
    #[error("the degree must be 1 to {max}, not {0}", max = octray_math::roots::MAX_DEGREE)]
    BadDegree(usize),
    /// A polynomial has too few or too many coefficients.
    #[error("a polynomial of degree {degree} has {expected} coefficients, not {given}")]
    CoefficientCount {
        /// How many there are.
        given: usize,
        /// The degree.
        degree: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A number lies outside of what is supported.
    #[error("{what} must be from {low} to {high}, not {value}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// What was given.
        value: f64,
        /// The least.
        low: f64,
        /// The most.
        high: f64,
    },
    /// The faces of a convex polyhedron enclose no bounded, full-dimensional region.
    #[error("the polyhedron is {0}")]
    BadPolyhedron(&'static str),
    /// The outlines of a prism's or lathe's profile cannot be used.
    #[error("the profile {0}")]
    BadProfile(&'static str),
    /// The tree of operations is too deep.
    #[error("the solid has {0} nested operations; at most {max} are supported", max = crate::solid::MAX_NESTING)]
    TooDeep(u32),
    /// The tree has too many primitives.
    #[error("the solid has {0} operands; at most {max} are supported", max = crate::solid::MAX_OPERANDS)]
    TooManyOperands(u64),
    /// The mesh cannot be used as a solid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A solid in its own frame, of the shapes that octray knows exactly.
#[derive(Clone, Debug)]
pub enum Primitive {
    /// All points within `radius` of the origin.
    Sphere {
        /// Positive.
        radius: f64,
    },
    /// The axis-aligned box between two corners.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner, above `min` on every axis.
        max: DVec3,
    },
    /// A circular cylinder about the z axis, capped at `z[0] < z[1]`.
    Cylinder {
        /// Positive.
        radius: f64,
        /// Bottom and top; infinite ends leave the cylinder uncapped there.
        z: [f64; 2],
    },
    /// A cone or frustum about the z axis: `radius[0]` at `z[0]`, `radius[1]` at `z[1]`, capped.
    Cone {
        /// Not negative, not equal (that would be a cylinder).
        radius: [f64; 2],
        /// Bottom and top, finite.
        z: [f64; 2],
    },
    /// A torus about the z axis; `minor > major` gives the spindle's outer shape.
    Torus {
        /// Distance of the tube's centre from the axis, positive.
        major: f64,
        /// Radius of the tube, positive.
        minor: f64,
    },
    /// The negative side of a quadric in its own frame.
    Quadric(QuadricForm),
    /// The points at which a polynomial is negative.
    Polynomial {
        /// The function.
        polynomial: Arc<Polynomial>,
        /// A box around the points, unbounded where none is known.
        bounds: Aabb,
    },
    /// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) <= 1`.
    Superellipsoid {
        /// `[e, n]`: 1 is round, towards 0 square, 2 a rhombus, above 2 pinched.
        exponents: [f64; 2],
    },
    /// The points with `normal . x <= offset`; `normal` has unit length.
    HalfSpace {
        /// Points out of the solid; unit length.
        normal: DVec3,
        /// Distance of the boundary from the origin along `normal`.
        offset: f64,
    },
    /// A bounded intersection of half-spaces.
    Convex(Arc<ConvexPolyhedron>),
    /// A prism, a lathe or a concave polyhedron.
    Composite(Arc<Composite>),
    /// The inside of a closed, consistently oriented mesh.
    Mesh(Arc<TriangleMesh>),
}

/// A bounded intersection of half-spaces, with its corners.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexPolyhedron {
    /// `(unit outward normal n, d)`: inside is `n . x <= d`. One per face.
    pub planes: Vec<(DVec3, f64)>,
    /// The corners.
    pub vertices: Vec<DVec3>,
}

impl ConvexPolyhedron {
    /// From corners and faces (corner indices in order round the face, either orientation).
    ///
    /// # Errors
    /// Fewer than 4 faces, an index out of range, a degenerate or non-planar face, or a corner
    /// that lies outside a face's plane (then the polyhedron is not convex) by more than 1e-9 of
    /// its size. Callers fall back to a mesh.
    pub fn from_faces(vertices: Vec<DVec3>, faces: &[Vec<u32>]) -> Result<Self, ShapeError> {
        let bounds = Aabb::from_points(vertices.iter().copied());
        if !bounds.is_bounded() || vertices.iter().any(|v| !v.is_finite()) {
            return Err(ShapeError::BadPolyhedron("not finite"));
        }
        if faces.len() < 4 {
            return Err(ShapeError::BadPolyhedron("open: it has fewer than 4 faces"));
        }
        let tolerance = bounds.diagonal() * 1e-9;
        let center = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let mut planes = Vec::with_capacity(faces.len());
        for face in faces {
            let corners = corners_of(face, &vertices)?;
            // Newell's normal: right for any polygon, exact for axis-aligned ones.
            let mut normal = DVec3::ZERO;
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                normal += (*a - center).cross(*b - center);
            }
            let Some(mut normal) = normal.try_normalize() else {
                return Err(ShapeError::BadPolyhedron("degenerate: a face has no area"));
            };
            let mut offset = normal.dot(corners[0]);
            if normal.dot(center) > offset {
                normal = -normal;
                offset = -offset;
            }
            if corners
                .iter()
                .any(|c| (normal.dot(*c) - offset).abs() > tolerance)
            {
                return Err(ShapeError::BadPolyhedron("not planar in one of its faces"));
            }
            if vertices.iter().any(|v| normal.dot(*v) - offset > tolerance) {
                return Err(ShapeError::BadPolyhedron("not convex"));
            }
            if normal.dot(center) > offset - tolerance {
                return Err(ShapeError::BadPolyhedron("flat"));
            }
            planes.push((normal, offset));
        }
        Ok(Self { planes, vertices })
    }

    /// From planes and corners as they are.
    ///
    /// # Errors
    /// A number is not finite, a normal has another length than 1, a corner lies outside of a
    /// plane by more than 1e-6 of the size, a plane has fewer than three corners on it, or there are
    /// fewer than four planes, or too many.
    pub(crate) fn from_parts(
        planes: Vec<(DVec3, f64)>,
        vertices: Vec<DVec3>,
    ) -> Result<Self, ShapeError> {
        let made = Self { planes, vertices };
        let bounds = made.bounds();
        let finite = made.vertices.iter().all(|v| v.is_finite())
            && made
                .planes
                .iter()
                .all(|(n, d)| n.is_normalized() && d.is_finite());
        if !finite || !bounds.is_bounded() {
            return Err(ShapeError::BadPolyhedron("not finite"));
        }
        if made.planes.len() < 4 {
            return Err(ShapeError::BadPolyhedron("open: it has fewer than 4 faces"));
        }
        let tests = made.planes.len().saturating_mul(made.vertices.len());
        if tests > crate::solid::CONVEX_TESTS {
            return Err(ShapeError::BadPolyhedron("too intricate"));
        }
        let tolerance = bounds.diagonal() * 1e-6;
        for (normal, offset) in &made.planes {
            let mut on_plane = 0;
            for vertex in &made.vertices {
                let height = normal.dot(*vertex) - offset;
                let within = height <= tolerance;
                if !within {
                    return Err(ShapeError::BadPolyhedron("not convex"));
                }
                on_plane += usize::from(height >= -tolerance);
            }
            if on_plane < 3 {
                return Err(ShapeError::BadPolyhedron("open: a face has no corners"));
            }
        }
        Ok(made)
    }

    /// The box around the corners.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.vertices.iter().copied())
    }
}

impl Primitive {
    /// How many faces it has; of a mesh, triangles.
    #[must_use]
    pub fn face_count(&self) -> u64 {
        match self {
            Self::Sphere { .. }
            | Self::Torus { .. }
            | Self::Quadric(_)
            | Self::Polynomial { .. }
            | Self::Superellipsoid { .. }
            | Self::HalfSpace { .. } => 1,
            Self::Box { .. } => 6,
            Self::Cylinder { .. } | Self::Cone { .. } => 3,
            Self::Convex(polyhedron) => polyhedron.planes.len() as u64,
            // Each may be named with both of its sides.
            Self::Composite(composite) => 2 * composite.faces().len() as u64,
            // One more stands for the whole mesh in expressions.
            Self::Mesh(mesh) => mesh.triangles().len() as u64 + 1,
        }
    }

    /// The box around the solid in its own frame, unbounded for half-spaces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Sphere { radius } => Aabb::new(DVec3::splat(-radius), DVec3::splat(*radius)),
            Self::Box { min, max } => Aabb::new(*min, *max),
            Self::Cylinder { radius, z } => Aabb::new(
                DVec3::new(-radius, -radius, z[0]),
                DVec3::new(*radius, *radius, z[1]),
            ),
            Self::Cone { radius, z } => {
                let r = radius[0].max(radius[1]);
                Aabb::new(DVec3::new(-r, -r, z[0]), DVec3::new(r, r, z[1]))
            }
            Self::Torus { major, minor } => {
                let r = major + minor;
                Aabb::new(DVec3::new(-r, -r, -minor), DVec3::new(r, r, *minor))
            }
            Self::Polynomial { bounds, .. } => *bounds,
            Self::Superellipsoid { .. } => Aabb::new(-DVec3::ONE, DVec3::ONE),
            Self::Quadric(_) | Self::HalfSpace { .. } => Aabb::ALL,
            Self::Convex(polyhedron) => polyhedron.bounds(),
            Self::Composite(composite) => composite.bounds(),
            Self::Mesh(mesh) => mesh.bounds(),
        }
    }
}
