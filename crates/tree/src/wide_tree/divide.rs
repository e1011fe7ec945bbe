//! Large references cut in two.
//!
//! A long triangle that runs askew has a box that is empty for the most part, and no tree of such
//! boxes is any good. So a large reference that straddles the middle of a piece may be divided
//! there: the item then stands on both sides, each time with the box of what it has there (Stich,
//! Friedrich & Dietrich 2009). It is done where it lowers the cost of the piece, and as long as
//! there is room for more references.

use octray_math::{Aabb, DVec3};

use super::items::{Coordinates, Items};
use super::reference::{PaddedBox, Reference};

/// References with a smaller share than this of the surface of the tree are not divided.
const LARGE: f32 = 1e-3;
/// So many references for each item may be added.
const ADDED: f64 = 0.3;

/// Boxes around what an item has in a box below and above a plane across each axis.
type Halves<'a> = dyn Fn(u32, &Aabb, DVec3) -> [[Aabb; 2]; 3] + Sync + 'a;

/// How references are divided.
pub(super) struct Division<'a> {
    halves: Box<Halves<'a>>,
    /// Half the surface from which on a reference is large.
    large: f32,
}

/// A way to divide a piece at its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    axis: usize,
    plane: f32,
    sides: [Side; 2],
    pub(super) cost: f32,
}

/// What lies on one side.
#[derive(Clone, Copy, Debug)]
struct Side {
    bounds: PaddedBox,
    count: u32,
}

/// What becomes of a reference.
enum Fate {
    Low,
    High,
    Both([Reference; 2]),
}

impl std::fmt::Debug for Division<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Division")
            .field("large", &self.large)
            .finish_non_exhaustive()
    }
}

impl Side {
    const EMPTY: Self = Self {
        bounds: PaddedBox::EMPTY,
        count: 0,
    };

    fn add(&mut self, bounds: &PaddedBox) {
        self.bounds = self.bounds.union(bounds);
        self.count += 1;
    }

    fn cost(&self) -> f32 {
        self.bounds.half_area() * self.count as f32
    }
}

impl<'a> Division<'a> {
    /// For items in coordinates that begin with a root of these bounds.
    pub(super) fn new<I: Items + ?Sized>(
        items: &'a I,
        coordinates: Coordinates,
        root: &PaddedBox,
    ) -> Self {
        Self {
            halves: Box::new(move |item, within, planes| {
                items.halves(item, &coordinates, within, planes)
            }),
            large: root.half_area() * LARGE,
        }
    }

    /// How much of a piece's room for more references a part with these should have; 0 for none.
    pub(super) fn weight(&self, references: &[Reference]) -> f64 {
        let areas = references.iter().map(|r| r.0.half_area());
        areas.filter(|&area| area > self.large).map(f64::from).sum()
    }

    /// The most references that may be added to these.
    pub(super) fn room(&self, references: &[Reference]) -> usize {
        // Cut until none is large, most would have been cut about this often.
        let cuts = self.weight(references) / f64::from(self.large);
        let most = references.len() as f64 * ADDED;
        cuts.min(most) as usize
    }

    /// Whether any reference of so large a piece could be divided.
    pub(super) fn may_cut(&self, bounds: &PaddedBox) -> bool {
        bounds.half_area() > self.large
    }

    /// The best cut at the middle of the piece.
    pub(super) fn best(&self, references: &[Reference], bounds: &PaddedBox) -> Option<Cut> {
        let planes: [f32; 3] = std::array::from_fn(|axis| middle(bounds, axis));
        let mut sides = [[Side::EMPTY; 2]; 3];
        let mut any = [false; 3];
        for r in references {
            let mut halves = None;
            for axis in 0..3 {
                let plane = planes[axis];
                if !self.is_cut(r, axis, plane) {
                    sides[axis][usize::from(is_high(r, axis, plane))].add(&r.0);
                    continue;
                }
                let halves = halves.get_or_insert_with(|| self.halves(r, planes));
                let parts = [false, true].map(|high| part(r, &halves[axis], axis, plane, high));
                for (side, part) in sides[axis].iter_mut().zip(parts) {
                    if let Some(part) = part {
                        side.add(&part.0);
                    }
                }
                any[axis] = true;
            }
        }
        let mut best: Option<Cut> = None;
        for axis in 0..3 {
            let cost = sides[axis][0].cost() + sides[axis][1].cost();
            let both = sides[axis].iter().all(|side| side.count > 0);
            if any[axis] && both && best.is_none_or(|best| cost < best.cost) {
                best = Some(Cut {
                    axis,
                    plane: planes[axis],
                    sides: sides[axis],
                    cost,
                });
            }
        }
        best
    }

