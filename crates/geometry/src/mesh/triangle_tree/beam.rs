//! Lines that travel together: their nearest triangles, or whether any is met.

use std::ops::Range;

use octray_kernels::beam::GROUP;
use octray_kernels::triangles::WINDOW;
use octray_kernels::{BeamTriangles, Candidates, Kernels, RayCandidates};
use octray_tree::wide_tree::{BEAM, Beam, BeamVisitor, GROUPS, PendingBeam};

use super::TriangleRay;
use super::divide::Triangles;
use super::nearest::{NearestTriangle, TriangleQuery};
use super::packed::PackedTriangles;
use super::search::SearchCost;
use super::settle::{Settlement, Undecided};

/// What is done with a line of a beam and a triangle that it may cross.
pub(super) trait Take {
    /// Returns the depth beyond which nothing matters on the line any more; infinity if that is as
    /// before.
    fn take(&mut self, beam: &Beam, line: usize, candidate: Candidate) -> f32;
}

/// A triangle that a line may cross, and bounds of the depth.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Candidate {
    pub(super) triangle: u32,
    pub(super) nearest: f32,
    pub(super) farthest: f32,
    pub(super) is_certain: bool,
}

/// Up to so many lines of a group are tested one by one.
const FEW: u32 = 3;

/// Tests the triangles of leaves.
pub(super) struct BeamLeaves<'a, T> {
    pub(super) beam: &'a mut Beam,
    pub(super) items: &'a [u32],
    pub(super) packed: &'a PackedTriangles,
    pub(super) tested: u64,
    /// Those of the leaf at hand.
    pub(super) triangles: &'a mut BeamTriangles,
    pub(super) take: T,
}

impl<T: Take> BeamVisitor for BeamLeaves<'_, T> {
    #[inline(always)]
    fn beam(&self) -> &Beam {
        self.beam
    }

    #[inline(always)]
    fn leaf(&mut self, kernels: impl Kernels, places: Range<usize>, lines: [u32; GROUPS]) {
        let count = places.len();
        self.tested += count as u64;
        let rows = self.packed.leaf(&places);
        let items = &self.items[places];
        let (mut is_prepared, mut some_shorter) = (false, false);
        for (index, lines) in lines.into_iter().enumerate() {
            if lines == 0 {
                continue;
            }
            let is_shorter = if lines.count_ones() <= FEW {
                self.few(kernels, rows, items, index, lines)
            } else {
                if !is_prepared {
                    kernels.prepare(self.beam.frame(), rows, count, self.triangles);
                    is_prepared = true;
                }
                self.many(kernels, items, index)
            };
            if is_shorter {
                self.beam.groups[index].shorten();
                some_shorter = true;
            }
        }
        if some_shorter {
            self.beam.shorten();
        }
    }
}

impl<T: Take> BeamLeaves<'_, T> {
    /// Tests some lines of a group one by one, each against all triangles of a leaf; returns whether
    /// ends have changed.
    #[inline(always)]
    fn few(
        &mut self,
        kernels: impl Kernels,
        rows: &[f32; WINDOW],
        items: &[u32],
        index: usize,
        mut lines: u32,
    ) -> bool {
        let margin = 2.0 * self.beam.frame().error();
        let mut is_shorter = false;
        let mut found = Candidates::NONE;
        while lines != 0 {
            let place = lines.trailing_zeros() as usize & (GROUP - 1);
            lines &= lines - 1;
            let group = &self.beam.groups[index];
            let line = self
                .beam
                .frame()
                .line([group.slopes[0][place], group.slopes[1][place]]);
            let end = group.ends[place];
            kernels.test_triangles(&line, rows, items.len(), -margin, end, &mut found);
            while found.possible != 0 {
                let lane = found.possible.trailing_zeros() as usize & 7;
                found.possible &= found.possible - 1;
                let candidate = Candidate {
                    triangle: items[lane],
                    nearest: found.nearest[lane],
                    farthest: found.farthest[lane],
                    is_certain: found.certain >> lane & 1 != 0,
                };
                is_shorter |= self.shown(index, place, candidate);
            }
        }
        is_shorter
    }

    /// Tests all lines of a group at once against the triangles of a leaf one by one; returns whether
    /// ends have changed.
    #[inline(always)]
    fn many(&mut self, kernels: impl Kernels, items: &[u32], index: usize) -> bool {
        let mut errors = [0.0; 8];
        let mut found = RayCandidates::default();
        let (frame, group) = (self.beam.frame(), &self.beam.groups[index]);
        let mut mask = kernels.cull(frame, group, self.triangles, &mut errors);
        mask &= (1 << items.len()) - 1;
        let mut is_shorter = false;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            let (frame, group) = (self.beam.frame(), &self.beam.groups[index]);
            let error = errors[lane];
            kernels.test_rays(frame, group, self.triangles, lane, error, &mut found);
            while found.possible != 0 {
                let place = found.possible.trailing_zeros() as usize & (GROUP - 1);
                found.possible &= found.possible - 1;
                let candidate = Candidate {
                    triangle: items[lane],
                    nearest: found.nearest[place],
                    farthest: found.farthest[place],
                    is_certain: found.certain >> place & 1 != 0,
                };
                is_shorter |= self.shown(index, place, candidate);
            }
        }
        is_shorter
    }

    /// Hands on what was found; returns whether the line's end has changed.
    #[inline(always)]
    fn shown(&mut self, index: usize, place: usize, candidate: Candidate) -> bool {
        let end = self.take.take(self.beam, index * GROUP + place, candidate);
        let known = &mut self.beam.groups[index].ends[place];
        let is_shorter = end < *known;
        if is_shorter {
            *known = end;
        }
        is_shorter
    }
}

/// Triangles that may wait per line.
const WAITING: usize = 4;

