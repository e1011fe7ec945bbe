//! Surfaces of revolution of curves that enclose nothing.

use octray_math::DVec2;

use super::pieces::{self, Piece, turn};
use super::region::{Edge, Outline, Region};
use crate::{ShapeError, Sheet, Solid};

/// The surface that one curved edge from `a` to `b` sweeps when it turns about the z axis (x is
/// the distance from it, y the height), in parts.
///
/// # Errors
/// A coordinate is not finite or on the other side of the axis, or an arc's ends do not fit its
/// centre. Straight edges have no part here: they are cones, cylinders and discs.
pub fn turned_shells(a: DVec2, edge: Edge, b: DVec2) -> Result<Vec<Sheet>, ShapeError> {
    let mut all = Vec::new();
    pieces::append(a, edge, b, &mut all)?;
    let curved = all.iter().filter(|p| !matches!(p, Piece::Line(..)));
    curved.map(shell).collect()
}

/// The curve closed behind its chord, as far as it lies in its control polygon: there the closing
/// lines are not.
fn shell(piece: &Piece) -> Result<Sheet, ShapeError> {
    let curve = piece.curve();
    let (a, b) = (piece.start(), piece.end());
    let control: Vec<DVec2> = curve.control().collect();
    let left = control.iter().any(|p| turn(a, b, *p) > 0.0);
    let away = if left {
        -(b - a).perp()
    } else {
        (b - a).perp()
    };
    let middle = (a + b) * 0.5;
    let room = if away.x < 0.0 {
        (0.5 * middle.x / -away.x).min(0.5)
    } else {
        0.5
    };
    let mut outline = Outline::starting_at(a);
    let edge = match (piece, &control[..]) {
        (Piece::Arc { center, .. }, _) => Edge::Arc {
            center: *center,
            clockwise: left,
        },
        (_, [_, c, _]) => Edge::Quadratic(*c),
        (_, [_, c, d, _]) => Edge::Cubic(*c, *d),
        _ => Edge::Line,
    };
    outline.push(edge, b);
    outline.push(Edge::Line, middle + away * room);
    let solid = Solid::lathe(&Region::new(&[outline])?)?;
    let clip = Solid::lathe(&Region::polygon(&control)?.right_half()?)?;
    Ok(Sheet::Shell { solid, clip })
}
