//! The boundaries of composites that consist of plane polygons, as triangles.
//!
//! The ends of a prism may be any polygons with any holes, so they are cut into trapezoids between the
//! heights of their corners (Fournier and Montuno, *Triangulating simple polygons and equivalent problems*,
//! 1984, without the sweep line's tree).

use std::sync::Arc;

use octray_math::{DVec2, DVec3};

/// Where plane polygons come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FlatBoundary {
    /// They are known.
    Triangles(Arc<[[DVec3; 3]]>),
    /// Inside is what an odd number of outlines goes round; `scale[i]` times as large at height `z[i]`.
    Prism {
        /// Of closed outlines.
        edges: Arc<[[DVec2; 2]]>,
        z: [f64; 2],
        scale: [f64; 2],
    },
}

impl FlatBoundary {
    /// Triangles that hold the boundary, unless there are more than `limit` or edges cross.
    pub(crate) fn triangles(&self, limit: usize) -> Option<Vec<[DVec3; 3]>> {
        match self {
            Self::Triangles(triangles) => (triangles.len() <= limit).then(|| triangles.to_vec()),
            Self::Prism { edges, z, scale } => {
                let left = limit.checked_sub(2 * edges.len())?;
                let lift = |p: DVec2, end: usize| (p * scale[end]).extend(z[end]);
                let mut triangles = Vec::new();
                for &[a, b] in edges.iter() {
                    let (low, high) = ([a, b].map(|p| lift(p, 0)), [a, b].map(|p| lift(p, 1)));
                    triangles.push([low[0], low[1], high[1]]);
                    triangles.push([low[0], high[1], high[0]]);
                }
                for [a, b, c, d] in trapezoids(edges, left / 4)? {
                    for end in 0..2 {
                        let [a, b, c, d] = [a, b, c, d].map(|p| lift(p, end));
                        triangles.extend([[a, b, c], [a, c, d]]);
                    }
                }
                Some(triangles)
            }
        }
    }
}

/// The inside of the outlines, between the heights of neighbouring corners; `None` if there are more
/// than `limit`, or edges cross.
fn trapezoids(edges: &[[DVec2; 2]], limit: usize) -> Option<Vec<[DVec2; 4]>> {
    let upward = |&[a, b]: &[DVec2; 2]| if a.y < b.y { [a, b] } else { [b, a] };
    let mut waiting: Vec<[DVec2; 2]> = edges
        .iter()
        .map(upward)
        .filter(|[a, b]| a.y < b.y)
        .collect();
    waiting.sort_by(|[a, _], [b, _]| b.y.total_cmp(&a.y));
    let mut heights: Vec<f64> = waiting.iter().flat_map(|[a, b]| [a.y, b.y]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut crossed: Vec<[DVec2; 2]> = Vec::new();
    let mut found = Vec::new();
    for slab in heights.windows(2) {
        let (low, high) = (slab[0], slab[1]);
        crossed.retain(|[_, b]| b.y > low);
        while let Some(edge) = waiting.pop_if(|[a, _]| a.y <= low) {
            crossed.push(edge);
        }
        let mut ends: Vec<[f64; 2]> = crossed.iter().map(|e| [at(e, low), at(e, high)]).collect();
        ends.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
        if found.len() + ends.len() / 2 > limit {
            return None;
        }
        // Edges that cross within a slab would need a height of their own.
        if ends
            .windows(2)
            .any(|e| e[0][0] > e[1][0] || e[0][1] > e[1][1])
        {
            return None;
        }
        found.extend(ends.chunks_exact(2).map(|pair| {
            let p = DVec2::new;
            let ([a, d], [b, c]) = (pair[0], pair[1]);
            [p(a, low), p(b, low), p(c, high), p(d, high)]
        }));
    }
    Some(found)
}

/// Where an upward edge is at a height that it reaches.
fn at([a, b]: &[DVec2; 2], y: f64) -> f64 {
    if y <= a.y {
        a.x
    } else if y >= b.y {
        b.x
    } else {
        let share = (y - a.y) / (b.y - a.y);
        (a.x * (1.0 - share) + b.x * share).clamp(a.x.min(b.x), a.x.max(b.x))
    }
}
