//! References to be divided in two.

use rayon::prelude::*;

use super::divide::Division;
use super::reference::{PaddedBox, Reference};

/// References that lie together in the array, and how they are to be divided.
#[derive(Debug)]
pub(super) struct Piece<'a> {
    /// The references, and room for more behind them.
    slots: &'a mut [Reference],
    count: usize,
    /// Morton codes of the references, which are sorted by them; empty where they are divided by
    /// cost.
    codes: &'a [u64],
    /// Around the references and around twice their centres; not kept while there are codes.
    extent: Extent,
}

/// Where references lie.
#[derive(Clone, Copy, Debug)]
struct Extent {
    bounds: PaddedBox,
    centers: PaddedBox,
}

/// From so many references on, threads share the work of looking at them.
const SHARED: usize = 1 << 16;
/// How much a thread looks at in one go.
const SHARE: usize = 1 << 12;

impl Extent {
    const EMPTY: Self = Self {
        bounds: PaddedBox::EMPTY,
        centers: PaddedBox::EMPTY,
    };

    fn of(references: &[Reference]) -> Self {
        let around = |part: &[Reference]| {
            part.iter().fold(Self::EMPTY, |mut extent, r| {
                extent.include(r);
                extent
            })
        };
        if references.len() < SHARED {
            return around(references);
        }
        let parts = references.par_chunks(SHARE).map(around);
        parts.reduce(
            || Self::EMPTY,
            |a, b| Self {
                bounds: a.bounds.union(&b.bounds),
                centers: a.centers.union(&b.centers),
            },
        )
    }

    #[inline(always)]
    fn include(&mut self, r: &Reference) {
        self.bounds = self.bounds.union(&r.0);
        self.centers = self.centers.including(r.0.center());
    }
}

const BINS: usize = 16;
/// Fewer than this are put into half as many bins.
const FEW: usize = 24;

/// Where the boxes of two halves overlap by no more than this share, nothing is cut in two.
const MUCH: f32 = 1.0 / 16.0;

