//! A search on its way from treelet to treelet.

use octray_geometry::FaceId;

use super::Treelets;
use crate::line::Line;
use crate::solids::{Interface, Scratch};
use crate::{Counters, Hit, RayQuery, Region, World};

/// The search for the nearest surface on a ray, as far as it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    query: RayQuery,
    /// Parameter of the line behind which it counts, of a ray without a departure that starts on a surface.
    beyond: Option<f64>,
    best: Option<Best>,
    stage: Stage,
}

/// The nearest boundary so far.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Best {
    s: f64,
    face: FaceId,
    instance: u32,
    holder: Holder,
}

/// Who found it and can find it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holder {
    /// Everyone.
    All,
    Treelet(u16),
}

/// What is to be done where the search arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Shared things are to be asked, anywhere.
    Begin,
    /// The treelet's own things are to be asked.
    Trace,
    /// It is final, and the treelet holds the best boundary.
    Decide,
    /// The region at the best boundary is asked for.
    Locate,
    /// It is known.
    Finish(Region),
}

/// What becomes of a search or an occlusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step<A> {
    /// It goes on in this treelet.
    Forward(u16),
    /// It is answered, in the treelet where it is.
    Done(A),
}

/// The search for something on a ray that stops light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionSearch {
    query: RayQuery,
    begun: bool,
}

impl Search {
    /// Not begun yet.
    #[must_use]
    pub const fn new(query: RayQuery) -> Self {
        Self {
            query,
            beyond: None,
            best: None,
            stage: Stage::Begin,
        }
    }

    fn consider(&mut self, found: Option<Interface>, holder: Holder) {
        let Some(found) = found else { return };
        let comes_first = self.best.is_none_or(|best| {
            let copies = (found.instance, found.face) < (best.instance, best.face);
            found.s < best.s || (found.s == best.s && copies)
        });
        if comes_first {
            self.best = Some(Best {
                s: found.s,
                face: found.face,
                instance: found.instance,
                holder,
            });
        }
    }

    fn limit(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| best.s)
    }
}

impl OcclusionSearch {
    /// Not begun yet.
    #[must_use]
    pub const fn new(query: RayQuery) -> Self {
        Self {
            query,
            begun: false,
        }
    }
}

/// What is asked of a world: what all share, or what one treelet holds.
#[derive(Clone, Copy)]
struct Share<'a> {
    treelets: &'a Treelets,
    holder: Holder,
}

impl Share<'_> {
    fn has_leaf(&self, leaf: Option<u32>) -> bool {
        match (self.holder, leaf) {
            (Holder::All, None) => true,
            (Holder::Treelet(here), Some(leaf)) => self.treelets.leaves[leaf as usize] == here,
            _ => false,
        }
    }

    fn has_triangle(&self, triangle: u32) -> bool {
        match self.holder {
            Holder::All => false,
            Holder::Treelet(here) => self.treelets.triangles[triangle as usize] == here,
        }
    }
}

impl World {
    /// Takes a search as far as it comes in the treelet `here`, asking nothing of the others.
    pub fn search_step(
        &self,
        treelets: &Treelets,
        here: u16,
        search: &mut Search,
        counters: &mut Counters,
    ) -> Step<Hit> {
        self.scratch
            .with(|scratch| self.step(treelets, here, search, scratch, counters))
    }

