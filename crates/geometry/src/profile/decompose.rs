//! A region as a formula over half-planes and convex curves.
//!
//! Straight edges and the chords of curved ones form polygons ([`super::chain`]); what lies
//! between a curve and its chord is added or taken away. So every edge is a side of its own: an
//! octree cell keeps only those that pass through it, and those that coincide with another solid's
//! surface are one with it.

use octray_math::DVec2;

use super::arrangement::Arrangement;
use super::chain;
use super::contour::Contour;
use super::curve::Curve;
use super::formula::{Formula, MAX_FORMULA_DEPTH};
use super::loops::{self, Loop};
use super::pieces::{Piece, turn};
use super::region::Region;

/// One side of a region's formula.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PlaneSide {
    /// Inside is left of the line from the first point to the second.
    Line(DVec2, DVec2),
    /// Inside is the disc about the centre whose rim passes through the point.
    Disc(DVec2, DVec2),
    /// Inside is a contour.
    Contour(Contour),
}

/// A region's sides and the formula over them.
pub(crate) struct Decomposition {
    pub(crate) sides: Vec<PlaneSide>,
    pub(crate) formula: Formula,
}

/// What the solid wants of its sides.
#[derive(Clone, Copy)]
pub(crate) struct Wishes {
    /// Contours may not reach below this abscissa.
    pub(crate) least_x: f64,
    /// Whether an arc becomes a disc rather than a contour.
    pub(crate) takes_disc: fn(&Piece) -> bool,
}

impl Decomposition {
    pub(crate) fn new(region: &Region, wishes: Wishes) -> Self {
        Self::by_chords(region, wishes).unwrap_or_else(|| {
            let curves = Arrangement::boundary(&region.pieces);
            Self {
                sides: vec![PlaneSide::Contour(Contour::new(curves, None))],
                formula: Formula::inside(0),
            }
        })
    }

    /// `None` where edges cross, curves meet or the outline is too intricate.
    fn by_chords(region: &Region, wishes: Wishes) -> Option<Self> {
        let arrangement = Arrangement::new(&region.pieces)?;
        let loops = loops::trace(&arrangement);
        let mut maker = Maker {
            arrangement: &arrangement,
            wishes,
            sides: Vec::new(),
            line_of: vec![None; arrangement.pieces.len()],
            has_loop: vec![false; arrangement.pieces.len()],
        };
        let formula = maker.region(&loops)?;
        (formula.depth() <= MAX_FORMULA_DEPTH).then_some(Self {
            sides: maker.sides,
            formula,
        })
    }
}

struct Maker<'a> {
    arrangement: &'a Arrangement,
    wishes: Wishes,
    sides: Vec<PlaneSide>,
    /// The side of each piece's chord.
    line_of: Vec<Option<u32>>,
    /// Whether the chord of a piece, or a part of it, is an edge of a loop.
    has_loop: Vec<bool>,
}

