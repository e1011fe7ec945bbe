//! `polygon`, `prism` and `lathe`.

use std::sync::Arc;

use octray_geometry::{ConvexPolyhedron, ShapeError, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec2, DVec3};

use super::object::{Geometry, MeshDef};
use super::primitives::conical;
use super::profile::{self, Trapezoid};
use super::reader::{Parsed, Reader};
use crate::Span;

/// How many pieces a figure may be cut into.
const MAX_PIECES: usize = 4_000_000;

impl Reader<'_> {
    fn point_count(&mut self) -> Parsed<usize> {
        let count = self.float()?;
        self.comma();
        if !(1.0..1e6).contains(&count) {
            return self.fail(self.last, format!("{count} is no usable number of points"));
        }
        Ok(count as usize)
    }

    fn plane_points(&mut self, count: usize) -> Parsed<Vec<DVec2>> {
        let mut points = Vec::new();
        for _ in 0..count {
            self.book(16)?;
            let v = self.terms()?;
            points.push(DVec2::new(v.v[0], v.v[1]));
            self.comma();
        }
        if points.iter().any(|p| !p.is_finite()) {
            return self.fail(self.last, "a point is not finite");
        }
        Ok(points)
    }

    fn cut(&mut self, points: &[DVec2], span: Span) -> Parsed<Vec<Trapezoid>> {
        let Some(outlines) = profile::outlines(points) else {
            let message = "an outline is not closed: its last point must repeat its first";
            return self.fail(span, message);
        };
        match profile::trapezoids(&outlines, MAX_PIECES) {
            Some(pieces) => {
                self.book(400 * pieces.len() as u64)?;
                Ok(pieces)
            }
            None => self.halt(span, "this figure has too many corners"),
        }
    }

    /// `count, <x, y>, ...`: a flat figure.
    pub(super) fn polygon(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let count = self.point_count()?;
        let mut corners = Vec::new();
        for _ in 0..count {
            self.book(24)?;
            corners.push(self.vector()?);
            self.comma();
        }
        let Some(plane) = plane_of(&corners) else {
            self.warn(span, "this `polygon` is left out: it has no area");
            return Ok(None);
        };
        let inverse = plane.inverse();
        let flat: Vec<DVec3> = corners
            .iter()
            .map(|c| inverse.transform_point3(*c))
            .collect();
        let size = flat.iter().fold(0.0, |size: f64, p| size.max(p.length()));
        if flat.iter().any(|p| p.z.abs() > 1e-6 * size) {
            return self.fail(span, "the points of this polygon do not lie in one plane");
        }
        let points: Vec<DVec2> = flat.iter().map(|p| DVec2::new(p.x, p.y)).collect();
        let pieces = self.cut(&points, span)?;
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for piece in &pieces {
            let first = positions.len() as u32;
            for (x, y) in [
                (piece.left[0], piece.y[0]),
                (piece.right[0], piece.y[0]),
                (piece.right[1], piece.y[1]),
                (piece.left[1], piece.y[1]),
            ] {
                positions.push(plane.transform_point3(DVec3::new(x, y, 0.0)));
            }
            triangles.push([first, first + 1, first + 2]);
            triangles.push([first, first + 2, first + 3]);
        }
        match TriangleMesh::new(positions, triangles) {
            Ok(mesh) => Ok(Some(Geometry::Mesh(MeshDef {
                mesh: Arc::new(mesh),
                texture_of: Vec::new(),
                textures: Vec::new(),
                has_inside: false,
            }))),
            Err(error) => self.fail(span, format!("this polygon is not usable: {error}")),
        }
    }

    /// `[linear_spline] [linear_sweep] height, height, count, <x, z>, ...`.
    pub(super) fn prism(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut conic = false;
        while let Some(word) = self.peek_word() {
            match &*word {
                "linear_spline" | "linear_sweep" => {}
                "conic_sweep" => conic = true,
                "quadratic_spline" | "cubic_spline" | "bezier_spline" => {
                    return self.curved("prism");
                }
                _ => break,
            }
            self.next();
        }
        let a = self.float()?;
        self.comma();
        let b = self.float()?;
        self.comma();
        let count = self.point_count()?;
        let points = self.plane_points(count)?;
        let pieces = self.cut(&points, span)?;
        self.eat_word("open");
        let heights = [a.min(b), a.max(b)];
        let solids = pieces
            .iter()
            .flat_map(|piece| prism_piece(piece, heights, conic));
        Ok(self.joined("prism", span, solids))
    }

    /// `[linear_spline] count, <x, y>, ...`: turned about the y axis.
    pub(super) fn lathe(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        while let Some(word) = self.peek_word() {
            match &*word {
                "linear_spline" => {
                    self.next();
                }
                "quadratic_spline" | "cubic_spline" | "bezier_spline" => {
                    return self.curved("lathe");
                }
                _ => break,
            }
        }
        let count = self.point_count()?;
        let mut points = self.plane_points(count)?;
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            return Ok(None);
        };
        if first.x == 0.0 && last.x == 0.0 {
            // The axis closes it.
            points.push(first);
        }
        if profile::outlines(&points).is_none() {
            return Ok(self.usable("lathe", span, open_lathe(&points)));
        }
        let pieces = self.cut(&points, span)?;
        Ok(self.joined("lathe", span, pieces.iter().map(lathe_piece)))
    }

    /// The union of the pieces that have a volume; slivers that rounding has flattened have none.
    fn joined(
        &mut self,
        word: &str,
        span: Span,
        pieces: impl Iterator<Item = Result<Solid, ShapeError>>,
    ) -> Option<Geometry> {
        let mut solids = Vec::new();
        let mut failed = ShapeError::BadPolyhedron("flat");
        for piece in pieces {
            match piece {
                Ok(solid) => solids.push(solid),
                Err(error) => failed = error,
            }
        }
        let made = if solids.is_empty() {
            Err(failed)
        } else {
            Ok(Geometry::Solid(Solid::union(solids)))
        };
        self.usable(word, span, made)
    }

    fn curved(&mut self, word: &str) -> Parsed<Option<Geometry>> {
        let token = self.next();
        let message = format!("a {word} of curves is not supported: it is left out");
        self.warn(token.span, message);
        // The numbers up to the modifiers.
        loop {
            let token = self.peek();
            let modifier = token.word().is_some_and(|w| {
                !matches!(
                    &**w,
                    "linear_sweep" | "conic_sweep" | "x" | "y" | "z" | "u" | "v"
                )
            });
            if token.is("}") || modifier || token.kind == super::lexer::Kind::End {
                return Ok(None);
            }
            if token.is(",") || token.word().is_some() {
                self.next();
            } else {
                self.terms()?;
            }
        }
    }
}

