//! The chords of a ray: every stretch of it that lies in a solid.

use octray_geometry::FaceId;
use octray_math::DVec3;
use octray_scene::ObjectId;

use crate::instances::{Ranks, Standing};
use crate::line::Line;
use crate::solids::{Interface, Passage, Scratch, Solids};
use crate::{Counters, RayQuery, Region, World};

/// Whose chords are listed where solids overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlaps {
    /// Every point belongs to one solid, its region (see [`Region`]): chords never overlap.
    #[default]
    Regions,
    /// A solid takes space only from those of lower explicit priority; else chords may overlap.
    Priorities,
    /// Every solid as if it were alone.
    Objects,
}

/// A stretch of a ray inside one solid, of positive length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// The solid.
    pub object: ObjectId,
    /// Which copy it is, as [`crate::Hit::instance`].
    pub instance: u32,
    /// Where it begins.
    pub enter: ChordEnd,
    /// Where it ends.
    pub exit: ChordEnd,
}

/// One end of a chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordEnd {
    /// In units of the ray's direction. 0 (on a whole line `-inf`) where the ray starts inside,
    /// `inf` where it never leaves.
    pub t: f64,
    /// The face that is crossed there, [`FaceId::NONE`] where the ray starts or never leaves.
    pub face: FaceId,
    /// Which copy the face is of, as [`crate::Hit::instance`].
    pub instance: u32,
    /// Whether the face belongs to another solid, which displaces this one: its outward normal
    /// points into the chord.
    pub displaced: bool,
    /// Whether the ray enters the solid that the face belongs to.
    pub entering: bool,
}

impl Chord {
    /// `exit.t - enter.t`, in units of the ray's direction.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.exit.t - self.enter.t
    }
}

/// A chord that goes on, by its index.
#[derive(Clone, Copy, Debug)]
struct Open {
    rank: u32,
    chord: usize,
}

/// Working memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct ChordScratch {
    passages: Vec<Passage>,
    /// Ranks of the solids that hold the point one is at, increasing.
    held: Vec<u32>,
    /// Of these, the ones whose chords go on there.
    visible: Vec<u32>,
    open: Vec<Open>,
    /// What takes part, by rank, where copies do.
    standings: Vec<Standing>,
}

impl World {
    /// All chords of the ray, ordered by where they begin, then by rank; `chords` is cleared first.
    ///
    /// Over `t > 0`, or with `whole_line` over all `t`. Sheets have no inside and no chords. A ray
    /// that is not finite or has no direction has none either.
    pub fn chords(
        &self,
        query: &RayQuery,
        whole_line: bool,
        overlaps: Overlaps,
        chords: &mut Vec<Chord>,
        counters: &mut Counters,
    ) {
        chords.clear();
        counters.rays += 1;
        if let Some(line) = self.line(query, whole_line) {
            self.scratch
                .with(|scratch| self.add_chords(&line, overlaps, scratch, chords, counters));
        }
    }

    /// Adds the chords of a line to what is there.
    pub(crate) fn add_chords(
        &self,
        line: &Line,
        overlaps: Overlaps,
        scratch: &mut Scratch,
        chords: &mut Vec<Chord>,
        counters: &mut Counters,
    ) {
        let mut own = std::mem::take(&mut scratch.chords);
        let mut line = *line;
        self.ranked_passages(&line, &mut own, scratch, counters);
        while let Some(first) = own.first_boundary(&self.solids)
            && self.starts_on(&line, &first)
        {
            line = line.beyond(first.s);
            self.ranked_passages(&line, &mut own, scratch, counters);
        }
        let standings = std::mem::take(&mut own.standings);
        let ranks = Ranks {
            solids: &self.solids,
            standings: &standings,
        };
        collect(&ranks, &line, overlaps, &mut own, chords);
        own.standings = standings;
        scratch.chords = own;
    }

