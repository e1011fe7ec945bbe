//! Whether a line meets any triangle: the walk ends at the first that it crosses beyond doubt.
//!
//! Whether that one counts is decided after the walks of all lines of a slice, like everything that is not
//! beyond doubt. It nearly always does; where it does not, the line is searched again, triangle by triangle.

use std::ops::{ControlFlow, Range};

use octray_kernels::beam::GROUP;
use octray_kernels::{Candidates, Kernels};
use octray_tree::wide_tree::{BEAM, Beam};
use octray_tree::{LeafVisitor, LocalLine};

use super::beam::{Candidate, Take};
use super::divide::Triangles;
use super::nearest::TriangleQuery;
use super::settle::Undecided;
use super::wide::Leaves;

/// Triangles that may be undecided at a time.
const UNDECIDED: usize = 1024;

/// Ends at the first triangle on a line.
pub(super) struct FirstMet<'a> {
    leaves: Leaves<'a>,
    exact: Triangles<'a>,
    query: &'a TriangleQuery,
    index: u32,
    /// Between these local parameters a crossing counts for certain.
    inside: [f32; 2],
    undecided: &'a mut Vec<Undecided>,
}

impl<'a> FirstMet<'a> {
    #[inline(always)]
    pub(super) fn new(
        leaves: Leaves<'a>,
        exact: Triangles<'a>,
        (index, query): (usize, &'a TriangleQuery),
        local: &LocalLine,
        undecided: &'a mut Vec<Undecided>,
    ) -> Self {
        Self {
            leaves,
            exact,
            query,
            index: index as u32,
            inside: [local.upper(query.span.start), local.lower(query.span.end)],
            undecided,
        }
    }

    pub(super) const fn tested(&self) -> u64 {
        self.leaves.tested
    }
}

impl LeafVisitor for FirstMet<'_> {
    #[inline(always)]
    fn leaf(
        &mut self,
        kernels: impl Kernels,
        places: Range<usize>,
        s_max: f32,
    ) -> ControlFlow<(), f32> {
        let mut found = Candidates::NONE;
        let items = self.leaves.test(kernels, places, s_max, &mut found);
        while found.possible != 0 {
            let lane = found.possible.trailing_zeros() as usize & 7;
            found.possible &= found.possible - 1;
            let triangle = items[lane];
            if self.query.departed == Some(triangle) {
                continue;
            }
            self.undecided.push(Undecided {
                query: self.index,
                triangle,
            });
            let certain = found.certain >> lane & 1 != 0
                && found.nearest[lane] > self.inside[0]
                && found.farthest[lane] < self.inside[1]
                && !self.query.leaves(triangle, &self.exact);
            if certain || self.undecided.len() >= UNDECIDED {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(s_max)
    }
}

/// The same for the lines of a beam.
pub(super) struct BeamAny<'a> {
    pub(super) exact: Triangles<'a>,
    pub(super) queries: &'a [TriangleQuery],
    pub(super) undecided: &'a mut Vec<Undecided>,
    pub(super) is_early: &'a mut [bool; BEAM],
}

impl Take for BeamAny<'_> {
    #[inline]
    fn take(&mut self, beam: &Beam, line: usize, candidate: Candidate) -> f32 {
        let query = &self.queries[line];
        let triangle = candidate.triangle;
        if query.departed == Some(triangle) {
            return f32::INFINITY;
        }
        self.undecided.push(Undecided {
            query: line as u32,
            triangle,
        });
        let margin = 2.0 * beam.frame().error();
        let end = beam.groups[line / GROUP].ends[line % GROUP];
        let certain = candidate.is_certain
            && candidate.nearest > margin
            && candidate.farthest + margin < end
            && !query.leaves(triangle, &self.exact);
        if certain || self.undecided.len() >= UNDECIDED {
            self.is_early[line] = true;
            return f32::NEG_INFINITY;
        }
        f32::INFINITY
    }
}
