//! Where primitives are put, and by which chain of transforms.

use octray_geometry::{Solid, SolidNode};
use octray_math::{DAffine3, DVec3, transform};

use super::Lattice;
use crate::draw::Draw;

/// A linear map that several primitives of a scene share, as the factors it is made of.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    factors: Vec<DAffine3>,
}

fn quarter_turns(draw: &mut Draw) -> DAffine3 {
    let degrees = |draw: &mut Draw| 90.0 * f64::from(draw.whole(0, 3));
    transform::rotation_xyz_degrees(DVec3::new(degrees(draw), degrees(draw), degrees(draw)))
}

fn rotation(draw: &mut Draw) -> DAffine3 {
    let axis = draw.direction();
    transform::rotation_degrees(axis, draw.between(0.0, 360.0))
}

impl Pose {
    pub(super) fn draw(draw: &mut Draw) -> Self {
        let mut factors = Vec::new();
        match draw.weighted(&[8, 2, 2, 3]) {
            0 => {}
            1 => factors.push(transform::rotation_degrees(DVec3::Z, 45.0)),
            2 => {
                let axis = DVec3::new(1.0, 1.0, draw.pick(&[0.0, 1.0]));
                factors.push(transform::rotation_degrees(
                    axis,
                    draw.pick(&[30.0, 45.0, 60.0, 120.0]),
                ));
            }
            _ => factors.push(rotation(draw)),
        }
        match draw.weighted(&[12, 2, 2, 1, 1, 1]) {
            0 => {}
            1 => factors.push(transform::mirror(draw.pick(&[DVec3::X, DVec3::ONE]))),
            2 => factors.push(DAffine3::from_scale(draw.pick(&[
                DVec3::new(2.0, 1.0, 1.0),
                DVec3::new(1.0, 0.5, 3.0),
                DVec3::splat(1.5),
            ]))),
            3 => factors.push(DAffine3::from_cols(
                DVec3::X,
                DVec3::new(0.5, 1.0, 0.0),
                DVec3::new(0.0, 0.25, 1.0),
                DVec3::ZERO,
            )),
            4 => {
                let size = DVec3::splat(1.0) + draw.direction().abs() * 3.0;
                factors.push(DAffine3::from_scale(size) * rotation(draw));
            }
            // Sheets and needles.
            _ => {
                let thin = draw.pick(&[1e-2, 1e-4]);
                let size = [DVec3::new(1.0, thin, 1.0), DVec3::new(thin, thin, 1.0)];
                factors.push(DAffine3::from_scale(draw.pick(&size)));
            }
        }
        Self { factors }
    }

    fn product(&self) -> DAffine3 {
        let factors = self.factors.iter();
        factors.fold(DAffine3::IDENTITY, |product, m| product * *m)
    }
}

fn moved(child: Solid, parent_from_child: DAffine3) -> Solid {
    SolidNode::Transformed {
        child,
        parent_from_child,
    }
    .into()
}

fn shift(draw: &mut Draw, lattice: Lattice) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| lattice.coordinate(draw)))
}

/// A primitive at a point of the lattice, turned by quarters, in a pose; by one of several chains
/// that are the same but for rounding.
pub(super) fn placed(draw: &mut Draw, lattice: Lattice, pose: &Pose, solid: Solid) -> Solid {
    let turn = if draw.chance(0.5) {
        quarter_turns(draw)
    } else {
        DAffine3::IDENTITY
    };
    let to_place = if draw.chance(0.6) {
        DAffine3::from_translation(shift(draw, lattice))
    } else {
        DAffine3::IDENTITY
    };
    let local = to_place * turn;
    match draw.below(5) {
        0 => moved(solid, pose.product() * local),
        1 => {
            let each = pose.factors.iter().rev();
            each.fold(moved(moved(solid, turn), to_place), |s, m| moved(s, *m))
        }
        2 => {
            // There and back again.
            let detour = rotation(draw) * DAffine3::from_translation(draw.direction());
            moved(
                moved(solid, detour * local),
                pose.product() * detour.inverse(),
            )
        }
        3 => {
            // A turn in three steps, a way in two.
            let axis = draw.direction();
            let third = transform::rotation_degrees(axis, 120.0);
            let half = DAffine3::from_translation(to_place.translation * 0.3);
            let rest = DAffine3::from_translation(to_place.translation * 0.7);
            let turned = (0..3).fold(solid, |s, _| moved(s, third));
            moved(moved(turned, half * rest * turn), pose.product())
        }
        _ => {
            let each = pose.factors.iter().rev().chain([]);
            let start = solid.transform(local).expect("invertible");
            each.fold(start, |s, m| s.transform(*m).expect("invertible"))
        }
    }
}

/// A whole subtree moved by a lattice vector or a turn.
pub(super) fn moved_as_a_whole(draw: &mut Draw, lattice: Lattice, solid: Solid) -> Solid {
    let by = match draw.below(3) {
        0 => DAffine3::from_translation(shift(draw, lattice)),
        1 => quarter_turns(draw),
        _ => rotation(draw),
    };
    moved(solid, by)
}

/// A scale and a place for the whole scene, sometimes.
pub(super) fn surroundings(draw: &mut Draw) -> Option<DAffine3> {
    let scale = match draw.weighted(&[10, 2, 2]) {
        0 => 1.0,
        1 => libm::ldexp(1.0, draw.whole(-40, 40)),
        _ => libm::pow(10.0, f64::from(draw.whole(-9, 9))),
    };
    let offset = match draw.weighted(&[10, 1, 1, 1]) {
        0 => DVec3::ZERO,
        1 => DVec3::new(7.0, -5.0, 3.0),
        2 => draw.direction() * 100.0,
        _ => draw.direction() * 1e6,
    };
    if scale == 1.0 && offset == DVec3::ZERO {
        return None;
    }
    let frame = DAffine3::from_scale(DVec3::splat(scale));
    Some(frame * DAffine3::from_translation(offset))
}
