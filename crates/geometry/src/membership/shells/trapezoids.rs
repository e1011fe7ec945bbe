//! The inside of polygons as trapezoids (Fournier and Montuno, *Triangulating simple polygons and equivalent
//! problems*, 1984, without the sweep line's tree).
//!
//! Between the heights of two neighbouring corners no edge begins or ends. From there to there the
//! plane is passed upwards; a trapezoid stays open for as long as the same two edges bound it, so a polygon
//! without crossings has fewer trapezoids than corners, but for corners that differ in height by rounding.

use octray_math::DVec2;

/// An edge that is not level, upwards.
type Edge = [DVec2; 2];

/// Trapezoids, corners in order round each, that together hold every point that an odd number of the
/// closed polygons goes round; `None` if there are more than `limit`. Where edges do not cross they hold no other
/// points.
pub(super) fn trapezoids(edges: &[Edge], limit: usize) -> Option<Vec<[DVec2; 4]>> {
    let upward = |&[a, b]: &Edge| if a.y < b.y { [a, b] } else { [b, a] };
    let mut edges: Vec<Edge> = edges
        .iter()
        .map(upward)
        .filter(|[a, b]| a.y < b.y)
        .collect();
    edges.sort_by(|[a, _], [b, _]| a.y.total_cmp(&b.y));
    let mut heights: Vec<f64> = edges.iter().flat_map(|[a, b]| [a.y, b.y]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut sweep = Sweep {
        edges: &edges,
        crossed: Vec::new(),
        open: vec![None; edges.len()],
        lefts: Vec::new(),
        found: Vec::new(),
    };
    let mut next = 0;
    for slab in heights.windows(2) {
        let (low, high) = (slab[0], slab[1]);
        sweep.crossed.retain(|&edge| edges[edge][1].y > low);
        while next < edges.len() && edges[next][0].y <= low {
            sweep.crossed.push(next);
            next += 1;
        }
        sweep.slab(low, high);
        if sweep.found.len() > limit {
            return None;
        }
    }
    let top = heights.last().copied().unwrap_or(0.0);
    sweep.close(top, |_| false);
    (sweep.found.len() <= limit).then_some(sweep.found)
}

/// A trapezoid that goes on: which edge is on its right, and where it began.
#[derive(Clone, Copy)]
struct Open {
    right: usize,
    low: f64,
}

struct Sweep<'a> {
    edges: &'a [Edge],
    /// The edges that pass the slab, from left to right as far as they do not cross.
    crossed: Vec<usize>,
    /// By the edge on the left.
    open: Vec<Option<Open>>,
    /// The edges that have an open trapezoid on their right.
    lefts: Vec<usize>,
    found: Vec<[DVec2; 4]>,
}

/// Neighbouring edges of which each crosses some other, or one alone: where they lie at the foot and the
/// top of a slab.
struct Tangle {
    first: usize,
    count: usize,
    least: [f64; 2],
    most: [f64; 2],
}

impl Tangle {
    fn absorb(&mut self, other: &Self) {
        self.count += other.count;
        for end in 0..2 {
            self.least[end] = self.least[end].min(other.least[end]);
            self.most[end] = self.most[end].max(other.most[end]);
        }
    }
}

impl Sweep<'_> {
    fn slab(&mut self, low: f64, high: f64) {
        let edges = self.edges;
        let ends = |edge: usize| [at(&edges[edge], low), at(&edges[edge], high)];
        let middle = |edge: usize| ends(edge)[0] + ends(edge)[1];
        // Nearly in order already.
        self.crossed
            .sort_by(|&a, &b| middle(a).total_cmp(&middle(b)));
        let mut tangles: Vec<Tangle> = Vec::with_capacity(self.crossed.len());
        for &first in &self.crossed {
            let place = ends(first);
            let mut tangle = Tangle {
                first,
                count: 1,
                least: place,
                most: place,
            };
            let reaches_over = |tangle: &Tangle, before: &Tangle| {
                (0..2).any(|end| tangle.least[end] < before.most[end])
            };
            while let Some(before) = tangles.pop_if(|before| reaches_over(&tangle, before)) {
                tangle.absorb(&before);
            }
            tangles.push(tangle);
        }
        let mut parity = false;
        let mut goes_on = Vec::new();
        let mut begins = Vec::new();
        let quad = |left: [f64; 2], right: [f64; 2]| {
            let p = DVec2::new;
            [
                p(left[0], low),
                p(right[0], low),
                p(right[1], high),
                p(left[1], high),
            ]
        };
        for (i, tangle) in tangles.iter().enumerate() {
            if tangle.count > 1 {
                self.found.push(quad(tangle.least, tangle.most));
            }
            parity ^= tangle.count % 2 == 1;
            let Some(right) = tangles.get(i + 1).filter(|_| parity) else {
                continue;
            };
            if tangle.count > 1 || right.count > 1 {
                self.found.push(quad(tangle.most, right.least));
            } else if self.open[tangle.first].is_some_and(|open| open.right == right.first) {
                goes_on.push(tangle.first);
            } else {
                begins.push((tangle.first, right.first));
            }
        }
        goes_on.sort_unstable();
        self.close(low, |left| goes_on.binary_search(&left).is_ok());
        for (left, right) in begins {
            self.open[left] = Some(Open { right, low });
            self.lefts.push(left);
        }
    }

    /// Ends the open trapezoids but some.
    fn close(&mut self, high: f64, goes_on: impl Fn(usize) -> bool) {
        let Self {
            edges,
            open,
            lefts,
            found,
            ..
        } = self;
        lefts.retain(|&left| {
            if goes_on(left) {
                return true;
            }
            if let Some(Open { right, low }) = open[left].take() {
                let corner = |edge: usize, y: f64| DVec2::new(at(&edges[edge], y), y);
                found.push([
                    corner(left, low),
                    corner(right, low),
                    corner(right, high),
                    corner(left, high),
                ]);
            }
            false
        });
    }
}

