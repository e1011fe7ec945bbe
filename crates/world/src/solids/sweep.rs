//! The merge of sorted crossings (Roth 1982) inside one cell, regularised.
//!
//! At one parameter all surfaces that are crossed there change sides together; an object has a
//! boundary there only if its expression differs before and after. No tolerance acts here: equal
//! parameters mean coincidence because coincident surfaces are one (see `surface::table`).

use octray_geometry::FaceId;
use octray_geometry::csg::{self, changed_face, evaluate};
use octray_math::Interval;

use super::leaf::{LeafObject, LeafView};
use super::{LeafVisit, Scratch, Solids};
use crate::line::Line;
use crate::{Counters, Region};

/// In leaves of more objects only those that name a crossed surface are asked again, which takes a
/// list of who does.
const MANY_OBJECTS: usize = 64;

/// A surface is crossed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    s: f64,
    surface: u32,
    triangle: u32,
}

/// A boundary on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interface {
    /// In the line's parameter.
    pub(crate) s: f64,
    /// Whose boundary is reported.
    pub(crate) face: FaceId,
    /// Which copy's, 0 for none.
    pub(crate) instance: u32,
    /// Whether the line enters the face's object.
    pub(crate) entering: bool,
    pub(crate) from: Region,
    pub(crate) to: Region,
}

/// What happens at one parameter of a line: some objects are entered or left.
pub(crate) struct Change<'a> {
    solids: &'a Solids,
    view: &'a LeafView<'a>,
    group: &'a [Event],
    /// The sides behind it.
    negative: &'a [bool],
    before: &'a [bool],
    after: &'a [bool],
}

/// One object's part of a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passage {
    /// In the line's parameter.
    pub(crate) s: f64,
    /// Index into the ranked objects.
    pub(crate) rank: u32,
    pub(crate) entering: bool,
    /// Of the object.
    pub(crate) face: FaceId,
}

impl Change<'_> {
    /// In the line's parameter.
    pub(crate) fn s(&self) -> f64 {
        self.group[0].s
    }

    fn truth(&self, face: FaceId) -> bool {
        self.solids.truth(self.negative, face)
    }

    fn truth_before(&self, face: FaceId) -> bool {
        let surface = self.solids.faces[face.0 as usize].surface.0;
        let crossings = self.group.iter().filter(|e| e.surface == surface).count();
        self.truth(face) ^ (crossings % 2 == 1)
    }

    /// The leaf's objects that are entered or left.
    fn changed(&self) -> impl Iterator<Item = (usize, &LeafObject)> {
        let objects = self.view.objects.iter().enumerate();
        objects.filter(|(index, _)| self.before[*index] != self.after[*index])
    }

    /// The face of a changed object that is crossed.
    fn face(&self, object: &LeafObject) -> Option<FaceId> {
        let face = changed_face(
            self.view.expression(object),
            &|face| self.truth_before(face),
            &|face| self.truth(face),
        )?;
        Some(self.solids.triangle_face(face, self.group))
    }

    /// The boundary that is seen here, if any is.
    pub(crate) fn interface(&self) -> Option<Interface> {
        let Self { solids, view, .. } = self;
        let (from, to) = (
            solids.region(view, self.before),
            solids.region(view, self.after),
        );
        let mut chosen: Option<(u8, usize)> = None;
        for (index, object) in self.changed() {
            let ranked = &solids.ranked[object.rank as usize];
            let class = if ranked.shell {
                let counts = view.clip(object).is_none_or(|clip| {
                    evaluate(clip, &|face| self.truth(face))
                        || evaluate(clip, &|face| self.truth_before(face))
                });
                if !counts {
                    continue;
                }
                3
            } else if self.is_hidden(ranked.priority) {
                continue;
            } else if Some(ranked.object) == to.object() {
                // What the line comes to see is the surface of what it enters.
                0
            } else if Some(ranked.object) == from.object() {
                1
            } else {
                2
            };
            if chosen.is_none_or(|(best, _)| class < best) {
                chosen = Some((class, index));
            }
        }
        let (_, index) = chosen?;
        Some(Interface {
            s: self.group[0].s,
            face: self.face(&view.objects[index])?,
            instance: 0,
            entering: self.after[index],
            from,
            to,
        })
    }

    /// Whether a solid of higher priority is on both sides.
    fn is_hidden(&self, priority: i32) -> bool {
        let ranked = &self.solids.ranked;
        if !self.solids.priorities_differ {
            return false;
        }
        let fills = self.view.base.checked_sub(1);
        let fills = fills.is_some_and(|rank| ranked[rank as usize].priority > priority);
        let inside = self.before.iter().zip(self.after).map(|(b, a)| *b && *a);
        fills
            || self
                .view
                .objects
                .iter()
                .zip(inside)
                .any(|(object, inside)| {
                    let other = &ranked[object.rank as usize];
                    inside && !other.shell && other.priority > priority
                })
    }
}

