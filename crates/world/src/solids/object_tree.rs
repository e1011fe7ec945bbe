//! Small solids in a tree of tight boxes: a ray meets each alone.
//!
//! Where every object has a few faces only, cells have nothing to reduce: what costs is to find the
//! objects near a line. A [`WideTree`] over their boxes does that. Two questions are asked of it.
//! *What changes next?* Every object is swept by itself, the nearest boxes first. *What happens
//! there?* The objects whose boxes hold that point are swept together, as brute force sweeps all of
//! them: the others are false there, so that regions, priorities and coincident faces come out the
//! same to the bit.

use octray_geometry::csg::{self, Face};
use octray_math::{Aabb, Interval};
use octray_tree::{WalkCost, WideTree, WideTreeConfig, WideTreeError};

use super::cells::{Active, Content};
use super::leaf::{LeafObject, LeafView};
use super::sweep::Change;
use super::volumes::{LeafHits, grown};
use super::{LeafVisit, Scratch, Solids};
use crate::Counters;
use crate::line::Line;

/// The most faces of an object that is small: balls, tubes, cones and rings. Of more, cells leave out
/// those that do not matter, which pays.
const SMALL: usize = 3;
/// The fewest objects that are worth a tree.
const MANY_OBJECTS: usize = 9;
/// The most objects without an end: each is asked on every line.
const FEW: usize = 8;

/// See the module.
#[derive(Debug)]
pub(super) struct ObjectTree {
    /// Over the bounded objects, in the order of `bounded`.
    tree: WideTree,
    /// Their places in the leaf that holds all objects.
    bounded: Vec<u32>,
    unbounded: Vec<u32>,
    /// For each object of that leaf its face, where it has only one: else `MANY`.
    faces: Vec<u32>,
}

const MANY: u32 = u32::MAX;

impl ObjectTree {
    /// Whether all objects are small; `bounds` by rank.
    pub(super) fn suits(all: &Content, bounds: &[Aabb]) -> bool {
        let few_faces = |object: Active<'_>| {
            let words = [object.expression, object.clip];
            words.into_iter().flat_map(csg::faces).nth(SMALL).is_none()
        };
        let endless = |object: &Active<'_>| !bounds[object.rank as usize].is_bounded();
        all.object_count() >= MANY_OBJECTS
            && all.objects().all(few_faces)
            && all.objects().filter(endless).nth(FEW).is_none()
    }

    /// Over the objects of a leaf; `bounds` by rank.
    ///
    /// # Errors
    /// The tree would be too large.
    pub(super) fn build(
        view: &LeafView<'_>,
        bounds: &[Aabb],
        config: &WideTreeConfig,
    ) -> Result<Self, WideTreeError> {
        let of = |index: &u32| &bounds[view.objects[*index as usize].rank as usize];
        let all = 0..view.objects.len() as u32;
        let (bounded, unbounded): (Vec<u32>, Vec<u32>) = all.partition(|i| of(i).is_bounded());
        let boxes: Vec<Aabb> = bounded.iter().map(|i| grown(of(i))).collect();
        let only = |object: &LeafObject| {
            let mut faces = csg::faces(view.expression(object));
            match (faces.next(), faces.next()) {
                (Some(face), None) => face.0,
                _ => MANY,
            }
        };
        Ok(Self {
            tree: WideTree::build(&boxes, config)?,
            bounded,
            unbounded,
            faces: view.objects.iter().map(only).collect(),
        })
    }

    /// The tree over the bounded objects.
    pub(super) const fn tree(&self) -> &WideTree {
        &self.tree
    }

    /// Bytes of the lists beside the tree.
    pub(super) fn list_bytes(&self) -> u64 {
        [&self.bounded, &self.unbounded, &self.faces]
            .into_iter()
            .map(|list| size_of_val(list.as_slice()) as u64)
            .sum()
    }

    /// Adds the objects that the line may meet in `span`, by rank.
    fn gather(
        &self,
        view: &LeafView<'_>,
        line: &Line,
        span: Interval,
        counters: &mut Counters,
        objects: &mut Vec<LeafObject>,
    ) {
        objects.clear();
        let mut cost = WalkCost::default();
        self.tree.all(&line.ray, span, &mut cost, |item| {
            objects.push(view.objects[self.bounded[item as usize] as usize]);
        });
        counters.nodes += cost.nodes;
        objects.extend(self.unbounded.iter().map(|&i| view.objects[i as usize]));
        objects.sort_unstable_by_key(|object| object.rank);
        // One of several parts of its box may have shown an object before.
        objects.dedup_by_key(|object| object.rank);
    }
}

impl Solids {
    /// Sweeps from change to change, as far as `visit` wants: it returns the parameter beyond which
    /// nothing matters any more. Meant for those who want the first ones.
    pub(crate) fn sweep_forward(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Change<'_>) -> f64,
    ) {
        let (Some(objects), Some(leaf)) = (&self.objects, self.outer) else {
            return self.sweep_line(line, limit, scratch, counters, visit);
        };
        scratch.begin(self.surfaces.len());
        let view = self.leaves.get(leaf);
        let mut ahead = Interval::new(line.origin, line.end.min(limit));
        while let Some(s) = self.next_change(objects, &view, line, ahead, scratch, counters) {
            // Every object that holds this point has been asked.
            let mut hits = std::mem::take(&mut scratch.leaf_hits);
            hits.objects.sort_unstable_by_key(|object| object.rank);
            hits.objects.dedup_by_key(|object| object.rank);
            let limit = self.sweep(
                line,
                LeafVisit {
                    index: None,
                    view: &view.only(&hits.objects, &mut hits.surfaces, &self.faces),
                    span: Interval::new(s, s),
                    limit: f64::INFINITY,
                    scratch,
                    counters,
                },
                &mut visit,
            );
            scratch.leaf_hits = hits;
            ahead = Interval::new(s.next_up(), ahead.end.min(limit));
            if ahead.is_empty() {
                return;
            }
        }
    }

