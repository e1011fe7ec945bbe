//! Polyhedra that are not convex, as formulas over the planes of their faces.
//!
//! A binary space partition (Fuchs, Kedem and Naylor 1980; Thibault and Naylor, *Set operations on
//! polyhedra using binary space partitioning trees*, 1987): every cell between the faces' planes is
//! inside or outside as a whole, so the planes decide, and two faces in one plane are one variable.

use std::sync::Arc;

use octray_math::{Aabb, DVec3};

use crate::boundary::{Boundary, Faces};
use crate::composite::{Composite, CompositeFace};
use crate::polygon::Triangulator;
use crate::profile::{Formula, MAX_FORMULA_DEPTH};
use crate::{ShapeError, TriangleMesh};

/// More faces stay a mesh: it is faster, and the partition may grow with their square.
pub(crate) const MAX_PLANES: usize = 400;
/// How often a face may be named on average, and how often all may be at least.
const GROWTH: usize = 4;
const LEAST_LIMIT: usize = 64;
/// How far corners may be off a face's plane, in units of the polyhedron's size.
const FLATNESS: f64 = 1e-9;

/// A part of a face, convex, with the index of its plane.
#[derive(Clone, Debug)]
struct Part {
    plane: usize,
    corners: Vec<DVec3>,
}

