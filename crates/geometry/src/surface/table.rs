//! The surface table: coincident surfaces become one.
//!
//! This is the only place in the project where a tolerance acts on geometry. Two surfaces are one
//! when every number of their fingerprints, in units of the scene's size, agrees within
//! [`SURFACE_TOLERANCE`]: the first of them then stands for both, so that their crossings have the
//! same bits and equal parameters mean coincidence. Surfaces that are further apart stay apart.

use std::collections::HashMap;

use octray_math::{DMat3, DVec3};

use super::{Quadric, Surface};
use crate::SurfaceId;

/// How far two surfaces may be apart, in units of the scene's size, to count as one: 2^-40, about
/// 4000 rounding errors and a millionth of a micrometre in a metre.
pub const SURFACE_TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

const NUMBERS: usize = 16;
/// Only this many numbers are hashed; all are compared.
const HASHED: usize = 4;
/// Width of a hash cell: many tolerances, so that few fingerprints lie near a cell's face.
const CELL: f64 = SURFACE_TOLERANCE * 256.0;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Fingerprint {
    kind: u8,
    numbers: [f64; NUMBERS],
}

type HashCell = (u8, [i64; HASHED]);

/// Canonical surfaces, numbered in the order of their first use.
#[derive(Debug)]
pub struct SurfaceTable {
    scale: f64,
    surfaces: Vec<Surface>,
    fingerprints: Vec<Fingerprint>,
    cells: HashMap<HashCell, Vec<u32>>,
    merged: usize,
}

impl SurfaceTable {
    /// An empty table for a scene of this size (largest coordinate; positive and finite).
    #[must_use]
    pub fn new(scene_size: f64) -> Self {
        Self {
            scale: 1.0 / scene_size,
            surfaces: Vec::new(),
            fingerprints: Vec::new(),
            cells: HashMap::new(),
            merged: 0,
        }
    }

    /// The id of `surface`, or of the first surface that coincides with it.
    pub fn insert(&mut self, surface: Surface) -> SurfaceId {
        let fingerprint = self.fingerprint(&surface);
        for cell in neighbours(&fingerprint) {
            for &id in self.cells.get(&cell).into_iter().flatten() {
                if coincide(&self.fingerprints[id as usize], &fingerprint) {
                    self.merged += 1;
                    return SurfaceId(id);
                }
            }
        }
        let id = self.surfaces.len() as u32;
        self.cells.entry(home(&fingerprint)).or_default().push(id);
        self.surfaces.push(surface);
        self.fingerprints.push(fingerprint);
        SurfaceId(id)
    }

    /// How many insertions found a surface that was there.
    #[must_use]
    pub const fn merged(&self) -> usize {
        self.merged
    }

    /// The surfaces; a [`SurfaceId`] is an index.
    #[must_use]
    pub fn into_surfaces(self) -> Vec<Surface> {
        self.surfaces
    }

    /// Numbers without dimension that agree exactly when two surfaces are the same set of points
    /// with the same negative side.
    fn fingerprint(&self, surface: &Surface) -> Fingerprint {
        let mut numbers = [0.0; NUMBERS];
        let mut rest = numbers.iter_mut();
        let mut put = |values: &[f64]| {
            for (slot, value) in rest.by_ref().zip(values) {
                *slot = *value;
            }
        };
        let kind = match surface {
            Surface::Plane { normal, offset } => {
                put(&[offset * self.scale]);
                put(&normal.to_array());
                0
            }
            Surface::Quadric {
                kind,
                local_from_world,
            } => {
                let world = local_from_world.inverse();
                let center = world.translation * self.scale;
                let shape = world.matrix3 * self.scale;
                match kind {
                    Quadric::Sphere => {
                        // The ellipsoid's matrix, which no rotation before the scaling changes.
                        put(&center.to_array());
                        put(&outer(&[shape.x_axis, shape.y_axis, shape.z_axis]));
                        1
                    }
                    Quadric::Cylinder => {
                        // Axis as a line, cross-section seen along it.
                        let axis = upward(shape.z_axis.normalize());
                        let across = |v: DVec3| v - axis * axis.dot(v);
                        put(&across(center).to_array());
                        put(&outer(&[across(shape.x_axis), across(shape.y_axis)]));
                        put(&axis.to_array());
                        2
                    }
                }
            }
            Surface::Cone {
                slope,
                local_from_world,
            } => {
                // The quadratic form about the scene's origin, up to a factor: the same wherever
                // along the axis the frame stands, and for a frustum that is nearly a cylinder too.
                let m = local_from_world.matrix3 * (1.0 / self.scale);
                let o = local_from_world.translation;
                let weights = DVec3::new(1.0, 1.0, -slope * slope);
                let form = m.transpose() * DMat3::from_diagonal(weights) * m;
                let radius = 1.0 + slope * o.z;
                let linear = m.transpose() * DVec3::new(o.x, o.y, -slope * radius);
                let constant = o.x * o.x + o.y * o.y - radius * radius;
                let entries = form.to_cols_array();
                let size = entries.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
                put(&(linear / size).to_array());
                put(&[constant / size]);
                put(&entries.map(|entry| entry / size));
                3
            }
            Surface::Torus {
                minor,
                local_from_world,
            } => {
                let world = local_from_world.inverse();
                let shape = world.matrix3 * self.scale;
                put(&(world.translation * self.scale).to_array());
                put(&outer(&[shape.x_axis, shape.y_axis]));
                put(&outer(&[shape.z_axis]));
                put(&[*minor]);
                4
            }
        };
        Fingerprint { kind, numbers }
    }
}

