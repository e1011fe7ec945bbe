//! A simple polygon as a formula over the sides of its edges and of the lids of its pockets.
//!
//! A polygon is its convex hull without the pockets between neighbouring corners of the hull, a
//! pocket is its own hull without the pockets of that, and so on: the convex differences of Tor and
//! Middleditch, *Convex decomposition of simple polygons* (ACM Transactions on Graphics, 1984). Every
//! edge is named once, and so is the lid of every pocket, which only its outer hull names: inside that,
//! the pocket need not.
//!
//! (The formulas of Dobkin, Guibas, Hershberger and Snoeyink, SIGGRAPH 1988, need no lids, but nest as
//! deeply as a spiral has corners.)

use octray_math::DVec2;

use super::formula::{Formula, MAX_FORMULA_DEPTH};
use super::pieces::turn;

/// Corners looked at, all levels together, before a polygon counts as too intricate.
const WORK_LIMIT: usize = 1 << 25;

/// The inside of a simple polygon, counter-clockwise, given the left side of every edge (edge `i`
/// leaves corner `i`), and what makes the left side of a line through two points. `None` if it is too
/// intricate: a spiral of hundreds of turns.
pub(super) fn polygon(
    corners: &[DVec2],
    lefts: &[Formula],
    left_of_lid: &mut dyn FnMut(DVec2, DVec2) -> Formula,
) -> Option<Formula> {
    let count = corners.len();
    let first = (0..count).min_by(|&i, &j| by_place(corners[i], corners[j]))?;
    // The first corner again at the end.
    let around: Vec<DVec2> = (0..=count).map(|i| corners[(first + i) % count]).collect();
    let lefts: Vec<&Formula> = (0..count).map(|i| &lefts[(first + i) % count]).collect();
    let mut chains = Chains {
        corners: &around,
        lefts: &lefts,
        left_of_lid,
        work_left: WORK_LIMIT,
    };
    chains.formula(0, count, true, MAX_FORMULA_DEPTH / 2)
}

struct Chains<'a> {
    corners: &'a [DVec2],
    lefts: &'a [&'a Formula],
    left_of_lid: &'a mut dyn FnMut(DVec2, DVec2) -> Formula,
    work_left: usize,
}

impl Chains<'_> {
    /// What the edges from corner `start` to corner `end` have in common with, or add to, the left
    /// side of the line between the two.
    fn formula(&mut self, start: usize, end: usize, all: bool, depth: u32) -> Option<Formula> {
        if end - start == 1 {
            return Some(self.lefts[start].clone());
        }
        self.work_left = self.work_left.checked_sub(end - start)?;
        let depth = depth.checked_sub(1)?;
        let mut splits = hull_corners(&self.corners[start..=end]);
        // A corner that touches the lid is not on the hull's other side.
        let (from, to) = (self.corners[start], self.corners[end]);
        let is_inner = |i: usize| 0 < i && i < end - start;
        splits.retain(|&i| {
            from == to || !is_inner(i) || turn(from, to, self.corners[start + i]) != 0.0
        });
        // Fewer would mean that the polygon is not simple.
        if splits.len() < 3 || splits.first() != Some(&0) || splits.last() != Some(&(end - start)) {
            return None;
        }
        let mut parts = Vec::with_capacity(splits.len() - 1);
        for pair in splits.windows(2) {
            if pair[1] - pair[0] > 1 {
                let [from, to] = [pair[0], pair[1]].map(|i| self.corners[start + i]);
                parts.push((self.left_of_lid)(from, to));
            }
            parts.push(self.formula(start + pair[0], start + pair[1], !all, depth)?);
        }
        Some(if all {
            Formula::all(parts)
        } else {
            Formula::any(parts)
        })
    }
}

