//! A decided box lies on its side.

use super::{implicit, implicit_value};
use crate::surface::{Canonical, Side, Surface};
use octray_math::{Aabb, DAffine3, DVec3};
use proptest::prelude::*;

fn point(range: f64) -> impl Strategy<Value = DVec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn surface() -> impl Strategy<Value = Surface> {
    let frame = (point(2.0), point(3.0), point(2.0)).prop_map(|(axis, shift, scale)| {
        DAffine3::from_scale(scale.abs() + 0.1)
            * DAffine3::from_rotation_x(axis.x)
            * DAffine3::from_rotation_y(axis.y)
            * DAffine3::from_translation(shift)
    });
    let shape = (0..5, 0.01..2.0f64, implicit());
    (shape, frame).prop_map(|((which, minor, implicit), local_from_scene)| {
        let canonical = match which {
            0 => Canonical::Sphere,
            1 => Canonical::Cylinder,
            2 => Canonical::Cone {
                slope: -0.5 * minor,
            },
            3 => Canonical::Torus { minor },
            4 if minor > 0.5 => implicit,
            _ => {
                return Surface::Plane {
                    normal: local_from_scene.matrix3.x_axis.normalize(),
                    offset: local_from_scene.translation.x,
                };
            }
        };
        Surface::Curved {
            canonical,
            local_from_scene,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    #[test]
    fn a_decided_box_has_all_its_points_on_that_side(
        surface in surface(), center in point(3.0), half in point(1.0),
        exponent in 0..12, inside in proptest::collection::vec(point(1.0), 16),
    ) {
        let half = half.abs() / f64::from(1 << exponent);
        let bounds = Aabb::new(center - half, center + half);
        let side = surface.classify(&bounds);
        for s in inside.into_iter().chain(Aabb::new(-DVec3::ONE, DVec3::ONE).corners()) {
            let v = implicit_value(&surface, center + half * s);
            match side {
                Side::Positive => prop_assert!(v > 0.0),
                Side::Negative => prop_assert!(v < 0.0),
                Side::Both => {}
            }
        }
    }

    #[test]
    fn a_small_box_is_decided_unless_it_is_near_the_surface(
        surface in surface(), center in point(3.0),
    ) {
        let half = DVec3::splat(1e-4);
        let bounds = Aabb::new(center - half, center + half);
        // The local frame stretches by at most about 2.1; functions are at most quadratic.
        prop_assume!(implicit_value(&surface, center).abs() > 0.05);
        prop_assert_ne!(surface.classify(&bounds), Side::Both);
    }
}
