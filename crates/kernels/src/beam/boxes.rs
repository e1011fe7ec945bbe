//! Boxes as a beam sees them.

use super::{BeamFrame, Bounds};
use crate::lane::Lane;
use crate::slab::Boxes8;

/// Positive or zero where something between two sides, and between two depths, may have a point with
/// `least z <= x <= most z`.
#[inline(always)]
fn overlap<L: Lane>(
    token: L::Token,
    [low, high]: [L; 2],
    [first, last]: [L; 2],
    [least, most]: [f32; 2],
) -> L {
    // The largest `x - least z` and the largest `most z - x`.
    let above = high - L::all(token, least) * if least < 0.0 { last } else { first };
    let below = L::all(token, most) * if most < 0.0 { first } else { last } - low;
    above.min(below)
}

/// Which way a box lies: the overlap across, and its depths.
#[inline(always)]
pub(super) fn box_verdict<L: Lane>(
    token: L::Token,
    beam: &BeamFrame,
    bounds: &Bounds,
    boxes: &Boxes8,
    lane: usize,
) -> [L; 3] {
    let [x, y, z] = beam.axes;
    let planes = &boxes.planes;
    let (x0, y0) = (L::all(token, beam.origin[0]), L::all(token, beam.origin[1]));
    let z0 = L::all(token, beam.origin[2]);
    let (z_low, z_high) = (
        L::load(token, &planes[z][lane..]),
        L::load(token, &planes[z + 3][lane..]),
    );
    let depths = if beam.down {
        [z0 - z_high, z0 - z_low]
    } else {
        [z_low - z0, z_high - z0]
    };
    let x_sides = [
        L::load(token, &planes[x][lane..]) - x0,
        L::load(token, &planes[x + 3][lane..]) - x0,
    ];
    let y_sides = [
        L::load(token, &planes[y][lane..]) - y0,
        L::load(token, &planes[y + 3][lane..]) - y0,
    ];
    let across = overlap(token, x_sides, depths, bounds.slopes[0]);
    let across = across.min(overlap(token, y_sides, depths, bounds.slopes[1]));
    [across, depths[0], depths[1]]
}

/// A box relative to a beam's point: the sides across, and the depths, least first.
pub(super) struct BoxSides {
    pub(super) across: [[f32; 2]; 2],
    pub(super) depths: [f32; 2],
}

impl BoxSides {
    #[inline(always)]
    pub(super) fn new(beam: &BeamFrame, boxes: &Boxes8, lane: usize) -> Self {
        let [x, y, z] = beam.axes;
        let [x0, y0, z0] = beam.origin;
        let planes = &boxes.planes;
        let (low, high) = (planes[z][lane], planes[z + 3][lane]);
        Self {
            across: [
                [planes[x][lane] - x0, planes[x + 3][lane] - x0],
                [planes[y][lane] - y0, planes[y + 3][lane] - y0],
            ],
            depths: if beam.down {
                [z0 - high, z0 - low]
            } else {
                [low - z0, high - z0]
            },
        }
    }
}

/// Positive or zero where lines may pass between two sides at some of the depths.
#[inline(always)]
pub(super) fn passes<L: Lane>(
    token: L::Token,
    slopes: &[f32],
    [low, high]: [f32; 2],
    [first, last]: [f32; 2],
) -> L {
    let slope = L::load(token, slopes);
    let (p, q) = (slope * L::all(token, first), slope * L::all(token, last));
    let above = L::all(token, high) - p.min(q);
    let below = p.max(q) - L::all(token, low);
    above.min(below)
}
