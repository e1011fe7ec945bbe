//! Triangles as the items of a tree, and what they have within a box on either side of a plane.

use octray_math::{Aabb, DVec3};
use octray_tree::wide_tree::{Coordinates, Items};

/// Triangles as they are: corners as indices into positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles<'a> {
    pub(super) positions: &'a [DVec3],
    pub(super) triangles: &'a [[u32; 3]],
}

/// A convex polygon: a triangle of which up to six planes have cut a corner each.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [DVec3; 10],
    count: usize,
}

/// How far beyond their place planes cut, in the tree's coordinates.
///
/// All coordinates are at most 1 in size. A corner that a plane makes lies on an edge; the share of
/// the edge is computed with three roundings, the point with three more per axis, so with edges up
/// to 2 it is off by less than `2^-49`. A polygon that was cut seven times so has every point of
/// the exact one within `2^-46` of it, if the planes are this much farther out than what is asked
/// for: a point that a step leaves at a distance of `k 2^-49` still has a companion on this side of
/// the next plane.
const MARGIN: f64 = 1.0 / (1u64 << 46) as f64;

impl Triangles<'_> {
    #[inline]
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        let p = self.positions;
        [p[a as usize], p[b as usize], p[c as usize]]
    }
}

impl Items for Triangles<'_> {
    fn count(&self) -> usize {
        self.triangles.len()
    }

    fn bounds(&self, item: u32) -> Aabb {
        Aabb::from_points(self.corners(item))
    }

    const DIVISIBLE: bool = true;

    fn halves(
        &self,
        item: u32,
        coordinates: &Coordinates,
        within: &Aabb,
        planes: DVec3,
    ) -> [[Aabb; 2]; 3] {
        let corners = self.corners(item).map(|p| coordinates.point(p));
        let mut polygon = Polygon::new(corners);
        let whole = Aabb::from_points(corners);
        let (low, high) = (within.min - MARGIN, within.max + MARGIN);
        for axis in 0..3 {
            if whole.min[axis] < low[axis] {
                polygon = polygon.cut(axis, |x| x - low[axis]);
            }
            if whole.max[axis] > high[axis] {
                polygon = polygon.cut(axis, |x| high[axis] - x);
            }
        }
        [0, 1, 2].map(|axis| {
            let (below, above) = (planes[axis] + MARGIN, planes[axis] - MARGIN);
            [
                polygon.bounds(axis, |x| below - x),
                polygon.bounds(axis, |x| x - above),
            ]
            .map(|half| half.inflated(MARGIN))
        })
    }
}

impl Polygon {
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let mut corners = [DVec3::ZERO; 10];
        corners[..3].copy_from_slice(&[a, b, c]);
        Self { corners, count: 3 }
    }

    /// Each corner with the one before it.
    fn edges(&self) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
        let corners = &self.corners[..self.count];
        let before = corners.iter().skip(self.count.max(1) - 1).chain(corners);
        before.copied().zip(corners.iter().copied())
    }

    /// A box around what lies where `height` of a coordinate, which is exact but for its last place,
    /// is not negative.
    #[inline]
    fn bounds(&self, axis: usize, height: impl Fn(f64) -> f64) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for (last, corner) in self.edges() {
            let (from, to) = (height(last[axis]), height(corner[axis]));
            if (from >= 0.0) != (to >= 0.0) {
                bounds = bounds.including(between(last, corner, from, to));
            }
            if to >= 0.0 {
                bounds = bounds.including(corner);
            }
        }
        bounds
    }

    /// What lies there (Sutherland & Hodgman 1974).
    fn cut(&self, axis: usize, height: impl Fn(f64) -> f64) -> Self {
        let mut cut = Self {
            corners: [DVec3::ZERO; 10],
            count: 0,
        };
        for (last, corner) in self.edges() {
            // Convex polygons never have so many corners; rounded ones keep what a cut would take.
            if cut.count + 2 > cut.corners.len() {
                return *self;
            }
            let (from, to) = (height(last[axis]), height(corner[axis]));
            if (from >= 0.0) != (to >= 0.0) {
                cut.push(between(last, corner, from, to));
            }
            if to >= 0.0 {
                cut.push(corner);
            }
        }
        cut
    }

    const fn push(&mut self, corner: DVec3) {
        self.corners[self.count] = corner;
        self.count += 1;
    }
}

/// Where the edge between two points of these heights, one negative, has none.
#[inline]
fn between(a: DVec3, b: DVec3, a_height: f64, b_height: f64) -> DVec3 {
    a + (b - a) * (a_height / (a_height - b_height))
}
