//! Small solids in a tree of tight boxes: a ray meets each alone.
//!
//! Where every object has a few faces only, or is a convex hull less convex holes
//! ([`super::flat_object`]), cells have little to reduce: what costs is to find the objects near a
//! line. A [`WideTree`] over their boxes does that. Two questions are asked of it. *What changes
//! next?* Every object is asked by itself, the nearest boxes first. *What happens there?* If one
//! flat object is all there is, it has said so. Else the objects that are not known to be elsewhere
//! are swept together, as brute force sweeps all of them: the others are false there, so that
//! regions, priorities and coincident faces come out the same to the bit.

use octray_geometry::csg::{self, Face};
use octray_geometry::surface::Surface;
use octray_math::{Aabb, Interval};
use octray_tree::{WalkCost, WideTree, WideTreeConfig, WideTreeError};

use super::cells::{Active, Content};
use super::flat_object::{Ahead, Course, FirstChange, FlatObjects, Met};
use super::leaf::{LeafObject, LeafView};
use super::sweep::Interface;
use super::volumes::{LeafHits, grown};
use super::{LeafVisit, Scratch, Solids};
use crate::line::Line;
use crate::{Counters, Region};

/// The most faces of an object that is small, unless it is flat: balls, tubes, cones and rings. Of
/// more, cells leave out those that do not matter, which pays.
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
    flat: FlatObjects,
}

impl ObjectTree {
    /// Whether all objects are small; `bounds` by rank.
    pub(super) fn suits(
        all: &Content,
        bounds: &[Aabb],
        faces: &[Face],
        surfaces: &[Surface],
    ) -> bool {
        let few_faces = |object: Active<'_>| {
            let words = [object.expression, object.clip];
            words.into_iter().flat_map(csg::faces).nth(SMALL).is_none()
                || (object.clip.is_empty()
                    && FlatObjects::suits(object.expression, faces, surfaces))
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
        flat: FlatObjects,
        config: &WideTreeConfig,
    ) -> Result<Self, WideTreeError> {
        let of = |index: &u32| &bounds[view.objects[*index as usize].rank as usize];
        let all = 0..view.objects.len() as u32;
        let (bounded, unbounded): (Vec<u32>, Vec<u32>) = all.partition(|i| of(i).is_bounded());
        let boxes: Vec<Aabb> = bounded.iter().map(|i| grown(of(i))).collect();
        Ok(Self {
            tree: WideTree::build(&boxes, config)?,
            bounded,
            unbounded,
            flat,
        })
    }

    /// The tree over the bounded objects.
    pub(super) const fn tree(&self) -> &WideTree {
        &self.tree
    }

