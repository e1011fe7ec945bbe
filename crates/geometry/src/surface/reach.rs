//! How far the insides of surfaces reach: what is far from a small one need not look at it closely.

use octray_math::{Aabb, DVec3};

use super::{Canonical, Surface};

/// A box, in single precision and rounded outwards, outside of which everything lies on the positive
/// side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    min: [f32; 3],
    max: [f32; 3],
}

/// What the box is grown by, in units of the largest coordinate that went into it: far more than
/// rounding, and than the slack with which sides are decided.
const GROWTH: f64 = 1e-6;
/// A frame that stretches by more is not inverted exactly enough.
const LARGEST_CONDITION: f64 = 1e6;

impl Reach {
    /// All of space.
    pub const EVERYWHERE: Self = Self {
        min: [f32::NEG_INFINITY; 3],
        max: [f32::INFINITY; 3],
    };

    /// Whether the box and another meet.
    #[must_use]
    pub fn overlaps(&self, other: &Aabb) -> bool {
        (0..3).all(|axis| {
            f64::from(self.min[axis]) <= other.max[axis]
                && other.min[axis] <= f64::from(self.max[axis])
        })
    }
}

impl Surface {
    /// A box outside of which everything lies on the positive side.
    #[must_use]
    pub fn reach(&self) -> Reach {
        let Self::Curved {
            canonical,
            local_from_scene,
        } = self
        else {
            return Reach::EVERYWHERE;
        };
        // The half diameters along the axes of the canonical shape's box; infinite where it has no end.
        let half = match canonical {
            Canonical::Sphere | Canonical::Superellipsoid { .. } => DVec3::ONE,
            Canonical::Cylinder => DVec3::new(1.0, 1.0, f64::INFINITY),
            Canonical::Torus { minor } => DVec3::new(1.0 + minor, 1.0 + minor, *minor),
            _ => return Reach::EVERYWHERE,
        };
        let scene_from_local = local_from_scene.inverse();
        let (m, inverse) = (scene_from_local.matrix3, local_from_scene.matrix3);
        let size = |m: &octray_math::DMat3| {
            [m.x_axis, m.y_axis, m.z_axis]
                .map(|axis| axis.abs().max_element())
                .into_iter()
                .fold(0.0, f64::max)
        };
        let condition = size(&m) * size(&inverse);
        if condition.is_nan() || condition > LARGEST_CONDITION {
            return Reach::EVERYWHERE;
        }
        let center = scene_from_local.translation;
        let mut reach = Reach::EVERYWHERE;
        for axis in 0..3 {
            let share = |column: DVec3, half: f64| {
                // Nothing of an axis without end, if it does not lean that way at all.
                if column[axis] == 0.0 {
                    0.0
                } else {
                    column[axis].abs() * half
                }
            };
            // The sum holds both ellipsoids and boxes.
            let extent =
                share(m.x_axis, half.x) + share(m.y_axis, half.y) + share(m.z_axis, half.z);
            let largest = center.abs().max_element() + extent + size(&m);
            let margin = GROWTH * largest;
            let (low, high) = (
                center[axis] - extent - margin,
                center[axis] + extent + margin,
            );
            // Rounded to the nearest it moves by less than the margin, unless it leaves the range.
            if low.is_finite() && low.abs() < 1e37 {
                reach.min[axis] = low as f32;
            }
            if high.is_finite() && high.abs() < 1e37 {
                reach.max[axis] = high as f32;
            }
        }
        reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Side;
    use octray_math::DAffine3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn nothing_but_the_positive_side_lies_outside(
            shape in 0..4, turn in -3.0..3.0f64, lean in -1.0..1.0f64,
            size in prop::array::uniform3(0.01..3.0f64), at in prop::array::uniform3(-9.0..9.0f64),
            point in prop::array::uniform3(-12.0..12.0f64),
        ) {
            let canonical = match shape {
                0 => Canonical::Sphere,
                1 => Canonical::Cylinder,
                2 => Canonical::Torus { minor: 0.3 },
                _ => Canonical::Superellipsoid { exponents: [0.4, 1.5] },
            };
            let frame = DAffine3::from_translation(DVec3::from_array(at))
                * DAffine3::from_rotation_z(turn)
                * DAffine3::from_rotation_x(if turn < 0.0 { lean } else { 0.0 })
                * DAffine3::from_scale(DVec3::from_array(size));
            let surface = Surface::Curved { canonical, local_from_scene: frame.inverse() };
            let reach = surface.reach();
            let p = DVec3::from_array(point);
            let there = Aabb::new(p, p);
            if surface.classify(&there) == Side::Negative {
                prop_assert!(reach.overlaps(&there));
            }
            // On the surface of the canonical shape's box nothing is lost either.
            let corner = frame.transform_point3(DVec3::new(1.0, 0.0, 0.0));
            prop_assert!(reach.overlaps(&Aabb::new(corner, corner)));
        }
    }

    #[test]
    fn small_surfaces_have_small_boxes() {
        let ball = |at: f64| Surface::Curved {
            canonical: Canonical::Sphere,
            local_from_scene: DAffine3::from_translation(DVec3::splat(at)).inverse(),
        };
        let near = Aabb::new(DVec3::splat(1.1), DVec3::splat(1.2));
        assert!(!ball(0.0).reach().overlaps(&near) && ball(1.5).reach().overlaps(&near));
        let plane = Surface::Plane {
            normal: DVec3::X,
            offset: 0.0,
        };
        assert!(plane.reach().overlaps(&near));
    }
}
