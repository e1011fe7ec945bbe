//! Triangles where they stand, and those that a line crosses.

mod any;
mod beam;
mod cells;
mod divide;
mod membership;
mod nearest;
mod occupied;
mod packed;
mod search;
mod settle;
mod volumes;
mod wide;

use std::ops::{ControlFlow, Range};

use octray_kernels::Lanes;
use octray_math::{Aabb, DVec3, Interval, Ray};
use octray_tree::traversal::Steps;
use octray_tree::{Partition, WideTreeError, WideTreeStats};

use super::{TriangleHit, TriangleRay};
use cells::TriangleCells;
use divide::Triangles;
pub use membership::TriangleMarks;
pub use nearest::{NearestTriangle, TriangleQuery};
pub use search::{SearchCost, SearchMemory, TriangleSearch};
use volumes::ObjectVolumes;
use wide::WideTriangles;

/// Triangles of world coordinates with a structure that finds those on a line, or without one: the
/// oracle.
///
/// Answers are the same bits whatever the structure.
#[derive(Clone, Debug)]
pub struct TriangleTree {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    index: Index,
}

/// So many triangles are tested one by one.
const FEW: u32 = 4;

/// What finds the triangles on a line; see [`TriangleSearch`].
#[derive(Clone, Debug)]
enum Index {
    All,
    Wide(Box<WideTriangles>),
    Volumes(ObjectVolumes),
    Cells(Box<TriangleCells>),
}

impl TriangleTree {
    /// Takes corners as indices into `positions`, and the index of the first triangle of each object
    /// (increasing, the first 0): only volumes around objects ask for them. Works inside the current
    /// thread pool; the result does not depend on it.
    ///
    /// # Errors
    /// The wide tree would be too large; see [`WideTreeError`].
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn new(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        objects: &[u32],
        search: &TriangleSearch,
    ) -> Result<Self, WideTreeError> {
        let mut all = Self {
            positions,
            triangles,
            index: Index::All,
        };
        let count = all.len() as u32;
        all.index = match *search {
            TriangleSearch::All => Index::All,
            // A floor of two triangles is tested sooner than a tree is entered.
            TriangleSearch::Wide(_) if count <= FEW => Index::All,
            TriangleSearch::Wide(config) => {
                Index::Wide(Box::new(WideTriangles::build(&all.exact(), &config)?))
            }
            TriangleSearch::Spheres | TriangleSearch::Boxes => {
                let ends = objects.iter().skip(1).copied().chain([count]);
                let ranges = objects
                    .iter()
                    .zip(ends)
                    .map(|(&a, b)| Range { start: a, end: b });
                let spheres = *search == TriangleSearch::Spheres;
                Index::Volumes(ObjectVolumes::new(ranges, |t| all.corners(t), spheres))
            }
            TriangleSearch::Cells {
                division,
                table,
                membership,
                criteria,
            } => TriangleCells::build(
                &all.positions,
                &all.triangles,
                (division, table),
                membership,
                &criteria,
            )
            .map_or(Index::All, |cells| Index::Cells(Box::new(cells))),
        };
        Ok(all)
    }

    /// The same with the kernels of the wide octree, if there is one, run as given. No answer depends on
    /// it.
    #[must_use]
    pub fn with_lanes(mut self, lanes: Lanes) -> Self {
        if let Index::Wide(wide) = &mut self.index {
            wide.set_lanes(lanes);
        }
        self
    }

    /// How kernels run.
    #[must_use]
    pub const fn lanes(&self) -> Lanes {
        match &self.index {
            Index::Wide(wide) => wide.tree.lanes(),
            _ => Lanes::Scalar,
        }
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

    #[inline]
    fn exact(&self) -> Triangles<'_> {
        Triangles {
            positions: &self.positions,
            triangles: &self.triangles,
        }
    }

