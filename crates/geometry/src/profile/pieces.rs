//! Edges cut into pieces that bend one way only and lie on one side of their chords.

use octray_math::{DVec2, transform};
use robust::{Coord, orient2d};

use super::contour::changes;
use super::curve::Curve;
use super::region::Edge;
use crate::ShapeError;

/// Halvings of a curve before a piece that still bends both ways is taken for straight: it is then
/// 2^-24 of the curve long and flatter than rounding.
const MAX_HALVINGS: u32 = 24;

/// Coordinates beyond this would leave the range when multiplied.
const LARGEST: f64 = 1e100;

/// A part of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Piece {
    /// Straight.
    Line(DVec2, DVec2),
    /// A Bézier curve whose control polygon is convex.
    Bezier(Curve),
    /// A circular arc of at most a quarter turn.
    Arc { center: DVec2, ends: [DVec2; 2] },
}

impl Piece {
    pub(crate) const fn start(&self) -> DVec2 {
        match self {
            Self::Line(a, _) | Self::Arc { ends: [a, _], .. } => *a,
            Self::Bezier(curve) => curve.start(),
        }
    }

    pub(crate) const fn end(&self) -> DVec2 {
        match self {
            Self::Line(_, b) | Self::Arc { ends: [_, b], .. } => *b,
            Self::Bezier(curve) => curve.end(),
        }
    }

    pub(crate) fn curve(&self) -> Curve {
        match self {
            Self::Line(a, b) => Curve::line(*a, *b),
            Self::Bezier(curve) => *curve,
            Self::Arc { center, ends } => Curve::arc(*center, ends[0], ends[1]),
        }
    }

    /// Two pieces for one.
    pub(crate) fn halves(&self) -> [Self; 2] {
        match self {
            Self::Line(a, b) => {
                let middle = (*a + *b) * 0.5;
                [Self::Line(*a, middle), Self::Line(middle, *b)]
            }
            Self::Bezier(curve) => curve.halves().map(Self::Bezier),
            Self::Arc { center, ends } => {
                let [u, v] = ends.map(|p| p - *center);
                let radius = ((u.length_squared() + v.length_squared()) * 0.5).sqrt();
                let middle = *center + (u + v).normalize_or_zero() * radius;
                [[ends[0], middle], [middle, ends[1]]].map(|ends| Self::Arc {
                    center: *center,
                    ends,
                })
            }
        }
    }
}

/// Positive where `c` lies left of the line from `a` to `b`, with the sign exact.
pub(crate) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// Appends the pieces of one edge; none where it has no length.
pub(super) fn append(
    from: DVec2,
    edge: Edge,
    to: DVec2,
    pieces: &mut Vec<Piece>,
) -> Result<(), ShapeError> {
    // -0 and 0 are one coordinate.
    let clean = |p: DVec2| -> Result<DVec2, ShapeError> {
        if !p.is_finite() {
            let message = "has a coordinate that is not finite";
            return Err(ShapeError::BadProfile(message));
        }
        if p.abs().max_element() > LARGEST {
            return Err(ShapeError::BadProfile("is too large"));
        }
        Ok(p + DVec2::ZERO)
    };
    let (from, to) = (clean(from)?, clean(to)?);
    match edge {
        Edge::Line => push_line(from, to, pieces),
        Edge::Quadratic(c) => append_bezier(&Curve::bezier(&[from, clean(c)?, to]), 0, pieces),
        Edge::Cubic(c, d) => {
            let curve = Curve::bezier(&[from, clean(c)?, clean(d)?, to]);
            append_bezier(&curve, 0, pieces);
        }
        Edge::Arc { center, clockwise } => {
            append_arc(from, to, clean(center)?, clockwise, pieces)?;
        }
    }
    Ok(())
}