impl Maker<'_> {
    fn region(&mut self, loops: &[Loop]) -> Option<Formula> {
        let mut own = Vec::with_capacity(loops.len());
        let mut polygons = Vec::with_capacity(loops.len());
        for each in loops {
            let (polygon, curved) = self.within(each)?;
            polygons.push(polygon);
            own.push(curved);
        }
        let chords = nested(loops, polygons);
        let mut formula = nested(loops, own);
        // Curves whose chords bound nothing: two arcs that make a lens, an arc on its own chord.
        for (i, piece) in self.arrangement.pieces.iter().enumerate() {
            if self.has_loop[i] || matches!(piece, Piece::Line(..)) {
                continue;
            }
            let middle = piece.curve().at(0.5);
            let is_within = chords.evaluate(&|side| match &self.sides[side as usize] {
                PlaneSide::Line(a, b) => turn(*a, *b, middle) > 0.0,
                _ => false,
            });
            let segment = self.segment(i);
            formula = if is_within {
                Formula::all([formula, segment.complement()])
            } else {
                Formula::any([formula, segment])
            };
        }
        Some(formula)
    }

    /// The polygon of a loop's chords, and the same with its curves.
    fn within(&mut self, each: &Loop) -> Option<(Formula, Formula)> {
        let mut lefts = Vec::with_capacity(each.chords.len());
        let mut bulges = Vec::new();
        let mut dents = Vec::new();
        for &(chord, forward) in &each.chords {
            let chord = self.arrangement.chords[chord as usize];
            let piece = chord.piece as usize;
            // The chord may run against its piece where it was found first in another one.
            let ends = chord.ends.map(|end| self.arrangement.points[end as usize]);
            let source = &self.arrangement.pieces[piece];
            let (a, b) = (source.start(), source.end());
            let along = ((ends[1] - ends[0]).dot(b - a) > 0.0) == forward;
            lefts.push(Formula::Side {
                side: self.line(piece),
                inside: along,
            });
            if !matches!(source, Piece::Line(..)) && !self.has_loop[piece] {
                if curves_left(source) == along {
                    dents.push(piece);
                } else {
                    bulges.push(piece);
                }
            }
            self.has_loop[piece] = true;
        }
        let mut lid = |a: DVec2, b: DVec2| self.side(PlaneSide::Line(a, b));
        let polygon = chain::polygon(&each.corners, &lefts, &mut lid)?;
        if dents.is_empty()
            && bulges.len() == each.chords.len()
            && let Some(disc) = self.whole_disc(&bulges)
        {
            return Some((polygon, disc));
        }
        let mut parts = vec![polygon.clone()];
        for piece in dents {
            parts.push(self.segment(piece).complement());
        }
        let mut all = vec![Formula::all(parts)];
        for piece in bulges {
            all.push(self.segment(piece));
        }
        Some((polygon, Formula::any(all)))
    }

    /// The disc that these pieces bound, if they are arcs of one circle.
    fn whole_disc(&mut self, pieces: &[usize]) -> Option<Formula> {
        let mut center = None;
        let mut rim = None;
        for &piece in pieces {
            let Piece::Arc { center: own, ends } = self.arrangement.pieces[piece] else {
                return None;
            };
            let wanted = (self.wishes.takes_disc)(&self.arrangement.pieces[piece]);
            if !wanted || *center.get_or_insert(own) != own {
                return None;
            }
            rim.get_or_insert(ends[0]);
        }
        let (center, rim) = (center?, rim?);
        // Arcs of one centre that join have one radius, but for rounding.
        let size = rim.distance(center);
        let round = |&piece: &usize| {
            let radius = self.arrangement.pieces[piece].start().distance(center);
            (radius - size).abs() <= 8.0 * f64::EPSILON * (size + center.abs().max_element())
        };
        if !pieces.iter().all(round) {
            return None;
        }
        Some(self.side(PlaneSide::Disc(center, rim)))
    }

    fn side(&mut self, side: PlaneSide) -> Formula {
        self.sides.push(side);
        Formula::inside(self.sides.len() as u32 - 1)
    }

    fn line(&mut self, piece: usize) -> u32 {
        if let Some(side) = self.line_of[piece] {
            return side;
        }
        let source = &self.arrangement.pieces[piece];
        self.sides
            .push(PlaneSide::Line(source.start(), source.end()));
        let side = self.sides.len() as u32 - 1;
        self.line_of[piece] = Some(side);
        side
    }

    /// What lies between a curve and its chord.
    fn segment(&mut self, piece: usize) -> Formula {
        let source = self.arrangement.pieces[piece];
        let left = curves_left(&source);
        let beyond = Formula::Side {
            side: self.line(piece),
            inside: left,
        };
        let side = match source {
            Piece::Arc { center, ends } if (self.wishes.takes_disc)(&source) => {
                PlaneSide::Disc(center, ends[0])
            }
            _ => PlaneSide::Contour(closed_behind_chord(&source, left, self.wishes.least_x)),
        };
        Formula::all([self.side(side), beyond])
    }
}