fn by_place(a: DVec2, b: DVec2) -> std::cmp::Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// The indices of the points on the boundary of the convex hull, increasing.
///
/// Andrew's monotone chain (1979), which keeps points on straight parts of the boundary.
fn hull_corners(points: &[DVec2]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| by_place(points[i], points[j]).then(i.cmp(&j)));
    let mut on_hull = vec![false; points.len()];
    let mut half = |order: &mut dyn Iterator<Item = usize>| {
        let mut stack: Vec<usize> = Vec::new();
        for i in order {
            while let [.., a, b] = stack[..]
                && turn(points[a], points[b], points[i]) < 0.0
            {
                stack.pop();
            }
            stack.push(i);
        }
        stack.into_iter().for_each(|i| on_hull[i] = true);
    };
    half(&mut order.iter().copied());
    half(&mut order.iter().rev().copied());
    (0..points.len()).filter(|&i| on_hull[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The formula, and the two points of every line that it names.
    fn formula_of(corners: &[DVec2]) -> (Formula, Vec<[DVec2; 2]>) {
        let lefts: Vec<Formula> = (0..corners.len() as u32).map(Formula::inside).collect();
        let next = corners.iter().cycle().skip(1);
        let mut lines: Vec<[DVec2; 2]> = corners.iter().zip(next).map(|(a, b)| [*a, *b]).collect();
        let mut lid = |a: DVec2, b: DVec2| {
            lines.push([a, b]);
            Formula::inside(lines.len() as u32 - 1)
        };
        let formula = polygon(corners, &lefts, &mut lid).expect("simple");
        assert_eq!(formula.literals(), lines.len(), "every line is named once");
        assert!(lines.len() < 2 * corners.len());
        (formula, lines)
    }

    fn contains((formula, lines): &(Formula, Vec<[DVec2; 2]>), p: DVec2) -> bool {
        formula.evaluate(&|side| {
            let [a, b] = lines[side as usize];
            turn(a, b, p) > 0.0
        })
    }

    /// Even-odd with exact signs; `None` on the outline.
    fn oracle(corners: &[DVec2], p: DVec2) -> Option<bool> {
        let mut inside = false;
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let side = turn(a, b, p);
            let within = p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all();
            if side == 0.0 && within {
                return None;
            }
            if (a.y > p.y) != (b.y > p.y) && (side > 0.0) == (b.y > a.y) {
                inside = !inside;
            }
        }
        Some(inside)
    }

    #[test]
    fn an_l_with_corners_on_its_sides() {
        let corners: Vec<DVec2> = [
            (0, 0),
            (1, 0),
            (2, 0),
            (4, 0),
            (4, 1),
            (2, 1),
            (1, 1),
            (1, 2),
            (1, 4),
            (0, 4),
            (0, 2),
        ]
        .map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)))
        .to_vec();
        let formula = formula_of(&corners);
        for i in -2..20 {
            for j in -2..20 {
                let p = DVec2::new(f64::from(i), f64::from(j)) * 0.25;
                if let Some(inside) = oracle(&corners, p) {
                    assert_eq!(contains(&formula, p), inside, "{p}");
                }
            }
        }
    }

    #[test]
    fn a_spiral_of_forty_turns() {
        let arm = |offset: f64| {
            (0..1600).map(move |i| {
                let angle = 0.16 * f64::from(i);
                let r = angle + offset;
                DVec2::new(r * libm::cos(angle), r * libm::sin(angle))
            })
        };
        let inner: Vec<DVec2> = arm(1.0).collect();
        let corners: Vec<DVec2> = inner.iter().rev().copied().chain(arm(3.0)).collect();
        let corners: Vec<DVec2> = corners.into_iter().collect();
        let formula = formula_of(&corners);
        for i in 0..400_u32 {
            let r = f64::from(i) * 0.7;
            let angle = f64::from(i * i % 719);
            let p = DVec2::new(r * libm::cos(angle), r * libm::sin(angle));
            if let Some(inside) = oracle(&corners, p) {
                assert_eq!(contains(&formula, p), inside, "{p}");
            }
        }
    }

    /// A simple polygon through random points of a small grid: collinear corners are common.
    ///
    /// Crossing edges are undone by reversing the part between them (2-opt) until none cross.
    fn simple_polygon() -> impl Strategy<Value = Vec<DVec2>> {
        proptest::collection::btree_set((0..12_i32, 0..12_i32), 3..30)
            .prop_shuffle_set()
            .prop_filter_map("no simple polygon", |points| {
                let mut corners: Vec<DVec2> = points
                    .into_iter()
                    .map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)))
                    .collect();
                for _ in 0..4000 {
                    let Some((i, j)) = meeting(&corners) else {
                        let area: f64 = (0..corners.len())
                            .map(|i| corners[i].perp_dot(corners[(i + 1) % corners.len()]))
                            .sum();
                        if area < 0.0 {
                            corners.reverse();
                        }
                        return (area != 0.0).then_some(corners);
                    };
                    corners[i + 1..=j].reverse();
                }
                None
            })
    }

    trait Shuffle: Strategy<Value = std::collections::BTreeSet<(i32, i32)>> + Sized {
        fn prop_shuffle_set(self) -> impl Strategy<Value = Vec<(i32, i32)>> {
            self.prop_map(|set| set.into_iter().collect::<Vec<_>>())
                .prop_shuffle()
        }
    }
    impl<S: Strategy<Value = std::collections::BTreeSet<(i32, i32)>>> Shuffle for S {}

    /// Two edges that have more in common than one shared end.
    fn meeting(corners: &[DVec2]) -> Option<(usize, usize)> {
        let n = corners.len();
        let at = |i: usize| corners[i % n];
        let on = |a: DVec2, b: DVec2, p: DVec2| {
            p != a
                && p != b
                && turn(a, b, p) == 0.0
                && p.cmpge(a.min(b)).all()
                && p.cmple(a.max(b)).all()
        };
        for i in 0..n {
            for j in i + 1..n {
                let (a, b, c, d) = (at(i), at(i + 1), at(j), at(j + 1));
                let crossing =
                    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
                if crossing || on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b) {
                    return Some((i, j));
                }
            }
        }
        None
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..Default::default() })]
        #[test]
        fn random_simple_polygons_are_what_even_odd_says(corners in simple_polygon()) {
            let formula = formula_of(&corners);
            for i in -2..50 {
                for j in -2..50 {
                    let p = DVec2::new(f64::from(i), f64::from(j)) * 0.25;
                    if let Some(inside) = oracle(&corners, p) {
                        prop_assert_eq!(contains(&formula, p), inside, "{}", p);
                    }
                }
            }
        }
    }
}