/// Appends what of a piece lies at `x >= 0`; for the rest, its projection onto the axis, so that
/// outlines stay closed and enclose the same at positive x.
pub(super) fn append_right_half(piece: &Piece, pieces: &mut Vec<Piece>) {
    let on_axis = |p: DVec2| DVec2::new(p.x.max(0.0), p.y);
    let curve = piece.curve();
    if curve.control().all(|p| p.x >= 0.0) {
        pieces.push(*piece);
        return;
    }
    if curve.control().all(|p| p.x <= 0.0) {
        push_line(on_axis(curve.start()), on_axis(curve.end()), pieces);
        return;
    }
    // Where x changes its sign; a curve that bends once does so at most twice.
    let x = curve.combined(1.0, 0.0, 0.0);
    let mut parts = Vec::new();
    let (mut rest, mut before) = (curve, 0.0);
    changes(
        &x,
        |u| x.evaluate(u),
        |u| {
            if u > before && u < 1.0 {
                let [part, after] = rest.split((u - before) / (1.0 - before));
                parts.push(part);
                (rest, before) = (after, u);
            }
        },
    );
    if parts.is_empty() && piece.start().x >= 0.0 && piece.end().x >= 0.0 {
        pieces.push(*piece);
        return;
    }
    parts.push(rest);
    let last = parts.len() - 1;
    for (i, part) in parts.into_iter().enumerate() {
        let is_right = part.at(0.5).x > 0.0;
        // Cut ends lie on the axis, up to the rounding taken away here.
        let at_axis = |p: DVec2| DVec2::new(0.0, p.y);
        let start = if i == 0 {
            on_axis(part.start())
        } else {
            at_axis(part.start())
        };
        let end = if i == last {
            on_axis(part.end())
        } else {
            at_axis(part.end())
        };
        match piece {
            Piece::Line(..) => push_line(start, end, pieces),
            _ if !is_right => push_line(start, end, pieces),
            Piece::Arc { center, .. } if start != end => pieces.push(Piece::Arc {
                center: *center,
                ends: [start, end],
            }),
            _ if start != end => pieces.push(Piece::Bezier(part.with_ends(start, end).clamped())),
            _ => {}
        }
    }
}

fn push_line(a: DVec2, b: DVec2, pieces: &mut Vec<Piece>) {
    if a != b {
        pieces.push(Piece::Line(a, b));
    }
}

fn append_bezier(curve: &Curve, halvings: u32, pieces: &mut Vec<Piece>) {
    let control: Vec<DVec2> = curve.control().collect();
    let (a, b) = (curve.start(), curve.end());
    // What rounding bends is straight: halved, it would be bent both ways for ever.
    let size = control
        .iter()
        .fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let rounding = 8.0 * f64::EPSILON * size * a.distance(b);
    let straight = a != b
        && control.iter().all(|&p| turn(a, b, p).abs() <= rounding)
        && control.windows(2).all(|w| (w[1] - w[0]).dot(b - a) >= 0.0);
    if straight || halvings == MAX_HALVINGS {
        push_line(a, b, pieces);
    } else if bends_once(&control) {
        pieces.push(Piece::Bezier(*curve));
    } else {
        for half in curve.halves() {
            append_bezier(&half, halvings + 1, pieces);
        }
    }
}

/// Whether the control polygon is convex and turns by less than a right angle: then the curve
/// lies in it, on one side of the chord.
fn bends_once(control: &[DVec2]) -> bool {
    let (Some(&a), Some(&b)) = (control.first(), control.last()) else {
        return false;
    };
    let inner = &control[1..control.len() - 1];
    let forward = |w: &[DVec2]| (w[1] - w[0]).dot(b - a) >= 0.0;
    let side = |sign: f64| {
        let clear = |p: &DVec2| turn(a, b, *p) * sign > 0.0;
        let bent = |w: &[DVec2]| turn(w[0], w[1], w[2]) * sign <= 0.0;
        inner.iter().any(clear)
            && inner.iter().all(|p| turn(a, b, *p) * sign >= 0.0)
            && control.windows(3).all(bent)
    };
    a != b && control.windows(2).all(forward) && (side(1.0) || side(-1.0))
}

fn append_arc(
    from: DVec2,
    to: DVec2,
    center: DVec2,
    clockwise: bool,
    pieces: &mut Vec<Piece>,
) -> Result<(), ShapeError> {
    let (u, v) = (from - center, to - center);
    let (radius, other) = (u.length(), v.length());
    if !(radius > 0.0 && (radius - other).abs() <= 1e-6 * radius) {
        let message = "has an arc whose ends are not equally far from its centre";
        return Err(ShapeError::BadProfile(message));
    }
    let sign = if clockwise { -1.0 } else { 1.0 };
    let degrees = if from == to {
        360.0
    } else {
        let angle = libm::atan2(sign * u.perp_dot(v), u.dot(v)).to_degrees();
        if angle > 0.0 { angle } else { angle + 360.0 }
    };
    let count = libm::ceil(degrees / 90.0 - 1e-12).max(1.0);
    let mut last = from;
    for i in 1..=count as u32 {
        let next = if f64::from(i) == count {
            to
        } else {
            let turn = sign * degrees * f64::from(i) / count;
            let (sin, cos) = transform::sin_cos_degrees(turn);
            center + DVec2::new(u.x * cos - u.y * sin, u.x * sin + u.y * cos)
        };
        if last != next {
            let ends = [last, next];
            pieces.push(Piece::Arc { center, ends });
        }
        last = next;
    }
    Ok(())
}
