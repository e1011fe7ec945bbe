//! The surface table: coincident surfaces become one.
//!
//! This is the only place in the project where a tolerance acts on geometry. Two surfaces are one
//! when every number of their fingerprints, in units of the scene's size, agrees within
//! [`SURFACE_TOLERANCE`] and the rounding that the coordinates carry ([`PLACE_TOLERANCE`]): the
//! first of them then stands for both, so that their crossings have the same bits and equal
//! parameters mean coincidence. Surfaces that are further apart stay apart.

use std::collections::HashMap;

use octray_math::{DVec3, hash_combine};

use super::Surface;
use super::fingerprint::{Fingerprint, Fingerprints};
use super::near::{NearPair, near_pairs};
use crate::SurfaceId;

/// How far two surfaces may be apart, in units of the scene's size, to count as one: 2^-40, about
/// 4000 rounding errors and a millionth of a micrometre in a metre.
pub const SURFACE_TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// What is added to it in units of the largest coordinate: 2^-49, eight rounding errors. In a scene
/// far from the origin the coordinates themselves carry no more.
pub const PLACE_TOLERANCE: f64 = 1.0 / (1u64 << 49) as f64;

/// Only this many numbers are hashed; all are compared.
const HASHED: usize = 4;
/// Width of a hash cell in tolerances: many, so that few fingerprints lie near a cell's face.
const CELL: f64 = 256.0;

/// The indices of the cells on each axis, which may have two where a number lies near a cell's face.
type Indices = [[i64; 2]; HASHED];

/// The end of a list of surfaces.
const NONE: u32 = u32::MAX;

/// Canonical surfaces, numbered in the order of their first use.
#[derive(Debug)]
pub struct SurfaceTable {
    scale: f64,
    /// In units of the scene's size.
    tolerance: f64,
    surfaces: Vec<Surface>,
    fingerprints: Fingerprints,
    /// By a hash of the cell, the surface that came there last.
    last: HashMap<u64, u32>,
    /// For each surface the one that came there before it.
    before: Vec<u32>,
    /// The numbers of the surface that is being inserted.
    numbers: Vec<f64>,
    merged: usize,
}

impl SurfaceTable {
    /// An empty table for a scene of this size whose coordinates, before it was moved to the
    /// origin, reach up to `largest` (both positive and finite).
    #[must_use]
    pub fn new(scene_size: f64, largest: f64) -> Self {
        Self {
            scale: 1.0 / scene_size,
            tolerance: SURFACE_TOLERANCE + PLACE_TOLERANCE * (largest / scene_size),
            surfaces: Vec::new(),
            fingerprints: Fingerprints::default(),
            last: HashMap::new(),
            before: Vec::new(),
            numbers: Vec::new(),
            merged: 0,
        }
    }

    /// The id of `surface`, or of the first surface that coincides with it.
    ///
    /// A surface that is inserted again gets the same id again, whatever came between: what
    /// coincides with it and was there before has a lower id, what came later a higher one.
    pub fn insert(&mut self, surface: Surface) -> SurfaceId {
        let mut numbers = std::mem::take(&mut self.numbers);
        let fingerprint = Fingerprint::new(&surface, self.scale, &mut numbers);
        let indices = self.indices(fingerprint);
        let found = self.first_coincident(fingerprint, &indices);
        let id = found.unwrap_or(self.surfaces.len() as u32);
        if found.is_some() {
            self.merged += 1;
        } else {
            let home = hash(fingerprint.kind, &indices, 0);
            let before = self.last.insert(home, id);
            self.before.push(before.unwrap_or(NONE));
            self.surfaces.push(surface);
            self.fingerprints.push(fingerprint);
        }
        self.numbers = numbers;
        SurfaceId(id)
    }

    /// The first surface that coincides with one of this fingerprint, in the cells where it may be.
    fn first_coincident(&self, fingerprint: Fingerprint<'_>, indices: &Indices) -> Option<u32> {
        let mut first = NONE;
        for choice in 0..1_u32 << HASHED {
            // Nearly always there is one cell on every axis.
            let doubles =
                (0..HASHED).any(|i| choice >> i & 1 == 1 && indices[i][0] == indices[i][1]);
            if doubles {
                continue;
            }
            let cell = hash(fingerprint.kind, indices, choice);
            let mut next = self.last.get(&cell).copied().unwrap_or(NONE);
            while next != NONE {
                if next < first && self.coincide(self.fingerprints.get(next as usize), fingerprint)
                {
                    first = next;
                }
                next = self.before[next as usize];
            }
        }
        (first != NONE).then_some(first)
    }