#[derive(Clone)]
struct Bins {
    boxes: [[PaddedBox; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

/// Which bin a centre belongs to.
#[derive(Clone, Copy, Debug)]
struct Binning {
    count: usize,
    start: [f32; 4],
    per_unit: [f32; 4],
}

/// A plane between two bins of an axis.
#[derive(Clone, Copy, Debug)]
struct Plane {
    axis: usize,
    bin: usize,
}

impl Binning {
    fn new(centers: &PaddedBox, count: usize) -> Self {
        let size = centers.size();
        // A little less, so that the last centre falls into the last bin.
        let bins = count as f32 * (1.0 - 1.0 / (1 << 20) as f32);
        Self {
            count,
            start: centers.min,
            per_unit: size.map(|size| bins / size),
        }
    }

    /// Infinities (of sizes near zero) land in the last bin, NaN in the first.
    #[inline(always)]
    fn bin(&self, center: [f32; 4], axis: usize) -> usize {
        let x = (center[axis] - self.start[axis]) * self.per_unit[axis];
        (x as i32 as usize).min(self.count - 1)
    }
}

impl Bins {
    const EMPTY: Self = Self {
        boxes: [[PaddedBox::EMPTY; BINS]; 3],
        counts: [[0; BINS]; 3],
    };

    fn of(references: &[Reference], binning: &Binning) -> Self {
        let fill = |part: &[Reference]| {
            let mut bins = Self::EMPTY;
            for r in part {
                let center = r.0.center();
                for axis in 0..3 {
                    let bin = binning.bin(center, axis) & (BINS - 1);
                    bins.boxes[axis][bin] = bins.boxes[axis][bin].union(&r.0);
                    bins.counts[axis][bin] += 1;
                }
            }
            bins
        };
        if references.len() < SHARED {
            return fill(references);
        }
        let parts = references.par_chunks(SHARE).map(fill);
        parts.reduce(
            || Self::EMPTY,
            |mut a, b| {
                for axis in 0..3 {
                    for bin in 0..BINS {
                        a.boxes[axis][bin] = a.boxes[axis][bin].union(&b.boxes[axis][bin]);
                        a.counts[axis][bin] += b.counts[axis][bin];
                    }
                }
                a
            },
        )
    }

    /// How far the boxes below and above a plane reach past each other, as a share of both.
    fn overlap(&self, plane: Plane, bins: usize) -> f32 {
        let Plane { axis, bin } = plane;
        let around = |boxes: &[PaddedBox]| {
            let all = boxes.iter();
            all.fold(PaddedBox::EMPTY, |all, bounds| all.union(bounds))
        };
        let boxes = &self.boxes[axis];
        let (low, high) = (around(&boxes[..bin]), around(&boxes[bin..bins]));
        let size = low.union(&high).size()[axis];
        (low.max[axis] - high.min[axis]) / size
    }

    /// The plane of least cost with references on both sides.
    fn best(&self, bins: usize) -> Option<(Plane, f32)> {
        let mut best: Option<(Plane, f32)> = None;
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            let mut after = [0.0; BINS];
            let (mut bounds, mut count) = (PaddedBox::EMPTY, 0);
            for bin in (1..bins).rev() {
                bounds = bounds.union(&boxes[bin]);
                count += counts[bin];
                after[bin] = if count == 0 {
                    f32::INFINITY
                } else {
                    bounds.half_area() * count as f32
                };
            }
            (bounds, count) = (PaddedBox::EMPTY, 0);
            for bin in 1..bins {
                bounds = bounds.union(&boxes[bin - 1]);
                count += counts[bin - 1];
                if count == 0 {
                    continue;
                }
                let cost = bounds.half_area() * count as f32 + after[bin];
                if best.map_or(cost < f32::INFINITY, |(_, least)| cost < least) {
                    best = Some((Plane { axis, bin }, cost));
                }
            }
        }
        best
    }
}

impl<'a> Piece<'a> {
    /// The first `count` of the slots are references; `codes` are theirs, or none.
    pub(super) fn new(slots: &'a mut [Reference], count: usize, codes: &'a [u64]) -> Self {
        let extent = if codes.is_empty() {
            Extent::of(&slots[..count])
        } else {
            Extent::EMPTY
        };
        Self {
            slots,
            count,
            codes,
            extent,
        }
    }

    /// The most references that there can be, whatever is cut.
    pub(super) const fn slots(&self) -> usize {
        self.slots.len()
    }

    pub(super) fn references(&self) -> &[Reference] {
        &self.slots[..self.count]
    }

    /// Two pieces of at least one reference each, neither of more than `most`; there are at least
    /// two references, and not more than twice `most`.
    pub(super) fn split(mut self, most: usize, division: Option<&Division<'_>>) -> [Self; 2] {
        let count = self.count;
        let fits = |middle: usize| middle.max(count - middle) <= most;
        if let [first, .., last] = *self.codes {
            if first != last {
                let bit = 1u64 << (first ^ last).ilog2();
                let middle = self.codes.partition_point(|code| code & bit == 0);
                if fits(middle) {
                    return self.parted(middle, [Extent::EMPTY; 2], None);
                }
            }
            // Centres in one cell of the finest grid: boxes may still tell them apart.
            self.codes = &[];
            self.extent = Extent::of(self.references());
        }
        // Where nothing can be cut any more, room is no use.
        let division = division
            .filter(|division| count < self.slots.len() && division.may_cut(&self.extent.bounds));
        if count > 2 {
            let bins = if count < FEW { BINS / 2 } else { BINS };
            let binning = Binning::new(&self.extent.centers, bins);
            let filled = Bins::of(self.references(), &binning);
            let plane = filled.best(bins);
            if let Some(division) = division
                && 2 * count <= most
                && plane.is_none_or(|(plane, _)| filled.overlap(plane, bins) > MUCH)
                && let Some(cut) = division.best(self.references(), &self.extent.bounds)
                && plane.is_none_or(|(_, cost)| cut.cost < cost)
            {
                let (middle, added) = division.cut(self.slots, count, cut);
                if middle > 0 && middle < count + added.len() {
                    return self.grown(middle, &added, division);
                }
            }
            if let Some((plane, _)) = plane {
                let (middle, extents) = self.partition(plane, &binning);
                if fits(middle) {
                    return self.parted(middle, extents, division);
                }
            }
        }
        let middle = count / 2;
        let (low, high) = self.references().split_at(middle);
        let extents = [Extent::of(low), Extent::of(high)];
        self.parted(middle, extents, division)
    }

    /// Parts the references after so many.
    fn parted(
        mut self,
        middle: usize,
        extents: [Extent; 2],
        division: Option<&Division<'_>>,
    ) -> [Self; 2] {
        let room = self.room_below(middle, &[], division);
        self.make_room(middle, room);
        let (low, high) = self.slots.split_at_mut(middle + room);
        let (low_codes, high_codes) = self.codes.split_at(middle.min(self.codes.len()));
        let pieces = [
            (low, middle, low_codes),
            (high, self.count - middle, high_codes),
        ];
        let mut extents = extents.into_iter();
        pieces.map(|(slots, count, codes)| {
            let extent = extents.next().unwrap_or(Extent::EMPTY);
            // Where nothing can be cut, slots end where references do.
            let end = if division.is_some() {
                slots.len()
            } else {
                count
            };
            Piece {
                slots: &mut slots[..end],
                count,
                codes,
                extent,
            }
        })
    }

    /// Parts the references after so many, with more at the end.
    fn grown(mut self, middle: usize, added: &[Reference], division: &Division<'_>) -> [Self; 2] {
        let room = self.room_below(middle, added, Some(division));
        self.make_room(middle, room);
        let (low, high) = self.slots.split_at_mut(middle + room);
        let kept = self.count - middle;
        high[kept..kept + added.len()].copy_from_slice(added);
        [(low, middle), (high, kept + added.len())]
            .map(|(slots, count)| Piece::new(slots, count, &[]))
    }

    /// How much of the room behind the references the first of them should have.
    fn room_below(
        &self,
        middle: usize,
        added: &[Reference],
        division: Option<&Division<'_>>,
    ) -> usize {
        let room = self.slots.len() - self.count - added.len();
        let Some(division) = division.filter(|_| room > 0) else {
            return 0;
        };
        let (low, high) = self.references().split_at(middle);
        let high = division.weight(high) + division.weight(added);
        let low = division.weight(low);
        if low > 0.0 {
            (room as f64 * (low / (low + high))) as usize
        } else {
            0
        }
    }

    /// Moves the references from `middle` on back by so much.
    fn make_room(&mut self, middle: usize, room: usize) {
        // Their order is no matter, so only as many are moved as must be.
        let moved = room.min(self.count - middle);
        self.slots
            .copy_within(middle..middle + moved, self.count + room - moved);
    }

    /// Moves what lies below the plane to the front; returns how much that is.
    fn partition(&mut self, plane: Plane, binning: &Binning) -> (usize, [Extent; 2]) {
        let is_low = |r: &Reference| binning.bin(r.0.center(), plane.axis) < plane.bin;
        let [mut low, mut high] = [Extent::EMPTY; 2];
        let references = &mut self.slots[..self.count];
        let (mut start, mut end) = (0, references.len());
        loop {
            while start < end && is_low(&references[start]) {
                low.include(&references[start]);
                start += 1;
            }
            while start < end && !is_low(&references[end - 1]) {
                end -= 1;
                high.include(&references[end]);
            }
            if start == end {
                return (start, [low, high]);
            }
            references.swap(start, end - 1);
        }
    }
}
