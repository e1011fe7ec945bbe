//! Copies of prototypes: a two-level octree.
//!
//! A prototype is a world of its own, in its own coordinates. Over the boxes of all copies stands one
//! octree with wide nodes; a line that meets a copy's box is taken into the prototype's coordinates
//! by the inverse transform, without normalising, so that its parameters keep their meaning up to
//! rounding, and is asked of the prototype. The answers are compared by (parameter, instance, face).
//!
//! Beside that octree nothing is kept for a copy: its transform stands in the scene, and is inverted
//! when a line comes near.

mod boxes;
mod chords;
mod interact;
mod prepare;
mod regions;
mod search;

use std::sync::Arc;

use octray_geometry::FaceId;
use octray_math::{DAffine3, DMat3, DVec3, Interval, Ray};
use octray_scene::ObjectId;
use octray_tree::{WalkCost, WideTree};

pub(crate) use chords::Ranks;
pub(crate) use regions::Standing;

use crate::line::Line;
use crate::solids::Scratch;
use crate::{Counters, Departure, Region, World};

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Instances {
    prototypes: Vec<World>,
    /// The scene's objects that are made of copies, in its order.
    objects: Vec<Copies>,
    /// How many copies there are.
    count: u32,
    /// `None` where every copy is tried.
    tree: Option<WideTree>,
    /// The point of the world that is the origin of the scene's coordinates.
    origin: DVec3,
    /// Whether any copy has an inside.
    have_insides: bool,
    /// Whether copies and solids have priorities that differ.
    priorities_differ: bool,
}

/// One object's copies.
#[derive(Debug)]
struct Copies {
    object: ObjectId,
    priority: i32,
    prototype: usize,
    /// Copies and faces of the objects before it.
    first_copy: u32,
    first_face: u32,
    world_from_prototype: Arc<[DAffine3]>,
}

/// One copy, ready for lines.
#[derive(Clone, Copy, Debug)]
struct Copy<'a> {
    copies: &'a Copies,
    prototype: &'a World,
    /// As in [`crate::Hit::instance`].
    instance: u32,
    /// Where the prototype's origin stands, in the coordinates of the scene.
    position: DVec3,
    prototype_from_scene: DMat3,
}

impl Instances {
    /// Whether there are no copies.
    pub(crate) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether copies may hide boundaries, or have theirs hidden, by an explicit priority.
    pub(crate) const fn hide(&self) -> bool {
        self.count > 0 && self.priorities_differ
    }

    /// The built structures as words.
    pub(crate) fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let bytes = self.tree.iter().flat_map(WideTree::bytes);
        let words = bytes.flat_map(|part| part.as_chunks::<4>().0);
        let tree = words.map(|word| u32::from_le_bytes(*word));
        tree.chain(self.prototypes.iter().flat_map(World::words))
    }

    /// How many copies there are.
    pub(crate) const fn len(&self) -> u32 {
        self.count
    }

    /// What is copied.
    pub(crate) fn prototypes(&self) -> &[World] {
        &self.prototypes
    }

    /// The octree over the copies' boxes.
    pub(crate) const fn tree(&self) -> Option<&WideTree> {
        self.tree.as_ref()
    }

    /// The copy of this number, from 1.
    fn copy(&self, instance: u32) -> Option<Copy<'_>> {
        let number = instance.checked_sub(1).filter(|n| *n < self.count)?;
        let next = self.objects.partition_point(|o| o.first_copy <= number);
        // Objects without copies begin where the next one does.
        let copies = &self.objects[next - 1];
        let placed = &copies.world_from_prototype[(number - copies.first_copy) as usize];
        Some(Copy {
            copies,
            prototype: &self.prototypes[copies.prototype],
            instance,
            position: placed.translation - self.origin,
            prototype_from_scene: placed.matrix3.inverse(),
        })
    }

    /// Shows `visit` the copies that the line may meet in `span`; it returns the parameter beyond
    /// which nothing matters any more.
    fn visit(
        &self,
        line: &Line,
        span: Interval,
        counters: &mut Counters,
        mut visit: impl FnMut(&Copy<'_>, &mut Counters) -> f64,
    ) {
        let mut cost = WalkCost::default();
        if let Some(tree) = &self.tree {
            tree.closest(&line.ray, span, &mut cost, |item, end| {
                let copy = self.copy(item + 1);
                copy.map_or(end, |copy| visit(&copy, counters))
            });
        } else {
            for copy in (1..=self.count).filter_map(|instance| self.copy(instance)) {
                cost.items += 1;
                if visit(&copy, counters) == f64::NEG_INFINITY {
                    break;
                }
            }
        }
        counters.add_instances(&cost);
    }

    /// Working memory for each prototype, to be given back to the scratch.
    fn take_memory(&self, scratch: &mut Scratch) -> Vec<Scratch> {
        let mut memory = std::mem::take(&mut scratch.prototypes);
        memory.resize_with(self.prototypes.len(), Scratch::default);
        memory
    }
}

impl Copy<'_> {
    /// The line in the prototype's coordinates, `None` where it leaves the range of numbers.
    fn line(&self, line: &Line) -> Option<Line> {
        let Ray { origin, direction } = line.ray;
        let ray = Ray::new(
            self.prototype_from_scene * (origin - self.position),
            self.prototype_from_scene * direction,
        );
        let departure = if line.departure.instance == self.instance {
            Departure {
                face: self.own_face(line.departure.face),
                instance: 0,
                ..line.departure
            }
        } else {
            Departure::NONE
        };
        line.seen_as(ray, &self.prototype.place, departure)
    }

    /// The identity in the scene of a face of the prototype.
    const fn face(&self, face: FaceId) -> FaceId {
        FaceId(self.copies.first_face + face.0)
    }

    /// The prototype's face that has this identity in the scene.
    fn own_face(&self, face: FaceId) -> FaceId {
        let own = face.0.checked_sub(self.copies.first_face);
        own.map_or(FaceId::NONE, FaceId)
    }

    /// The region that one of the prototype stands for.
    fn region(&self, own: Region) -> Region {
        own.object()
            .map_or(Region::OUTSIDE, |_| Region::of(self.copies.object))
    }
}
