//! Which solids of a leaf hold a point, and whose region it is in.

use super::leaf::{LeafObject, LeafView};
use super::{Scratch, Solids};
use crate::line::Line;
use crate::{Counters, Region};

impl Solids {
    /// The region, given which of the leaf's objects one is in.
    pub(super) fn region(&self, view: &LeafView<'_>, inside: &[bool]) -> Region {
        let solid = |(object, inside): (&LeafObject, &bool)| {
            (*inside && !self.ranked[object.rank as usize].shell).then_some(object.rank + 1)
        };
        let first = view.objects.iter().zip(inside).find_map(solid);
        let state = match (first, view.base) {
            (None, base) => base,
            (Some(rank), 0) => rank,
            (Some(rank), base) => rank.min(base),
        };
        self.region_of_state(state)
    }

    /// The region at `s` of the line, in a leaf that holds the point.
    pub(super) fn region_in(
        &self,
        line: &Line,
        view: &LeafView<'_>,
        s: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Region {
        self.place(view, line, s, scratch, counters, None);
        let Scratch {
            negative, inside, ..
        } = scratch;
        self.memberships(view, negative, inside);
        self.region(view, inside)
    }

    /// The ranks of the leaf's solids that hold the point at `s`, increasing.
    pub(super) fn solids_in(
        &self,
        line: &Line,
        view: &LeafView<'_>,
        s: f64,
        ranks: &mut Vec<u32>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        self.place(view, line, s, scratch, counters, None);
        let Scratch {
            negative, inside, ..
        } = scratch;
        self.memberships(view, negative, inside);
        let held = view.objects.iter().zip(inside.iter()).filter(|(_, i)| **i);
        ranks.extend(held.map(|(object, _)| object.rank));
        ranks.extend(view.base.checked_sub(1));
        ranks.retain(|&rank| !self.ranked[rank as usize].shell);
        ranks.sort_unstable();
    }
}