    /// Carries out a cut of the first `count` references: moves what is low to the front, and
    /// returns how many those are and the references to be added to the high ones, at most as many
    /// as there is room behind.
    pub(super) fn cut(
        &self,
        references: &mut [Reference],
        count: usize,
        cut: Cut,
    ) -> (usize, Vec<Reference>) {
        let mut room = references.len() - count;
        let mut added = Vec::new();
        let mut sides = cut.sides;
        let (mut start, mut end) = (0, count);
        while start < end {
            let r = references[start];
            match self.fate(&r, &cut, &mut sides, room) {
                Fate::Low => start += 1,
                Fate::High => {
                    end -= 1;
                    references.swap(start, end);
                }
                Fate::Both([low, high]) => {
                    references[start] = low;
                    added.push(high);
                    room -= 1;
                    start += 1;
                }
            }
        }
        (start, added)
    }

    /// A large reference is divided only where standing on one side would not cost less.
    fn fate(&self, r: &Reference, cut: &Cut, sides: &mut [Side; 2], room: usize) -> Fate {
        let &Cut { axis, plane, .. } = cut;
        let whole = |high| if high { Fate::High } else { Fate::Low };
        if room == 0 || !self.is_cut(r, axis, plane) {
            return whole(is_high(r, axis, plane));
        }
        let halves = self.halves(r, [plane; 3])[axis];
        let parts = [false, true].map(|high| part(r, &halves, axis, plane, high));
        let [Some(low), Some(high)] = parts else {
            return whole(parts[1].is_some() || (parts[0].is_none() && is_high(r, axis, plane)));
        };
        let alone = |to: usize| {
            let mut sides = *sides;
            sides[to].bounds = sides[to].bounds.union(&r.0);
            sides[1 - to].count = sides[1 - to].count.saturating_sub(1);
            sides
        };
        let cost = |sides: &[Side; 2]| sides[0].cost() + sides[1].cost();
        let (both, [in_low, in_high]) = (cost(sides), [alone(0), alone(1)]);
        let (low_cost, high_cost) = (cost(&in_low), cost(&in_high));
        if both <= low_cost.min(high_cost) {
            return Fate::Both([low, high]);
        }
        let to_high = high_cost < low_cost;
        *sides = if to_high { in_high } else { in_low };
        whole(to_high)
    }

    /// Whether a reference is large and lies on both sides of the plane.
    fn is_cut(&self, r: &Reference, axis: usize, plane: f32) -> bool {
        r.0.min[axis] < plane && plane < r.0.max[axis] && r.0.half_area() > self.large
    }

    fn halves(&self, r: &Reference, planes: [f32; 3]) -> [[Aabb; 2]; 3] {
        let corner = |[x, y, z, _]: [f32; 4]| DVec3::new(x.into(), y.into(), z.into());
        let within = Aabb::new(corner(r.0.min), corner(r.0.max));
        (self.halves)(r.item(), &within, DVec3::from_array(planes.map(f64::from)))
    }
}

fn middle(bounds: &PaddedBox, axis: usize) -> f32 {
    0.5 * (bounds.min[axis] + bounds.max[axis])
}

/// On which side a whole reference stands.
fn is_high(r: &Reference, axis: usize, plane: f32) -> bool {
    r.0.center()[axis] >= 2.0 * plane
}

/// The reference to one half of an item, `None` if there is nothing of it.
fn part(
    r: &Reference,
    halves: &[Aabb; 2],
    axis: usize,
    plane: f32,
    high: bool,
) -> Option<Reference> {
    let half = &halves[usize::from(high)];
    if half.is_empty() {
        return None;
    }
    let mut bounds = PaddedBox::rounded(half.min.to_array(), half.max.to_array());
    if high {
        bounds.min[axis] = bounds.min[axis].max(plane);
    } else {
        bounds.max[axis] = bounds.max[axis].min(plane);
    }
    for axis in 0..3 {
        bounds.min[axis] = bounds.min[axis].max(r.0.min[axis]);
        bounds.max[axis] = bounds.max[axis].min(r.0.max[axis]);
        if bounds.min[axis] > bounds.max[axis] {
            return None;
        }
    }
    Some(Reference::new(bounds, r.item()))
}