impl Solids {
    /// Visits the changes in one leaf, in order, and returns the new limit.
    pub(super) fn sweep(
        &self,
        line: &Line,
        leaf: LeafVisit<'_>,
        visit: &mut impl FnMut(&Change<'_>) -> f64,
    ) -> f64 {
        let LeafVisit {
            index: _,
            view,
            span,
            mut limit,
            scratch,
            counters,
        } = leaf;
        scratch.events.clear();
        let part = Interval::new(span.start, span.end.min(limit));
        if !self.place_until_decided(view, line, part, scratch, counters) {
            return limit;
        }
        if scratch.events.len() > 1 {
            scratch
                .events
                .sort_unstable_by(|a, b| a.s.total_cmp(&b.s).then(a.surface.cmp(&b.surface)));
        }
        let Scratch {
            events,
            negative,
            inside,
            inside_after,
            naming,
            ..
        } = scratch;
        self.memberships(view, negative, inside);
        let many = view.objects.len() > MANY_OBJECTS;
        if many {
            self.who_names(view, naming);
        }
        for group in events.chunk_by(|a, b| a.s == b.s) {
            if group[0].s > limit {
                break;
            }
            for event in group {
                negative[event.surface as usize] ^= true;
            }
            if many {
                inside_after.clone_from(inside);
                for event in group {
                    let first = naming.partition_point(|(surface, _)| *surface < event.surface);
                    let own = naming[first..].iter();
                    for (_, index) in own.take_while(|(surface, _)| *surface == event.surface) {
                        let object = &view.objects[*index as usize];
                        inside_after[*index as usize] = self.is_inside(view, object, negative);
                    }
                }
            } else {
                self.memberships(view, negative, inside_after);
            }
            if inside != inside_after {
                limit = limit.min(visit(&Change {
                    solids: self,
                    view,
                    group,
                    negative,
                    before: inside,
                    after: inside_after,
                }));
            }
            std::mem::swap(inside, inside_after);
        }
        limit
    }

    /// Puts the surfaces of the leaf on their sides at the start of `part` and collects the crossings
    /// in it. `false` if nothing changes there: of an intersection, one operand that is false all
    /// along tells so, and nobody needs to know where the others are crossed.
    fn place_until_decided(
        &self,
        view: &LeafView<'_>,
        line: &Line,
        part: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let Some((absorbing, literals)) = view.flat() else {
            self.place(view, line, part.start, scratch, counters, Some(part.end));
            return !scratch.events.is_empty();
        };
        for face in csg::faces(literals) {
            let surface = self.faces[face.0 as usize].surface.0;
            let found = scratch.events.len();
            self.place_one(surface, line, part.start, scratch, counters, Some(part.end));
            let is_constant = scratch.events.len() == found;
            if is_constant && self.truth(&scratch.negative, face) == absorbing {
                return false;
            }
        }
        !scratch.events.is_empty()
    }

    /// Puts every surface of the leaf on its side at `start`, and collects the crossings from there
    /// to `end` if one is given.
    pub(super) fn place(
        &self,
        view: &LeafView<'_>,
        line: &Line,
        start: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        end: Option<f64>,
    ) {
        for &surface in view.surfaces {
            self.place_one(surface, line, start, scratch, counters, end);
        }
    }

    /// [`Solids::place`] for one surface.
    #[inline]
    fn place_one(
        &self,
        surface: u32,
        line: &Line,
        start: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        end: Option<f64>,
    ) {
        let slot = self.roots(surface, line, scratch, counters);
        let Scratch {
            roots,
            events,
            negative,
            ..
        } = scratch;
        let (ahead, side) = slot.ahead(roots, start);
        negative[surface as usize] = side;
        if let Some(end) = end {
            for root in roots[ahead].iter().take_while(|r| r.s <= end) {
                events.push(Event {
                    s: root.s,
                    surface,
                    triangle: root.triangle,
                });
            }
        }
    }

    fn truth(&self, negative: &[bool], face: FaceId) -> bool {
        let face = &self.faces[face.0 as usize];
        negative[face.surface.0 as usize] != face.inside_is_positive
    }

    pub(super) fn memberships(
        &self,
        view: &LeafView<'_>,
        negative: &[bool],
        inside: &mut Vec<bool>,
    ) {
        inside.clear();
        let objects = view.objects.iter();
        inside.extend(objects.map(|object| self.is_inside(view, object, negative)));
    }

    fn is_inside(&self, view: &LeafView<'_>, object: &LeafObject, negative: &[bool]) -> bool {
        evaluate(view.expression(object), &|face| self.truth(negative, face))
    }

    /// Which of the leaf's objects name a surface, as pairs in the order of the surfaces: only these
    /// can change where it is crossed.
    fn who_names(&self, view: &LeafView<'_>, naming: &mut Vec<(u32, u32)>) {
        naming.clear();
        for (index, object) in view.objects.iter().enumerate() {
            let surface = |face: FaceId| self.faces[face.0 as usize].surface.0;
            let faces = csg::faces(view.expression(object));
            naming.extend(faces.map(|face| (surface(face), index as u32)));
        }
        naming.sort_unstable();
        naming.dedup();
    }

    /// A face of a mesh operand becomes that of the triangle which was crossed.
    fn triangle_face(&self, face: FaceId, group: &[Event]) -> FaceId {
        let surface = self.faces[face.0 as usize].surface.0;
        let crossed = group.iter().find(|e| e.surface == surface);
        self.face_of_triangle(face, crossed.map_or(0, |e| e.triangle))
    }

    /// The triangle's face, for the literal of a mesh operand; any other face as it is.
    pub(super) fn face_of_triangle(&self, face: FaceId, triangle: u32) -> FaceId {
        let surface = self.faces[face.0 as usize].surface.0;
        match (surface as usize).checked_sub(self.surfaces.len()) {
            Some(mesh) => FaceId(self.meshes[mesh].first_face + triangle),
            None => face,
        }
    }
}
