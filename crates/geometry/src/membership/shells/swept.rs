//! Prisms and lathes: their outlines as strokes, drawn out or turned, and their plane ends.
//!
//! Straight edges stay as they are unless there are too many; a piece of a curve lies in a rectangle
//! along its chord, as wide as the curve is high over the chord. What turns does so from facet to facet:
//! between the chord of a turn and its arc, a point is up to the reciprocal of the cosine of half the
//! angle farther away.

use octray_math::{DVec2, DVec3};

use super::ShellPatch;
use super::band::facet;
use super::strokes::{Stroke, joined, strokes};
use super::trapezoids::trapezoids;
use crate::profile::{Piece, Turning};

/// Larger than the rounding of directions.
const ROUNDING: f64 = 1.0 + 1e-12;

/// How fine, and how many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The chord error to aim at.
    pub(super) error: f64,
    pub(super) limit: usize,
}

/// The patches of a solid of a given size, as fine as there may be many, and their error.
///
/// `share` of the error is left to the strokes. `made` gives those of strokes and of an error where that matters, unless they are too many.
fn as_fine_as_allowed(
    pieces: &[Piece],
    (size, share): (f64, f64),
    aim: Aim,
    made: impl Fn(&[Stroke], f64, usize) -> Option<(Vec<ShellPatch>, f64)>,
) -> (Vec<ShellPatch>, f64) {
    let mut error = aim.error.clamp(1e-6 * size, size);
    let mut parts = strokes(pieces, share * error);
    if aim.error >= size {
        parts = joined(&parts, share * aim.error);
    }
    loop {
        let is_last = error > 8.0 * size;
        let limit = if is_last { usize::MAX } else { aim.limit };
        if let Some(done) = made(&parts, error, limit) {
            return done;
        }
        error *= 1.5;
        parts = joined(&parts, share * error);
    }
}

/// Appends the part of a plane that the outlines bound.
fn cap(
    strokes: &[Stroke],
    limit: usize,
    place: impl Fn(DVec2) -> DVec3,
    patches: &mut Vec<ShellPatch>,
) -> Option<()> {
    let left = limit.checked_sub(patches.len())?;
    let chords: Vec<[DVec2; 2]> = strokes.iter().map(|s| s.ends).collect();
    let bands = strokes.iter().filter(|s| s.band.inner != s.band.outer);
    let quads = trapezoids(&chords, left / 2)?
        .into_iter()
        .chain(bands.map(|s| s.band.corners()));
    for [a, b, c, d] in quads {
        let [a, b, c, d] = [a, b, c, d].map(&place);
        patches.extend([[a, b, c], [a, c, d]].map(ShellPatch::flat));
    }
    (patches.len() <= limit).then_some(())
}

fn thickest(strokes: &[Stroke]) -> f64 {
    strokes
        .iter()
        .map(|s| s.band.thickness())
        .fold(0.0, f64::max)
}

/// Of a prism whose diagonal is `size`.
pub(super) fn prism(
    pieces: &[Piece],
    z: [f64; 2],
    scale: [f64; 2],
    size: f64,
    aim: Aim,
) -> (Vec<ShellPatch>, f64) {
    let widest = scale[0].max(scale[1]);
    as_fine_as_allowed(pieces, (size, 1.0 / widest), aim, |strokes, _, limit| {
        if 2 * strokes.len() > limit {
            return None;
        }
        let place = |p: DVec2, end: usize| (p * scale[end]).extend(z[end]);
        let walls = strokes.iter().flat_map(|s| s.band.swept(place));
        let mut patches: Vec<ShellPatch> = walls.collect();
        for end in [0, 1] {
            if scale[end] > 0.0 {
                cap(strokes, limit, |p| place(p, end), &mut patches)?;
            }
        }
        Some((patches, thickest(strokes) * widest))
    })
}

/// Of a lathe whose diagonal is `size`.
pub(super) fn lathe(
    pieces: &[Piece],
    turning: Turning,
    size: f64,
    aim: Aim,
) -> (Vec<ShellPatch>, f64) {
    as_fine_as_allowed(pieces, (size, 0.5), aim, |strokes, error, limit| {
        let mut patches = Vec::new();
        let mut farthest: f64 = 0.0;
        for stroke in strokes {
            let radius = stroke.band.most_x();
            // What lies on the axis stays there.
            if radius <= 0.0 {
                continue;
            }
            let facets = facets(turning, 0.5 * error / radius);
            if patches.len() + 2 * facets.len() > limit {
                return None;
            }
            for (directions, reach) in facets {
                farthest = farthest.max(radius * (reach - 1.0));
                patches.extend(facet(&stroke.band, directions, [1.0, reach]));
            }
        }
        if !turning.is_whole() {
            for part in [0.0, 1.0] {
                let outward = turning.direction(part);
                let place = |p: DVec2| (outward * p.x).extend(p.y);
                cap(strokes, limit, place, &mut patches)?;
            }
        }
        Some((patches, thickest(strokes) + farthest))
    })
}

/// Directions between which the turn is taken for straight, and how many times as far away as the chord
/// it may be there. `error` is what may be added to a distance of 1.
fn facets(turning: Turning, error: f64) -> Vec<([DVec2; 2], f64)> {
    // 1 / cos(half) - 1 = error.
    let half = libm::acos(1.0 / (1.0 + error)).clamp(1e-4, std::f64::consts::FRAC_PI_3);
    let wanted = libm::ceil(0.5 * turning.sweep.to_radians() / half - 1e-9).max(1.0) as u32;
    let steps = turning.steps.unwrap_or(u32::MAX);
    let count = wanted.min(steps);
    // Where there are steps, facets begin and end with one.
    let part = |i: u32| match turning.steps {
        Some(steps) => {
            let step = u64::from(i) * u64::from(steps) / u64::from(count);
            step as f64 / f64::from(steps)
        }
        None => f64::from(i) / f64::from(count),
    };
    (0..count)
        .map(|i| {
            let parts = [part(i), part(i + 1)];
            let directions = parts.map(|part| turning.direction(part));
            let angle = turning.sweep.to_radians() * (parts[1] - parts[0]);
            let reach = if count == steps {
                1.0
            } else {
                ROUNDING / libm::cos(0.5 * angle)
            };
            (directions, reach)
        })
        .collect()
}
