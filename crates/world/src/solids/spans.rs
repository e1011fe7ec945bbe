//! Every stretch of a line inside one object: the set operations on intervals themselves (Roth, *Ray
//! Casting for Modeling Solids*, 1982), operand by operand.
//!
//! Where the objects need not be known all at once this is faster than the sweep: an intersection
//! that is empty already crosses no further surfaces. Both find the same boundaries to the bit. What
//! happens at one parameter happens at once here too: see [`merge`].

use octray_geometry::FaceId;
use octray_geometry::csg::{Term, operands, term};
use octray_math::Interval;

use super::leaf::{LeafObject, LeafView};
use super::{Passage, Scratch, Solids};
use crate::Counters;
use crate::line::Line;

/// Where an operand's truth changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Toggle {
    s: f64,
    /// The lowest face that makes the change.
    face: FaceId,
    /// Of a mesh operand.
    triangle: u32,
}

/// Two operands become one: working memory.
#[derive(Debug, Default)]
pub(super) struct Toggles {
    /// A stack: the last operand's are at the end.
    all: Vec<Toggle>,
    merged: Vec<Toggle>,
}

/// A line in a leaf.
struct Stretch<'a> {
    line: &'a Line,
    words: &'a [u32],
    span: Interval,
}

impl Solids {
    /// Adds the passages in `span` of all solids of a leaf.
    pub(super) fn leaf_passages(
        &self,
        line: &Line,
        view: &LeafView<'_>,
        span: Interval,
        found: &mut Vec<Passage>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        for object in view.objects {
            if self.ranked[object.rank as usize].shell {
                continue;
            }
            scratch.toggles.all.clear();
            let stretch = Stretch {
                line,
                words: view.expression(object),
                span,
            };
            let mut inside = self.truth_along(&stretch, 0, scratch, counters);
            for toggle in &scratch.toggles.all {
                inside = !inside;
                found.push(Passage {
                    s: toggle.s,
                    rank: object.rank,
                    entering: inside,
                    face: self.face_of_triangle(toggle.face, toggle.triangle),
                });
            }
        }
    }

    /// Whether the line is in an object at the start of `span`, and where it first enters or leaves it
    /// in `span`, wherever its boundary counts.
    pub(super) fn first_toggle(
        &self,
        line: &Line,
        view: &LeafView<'_>,
        object: &LeafObject,
        span: Interval,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> (bool, Option<f64>) {
        scratch.toggles.all.clear();
        let stretch = Stretch {
            line,
            words: view.expression(object),
            span,
        };
        let inside = self.truth_along(&stretch, 0, scratch, counters);
        (inside, scratch.toggles.all.first().map(|toggle| toggle.s))
    }

    /// Appends the changes of the term at `at` to the toggles, and returns its truth at the start.
    fn truth_along(
        &self,
        stretch: &Stretch<'_>,
        at: usize,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let all = match term(stretch.words, at) {
            Term::Literal(face) => return self.face_along(stretch, face, scratch, counters),
            Term::And => true,
            Term::Or => false,
        };
        let start = scratch.toggles.all.len();
        // The truth of no operands: what changes nothing.
        let mut inside = all;
        for operand in operands(stretch.words, at) {
            let middle = scratch.toggles.all.len();
            let other = self.truth_along(stretch, operand, scratch, counters);
            inside = scratch.toggles.join(start, middle, [inside, other], all);
            if inside != all && scratch.toggles.all.len() == start {
                // Decided, whatever the rest.
                break;
            }
        }
        inside
    }

    fn face_along(
        &self,
        stretch: &Stretch<'_>,
        face: FaceId,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let side = &self.faces[face.0 as usize];
        let slot = self.roots(side.surface.0, stretch.line, scratch, counters);
        let Scratch { roots, toggles, .. } = scratch;
        let (ahead, negative) = slot.ahead(roots, stretch.span.start);
        for root in roots[ahead].iter().take_while(|r| r.s <= stretch.span.end) {
            toggles.all.push(Toggle {
                s: root.s,
                face,
                triangle: root.triangle,
            });
        }
        negative != side.inside_is_positive
    }
}

impl Toggles {
    /// Joins the operands with toggles from `start` and from `middle`, true or false before them,
    /// to one; returns its truth before its toggles.
    fn join(&mut self, start: usize, middle: usize, before: [bool; 2], all: bool) -> bool {
        let joined = |[a, b]: [bool; 2]| if all { a && b } else { a || b };
        let end = self.all.len();
        for (operand, len) in [(0, middle - start), (1, end - middle)] {
            if len > 0 {
                continue;
            }
            // One operand is constant: it decides, or the other is what there is.
            if before[operand] != all {
                self.all.truncate(start);
            }
            return joined(before);
        }
        self.merged.clear();
        let (a, b) = self.all[start..].split_at(middle - start);
        merge(a, b, before, joined, &mut self.merged);
        self.all.truncate(start);
        self.all.extend_from_slice(&self.merged);
        joined(before)
    }
}

/// The changes of `joined`, given those of two operands.
///
/// What happens at one parameter happens at once: there is a change only if the truth before and
/// after differ, and its face is the lowest of those that change the same way.
fn merge(
    a: &[Toggle],
    b: &[Toggle],
    mut truth: [bool; 2],
    joined: impl Fn([bool; 2]) -> bool,
    out: &mut Vec<Toggle>,
) {
    let (mut a, mut b) = (a.iter(), b.iter());
    while let Some(s) = match (a.as_slice().first(), b.as_slice().first()) {
        (Some(a), Some(b)) => Some(a.s.min(b.s)),
        (Some(one), None) | (None, Some(one)) => Some(one.s),
        (None, None) => None,
    } {
        let was = joined(truth);
        let mut changed: [Option<Toggle>; 2] = [None; 2];
        let mut pass = |operand: usize, rest: &mut std::slice::Iter<'_, Toggle>| {
            if let Some(first) = rest.as_slice().first().filter(|t| t.s == s) {
                truth[operand] = !truth[operand];
                changed[operand] = Some(*first);
                rest.next();
            }
        };
        pass(0, &mut a);
        pass(1, &mut b);
        let is = joined(truth);
        if is == was {
            continue;
        }
        let same_way = changed.into_iter().zip(truth).filter(|(_, t)| *t == is);
        let lowest = same_way.filter_map(|(toggle, _)| toggle);
        out.extend(lowest.min_by_key(|toggle| toggle.face));
    }
}
