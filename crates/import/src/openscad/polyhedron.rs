//! `polyhedron`: corners and faces, clockwise seen from outside.

use std::collections::BTreeMap;
use std::sync::Arc;

use octray_geometry::{ConvexPolyhedron, Solid, TriangleMesh};
use octray_math::DVec3;

use crate::Span;
use crate::mesh_object::mesh_solid;
use crate::polygon::{TooComplex, Triangulator};

use super::arguments::Arguments;
use super::orientation::{self, Orientation};
use super::primitives::Workshop;
use super::syntax::{Statement, Value};

/// Up to this product of faces and corners it is tried whether a polyhedron is convex.
const CONVEX_TESTS: usize = 50_000_000;

/// What the arguments of a `polyhedron` describe.
pub(super) enum Polyhedron {
    Solid(Solid),
    /// Faces that enclose nothing, with the reason.
    Open(Arc<TriangleMesh>, String),
}

impl Workshop<'_> {
    /// `polyhedron(points, faces)`.
    pub(super) fn polyhedron(&mut self, statement: &Statement<'_>) -> Polyhedron {
        let arguments = Arguments::bind(
            statement,
            &["points", "faces", "convexity"],
            &["triangles"],
            self.diagnostics,
        );
        let span = arguments.span();
        let points = self.vectors(&arguments, "points").unwrap_or_default();
        let faces = if arguments.get("faces").is_some() {
            self.vectors(&arguments, "faces")
        } else {
            self.vectors(&arguments, "triangles")
        };
        let faces = faces.unwrap_or_default();
        match corners_and_faces(&points, &faces) {
            Ok((corners, faces)) => self.assemble(corners, faces, span),
            Err(why) => {
                let message = format!("{why}: the polyhedron is empty");
                self.diagnostics.warning(span, message);
                Polyhedron::Solid(Solid::empty())
            }
        }
    }

    /// A vector of vectors of numbers; a warning if it is something else.
    fn vectors(&mut self, arguments: &Arguments<'_>, name: &str) -> Option<Vec<Vec<f64>>> {
        let argument = arguments.get(name)?;
        let rows = match &argument.value {
            Value::Vector(rows) => rows.iter().map(Value::numbers).collect(),
            _ => None,
        };
        if rows.is_none() {
            let message = format!("`{name}` must be a vector of vectors of numbers");
            self.diagnostics.warning(argument.span, message);
        }
        rows
    }

    pub(super) fn assemble(
        &mut self,
        corners: Vec<DVec3>,
        mut faces: Vec<Vec<u32>>,
        span: Span,
    ) -> Polyhedron {
        let total = faces.iter().map(Vec::len).sum();
        if !self.budget.take_faces(total, span, self.diagnostics) {
            return Polyhedron::Solid(Solid::empty());
        }
        let oriented = orientation::orient(&mut faces);
        if oriented == Orientation::Repaired {
            let message = "the faces of this polyhedron are not all clockwise seen from outside; \
                           those that differ are turned round";
            self.diagnostics.warning(span, message);
        }
        let closed = oriented != Orientation::Impossible;
        if closed
            && faces.len().saturating_mul(corners.len()) <= CONVEX_TESTS
            && let Ok(convex) = ConvexPolyhedron::from_faces(corners.clone(), &faces)
        {
            return Polyhedron::Solid(Solid::convex(Arc::new(convex)));
        }
        let triangles = match triangulate(&corners, &faces) {
            Ok(triangles) => triangles,
            Err(error) => {
                let message = format!("{error}: the polyhedron is empty");
                self.diagnostics.warning(span, message);
                return Polyhedron::Solid(Solid::empty());
            }
        };
        let inside_out = closed && signed_volume(&corners, &triangles) < 0.0;
        if inside_out {
            faces.iter_mut().for_each(|face| face.reverse());
        }
        let triangles = if inside_out {
            let message = "the faces of this polyhedron are counter-clockwise seen from outside; \
                           they are turned round";
            self.diagnostics.warning(span, message);
            triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect()
        } else {
            triangles
        };
        if closed && let Ok(exact) = Solid::exact_polyhedron(&corners, &faces) {
            return Polyhedron::Solid(exact);
        }
        let mesh = match TriangleMesh::new(corners, triangles) {
            Ok(mesh) => Arc::new(mesh),
            Err(error) => {
                let message = format!("{error}: the polyhedron is empty");
                self.diagnostics.warning(span, message);
                return Polyhedron::Solid(Solid::empty());
            }
        };
        match mesh_solid(&mesh) {
            Ok((solid, doubt)) => {
                if let Some(doubt) = doubt {
                    self.diagnostics.warning(span, doubt);
                }
                Polyhedron::Solid(solid)
            }
            Err(error) => Polyhedron::Open(mesh, error.to_string()),
        }
    }
}

fn triangulate(corners: &[DVec3], faces: &[Vec<u32>]) -> Result<Vec<[u32; 3]>, TooComplex> {
    let mut triangulator = Triangulator::new();
    let mut triangles = Vec::new();
    for face in faces {
        let outline: Vec<DVec3> = face.iter().map(|&i| corners[i as usize]).collect();
        let local = triangulator.triangulate(&outline)?;
        triangles.extend(local.into_iter().map(|t| t.map(|i| face[i as usize])));
    }
    Ok(triangles)
}

type Indexed = (Vec<DVec3>, Vec<Vec<u32>>);

/// Distinct corners, and faces counter-clockwise seen from outside that name no corner twice in a
/// row.
fn corners_and_faces(points: &[Vec<f64>], rows: &[Vec<f64>]) -> Result<Indexed, String> {
    let mut corners = Vec::new();
    let mut ids = Vec::with_capacity(points.len());
    let mut known = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        let corner = match point[..] {
            [x, y] => DVec3::new(x, y, 0.0),
            [x, y, z] => DVec3::new(x, y, z),
            _ => return Err(format!("point {index} has not 2 or 3 coordinates")),
        };
        if !corner.is_finite() {
            return Err(format!("point {index} is not finite"));
        }
        // Adding 0 makes -0 the same as 0.
        let key = (corner + DVec3::ZERO).to_array().map(f64::to_bits);
        let id = *known.entry(key).or_insert_with(|| {
            corners.push(corner);
            corners.len() as u32 - 1
        });
        ids.push(id);
    }
    let mut faces = Vec::with_capacity(rows.len());
    for (number, row) in rows.iter().enumerate() {
        let mut face = Vec::with_capacity(row.len());
        for &index in row {
            let id = if index >= 0.0 {
                ids.get(index as usize)
            } else {
                None
            };
            let Some(&id) = id else {
                let count = ids.len();
                return Err(format!(
                    "face {number} uses point {index}, but there are {count}"
                ));
            };
            face.push(id);
        }
        face.reverse();
        face.dedup();
        while face.len() > 1 && face.first() == face.last() {
            face.pop();
        }
        if face.len() >= 3 {
            faces.push(face);
        }
    }
    if faces.is_empty() {
        return Err("there are no faces".to_owned());
    }
    Ok((corners, faces))
}

/// Positive if the triangles are counter-clockwise seen from outside.
fn signed_volume(corners: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let origin = corners.first().copied().unwrap_or_default();
    triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| corners[i as usize] - origin);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}
