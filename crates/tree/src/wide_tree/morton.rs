//! The order of centres along the octree's cells.

use octray_math::MAX_DEPTH;
use rayon::prelude::*;

use super::reference::{PaddedBox, Reference};

/// How much a thread works on in one go.
const SHARE: usize = 1 << 12;

/// The most bytes that sorting takes beside the references: a second copy, keys and codes.
pub(super) const fn bytes(count: usize) -> u64 {
    (count * (size_of::<Reference>() + size_of::<(u64, u32)>() + size_of::<u64>())) as u64
}

/// Sorts references by the Morton codes of their centres in the smallest cube around them; returns
/// the codes.
pub(super) fn sort(references: &mut Vec<Reference>) -> Vec<u64> {
    let around = |part: &[Reference]| {
        let centers = part.iter().map(|r| r.0.center());
        centers.fold(PaddedBox::EMPTY, |all, center| all.including(center))
    };
    let parts = references.par_chunks(SHARE).map(around);
    let cube = parts.reduce(|| PaddedBox::EMPTY, |a, b| a.union(&b));
    let [x, y, z, _] = cube.size();
    let size = x.max(y).max(z);
    let per_unit = if size > 0.0 {
        f64::from(1u32 << MAX_DEPTH) / f64::from(size)
    } else {
        0.0
    };
    let code = |r: &Reference| {
        let center = r.0.center();
        let digits = |axis: usize| {
            // The conversion saturates, so the far side of the cube lies in the last cell.
            let cell = f64::from(center[axis] - cube.min[axis]) * per_unit;
            spread((cell as u64).min((1 << MAX_DEPTH) - 1))
        };
        digits(0) | digits(1) << 1 | digits(2) << 2
    };
    let mut keys: Vec<(u64, u32)> = references
        .par_iter()
        .with_min_len(SHARE)
        .enumerate()
        .map(|(place, r)| (code(r), place as u32))
        .collect();
    keys.par_sort_unstable();
    let sorted = keys.par_iter().with_min_len(SHARE);
    *references = sorted
        .map(|&(_, place)| references[place as usize])
        .collect();
    keys.par_iter()
        .with_min_len(SHARE)
        .map(|&(code, _)| code)
        .collect()
}

/// Moves 21 bits three places apart.
#[inline]
fn spread(mut v: u64) -> u64 {
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}
