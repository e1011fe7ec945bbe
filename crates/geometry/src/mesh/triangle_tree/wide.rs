//! Triangles in a wide tree: several are ruled out at once in `f32`, what remains is decided in `f64`.

use std::ops::{ControlFlow, Range};

use octray_kernels::{
    BeamTriangles, Candidates, Kernels, Lanes, Scalar, TriangleLine, Vector, dispatch,
};
use octray_math::{Interval, Ray};
use octray_tree::wide_tree::{BEAM, Beam, BeamLine, PendingBeam};
use octray_tree::{LeafVisitor, LocalLine, WideTree, WideTreeConfig, WideTreeError};

use super::any::{BeamAny, FirstMet};
use super::beam::{BeamLeaves, BeamMemory, BeamNearest, Take};
use super::divide::Triangles;
use super::nearest::{Nearest, NearestTriangle, TriangleQuery};
use super::packed::PackedTriangles;
use super::search::{SearchCost, SearchMemory};
use super::settle::Settlement;
use super::{TriangleHit, TriangleRay};

/// The tree with its packed triangles.
#[derive(Clone, Debug)]
pub(super) struct WideTriangles {
    pub(super) tree: WideTree,
    packed: PackedTriangles,
}

/// Lines for which a beam is worth making.
const FEWEST: usize = 8;

/// Slopes of a beam's lines may differ by this much; wider beams meet too much in common. Most rays
/// to a lamp meet nothing, so that theirs have no end to spare them what lies behind.
const WIDEST: f32 = 0.25;
const WIDEST_TO_LAMP: f32 = 0.06;

/// Where the lines of a beam meet.
#[derive(Clone, Copy)]
enum Meeting {
    Start,
    End,
}

/// Proposes triangles of leaves.
pub(super) struct Leaves<'a> {
    items: &'a [u32],
    packed: &'a PackedTriangles,
    /// `None`: nothing is ruled out.
    line: Option<TriangleLine>,
    s_min: f32,
    /// Triangles in the leaves so far.
    pub(super) tested: u64,
}

impl<'a> Leaves<'a> {
    #[inline(always)]
    fn new(wide: &'a WideTriangles, local: &LocalLine, s_min: f32) -> Self {
        Self {
            items: wide.tree.items(),
            packed: &wide.packed,
            line: local.triangle_line(),
            s_min,
            tested: 0,
        }
    }

    /// The triangles at the places, and what the kernel says about them.
    #[inline(always)]
    pub(super) fn test(
        &mut self,
        kernels: impl Kernels,
        places: Range<usize>,
        s_max: f32,
        found: &mut Candidates,
    ) -> &'a [u32] {
        let count = places.len();
        self.tested += count as u64;
        if let Some(line) = &self.line {
            let rows = self.packed.leaf(&places);
            kernels.test_triangles(line, rows, count, self.s_min, s_max, found);
        } else {
            found.possible = (1 << count) - 1;
            found.certain = 0;
            found.nearest = [f32::NEG_INFINITY; 8];
            found.farthest = [f32::INFINITY; 8];
        }
        &self.items[places]
    }
}

/// Shows every triangle that the line crosses.
struct Crossed<'a, F> {
    leaves: Leaves<'a>,
    exact: Triangles<'a>,
    line: TriangleRay,
    local: &'a LocalLine,
    span: Interval,
    visit: F,
}

impl<F: FnMut(u32, &TriangleHit, f64) -> ControlFlow<(), f64>> LeafVisitor for Crossed<'_, F> {
    #[inline(always)]
    fn leaf(
        &mut self,
        kernels: impl Kernels,
        places: Range<usize>,
        mut s_max: f32,
    ) -> ControlFlow<(), f32> {
        let mut found = Candidates::NONE;
        let items = self.leaves.test(kernels, places, s_max, &mut found);
        while found.possible != 0 {
            let lane = found.possible.trailing_zeros() as usize;
            found.possible &= found.possible - 1;
            let triangle = items[lane];
            let Some(hit) = self.line.intersect(self.exact.corners(triangle)) else {
                continue;
            };
            if self.span.contains(hit.t) {
                // Only ever shortens the span.
                let limit = (self.visit)(triangle, &hit, self.span.end)?;
                if limit < self.span.end {
                    self.span.end = limit;
                    s_max = self.local.upper(limit);
                }
            }
        }
        ControlFlow::Continue(s_max)
    }
}

