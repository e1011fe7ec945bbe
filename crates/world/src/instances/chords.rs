//! Where a line enters and leaves copies, ranked together with the solids.

use octray_geometry::FaceId;
use octray_math::Interval;
use octray_scene::ObjectId;

use super::regions::Standing;
use crate::line::Line;
use crate::solids::{Passage, Scratch, Solids};
use crate::{Counters, Departure, World};

/// What the ranks of passages mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranks<'a> {
    pub(crate) solids: &'a Solids,
    /// Where copies take part: what takes part, by rank. Else the ranks are the solids' own.
    pub(crate) standings: &'a [Standing],
}

impl Ranks<'_> {
    pub(crate) fn object(&self, rank: u32) -> ObjectId {
        match self.standings.get(rank as usize) {
            Some(standing) => standing.object,
            None => self.solids.object_of(rank),
        }
    }

    /// Which copy, 0 for none.
    pub(crate) fn instance(&self, rank: u32) -> u32 {
        let standing = self.standings.get(rank as usize);
        standing.map_or(0, |standing| standing.instance)
    }

    pub(crate) fn priority(&self, rank: u32) -> i32 {
        match self.standings.get(rank as usize) {
            Some(standing) => standing.priority,
            None => self.solids.priority_of(rank),
        }
    }
}

impl World {
    /// Adds the passages of the line into and out of copies to those of solids, whose ranks, with
    /// those in `held`, become indices into `standings`. Where no copy is met, that stays empty and
    /// the ranks as they are.
    pub(crate) fn add_copy_passages(
        &self,
        line: &Line,
        passages: &mut Vec<Passage>,
        held: &mut [u32],
        standings: &mut Vec<Standing>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        standings.clear();
        if !self.instances.have_insides {
            return;
        }
        let mut of_copies: Vec<(Standing, Passage)> = Vec::new();
        let mut memory = self.instances.take_memory(scratch);
        let mut own = Vec::new();
        let span = Interval::new(line.origin, line.end);
        self.instances
            .visit(line, span, counters, |copy, counters| {
                let Some(inner) = copy.line(line) else {
                    return f64::INFINITY;
                };
                let scratch = &mut memory[copy.copies.prototype];
                let solids = &copy.prototype.solids;
                solids.passages(&inner, &mut own, scratch, counters);
                of_copies.extend(own.iter().filter_map(|passage| {
                    let s = inner.outer(passage.s);
                    let is_behind = s <= line.origin && inner.departure == Departure::NONE;
                    (s < line.end && !is_behind).then(|| {
                        let face = copy.face(passage.face);
                        let standing = Standing::of_copy(copy, passage.rank);
                        (
                            standing,
                            Passage {
                                s,
                                face,
                                ..*passage
                            },
                        )
                    })
                }));
                f64::INFINITY
            });
        scratch.prototypes = memory;
        if of_copies.is_empty() {
            return;
        }
        let of_rank = |rank: u32| Standing::of_object(self, self.solids.object_of(rank));
        let solids = passages.iter().map(|p| p.rank).chain(held.iter().copied());
        standings.extend(solids.map(of_rank));
        standings.extend(of_copies.iter().map(|(standing, _)| *standing));
        standings.sort_unstable_by(Standing::rank);
        standings.dedup();
        // Every one is among them.
        let rank = |standing: &Standing| standings.partition_point(|s| s.rank(standing).is_lt());
        for passage in passages.iter_mut() {
            passage.rank = rank(&of_rank(passage.rank)) as u32;
        }
        for held in held.iter_mut() {
            *held = rank(&of_rank(*held)) as u32;
        }
        passages.extend(of_copies.iter().map(|(standing, passage)| Passage {
            rank: rank(standing) as u32,
            ..*passage
        }));
        passages.sort_by(|a, b| a.s.total_cmp(&b.s).then(a.rank.cmp(&b.rank)));
    }

    /// How many faces of sheets among the copies count on the line.
    pub(crate) fn count_copied_sheets(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> u64 {
        let mut found: Vec<(u64, u32, FaceId)> = Vec::new();
        self.visit_copies(line, scratch, counters, |boundary| {
            let copy = self.instances.copy(boundary.instance);
            let is_sheet = copy.is_some_and(|copy| {
                let own = copy.own_face(boundary.face);
                !copy.prototype.solids.has(own)
            });
            if is_sheet && !self.starts_on(line, boundary) {
                found.push((boundary.s.to_bits(), boundary.instance, boundary.face));
            }
        });
        found.sort_unstable();
        found.dedup();
        found.len() as u64
    }
}
