//! The splines of `prism` and `lathe` as lines and Bézier curves.
//!
//! Which points count for what is in the POV-Ray 3.7 documentation, sections 3.4.4.1.5 (lathe) and
//! 3.4.4.1.8 (prism): quadratic splines begin with a point off the curve, cubic ones also end with
//! one, Bézier splines name four points per piece.

use octray_geometry::profile::{Edge, Outline};
use octray_math::DVec2;

use super::profile::CLOSED;

/// How points become a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spline {
    Linear,
    Quadratic,
    Cubic,
    Bezier,
}

/// A curve: how it goes on, and to where.
pub(super) type Edges = Vec<(Edge, DVec2)>;

impl Spline {
    pub(super) fn called(word: &str) -> Option<Self> {
        match word {
            "linear_spline" => Some(Self::Linear),
            "quadratic_spline" => Some(Self::Quadratic),
            "cubic_spline" => Some(Self::Cubic),
            "bezier_spline" => Some(Self::Bezier),
            _ => None,
        }
    }

    /// What is wrong with points that make no closed outlines.
    pub(super) const fn complaint(self) -> &'static str {
        match self {
            Self::Linear => "an outline is not closed: its last point must repeat its first",
            Self::Quadratic => "an outline is not closed: its last point must repeat its second",
            Self::Cubic => {
                "an outline is not closed: its last point but one must repeat its second"
            }
            Self::Bezier => {
                "an outline is not closed: the fourth point of its last piece must repeat the \
                 first of its first"
            }
        }
    }

    /// How many points before and after the curve shape it without lying on it.
    const fn outer(self) -> (usize, usize) {
        match self {
            Self::Linear | Self::Bezier => (0, 0),
            Self::Quadratic => (1, 0),
            Self::Cubic => (1, 1),
        }
    }

    /// The one curve through all points; `None` if there are too few.
    pub(super) fn curve(self, points: &[DVec2]) -> Option<(DVec2, Edges)> {
        let mut edges = Vec::new();
        if self == Self::Bezier {
            let pieces = points.chunks_exact(4);
            for piece in pieces {
                // Pieces that do not join are joined by a line.
                if let Some((_, last)) = edges.last()
                    && *last != piece[0]
                {
                    edges.push((Edge::Line, piece[0]));
                }
                edges.push((Edge::Cubic(piece[1], piece[2]), piece[3]));
            }
        } else {
            let (before, after) = self.outer();
            let last = points.len().checked_sub(1 + after)?;
            for i in before..last {
                edges.push((self.edge(points, i), points[i + 1]));
            }
        }
        let start = *points.get(self.outer().0)?;
        (!edges.is_empty()).then_some((start, edges))
    }

    /// From point `i` to the next.
    fn edge(self, points: &[DVec2], i: usize) -> Edge {
        let (b, c) = (points[i], points[i + 1]);
        match self {
            // The parabola that is at `a`, `b` and `c` at times -1, 0 and 1.
            Self::Quadratic => Edge::Quadratic(b + (c - points[i - 1]) * 0.25),
            // Catmull and Rom: in `b` it runs parallel to `a c`, in `c` to `b d`.
            Self::Cubic => {
                Edge::Cubic(b + (c - points[i - 1]) / 6.0, c - (points[i + 2] - b) / 6.0)
            }
            Self::Linear | Self::Bezier => Edge::Line,
        }
    }

    /// Closed outlines one after the other; `None` where the last one is not closed.
    pub(super) fn outlines(self, points: &[DVec2]) -> Option<Vec<Outline>> {
        let (before, after) = self.outer();
        let mut all = Vec::new();
        let mut from = 0;
        while from < points.len() {
            let rest = &points[from..];
            let first = *rest.get(before)?;
            let ends_a_piece = |i: &usize| self != Self::Bezier || (i + 1).is_multiple_of(4);
            let last = (before + 1..rest.len())
                .filter(ends_a_piece)
                .find(|&i| rest[i].distance(first) < CLOSED)?;
            let length = last + 1 + after;
            let own = rest.get(..length)?;
            let (start, mut edges) = self.curve(own)?;
            if let Some(end) = edges.last_mut() {
                end.1 = start;
            }
            let mut outline = Outline::starting_at(start);
            for (edge, to) in edges {
                outline.push(edge, to);
            }
            all.push(outline);
            from += length;
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<DVec2> {
        all.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    #[test]
    fn every_spline_passes_its_points() {
        let all = points(&[
            (9.0, 9.0),
            (0.0, 0.0),
            (2.0, 0.0),
            (1.0, 2.0),
            (0.0, 0.0),
            (5.0, 1.0),
        ]);
        let count = |spline: Spline, points: &[DVec2]| {
            let outlines = spline.outlines(points);
            outlines.map(|all| all.len())
        };
        assert_eq!(count(Spline::Linear, &all[1..5]), Some(1));
        assert_eq!(count(Spline::Quadratic, &all[..5]), Some(1));
        assert_eq!(count(Spline::Cubic, &all), Some(1));
        assert_eq!(count(Spline::Cubic, &all[..5]), None);
        assert_eq!(count(Spline::Linear, &all[..5]), None);
        let twice = [&all[..], &all[..]].concat();
        assert_eq!(count(Spline::Cubic, &twice), Some(2));
        let drop = points(&[(0.0, 0.0), (2.0, 1.0), (-2.0, 1.0), (0.0, 0.0)]);
        assert_eq!(count(Spline::Bezier, &drop), Some(1));
        assert_eq!(count(Spline::Bezier, &drop[..3]), None);
    }

    #[test]
    fn curves_are_those_of_the_formulas() {
        let all = points(&[(0.0, 0.0), (1.0, 0.0), (3.0, 2.0), (4.0, 0.0)]);
        let (start, edges) = Spline::Quadratic.curve(&all).expect("four points");
        assert_eq!((start, edges.len()), (all[1], 2));
        // B t^2 + C t + D with B = (a - 2 b + c) / 2, C = (c - a) / 2, D = b, at t = 1/2.
        let Edge::Quadratic(control) = edges[0].0 else {
            panic!("{edges:?}");
        };
        let middle = (all[1] + control * 2.0 + all[2]) * 0.25;
        let expected = (all[0] - all[1] * 2.0 + all[2]) * 0.125 + (all[2] - all[0]) * 0.25 + all[1];
        assert!(middle.distance(expected) < 1e-15);
        let (_, edges) = Spline::Cubic.curve(&all).expect("four points");
        let [(Edge::Cubic(c, d), end)] = edges[..] else {
            panic!("{edges:?}");
        };
        assert_eq!(end, all[2]);
        let middle = (all[1] + c * 3.0 + d * 3.0 + all[2]) * 0.125;
        let expected = (all[1] + all[2]) * 0.5625 - (all[0] + all[3]) * 0.0625;
        assert!(middle.distance(expected) < 1e-15);
    }
}