/// What is known of the lines of a beam.
#[derive(Clone, Debug)]
pub(super) struct Known {
    waiting: [[Candidate; WAITING]; BEAM],
    lengths: [u8; BEAM],
}

/// Whether beams have paid lately: where many triangles stand in the space of one, its lines are faster
/// alone.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coherence {
    /// Runs of lines that are still to walk alone, and how many that was last time.
    alone: u32,
    last: u32,
}

/// What a line of a beam may cost, in nodes; four triangles cost about as much as two.
const WORTH: u64 = 3;
/// Runs that walk alone before a beam is tried again, at most.
const LONGEST: u32 = 16;

impl Coherence {
    /// Whether to try a beam now.
    pub(super) const fn allows(&mut self) -> bool {
        let allows = self.alone == 0;
        self.alone = self.alone.saturating_sub(1);
        allows
    }

    /// What a beam of so many lines has cost.
    pub(super) fn learn(&mut self, cost: &SearchCost, lines: usize) {
        let is_worth = cost.walk.nodes + cost.walk.items / 2 <= WORTH * lines as u64;
        self.last = if is_worth {
            0
        } else {
            (2 * self.last).clamp(1, LONGEST)
        };
        self.alone = self.last;
    }
}

/// Working memory of beams, kept from one to the next.
#[derive(Clone, Debug)]
pub(super) struct BeamMemory {
    pub(super) beam: Beam,
    pub(super) stack: Vec<PendingBeam>,
    pub(super) triangles: BeamTriangles,
    pub(super) known: Known,
    pub(super) settlement: Settlement,
    /// Of lines that walk by themselves.
    pub(super) costs: [SearchCost; BEAM],
}

impl Default for BeamMemory {
    fn default() -> Self {
        Self {
            beam: Beam::default(),
            stack: Vec::new(),
            triangles: BeamTriangles::default(),
            known: Known {
                waiting: [[Candidate::default(); WAITING]; BEAM],
                lengths: [0; BEAM],
            },
            settlement: Settlement::default(),
            costs: [SearchCost::default(); BEAM],
        }
    }
}

/// Gathers the triangles of each line; see [`super::nearest`].
pub(super) struct BeamNearest<'a> {
    exact: Triangles<'a>,
    queries: &'a [TriangleQuery],
    known: &'a mut Known,
    best: &'a mut [Option<NearestTriangle>; BEAM],
}

impl<'a> BeamNearest<'a> {
    pub(super) fn new(
        exact: Triangles<'a>,
        queries: &'a [TriangleQuery],
        known: &'a mut Known,
        best: &'a mut [Option<NearestTriangle>; BEAM],
    ) -> Self {
        known.lengths.fill(0);
        Self {
            exact,
            queries,
            known,
            best,
        }
    }

    /// Tests what waits and has not been overtaken; returns the new end, infinity if it is as before.
    #[inline]
    fn decide(&mut self, beam: &Beam, line: usize) -> f32 {
        let length = self.known.lengths[line] as usize;
        if length == 0 {
            return f32::INFINITY;
        }
        let query = &self.queries[line];
        let test = TriangleRay::new(&query.ray);
        let end = beam.groups[line / GROUP].ends[line % GROUP];
        for candidate in &self.known.waiting[line][..length] {
            if candidate.nearest > end {
                continue;
            }
            let corners = self.exact.corners(candidate.triangle);
            let Some(hit) = test.intersect(corners) else {
                continue;
            };
            let found = NearestTriangle {
                t: hit.t,
                triangle: candidate.triangle,
                entering: hit.entering,
            };
            if query.counts(hit.t)
                && found.is_before(self.best[line].as_ref())
                && !query.leaves(candidate.triangle, &self.exact)
            {
                self.best[line] = Some(found);
            }
        }
        self.known.lengths[line] = 0;
        self.best[line].map_or(f32::INFINITY, |best| beam.depth(line, best.t))
    }
}

impl Known {
    /// Which exact tests are left, once the walk is over.
    #[inline(always)]
    pub(super) fn finish(&self, beam: &Beam, lines: usize, undecided: &mut Vec<Undecided>) {
        for line in 0..lines.min(BEAM) {
            let end = beam.groups[line / GROUP].ends[line % GROUP];
            for candidate in &self.waiting[line][..self.lengths[line] as usize % (WAITING + 1)] {
                if candidate.nearest <= end {
                    undecided.push(Undecided {
                        query: line as u32,
                        triangle: candidate.triangle,
                    });
                }
            }
        }
    }
}

impl Take for BeamNearest<'_> {
    #[inline]
    fn take(&mut self, beam: &Beam, line: usize, candidate: Candidate) -> f32 {
        let query = &self.queries[line];
        if query.departed == Some(candidate.triangle) {
            return f32::INFINITY;
        }
        let mut end = f32::INFINITY;
        if self.known.lengths[line] as usize == WAITING {
            // Most have been overtaken.
            let known = beam.groups[line / GROUP].ends[line % GROUP];
            let waiting = &mut self.known.waiting[line];
            let mut kept = 0;
            for i in 0..WAITING {
                if waiting[i].nearest <= known {
                    waiting[kept] = waiting[i];
                    kept += 1;
                }
            }
            self.known.lengths[line] = kept as u8;
            if kept == WAITING {
                end = self.decide(beam, line);
            }
        }
        let length = &mut self.known.lengths[line];
        self.known.waiting[line][*length as usize & (WAITING - 1)] = candidate;
        *length += 1;
        if candidate.is_certain && candidate.nearest > beam.frame().error() {
            if query.leaves(candidate.triangle, &self.exact) {
                *length -= 1;
            } else {
                end = end.min(candidate.farthest);
            }
        }
        end
    }
}
