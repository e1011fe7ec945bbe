//! What becomes of flat shapes: they are drawn out or turned.
//!
//! Drawing out, turning and set operations may be done in any order, so each flat shape becomes a
//! solid of its own, and the operations on them are those on solids.

use octray_geometry::profile::{Region, Turning};
use octray_geometry::{ShapeError, Solid};
use octray_math::{DAffine3, DMat3, DVec3};

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drawing {
    /// `linear_extrude`.
    Out(Slab),
    /// `rotate_extrude`.
    Turned(Turn),
}

/// One of the drawings of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DrawingId(pub(super) u32);

/// From where to where, and how large the top is in units of the bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slab {
    pub(super) z: [f64; 2],
    pub(super) top: f64,
}

/// A turn about the y axis of the plane, which becomes the z axis of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// Where the shape lies in the plane.
    pub(super) place: DAffine3,
    /// How far, and whether in straight steps.
    pub(super) turning: Turning,
}

impl Drawing {
    /// What a transform of flat shapes means: one of solids, to be applied to what comes out, and
    /// the drawing for what lies within.
    pub(super) fn transformed(self, own: DAffine3) -> (DAffine3, Self) {
        let m = own.matrix3;
        let (x, y) = (m.x_axis.with_z(0.0), m.y_axis.with_z(0.0));
        let shift = own.translation.with_z(0.0);
        let flat = |z, shift| DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), shift);
        match self {
            Self::Out(slab) => {
                // The shift is as much larger or smaller at every height as the shape.
                let growth = (slab.top - 1.0) / (slab.z[1] - slab.z[0]);
                let leaning = DVec3::Z + shift * growth;
                let there = flat(leaning, shift * (1.0 - growth * slab.z[0]));
                (there, self)
            }
            Self::Turned(turn) => {
                let place = turn.place * flat(DVec3::Z, shift);
                (DAffine3::IDENTITY, Self::Turned(Turn { place, ..turn }))
            }
        }
    }

    /// The solid of a region.
    pub(super) fn solid(self, region: &Region) -> Result<Solid, ShapeError> {
        match self {
            Self::Out(slab) => Solid::tapered_prism(region, slab.z, [1.0, slab.top]),
            Self::Turned(turn) => {
                // What lies beyond the axis, others may take away again.
                let Ok(half) = region.transformed(&turn.place).and_then(|r| r.right_half()) else {
                    return Ok(Solid::empty());
                };
                Solid::turned_lathe(&half, turn.turning)
            }
        }
    }
}
