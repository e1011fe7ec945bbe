//! The boundaries of copies on a line.

use octray_geometry::FaceId;
use octray_math::Interval;

use super::Copy;
use crate::line::Line;
use crate::solids::{Interface, Scratch};
use crate::{Counters, Departure, World};

/// Whether one boundary comes before another: by parameter, then copy, then face.
fn precedes(a: &Interface, b: &Interface) -> bool {
    a.s < b.s || (a.s == b.s && (a.instance, a.face) < (b.instance, b.face))
}

impl Copy<'_> {
    /// A boundary of the prototype on a line that was taken into its coordinates, as one of the copy
    /// on the line itself; `None` where it does not count there.
    fn of_own(&self, line: &Line, inner: &Line, own: &Interface) -> Option<Interface> {
        let s = inner.outer(own.s);
        // Parameters that differ in the prototype may be one here.
        let is_behind = s <= line.origin && inner.departure == Departure::NONE;
        (s < line.end && !is_behind).then(|| Interface {
            s,
            face: self.face(own.face),
            instance: self.instance,
            entering: own.entering,
            from: self.region(own.from),
            to: self.region(own.to),
        })
    }

    /// The nearest boundary of the copy before or at `limit`.
    fn nearest(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let mut inner = self.line(line)?;
        loop {
            let limit = inner.inner_limit(limit);
            let own = self
                .prototype
                .nearest_own(&inner, limit, scratch, counters)?;
            let found = self.of_own(line, &inner, &own);
            if found.is_some() || inner.outer(own.s) > line.origin {
                return found;
            }
            inner = inner.beyond(own.s);
        }
    }
}

impl World {
    /// The nearest boundary, of copies or not, on a line. `own` is the nearest that is not.
    pub(crate) fn nearest_with_copies(
        &self,
        line: &Line,
        mut own: Option<Interface>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let mut line = *line;
        loop {
            let found = self.nearest_copy(&line, own, scratch, counters)?;
            if !(self.has_transparency() || self.instances.priorities_differ) {
                return Some(found);
            }
            if let Some(found) = self.among_all(&line, found, scratch, counters) {
                return Some(found);
            }
            // Hidden: the line goes on behind it.
            line = line.beyond(found.s);
            line.departure = Departure::NONE;
            own = self.nearest_own(&line, f64::INFINITY, scratch, counters);
        }
    }

    /// The nearest boundary of a copy, or the one given if it is nearer.
    pub(crate) fn nearest_copy(
        &self,
        line: &Line,
        mut best: Option<Interface>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let mut memory = self.instances.take_memory(scratch);
        let limit_of = |best: &Option<Interface>| best.map_or(f64::INFINITY, |b| b.s);
        let span = Interval::new(line.origin, limit_of(&best).min(line.end));
        self.instances
            .visit(line, span, counters, |copy, counters| {
                let scratch = &mut memory[copy.copies.prototype];
                let found = copy.nearest(line, limit_of(&best), scratch, counters);
                if let Some(found) = found
                    && best.is_none_or(|best| precedes(&found, &best))
                {
                    best = Some(found);
                }
                limit_of(&best)
            });
        scratch.prototypes = memory;
        best
    }

    /// Whether a face of a copy that counts lies on the half-line.
    pub(crate) fn line_meets_copy(
        &self,
        line: &Line,
        counts: &impl Fn(FaceId) -> bool,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let mut memory = self.instances.take_memory(scratch);
        let mut met = false;
        let span = Interval::new(line.origin, line.end);
        self.instances
            .visit(line, span, counters, |copy, counters| {
                let Some(inner) = copy.line(line) else {
                    return f64::INFINITY;
                };
                let scratch = &mut memory[copy.copies.prototype];
                let limit = f64::INFINITY;
                copy.prototype
                    .visit_own(&inner, limit, scratch, counters, |own| {
                        let found = copy.of_own(line, &inner, own);
                        met |= found.is_some_and(|found| {
                            counts(found.face) && !self.starts_on(line, &found)
                        });
                        if met {
                            f64::NEG_INFINITY
                        } else {
                            f64::INFINITY
                        }
                    });
                if met {
                    f64::NEG_INFINITY
                } else {
                    f64::INFINITY
                }
            });
        scratch.prototypes = memory;
        met
    }

    /// Adds all boundaries of copies on a line, and gives all that are there the regions on their
    /// sides; leaves out what is hidden.
    pub(crate) fn add_copies(
        &self,
        line: &Line,
        found: &mut Vec<Interface>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        self.visit_copies(line, scratch, counters, |found_on_copy| {
            found.push(*found_on_copy);
        });
        let mut kept = 0;
        for index in 0..found.len() {
            let all = self.among_all(line, found[index], scratch, counters);
            if let Some(all) = all {
                found[kept] = all;
                kept += 1;
            }
        }
        found.truncate(kept);
    }

    /// Every boundary of every copy on a line, in any order; near the faces of cells some twice.
    pub(super) fn visit_copies(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Interface),
    ) {
        let mut memory = self.instances.take_memory(scratch);
        let span = Interval::new(line.origin, line.end);
        self.instances
            .visit(line, span, counters, |copy, counters| {
                if let Some(inner) = copy.line(line) {
                    let scratch = &mut memory[copy.copies.prototype];
                    let limit = f64::INFINITY;
                    copy.prototype
                        .visit_own(&inner, limit, scratch, counters, |own| {
                            copy.of_own(line, &inner, own).iter().for_each(&mut visit);
                            f64::INFINITY
                        });
                }
                f64::INFINITY
            });
        scratch.prototypes = memory;
    }
}
