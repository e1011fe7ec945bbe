//! Plane regions: what prisms and lathes are made of.

use octray_math::{DAffine3, DVec2};

use super::pieces::{self, Piece};
use crate::ShapeError;

/// The most edges a region may have.
pub const MAX_EDGES: usize = 1 << 20;

/// Products of smaller sizes would leave the range.
const SMALLEST: f64 = 1e-100;

/// How an outline goes on to its next point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// Straight.
    Line,
    /// A quadratic Bézier curve with this control point.
    Quadratic(DVec2),
    /// A cubic Bézier curve with these control points.
    Cubic(DVec2, DVec2),
    /// A circular arc about this centre; a whole circle if it ends where it began.
    Arc {
        /// As far from both ends.
        center: DVec2,
        /// Which way round.
        clockwise: bool,
    },
}

/// A closed curve of edges in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    start: DVec2,
    edges: Vec<(Edge, DVec2)>,
}

impl Outline {
    /// One that begins here.
    #[must_use]
    pub const fn starting_at(start: DVec2) -> Self {
        Self {
            start,
            edges: Vec::new(),
        }
    }

    /// The polygon with these corners; the last one is joined to the first.
    #[must_use]
    pub fn polygon(corners: &[DVec2]) -> Self {
        let mut outline = Self::starting_at(corners.first().copied().unwrap_or_default());
        for &corner in corners.iter().skip(1) {
            outline.push(Edge::Line, corner);
        }
        outline
    }

    /// A circle.
    #[must_use]
    pub fn circle(center: DVec2, radius: f64) -> Self {
        let start = center + DVec2::X * radius;
        let mut outline = Self::starting_at(start);
        let clockwise = false;
        outline.push(Edge::Arc { center, clockwise }, start);
        outline
    }

    /// Goes on along `edge` to `to`.
    pub fn push(&mut self, edge: Edge, to: DVec2) {
        self.edges.push((edge, to));
    }

    /// The edges with their ends, closed by a straight one where the last does not end at the
    /// start.
    pub(super) fn closed(&self) -> impl Iterator<Item = (DVec2, Edge, DVec2)> + '_ {
        let last = self.edges.last().map_or(self.start, |(_, to)| *to);
        let closing = (last != self.start).then_some((Edge::Line, self.start));
        let edges = self.edges.iter().copied().chain(closing);
        edges.scan(self.start, |from, (edge, to)| {
            let edge = (*from, edge, to);
            *from = to;
            Some(edge)
        })
    }
}

/// A bounded region of the plane: the points that an odd number of outlines goes round.
///
/// Outlines may be in any order and orientation, be nested, touch, cross and repeat points.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    pub(super) pieces: Vec<Piece>,
    bounds: [DVec2; 2],
}

impl Region {
    /// The region within these outlines.
    ///
    /// # Errors
    /// A coordinate is not finite, an arc's ends are not equally far from its centre (within 1e-6
    /// of its radius), there are more than [`MAX_EDGES`] edges, or nothing that could enclose an area.
    pub fn new(outlines: &[Outline]) -> Result<Self, ShapeError> {
        let count: usize = outlines.iter().map(|o| o.edges.len() + 1).sum();
        if count > MAX_EDGES {
            return Err(ShapeError::BadProfile("has too many edges"));
        }
        let mut pieces = Vec::with_capacity(count);
        for outline in outlines {
            for (from, edge, to) in outline.closed() {
                pieces::append(from, edge, to, &mut pieces)?;
            }
        }
        Self::of_pieces(pieces)
    }

    /// What its outlines have been cut into.
    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The region whose outlines are made of these pieces, in any order.
    ///
    /// # Errors
    /// Like [`Region::new`]; the outlines are not closed.
    pub(crate) fn from_pieces(pieces: Vec<Piece>) -> Result<Self, ShapeError> {
        let control = |piece: &Piece| piece.curve().control().all(DVec2::is_finite);
        if !pieces.iter().all(control) {
            let message = "has a coordinate that is not finite";
            return Err(ShapeError::BadProfile(message));
        }
        // Every start is an end.
        let sorted = |end: fn(&Piece) -> DVec2| {
            let mut all: Vec<[f64; 2]> = pieces
                .iter()
                // Adding 0 makes -0 the same as 0.
                .map(|p| (end(p) + DVec2::ZERO).to_array())
                .collect();
            all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            all
        };
        if sorted(Piece::start) != sorted(Piece::end) {
            return Err(ShapeError::BadProfile("has an outline that is not closed"));
        }
        Self::of_pieces(pieces)
    }