    /// The corners of a triangle.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.exact().corners(triangle)
    }

    /// Whether two triangles lie in one plane, exactly: a line that leaves one for good cannot cross
    /// the other. Triangles that stand in a file twice do, and so do overlapping ones of one level.
    #[must_use]
    pub fn are_coplanar(&self, a: u32, b: u32) -> bool {
        a == b || are_coplanar(self.corners(a), self.corners(b))
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

    /// Figures about the wide octree, if there is one.
    #[must_use]
    pub const fn tree_stats(&self) -> Option<&WideTreeStats> {
        match &self.index {
            Index::Wide(wide) => Some(wide.tree.stats()),
            _ => None,
        }
    }

    /// Bytes of the corners that stand with the wide octree, in the order of its leaves.
    #[must_use]
    pub fn packed_bytes(&self) -> u64 {
        match &self.index {
            Index::Wide(wide) => wide.packed_bytes(),
            _ => 0,
        }
    }

    const fn cells(&self) -> Option<&TriangleCells> {
        match &self.index {
            Index::Cells(cells) => Some(cells),
            _ => None,
        }
    }

    /// The cells, if there are any.
    #[must_use]
    pub fn partition(&self) -> Option<&Partition> {
        self.cells().map(TriangleCells::partition)
    }

    /// What decided which triangles the cells list, if there are any.
    #[must_use]
    pub fn marks(&self) -> Option<&TriangleMarks> {
        self.cells().map(TriangleCells::marks)
    }

    /// The triangles that touch an occupied cell, increasing; none where there are no cells.
    ///
    /// # Panics
    /// If there are cells, but not so many occupied ones.
    #[must_use]
    pub fn listed(&self, leaf: u32) -> &[u32] {
        self.cells().map_or(&[], |cells| cells.listed(leaf))
    }

    /// Bytes of the cells with their lists of triangles, 0 where there are none.
    #[must_use]
    pub fn cell_bytes(&self) -> u64 {
        self.cells().map_or(0, TriangleCells::bytes)
    }

    /// The octree or the cells as words: equal for equal triangles, whatever built it.
    pub fn tree_words(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        match &self.index {
            Index::All | Index::Volumes(_) => Box::new(std::iter::empty()),
            Index::Wide(wide) => Box::new(wide.tree.bytes().into_iter().flat_map(|part| {
                let (words, _) = part.as_chunks();
                words.iter().map(|&word| u32::from_ne_bytes(word))
            })),
            Index::Cells(cells) => Box::new(cells.words()),
        }
    }

    /// Whether [`TriangleTree::nearest`] and [`TriangleTree::any_of`] are faster for many lines than for
    /// each by itself.
    #[must_use]
    pub fn has_slices(&self) -> bool {
        matches!(&self.index, Index::Wide(_)) && !self.is_empty()
    }

    /// Whether neighbouring rays travel together: then [`TriangleTree::enter`] is worth its call.
    #[must_use]
    pub fn has_beams(&self) -> bool {
        matches!(&self.index, Index::Cells(cells) if cells.has_beams())
    }

    /// Takes a run of rays, each with the part of it that counts, through the upper cells together;
    /// until [`SearchMemory::leave`], only these may be searched with this memory. Returns what it
    /// cost.
    pub fn enter(&self, rays: &[(Ray, Interval)], memory: &mut SearchMemory) -> Steps {
        match &self.index {
            Index::Cells(cells) => cells.enter(rays, memory),
            _ => Steps::default(),
        }
    }

    /// Shows `visit` the triangles that the line crosses in `span` (ends included), until nothing
    /// better can come: `visit(triangle, hit, end)` returns the new end of the span, or `end`.
    ///
    /// All triangles up to the final end are shown, those at the end itself too, in no particular
    /// order; one that stands in several leaves of the wide octree may be shown more than once.
    /// `cost.walk.items` counts triangles tested.
    #[inline]
    pub fn closest(
        &self,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut visit: impl FnMut(u32, &TriangleHit, f64) -> f64,
    ) {
        if let Index::Wide(wide) = &self.index {
            // A search that never breaks off has no result of its own.
            let _ = wide.crossed(
                self.exact(),
                ray,
                span,
                memory,
                cost,
                |triangle, hit, end| ControlFlow::Continue(visit(triangle, hit, end)),
            );
            return;
        }
        let line = TriangleRay::new(ray);
        let test = |triangle: u32, end: f64| match line.intersect(self.corners(triangle)) {
            Some(hit) if span.start <= hit.t && hit.t <= end => {
                // Only ever shortens the span.
                let limit = visit(triangle, &hit, end);
                if limit < end { limit } else { end }
            }
            _ => end,
        };
        self.propose(ray, span, memory, cost, test);
    }

    /// Gives `answer` the nearest triangle on each line, with the line's index and what the search
    /// cost, each index once.
    pub fn nearest(
        &self,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        mut answer: impl FnMut(usize, Option<NearestTriangle>, SearchCost),
    ) {
        if let Index::Wide(wide) = &self.index {
            wide.nearest(self.exact(), queries, memory, answer);
            return;
        }
        for (index, query) in queries.iter().enumerate() {
            let mut cost = SearchCost::default();
            let mut best: Option<NearestTriangle> = None;
            self.closest(
                &query.ray,
                query.span,
                memory,
                &mut cost,
                |triangle, hit, end| {
                    let found = NearestTriangle {
                        t: hit.t,
                        triangle,
                        entering: hit.entering,
                    };
                    let left = |from| self.are_coplanar(from, triangle);
                    if hit.t > query.span.start
                        && found.is_before(best.as_ref())
                        && !query.departed.is_some_and(left)
                    {
                        best = Some(found);
                    }
                    best.map_or(end, |best| best.t)
                },
            );
            answer(index, best, cost);
        }
    }

    /// Gives `answer` whether `counts` is true of any triangle on each line, with the line's index and
    /// what the search cost, each index once. `counts` gets the line's index, and where it crosses which
    /// triangle; it is asked only about what the query leaves open.
    pub fn any_of(
        &self,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        mut counts: impl FnMut(usize, &NearestTriangle) -> bool,
        mut answer: impl FnMut(usize, bool, SearchCost),
    ) {
        if let Index::Wide(wide) = &self.index {
            wide.any_of(self.exact(), queries, memory, counts, answer);
            return;
        }
        for (index, query) in queries.iter().enumerate() {
            let mut cost = SearchCost::default();
            let met = self.any(
                &query.ray,
                query.span,
                memory,
                &mut cost,
                |triangle, hit| {
                    let found = NearestTriangle {
                        t: hit.t,
                        triangle,
                        entering: hit.entering,
                    };
                    query.counts(hit.t)
                        && !query.leaves(triangle, &self.exact())
                        && counts(index, &found)
                },
            );
            answer(index, met, cost);
        }
    }

    /// Whether `visit` is true of any triangle that the line crosses in `span`; stops at the first.
    #[inline]
    pub fn any(
        &self,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut visit: impl FnMut(u32, &TriangleHit) -> bool,
    ) -> bool {
        if let Index::Wide(wide) = &self.index {
            let visit = |triangle, hit: &TriangleHit, end| {
                if visit(triangle, hit) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(end)
                }
            };
            return wide
                .crossed(self.exact(), ray, span, memory, cost, visit)
                .is_break();
        }
        let line = TriangleRay::new(ray);
        let mut test = |triangle: u32| {
            line.intersect(self.corners(triangle))
                .is_some_and(|hit| span.contains(hit.t) && visit(triangle, &hit))
        };
        let mut found = false;
        self.propose(ray, span, memory, cost, |triangle, end| {
            found = found || test(triangle);
            if found { f64::NEG_INFINITY } else { end }
        });
        found
    }

    /// Shows `visit` every triangle that the line crosses in `span`, each once and in no particular
    /// order.
    #[inline]
    pub fn all(
        &self,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut visit: impl FnMut(u32, &TriangleHit),
    ) {
        let once = self
            .tree_stats()
            .is_none_or(|tree| tree.references == tree.items);
        let mut found: Vec<(u32, TriangleHit)> = Vec::new();
        self.closest(ray, span, memory, cost, |triangle, hit, end| {
            if once {
                visit(triangle, hit);
            } else {
                found.push((triangle, *hit));
            }
            end
        });
        found.sort_unstable_by_key(|(triangle, _)| *triangle);
        found.dedup_by_key(|(triangle, _)| *triangle);
        for (triangle, hit) in &found {
            visit(*triangle, hit);
        }
    }

    /// Shows `test` the triangles that may lie on the line in `span`, each once; it returns the new
    /// end of the span.
    fn propose(
        &self,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut test: impl FnMut(u32, f64) -> f64,
    ) {
        match &self.index {
            Index::Volumes(volumes) => volumes.visit(ray, span, cost, test),
            Index::Cells(cells) if cells.can_walk(ray) => {
                cells.visit(ray, span, memory, cost, test);
            }
            _ => {
                let mut end = span.end;
                for triangle in 0..self.triangles.len() as u32 {
                    if end < span.start {
                        return;
                    }
                    cost.walk.items += 1;
                    end = test(triangle, end);
                }
            }
        }
    }

    /// Whether the box of any triangle overlaps `region`.
    #[must_use]
    pub fn overlaps(&self, region: &Aabb) -> bool {
        let near = |triangle: u32| self.bounds(triangle).overlaps(region);
        match &self.index {
            Index::Wide(wide) => wide.tree.any_overlapping(region, near),
            _ => (0..self.triangles.len() as u32).any(near),
        }
    }
}

/// Whether two triangles lie in one plane, exactly.
fn are_coplanar(a: [DVec3; 3], b: [DVec3; 3]) -> bool {
    let coord = |p: DVec3| robust::Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    let [p, q, r] = a.map(coord);
    let on_plane = |s: DVec3| robust::orient3d(p, q, r, coord(s)) == 0.0;
    b.into_iter().all(on_plane)
}