impl WideTriangles {
    /// Over all triangles.
    ///
    /// # Errors
    /// It would be too large.
    pub(super) fn build(
        exact: &Triangles<'_>,
        config: &WideTreeConfig,
    ) -> Result<Self, WideTreeError> {
        let tree = WideTree::over(exact, config)?;
        let needed = tree.stats().bytes + PackedTriangles::bytes_for(tree.items().len());
        if needed > config.memory_limit {
            return Err(WideTreeError::Memory {
                items: exact.triangles.len(),
                needed,
                limit: config.memory_limit,
            });
        }
        let packed = PackedTriangles::new(&tree, |triangle| exact.corners(triangle));
        Ok(Self { tree, packed })
    }

    pub(super) fn set_lanes(&mut self, lanes: Lanes) {
        self.tree.set_lanes(lanes);
    }

    /// Bytes of the triangles beside the tree.
    pub(super) fn packed_bytes(&self) -> u64 {
        self.packed.bytes()
    }

    /// Shows `visit` the triangles that the line crosses in `span`, until it breaks off; it returns
    /// the new end of the span.
    #[inline]
    pub(super) fn crossed(
        &self,
        exact: Triangles<'_>,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        visit: impl FnMut(u32, &TriangleHit, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        if span.is_empty() {
            return ControlFlow::Continue(());
        }
        let Some(local) = self.tree.line(ray) else {
            return ControlFlow::Continue(());
        };
        let reach = [local.lower(span.start), local.upper(span.end)];
        let mut visitor = Crossed {
            leaves: Leaves::new(self, &local, reach[0]),
            exact,
            line: TriangleRay::new(ray),
            local: &local,
            span,
            visit,
        };
        let stack = memory.stack(&self.tree);
        let (tree, walk) = (&self.tree, &mut cost.walk);
        let flow = match tree.lanes() {
            Lanes::Scalar => tree.walk(Scalar, &local, reach, stack, walk, &mut visitor),
            Lanes::Vector(level) => dispatch!(level, simd =>
                tree.walk(Vector(simd), &local, reach, stack, walk, &mut visitor)),
        };
        cost.walk.items += visitor.leaves.tested;
        flow
    }

    /// The nearest triangle on each line.
    pub(super) fn nearest(
        &self,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        answer: impl FnMut(usize, Option<NearestTriangle>, SearchCost),
    ) {
        match self.tree.lanes() {
            Lanes::Scalar => self.nearest_with(Scalar, exact, queries, memory, answer),
            Lanes::Vector(level) => dispatch!(level, simd =>
                self.nearest_with(Vector(simd), exact, queries, memory, answer)),
        }
    }

    #[inline(always)]
    fn nearest_with(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        mut answer: impl FnMut(usize, Option<NearestTriangle>, SearchCost),
    ) {
        let mut beams = memory.beams.take().unwrap_or_default();
        let mut first = 0;
        for part in queries.chunks(BEAM) {
            let BeamMemory {
                beam,
                stack,
                triangles,
                known,
                settlement,
                costs,
            } = &mut *beams;
            settlement.clear(part.len());
            let costs = &mut costs[..part.len()];
            if memory.coherence.allows() && self.beam(part, Meeting::Start, beam) {
                let take = BeamNearest::new(exact, part, known, &mut settlement.best);
                let mut visitor = self.beam_leaves(beam, triangles, take);
                let cost = self.walk_beam(kernels, stack, &mut visitor);
                memory.coherence.learn(&cost, part.len());
                known.finish(beam, part.len(), &mut settlement.undecided);
                for (index, own) in costs.iter_mut().enumerate() {
                    *own = cost.share(index, part.len());
                }
            } else {
                for (index, (query, cost)) in part.iter().zip(&mut *costs).enumerate() {
                    *cost = SearchCost::default();
                    self.nearest_one(kernels, exact, (index, query), memory, cost, settlement);
                }
            }
            settlement.settle(kernels, exact, part);
            for (index, (&found, &cost)) in settlement.best.iter().zip(&*costs).enumerate() {
                answer(first + index, found, cost);
            }
            first += part.len();
        }
        memory.beams = Some(beams);
    }

    /// Whether `counts` is true of any triangle on each line.
    pub(super) fn any_of(
        &self,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        counts: impl FnMut(usize, &NearestTriangle) -> bool,
        answer: impl FnMut(usize, bool, SearchCost),
    ) {
        match self.tree.lanes() {
            Lanes::Scalar => self.any_with(Scalar, exact, queries, memory, counts, answer),
            Lanes::Vector(level) => dispatch!(level, simd =>
                self.any_with(Vector(simd), exact, queries, memory, counts, answer)),
        }
    }

    #[inline(always)]
    fn any_with(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        mut counts: impl FnMut(usize, &NearestTriangle) -> bool,
        mut answer: impl FnMut(usize, bool, SearchCost),
    ) {
        let mut beams = memory.beams.take().unwrap_or_default();
        let mut first = 0;
        for part in queries.chunks(BEAM) {
            let BeamMemory {
                beam,
                stack,
                triangles,
                settlement,
                costs,
                ..
            } = &mut *beams;
            settlement.clear(part.len());
            let costs = &mut costs[..part.len()];
            if memory.coherence.allows()
                && (self.beam(part, Meeting::End, beam) || self.beam(part, Meeting::Start, beam))
            {
                let take = BeamAny {
                    exact,
                    queries: part,
                    undecided: &mut settlement.undecided,
                    is_early: &mut settlement.is_early,
                };
                let mut visitor = self.beam_leaves(beam, triangles, take);
                let cost = self.walk_beam(kernels, stack, &mut visitor);
                memory.coherence.learn(&cost, part.len());
                for (index, own) in costs.iter_mut().enumerate() {
                    *own = cost.share(index, part.len());
                }
            } else {
                for (index, (query, cost)) in part.iter().zip(&mut *costs).enumerate() {
                    *cost = SearchCost::default();
                    self.first_met(kernels, exact, (index, query), memory, cost, settlement);
                }
            }
            let mut met = settlement.met;
            settlement.each(kernels, exact, part, |index, found| {
                met[index] = met[index]
                    || (!part[index].leaves(found.triangle, &exact)
                        && counts(first + index, &found));
            });
            for (index, (query, cost)) in part.iter().zip(&mut *costs).enumerate() {
                let is_met = met[index]
                    || (settlement.is_early[index]
                        && self.any_one(kernels, exact, query, memory, cost, |found| {
                            counts(first + index, found)
                        }));
                answer(first + index, is_met, *cost);
            }
            first += part.len();
        }
        memory.beams = Some(beams);
    }

    /// Makes a beam of lines that meet at one end, if there are enough of them and they are neighbours.
    fn beam(&self, queries: &[TriangleQuery], meeting: Meeting, beam: &mut Beam) -> bool {
        let widest = match meeting {
            Meeting::Start => WIDEST,
            Meeting::End => WIDEST_TO_LAMP,
        };
        let line = |index: usize| {
            let TriangleQuery { ray, span, .. } = queries[index];
            let (at, end) = match meeting {
                Meeting::Start => (span.start, span.end),
                Meeting::End => (span.end, span.start),
            };
            (at.is_finite() && !span.is_empty()).then_some(BeamLine { ray, at, end })
        };
        queries.len() >= FEWEST && self.tree.beam(queries.len(), line, widest, beam)
    }

    fn beam_leaves<'a, T: Take>(
        &'a self,
        beam: &'a mut Beam,
        triangles: &'a mut BeamTriangles,
        take: T,
    ) -> BeamLeaves<'a, T> {
        BeamLeaves {
            beam,
            items: self.tree.items(),
            packed: &self.packed,
            tested: 0,
            triangles,
            take,
        }
    }

    #[inline(always)]
    fn walk_beam<T: Take>(
        &self,
        kernels: impl Kernels,
        stack: &mut Vec<PendingBeam>,
        visitor: &mut BeamLeaves<'_, T>,
    ) -> SearchCost {
        let mut cost = SearchCost::default();
        if stack.len() < self.tree.stack_length() {
            stack.resize(self.tree.stack_length(), PendingBeam::default());
        }
        self.tree.walk_beam(kernels, stack, &mut cost.walk, visitor);
        cost.walk.items += visitor.tested;
        cost
    }

    /// Walks alone and decides every triangle at once.
    #[inline(never)]
    fn any_one(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        query: &TriangleQuery,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut counts: impl FnMut(&NearestTriangle) -> bool,
    ) -> bool {
        if query.span.is_empty() {
            return false;
        }
        let Some(local) = self.tree.line(&query.ray) else {
            return false;
        };
        let reach = [local.lower(query.span.start), local.upper(query.span.end)];
        let mut visitor = Crossed {
            leaves: Leaves::new(self, &local, reach[0]),
            exact,
            line: TriangleRay::new(&query.ray),
            local: &local,
            span: query.span,
            visit: |triangle, hit: &TriangleHit, end| {
                let found = NearestTriangle {
                    t: hit.t,
                    triangle,
                    entering: hit.entering,
                };
                if query.counts(hit.t) && !query.leaves(triangle, &exact) && counts(&found) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(end)
                }
            },
        };
        let (walk, stack) = (&mut cost.walk, memory.stack(&self.tree));
        let flow = self
            .tree
            .walk(kernels, &local, reach, stack, walk, &mut visitor);
        walk.items += visitor.leaves.tested;
        flow.is_break()
    }

    /// Walks alone until something is met; exact tests are left to the settlement.
    #[inline(always)]
    fn first_met(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        (index, query): (usize, &TriangleQuery),
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        settlement: &mut Settlement,
    ) {
        if query.span.is_empty() {
            return;
        }
        let Some(local) = self.tree.line(&query.ray) else {
            return;
        };
        let reach = [local.lower(query.span.start), local.upper(query.span.end)];
        let leaves = Leaves::new(self, &local, reach[0]);
        let undecided = &mut settlement.undecided;
        let mut visitor = FirstMet::new(leaves, exact, (index, query), &local, undecided);
        let (walk, stack) = (&mut cost.walk, memory.stack(&self.tree));
        let flow = self
            .tree
            .walk(kernels, &local, reach, stack, walk, &mut visitor);
        walk.items += visitor.tested();
        settlement.is_early[index % BEAM] = flow.is_break();
    }

    /// Walks alone; exact tests are left to the settlement.
    #[inline(always)]
    fn nearest_one(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        (index, query): (usize, &TriangleQuery),
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        settlement: &mut Settlement,
    ) {
        if query.span.is_empty() {
            return;
        }
        let Some(local) = self.tree.line(&query.ray) else {
            return;
        };
        let reach = [local.lower(query.span.start), local.upper(query.span.end)];
        let leaves = Leaves::new(self, &local, reach[0]);
        let mut visitor = Nearest::new(leaves, exact, query, &local);
        let (walk, stack) = (&mut cost.walk, memory.stack(&self.tree));
        // The search never breaks off.
        let _ = self
            .tree
            .walk(kernels, &local, reach, stack, walk, &mut visitor);
        walk.items += visitor.tested();
        settlement.best[index % BEAM] = visitor.finish(index, &mut settlement.undecided);
    }
}