/// A curve, closed by a corner on the other side of its chord: there it does not matter.
fn closed_behind_chord(piece: &Piece, left: bool, least_x: f64) -> Contour {
    let curve = piece.curve();
    let (a, b) = (curve.start(), curve.end());
    let away = if left {
        -(b - a).perp()
    } else {
        (b - a).perp()
    } * 0.5;
    let middle = (a + b) * 0.5;
    let room = middle.x - least_x;
    let reach = if middle.x + away.x < least_x {
        0.5 * room / -away.x
    } else {
        1.0
    };
    let mut curves = vec![curve];
    if reach > 0.0 {
        let corner = middle + away * reach;
        curves.extend([Curve::line(b, corner), Curve::line(corner, a)]);
    } else {
        // The chord lies on the axis, where nothing is crossed.
        curves.push(Curve::line(b, a));
    }
    Contour::new(curves, Some(!left))
}

/// Whether a curve lies left of its chord.
fn curves_left(piece: &Piece) -> bool {
    let (a, b) = (piece.start(), piece.end());
    let turns = piece
        .curve()
        .control()
        .map(|p| turn(a, b, p))
        .collect::<Vec<_>>();
    turns.into_iter().any(|t| t > 0.0)
}

/// The loops' formulas, each without those nested in it, these again without theirs.
fn nested(loops: &[Loop], formulas: Vec<Formula>) -> Formula {
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(loops[i].depth));
    let mut islands: Vec<Vec<Formula>> = vec![Vec::new(); loops.len()];
    let mut outer = Vec::new();
    let mut formulas: Vec<Option<Formula>> = formulas.into_iter().map(Some).collect();
    for i in order {
        let Some(own) = formulas[i].take() else {
            continue;
        };
        let holes = std::mem::take(&mut islands[i]);
        let less = Formula::all([own, Formula::any(holes).complement()]);
        match loops[i].parent {
            Some(parent) => islands[parent].push(less),
            None => outer.push(less),
        }
    }
    Formula::any(outer)
}

#[cfg(test)]
mod tests {
    use super::super::{Edge, Outline};
    use super::*;

    fn contains(region: &Decomposition, p: DVec2) -> bool {
        region
            .formula
            .evaluate(&|side| match &region.sides[side as usize] {
                PlaneSide::Line(a, b) => turn(*a, *b, p) > 0.0,
                PlaneSide::Disc(center, rim) => p.distance(*center) < rim.distance(*center),
                PlaneSide::Contour(contour) => contour.contains(p),
            })
    }

    const ANYWHERE: Wishes = Wishes {
        least_x: f64::NEG_INFINITY,
        takes_disc: |_| true,
    };

    /// Compares with the whole region as one contour, away from its boundary.
    fn check(outlines: &[Outline], expects_chords: bool) {
        let region = Region::new(outlines).expect("valid");
        let by_chords = Decomposition::by_chords(&region, ANYWHERE);
        assert_eq!(by_chords.is_some(), expects_chords);
        let by_chords = by_chords.unwrap_or_else(|| Decomposition::new(&region, ANYWHERE));
        let whole = Contour::new(region.pieces.iter().map(Piece::curve).collect(), None);
        let [low, high] = region.bounds();
        for i in 0..60 {
            for j in 0..60 {
                let f = DVec2::new(f64::from(i) - 4.9, f64::from(j) - 4.7) / 50.0;
                let p = low + (high - low) * f;
                let near = DVec2::splat(1e-9);
                if whole.classify(p - near, p + near) != crate::surface::Side::Both {
                    assert_eq!(contains(&by_chords, p), whole.contains(p), "{p}");
                }
            }
        }
    }