    /// Whether the line enters or leaves any object at all.
    pub(crate) fn changes(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let mut changes = false;
        let (Some(objects), Some(leaf)) = (&self.objects, self.outer) else {
            self.sweep_line(line, f64::INFINITY, scratch, counters, |change| {
                // What lies at the very end does not count.
                changes |= change.s() < line.end;
                if changes {
                    f64::NEG_INFINITY
                } else {
                    f64::INFINITY
                }
            });
            return changes;
        };
        scratch.begin(self.surfaces.len());
        let view = self.leaves.get(leaf);
        let ahead = Interval::new(line.origin, line.end);
        let departed = self.departed_surface(line).map(|(surface, ..)| surface);
        let mut cost = WalkCost::default();
        let mut ask = |index: u32| {
            let found = self.first_change(
                objects, &view, index, line, departed, ahead, scratch, counters,
            );
            found.is_some_and(|s| s < line.end)
        };
        changes = objects.unbounded.iter().any(|&index| ask(index))
            || objects.tree.any(&line.ray, ahead, &mut cost, |item| {
                ask(objects.bounded[item as usize])
            });
        counters.nodes += cost.nodes;
        changes
    }

    /// Visits one leaf: the objects whose boxes the line meets in `span`.
    pub(super) fn sweep_objects(
        &self,
        objects: &ObjectTree,
        line: &Line,
        span: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
        visit: &mut dyn FnMut(LeafVisit<'_>) -> f64,
    ) -> f64 {
        let Some(leaf) = self.outer else {
            return f64::INFINITY;
        };
        let whole = self.leaves.get(leaf);
        let LeafHits {
            objects: mut met,
            mut surfaces,
        } = std::mem::take(&mut scratch.leaf_hits);
        objects.gather(&whole, line, span, counters, &mut met);
        let limit = visit(LeafVisit {
            index: None,
            view: &whole.only(&met, &mut surfaces, &self.faces),
            span,
            limit: f64::INFINITY,
            scratch,
            counters,
        });
        scratch.leaf_hits = LeafHits {
            objects: met,
            surfaces,
        };
        limit
    }

    /// The first parameter of `ahead` at which the line enters or leaves any object. Those that were
    /// asked, among them all that hold the point there, stand in the scratch then.
    fn next_change(
        &self,
        objects: &ObjectTree,
        view: &LeafView<'_>,
        line: &Line,
        ahead: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<f64> {
        let departed = self.departed_surface(line).map(|(surface, ..)| surface);
        let mut next = None;
        scratch.leaf_hits.objects.clear();
        let mut ask = |index: u32, end: f64| {
            scratch.leaf_hits.objects.push(view.objects[index as usize]);
            let within = Interval::new(ahead.start, end);
            let found = self.first_change(
                objects, view, index, line, departed, within, scratch, counters,
            );
            match found {
                Some(s) if s <= end => {
                    next = found;
                    s
                }
                _ => end,
            }
        };
        let mut end = ahead.end;
        for &index in &objects.unbounded {
            end = ask(index, end);
        }
        let mut cost = WalkCost::default();
        let ahead = Interval::new(ahead.start, end);
        objects
            .tree
            .closest(&line.ray, ahead, &mut cost, |item, end| {
                ask(objects.bounded[item as usize], end)
            });
        counters.nodes += cost.nodes;
        next
    }

    /// Where the line first enters or leaves one object.
    #[expect(
        clippy::too_many_arguments,
        reason = "one hot function with its working memory"
    )]
    #[inline]
    fn first_change(
        &self,
        objects: &ObjectTree,
        view: &LeafView<'_>,
        index: u32,
        line: &Line,
        departed: Option<u32>,
        within: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<f64> {
        let face: Option<&Face> = self.faces.get(objects.faces[index as usize] as usize);
        match face.map(|face| face.surface.0) {
            Some(surface) if Some(surface) != departed => {
                counters.surface_tests += 1;
                self.first_crossing(surface, line, within)
            }
            _ => {
                let object = &view.objects[index as usize];
                self.first_toggle(line, view, object, within, scratch, counters)
            }
        }
    }

    /// Where the line first changes its side of a surface that it does not depart from.
    fn first_crossing(&self, surface: u32, line: &Line, within: Interval) -> Option<f64> {
        let mut first = None;
        self.surfaces[surface as usize].crossings(&line.ray, |s| {
            // There is one zero.
            let s = s + 0.0;
            if s > line.origin && s >= within.start {
                match first {
                    None => first = Some(s),
                    // Crossed twice at once: nothing changes.
                    Some(same) if same == s => first = None,
                    Some(_) => {}
                }
            }
        });
        first
    }
}
