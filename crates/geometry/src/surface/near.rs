//! Surfaces that nearly coincide: apart by more than the tolerance, and by little enough to be
//! meant as one.

use std::collections::HashMap;

use super::fingerprint::{Fingerprint, Fingerprints};
use crate::SurfaceId;

/// How near two distinct surfaces must be, in units of the scene's size, to be reported: 2^-20, a
/// micrometre in a metre. That is what coordinates rounded to six or seven digits leave apart.
pub const NEAR: f64 = 1.0 / (1u64 << 20) as f64;

/// Two surfaces of one kind that were kept apart although they are nearly the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPair {
    /// The one that was there first.
    pub first: SurfaceId,
    /// The later one.
    pub second: SurfaceId,
    /// By how much they differ at most within the scene, in units of its size.
    pub gap: f64,
}

/// Width of a hash cell in units of [`NEAR`]: many, so that few fingerprints lie near a face.
const CELL: f64 = 64.0;
/// Where the cells start: not at 0, which many numbers are.
const SHIFT: f64 = 0.381_966;
/// So many fingerprints of a cell are compared with another: whatever the scene, time is linear.
const COMPARED: usize = 32;
/// So many numbers near faces of cells are looked after.
const DOUBTFUL: usize = 6;

type HashCell = (u8, Vec<i64>);

fn index(value: f64) -> i64 {
    libm::floor(value / (CELL * NEAR) + SHIFT) as i64
}

/// The cell of a fingerprint, and those in which one that is near may lie.
fn cells(fingerprint: Fingerprint<'_>) -> Vec<HashCell> {
    let home: Vec<i64> = fingerprint.numbers.iter().map(|v| index(*v)).collect();
    let mut cells = vec![(fingerprint.kind, home.clone())];
    let mut doubtful = 0;
    for (axis, value) in fingerprint.numbers.iter().enumerate() {
        let other = [index(value - NEAR), index(value + NEAR)]
            .into_iter()
            .find(|i| *i != home[axis]);
        let Some(other) = other.filter(|_| doubtful < DOUBTFUL) else {
            continue;
        };
        doubtful += 1;
        for i in 0..cells.len() {
            let mut cell = cells[i].clone();
            cell.1[axis] = other;
            cells.push(cell);
        }
    }
    cells
}

/// How far two fingerprints of one kind are apart.
fn gap(a: Fingerprint<'_>, b: Fingerprint<'_>) -> f64 {
    let pairs = a.numbers.iter().zip(b.numbers);
    pairs.fold(0.0, |gap, (x, y)| gap.max((x - y).abs()))
}

/// For each surface the nearest earlier one that nearly coincides with it.
///
/// Where more than 32 crowd together the nearest of those that were looked at is named.
pub(super) fn near_pairs(fingerprints: &Fingerprints) -> Vec<NearPair> {
    let mut seen: HashMap<HashCell, Vec<u32>> = HashMap::new();
    let mut pairs = Vec::new();
    for id in 0..fingerprints.len() {
        let fingerprint = fingerprints.get(id);
        let mut cells = cells(fingerprint);
        let nearest = cells
            .iter()
            .filter_map(|cell| seen.get(cell))
            .flatten()
            .map(|&other| (other, gap(fingerprints.get(other as usize), fingerprint)))
            .filter(|(_, gap)| *gap <= NEAR)
            .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        if let Some((first, gap)) = nearest {
            pairs.push(NearPair {
                first: SurfaceId(first),
                second: SurfaceId(id as u32),
                gap,
            });
        }
        let home = seen.entry(cells.swap_remove(0)).or_default();
        if home.len() < COMPARED {
            home.push(id as u32);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Canonical, Surface, SurfaceTable};
    use octray_math::{DAffine3, DVec3};
    use proptest::prelude::*;

    fn sphere(center: DVec3, radius: f64) -> Surface {
        let frame = DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(radius));
        Surface::Curved {
            canonical: Canonical::Sphere,
            local_from_scene: frame.inverse(),
        }
    }

    #[test]
    fn what_is_merged_or_clearly_apart_is_no_near_pair() {
        let mut table = SurfaceTable::new(10.0, 10.0);
        for offset in [5.0, 5.0 + 1e-12, 5.1, -5.0] {
            table.insert(Surface::Plane {
                normal: DVec3::Z,
                offset,
            });
        }
        table.insert(sphere(DVec3::X, 2.0));
        table.insert(sphere(DVec3::X, 2.001));
        assert_eq!(table.merged(), 1);
        assert_eq!(table.near_pairs(), []);
    }

    #[test]
    fn crowds_take_linear_time_and_name_a_neighbour_each() {
        let mut table = SurfaceTable::new(1.0, 1.0);
        let count = 100_000;
        for i in 0..count {
            // All within 2^-20, none within the tolerance.
            table.insert(Surface::Plane {
                normal: DVec3::Z,
                offset: 0.5 + 9e-12 * f64::from(i),
            });
        }
        assert_eq!(table.merged(), 0);
        assert_eq!(table.near_pairs().len(), count as usize - 1);
    }

    proptest! {
        #[test]
        fn a_near_pair_is_found_wherever_it_lies(
            x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64, radius in 0.01..1.0f64,
            shift in -0.9..0.9f64, growth in -0.9..0.9f64,
        ) {
            let mut table = SurfaceTable::new(1.0, 1.0);
            let center = DVec3::new(x, y, z);
            let first = table.insert(sphere(center, radius));
            table.insert(sphere(-center * 2.0 + DVec3::ONE * 3.0, radius));
            let moved = center + DVec3::new(0.0, shift * NEAR, 0.0);
            let second = table.insert(sphere(moved, radius + growth * NEAR));
            prop_assume!(first != second);
            let pairs = table.near_pairs();
            prop_assert_eq!(pairs.len(), 1);
            prop_assert_eq!((pairs[0].first, pairs[0].second), (first, second));
            let expected = shift.abs().max(growth.abs()) * NEAR;
            prop_assert!((pairs[0].gap - expected).abs() < 1e-13, "{:?} {}", pairs, expected);
        }
    }
}
