//! Which edges of a region touch, cross or come too close to be told apart by their hulls.

use std::collections::{BTreeMap, BTreeSet};

use octray_math::DVec2;

use super::curve::Curve;
use super::pieces::{Piece, turn};

/// Pairs of edges that are compared at most.
const PAIR_LIMIT: usize = 1 << 27;
/// Rounds of halving curves whose hulls meet something.
const MAX_ROUNDS: u32 = 8;

/// A straight edge, or the straight line between the ends of a curve, or a part of one between
/// points at which other edges touch it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// Indices of points.
    pub(super) ends: [u32; 2],
    /// The piece it comes from.
    pub(super) piece: u32,
}

/// Pieces none of which cross, and their chords.
pub(super) struct Arrangement {
    pub(super) pieces: Vec<Piece>,
    pub(super) points: Vec<DVec2>,
    /// No two have the same ends: pairs that coincide bound nothing.
    pub(super) chords: Vec<Chord>,
}

/// Why a region is no arrangement.
enum Meeting {
    /// Edges cross, or there are too many of them.
    Crossing,
    /// The hulls of these curves meet something.
    Close(BTreeSet<usize>),
}

impl Arrangement {
    /// Halves curves until their hulls lie clear of everything else. `None` where edges cross or
    /// curves stay too close to something.
    pub(super) fn new(pieces: &[Piece]) -> Option<Self> {
        let mut pieces = without_doubles(pieces);
        let limit = 4 * pieces.len() + 1024;
        for _ in 0..=MAX_ROUNDS {
            match touches(&pieces, true) {
                Ok(touches) => return Some(Self::split(pieces, &touches)),
                Err(Meeting::Crossing) => return None,
                Err(Meeting::Close(curves)) => {
                    let halved = pieces.iter().enumerate().flat_map(|(i, piece)| {
                        let [a, b] = piece.halves();
                        if curves.contains(&i) {
                            [Some(a), Some(b)]
                        } else {
                            [Some(*piece), None]
                        }
                    });
                    pieces = halved.flatten().collect();
                    if pieces.len() > limit || pieces.iter().any(|p| p.start() == p.end()) {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// The boundary of the region as closed curves that may cross; straight edges that lie on each
    /// other are gone, as far as they do.
    pub(super) fn boundary(pieces: &[Piece]) -> Vec<Curve> {
        let pieces = without_doubles(pieces);
        let is_line = |piece: &&Piece| matches!(piece, Piece::Line(..));
        let lines: Vec<Piece> = pieces.iter().filter(is_line).copied().collect();
        let curves = pieces.iter().filter(|p| !is_line(p)).map(Piece::curve);
        match touches(&lines, false) {
            Ok(touches) => {
                let lines = Self::split(lines, &touches);
                let at = |i: u32| lines.points[i as usize];
                let chords = lines.chords.iter();
                let straight = chords.map(|c| Curve::line(at(c.ends[0]), at(c.ends[1])));
                curves.chain(straight).collect()
            }
            Err(_) => pieces.iter().map(Piece::curve).collect(),
        }
    }

    fn split(pieces: Vec<Piece>, touches: &[(usize, DVec2)]) -> Self {
        let mut points = Vec::new();
        let mut known = BTreeMap::new();
        let mut index = |p: DVec2| {
            *known
                .entry(p.to_array().map(f64::to_bits))
                .or_insert_with(|| {
                    points.push(p);
                    points.len() as u32 - 1
                })
        };
        let mut between: BTreeMap<usize, Vec<DVec2>> = BTreeMap::new();
        for (piece, p) in touches {
            between.entry(*piece).or_default().push(*p);
        }
        // How often each pair of points is joined; only an odd number counts.
        let mut joined: BTreeMap<[u32; 2], (bool, Chord)> = BTreeMap::new();
        for (i, piece) in pieces.iter().enumerate() {
            let mut stops = between.remove(&i).unwrap_or_default();
            let (a, b) = (piece.start(), piece.end());
            stops.sort_by(|p, q| (*p - a).dot(b - a).total_cmp(&(*q - a).dot(b - a)));
            stops.push(b);
            let mut from = index(a);
            for stop in stops {
                let to = index(stop);
                if from == to {
                    continue;
                }
                let chord = Chord {
                    ends: [from, to],
                    piece: i as u32,
                };
                let entry = joined.entry([from.min(to), from.max(to)]);
                entry.or_insert((false, chord)).0 ^= true;
                from = to;
            }
        }
        let odd = joined.into_values().filter(|(odd, _)| *odd);
        Self {
            chords: odd.map(|(_, chord)| chord).collect(),
            pieces,
            points,
        }
    }
}

/// The pieces less those that are there twice, in either direction: they bound nothing.
fn without_doubles(pieces: &[Piece]) -> Vec<Piece> {
    let mut count: BTreeMap<Vec<u64>, bool> = BTreeMap::new();
    let keys: Vec<Vec<u64>> = pieces
        .iter()
        .map(|piece| {
            let bits = |p: DVec2| p.to_array().map(f64::to_bits);
            let key: Vec<u64> = piece.curve().control().flat_map(bits).collect();
            let mut points: Vec<DVec2> = piece.curve().control().collect();
            points.reverse();
            key.min(points.into_iter().flat_map(bits).collect())
        })
        .collect();
    for key in &keys {
        *count.entry(key.clone()).or_insert(false) ^= true;
    }
    // The first of an odd number stays.
    let mut kept = Vec::with_capacity(pieces.len());
    for (piece, key) in pieces.iter().zip(&keys) {
        if let Some(is_odd) = count.get_mut(key)
            && std::mem::take(is_odd)
        {
            kept.push(*piece);
        }
    }
    kept
}

/// The points at which ends of some pieces touch the chords of others; it is an error that edges
/// cross if they `must_not`.
fn touches(pieces: &[Piece], must_not_cross: bool) -> Result<Vec<(usize, DVec2)>, Meeting> {
    let hulls: Vec<Vec<DVec2>> = pieces
        .iter()
        .map(|p| p.curve().control().collect())
        .collect();
    let boxes: Vec<[DVec2; 2]> = pieces.iter().map(|p| p.curve().bounds()).collect();
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&i, &j| boxes[i][0].x.total_cmp(&boxes[j][0].x).then(i.cmp(&j)));
    let mut touches = Vec::new();
    let mut close = BTreeSet::new();
    let mut pairs_left = PAIR_LIMIT;
    for (place, &i) in order.iter().enumerate() {
        for &j in &order[place + 1..] {
            if boxes[j][0].x > boxes[i][1].x {
                break;
            }
            pairs_left = pairs_left.checked_sub(1).ok_or(Meeting::Crossing)?;
            if boxes[j][0].y > boxes[i][1].y || boxes[i][0].y > boxes[j][1].y {
                continue;
            }
            let curved = [i, j].map(|k| !matches!(pieces[k], Piece::Line(..)));
            if curved != [false, false] && !hulls_apart(&hulls[i], &hulls[j]) {
                close.extend([i, j].into_iter().zip(curved).filter(|c| c.1).map(|c| c.0));
                continue;
            }
            let (a, b, c, d) = (
                pieces[i].start(),
                pieces[i].end(),
                pieces[j].start(),
                pieces[j].end(),
            );
            let [on_c, on_d] = [turn(a, b, c), turn(a, b, d)];
            let [on_a, on_b] = [turn(c, d, a), turn(c, d, b)];
            let opposite = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
            if must_not_cross && opposite(on_c, on_d) && opposite(on_a, on_b) {
                return Err(Meeting::Crossing);
            }
            for (sign, p, piece, ends) in [
                (on_c, c, i, [a, b]),
                (on_d, d, i, [a, b]),
                (on_a, a, j, [c, d]),
                (on_b, b, j, [c, d]),
            ] {
                if sign == 0.0 && lies_between(p, ends) {
                    touches.push((piece, p));
                }
            }
        }
    }
    if close.is_empty() {
        Ok(touches)
    } else {
        Err(Meeting::Close(close))
    }
}

/// Whether a point of the line through two others lies strictly between them.
fn lies_between(p: DVec2, [a, b]: [DVec2; 2]) -> bool {
    p != a && p != b && p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all()
}

/// Whether the hulls of two convex control polygons have no inner point in common: then a line
/// through a side of one of them has them on different sides.
fn hulls_apart(a: &[DVec2], b: &[DVec2]) -> bool {
    let separates = |from: DVec2, to: DVec2| {
        let signs = |points: &[DVec2]| {
            let turns = || points.iter().map(|p| turn(from, to, *p));
            (turns().any(|t| t > 0.0), turns().any(|t| t < 0.0))
        };
        let ((a_left, a_right), (b_left, b_right)) = (signs(a), signs(b));
        from != to
            && !(a_left && b_left)
            && !(a_right && b_right)
            && !(a_left && a_right)
            && !(b_left && b_right)
    };
    [a, b].into_iter().any(|hull| {
        let next = hull.iter().cycle().skip(1);
        hull.iter().zip(next).any(|(p, q)| separates(*p, *q))
    })
}