    fn of_pieces(pieces: Vec<Piece>) -> Result<Self, ShapeError> {
        let Some(first) = pieces.first() else {
            return Err(ShapeError::BadProfile("has no area"));
        };
        let mut bounds = first.curve().bounds();
        for piece in &pieces {
            let [low, high] = piece.curve().bounds();
            bounds = [bounds[0].min(low), bounds[1].max(high)];
        }
        if !(bounds[1] - bounds[0]).is_finite() {
            return Err(ShapeError::BadProfile("is too large"));
        }
        let size = bounds[1] - bounds[0];
        if size.min_element() <= 0.0 {
            return Err(ShapeError::BadProfile("has no area"));
        }
        if size.max_element() < SMALLEST {
            return Err(ShapeError::BadProfile("is too small"));
        }
        Ok(Self { pieces, bounds })
    }

    /// The region under the part of an affine map that concerns the xy plane. Arcs stay arcs where
    /// it keeps circles round.
    ///
    /// # Errors
    /// What comes out has no area or is too large.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, ShapeError> {
        let (x, y) = (map.matrix3.x_axis.truncate(), map.matrix3.y_axis.truncate());
        let shift = map.translation.truncate();
        // Adding 0 makes -0 the same as 0.
        let place = |p: DVec2| x * p.x + y * p.y + shift + DVec2::ZERO;
        let (a, b) = (x.length_squared(), y.length_squared());
        let is_round =
            (a - b).abs() <= 4.0 * f64::EPSILON * a && x.dot(y).abs() <= 4.0 * f64::EPSILON * a;
        let pieces = self.pieces.iter().map(|piece| match piece {
            Piece::Line(a, b) => Piece::Line(place(*a), place(*b)),
            Piece::Arc { center, ends } if is_round => Piece::Arc {
                center: place(*center),
                ends: ends.map(place),
            },
            curved => Piece::Bezier(curved.curve().mapped(&place)),
        });
        Self::of_pieces(
            pieces
                .filter(|piece| piece.start() != piece.end())
                .collect(),
        )
    }

    /// The part at `x >= 0`, for a lathe.
    ///
    /// # Errors
    /// That part has no area.
    pub fn right_half(&self) -> Result<Self, ShapeError> {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        for piece in &self.pieces {
            pieces::append_right_half(piece, &mut pieces);
        }
        Self::of_pieces(pieces)
    }

    /// The region within one polygon.
    ///
    /// # Errors
    /// Like [`Region::new`].
    pub fn polygon(corners: &[DVec2]) -> Result<Self, ShapeError> {
        Self::new(&[Outline::polygon(corners)])
    }

    /// A box around it: lowest and highest corner.
    #[must_use]
    pub const fn bounds(&self) -> [DVec2; 2] {
        self.bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;
    use proptest::prelude::*;

    fn odd_number() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => (-3..=3_i32).prop_map(f64::from),
            1 => prop_oneof![Just(-0.0), Just(1e-17), Just(1e-300), Just(0.1), Just(0.3)],
            1 => (-4..=4_i32).prop_map(|ulps| 1.0 + f64::from(ulps) * f64::EPSILON),
            1 => prop_oneof![Just(1e99), Just(1e101), Just(f64::NAN), Just(f64::INFINITY)],
        ]
    }

    fn point() -> impl Strategy<Value = DVec2> {
        (odd_number(), odd_number()).prop_map(|(x, y)| DVec2::new(x, y))
    }

    fn outline() -> impl Strategy<Value = Outline> {
        let step = (0..5_u32, point(), point(), point());
        (point(), proptest::collection::vec(step, 0..8)).prop_map(|(start, steps)| {
            let mut outline = Outline::starting_at(start);
            for (kind, a, b, to) in steps {
                let edge = match kind {
                    0 => Edge::Quadratic(a),
                    1 => Edge::Cubic(a, b),
                    2 => Edge::Arc {
                        center: a,
                        clockwise: b.x > 0.0,
                    },
                    _ => Edge::Line,
                };
                outline.push(edge, to);
            }
            outline
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn any_outline_is_refused_or_made_with_few_pieces(
            outlines in proptest::collection::vec(outline(), 0..3),
        ) {
            if let Ok(region) = Region::new(&outlines) {
                prop_assert!(region.pieces.len() < 2000, "{}", region.pieces.len());
                let made = [Solid::prism(&region, 0.0, 1.0), Solid::lathe(&region)];
                for solid in made.into_iter().flatten() {
                    prop_assert!(solid.bounds().is_bounded());
                }
            }
        }
    }
}