/// The sum of the vectors' outer products: six numbers.
fn outer(vectors: &[DVec3]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for v in vectors {
        for (s, term) in sum.iter_mut().zip([
            v.x * v.x,
            v.y * v.y,
            v.z * v.z,
            v.x * v.y,
            v.y * v.z,
            v.z * v.x,
        ]) {
            *s += term;
        }
    }
    sum
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

fn coincide(a: &Fingerprint, b: &Fingerprint) -> bool {
    a.kind == b.kind
        && a.numbers
            .iter()
            .zip(&b.numbers)
            .all(|(x, y)| (x - y).abs() <= SURFACE_TOLERANCE)
}

fn home(fingerprint: &Fingerprint) -> HashCell {
    let cell = std::array::from_fn(|i| libm::floor(fingerprint.numbers[i] / CELL) as i64);
    (fingerprint.kind, cell)
}

/// The hash cells in which a coincident fingerprint may live: nearly always one.
fn neighbours(fingerprint: &Fingerprint) -> Vec<HashCell> {
    let mut cells = vec![home(fingerprint)];
    for axis in 0..HASHED {
        let value = fingerprint.numbers[axis];
        for shifted in [value - SURFACE_TOLERANCE, value + SURFACE_TOLERANCE] {
            let index = libm::floor(shifted / CELL) as i64;
            if index != cells[0].1[axis] {
                for i in 0..cells.len() {
                    let mut cell = cells[i];
                    cell.1[axis] = index;
                    cells.push(cell);
                }
                break;
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_math::DAffine3;
    use proptest::prelude::*;

    fn plane(normal: DVec3, offset: f64) -> Surface {
        Surface::Plane { normal, offset }
    }

    #[test]
    fn planes_merge_within_the_tolerance_only() {
        let mut table = SurfaceTable::new(10.0);
        let a = table.insert(plane(DVec3::Z, 10.0));
        assert_eq!(table.insert(plane(DVec3::Z, 10.0 + 5e-12)), a);
        assert_ne!(table.insert(plane(DVec3::Z, 10.0 + 5e-11)), a);
        assert_ne!(table.insert(plane(DVec3::X, 10.0)), a);
    }

    #[test]
    fn a_cylinder_is_the_same_wherever_along_its_axis_it_was_made() {
        let cylinder = |frame: DAffine3| Surface::Quadric {
            kind: Quadric::Cylinder,
            local_from_world: frame.inverse(),
        };
        let scale = DAffine3::from_scale(DVec3::splat(2.0));
        let tilt = DAffine3::from_rotation_x(0.7);
        let mut table = SurfaceTable::new(10.0);
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
        let cone = |base: f64, radius: f64, slope: f64| Surface::Cone {
            slope,
            local_from_world: (DAffine3::from_translation(DVec3::new(1.0, 2.0, base))
                * DAffine3::from_scale(DVec3::splat(radius)))
            .inverse(),
        };
        let mut table = SurfaceTable::new(5.0);
        let a = table.insert(cone(0.0, 4.0, -2.0));
        assert_eq!(table.insert(cone(1.0, 2.0, -2.0)), a);
        assert_ne!(table.insert(cone(1.0, 2.1, -2.0)), a);
        let b = table.insert(cone(0.0, 2.0, -1e-15));
        assert_ne!(table.insert(cone(0.0, 2.1, -1e-15)), b);
    }

    proptest! {
        #[test]
        fn cell_borders_do_not_hide_coincidence(offset in -1.0..1.0f64, steps in -300i32..300) {
            // Start on and around a border of a hash cell.
            let border = libm::round(offset / CELL) * CELL + f64::from(steps) * SURFACE_TOLERANCE * 0.01;
            let mut table = SurfaceTable::new(1.0);
            let a = table.insert(plane(DVec3::Y, border));
            prop_assert_eq!(table.insert(plane(DVec3::Y, border + 0.9 * SURFACE_TOLERANCE)), a);
            prop_assert_eq!(table.insert(plane(DVec3::Y, border - 0.9 * SURFACE_TOLERANCE)), a);
            prop_assert_ne!(table.insert(plane(DVec3::Y, border + 2.0 * SURFACE_TOLERANCE)), a);
        }
    }
}
