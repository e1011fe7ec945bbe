//! Random plane regions, and independently of them which points are inside.

use octray_geometry::profile::{Edge, Outline, Region};
use octray_math::DVec2;
use proptest::prelude::*;

/// How far the straight pieces below may be from the curves they stand for.
const FLATNESS: f64 = 4e-3;

/// A region, and its outlines as many short straight pieces.
#[derive(Clone)]
pub(crate) struct Profile {
    pub(crate) region: Region,
    outlines: Vec<(DVec2, Vec<(Edge, DVec2)>)>,
    pieces: Vec<[DVec2; 2]>,
    is_curved: bool,
}

impl std::fmt::Debug for Profile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.outlines.fmt(f)
    }
}

impl Profile {
    fn new(outlines: &[(DVec2, Vec<(Edge, DVec2)>)], turned: bool) -> Option<Self> {
        let mut made = Vec::new();
        let mut pieces = Vec::new();
        let mut is_curved = false;
        for (start, edges) in outlines {
            let mut outline = Outline::starting_at(*start);
            let mut from = *start;
            for &(edge, to) in edges {
                outline.push(edge, to);
                is_curved |= edge != Edge::Line;
                let steps = if edge == Edge::Line { 1 } else { 64 };
                let mut last = from;
                for i in 1..=steps {
                    let next = point_of(from, edge, to, f64::from(i) / f64::from(steps));
                    pieces.push([last, next]);
                    last = next;
                }
                from = to;
            }
            pieces.push([from, *start]);
            made.push(outline);
        }
        let region = Region::new(&made).ok()?;
        let region = if turned {
            region.right_half().ok()?
        } else {
            region
        };
        Some(Self {
            region,
            outlines: outlines.to_vec(),
            pieces,
            is_curved,
        })
    }

    /// Even-odd, and the distance from the outlines.
    pub(crate) fn contains(&self, p: DVec2) -> (bool, f64) {
        let mut inside = false;
        let mut distance = f64::INFINITY;
        for &[a, b] in &self.pieces {
            if (a.y > p.y) != (b.y > p.y) && a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)) > p.x {
                inside = !inside;
            }
            let along = (p - a).dot(b - a) / (b - a).length_squared();
            let along = if along.is_finite() {
                along.clamp(0.0, 1.0)
            } else {
                0.0
            };
            distance = distance.min(p.distance(a + (b - a) * along));
        }
        let slack = if self.is_curved { FLATNESS } else { 0.0 };
        (inside, (distance - slack).max(0.0))
    }
}

/// The point of an edge at `u`, by its definition.
fn point_of(from: DVec2, edge: Edge, to: DVec2, u: f64) -> DVec2 {
    let v = 1.0 - u;
    match edge {
        Edge::Line => from * v + to * u,
        Edge::Quadratic(c) => from * (v * v) + c * (2.0 * u * v) + to * (u * u),
        Edge::Cubic(c, d) => {
            from * (v * v * v) + c * (3.0 * u * v * v) + d * (3.0 * u * u * v) + to * (u * u * u)
        }
        Edge::Arc { center, clockwise } => {
            let (s, t) = (from - center, to - center);
            let sign = if clockwise { -1.0 } else { 1.0 };
            let mut angle = libm::atan2(sign * s.perp_dot(t), s.dot(t));
            if angle <= 0.0 {
                angle += std::f64::consts::TAU;
            }
            let (sin, cos) = libm::sincos(sign * angle * u);
            center + DVec2::new(s.x * cos - s.y * sin, s.x * sin + s.y * cos)
        }
    }
}

/// Multiples of 1/2, exact: an outline that crosses itself keeps slivers however thin, and what a
/// ray meets in one thinner than the rounding of its origin is not decidable.
fn corner(turned: bool) -> impl Strategy<Value = DVec2> {
    let grid = |low: i32| (low..=4).prop_map(|i| f64::from(i) * 0.5);
    // What a lathe has at negative x is cut off.
    (grid(if turned { -1 } else { -4 }), grid(-4)).prop_map(|(x, y)| DVec2::new(x, y))
}

/// One or two outlines of any kind of edges between points of a coarse grid, which may cross, touch
/// and repeat points.
pub(crate) fn profile(turned: bool) -> impl Strategy<Value = Profile> {
    let step = (corner(turned), corner(turned), corner(turned), 0..9_u32);
    let outline = (corner(turned), proptest::collection::vec(step, 2..7));
    proptest::collection::vec(outline, 1..3).prop_filter_map("no area", move |outlines| {
        let outlines: Vec<_> = outlines
            .into_iter()
            .map(|(start, steps)| {
                let mut from = start;
                let edges = steps.into_iter().map(|(to, c, d, kind)| {
                    let edge = edge(from, to, c, d, kind);
                    from = to;
                    (edge, to)
                });
                (start, edges.collect())
            })
            .collect();
        Profile::new(&outlines, turned)
    })
}

fn edge(from: DVec2, to: DVec2, c: DVec2, d: DVec2, kind: u32) -> Edge {
    let center = (from + to) * 0.5;
    match kind {
        0 => Edge::Quadratic(c),
        1 => Edge::Cubic(c, d),
        // Half a circle.
        2 | 3 if from != to => Edge::Arc {
            center,
            clockwise: kind == 2,
        },
        _ => Edge::Line,
    }
}
