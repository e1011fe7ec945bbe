//! Outlines as few bands.

use octray_math::DVec2;

use super::band::Band;
use super::plane_curve::PlaneCurve;
use crate::profile::{Curve, Piece};

/// A curve is cut into at most this many pieces: 2 to the power of it.
const MOST_HALVINGS: u32 = 8;

/// A part of closed outlines: what a band holds. Its chord goes from one end to the other; where they are
/// the same point there is none. Chords of all strokes are closed polygons, and a point that these go round
/// an odd number of times and the outlines an even number of times, or the other way round, lies in some
/// stroke's band: it lies between a part and its chord.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) ends: [DVec2; 2],
    pub(super) band: Band,
}

impl Stroke {
    fn is_closed(&self) -> bool {
        self.ends[0] == self.ends[1]
    }

    /// Both as one, no thicker than `most`.
    fn joined(&self, next: &Self, most: f64) -> Option<Self> {
        let ends = if next.is_closed() {
            self.ends
        } else if self.is_closed() {
            next.ends
        } else if self.ends[1] == next.ends[0] {
            [self.ends[0], next.ends[1]]
        } else {
            return None;
        };
        let corners = [self.band.corners(), next.band.corners()];
        let band = Band::around(ends, corners.as_flattened());
        (band.thickness() <= most).then_some(Self { ends, band })
    }
}

/// The strokes of outlines, those of curves no thicker than `most` if they can be.
pub(super) fn strokes(pieces: &[Piece], most: f64) -> Vec<Stroke> {
    let mut found = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let ends = [piece.start(), piece.end()];
        match piece {
            Piece::Line(..) => found.push(Stroke {
                ends,
                band: Band::line(ends),
            }),
            Piece::Bezier(curve) => bend(curve, 0.0, most, MOST_HALVINGS, &mut found),
            Piece::Arc { center, ends } => {
                // The circle passes through the first end, but may miss the second.
                let miss = (ends[0].distance(*center) - ends[1].distance(*center)).abs();
                bend(&piece.curve(), 4.0 * miss, most, MOST_HALVINGS, &mut found);
            }
        }
    }
    found
}

/// Appends the strokes of a curve that is known up to `slack`.
fn bend(curve: &Curve, slack: f64, most: f64, halvings: u32, found: &mut Vec<Stroke>) {
    let mut band = curve.band();
    if halvings > 0 && band.thickness() > most {
        for half in Curve::halves(curve) {
            bend(&half, slack, most, halvings - 1, found);
        }
        return;
    }
    let ends = [curve.start(), curve.end()];
    if slack > 0.0 {
        let around = |p: DVec2| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| p + DVec2::new(x, y) * slack)
        };
        band = Band::around(ends, band.corners().map(around).as_flattened());
    }
    found.push(Stroke { ends, band });
}

/// Neighbours joined where they become no thicker than `most`.
pub(super) fn joined(strokes: &[Stroke], most: f64) -> Vec<Stroke> {
    let mut found: Vec<Stroke> = Vec::with_capacity(strokes.len());
    for stroke in strokes {
        match found.last().and_then(|last| last.joined(stroke, most)) {
            Some(both) => {
                found.pop();
                found.push(both);
            }
            None => found.push(*stroke),
        }
    }
    found
}