    /// Bytes of the lists beside the tree.
    pub(super) fn list_bytes(&self) -> u64 {
        let lists = [&self.bounded, &self.unbounded].into_iter();
        let bytes: u64 = lists.map(|list| size_of_val(list.as_slice()) as u64).sum();
        bytes + self.flat.list_bytes()
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
    /// Visits the boundaries that are seen, change by change, as far as `visit` wants: it returns the
    /// parameter beyond which nothing matters any more. Meant for those who want the first ones.
    pub(crate) fn sweep_forward(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(Option<Interface>) -> f64,
    ) {
        let (Some(objects), Some(leaf)) = (&self.objects, self.outer) else {
            return self.sweep_line(line, limit, scratch, counters, |change| {
                visit(change.interface())
            });
        };
        scratch.begin(self.surfaces.len());
        let view = self.leaves.get(leaf);
        let mut ahead = Interval::new(line.origin, line.end.min(limit));
        while let Some((s, ahead_of)) =
            self.next_change(objects, &view, line, ahead, scratch, counters)
        {
            // Every object that holds this point has been asked.
            let mut met = std::mem::take(&mut scratch.met);
            met.retain(|met| met.inside || met.s == s);
            let limit = match (&met[..], ahead_of) {
                // In several leaves it has been asked several times.
                ([one, same @ ..], Ahead::Change(change))
                    if view.base == 0 && same.iter().all(|m| m.object.rank == one.object.rank) =>
                {
                    visit(Some(self.interface_of(one.object.rank, change)))
                }
                _ => self.sweep_at(s, line, &view, &met, scratch, counters, &mut visit),
            };
            scratch.met = met;
            ahead = Interval::new(s.next_up(), ahead.end.min(limit));
            if ahead.is_empty() {
                return;
            }
        }
    }

    /// Sweeps all objects that have been met at one parameter.
    #[expect(
        clippy::too_many_arguments,
        reason = "one hot function with its working memory"
    )]
    #[inline(never)]
    fn sweep_at(
        &self,
        s: f64,
        line: &Line,
        view: &LeafView<'_>,
        met: &[Met],
        scratch: &mut Scratch,
        counters: &mut Counters,
        visit: &mut impl FnMut(Option<Interface>) -> f64,
    ) -> f64 {
        let mut hits = std::mem::take(&mut scratch.leaf_hits);
        hits.objects.clear();
        hits.objects.extend(met.iter().map(|met| met.object));
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
            &mut |change| visit(change.interface()),
        );
        scratch.leaf_hits = hits;
        limit
    }

    /// The change of an object where nothing else is.
    fn interface_of(&self, rank: u32, change: FirstChange) -> Interface {
        let inside = Region::of(self.object_of(rank));
        let (from, to) = if change.entering {
            (Region::OUTSIDE, inside)
        } else {
            (inside, Region::OUTSIDE)
        };
        Interface {
            s: change.s,
            face: change.face,
            instance: 0,
            entering: change.entering,
            from,
            to,
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
        let course = self.course(line, ahead.start);
        let mut cost = WalkCost::default();
        let mut ask = |index: u32| {
            let end = line.end;
            let (met, _) =
                self.first_change(objects, &view, index, &course, end, scratch, counters);
            met.is_some_and(|met| met.s < end)
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

    /// The first parameter of `ahead` at which the line enters or leaves any object, and what is
    /// known of the change. The objects that were asked and are not known to be elsewhere, among them
    /// all that hold the point there, stand in the scratch then.
    fn next_change(
        &self,
        objects: &ObjectTree,
        view: &LeafView<'_>,
        line: &Line,
        ahead: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<(f64, Ahead)> {
        let course = self.course(line, ahead.start);
        let mut next = None;
        scratch.met.clear();
        let mut ask = |index: u32, end: f64| {
            let (met, known) =
                self.first_change(objects, view, index, &course, end, scratch, counters);
            let Some(met) = met else { return end };
            scratch.met.push(met);
            if met.s <= end && met.s < f64::INFINITY {
                next = Some((met.s, known));
                met.s
            } else {
                end
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

    /// The line from `start` on.
    fn course<'a>(&self, line: &'a Line, start: f64) -> Course<'a> {
        let departed = self.departed_surface(line);
        let departed = departed.map(|(surface, to_positive, _)| (surface, to_positive));
        Course::new(line, start, departed)
    }

    /// Where the line first enters or leaves one object; `None` if it is outside all along.
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
        course: &Course<'_>,
        end: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> (Option<Met>, Ahead) {
        let ahead = (objects.flat).ahead(index, course, end, &self.surfaces, counters);
        let (inside, s) = match ahead {
            Ahead::Outside => return (None, ahead),
            Ahead::Inside => (true, f64::INFINITY),
            Ahead::Change(change) => (!change.entering, change.s),
            Ahead::Unknown => {
                let within = course.until(end);
                let object = &view.objects[index as usize];
                let (inside, first) =
                    self.first_toggle(course.line, view, object, within, scratch, counters);
                (inside, first.unwrap_or(f64::INFINITY))
            }
        };
        let object = view.objects[index as usize];
        (Some(Met { object, inside, s }), ahead)
    }
}
