//! Chords that do not cross, joined to simple polygons that are nested or apart.

use std::collections::BTreeMap;

use octray_math::DVec2;

use super::arrangement::Arrangement;
use super::pieces::turn;

/// A simple polygon, counter-clockwise.
#[derive(Clone, Debug)]
pub(super) struct Loop {
    pub(super) corners: Vec<DVec2>,
    /// The chord that leaves each corner, and whether it is traversed from its first end.
    pub(super) chords: Vec<(u32, bool)>,
    /// The smallest loop around it.
    pub(super) parent: Option<usize>,
    /// How many loops are around it.
    pub(super) depth: usize,
}

/// The loops of an arrangement, the outer ones first; `None` if its chords form none, which only
/// happens if there are none.
pub(super) fn trace(arrangement: &Arrangement) -> Vec<Loop> {
    let partner = partners(arrangement);
    let chords = &arrangement.chords;
    let mut used = vec![false; chords.len()];
    let mut loops = Vec::new();
    for first in 0..chords.len() {
        if used[first] {
            continue;
        }
        let mut path: Vec<(u32, bool)> = Vec::new();
        let (mut chord, mut forward) = (first, true);
        while !used[chord] {
            used[chord] = true;
            path.push((chord as u32, forward));
            let slot = partner[2 * chord + usize::from(forward)];
            (chord, forward) = (slot / 2, slot.is_multiple_of(2));
        }
        split_at_repeated_points(arrangement, path, &mut loops);
    }
    nest(&mut loops);
    loops
}

/// For every end of a chord (`2 chord + 0` or `1`) the end that follows it at the same point.
///
/// Where more than two chords meet, neighbours in angle are joined, so that no loop crosses another.
fn partners(arrangement: &Arrangement) -> Vec<usize> {
    let mut at_point: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, chord) in arrangement.chords.iter().enumerate() {
        for (k, end) in chord.ends.iter().enumerate() {
            at_point.entry(*end).or_default().push(2 * i + k);
        }
    }
    let mut partner = vec![0; 2 * arrangement.chords.len()];
    for (point, mut slots) in at_point {
        let center = arrangement.points[point as usize];
        let other = |slot: usize| {
            let ends = arrangement.chords[slot / 2].ends;
            arrangement.points[ends[1 - slot % 2] as usize]
        };
        if slots.len() > 2 {
            let upper = |p: DVec2| p.y > center.y || (p.y == center.y && p.x > center.x);
            slots.sort_by(|&i, &j| {
                let (p, q) = (other(i), other(j));
                let around = 0.0_f64.total_cmp(&turn(center, p, q));
                upper(q).cmp(&upper(p)).then(around)
            });
        }
        for pair in slots.chunks_exact(2) {
            partner[pair[0]] = pair[1];
            partner[pair[1]] = pair[0];
        }
    }
    partner
}

fn split_at_repeated_points(
    arrangement: &Arrangement,
    path: Vec<(u32, bool)>,
    loops: &mut Vec<Loop>,
) {
    let start = |&(chord, forward): &(u32, bool)| {
        arrangement.chords[chord as usize].ends[usize::from(!forward)]
    };
    let mut place: BTreeMap<u32, usize> = BTreeMap::new();
    let mut open: Vec<(u32, bool)> = Vec::new();
    for step in path {
        let point = start(&step);
        if let Some(&from) = place.get(&point) {
            let closed = open.split_off(from);
            for step in &closed {
                place.remove(&start(step));
            }
            loops.extend(oriented(arrangement, closed));
        }
        place.insert(point, open.len());
        open.push(step);
    }
    loops.extend(oriented(arrangement, open));
}

/// The loop of these chords, counter-clockwise.
fn oriented(arrangement: &Arrangement, mut chords: Vec<(u32, bool)>) -> Option<Loop> {
    if chords.len() < 3 {
        return None;
    }
    let start = |&(chord, forward): &(u32, bool)| {
        let ends = arrangement.chords[chord as usize].ends;
        arrangement.points[ends[usize::from(!forward)] as usize]
    };
    let mut corners: Vec<DVec2> = chords.iter().map(start).collect();
    let n = corners.len();
    let by_place = |&i: &usize, &j: &usize| {
        let (a, b) = (corners[i], corners[j]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    };
    let lowest = (0..n).min_by(by_place)?;
    let (before, after) = (corners[(lowest + n - 1) % n], corners[(lowest + 1) % n]);
    if turn(before, corners[lowest], after) < 0.0 {
        chords.reverse();
        for chord in &mut chords {
            chord.1 = !chord.1;
        }
        corners = chords.iter().map(start).collect();
    }
    Some(Loop {
        corners,
        chords,
        parent: None,
        depth: 0,
    })
}

/// Finds what surrounds what.
fn nest(loops: &mut [Loop]) {
    let bounds = |l: &Loop| {
        let fold = |f: fn(DVec2, DVec2) -> DVec2| l.corners.iter().copied().reduce(f);
        [fold(DVec2::min), fold(DVec2::max)].map(Option::unwrap_or_default)
    };
    let boxes: Vec<[DVec2; 2]> = loops.iter().map(bounds).collect();
    let around: Vec<Vec<usize>> = (0..loops.len())
        .map(|inner| {
            let wide = |outer: &usize| {
                *outer != inner
                    && boxes[*outer][0].cmple(boxes[inner][0]).all()
                    && boxes[*outer][1].cmpge(boxes[inner][1]).all()
                    && surrounds(&loops[*outer].corners, &loops[inner].corners)
            };
            (0..loops.len()).filter(wide).collect()
        })
        .collect();
    for (inner, around_inner) in around.iter().enumerate() {
        loops[inner].depth = around_inner.len();
        // The one that most others surround is the smallest.
        loops[inner].parent = around_inner
            .iter()
            .copied()
            .max_by_key(|outer| around[*outer].len());
    }
}

/// Whether a loop lies in another that it does not cross.
fn surrounds(outer: &[DVec2], inner: &[DVec2]) -> bool {
    let next = |path: &[DVec2], i: usize| path[(i + 1) % path.len()];
    let middles = (0..inner.len()).map(|i| (inner[i] + next(inner, i)) * 0.5);
    for p in inner.iter().copied().chain(middles) {
        let mut inside = false;
        let mut touches = false;
        for (i, &a) in outer.iter().enumerate() {
            let b = next(outer, i);
            let spans = (a.y > p.y) != (b.y > p.y);
            if !spans && (p.y < a.y.min(b.y) || p.y > a.y.max(b.y)) {
                continue;
            }
            let side = turn(a, b, p);
            let within = p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all();
            touches |= side == 0.0 && within;
            inside ^= spans && (side > 0.0) == (b.y > a.y);
        }
        // A point on the outline says nothing.
        if !touches {
            return inside;
        }
    }
    false
}
