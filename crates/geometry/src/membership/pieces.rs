//! The temporary triangulation, or the cover, of all operands of a scene. It is there while an octree is
//! built, and counts the bytes it takes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use octray_math::Aabb;
use rayon::prelude::*;

use super::Membership;
use super::shells::{ShellPatch, StepCounts, cover, shells};
use crate::csg::Operand;

/// How fine the pieces are, and how many there may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// What is divided into cells: boundaries are cut off there.
    pub within: Aabb,
    /// Bytes for all pieces: where they do not suffice, pieces become larger. (Every operand has a few.)
    pub memory_limit: u64,
}

/// Shells are this share of their operand's size apart, and boxes of a cover that long.
///
/// Measured on one primitive of every kind, all cells divided to depth 6, where the analytic test marks
/// 29,490 pairs of a cell and an operand:
///
/// | shells | marks | MB | | cover | marks | MB |
/// |---|---:|---:|---|---|---:|---:|
/// | 1/32 | 38,479 | 1.7 | | 1/4 | 271,193 | 0.1 |
/// | 1/64 | 33,806 | 2.6 | | 1/8 | 151,317 | 0.6 |
/// | 1/128 | 29,514 | 3.0 | | 1/16 | 90,360 | 1.2 |
/// | 1/256 | 29,295 | 3.7 | | 1/32 | 58,028 | 3.0 |
const CHORD_SHARE: f64 = 1.0 / 128.0;
const COVER_SHARE: f64 = 1.0 / 32.0;
/// Nothing is followed below this share of what is divided.
const LEAST_SHARE: f64 = 1.0 / 16384.0;
/// An operand has no more pieces than this, so that one of many parts cannot take all memory.
const MOST: usize = 1 << 14;

/// What holds the pieces' bytes for as long as there are pieces.
#[derive(Debug)]
pub struct LiveBytes {
    bytes: u64,
    gauge: Arc<AtomicU64>,
}

impl LiveBytes {
    fn new(bytes: u64, gauge: &Arc<AtomicU64>) -> Self {
        gauge.fetch_add(bytes, Ordering::Relaxed);
        let gauge = Arc::clone(gauge);
        Self { bytes, gauge }
    }
}

