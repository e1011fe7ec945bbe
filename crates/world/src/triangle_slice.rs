//! Slices of rays against the triangles of sheets, which lines can search together.
//!
//! The triangles come first: they shorten the lines for the solids. The answer is the same either
//! way, the nearest by (parameter, face).

use octray_geometry::FaceId;
use octray_geometry::mesh::TriangleQuery;
use octray_kernels::{Lanes, dispatch};
use octray_math::Interval;

use crate::line::Line;
use crate::sheets::SheetHit;
use crate::slice::Account;
use crate::solids::{Interface, Scratch};
use crate::{Hit, RayQuery, World};

/// Rays whose lines are in memory at a time.
const PART: usize = 64;

/// Working memory of slices that search triangles.
#[derive(Debug, Default)]
pub(crate) struct TriangleSlice {
    /// `None` for a query that is no ray.
    lines: Vec<Option<Line>>,
    queries: Vec<TriangleQuery>,
    nearest: Vec<Option<SheetHit>>,
    met: Vec<bool>,
}

impl TriangleSlice {
    /// The lines of some queries, with the vector instructions of this machine: rounding to an integer is one
    /// of them.
    fn fill(&mut self, world: &World, queries: &[RayQuery]) {
        match world.sheets.triangles().lanes() {
            Lanes::Scalar => self.fill_with(world, queries),
            Lanes::Vector(level) => dispatch!(level, _simd => self.fill_with(world, queries)),
        }
    }

    #[inline(always)]
    fn fill_with(&mut self, world: &World, queries: &[RayQuery]) {
        self.lines.clear();
        self.queries.clear();
        for query in queries {
            // Each by itself: what is merged first is copied once more.
            match world.line(query, false) {
                Some(line) => {
                    self.queries.push(world.sheets.query(&line, f64::INFINITY));
                    self.lines.push(Some(line));
                }
                None => {
                    self.queries.push(TriangleQuery {
                        ray: query.ray,
                        span: Interval::EMPTY,
                        departed: None,
                    });
                    self.lines.push(None);
                }
            }
        }
    }
}

impl World {
    /// Whether lines search triangles together.
    pub(crate) fn has_triangle_slices(&self) -> bool {
        self.sheets.triangles().has_slices() && self.instances.is_empty()
    }

    /// The nearest surface on each ray.
    pub(crate) fn closest_by_triangles(
        &self,
        queries: &[RayQuery],
        scratch: &mut Scratch,
        account: &mut Account<'_>,
        hits: &mut Vec<Hit>,
    ) {
        let mut slice = std::mem::take(&mut scratch.triangle_slice);
        let triangles = self.sheets.triangles();
        scratch.triangles.begin_slice();
        let mut first = 0;
        for part in queries.chunks(PART) {
            slice.fill(self, part);
            let TriangleSlice {
                lines,
                queries,
                nearest,
                ..
            } = &mut slice;
            nearest.clear();
            nearest.resize(part.len(), None);
            triangles.nearest(queries, &mut scratch.triangles, |index, found, cost| {
                nearest[index] = found.map(|found| self.sheets.hit(&found));
                let counters = account.of(first + index);
                counters.rays += 1;
                counters.add_search(&cost);
            });
            for (index, line) in lines.iter().enumerate() {
                let Some(line) = line else {
                    hits.push(Hit::MISS);
                    continue;
                };
                let counters = account.of(first + index);
                let sheet = nearest[index].filter(|hit| hit.s < line.end);
                let found = self.with_solids(line, sheet.as_ref(), scratch, counters);
                hits.push(match found {
                    None => Hit::MISS,
                    // The rest of the line by itself.
                    Some(found) if self.starts_on(line, &found) => {
                        self.closest_on_line(line.beyond(found.s), scratch, counters)
                    }
                    Some(found) => found.into_hit(line),
                });
            }
            first += part.len();
        }
        scratch.triangle_slice = slice;
    }

    /// Whether any of the faces that count lies on each ray.
    pub(crate) fn meets_by_triangles(
        &self,
        queries: &[RayQuery],
        counts: &impl Fn(FaceId) -> bool,
        scratch: &mut Scratch,
        account: &mut Account<'_>,
        blocked: &mut Vec<bool>,
    ) {
        let mut slice = std::mem::take(&mut scratch.triangle_slice);
        let triangles = self.sheets.triangles();
        scratch.triangles.begin_slice();
        let mut first = 0;
        for part in queries.chunks(PART) {
            slice.fill(self, part);
            let TriangleSlice {
                lines,
                queries,
                met,
                ..
            } = &mut slice;
            met.clear();
            met.resize(part.len(), false);
            triangles.any_of(
                queries,
                &mut scratch.triangles,
                |index, found| {
                    let found = Interface::of_sheet(&self.sheets.hit(found));
                    lines[index].as_ref().is_some_and(|line| {
                        found.s < line.end && counts(found.face) && !self.starts_on(line, &found)
                    })
                },
                |index, answer, cost| {
                    met[index] = answer;
                    let counters = account.of(first + index);
                    counters.rays += 1;
                    counters.add_search(&cost);
                },
            );
            for (index, line) in lines.iter().enumerate() {
                let is_met = met[index]
                    || line.as_ref().is_some_and(|line| {
                        let counters = account.of(first + index);
                        self.line_meets_solid(line, counts, scratch, counters)
                    });
                blocked.push(is_met);
            }
            first += part.len();
        }
        scratch.triangle_slice = slice;
    }
}