    /// How far two surfaces may be apart to count as one, in units of the scene's size.
    pub(crate) const fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// How many insertions found a surface that was there.
    #[must_use]
    pub const fn merged(&self) -> usize {
        self.merged
    }

    /// The surfaces that nearly coincide with an earlier one (see [`NEAR`](super::NEAR)).
    #[must_use]
    pub fn near_pairs(&self) -> Vec<NearPair> {
        near_pairs(&self.fingerprints)
    }

    /// The surfaces; a [`SurfaceId`] is an index.
    #[must_use]
    pub fn into_surfaces(self) -> Vec<Surface> {
        let mut surfaces = self.surfaces;
        surfaces.shrink_to_fit();
        surfaces
    }

    fn coincide(&self, a: Fingerprint<'_>, b: Fingerprint<'_>) -> bool {
        a.kind == b.kind
            && a.numbers.len() == b.numbers.len()
            && a.numbers
                .iter()
                .zip(b.numbers)
                .all(|(x, y)| (x - y).abs() <= self.tolerance)
    }

    fn hash_index(&self, value: f64) -> i64 {
        libm::floor(value / (CELL * self.tolerance)) as i64
    }

    /// The hash cells in which a coincident fingerprint may live, its own first: nearly always one.
    fn indices(&self, fingerprint: Fingerprint<'_>) -> Indices {
        std::array::from_fn(|i| {
            let value = fingerprint.numbers.get(i).copied().unwrap_or(0.0);
            let own = self.hash_index(value);
            let other = [value - self.tolerance, value + self.tolerance]
                .map(|shifted| self.hash_index(shifted))
                .into_iter()
                .find(|index| *index != own);
            [own, other.unwrap_or(own)]
        })
    }
}

/// Of a cell; `choice` has a bit for each axis on which the other index counts.
fn hash(kind: u8, indices: &Indices, choice: u32) -> u64 {
    (0..HASHED).fold(u64::from(kind), |hash, i| {
        let index = indices[i][(choice >> i & 1) as usize];
        hash_combine(hash, index as u64)
    })
}

/// `v` or `-v`: the one whose first component clear of 0 is positive.
pub(crate) fn upward(v: DVec3) -> DVec3 {
    if points_upward(v) { v } else { -v }
}