impl Drop for LiveBytes {
    fn drop(&mut self) {
        self.gauge.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// Pieces of the boundaries of all operands.
#[derive(Debug)]
pub(super) struct Pieces {
    shapes: Shapes,
    /// The pieces of operand `i` are those from `first[i]` to before `first[i + 1]`.
    first: Vec<u32>,
    /// The coarsest operand's.
    pub(super) chord_error: f64,
    live: LiveBytes,
    /// How the questions were decided. Sums do not depend on the order of threads.
    steps: [AtomicU64; 5],
}

#[derive(Debug)]
enum Shapes {
    Boxes(Vec<Aabb>),
    Patches(Vec<(Aabb, ShellPatch)>),
}

impl Pieces {
    /// `None` for membership tests that need no pieces. Works inside the current thread pool; the result
    /// does not depend on it.
    pub(super) fn new(
        operands: &[Operand],
        membership: Membership,
        slack: f64,
        fineness: &Fineness,
        gauge: &Arc<AtomicU64>,
    ) -> Option<Self> {
        let within = fineness.within.inflated(slack);
        let least = LEAST_SHARE * within.diagonal();
        let size = |operand: &Operand| {
            let bounds = operand.primitive.bounds();
            let there = if bounds.is_bounded() {
                bounds.transformed(&operand.scene_from_local)
            } else {
                within
            };
            there.intersection(within).diagonal()
        };
        let share = |bytes: usize| {
            let pieces = fineness.memory_limit / bytes as u64 / operands.len().max(1) as u64;
            usize::try_from(pieces).unwrap_or(MOST).min(MOST)
        };
        let mut first = Vec::with_capacity(operands.len() + 1);
        first.push(0);
        let mut chord_error: f64 = 0.0;
        let shapes = match membership {
            Membership::BoundingCover => {
                let limit = share(size_of::<Aabb>());
                let of = |operand: &Operand| {
                    let (primitive, place) = (&operand.primitive, &operand.scene_from_local);
                    let size = (COVER_SHARE * size(operand)).max(least);
                    cover(primitive, place, &within, size, limit)
                };
                let all: Vec<Vec<Aabb>> = operands.par_iter().map(of).collect();
                let mut boxes = Vec::with_capacity(all.iter().map(Vec::len).sum());
                for own in all {
                    boxes.extend(own.iter().map(|b| b.inflated(slack)));
                    first.push(boxes.len() as u32);
                }
                Shapes::Boxes(boxes)
            }
            Membership::Shells => {
                let limit = share(size_of::<(Aabb, ShellPatch)>());
                let of = |operand: &Operand| {
                    let (primitive, place) = (&operand.primitive, &operand.scene_from_local);
                    let error = (CHORD_SHARE * size(operand)).max(least);
                    shells(primitive, place, &within, error, limit)
                };
                let all: Vec<_> = operands.par_iter().map(of).collect();
                let mut patches = Vec::with_capacity(all.iter().map(|s| s.patches.len()).sum());
                for own in all {
                    chord_error = chord_error.max(own.chord_error);
                    patches.extend(own.patches.into_iter().map(|p| (p.bounds(), p)));
                    first.push(patches.len() as u32);
                }
                Shapes::Patches(patches)
            }
            Membership::Analytic | Membership::BoundingBox | Membership::BoundingSphere => {
                return None;
            }
        };
        let bytes = match &shapes {
            Shapes::Boxes(boxes) => size_of_val(boxes.as_slice()),
            Shapes::Patches(patches) => size_of_val(patches.as_slice()),
        } + size_of_val(first.as_slice());
        Some(Self {
            shapes,
            first,
            chord_error,
            live: LiveBytes::new(bytes as u64, gauge),
            steps: Default::default(),
        })
    }

    /// How many there are.
    pub(super) fn len(&self) -> u64 {
        u64::from(self.first.last().copied().unwrap_or(0))
    }

    pub(super) const fn bytes(&self) -> u64 {
        self.live.bytes
    }

    /// What has decided so far.
    pub(super) fn steps(&self) -> StepCounts {
        let [vertex, face, edge, diagonal, between] =
            [0, 1, 2, 3, 4].map(|step: usize| self.steps[step].load(Ordering::Relaxed));
        StepCounts {
            vertex,
            face,
            edge,
            diagonal,
            between,
        }
    }

    /// All pieces of these operands, operand by operand.
    pub(super) fn of(&self, operands: &[u32]) -> Vec<u32> {
        let range = |&o: &u32| self.first[o as usize]..self.first[o as usize + 1];
        operands.iter().flat_map(range).collect()
    }

    /// Keeps the pieces of these operands (increasing, like the pieces).
    pub(super) fn keep_those_of(&self, pieces: &mut Vec<u32>, operands: &[u32]) {
        let mut of = operands.iter().copied().peekable();
        pieces.retain(|&piece| {
            while of
                .peek()
                .is_some_and(|&o| self.first[o as usize + 1] <= piece)
            {
                of.next();
            }
            of.peek().is_some_and(|&o| self.first[o as usize] <= piece)
        });
    }

    /// Of these operands and their pieces, those that may meet the cell.
    pub(super) fn touching(
        &self,
        operands: &[u32],
        pieces: &[u32],
        cell: &Aabb,
        slack: f64,
    ) -> (Vec<u32>, Vec<u32>) {
        let mut counts = StepCounts::default();
        let grown = cell.inflated(slack);
        let mut meets = |piece: u32| match &self.shapes {
            Shapes::Boxes(boxes) => boxes[piece as usize].overlaps(cell),
            Shapes::Patches(patches) => {
                let (bounds, patch) = &patches[piece as usize];
                bounds.overlaps(&grown) && patch.meets(&grown, &mut counts)
            }
        };
        let mut touched = Vec::new();
        let mut met = Vec::new();
        let mut rest = pieces.iter().copied().peekable();
        for &operand in operands {
            let [start, end] = [0, 1].map(|i| self.first[operand as usize + i]);
            while rest.next_if(|&piece| piece < start).is_some() {}
            let before = met.len();
            while let Some(piece) = rest.next_if(|&piece| piece < end) {
                if meets(piece) {
                    met.push(piece);
                }
            }
            if met.len() > before {
                touched.push(operand);
            }
        }
        let StepCounts {
            vertex,
            face,
            edge,
            diagonal,
            between,
        } = counts;
        for (sum, more) in self
            .steps
            .iter()
            .zip([vertex, face, edge, diagonal, between])
        {
            sum.fetch_add(more, Ordering::Relaxed);
        }
        (touched, met)
    }
}
