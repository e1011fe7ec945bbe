//! Triangles in a wide tree: several are ruled out at once in `f32`, what remains is decided in `f64`.

use std::ops::{ControlFlow, Range};

use octray_kernels::{
    BeamTriangles, Candidates, Kernels, Lanes, Scalar, TriangleLine, Vector, dispatch,
};
use octray_math::{Interval, Ray};
use octray_tree::wide_tree::{BEAM, Beam, BeamLine};
use octray_tree::{LeafVisitor, LocalLine, WideTree, WideTreeConfig, WideTreeError};

use super::beam::{BeamAny, BeamLeaves, BeamNearest, Take};
use super::divide::Triangles;
use super::nearest::{Nearest, NearestTriangle, TriangleQuery};
use super::packed::PackedTriangles;
use super::search::{SearchCost, SearchMemory};
use super::{TriangleHit, TriangleRay};

/// The tree with its packed triangles.
#[derive(Clone, Debug)]
pub(super) struct WideTriangles {
    pub(super) tree: WideTree,
    packed: PackedTriangles,
}

/// Lines for which a beam is worth making.
const FEWEST: usize = 8;

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
        let mut found = Candidates::default();
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
        let mut first = 0;
        for part in queries.chunks(BEAM) {
            if let Some(beam) = self.beam(part, Meeting::Start) {
                let mut visitor = self.beam_leaves(beam, BeamNearest::new(exact, part));
                let cost = self.walk_beam(kernels, memory, &mut visitor);
                for index in 0..part.len() {
                    let found = visitor.take.finish(&visitor.beam, index);
                    answer(first + index, found, cost.share(index, part.len()));
                }
            } else {
                for (index, query) in part.iter().enumerate() {
                    let mut cost = SearchCost::default();
                    let found = self.nearest_one(kernels, exact, query, memory, &mut cost);
                    answer(first + index, found, cost);
                }
            }
            first += part.len();
        }
    }

    /// Whether `counts` is true of any triangle on each line.
    pub(super) fn any_of(
        &self,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        memory: &mut SearchMemory,
        counts: impl FnMut(usize, u32, &TriangleHit) -> bool,
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
        mut counts: impl FnMut(usize, u32, &TriangleHit) -> bool,
        mut answer: impl FnMut(usize, bool, SearchCost),
    ) {
        let mut first = 0;
        for part in queries.chunks(BEAM) {
            let beam = self.beam(part, Meeting::End);
            if let Some(beam) = beam.or_else(|| self.beam(part, Meeting::Start)) {
                let take = BeamAny {
                    exact,
                    queries: part,
                    met: [false; BEAM],
                    counts: |index, triangle, hit: &TriangleHit| {
                        counts(first + index, triangle, hit)
                    },
                };
                let mut visitor = self.beam_leaves(beam, take);
                let cost = self.walk_beam(kernels, memory, &mut visitor);
                let met = visitor.take.met;
                for (index, &met) in met.iter().enumerate().take(part.len()) {
                    answer(first + index, met, cost.share(index, part.len()));
                }
            } else {
                for (index, query) in part.iter().enumerate() {
                    let mut cost = SearchCost::default();
                    let met = self.any_one(kernels, exact, query, memory, &mut cost, |t, hit| {
                        counts(first + index, t, hit)
                    });
                    answer(first + index, met, cost);
                }
            }
            first += part.len();
        }
    }

    /// The beam of lines that meet at one end, if there are enough of them.
    fn beam(&self, queries: &[TriangleQuery], meeting: Meeting) -> Option<Beam> {
        if queries.len() < FEWEST {
            return None;
        }
        let line = |query: &TriangleQuery| {
            let Interval { start, end } = query.span;
            let (at, end) = match meeting {
                Meeting::Start => (start, end),
                Meeting::End => (end, start),
            };
            let ray = query.ray;
            (at.is_finite() && !query.span.is_empty()).then_some(BeamLine { ray, at, end })
        };
        let first = line(&queries[0])?;
        let through = first.ray.at(first.at);
        let mut lines = [first; BEAM];
        for (place, query) in lines.iter_mut().zip(queries) {
            *place = line(query)?;
        }
        self.tree.beam(through, &lines[..queries.len()])
    }

    fn beam_leaves<T: Take>(&self, beam: Beam, take: T) -> BeamLeaves<'_, T> {
        BeamLeaves {
            beam,
            items: self.tree.items(),
            packed: &self.packed,
            tested: 0,
            triangles: BeamTriangles::default(),
            take,
        }
    }

    #[inline(always)]
    fn walk_beam<T: Take>(
        &self,
        kernels: impl Kernels,
        memory: &mut SearchMemory,
        visitor: &mut BeamLeaves<'_, T>,
    ) -> SearchCost {
        let mut cost = SearchCost::default();
        let stack = memory.beam_stack(&self.tree);
        self.tree.walk_beam(kernels, stack, &mut cost.walk, visitor);
        cost.walk.items += visitor.tested;
        cost
    }

    #[inline(always)]
    fn any_one(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        query: &TriangleQuery,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut counts: impl FnMut(u32, &TriangleHit) -> bool,
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
                if query.counts(hit.t) && !query.leaves(triangle, &exact) && counts(triangle, hit) {
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

    #[inline(always)]
    fn nearest_one(
        &self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        query: &TriangleQuery,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
    ) -> Option<NearestTriangle> {
        if query.span.is_empty() {
            return None;
        }
        let local = self.tree.line(&query.ray)?;
        let reach = [local.lower(query.span.start), local.upper(query.span.end)];
        let leaves = Leaves::new(self, &local, reach[0]);
        let mut visitor = Nearest::new(leaves, exact, query, &local);
        let (walk, stack) = (&mut cost.walk, memory.stack(&self.tree));
        // The search never breaks off.
        let _ = self
            .tree
            .walk(kernels, &local, reach, stack, walk, &mut visitor);
        walk.items += visitor.tested();
        visitor.finish()
    }
}
