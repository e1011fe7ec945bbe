//! From front to back, leaving out what cannot matter any more.

use std::ops::{ControlFlow, Range};

use octray_kernels::{Kernels, Lanes, Scalar, Vector, dispatch};
use octray_math::{Interval, Ray};

use super::frame::LocalLine;
use super::{WideTree, link};

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
#[derive(Clone, Copy, Debug, Default)]
pub struct Pending {
    entry: f32,
    link: u32,
}

/// Long enough for all but contrived trees.
const USUAL_STACK: usize = 128;

/// What looks at the items of leaves.
pub trait LeafVisitor {
    /// Looks at the items that stand at `places` of [`WideTree::items`]; returns the local parameter
    /// (see [`LocalLine`]) beyond which nothing matters any more, `s_max` or less.
    fn leaf(
        &mut self,
        kernels: impl Kernels,
        places: Range<usize>,
        s_max: f32,
    ) -> ControlFlow<(), f32>;
}

/// Shows the items of leaves one by one.
struct Each<'a, F> {
    items: &'a [u32],
    line: &'a LocalLine,
    end: f64,
    shown: u64,
    visit: F,
}

impl<F: FnMut(u32, f64) -> ControlFlow<(), f64>> LeafVisitor for Each<'_, F> {
    #[inline(always)]
    fn leaf(
        &mut self,
        _kernels: impl Kernels,
        places: Range<usize>,
        s_max: f32,
    ) -> ControlFlow<(), f32> {
        let before = self.end;
        for &item in &self.items[places] {
            self.shown += 1;
            let found = (self.visit)(item, self.end)?;
            if found < self.end {
                self.end = found;
            }
        }
        ControlFlow::Continue(if self.end < before {
            self.line.upper(self.end)
        } else {
            s_max
        })
    }
}

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
        let _ = self.each(ray, span, cost, |item, end| {
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
        self.each(ray, span, cost, |item, end| {
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
        let _ = self.each(ray, span, cost, |item, end| {
            visit(item);
            ControlFlow::Continue(end)
        });
    }

    #[inline]
    fn each(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        visit: impl FnMut(u32, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        if span.is_empty() {
            return ControlFlow::Continue(());
        }
        let Some(line) = self.line(ray) else {
            return ControlFlow::Continue(());
        };
        let mut each = Each {
            items: &self.items,
            line: &line,
            end: span.end,
            shown: 0,
            visit,
        };
        let (mut usual, mut deep);
        let stack: &mut [Pending] = if self.stack_length() <= USUAL_STACK {
            usual = [Pending::default(); USUAL_STACK];
            &mut usual
        } else {
            deep = vec![Pending::default(); self.stack_length()];
            &mut deep
        };
        let reach = [line.lower(span.start), line.upper(span.end)];
        let flow = match self.lanes {
            Lanes::Scalar => self.walk(Scalar, &line, reach, stack, cost, &mut each),
            Lanes::Vector(level) => dispatch!(level, simd =>
                self.walk(Vector(simd), &line, reach, stack, cost, &mut each)),
        };
        cost.items += each.shown;
        flow
    }

    /// The line in the tree's coordinates; `None` for one that does not meet the tree.
    #[must_use]
    #[inline(always)]
    pub fn line(&self, ray: &Ray) -> Option<LocalLine> {
        if self.nodes.is_empty() {
            return None;
        }
        self.frame.ray(ray)
    }

    /// Parts of the tree that wait at a time, at most.
    #[must_use]
    #[inline]
    pub const fn stack_length(&self) -> usize {
        // A node leaves at most seven parts behind when the walk goes on into the eighth.
        7 * self.stats.depth as usize + 8
    }

    /// Walks the line from leaf to leaf, about front to back, between two local parameters. To be
    /// used inside `dispatch!` on [`WideTree::lanes`]. Counts nodes; items are the visitor's.
    ///
    /// `stack` is working memory, at least [`WideTree::stack_length`] long.
    #[inline(always)]
    pub fn walk(
        &self,
        kernels: impl Kernels,
        line: &LocalLine,
        [s_min, mut s_max]: [f32; 2],
        stack: &mut [Pending],
        cost: &mut WalkCost,
        visitor: &mut impl LeafVisitor,
    ) -> ControlFlow<()> {
        let mut entries = [0.0f32; 8];
        let mut height = 0;
        let mut part = link::node(0);
        loop {
            if let Some(places) = link::items(part) {
                s_max = visitor.leaf(kernels, places, s_max)?;
            } else {
                cost.nodes += 1;
                let node = &self.nodes[part as usize];
                let mut mask = kernels.test(&line.slab, &node.boxes, s_min, s_max, &mut entries);
                if mask != 0 {
                    let first = mask.trailing_zeros() as usize & 7;
                    mask &= mask - 1;
                    part = node.links[first];
                    if mask == 0 {
                        continue;
                    }
                    // The nearest is next; the others wait, the nearer ones higher up.
                    let mut nearest = Pending {
                        entry: entries[first],
                        link: part,
                    };
                    let second = mask.trailing_zeros() as usize & 7;
                    mask &= mask - 1;
                    let mut other = Pending {
                        entry: entries[second],
                        link: node.links[second],
                    };
                    if other.entry < nearest.entry {
                        std::mem::swap(&mut other, &mut nearest);
                    }
                    stack[height] = other;
                    let bottom = height;
                    height += 1;
                    while mask != 0 {
                        let lane = mask.trailing_zeros() as usize & 7;
                        mask &= mask - 1;
                        let mut other = Pending {
                            entry: entries[lane],
                            link: node.links[lane],
                        };
                        if other.entry < nearest.entry {
                            std::mem::swap(&mut other, &mut nearest);
                        }
                        let mut place = height;
                        while place > bottom && stack[place - 1].entry < other.entry {
                            stack[place] = stack[place - 1];
                            place -= 1;
                        }
                        stack[place] = other;
                        height += 1;
                    }
                    part = nearest.link;
                    continue;
                }
            }
            loop {
                if height == 0 {
                    return ControlFlow::Continue(());
                }
                height -= 1;
                if stack[height].entry <= s_max {
                    break;
                }
            }
            part = stack[height].link;
        }
    }
}