    fn at(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn a_circle_is_one_disc() {
        let region = Region::new(&[Outline::circle(at(1.0, 2.0), 3.0)]).expect("valid");
        let whole = Decomposition::new(&region, ANYWHERE);
        assert_eq!(whole.formula.literals(), 1);
        check(&[Outline::circle(at(1.0, 2.0), 3.0)], true);
    }

    #[test]
    fn a_heart_of_curves_and_a_slot_of_arcs() {
        let mut heart = Outline::starting_at(at(0.0, -1.0));
        heart.push(Edge::Cubic(at(2.0, 0.3), at(1.0, 1.8)), at(0.0, 0.6));
        heart.push(Edge::Cubic(at(-1.0, 1.8), at(-2.0, 0.3)), at(0.0, -1.0));
        check(&[heart.clone()], true);
        let mut slot = Outline::starting_at(at(-2.0, -1.0));
        slot.push(Edge::Line, at(2.0, -1.0));
        let arc = |x: f64| Edge::Arc {
            center: at(x, 0.0),
            clockwise: false,
        };
        slot.push(arc(2.0), at(2.0, 1.0));
        slot.push(Edge::Line, at(-2.0, 1.0));
        slot.push(arc(-2.0), at(-2.0, -1.0));
        check(&[slot.clone()], true);
        // A hole that dents, and an island.
        let hole = Outline::circle(at(0.3, 0.0), 0.5);
        let island = Outline::polygon(&[at(0.2, 0.0), at(0.5, 0.0), at(0.3, 0.2)]);
        check(&[island, slot, hole], true);
    }

    #[test]
    fn dents_lenses_and_segments() {
        let mut bite = Outline::starting_at(at(0.0, 0.0));
        bite.push(Edge::Line, at(4.0, 0.0));
        bite.push(Edge::Quadratic(at(3.0, 1.0)), at(4.0, 2.0));
        bite.push(
            Edge::Arc {
                center: at(2.0, 2.0),
                clockwise: true,
            },
            at(0.0, 2.0),
        );
        check(&[bite], false);
        let mut concave = Outline::starting_at(at(0.0, 0.0));
        concave.push(Edge::Line, at(4.0, 0.0));
        concave.push(Edge::Quadratic(at(3.0, 1.0)), at(4.0, 2.0));
        concave.push(Edge::Line, at(3.0, 2.0));
        concave.push(
            Edge::Arc {
                center: at(2.0, 2.0),
                clockwise: true,
            },
            at(1.0, 2.0),
        );
        check(&[concave], true);
        let mut lens = Outline::starting_at(at(-1.0, 0.0));
        lens.push(Edge::Quadratic(at(0.0, -1.0)), at(1.0, 0.0));
        lens.push(Edge::Quadratic(at(0.0, 1.0)), at(-1.0, 0.0));
        check(&[lens], true);
        let mut cap = Outline::starting_at(at(-1.0, 0.0));
        cap.push(Edge::Quadratic(at(0.3, -1.0)), at(1.0, 0.0));
        check(&[cap], true);
    }

    #[test]
    fn crossing_edges_and_bridges_to_holes() {
        let star: Vec<DVec2> = (0..5)
            .map(|i| {
                let angle = 2.513_274_122_871_834_5 * f64::from(i);
                at(libm::cos(angle), libm::sin(angle))
            })
            .collect();
        check(&[Outline::polygon(&star)], false);
        // A square with a square hole, joined by a bridge that is traversed twice.
        let keyhole = [
            (0, 0),
            (8, 0),
            (8, 8),
            (0, 8),
            (0, 0),
            (2, 2),
            (2, 6),
            (6, 6),
            (6, 2),
            (2, 2),
        ];
        let keyhole: Vec<DVec2> = keyhole
            .iter()
            .map(|&(x, y)| at(f64::from(x), f64::from(y)))
            .collect();
        check(&[Outline::polygon(&keyhole)], true);
        // Two squares that touch in a corner, traversed as one; and one that touches a side.
        let eight = [
            (0, 0),
            (2, 0),
            (2, 2),
            (4, 2),
            (4, 4),
            (2, 4),
            (2, 2),
            (0, 2),
        ];
        let eight: Vec<DVec2> = eight
            .iter()
            .map(|&(x, y)| at(f64::from(x), f64::from(y)))
            .collect();
        check(&[Outline::polygon(&eight)], true);
        let tent = [at(1.0, 0.0), at(1.5, 1.0), at(0.5, 1.0)];
        let base = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)];
        check(&[Outline::polygon(&tent), Outline::polygon(&base)], true);
    }
}
