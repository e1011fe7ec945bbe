//! Plane figures cut into trapezoids: what `polygon` is made of.

use std::cmp::Ordering;

use octray_math::DVec2;

/// Points of an outline this near to its first one close it.
pub(super) const CLOSED: f64 = 1e-9;

/// A piece of a figure between two heights: `left` and `right` at the lower one, then at the
/// upper one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trapezoid {
    pub(super) y: [f64; 2],
    pub(super) left: [f64; 2],
    pub(super) right: [f64; 2],
}

/// Splits a list of points into closed outlines: one ends where its first point comes again.
///
/// `None` where the last outline is not closed.
pub(super) fn outlines(points: &[DVec2]) -> Option<Vec<&[DVec2]>> {
    let mut all = Vec::new();
    let mut start = 0;
    while start < points.len() {
        let length = points[start + 1..]
            .iter()
            .position(|p| (*p - points[start]).length() < CLOSED)?;
        // The closing point repeats the first one and is dropped.
        all.push(&points[start..=start + length]);
        start += length + 2;
    }
    Some(all)
}

/// The figure within the outlines (even-odd rule) as trapezoids between the heights at which a
/// corner or a crossing of edges lies, from below and from the left. `None` where there would be
/// more than `limit`.
pub(super) fn trapezoids(outlines: &[&[DVec2]], limit: usize) -> Option<Vec<Trapezoid>> {
    let mut edges: Vec<[DVec2; 2]> = Vec::new();
    for outline in outlines {
        for (i, &a) in outline.iter().enumerate() {
            let b = outline[(i + 1) % outline.len()];
            match a.y.partial_cmp(&b.y) {
                Some(Ordering::Less) => edges.push([a, b]),
                Some(Ordering::Greater) => edges.push([b, a]),
                _ => {}
            }
        }
    }
    if edges.len().saturating_mul(edges.len()) > limit {
        return None;
    }
    let mut heights: Vec<f64> = edges.iter().flatten().map(|p| p.y).collect();
    for (i, a) in edges.iter().enumerate() {
        for b in &edges[i + 1..] {
            heights.extend(crossing_height(a, b));
        }
    }
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut made = Vec::new();
    for pair in heights.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let middle = 0.5 * (low + high);
        let mut spanning: Vec<_> = edges
            .iter()
            .filter(|e| e[0].y <= low && e[1].y >= high)
            .map(|e| (x_at(e, middle), x_at(e, low), x_at(e, high)))
            .collect();
        spanning.sort_by(|a, b| a.0.total_cmp(&b.0));
        for sides in spanning.chunks_exact(2) {
            let (l, r) = (sides[0], sides[1]);
            if r.0 > l.0 {
                made.push(Trapezoid {
                    y: [low, high],
                    left: [l.1, l.2],
                    right: [r.1.max(l.1), r.2.max(l.2)],
                });
            }
            if made.len() > limit {
                return None;
            }
        }
    }
    Some(made)
}

/// The edge's x at a height; its own ends exactly.
fn x_at(edge: &[DVec2; 2], y: f64) -> f64 {
    let [a, b] = edge;
    if y == a.y {
        a.x
    } else if y == b.y {
        b.x
    } else {
        a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y))
    }
}

/// Where two edges cross strictly inside both.
fn crossing_height(a: &[DVec2; 2], b: &[DVec2; 2]) -> Option<f64> {
    let (d, e) = (a[1] - a[0], b[1] - b[0]);
    let turn = d.perp_dot(e);
    if turn == 0.0 {
        return None;
    }
    let between = b[0] - a[0];
    let s = between.perp_dot(e) / turn;
    let t = between.perp_dot(d) / turn;
    let inside = |x: f64| x > 1e-12 && x < 1.0 - 1e-12;
    (inside(s) && inside(t)).then(|| a[0].y + d.y * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(all: &[Trapezoid]) -> f64 {
        let one = |t: &Trapezoid| {
            let widths = (t.right[0] - t.left[0]) + (t.right[1] - t.left[1]);
            0.5 * widths * (t.y[1] - t.y[0])
        };
        all.iter().map(one).sum()
    }

    #[test]
    fn a_square_with_a_square_hole_keeps_its_area() {
        let square = |r: f64| [(-r, -r), (r, -r), (r, r), (-r, r), (-r, -r)].map(DVec2::from);
        let points: Vec<DVec2> = square(2.0).into_iter().chain(square(1.0)).collect();
        let outlines = outlines(&points).expect("both are closed");
        assert_eq!(outlines.len(), 2);
        let all = trapezoids(&outlines, 1000).expect("few edges");
        assert!((area(&all) - 12.0).abs() < 1e-12);
    }

    #[test]
    fn a_bow_tie_is_two_triangles() {
        let points = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0), (0.0, 0.0)].map(DVec2::from);
        let all = trapezoids(&outlines(&points).expect("closed"), 1000).expect("few edges");
        assert!((area(&all) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_outline_is_refused() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(DVec2::from);
        assert!(outlines(&points).is_none());
    }
}