/// Whether the first component of a unit vector that is clear of 0 is positive.
pub(crate) fn points_upward(v: DVec3) -> bool {
    v.to_array()
        .into_iter()
        .find(|c| c.abs() > SURFACE_TOLERANCE)
        .is_none_or(|c| c > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Canonical;
    use octray_math::DAffine3;
    use proptest::prelude::*;

    fn plane(normal: DVec3, offset: f64) -> Surface {
        Surface::Plane { normal, offset }
    }

    #[test]
    fn planes_merge_within_the_tolerance_only() {
        let mut table = SurfaceTable::new(10.0, 10.0);
        let a = table.insert(plane(DVec3::Z, 10.0));
        assert_eq!(table.insert(plane(DVec3::Z, 10.0 + 5e-12)), a);
        assert_ne!(table.insert(plane(DVec3::Z, 10.0 + 5e-11)), a);
        assert_ne!(table.insert(plane(DVec3::X, 10.0)), a);
    }

    #[test]
    fn a_cylinder_is_the_same_wherever_along_its_axis_it_was_made() {
        let cylinder = |frame: DAffine3| Surface::Curved {
            canonical: Canonical::Cylinder,
            local_from_scene: frame.inverse(),
        };
        let scale = DAffine3::from_scale(DVec3::splat(2.0));
        let tilt = DAffine3::from_rotation_x(0.7);
        let mut table = SurfaceTable::new(10.0, 10.0);
        let a = table.insert(cylinder(tilt * scale));
        let along = DAffine3::from_translation(DVec3::new(0.0, 0.0, 3.0));
        let turned = DAffine3::from_rotation_z(0.4);
        assert_eq!(table.insert(cylinder(tilt * along * turned * scale)), a);
        let aside = DAffine3::from_translation(DVec3::new(1e-6, 0.0, 0.0));
        assert_ne!(table.insert(cylinder(tilt * aside * scale)), a);
    }

    #[test]
    fn two_frusta_of_one_cone_share_it_and_a_near_cylinder_keeps_its_place() {
        // Radius 4 - 2 z: once from z = 0, once from z = 1.
        let cone = |base: f64, radius: f64, slope: f64| Surface::Curved {
            canonical: Canonical::Cone { slope },
            local_from_scene: (DAffine3::from_translation(DVec3::new(1.0, 2.0, base))
                * DAffine3::from_scale(DVec3::splat(radius)))
            .inverse(),
        };
        let mut table = SurfaceTable::new(5.0, 5.0);
        let a = table.insert(cone(0.0, 4.0, -2.0));
        assert_eq!(table.insert(cone(1.0, 2.0, -2.0)), a);
        assert_eq!(table.insert(cone(1.95, 0.1, -2.0)), a);
        assert_ne!(table.insert(cone(1.0, 2.1, -2.0)), a);
        let b = table.insert(cone(0.0, 2.0, -1e-15));
        assert_ne!(table.insert(cone(0.0, 2.1, -1e-15)), b);
    }

    proptest! {
        #[test]
        fn any_two_frusta_of_one_cone_share_it(
            radius in -3.0..3.0f64, growth in -2.0..2.0f64, heights in [-3.0..3.0f64, -3.0..3.0],
            turned in any::<bool>(),
        ) {
            prop_assume!(growth.abs() > 0.01);
            let tilt = DAffine3::from_rotation_x(if turned { 0.7 } else { 0.0 });
            let mut table = SurfaceTable::new(5.0, 5.0);
            let mut frustum = |base: f64| {
                let own = radius + growth * base;
                let frame = DAffine3::from_translation(DVec3::new(0.0, 0.0, base))
                    * DAffine3::from_scale(DVec3::new(own, own, 1.0));
                table.insert(Surface::Curved {
                    canonical: Canonical::Cone { slope: growth / own },
                    local_from_scene: (tilt * frame).inverse(),
                })
            };
            prop_assume!(heights.iter().all(|h| (radius + growth * h).abs() > 0.05));
            prop_assert_eq!(frustum(heights[0]), frustum(heights[1]));
        }

        #[test]
        fn a_surface_inserted_again_is_the_same_whatever_came_between(
            steps in proptest::collection::vec(-8i32..8, 1..40), at in -1.0..1.0f64,
        ) {
            // Coincidence within a tolerance is not transitive; the ids must not depend on luck.
            let cell = CELL * (SURFACE_TOLERANCE + PLACE_TOLERANCE);
            let border = libm::round(at / cell) * cell;
            let offset = |step: i32| border + f64::from(step) * 0.3 * SURFACE_TOLERANCE;
            let mut table = SurfaceTable::new(1.0, 1.0);
            let ids: Vec<SurfaceId> =
                steps.iter().map(|s| table.insert(plane(DVec3::Y, offset(*s)))).collect();
            for (step, id) in steps.iter().zip(ids).rev() {
                prop_assert_eq!(table.insert(plane(DVec3::Y, offset(*step))), id);
            }
        }

        #[test]
        fn cell_borders_do_not_hide_coincidence(offset in -1.0..1.0f64, steps in -300i32..300) {
            // Start on and around a border of a hash cell.
            let cell = CELL * (SURFACE_TOLERANCE + PLACE_TOLERANCE);
            let border = libm::round(offset / cell) * cell + f64::from(steps) * SURFACE_TOLERANCE * 0.01;
            let mut table = SurfaceTable::new(1.0, 1.0);
            let a = table.insert(plane(DVec3::Y, border));
            prop_assert_eq!(table.insert(plane(DVec3::Y, border + 0.9 * SURFACE_TOLERANCE)), a);
            prop_assert_eq!(table.insert(plane(DVec3::Y, border - 0.9 * SURFACE_TOLERANCE)), a);
            prop_assert_ne!(table.insert(plane(DVec3::Y, border + 2.0 * SURFACE_TOLERANCE)), a);
        }
    }
}
