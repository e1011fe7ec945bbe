//! The coordinates in which a scene is worked on.

use octray_math::{Aabb, DAffine3, DVec3};

use crate::{Primitive, Solid, SolidNode};

/// A scene far from the origin is moved there before anything is computed, so that its coordinates
/// keep their digits: a millionth of a scene's size is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFrame {
    /// The point of the world that becomes the origin.
    pub origin: DVec3,
    /// The largest coordinate of the bounded objects in these coordinates; 1 without any.
    pub size: f64,
}

impl SceneFrame {
    /// The world's own coordinates, for a scene of this size.
    #[must_use]
    pub const fn around_origin(size: f64) -> Self {
        Self {
            origin: DVec3::ZERO,
            size,
        }
    }

    /// For bounded objects in this box (which may be empty).
    ///
    /// The origin stays where it is unless the scene lies outside of its own size around it, and
    /// moves by multiples of a power of two: what is a short number stays one.
    #[must_use]
    pub fn new(bounds: &Aabb) -> Self {
        if bounds.is_empty() || !bounds.is_bounded() {
            return Self::around_origin(1.0);
        }
        let half = bounds.half_size().max_element();
        let step = if half > 0.0 {
            libm::ldexp(2.0, libm::ilogb(half))
        } else {
            0.0
        };
        let place = |x: f64| {
            let steps = libm::trunc(x / step);
            // A point, or so far away that no digit of its size is left.
            if steps.is_finite() { steps * step } else { x }
        };
        let center = bounds.center();
        let origin = DVec3::new(place(center.x), place(center.y), place(center.z));
        let moved = |corner: DVec3| (corner - origin).abs().max_element();
        let size = moved(bounds.min).max(moved(bounds.max));
        Self {
            origin,
            size: if size > 0.0 { size } else { 1.0 },
        }
    }

    /// From the user's coordinates to these.
    #[must_use]
    pub fn scene_from_world(&self) -> DAffine3 {
        DAffine3::from_translation(-self.origin)
    }

    /// The largest coordinate that the objects have in the world.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.origin.abs().max_element() + self.size
    }
}

/// The box that decides on the frame of a scene: `bounded` holds its bounded objects, and each of
/// `unbounded` adds its bounded primitives, because they are as large as its coordinates are. Where
/// there is nothing bounded at all, the unbounded primitives add the points they are given by.
pub fn finite_box<'a>(bounded: Aabb, unbounded: impl Iterator<Item = &'a Solid> + Clone) -> Aabb {
    let add = |anchors: bool| {
        let mut all = bounded;
        for solid in unbounded.clone() {
            add_primitives(solid, &DAffine3::IDENTITY, anchors, &mut all);
        }
        all
    };
    let finite = add(false);
    if finite.is_empty() { add(true) } else { finite }
}

fn add_primitives(solid: &Solid, world: &DAffine3, anchors: bool, all: &mut Aabb) {
    let each = |solids: &[Solid], all: &mut Aabb| {
        for solid in solids {
            add_primitives(solid, world, anchors, all);
        }
    };
    match solid.node() {
        SolidNode::Empty => {}
        SolidNode::Primitive(primitive) => {
            let bounds = match primitive {
                Primitive::HalfSpace { normal, offset } if anchors => {
                    Aabb::from_points([*normal * *offset])
                }
                Primitive::Cylinder { radius, z } if anchors => {
                    let end = z.iter().find(|z| z.is_finite()).copied().unwrap_or(0.0);
                    let corner = DVec3::new(*radius, *radius, 0.0);
                    let center = DVec3::new(0.0, 0.0, end);
                    Aabb::new(center - corner, center + corner)
                }
                other => other.bounds(),
            };
            if bounds.is_bounded() {
                *all = all.union(bounds.transformed(world));
            }
        }
        SolidNode::Transformed {
            child,
            parent_from_child,
        } => add_primitives(child, &(*world * *parent_from_child), anchors, all),
        SolidNode::WithMaterial { child, .. } | SolidNode::Complement(child) => {
            each(std::slice::from_ref(child), all);
        }
        SolidNode::Union(solids)
        | SolidNode::Intersection(solids)
        | SolidNode::Difference(solids) => each(solids, all),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unbounded_objects_are_as_large_as_what_they_are_made_of() {
        let floor = Solid::half_space(DVec3::Z, -1e9).expect("valid");
        let ball = Solid::sphere(3e8).expect("valid");
        let far = ball.translate(DVec3::X * 1e9).expect("finite");
        let hollow = Solid::difference([floor.clone(), far]);
        let unit = Aabb::new(-DVec3::ONE, DVec3::ONE);
        assert_eq!(finite_box(unit, [&floor]), unit);
        assert_eq!(finite_box(unit, [&hollow]).max.x, 1.3e9);
        let only = finite_box(Aabb::EMPTY, [&floor]);
        assert_eq!(only, Aabb::from_points([DVec3::Z * -1e9]));
    }

    #[test]
    fn a_scene_around_the_origin_stays_there() {
        let bounds = Aabb::new(DVec3::new(0.0, -3.0, -1.0), DVec3::new(10.0, 3.0, 9.0));
        let frame = SceneFrame::new(&bounds);
        assert_eq!(frame.origin, DVec3::ZERO);
        assert_eq!(frame.size, 10.0);
    }

    #[test]
    fn a_far_scene_is_moved_by_a_short_number_to_within_its_size() {
        let offset = DVec3::new(123_456.7, -1e9, 0.3);
        let bounds = Aabb::new(offset - DVec3::ONE, offset + DVec3::ONE);
        let frame = SceneFrame::new(&bounds);
        assert_eq!(frame.origin, DVec3::new(123_456.0, -1e9, 0.0));
        assert!(frame.size <= 3.0);
        assert!(frame.largest() >= 1e9);
    }

    #[test]
    fn scaling_by_a_power_of_two_scales_the_frame() {
        let bounds = Aabb::new(DVec3::new(70.1, -3.3, 12.0), DVec3::new(75.9, 3.0, 19.0));
        let frame = SceneFrame::new(&bounds);
        for k in [-30, 30] {
            let scale = libm::ldexp(1.0, k);
            let scaled = SceneFrame::new(&Aabb::new(bounds.min * scale, bounds.max * scale));
            assert_eq!(scaled.origin, frame.origin * scale);
            assert_eq!(scaled.size, frame.size * scale);
        }
    }
}
