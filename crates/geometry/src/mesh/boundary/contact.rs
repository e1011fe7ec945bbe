//! How two triangles meet.
//!
//! Two triangles in different planes meet in parts of the line that both planes share: intervals,
//! whose ends are compared by the signs of four determinants (Guigue & Devillers, *Fast and Robust
//! Triangle-Triangle Overlap Test Using Orientation Predicates*, JGT 2003).

use octray_math::DVec3;

use super::exact_mesh::{flat, side};

/// What two triangles have in common beyond the corners and edges that they share anyway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Contact {
    /// Nothing, or parts of their borders in one plane.
    Apart,
    /// A corner or an edge of one lies on the other, or they lie upon one another and face opposite
    /// ways. Given is a common point, up to rounding.
    Touching(DVec3),
    /// Each passes through the other.
    Crossing(DVec3),
    /// They lie upon one another and face the same way.
    Overlapping(DVec3),
    /// They share an edge, lie upon one another and face opposite ways.
    Folded(DVec3),
}

/// One triangle as seen from the other's plane: a corner that is alone on its side, and whether
/// that side is in front.
struct Seen {
    /// The lone corner first, in the triangle's own order of rotation.
    order: [usize; 3],
    in_front: bool,
    /// Whether there are corners strictly on both sides.
    is_cut: bool,
}

impl Seen {
    /// `None` if all corners are strictly on one side. `heights` are not all 0.
    fn new(heights: [f64; 3]) -> Option<Self> {
        let fronts = heights.iter().filter(|h| **h > 0.0).count();
        let backs = heights.iter().filter(|h| **h < 0.0).count();
        let find = |wanted: fn(f64) -> bool| heights.iter().position(|&h| wanted(h));
        let (lone, in_front) = match (fronts, backs) {
            (3, _) | (_, 3) => return None,
            (1, _) => (find(|h| h > 0.0), true),
            (_, 1) => (find(|h| h < 0.0), false),
            (2, _) => (find(|h| h == 0.0), false),
            _ => (find(|h| h == 0.0), true),
        };
        let first = lone?;
        Some(Self {
            order: [first, (first + 1) % 3, (first + 2) % 3],
            in_front,
            is_cut: fronts > 0 && backs > 0,
        })
    }
}

/// How two triangles with area meet; `shared[i]` says which corner of the second the corner `i` of
/// the first is.
pub(super) fn contact(a: [DVec3; 3], b: [DVec3; 3], shared: [Option<usize>; 3]) -> Contact {
    let common = shared.iter().flatten().count();
    // Front is positive here.
    let heights = |of: [DVec3; 3], over: [DVec3; 3], on: [bool; 3]| {
        let height = |i: usize| if on[i] { 0.0 } else { -side(over, of[i]) };
        [height(0), height(1), height(2)]
    };
    let of_a = heights(a, b, shared.map(|s| s.is_some()));
    if of_a == [0.0; 3] {
        return in_one_plane(a, b, common);
    }
    let Some(seen_a) = Seen::new(of_a) else {
        return Contact::Apart;
    };
    // Neighbours in different planes have only the edge in common, and two triangles that share a
    // corner have only that if one stays on one side of the other.
    if common >= 2 || (common == 1 && is_clear_of(of_a, 1)) {
        return Contact::Apart;
    }
    let of_b = heights(b, a, [0, 1, 2].map(|i| shared.contains(&Some(i))));
    let Some(seen_b) = Seen::new(of_b) else {
        return Contact::Apart;
    };
    if common == 1 && is_clear_of(of_b, 1) {
        return Contact::Apart;
    }
    let [p1, mut q1, mut r1] = seen_a.order.map(|i| a[i]);
    let [p2, mut q2, mut r2] = seen_b.order.map(|i| b[i]);
    if !seen_a.in_front {
        std::mem::swap(&mut q2, &mut r2);
    }
    if !seen_b.in_front {
        std::mem::swap(&mut q1, &mut r1);
    }
    let first = side([p1, q1, p2], q2);
    let second = side([p1, r1, r2], p2);
    if first < 0.0 || second < 0.0 {
        return Contact::Apart;
    }
    let overlap = first > 0.0 && second > 0.0;
    if common == 1 && !overlap {
        return Contact::Apart;
    }
    let place = common_point(a, of_a, b, of_b);
    if overlap && seen_a.is_cut && seen_b.is_cut {
        Contact::Crossing(place)
    } else {
        Contact::Touching(place)
    }
}

/// Whether all corners but `on` of them lie strictly on one side.
fn is_clear_of(heights: [f64; 3], on: usize) -> bool {
    let fronts = heights.iter().filter(|h| **h > 0.0).count();
    let backs = heights.iter().filter(|h| **h < 0.0).count();
    fronts + on == 3 || backs + on == 3
}

