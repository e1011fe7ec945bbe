//! From front to back, leaving out what cannot matter any more.

use std::ops::ControlFlow;

use octray_kernels::{BoxTest, Lanes, Scalar, Vector, dispatch};
use octray_math::{Interval, Ray};

use super::frame::LocalRay;
use super::{MAX_DEPTH, WideTree, link};

/// What walking costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkCost {
    /// Nodes entered; each is eight boxes tested at once.
    pub nodes: u64,
    /// Items shown to the visitor.
    pub items: u64,
}

impl std::ops::AddAssign for WalkCost {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.items += other.items;
    }
}

/// A part of the tree that is still to be seen, and the parameter before which nothing in it
/// counts.
#[derive(Clone, Copy)]
struct Pending {
    entry: f32,
    link: u32,
}

const NOTHING: Pending = Pending {
    entry: 0.0,
    link: 0,
};
/// A node leaves at most seven parts behind when the walk goes on into the eighth.
const fn stack_for(depth: u32) -> usize {
    7 * depth as usize + 8
}
/// Deep enough for all but contrived trees; a larger stack would have to be cleared for every ray.
const USUAL_DEPTH: u32 = 17;

impl WideTree {
    /// Shows `visit` every item that may matter to a search for the smallest `t` in `span`.
    ///
    /// `visit(item, end)` returns the new end of the span: the `t` of what it found if that is
    /// not larger, else `end`. Every item whose box the line meets at or before the final end (or
    /// within rounding of it) is shown, in an order that depends on nothing but tree and ray. Ties
    /// are the visitor's to resolve: nothing is left out for being only as good as the best. An item
    /// that stands in several leaves may be shown more than once, and need be met in one of them.
    pub fn closest(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) {
        // A search that never breaks off has no result of its own.
        let _ = self.walk(ray, span, cost, |item, end| {
            ControlFlow::Continue(visit(item, end))
        });
    }

    /// Whether `visit` is true of any item whose box the line meets in `span`; stops at the first.
    pub fn any(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32) -> bool,
    ) -> bool {
        self.walk(ray, span, cost, |item, end| {
            if visit(item) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(end)
            }
        })
        .is_break()
    }

    /// Shows `visit` every item whose box the line meets in `span`, and perhaps some others; items
    /// in several leaves perhaps more than once.
    pub fn all(&self, ray: &Ray, span: Interval, cost: &mut WalkCost, mut visit: impl FnMut(u32)) {
        let _ = self.walk(ray, span, cost, |item, end| {
            visit(item);
            ControlFlow::Continue(end)
        });
    }

    #[inline]
    fn walk(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        visit: impl FnMut(u32, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        if self.nodes.is_empty() || span.is_empty() {
            return ControlFlow::Continue(());
        }
        let Some(local) = self.frame.ray(ray) else {
            return ControlFlow::Continue(());
        };
        let (mut usual, mut deep);
        let stack: &mut [Pending] = if self.stats.depth <= USUAL_DEPTH {
            usual = [NOTHING; stack_for(USUAL_DEPTH)];
            &mut usual
        } else {
            deep = [NOTHING; stack_for(MAX_DEPTH)];
            &mut deep
        };
        match self.lanes {
            Lanes::Scalar => self.walk_with(Scalar, &local, span, stack, cost, visit),
            Lanes::Vector(level) => dispatch!(level, simd =>
                self.walk_with(Vector(simd), &local, span, stack, cost, visit)),
        }
    }

    #[inline(always)]
    fn walk_with(
        &self,
        test: impl BoxTest,
        ray: &LocalRay,
        span: Interval,
        stack: &mut [Pending],
        cost: &mut WalkCost,
        mut visit: impl FnMut(u32, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let mut end = span.end;
        let s_min = ray.lower(span.start);
        let mut s_max = ray.upper(end);
        let mut entries = [0.0f32; 8];
        stack[0] = Pending {
            entry: f32::NEG_INFINITY,
            link: link::node(0),
        };
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let part = stack[height];
            if part.entry > s_max {
                continue;
            }
            if let Some(items) = link::items(part.link) {
                for &item in &self.items[items] {
                    cost.items += 1;
                    let found = visit(item, end)?;
                    if found < end {
                        end = found;
                        s_max = ray.upper(end);
                    }
                }
                continue;
            }
            cost.nodes += 1;
            let node = &self.nodes[part.link as usize];
            let mut mask = test.test(&ray.slab, &node.boxes, s_min, s_max, &mut entries);
            // The nearest comes to lie on top.
            let bottom = height;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let next = Pending {
                    entry: entries[lane & 7],
                    link: node.links[lane & 7],
                };
                let mut place = height;
                while place > bottom && stack[place - 1].entry < next.entry {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = next;
                height += 1;
            }
        }
        ControlFlow::Continue(())
    }
}
