//! Plane polygons into triangles, by ear clipping (Meisters 1975).

use octray_math::DVec3;
use robust::{Coord, orient2d};

/// Triangulates polygons; keeps an account of the work, so that no file can ask for hours of it.
#[derive(Debug)]
pub struct Triangulator {
    work_left: u64,
}

impl Default for Triangulator {
    fn default() -> Self {
        Self::new()
    }
}

/// The polygons have too many inward corners to be triangulated in reasonable time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("polygons with this many inward corners are too much work to triangulate")]
pub struct TooComplex;

impl Triangulator {
    /// Tests of a point against a triangle that one triangulator makes at most.
    pub const WORK_LIMIT: u64 = 1 << 30;

    /// With the whole budget.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            work_left: Self::WORK_LIMIT,
        }
    }

    /// Splits a polygon with `n` corners into `n - 2` triangles that name its corners by their
    /// place in `corners`, in the polygon's orientation.
    ///
    /// Every corner is used, also one on a straight edge, so neighbours stay joined. Concave
    /// outlines are split inside; convex ones into a fan about the first corner. A polygon that is
    /// not plane is judged by its projection along its greatest axis; one that crosses itself or
    /// has no area still gives `n - 2` triangles. Fewer than three corners give none.
    ///
    /// # Errors
    /// [`TooComplex`] when the budget is used up.
    pub fn triangulate(&mut self, corners: &[DVec3]) -> Result<Vec<[u32; 3]>, TooComplex> {
        match corners.len() {
            0..=2 => return Ok(Vec::new()),
            3 => return Ok(vec![[0, 1, 2]]),
            _ => {}
        }
        let outline = project(corners);
        if is_convex(&outline) {
            return Ok((1..corners.len() as u32 - 1)
                .map(|i| [0, i, i + 1])
                .collect());
        }
        self.clip_ears(&outline)
    }

    fn clip_ears(&mut self, outline: &[Coord<f64>]) -> Result<Vec<[u32; 3]>, TooComplex> {
        let mut ring = Ring::new(outline);
        let mut triangles = Vec::with_capacity(outline.len() - 2);
        let mut corner = 0_u32;
        // Corners looked at since the last ear; after a whole round the rest has no clean ear.
        let mut fruitless = 0;
        while ring.left > 3 {
            let forced = fruitless > ring.left;
            self.work_left = self.work_left.checked_sub(1).ok_or(TooComplex)?;
            let clip = forced || self.is_ear(&ring, corner)?;
            let (before, after) = (ring.previous(corner), ring.next(corner));
            if clip {
                triangles.push([before, corner, after]);
                ring.remove(corner);
                fruitless = 0;
                // Looking on from the corner after next gives fewer slivers than a fan.
                corner = ring.next(after);
            } else {
                fruitless += 1;
                corner = after;
            }
        }
        let (before, after) = (ring.previous(corner), ring.next(corner));
        triangles.push([before, corner, after]);
        Ok(triangles)
    }

    fn is_ear(&mut self, ring: &Ring<'_>, corner: u32) -> Result<bool, TooComplex> {
        if ring.turn(corner) <= 0.0 {
            // A corner on a straight edge is no ear, or its edge's neighbour would be cut off.
            return Ok(false);
        }
        let (before, after) = (ring.previous(corner), ring.next(corner));
        let [a, b, c] = [before, corner, after].map(|i| ring.at(i));
        for &other in &ring.reflex {
            self.work_left = self.work_left.checked_sub(1).ok_or(TooComplex)?;
            if !ring.is_reflex[other as usize] || [before, corner, after].contains(&other) {
                continue;
            }
            let p = ring.at(other);
            let same = |q: Coord<f64>| p.x == q.x && p.y == q.y;
            // A corner at the same place as one of the ear's (a bridge to a hole) is no obstacle.
            if same(a) || same(b) || same(c) {
                continue;
            }
            if orient2d(a, b, p) >= 0.0 && orient2d(b, c, p) >= 0.0 && orient2d(c, a, p) >= 0.0 {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The corners not yet clipped, as a doubly linked ring, counter-clockwise.
struct Ring<'a> {
    outline: &'a [Coord<f64>],
    links: Vec<[u32; 2]>,
    /// Corners that are or were reflex, and whether they still are.
    reflex: Vec<u32>,
    is_reflex: Vec<bool>,
    left: usize,
}

impl<'a> Ring<'a> {
    fn new(outline: &'a [Coord<f64>]) -> Self {
        let n = outline.len() as u32;
        let links = (0..n).map(|i| [(i + n - 1) % n, (i + 1) % n]).collect();
        let mut ring = Self {
            outline,
            links,
            reflex: Vec::new(),
            is_reflex: Vec::new(),
            left: outline.len(),
        };
        // Cutting ears off never makes a convex corner reflex, so the list only shrinks.
        ring.is_reflex = (0..n).map(|i| ring.turn(i) <= 0.0).collect();
        ring.reflex = (0..n).filter(|&i| ring.is_reflex[i as usize]).collect();
        ring
    }

    fn at(&self, corner: u32) -> Coord<f64> {
        self.outline[corner as usize]
    }

    fn previous(&self, corner: u32) -> u32 {
        self.links[corner as usize][0]
    }

    fn next(&self, corner: u32) -> u32 {
        self.links[corner as usize][1]
    }

    /// Positive where the outline turns left.
    fn turn(&self, corner: u32) -> f64 {
        orient2d(
            self.at(self.previous(corner)),
            self.at(corner),
            self.at(self.next(corner)),
        )
    }

    fn remove(&mut self, corner: u32) {
        let [before, after] = self.links[corner as usize];
        self.links[before as usize][1] = after;
        self.links[after as usize][0] = before;
        self.is_reflex[corner as usize] = false;
        self.left -= 1;
        for neighbour in [before, after] {
            if self.turn(neighbour) > 0.0 {
                self.is_reflex[neighbour as usize] = false;
            }
        }
        // Sweeping at every step would cost more than it saves.
        if self.left.is_power_of_two() || self.left.is_multiple_of(1024) {
            let is_reflex = &self.is_reflex;
            self.reflex.retain(|&i| is_reflex[i as usize]);
        }
    }
}

/// The outline without its coordinate along the greatest axis of its normal, counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<Coord<f64>> {
    let origin = corners[0];
    let mut normal = DVec3::ZERO;
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        normal += (*a - origin).cross(*b - origin);
    }
    let size = normal.abs();
    let (u, v, sign) = if size.z >= size.x && size.z >= size.y {
        (0, 1, normal.z)
    } else if size.y >= size.x {
        (2, 0, normal.y)
    } else {
        (1, 2, normal.x)
    };
    let (u, v) = if sign < 0.0 { (v, u) } else { (u, v) };
    let flat = |p: &DVec3| Coord { x: p[u], y: p[v] };
    corners.iter().map(flat).collect()
}

