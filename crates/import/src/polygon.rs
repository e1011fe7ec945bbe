//! Flat polygons in space into triangles.

use octray_math::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// How many point-in-ear tests a polygon may cost before corners are cut off untested.
const MAX_TESTS: usize = 5_000_000;

/// Cuts ears off a simple, roughly planar polygon, which may be concave (Meisters 1975).
///
/// `corners` are indices into `points`, in order. The `corners.len() - 2` triangles use every
/// edge of the polygon once and every corner, even one in the middle of a straight edge (its
/// triangle then may have no area): a closed polyhedron stays closed. A polygon that crosses
/// itself also gives triangles with these edges, of no useful shape. Indices must be in range.
pub(crate) fn triangulate(points: &[DVec3], corners: &[u32]) -> Vec<[u32; 3]> {
    let count = corners.len();
    if count < 3 {
        return Vec::new();
    }
    let mut ring = Ring::new(points, corners);
    let mut triangles = Vec::with_capacity(count - 2);
    let (mut at, mut left, mut refused) = (0, count, 0);
    while left > 3 {
        // After a round without an ear anything goes: first corners without area, then any.
        let clip = match ring.turn(at) {
            _ if ring.tests > MAX_TESTS => true,
            turn if turn > 0.0 => refused >= 2 * left || ring.is_ear(at),
            0.0 => refused >= left,
            _ => refused >= 2 * left,
        };
        ring.tests += 1;
        let next = ring.next[at];
        if clip {
            triangles.push([ring.previous[at], at, next].map(|i| corners[i]));
            ring.remove(at);
            (left, refused) = (left - 1, 0);
        } else {
            refused += 1;
        }
        at = next;
    }
    triangles.push([ring.previous[at], at, ring.next[at]].map(|i| corners[i]));
    triangles
}

/// The corners not yet cut off, seen from the side the polygon runs counter-clockwise on.
struct Ring {
    flat: Vec<DVec2>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// The corners that do not turn left: only they can lie in an ear.
    reflex: Vec<usize>,
    is_reflex: Vec<bool>,
    tests: usize,
}

impl Ring {
    fn new(points: &[DVec3], corners: &[u32]) -> Self {
        let count = corners.len();
        let at = |i: usize| points[corners[i] as usize];
        let middle = at(0);
        // Newell's normal, twice the area vector.
        let normal = (1..count).fold(DVec3::ZERO, |sum, i| {
            sum + (at(i - 1) - middle).cross(at(i) - middle)
        });
        let size = normal.abs();
        let flatten = |p: DVec3| {
            let (u, v, along) = if size.x >= size.y && size.x >= size.z {
                (p.y, p.z, normal.x)
            } else if size.y >= size.z {
                (p.z, p.x, normal.y)
            } else {
                (p.x, p.y, normal.z)
            };
            if along < 0.0 {
                DVec2::new(v, u)
            } else {
                DVec2::new(u, v)
            }
        };
        let mut ring = Self {
            flat: (0..count).map(|i| flatten(at(i))).collect(),
            next: (1..count).chain([0]).collect(),
            previous: std::iter::once(count - 1).chain(0..count - 1).collect(),
            reflex: Vec::new(),
            is_reflex: Vec::new(),
            tests: 0,
        };
        ring.is_reflex = (0..count).map(|i| ring.turn(i) <= 0.0).collect();
        ring.reflex = (0..count).filter(|&i| ring.is_reflex[i]).collect();
        ring
    }

    /// Positive where the polygon turns left at the corner, with the sign exact.
    fn turn(&self, at: usize) -> f64 {
        self.side(self.previous[at], at, self.next[at])
    }

    /// Positive where corner `point` lies left of the line from corner `a` to corner `b`.
    fn side(&self, a: usize, b: usize, point: usize) -> f64 {
        let coord = |i: usize| Coord {
            x: self.flat[i].x,
            y: self.flat[i].y,
        };
        orient2d(coord(a), coord(b), coord(point))
    }

    fn is_ear(&mut self, at: usize) -> bool {
        let corners = [self.previous[at], at, self.next[at]];
        self.tests += self.reflex.len();
        let blocks = |&other: &usize| {
            let touching = corners.iter().any(|&c| self.flat[c] == self.flat[other]);
            let inside = |k: usize| self.side(corners[k], corners[(k + 1) % 3], other) >= 0.0;
            !touching && (0..3).all(inside)
        };
        !self.reflex.iter().any(blocks)
    }

