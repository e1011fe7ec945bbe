//! `polygon`, `prism` and `lathe`.

use std::sync::Arc;

use octray_geometry::profile::{self, Edge, Outline, Region};
use octray_geometry::{ShapeError, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DMat3, DVec2, DVec3};

use super::object::{Geometry, MeshDef};
use super::primitives::conical;
use super::profile::{CLOSED, Trapezoid, outlines, trapezoids};
use super::reader::{Parsed, Reader};
use super::splines::Spline;
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
        let Some(outlines) = outlines(points) else {
            let message = "an outline is not closed: its last point must repeat its first";
            return self.fail(span, message);
        };
        match trapezoids(&outlines, MAX_PIECES) {
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

    /// `[SPLINE] [SWEEP] height, height, count, <x, z>, ...`.
    pub(super) fn prism(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut conic = false;
        let mut spline = Spline::Linear;
        while let Some(word) = self.peek_word() {
            match (&*word, Spline::called(&word)) {
                (_, Some(called)) => spline = called,
                ("linear_sweep", _) => conic = false,
                ("conic_sweep", _) => conic = true,
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
        self.eat_word("open");
        let Some(outlines) = spline.outlines(&points) else {
            return self.fail(span, spline.complaint());
        };
        self.book(400 * points.len() as u64)?;
        let heights = [a.min(b), a.max(b)];
        let made = Region::new(&outlines).and_then(|region| swept(&region, heights, conic));
        Ok(self.usable("prism", span, made.map(Geometry::Solid)))
    }

    /// `[SPLINE] count, <x, y>, ...`: turned about the y axis.
    pub(super) fn lathe(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut spline = Spline::Linear;
        while let Some(word) = self.peek_word() {
            let Some(called) = Spline::called(&word) else {
                break;
            };
            spline = called;
            self.next();
        }
        let count = self.point_count()?;
        let mut points = self.plane_points(count)?;
        // Distances from the axis; POV-Ray too turns the other side.
        points.iter_mut().for_each(|p| p.x = p.x.abs());
        let Some((start, edges)) = spline.curve(&points) else {
            return self.fail(span, "there are too few points for this spline");
        };
        self.book(400 * points.len() as u64)?;
        let end = edges.last().map_or(start, |(_, to)| *to);
        let is_closed = end.distance(start) < CLOSED || (start.x == 0.0 && end.x == 0.0);
        let made = if is_closed {
            let mut outline = Outline::starting_at(start);
            for &(edge, to) in &edges {
                outline.push(edge, to);
            }
            let turned = Region::new(&[outline])
                .and_then(|region| region.right_half())
                .and_then(|region| Solid::lathe(&region)?.transform(upright()));
            turned.map(Geometry::Solid)
        } else {
            open_lathe(start, &edges)
        };
        Ok(self.usable("lathe", span, made))
    }
}

/// From the plane's coordinates and the height to POV-Ray's x, z and y.
fn upright() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y))
}

/// The region between two heights, as large as the height where it is `conic`.
fn swept(region: &Region, heights: [f64; 2], conic: bool) -> Result<Solid, ShapeError> {
    if !conic {
        return Solid::prism(region, heights[0], heights[1])?.transform(upright());
    }
    let mut parts = Vec::new();
    let [low, high] = heights;
    if high > 0.0 {
        let z = [low.max(0.0), high];
        parts.push(Solid::tapered_prism(region, z, z)?);
    }
    if low < 0.0 {
        // Below, the region is seen through the apex.
        let turned = region.transformed(&DAffine3::from_scale(DVec3::new(-1.0, -1.0, 1.0)))?;
        let z = [low, high.min(0.0)];
        parts.push(Solid::tapered_prism(&turned, z, z.map(f64::abs))?);
    }
    Solid::union(parts).transform(upright())
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

/// A profile that is not closed: the surface alone.
fn open_lathe(start: DVec2, edges: &[(Edge, DVec2)]) -> Result<Geometry, ShapeError> {
    let mut parts = Vec::new();
    let mut a = start;
    for &(edge, b) in edges {
        if edge != Edge::Line {
            for shell in profile::turned_shells(a, edge, b)? {
                parts.push(Geometry::Sheet(shell.transform(upright())?));
            }
        } else if a.y == b.y && a != b {
            let (inner, outer) = (a.x.min(b.x), a.x.max(b.x));
            let center = DVec3::new(0.0, a.y, 0.0);
            let disc = Sheet::disc(center, DVec3::Y, outer, inner)?;
            parts.push(Geometry::Sheet(disc));
        } else if a != b {
            let [p, q] = [a.y, b.y].map(|y| DVec3::new(0.0, y, 0.0));
            parts.push(conical(p, a.x, q, b.x, true)?);
        }
        a = b;
    }
    Ok(Geometry::Sheets(parts))
}