/// The middle of what two triangles have in common on the line of their planes.
fn common_point(a: [DVec3; 3], of_a: [f64; 3], b: [DVec3; 3], of_b: [f64; 3]) -> DVec3 {
    let ends = |corners: [DVec3; 3], heights: [f64; 3]| {
        let mut found: Vec<DVec3> = Vec::new();
        for i in 0..3 {
            let j = (i + 1) % 3;
            if heights[i] == 0.0 {
                found.push(corners[i]);
            }
            if heights[i] * heights[j].signum() < 0.0 && heights[j] != 0.0 {
                let share = heights[i] / (heights[i] - heights[j]);
                found.push(corners[i] + (corners[j] - corners[i]) * share);
            }
        }
        let first = found.first().copied().unwrap_or(corners[0]);
        [first, found.last().copied().unwrap_or(first)]
    };
    let (one, other) = (ends(a, of_a), ends(b, of_b));
    // Along the longer of the two, by its largest component.
    let (d, e) = (one[1] - one[0], other[1] - other[0]);
    let along = if d.abs().max_element() >= e.abs().max_element() {
        d
    } else {
        e
    };
    let axis = along.abs().max_position();
    let sorted = |mut ends: [DVec3; 2]| {
        ends.sort_by(|p, q| p[axis].total_cmp(&q[axis]));
        ends
    };
    let ([s1, e1], [s2, e2]) = (sorted(one), sorted(other));
    let start = if s1[axis] > s2[axis] { s1 } else { s2 };
    let end = if e1[axis] < e2[axis] { e1 } else { e2 };
    start * 0.5 + end * 0.5
}

/// Two triangles of one plane.
fn in_one_plane(a: [DVec3; 3], b: [DVec3; 3], common: usize) -> Contact {
    let turn = |[p, q, r]: [DVec3; 3], axis: usize| {
        robust::orient2d(flat(p, axis), flat(q, axis), flat(r, axis))
    };
    let Some(axis) = (0..3).find(|&axis| turn(a, axis) != 0.0) else {
        return Contact::Apart;
    };
    let (turn_a, turn_b) = (turn(a, axis), turn(b, axis));
    let separates = |one: [DVec3; 3], turn_one: f64, other: [DVec3; 3]| {
        (0..3).any(|i| {
            let (p, q) = (one[i], one[(i + 1) % 3]);
            other
                .iter()
                .all(|&r| turn([p, q, r], axis) * turn_one.signum() <= 0.0)
        })
    };
    if separates(a, turn_a, b) || separates(b, turn_b, a) {
        return Contact::Apart;
    }
    let place = middle_of_overlap(a, turn_a, b, axis);
    if (turn_a > 0.0) == (turn_b > 0.0) {
        Contact::Overlapping(place)
    } else if common >= 2 {
        Contact::Folded(place)
    } else {
        Contact::Touching(place)
    }
}