    /// The passages of the line, and the unbounded solids that hold its start, by rank.
    fn ranked_passages(
        &self,
        line: &Line,
        own: &mut ChordScratch,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        let solids = &self.solids;
        solids.passages(line, &mut own.passages, scratch, counters);
        solids.unbounded_at_start(line, &mut own.held, scratch, counters);
        self.add_copy_passages(
            line,
            &mut own.passages,
            &mut own.held,
            &mut own.standings,
            scratch,
            counters,
        );
    }

    /// How many boundaries the ray crosses: where a solid is entered or left, as
    /// [`Overlaps::Priorities`] has it, and the sheets. Two solids that touch make two.
    pub fn count_crossings(
        &self,
        query: &RayQuery,
        whole_line: bool,
        counters: &mut Counters,
    ) -> u64 {
        counters.rays += 1;
        self.line(query, whole_line).map_or(0, |line| {
            self.scratch
                .with(|scratch| self.count_on_line(&line, scratch, counters))
        })
    }

    pub(crate) fn count_on_line(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> u64 {
        let mut chords = std::mem::take(&mut scratch.counted);
        chords.clear();
        self.add_chords(line, Overlaps::Priorities, scratch, &mut chords, counters);
        let ends = chords.iter().flat_map(|c| [c.enter.face, c.exit.face]);
        let crossed = ends.filter(|face| *face != FaceId::NONE).count() as u64;
        scratch.counted = chords;
        // A triangle may be shown more than once.
        let mut sheets: Vec<FaceId> = Vec::new();
        self.sheets.visit_line(
            line,
            f64::INFINITY,
            &mut scratch.triangles,
            counters,
            |hit| {
                if !self.starts_on(line, &Interface::of_sheet(hit)) {
                    sheets.push(hit.face);
                }
                f64::INFINITY
            },
        );
        sheets.sort_unstable();
        sheets.dedup();
        crossed + sheets.len() as u64 + self.count_copied_sheets(line, scratch, counters)
    }

    /// The unit normal at an end of one of the ray's chords, pointing out of the chord's solid (or
    /// of what is left of it); zero where no face is crossed.
    #[must_use]
    pub fn chord_normal(&self, query: &RayQuery, end: &ChordEnd) -> DVec3 {
        let normal = || {
            let line = self.line(query, false)?;
            let point = self.place.scene_from_world(query.ray.at(end.t));
            let face = (end.instance, end.face, end.entering);
            self.point(&line, face, point)
                .map(|(point, _)| point.normal)
        };
        if end.face == FaceId::NONE {
            return DVec3::ZERO;
        }
        let normal = normal().unwrap_or_default();
        if end.displaced { -normal } else { normal }
    }

    /// The region of each point of the world; on a boundary, that of one of its sides. `regions` is
    /// cleared first. A point that is not finite is outside.
    pub fn regions(&self, points: &[DVec3], regions: &mut Vec<Region>, counters: &mut Counters) {
        regions.clear();
        self.scratch.with(|scratch| {
            let region = |&point: &DVec3| self.region_of(point, scratch, counters);
            regions.extend(points.iter().map(region));
        });
    }

    pub(crate) fn region_of(
        &self,
        point: DVec3,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Region {
        let query = RayQuery::new(octray_math::Ray::new(point, DVec3::X));
        self.line(&query, false).map_or(Region::OUTSIDE, |line| {
            self.region_with_copies(&line, line.origin, scratch, counters)
        })
    }
}

impl ChordScratch {
    /// The first passage, as a boundary without regions.
    fn first_boundary(&self, solids: &Solids) -> Option<Interface> {
        let standings = &self.standings;
        let first = self.passages.first()?;
        Some(Interface {
            s: first.s,
            face: first.face,
            instance: Ranks { solids, standings }.instance(first.rank),
            entering: first.entering,
            from: Region::OUTSIDE,
            to: Region::OUTSIDE,
        })
    }
}

/// Pairs the passages of a line to chords, which are added to `chords`. `own.held` comes with the unbounded solids that hold the
/// start.
fn collect(
    ranks: &Ranks<'_>,
    line: &Line,
    overlaps: Overlaps,
    own: &mut ChordScratch,
    chords: &mut Vec<Chord>,
) {
    let ChordScratch {
        passages,
        held,
        visible,
        open,
        ..
    } = own;
    add_held_at_start(passages, held);
    open.clear();
    let first = chords.len();
    list_visible(ranks, overlaps, held, visible);
    let without_face = |s: f64| ChordEnd {
        t: line.t(s),
        face: FaceId::NONE,
        instance: 0,
        displaced: false,
        entering: false,
    };
    let start = without_face(line.origin);
    let never = without_face(line.end);
    let begin = |rank: u32, enter: ChordEnd, chords: &mut Vec<Chord>| {
        let chord = chords.len();
        chords.push(Chord {
            object: ranks.object(rank),
            instance: ranks.instance(rank),
            enter,
            exit: never,
        });
        Open { rank, chord }
    };
    open.extend(visible.iter().map(|&rank| begin(rank, start, chords)));
    for group in passages.chunk_by(|a, b| a.s == b.s) {
        for passage in group {
            pass(held, passage);
        }
        // Where a solid begins or ends without a passage of its own, the first one's makes it so.
        let end = |rank: u32| {
            let own = group.iter().find(|p| p.rank == rank);
            let passage = own.unwrap_or(&group[0]);
            ChordEnd {
                t: line.t(passage.s),
                face: passage.face,
                instance: ranks.instance(passage.rank),
                displaced: own.is_none(),
                entering: passage.entering,
            }
        };
        list_visible(ranks, overlaps, held, visible);
        open.retain(|o| {
            let stays = visible.binary_search(&o.rank).is_ok();
            if !stays {
                chords[o.chord].exit = end(o.rank);
            }
            stays
        });
        for &rank in visible.iter() {
            if let Err(at) = open.binary_search_by_key(&rank, |o| o.rank) {
                open.insert(at, begin(rank, end(rank), chords));
            }
        }
    }
    // Far from the ray's origin two parameters may round to one.
    let mut kept = first;
    for index in first..chords.len() {
        let chord = chords[index];
        if chord.enter.t < chord.exit.t {
            chords[kept] = chord;
            kept += 1;
        }
    }
    chords.truncate(kept);
}

/// Enters a solid or leaves it; whether it was left without having been entered.
fn pass(held: &mut Vec<u32>, passage: &Passage) -> bool {
    match (held.binary_search(&passage.rank), passage.entering) {
        (Err(at), true) => held.insert(at, passage.rank),
        (Ok(at), false) => {
            held.remove(at);
        }
        (Err(_), false) => return true,
        (Ok(_), true) => {}
    }
    false
}

/// Adds the solids that are left without having been entered: they hold the start.
fn add_held_at_start(passages: &[Passage], held: &mut Vec<u32>) {
    let unbounded = held.len();
    let mut now = held.clone();
    for passage in passages {
        if pass(&mut now, passage) {
            held.push(passage.rank);
        }
    }
    if held.len() > unbounded {
        held.sort_unstable();
        held.dedup();
    }
}

/// Of the solids that hold a point, by rank, those whose chords go on there.
fn list_visible(ranks: &Ranks<'_>, overlaps: Overlaps, held: &[u32], visible: &mut Vec<u32>) {
    let count = match overlaps {
        Overlaps::Objects => held.len(),
        Overlaps::Regions => held.len().min(1),
        Overlaps::Priorities => {
            let priority = |rank: &u32| ranks.priority(*rank);
            let first = held.first().map(priority);
            held.partition_point(|rank| Some(priority(rank)) == first)
        }
    };
    visible.clear();
    visible.extend_from_slice(&held[..count]);
}
