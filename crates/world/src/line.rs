//! Rays as the structures see them: moved and scaled so that rounding stays small.

use octray_geometry::SceneFrame;
use octray_math::{Aabb, DVec3, Ray};

use crate::{Departure, RayQuery};

/// The bits of a positive number that say its power of two.
const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;

/// Where the scene is: the coordinates it is worked on in, and its centre in them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) frame: SceneFrame,
    center: DVec3,
}

impl Place {
    /// Of the bounded objects in this box, which may be empty.
    pub(crate) fn new(bounds: &Aabb) -> Self {
        let frame = SceneFrame::new(bounds);
        let center = if bounds.is_empty() || !bounds.is_bounded() {
            DVec3::ZERO
        } else {
            bounds.center() - frame.origin
        };
        Self { frame, center }
    }

    /// A point of the world in the scene's coordinates.
    pub(crate) fn scene_from_world(&self, point: DVec3) -> DVec3 {
        point - self.frame.origin
    }
}

/// A ray in the coordinates of the scene whose origin lies at its closest approach to the scene's centre and whose direction's
/// largest component lies in `[1, 2)`.
///
/// Everything is tested against `ray` and compared by its parameter `s`; the user's parameter is
/// `t = (s - origin) / scale`. Far origins then cost no digits, and no length of direction
/// overflows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) ray: Ray,
    /// Parameter of the query's origin; `-inf` where the whole line counts.
    pub(crate) origin: f64,
    /// Parameter of the query's end.
    pub(crate) end: f64,
    pub(crate) departure: Departure,
    shift: f64,
    scale: f64,
}

/// The direction divided by the power of two below its largest component, and that power.
fn scaled(direction: DVec3, largest: f64) -> (DVec3, f64) {
    // The same as below, for lengths whose powers are normal numbers.
    if (1e-300..1e300).contains(&largest) {
        let power = f64::from_bits(largest.to_bits() & EXPONENT_BITS);
        return (direction * power.recip(), power);
    }
    let exponent = libm::ilogb(largest);
    let scaled = direction.to_array().map(|x| libm::ldexp(x, -exponent));
    (DVec3::from_array(scaled), libm::ldexp(1.0, exponent))
}

impl Line {
    /// `None` for a ray with a NaN, an infinity or no direction: it meets nothing.
    pub(crate) fn new(query: &RayQuery, place: &Place) -> Option<Self> {
        let Ray { origin, direction } = query.ray;
        let largest = direction.abs().max_element();
        if !(origin.is_finite() && direction.is_finite() && largest > 0.0) {
            return None;
        }
        // Powers of two: exact, except for directions so small that they have few digits anyway.
        let (direction, scale) = scaled(direction, largest);
        let unit = Ray::new(origin - place.frame.origin, direction);
        let shift = unit.closest_approach(place.center);
        let ray = unit.shifted(shift);
        if !(ray.origin.is_finite() && scale > 0.0) {
            return None;
        }
        Some(Self {
            ray,
            origin: -shift,
            end: query.t_max * scale - shift,
            departure: query.departure,
            shift,
            scale,
        })
    }

    /// The same line with all its parameters counting.
    pub(crate) const fn whole(mut self) -> Self {
        self.origin = f64::NEG_INFINITY;
        self.end = f64::INFINITY;
        self
    }

    /// The user's parameter. Never negative on a half-line: what counts lies after the origin, and
    /// rounding must not say otherwise.
    pub(crate) fn t(&self, s: f64) -> f64 {
        let t = (s + self.shift) / self.scale;
        if self.origin.is_finite() {
            t.max(0.0)
        } else {
            t
        }
    }
}