/// The closed polyhedron with these corners and faces (counter-clockwise seen from outside).
///
/// # Errors
/// A face is degenerate or not planar, the faces are not closed, or there are so many or so
/// intricate ones that a mesh is the better representation.
pub(crate) fn polyhedron(vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<Composite, ShapeError> {
    let bounds = Aabb::from_points(vertices.iter().copied());
    if faces.len() > MAX_PLANES {
        return Err(ShapeError::BadPolyhedron("too intricate"));
    }
    let tolerance = bounds.diagonal() * FLATNESS;
    let mut planes: Vec<(DVec3, DVec3)> = Vec::new();
    let mut parts = Vec::new();
    let mut triangulator = Triangulator::new();
    for face in faces {
        let corners = corners_of(face, vertices)?;
        let (normal, point) = plane_of(&corners, tolerance)?;
        let plane = planes.len();
        planes.push((normal, point));
        let triangles = triangulator
            .triangulate(&corners)
            .map_err(|_| ShapeError::BadPolyhedron("too intricate"))?;
        parts.extend(triangles.into_iter().map(|t| Part {
            plane,
            corners: t.map(|i| corners[i as usize]).to_vec(),
        }));
    }
    let corners = |part: &Part| [part.corners[0], part.corners[1], part.corners[2]];
    let triangles: Vec<[DVec3; 3]> = parts.iter().map(corners).collect();
    let probes: Vec<(DVec3, DVec3)> = parts
        .iter()
        .filter(|part| area(&part.corners) > tolerance * tolerance)
        .map(|part| {
            (
                part.corners.iter().sum::<DVec3>() / 3.0,
                planes[part.plane].0,
            )
        })
        .collect();
    let boundary = Boundary::Triangles {
        triangles: triangles.into(),
        source: Arc::new(Faces {
            vertices: vertices.to_vec(),
            faces: faces.to_vec(),
        }),
    };
    let mut partition = Partition {
        planes: &planes,
        tolerance,
        literals_left: (GROWTH * faces.len()).max(LEAST_LIMIT),
    };
    let formula = partition.formula(parts, MAX_FORMULA_DEPTH / 4);
    let formula = formula.ok_or(ShapeError::BadPolyhedron("too intricate"))?;
    // Just below every face it must be inside, just above it outside; thin parts fail this.
    let contains = |p: DVec3| {
        formula.evaluate(&|side| {
            let (normal, point) = planes[side as usize];
            normal.dot(p - point) < 0.0
        })
    };
    let step = bounds.diagonal() * 1e-7;
    for (center, normal) in probes {
        if !contains(center - normal * step) || contains(center + normal * step) {
            return Err(ShapeError::BadPolyhedron("too intricate"));
        }
    }
    let faces = planes
        .into_iter()
        .map(|(normal, point)| CompositeFace::Plane { normal, point })
        .collect();
    Composite::new(boundary, faces, formula, bounds)
}

/// Where the corners of a face are.
///
/// # Errors
/// An index is out of range.
pub(crate) fn corners_of(face: &[u32], vertices: &[DVec3]) -> Result<Vec<DVec3>, ShapeError> {
    let corner = |&i: &u32| vertices.get(i as usize).copied();
    let corners: Option<Vec<DVec3>> = face.iter().map(corner).collect();
    corners.ok_or(ShapeError::BadPolyhedron("using a corner it does not have"))
}

/// The triangles of the faces.
///
/// # Errors
/// An index is out of range, or the faces are too intricate to be cut into triangles.
pub(crate) fn triangulated(
    vertices: Vec<DVec3>,
    faces: &[Vec<u32>],
) -> Result<TriangleMesh, ShapeError> {
    let mut triangulator = Triangulator::new();
    let mut triangles = Vec::new();
    for face in faces {
        let corners = corners_of(face, &vertices)?;
        let local = triangulator
            .triangulate(&corners)
            .map_err(|_| ShapeError::BadPolyhedron("too intricate"))?;
        triangles.extend(local.into_iter().map(|t| t.map(|i| face[i as usize])));
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

fn area(corners: &[DVec3]) -> f64 {
    (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .length()
}

/// Unit outward normal and a corner of a face.
fn plane_of(corners: &[DVec3], tolerance: f64) -> Result<(DVec3, DVec3), ShapeError> {
    let origin = corners.first().copied().unwrap_or_default();
    // Newell's normal: right for any polygon, exact for axis-aligned ones.
    let mut normal = DVec3::ZERO;
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        normal += (*a - origin).cross(*b - origin);
    }
    let Some(normal) = normal.try_normalize() else {
        return Err(ShapeError::BadPolyhedron("degenerate: a face has no area"));
    };
    let off = |c: &DVec3| normal.dot(*c - origin).abs() > tolerance;
    if corners.iter().any(off) {
        return Err(ShapeError::BadPolyhedron("not planar in one of its faces"));
    }
    Ok((normal, origin))
}

struct Partition<'a> {
    planes: &'a [(DVec3, DVec3)],
    tolerance: f64,
    literals_left: usize,
}

impl Partition<'_> {
    /// Of a cell in which these parts of faces lie, at least one; `None` if it is too intricate.
    fn formula(&mut self, parts: Vec<Part>, depth: u32) -> Option<Formula> {
        let depth = depth.checked_sub(1)?;
        let plane = self.best_plane(&parts)?;
        let (mut behind, mut before) = (Vec::new(), Vec::new());
        for part in parts {
            self.split(part, plane, &mut behind, &mut before);
        }
        let mut child = |parts: Vec<Part>, inside: bool| {
            if parts.is_empty() {
                Some(Formula::Constant(inside))
            } else {
                self.formula(parts, depth)
            }
        };
        let (back, front) = (child(behind, true)?, child(before, false)?);
        let side = Formula::inside(plane as u32);
        let both = ![&back, &front]
            .iter()
            .any(|f| matches!(f, Formula::Constant(_)));
        let named = if both { 2 } else { 1 };
        self.literals_left = self.literals_left.checked_sub(named)?;
        Some(match (back, front) {
            (back, Formula::Constant(false)) => Formula::all([side, back]),
            (Formula::Constant(true), front) => Formula::any([side, front]),
            (back, front) => Formula::any([
                Formula::all([side.clone(), back]),
                Formula::all([side.complement(), front]),
            ]),
        })
    }

    /// The plane that divides the parts best: it should cut few, and have all others on one side.
    fn best_plane(&self, parts: &[Part]) -> Option<usize> {
        let mut candidates: Vec<usize> = parts.iter().map(|part| part.plane).collect();
        candidates.sort_unstable();
        candidates.dedup();
        candidates.into_iter().min_by_key(|&plane| {
            let (mut behind, mut before, mut cut) = (0_usize, 0_usize, 0_usize);
            for part in parts {
                match self.span(part, plane) {
                    (true, true) => cut += 1,
                    (true, false) => behind += 1,
                    (false, true) => before += 1,
                    (false, false) => {}
                }
            }
            let one_sided = cut == 0 && (behind == 0 || before == 0);
            (!one_sided, 4 * cut + behind.abs_diff(before))
        })
    }

    fn height(&self, plane: usize, p: DVec3) -> f64 {
        let (normal, point) = self.planes[plane];
        normal.dot(p - point)
    }

    /// Whether a part reaches behind and before a plane.
    fn span(&self, part: &Part, plane: usize) -> (bool, bool) {
        if part.plane == plane {
            return (false, false);
        }
        let heights = || part.corners.iter().map(|c| self.height(plane, *c));
        (
            heights().any(|h| h < -self.tolerance),
            heights().any(|h| h > self.tolerance),
        )
    }

    fn split(&self, part: Part, plane: usize, behind: &mut Vec<Part>, before: &mut Vec<Part>) {
        match self.span(&part, plane) {
            (false, false) => {}
            (true, false) => behind.push(part),
            (false, true) => before.push(part),
            (true, true) => {
                let (mut low, mut high) = (Vec::new(), Vec::new());
                let n = part.corners.len();
                for i in 0..n {
                    let (a, b) = (part.corners[i], part.corners[(i + 1) % n]);
                    let (ha, hb) = (self.height(plane, a), self.height(plane, b));
                    if ha <= self.tolerance {
                        low.push(a);
                    }
                    if ha >= -self.tolerance {
                        high.push(a);
                    }
                    if (ha < -self.tolerance && hb > self.tolerance)
                        || (ha > self.tolerance && hb < -self.tolerance)
                    {
                        let middle = a + (b - a) * (ha / (ha - hb));
                        low.push(middle);
                        high.push(middle);
                    }
                }
                for (corners, side) in [(low, behind), (high, before)] {
                    let plane = part.plane;
                    side.push(Part { plane, corners });
                }
            }
        }
    }
}