/// A frame in whose xy plane the points lie.
fn plane_of(points: &[DVec3]) -> Option<DAffine3> {
    let origin = *points.first()?;
    let far = points
        .iter()
        .map(|p| *p - origin)
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    let normal = points
        .iter()
        .map(|p| far.cross(*p - origin))
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?
        .try_normalize()?;
    let x = far.try_normalize()?;
    Some(DAffine3::from_cols(x, normal.cross(x), normal, origin))
}

/// The prisms over one trapezoid; two where it crosses the apex of a conic sweep.
fn prism_piece(
    piece: &Trapezoid,
    heights: [f64; 2],
    conic: bool,
) -> Vec<Result<Solid, ShapeError>> {
    let ranges = if conic && heights[0] < 0.0 && heights[1] > 0.0 {
        vec![[heights[0], 0.0], [0.0, heights[1]]]
    } else {
        vec![heights]
    };
    let solid = |range: [f64; 2]| {
        let ring = |y: f64| {
            let s = if conic { y } else { 1.0 };
            [
                (piece.left[0], piece.y[0]),
                (piece.right[0], piece.y[0]),
                (piece.right[1], piece.y[1]),
                (piece.left[1], piece.y[1]),
            ]
            .map(|(x, z)| DVec3::new(x * s, y, z * s))
        };
        let (low, high) = (ring(range[0]), ring(range[1]));
        let mut corners: Vec<DVec3> = Vec::new();
        let mut index = |p: DVec3| {
            let known = corners.iter().position(|q| *q == p);
            known.unwrap_or_else(|| {
                corners.push(p);
                corners.len() - 1
            }) as u32
        };
        let quads = [
            low,
            high,
            [low[0], low[1], high[1], high[0]],
            [low[1], low[2], high[2], high[1]],
            [low[2], low[3], high[3], high[2]],
            [low[3], low[0], high[0], high[3]],
        ];
        let mut faces: Vec<Vec<u32>> = Vec::new();
        for quad in quads {
            let mut face: Vec<u32> = quad.into_iter().map(&mut index).collect();
            face.dedup();
            if face.len() > 1 && face.first() == face.last() {
                face.pop();
            }
            if face.len() >= 3 {
                faces.push(face);
            }
        }
        let polyhedron = ConvexPolyhedron::from_faces(corners, &faces)?;
        Ok(Solid::convex(Arc::new(polyhedron)))
    };
    ranges.into_iter().map(solid).collect()
}

/// One trapezoid turned about the y axis: a frustum less the frustum within.
fn lathe_piece(piece: &Trapezoid) -> Result<Solid, ShapeError> {
    let frustum = |r: [f64; 2]| -> Result<Solid, ShapeError> {
        let [a, b] = piece.y.map(|y| DVec3::new(0.0, y, 0.0));
        match conical(a, r[0], b, r[1], false)? {
            Geometry::Solid(solid) => Ok(solid),
            _ => Ok(Solid::empty()),
        }
    };
    let outer = frustum(piece.right.map(f64::abs))?;
    if piece.left[0] <= 0.0 && piece.left[1] <= 0.0 {
        return Ok(outer);
    }
    Ok(Solid::difference([
        outer,
        frustum(piece.left.map(|x| x.max(0.0)))?,
    ]))
}

/// A profile that is not closed: the surface alone.
fn open_lathe(points: &[DVec2]) -> Result<Geometry, ShapeError> {
    let mut parts = Vec::new();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if a == b {
            continue;
        }
        let part = if a.y == b.y {
            let (inner, outer) = (a.x.abs().min(b.x.abs()), a.x.abs().max(b.x.abs()));
            Geometry::Sheet(Sheet::disc(
                DVec3::new(0.0, a.y, 0.0),
                DVec3::Y,
                outer,
                inner,
            )?)
        } else {
            let [p, q] = [a.y, b.y].map(|y| DVec3::new(0.0, y, 0.0));
            conical(p, a.x.abs(), q, b.x.abs(), true)?
        };
        parts.push(part);
    }
    Ok(Geometry::Sheets(parts))
}
