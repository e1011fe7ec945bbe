//! Who is where, when copies overlap solids and each other.
//!
//! A copy is ranked as an object would be: higher priority first, then the smaller, then the later
//! object, then the later copy. Its size is that of the box around its prototype's box.

use std::cmp::Ordering;

use octray_math::Interval;
use octray_scene::ObjectId;

use super::Copy;
use crate::line::Line;
use crate::solids::{Interface, Scratch};
use crate::{Counters, Region, World};

/// The rank of a solid, or of a part of a copy; the least is where solids overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Standing {
    pub(super) priority: i32,
    size: f64,
    pub(super) object: ObjectId,
    /// Which copy, 0 for none.
    pub(super) instance: u32,
    /// Rank among the parts of the copy.
    pub(super) part: u32,
}

impl Standing {
    pub(super) fn of_object(world: &World, object: ObjectId) -> Self {
        Self {
            priority: world.scene.objects()[object.0 as usize].priority,
            size: world.solids.size_of(object),
            object,
            instance: 0,
            part: 0,
        }
    }

    pub(super) fn of_copy(copy: &Copy<'_>, part: u32) -> Self {
        Self {
            priority: copy.copies.priority,
            size: copy.size(),
            object: copy.copies.object,
            instance: copy.instance,
            part,
        }
    }

    pub(super) fn rank(&self, other: &Self) -> Ordering {
        (other.priority.cmp(&self.priority))
            .then(self.size.total_cmp(&other.size))
            .then(other.object.cmp(&self.object))
            .then(other.instance.cmp(&self.instance))
            .then(self.part.cmp(&other.part))
    }
}

/// The first by rank.
fn first(a: Option<Standing>, b: Option<Standing>) -> Option<Standing> {
    match (a, b) {
        (Some(a), Some(b)) if b.rank(&a) == Ordering::Less => Some(b),
        (Some(a), _) => Some(a),
        (None, b) => b,
    }
}

fn region(standing: Option<Standing>) -> Region {
    standing.map_or(Region::OUTSIDE, |s| Region::of(s.object))
}

impl Copy<'_> {
    fn size(&self) -> f64 {
        let index = self.instance - 1 - self.copies.first_copy;
        let placed = &self.copies.world_from_prototype[index as usize];
        self.prototype.bounds().transformed(placed).diagonal()
    }
}

impl World {
    /// The first by rank of the copies that hold the point at `s`, but for one of them.
    fn copy_at(
        &self,
        line: &Line,
        s: f64,
        except: u32,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Standing> {
        if !self.instances.have_insides {
            return None;
        }
        let mut memory = self.instances.take_memory(scratch);
        let mut best = None;
        let span = Interval::new(s, s);
        self.instances
            .visit(line, span, counters, |copy, counters| {
                let inner = copy.line(line).filter(|_| copy.instance != except);
                if let Some(inner) = inner {
                    let scratch = &mut memory[copy.copies.prototype];
                    let solids = &copy.prototype.solids;
                    let region = solids.region_at(&inner, inner.inner(s), scratch, counters);
                    if region != Region::OUTSIDE {
                        best = first(best, Some(Standing::of_copy(copy, 0)));
                    }
                }
                f64::INFINITY
            });
        scratch.prototypes = memory;
        best
    }

    /// The region at parameter `s` of the line, copies included.
    pub(crate) fn region_with_copies(
        &self,
        line: &Line,
        s: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Region {
        let own = self.solids.region_at(line, s, scratch, counters);
        if self.instances.is_empty() {
            return own;
        }
        let copy = self.copy_at(line, s, 0, scratch, counters);
        match (own.object(), copy) {
            (_, None) => own,
            (None, copy) => region(copy),
            (Some(own), copy) => region(first(Some(Standing::of_object(self, own)), copy)),
        }
    }

    /// What was found among all boundaries, with the regions on both sides; `None` if something of
    /// higher priority hides it.
    pub(super) fn among_all(
        &self,
        line: &Line,
        found: Interface,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        if self.is_of_sheet(&found) {
            let region = self.region_with_copies(line, found.s, scratch, counters);
            return Some(Interface {
                from: region,
                to: region,
                ..found
            });
        }
        let copies = self.copy_at(line, found.s, found.instance, scratch, counters);
        let standing = |object| Standing::of_object(self, object);
        let copy = self.instances.copy(found.instance);
        let others = if copy.is_some() {
            let own = self.solids.region_at(line, found.s, scratch, counters);
            first(own.object().map(standing), copies)
        } else {
            copies
        };
        // A solid's own regions come with those of the others that it was prepared with.
        let own = |side: Region| match &copy {
            Some(copy) => side.object().map(|_| Standing::of_copy(copy, 0)),
            None => side.object().map(standing),
        };
        let priority = match (&copy, self.owner(found.face)) {
            (Some(copy), _) => copy.copies.priority,
            (None, Some((object, _))) => standing(object).priority,
            (None, None) => return Some(found),
        };
        if others.is_some_and(|other| other.priority > priority) {
            return None;
        }
        Some(Interface {
            from: region(first(own(found.from), others)),
            to: region(first(own(found.to), others)),
            ..found
        })
    }

    /// Whether what was found has no inside.
    fn is_of_sheet(&self, found: &Interface) -> bool {
        let is_solid = |world: &Self, face| {
            let object = world.solids.owner(face, &world.scene);
            object.is_some_and(|(object, _)| {
                let shape = &world.scene.objects()[object.0 as usize].shape;
                matches!(shape, octray_scene::Shape::Solid(_))
            })
        };
        !match self.instances.copy(found.instance) {
            Some(copy) => is_solid(copy.prototype, copy.own_face(found.face)),
            None => is_solid(self, found.face),
        }
    }
}