    fn remove(&mut self, at: usize) {
        let (before, after) = (self.previous[at], self.next[at]);
        self.next[before] = after;
        self.previous[after] = before;
        let mut changed = std::mem::take(&mut self.is_reflex[at]);
        for i in [before, after] {
            if self.is_reflex[i] && self.turn(i) > 0.0 {
                self.is_reflex[i] = false;
                changed = true;
            }
        }
        if changed && self.tests < MAX_TESTS {
            self.tests += self.reflex.len();
            self.reflex.retain(|&i| self.is_reflex[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let triangle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            (b - a).cross(c - a).z / 2.0
        };
        triangles.iter().map(triangle).sum()
    }

    fn all_counter_clockwise(points: &[DVec3], triangles: &[[u32; 3]]) -> bool {
        triangles.iter().all(|&t| area(points, &[t]) >= 0.0)
    }

    /// Every edge of the polygon once, every other edge once in each direction.
    fn keeps_edges(corners: &[u32], triangles: &[[u32; 3]]) -> bool {
        let mut edges = std::collections::BTreeMap::new();
        let count = corners.len();
        for (i, &a) in corners.iter().enumerate() {
            *edges.entry((a, corners[(i + 1) % count])).or_insert(0) -= 1;
            *edges.entry((corners[(i + 1) % count], a)).or_insert(0) += 1;
        }
        for t in triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *edges.entry((a, b)).or_insert(0) += 1;
                *edges.entry((b, a)).or_insert(0) -= 1;
            }
        }
        edges.values().all(|&balance| balance == 0)
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p[0], p[1], 1.5)).collect()
    }

    #[test]
    fn concave_polygons_are_filled_and_not_more() {
        // A comb with three teeth, 10 x 4 less two gaps of 2 x 3.
        let comb = flat(&[
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 4.0],
            [8.0, 4.0],
            [8.0, 1.0],
            [6.0, 1.0],
            [6.0, 4.0],
            [4.0, 4.0],
            [4.0, 1.0],
            [2.0, 1.0],
            [2.0, 4.0],
            [0.0, 4.0],
        ]);
        let corners: Vec<u32> = (0..12).collect();
        let triangles = triangulate(&comb, &corners);
        assert_eq!(triangles.len(), 10);
        assert!(all_counter_clockwise(&comb, &triangles));
        assert!((area(&comb, &triangles) - 28.0).abs() < 1e-12);
        let backwards: Vec<u32> = corners.iter().rev().copied().collect();
        assert!((area(&comb, &triangulate(&comb, &backwards)) + 28.0).abs() < 1e-12);
    }

    #[test]
    fn corners_on_straight_edges_are_kept() {
        let square = flat(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ]);
        let corners = [0, 1, 2, 3, 4, 5];
        let triangles = triangulate(&square, &corners);
        assert!(keeps_edges(&corners, &triangles));
        assert!((area(&square, &triangles) - 4.0).abs() < 1e-15);
        assert!(all_counter_clockwise(&square, &triangles));
    }

    proptest! {
        #[test]
        fn star_shaped_polygons_are_filled(radii in prop::collection::vec(0.1..10.0_f64, 3..60)) {
            let count = radii.len();
            let angle = |i: usize| i as f64 * std::f64::consts::TAU / count as f64;
            let points: Vec<DVec3> = radii.iter().enumerate()
                .map(|(i, r)| DVec3::new(r * angle(i).cos(), r * angle(i).sin(), 0.0)).collect();
            let corners: Vec<u32> = (0..count as u32).collect();
            let triangles = triangulate(&points, &corners);
            prop_assert_eq!(triangles.len(), count - 2);
            prop_assert!(keeps_edges(&corners, &triangles));
            prop_assert!(all_counter_clockwise(&points, &triangles));
            // The shoelace formula.
            let exact: f64 = (0..count)
                .map(|i| points[i].cross(points[(i + 1) % count]).z / 2.0).sum();
            prop_assert!((area(&points, &triangles) - exact).abs() < 1e-9 * exact.abs().max(1.0));
        }

        #[test]
        fn any_polygon_keeps_its_edges(
            grid in prop::collection::vec((0..5_i8, 0..5_i8, 0..2_i8), 3..40)
        ) {
            let points: Vec<DVec3> = grid.iter()
                .map(|&(x, y, z)| DVec3::new(x.into(), y.into(), z.into())).collect();
            let corners: Vec<u32> = (0..points.len() as u32).collect();
            prop_assert!(keeps_edges(&corners, &triangulate(&points, &corners)));
        }
    }
}