/// Where an upward edge is at a height that it reaches.
fn at([a, b]: &Edge, y: f64) -> f64 {
    if y <= a.y {
        a.x
    } else if y >= b.y {
        b.x
    } else {
        let share = (y - a.y) / (b.y - a.y);
        (a.x * (1.0 - share) + b.x * share).clamp(a.x.min(b.x), a.x.max(b.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed(corners: &[DVec2]) -> Vec<Edge> {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| [*a, *b]).collect()
    }

    /// Whether an odd number of outlines goes round a point.
    fn within(edges: &[Edge], p: DVec2) -> bool {
        let passed = |&&[a, b]: &&Edge| {
            (a.y > p.y) != (b.y > p.y) && a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) > p.x
        };
        edges.iter().filter(passed).count() % 2 == 1
    }

    fn held(traps: &[[DVec2; 4]], p: DVec2) -> bool {
        traps.iter().any(|t| {
            let sides = closed(t);
            sides
                .iter()
                .all(|[a, b]| (*b - *a).perp_dot(p - *a) >= -1e-12)
        })
    }

    fn wheel(corners: usize, radius: impl Fn(usize) -> f64, turns: f64) -> Vec<DVec2> {
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * turns * i as f64 / corners as f64;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * radius(i)
        };
        (0..corners).map(corner).collect()
    }

    /// Area of the trapezoids, whatever they overlap.
    fn area(traps: &[[DVec2; 4]]) -> f64 {
        let half = |t: &[DVec2; 4]| 0.5 * (t[2] - t[0]).perp_dot(t[3] - t[1]);
        traps.iter().map(half).sum()
    }

    #[test]
    fn outlines_without_crossings_are_cut_into_as_many_as_they_have_corners() {
        for corners in [3, 4, 7, 100, 2000] {
            let outer = wheel(corners, |i| if i % 2 == 0 { 1.0 } else { 0.8 }, 1.0);
            let hole = wheel(corners, |_| 0.5, -1.0);
            let edges = [closed(&outer), closed(&hole)].concat();
            let traps = trapezoids(&edges, 4 * corners).expect("few");
            assert!(
                traps.len() <= 2 * corners + corners / 10 + 2,
                "{corners}: {}",
                traps.len()
            );
            let truth: f64 = edges.iter().map(|[a, b]| 0.5 * a.perp_dot(*b)).sum();
            assert!(
                (area(&traps) - truth).abs() < 1e-9 * corners as f64,
                "{corners}"
            );
            assert_eq!(trapezoids(&edges, traps.len() - 1), None);
        }
    }

    #[test]
    fn crossing_outlines_are_held() {
        for (corners, turns) in [(5, 2.0), (7, 3.0), (40, 9.0), (4, 1.0)] {
            let star = closed(&wheel(corners, |_| 1.0, turns));
            let other = closed(&wheel(3, |_| 0.9, 1.0));
            let edges = [star, other].concat();
            let traps = trapezoids(&edges, 100_000).expect("few");
            let mut inside = 0;
            for i in 0..150 {
                for j in 0..150 {
                    let p = DVec2::new(f64::from(i) - 74.3, f64::from(j) - 74.7) / 74.0;
                    if within(&edges, p) {
                        inside += 1;
                        assert!(held(&traps, p), "{corners} {turns}: {p}");
                    }
                }
            }
            assert!(inside > 500, "{inside}");
        }
    }
}
