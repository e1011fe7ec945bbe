//! Triangles where they stand, and those that a line crosses.

use octray_math::{Aabb, DVec3, Interval, Ray};
use octray_tree::{WalkCost, WideTree, WideTreeConfig, WideTreeError, WideTreeStats};

use super::{TriangleHit, TriangleRay};

/// Triangles of world coordinates with an octree over them, or without one: the oracle.
///
/// Answers are the same bits either way.
#[derive(Clone, Debug)]
pub struct TriangleTree {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tree: Option<WideTree>,
}

impl TriangleTree {
    /// Takes corners as indices into `positions`; builds an octree if there is a configuration.
    ///
    /// # Errors
    /// The tree would be too large; see [`WideTreeError`].
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn new(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        config: Option<&WideTreeConfig>,
    ) -> Result<Self, WideTreeError> {
        let mut triangles = Self {
            positions,
            triangles,
            tree: None,
        };
        if let Some(config) = config {
            let bounds: Vec<Aabb> = (0..triangles.len() as u32)
                .map(|i| triangles.bounds(i))
                .collect();
            triangles.tree = Some(WideTree::build(&bounds, config)?);
        }
        Ok(triangles)
    }

    /// How many triangles there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The corners of a triangle.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        let p = &self.positions;
        [p[a as usize], p[b as usize], p[c as usize]]
    }

    /// Whether two triangles lie in one plane, exactly: a line that leaves one for good cannot cross
    /// the other. Triangles that stand in a file twice do, and so do overlapping ones of one level.
    #[must_use]
    pub fn are_coplanar(&self, a: u32, b: u32) -> bool {
        let coord = |p: DVec3| robust::Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        let [p, q, r] = self.corners(a).map(coord);
        let on_plane = |s: DVec3| robust::orient3d(p, q, r, coord(s)) == 0.0;
        a == b || self.corners(b).into_iter().all(on_plane)
    }

    /// The box around a triangle.
    pub(super) fn bounds(&self, triangle: u32) -> Aabb {
        Aabb::from_points(self.corners(triangle))
    }

    /// Bytes of the triangles and their corners.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice())) as u64
    }

    /// Figures about the octree.
    #[must_use]
    pub fn tree_stats(&self) -> Option<&WideTreeStats> {
        self.tree.as_ref().map(WideTree::stats)
    }

    /// The octree as words: equal for equal triangles, whatever built it.
    pub fn tree_words(&self) -> impl Iterator<Item = u32> + '_ {
        let bytes = self.tree.iter().flat_map(WideTree::bytes);
        bytes.flat_map(|part| {
            let (words, _) = part.as_chunks();
            words.iter().map(|&word| u32::from_ne_bytes(word))
        })
    }

    /// Shows `visit` the triangles that the line crosses in `span` (ends included), until nothing
    /// better can come: `visit(triangle, hit, end)` returns the new end of the span, or `end`.
    ///
    /// All triangles up to the final end are shown, those at the end itself too, in no particular
    /// order. `cost.items` counts triangles tested.
    #[inline]
    pub fn closest(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32, &TriangleHit, f64) -> f64,
    ) {
        let line = TriangleRay::new(ray);
        let mut test = |triangle: u32, end: f64| match line.intersect(self.corners(triangle)) {
            Some(hit) if span.start <= hit.t && hit.t <= end => {
                // Only ever shortens the span.
                let limit = visit(triangle, &hit, end);
                if limit < end { limit } else { end }
            }
            _ => end,
        };
        match &self.tree {
            Some(tree) => tree.closest(ray, span, cost, test),
            None => {
                let mut end = span.end;
                for triangle in 0..self.triangles.len() as u32 {
                    end = test(triangle, end);
                }
                cost.items += self.triangles.len() as u64;
            }
        }
    }

    /// Whether `visit` is true of any triangle that the line crosses in `span`; stops at the first.
    #[inline]
    pub fn any(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32, &TriangleHit) -> bool,
    ) -> bool {
        let line = TriangleRay::new(ray);
        let mut test = |triangle: u32| {
            line.intersect(self.corners(triangle))
                .is_some_and(|hit| span.contains(hit.t) && visit(triangle, &hit))
        };
        match &self.tree {
            Some(tree) => tree.any(ray, span, cost, test),
            None => (0..self.triangles.len() as u32).any(|triangle| {
                cost.items += 1;
                test(triangle)
            }),
        }
    }

    /// Shows `visit` every triangle that the line crosses in `span`, in no particular order.
    #[inline]
    pub fn all(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32, &TriangleHit),
    ) {
        self.closest(ray, span, cost, |triangle, hit, end| {
            visit(triangle, hit);
            end
        });
    }

    /// Whether the box of any triangle overlaps `region`.
    #[must_use]
    pub fn overlaps(&self, region: &Aabb) -> bool {
        let near = |triangle: u32| self.bounds(triangle).overlaps(region);
        match &self.tree {
            Some(tree) => tree.any_overlapping(region, near),
            None => (0..self.triangles.len() as u32).any(near),
        }
    }
}
