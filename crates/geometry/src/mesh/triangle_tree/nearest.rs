//! The nearest triangle on a line, decided in `f64` only where `f32` leaves a choice.
//!
//! The kernel says of some triangles that they are crossed beyond doubt, and bounds the parameter.
//! Such a bound ends the search like an exact parameter does, so triangles wait for the exact test
//! until the walk is over: by then most of them have been overtaken.

use std::ops::{ControlFlow, Range};

use octray_kernels::{Candidates, Kernels};
use octray_math::{Interval, Ray};
use octray_tree::{LeafVisitor, LocalLine};

use super::divide::Triangles;
use super::settle::Undecided;
use super::wide::Leaves;
use super::{TriangleRay, are_coplanar};

/// A line whose nearest triangle is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleQuery {
    /// The line.
    pub ray: Ray,
    /// What counts of it: parameters after the start and up to the end, which counts.
    pub span: Interval,
    /// The triangle that the line leaves: those in its plane do not count.
    pub departed: Option<u32>,
}

impl TriangleQuery {
    /// Whether a parameter counts.
    #[inline]
    pub(super) fn counts(&self, t: f64) -> bool {
        t > self.span.start && t <= self.span.end
    }

    /// Whether the line leaves the triangle's plane.
    #[inline]
    pub(super) fn leaves(&self, triangle: u32, exact: &Triangles<'_>) -> bool {
        let leaves =
            |from| from == triangle || are_coplanar(exact.corners(from), exact.corners(triangle));
        self.departed.is_some_and(leaves)
    }
}

/// The nearest triangle on a line, of several the lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestTriangle {
    /// In units of the ray's direction.
    pub t: f64,
    /// Its index.
    pub triangle: u32,
    /// Whether the line comes from the side on which the corners run counter-clockwise.
    pub entering: bool,
}

impl NearestTriangle {
    /// Whether it comes before another, if there is one.
    #[inline]
    pub(super) fn is_before(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|o| self.t < o.t || (self.t == o.t && self.triangle < o.triangle))
    }
}

/// Triangles that may wait.
const WAITING: usize = 8;

/// A triangle that waits for the exact test, and a lower bound of its local parameter.
#[derive(Clone, Copy, Debug, Default)]
struct Waiting {
    nearest: f32,
    triangle: u32,
}

/// Gathers triangles along one line.
pub(super) struct Nearest<'a> {
    leaves: Leaves<'a>,
    exact: Triangles<'a>,
    query: &'a TriangleQuery,
    local: &'a LocalLine,
    /// The local parameter from which on a crossing comes after the start for certain.
    s_after: f32,
    waiting: [Waiting; WAITING],
    length: usize,
    best: Option<NearestTriangle>,
    s_max: f32,
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    pub(super) fn new(
        leaves: Leaves<'a>,
        exact: Triangles<'a>,
        query: &'a TriangleQuery,
        local: &'a LocalLine,
    ) -> Self {
        Self {
            leaves,
            exact,
            query,
            local,
            s_after: local.upper(query.span.start),
            waiting: [Waiting::default(); WAITING],
            length: 0,
            best: None,
            s_max: f32::INFINITY,
        }
    }

    pub(super) const fn tested(&self) -> u64 {
        self.leaves.tested
    }

    /// What is known, and which exact tests are left.
    #[inline(always)]
    pub(super) fn finish(
        &self,
        index: usize,
        undecided: &mut Vec<Undecided>,
    ) -> Option<NearestTriangle> {
        for waiting in &self.waiting[..self.length] {
            if waiting.nearest <= self.s_max {
                undecided.push(Undecided {
                    query: index as u32,
                    triangle: waiting.triangle,
                });
            }
        }
        self.best
    }

    /// Tests those that wait and have not been overtaken.
    #[inline]
    fn decide(&mut self) {
        if self.length == 0 {
            return;
        }
        let line = TriangleRay::new(&self.query.ray);
        for waiting in &self.waiting[..self.length] {
            if waiting.nearest > self.s_max {
                continue;
            }
            let corners = self.exact.corners(waiting.triangle);
            let Some(hit) = line.intersect(corners) else {
                continue;
            };
            let found = NearestTriangle {
                t: hit.t,
                triangle: waiting.triangle,
                entering: hit.entering,
            };
            if self.query.counts(hit.t)
                && found.is_before(self.best.as_ref())
                && !self.query.leaves(waiting.triangle, &self.exact)
            {
                self.best = Some(found);
                self.s_max = self.s_max.min(self.local.upper(hit.t));
            }
        }
        self.length = 0;
    }
}

impl LeafVisitor for Nearest<'_> {
    #[inline(always)]
    fn leaf(
        &mut self,
        kernels: impl Kernels,
        places: Range<usize>,
        s_max: f32,
    ) -> ControlFlow<(), f32> {
        self.s_max = s_max;
        let mut found = Candidates::NONE;
        let items = self.leaves.test(kernels, places, s_max, &mut found);
        while found.possible != 0 {
            let lane = found.possible.trailing_zeros() as usize & 7;
            found.possible &= found.possible - 1;
            let (triangle, nearest) = (items[lane], found.nearest[lane]);
            if nearest > self.s_max || self.query.departed == Some(triangle) {
                continue;
            }
            if self.length == WAITING {
                self.decide();
            }
            self.waiting[self.length & (WAITING - 1)] = Waiting { nearest, triangle };
            self.length += 1;
            if found.certain >> lane & 1 != 0 && nearest > self.s_after {
                if self.query.leaves(triangle, &self.exact) {
                    self.length -= 1;
                } else {
                    self.s_max = self.s_max.min(found.farthest[lane]);
                }
            }
        }
        ControlFlow::Continue(self.s_max)
    }
}