/// Cuts `b` down to `a` (Sutherland & Hodgman 1974) and takes the mean of the corners.
fn middle_of_overlap(a: [DVec3; 3], turn_a: f64, b: [DVec3; 3], axis: usize) -> DVec3 {
    let mut polygon = b.to_vec();
    for i in 0..3 {
        let (p, q) = (flat(a[i], axis), flat(a[(i + 1) % 3], axis));
        let inside = |r: DVec3| robust::orient2d(p, q, flat(r, axis)) * turn_a.signum();
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (j, &from) in polygon.iter().enumerate() {
            let to = polygon[(j + 1) % polygon.len()];
            let (u, v) = (inside(from), inside(to));
            if u >= 0.0 {
                kept.push(from);
            }
            if (u < 0.0) != (v < 0.0) && u != 0.0 && v != 0.0 {
                kept.push(from + (to - from) * (u / (u - v)));
            }
        }
        polygon = kept;
    }
    if polygon.is_empty() {
        // Only by rounding.
        return b[0];
    }
    let share = 1.0 / polygon.len() as f64;
    polygon.iter().map(|&p| p * share).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_math::{hash_combine, unit_f64};

    /// Whether the segments' and triangles' interiors meet, in whole numbers: an edge of one passes
    /// through the inside of the other.
    fn pierces(a: [[i64; 3]; 3], b: [[i64; 3]; 3]) -> bool {
        let sub = |p: [i64; 3], q: [i64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let volume = |p: [i64; 3], q: [i64; 3], r: [i64; 3], s: [i64; 3]| {
            let (u, v, w) = (sub(q, p), sub(r, p), sub(s, p));
            let cross = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            (cross[0] * w[0] + cross[1] * w[1] + cross[2] * w[2]).signum()
        };
        let through = |p, q, t: [[i64; 3]; 3]| {
            let sides = volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q);
            let turns = [0, 1, 2].map(|i| volume(p, q, t[i], t[(i + 1) % 3]));
            sides < 0 && turns[0] != 0 && turns.iter().all(|&s| s == turns[0])
        };
        (0..3).any(|i| through(a[i], a[(i + 1) % 3], b) || through(b[i], b[(i + 1) % 3], a))
    }

    fn random(seed: u64, size: i64) -> [[i64; 3]; 3] {
        let number = |i: u64| (unit_f64(hash_combine(seed, i)) * size as f64) as i64;
        [0, 3, 6].map(|i| [number(i), number(i + 1), number(i + 2)])
    }

    fn floats(t: [[i64; 3]; 3]) -> [DVec3; 3] {
        t.map(|p| DVec3::from_array(p.map(|x| x as f64)))
    }

    #[test]
    fn edges_that_pierce_a_triangle_are_crossings() {
        let mut found = [0; 2];
        for seed in 0..40_000 {
            // Large numbers give general positions, small ones all special ones.
            let size = if seed % 2 == 0 { 1000 } else { 4 };
            let (a, b) = (random(2 * seed, size), random(2 * seed + 1, size));
            let [fa, fb] = [a, b].map(floats);
            let area = |t: [DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]) != DVec3::ZERO;
            if !area(fa) || !area(fb) {
                continue;
            }
            let ids = [0, 1, 2].map(|i| (0..3).find(|&j| a[i] == b[j]));
            let ways = [
                contact(fa, fb, ids),
                contact([fa[1], fa[0], fa[2]], fb, [ids[1], ids[0], ids[2]]),
                contact(
                    fb,
                    fa,
                    [0, 1, 2].map(|j| (0..3).find(|&i| ids[i] == Some(j))),
                ),
            ];
            let crosses = ways.map(|w| matches!(w, Contact::Crossing(_)));
            assert!(crosses.iter().all(|&c| c == crosses[0]), "{ways:?}");
            if pierces(a, b) {
                assert!(crosses[0], "{a:?} {b:?} {ways:?}");
                found[0] += 1;
            } else if size == 1000 {
                assert!(!crosses[0], "{a:?} {b:?} {ways:?}");
                found[1] += 1;
            }
            for way in ways {
                // The place lies in both boxes.
                if let Contact::Crossing(p) | Contact::Touching(p) | Contact::Overlapping(p) = way {
                    for t in [fa, fb] {
                        let low = t[0].min(t[1]).min(t[2]) - 1e-9;
                        let high = t[0].max(t[1]).max(t[2]) + 1e-9;
                        assert!(p.cmpge(low).all() && p.cmple(high).all(), "{way:?}");
                    }
                }
            }
        }
        assert!(found[0] > 3000 && found[1] > 3000, "{found:?}");
    }

    #[test]
    fn each_way_to_meet() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let floor = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 4.0, 0.0)];
        let apart = [None; 3];
        let with = |t: [DVec3; 3]| contact(floor, t, apart);
        // A corner on the face; an edge in it; a corner above it; a corner through it.
        let stands = |z: f64| [p(1.0, 1.0, z), p(2.0, 1.0, 3.0), p(1.0, 2.0, 3.0)];
        assert_eq!(with(stands(0.0)), Contact::Touching(p(1.0, 1.0, 0.0)));
        assert_eq!(with(stands(1e-300)), Contact::Apart);
        assert!(matches!(with(stands(-1e-300)), Contact::Crossing(_)));
        let lies = [p(1.0, 1.0, 0.0), p(2.0, 1.0, 0.0), p(1.0, 2.0, 3.0)];
        assert_eq!(with(lies), Contact::Touching(p(1.5, 1.0, 0.0)));
        // In its plane: beside, upon, upon and turned.
        let moved = |x: f64| floor.map(|q| q + p(x, 0.0, 0.0));
        assert_eq!(with(moved(4.0)), Contact::Apart);
        assert!(matches!(with(moved(3.9)), Contact::Overlapping(_)));
        let [a, b, c] = moved(3.9);
        assert!(matches!(with([a, c, b]), Contact::Touching(_)));
        // Neighbours: bent, flat, folded, and a fan that passes through.
        let [a, b, c] = floor;
        let neighbour = |d: DVec3| contact(floor, [b, a, d], [Some(1), Some(0), None]);
        assert_eq!(neighbour(p(1.0, 1.0, 1e-200)), Contact::Apart);
        assert_eq!(neighbour(p(1.0, -1.0, 0.0)), Contact::Apart);
        assert!(matches!(neighbour(p(1.0, 1.0, 0.0)), Contact::Folded(_)));
        let fan = |d: DVec3, e: DVec3| contact(floor, [a, d, e], [Some(0), None, None]);
        assert!(matches!(
            fan(p(1.0, 1.0, 1.0), p(1.0, 1.0, -1.0)),
            Contact::Crossing(_)
        ));
        assert_eq!(fan(p(-1.0, -1.0, 1.0), p(-1.0, -1.0, -1.0)), Contact::Apart);
        assert_eq!(fan(p(1.0, 1.0, 1.0), p(1.0, 2.0, 1.0)), Contact::Apart);
        assert!(matches!(
            fan(p(1.0, 1.0, 0.0), c + p(0.0, 0.0, 1.0)),
            Contact::Touching(_)
        ));
    }
}