    fn step(
        &self,
        treelets: &Treelets,
        here: u16,
        search: &mut Search,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Step<Hit> {
        let Some(start) = self.line(&search.query, false) else {
            return Step::Done(Hit::MISS);
        };
        let share = |holder| Share { treelets, holder };
        loop {
            let line = search.beyond.map_or(start, |s| start.beyond(s));
            let next = match search.stage {
                Stage::Begin => {
                    search.stage = Stage::Trace;
                    let shared = self.nearest_shared(&line, share(Holder::All), scratch, counters);
                    search.consider(shared, Holder::All);
                    treelets.next(&line, None, search.limit())
                }
                Stage::Trace => {
                    let own = share(Holder::Treelet(here));
                    let limit = search.limit();
                    let found = self.nearest_of(&line, own, limit, scratch, counters);
                    search.consider(found, own.holder);
                    treelets.next(&line, Some(here), search.limit())
                }
                Stage::Decide => {
                    match self.decide(treelets, here, &line, search, scratch, counters) {
                        Some(hit) => return Step::Done(hit),
                        None if search.stage == Stage::Locate => {
                            Some(treelets.at(&line, search.limit()).unwrap_or(here))
                        }
                        None => Some(here),
                    }
                }
                Stage::Locate => {
                    let s = search.limit();
                    let region = self.solids.region_at(&line, s, scratch, counters);
                    search.stage = Stage::Finish(region);
                    search.best.and_then(|best| match best.holder {
                        Holder::All => None,
                        Holder::Treelet(holder) => Some(holder),
                    })
                }
                Stage::Finish(region) => {
                    let found = self.found_again(treelets, here, &line, search, scratch, counters);
                    return Step::Done(found.map_or(Hit::MISS, |found| {
                        let found = Interface {
                            from: region,
                            to: region,
                            ..found
                        };
                        found.into_hit(&line)
                    }));
                }
            };
            let next = match (next, search.stage, search.best) {
                (Some(next), ..) => next,
                (None, Stage::Trace, None) => return Step::Done(Hit::MISS),
                (None, Stage::Trace, Some(best)) => {
                    search.stage = Stage::Decide;
                    match best.holder {
                        Holder::All => here,
                        Holder::Treelet(holder) => holder,
                    }
                }
                (None, ..) => here,
            };
            if next != here {
                return Step::Forward(next);
            }
        }
    }

    /// What holds the best boundary looks at it: `None` where the search goes on.
    fn decide(
        &self,
        treelets: &Treelets,
        here: u16,
        line: &Line,
        search: &mut Search,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Hit> {
        let found = self.found_again(treelets, here, line, search, scratch, counters)?;
        if self.starts_on(line, &found) {
            *search = Search {
                beyond: Some(found.s),
                ..Search::new(search.query)
            };
            return None;
        }
        let is_sheet = found.instance == 0 && !self.solids.has(found.face);
        if is_sheet && self.has_transparency() {
            search.stage = Stage::Locate;
            return None;
        }
        Some(found.into_hit(line))
    }

    /// The best boundary, by whoever found it.
    fn found_again(
        &self,
        treelets: &Treelets,
        here: u16,
        line: &Line,
        search: &Search,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let best = search.best?;
        let share = Share {
            treelets,
            holder: best.holder,
        };
        match best.holder {
            Holder::All => self.nearest_shared(line, share, scratch, counters),
            Holder::Treelet(holder) => {
                debug_assert_eq!(holder, here, "the search has come to its holder");
                self.nearest_of(line, share, best.s, scratch, counters)
            }
        }
    }

    fn nearest_shared(
        &self,
        line: &Line,
        share: Share<'_>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let own = self.nearest_of(line, share, f64::INFINITY, scratch, counters);
        if self.instances.is_empty() {
            return own;
        }
        self.nearest_copy(line, own, scratch, counters)
    }

    /// The nearest boundary in a share, before `limit` or at it; for a triangle of a sheet without
    /// regions.
    fn nearest_of(
        &self,
        line: &Line,
        share: Share<'_>,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let mut best: Option<Interface> = None;
        self.visit_share(line, share, limit, scratch, counters, |found| {
            let comes_first = found.s < line.end
                && found.s <= limit
                && best.is_none_or(|b| found.s < b.s || (found.s == b.s && found.face < b.face));
            if comes_first {
                best = Some(*found);
            }
            best.map_or(limit, |b| b.s)
        });
        best
    }

    /// Visits the boundaries in a share as [`World::visit_own`] does all.
    fn visit_share(
        &self,
        line: &Line,
        share: Share<'_>,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Interface) -> f64,
    ) {
        let mut limit = limit;
        if matches!(share.holder, Holder::Treelet(_)) {
            let first = self.solids.face_count();
            let memory = &mut scratch.triangles;
            self.sheets
                .visit_line(line, limit, memory, counters, |hit| {
                    if share.has_triangle(hit.face.0 - first) {
                        limit = visit(&Interface::of_sheet(hit));
                    }
                    limit
                });
        }
        if limit == f64::NEG_INFINITY || self.solids.face_count() == 0 {
            return;
        }
        let has = |leaf| share.has_leaf(leaf);
        self.solids
            .sweep_some(line, limit, has, scratch, counters, |change| {
                if let Some(found) = change.interface() {
                    limit = visit(&found);
                }
                limit
            });
    }

    /// Takes a search for something opaque as far as it comes in the treelet `here`; the answer is
    /// that of [`World::occluded`].
    pub fn occlusion_step(
        &self,
        treelets: &Treelets,
        here: u16,
        search: &mut OcclusionSearch,
        counters: &mut Counters,
    ) -> Step<bool> {
        let Some(line) = self.line(&search.query, false) else {
            return Step::Done(false);
        };
        self.scratch.with(|scratch| {
            let mut last = Some(here);
            if !search.begun {
                search.begun = true;
                if self.share_blocks(&line, treelets, Holder::All, scratch, counters) {
                    return Step::Done(true);
                }
                last = None;
            } else if self.share_blocks(&line, treelets, Holder::Treelet(here), scratch, counters) {
                return Step::Done(true);
            }
            loop {
                match treelets.next(&line, last, f64::INFINITY) {
                    None => return Step::Done(false),
                    Some(next) if next != here => return Step::Forward(next),
                    Some(_) => {
                        let own = Holder::Treelet(here);
                        if self.share_blocks(&line, treelets, own, scratch, counters) {
                            return Step::Done(true);
                        }
                        last = Some(here);
                    }
                }
            }
        })
    }

    fn share_blocks(
        &self,
        line: &Line,
        treelets: &Treelets,
        holder: Holder,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let counts = |face| self.blocks(face);
        let share = Share { treelets, holder };
        let mut met = false;
        self.visit_share(line, share, f64::INFINITY, scratch, counters, |found| {
            met |= found.s < line.end && counts(found.face) && !self.starts_on(line, found);
            if met {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            }
        });
        met || (holder == Holder::All
            && !self.instances.is_empty()
            && self.line_meets_copy(line, &counts, scratch, counters))
    }
}

impl Treelets {
    /// The treelet whose boxes hold the point at a parameter of the line, the first of several.
    fn at(&self, line: &Line, s: f64) -> Option<u16> {
        let point = line.ray.at(s);
        self.holding(point)
    }
}