/// Whether the outline turns left at every corner, once round.
fn is_convex(outline: &[Coord<f64>]) -> bool {
    let n = outline.len();
    let origin = outline[0];
    (0..n).all(|i| {
        let [a, b, c] = [outline[i], outline[(i + 1) % n], outline[(i + 2) % n]];
        orient2d(a, b, c) > 0.0
    }) && (1..n - 1).all(|i| orient2d(origin, outline[i], outline[i + 1]) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area2(corners: &[DVec3]) -> f64 {
        let mut sum = 0.0;
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            sum += a.x * b.y - a.y * b.x;
        }
        sum
    }

    /// All triangles have the outline's orientation and cover its area: none overlap.
    fn check(corners: &[DVec3]) {
        let triangles = Triangulator::new().triangulate(corners).expect("simple");
        assert_eq!(triangles.len(), corners.len() - 2);
        let whole = area2(corners);
        let mut sum = 0.0;
        for t in &triangles {
            let part = area2(&t.map(|i| corners[i as usize]));
            assert!(part * whole >= 0.0, "{t:?} is turned over");
            sum += part;
        }
        assert!((sum - whole).abs() <= 1e-9 * whole.abs(), "{sum} {whole}");
    }

    fn flat(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn concave_outlines_of_both_orientations() {
        let arrow = flat(&[(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)]);
        let mut comb = vec![(20.0, -1.0), (20.0, 5.0)];
        for tooth in (0..10).rev() {
            let x = 2.0 * f64::from(tooth);
            comb.extend([
                (x + 1.5, 5.0),
                (x + 1.5, 0.0),
                (x + 1.0, 0.0),
                (x + 0.5, 5.0),
            ]);
        }
        comb.push((0.0, -1.0));
        for outline in [arrow, flat(&comb)] {
            check(&outline);
            check(&outline.iter().rev().copied().collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_spiral_with_thousands_of_inward_corners() {
        let mut outline = Vec::new();
        for i in 0..2000 {
            let angle = f64::from(i) * 0.02;
            outline.push(DVec3::new(
                angle * libm::cos(angle),
                angle * libm::sin(angle),
                0.0,
            ));
        }
        for i in (0..2000).rev() {
            let angle = f64::from(i) * 0.02;
            let r = angle + 2.0;
            outline.push(DVec3::new(r * libm::cos(angle), r * libm::sin(angle), 0.0));
        }
        check(&outline);
    }

    #[test]
    fn corners_on_straight_edges_are_used() {
        let outline = flat(&[
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (2.0, 2.0),
            (1.0, 2.0),
            (0.0, 2.0),
        ]);
        check(&outline);
        let triangles = Triangulator::new().triangulate(&outline).expect("simple");
        for corner in 0..6 {
            assert!(triangles.iter().flatten().any(|&i| i == corner));
        }
    }

    #[test]
    fn nonsense_still_gives_triangles() {
        let bow_tie = flat(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (0.5, 3.0)]);
        let point = vec![DVec3::ONE; 7];
        let line = flat(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.5, 0.0)]);
        for outline in [bow_tie, point, line] {
            let triangles = Triangulator::new().triangulate(&outline).expect("small");
            assert_eq!(triangles.len(), outline.len() - 2);
        }
    }

    #[test]
    fn the_work_is_bounded() {
        let mut zigzag = Vec::new();
        for i in 0..200_000 {
            let x = f64::from(i);
            zigzag.push(DVec3::new(
                x,
                if i % 2 == 0 { 0.0 } else { 1.0e6 / (1.0 + x) },
                0.0,
            ));
        }
        // Either it is done or it is refused; what matters is that it ends.
        let mut triangulator = Triangulator { work_left: 1 << 24 };
        if let Ok(triangles) = triangulator.triangulate(&zigzag) {
            assert_eq!(triangles.len(), zigzag.len() - 2);
        }
    }
}
