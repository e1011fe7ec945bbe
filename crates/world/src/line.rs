//! Rays as the structures see them: moved and scaled so that rounding stays small.

use octray_geometry::{SceneFrame, Sheet, finite_box};
use octray_math::{DVec3, Ray};
use octray_scene::{Scene, Shape};

use crate::{Departure, RayQuery};

/// The bits of a positive number that say its power of two.
const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;
const ONE_BITS: u64 = 1.0_f64.to_bits();

/// More than a few roundings.
const LIMIT_ROUNDING: f64 = 1.0 / (1u64 << 49) as f64;

/// Where the scene is: the coordinates it is worked on in, and its centre in them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) frame: SceneFrame,
    center: DVec3,
    /// A 256th of the power of two below the scene's size, and its reciprocal.
    step: f64,
    per_step: f64,
}

impl Place {
    /// Of a scene.
    pub(crate) fn new(scene: &Scene) -> Self {
        let solids = scene.objects().iter().flat_map(|object| {
            let solids = match &object.shape {
                Shape::Solid(solid) => [Some(solid), None],
                Shape::Sheet(Sheet::Shell { solid, clip }) => [Some(solid), Some(clip)],
                Shape::Sheet(Sheet::Mesh { .. }) | Shape::Instances(_) => [None, None],
            };
            let bounds = object.shape.bounds();
            let unbounded = !bounds.is_empty() && !bounds.is_bounded();
            solids.into_iter().flatten().filter(move |_| unbounded)
        });
        let bounds = finite_box(scene.bounds(), &solids.collect::<Vec<_>>());
        let frame = SceneFrame::new(&bounds);
        let center = if bounds.is_empty() || !bounds.is_bounded() {
            DVec3::ZERO
        } else {
            bounds.center() - frame.origin
        };
        let step = libm::ldexp(1.0, libm::ilogb(frame.size) - 8);
        Self {
            frame,
            center,
            step,
            per_step: step.recip(),
        }
    }

    /// `shift` to within a 512th of the scene's size, as a short number: a line whose coordinates
    /// are short numbers then has an exact origin, and crosses the planes that meet in an edge at
    /// one parameter if it goes through the edge.
    #[inline(always)]
    fn short(&self, shift: f64) -> f64 {
        let steps = (shift * self.per_step).round_ties_even();
        if steps.is_finite() {
            steps * self.step
        } else {
            shift
        }
    }

    /// A point of the world in the scene's coordinates.
    #[inline(always)]
    pub(crate) fn scene_from_world(&self, point: DVec3) -> DVec3 {
        point - self.frame.origin
    }
}

/// A ray in the coordinates of the scene whose origin lies about at its closest approach to the
/// scene's centre and whose direction's largest component lies in `[1, 2)`.
///
/// Everything is tested against `ray` and compared by its parameter `s`; the user's parameter is
/// `t = (s - origin) / scale`. Far origins then cost no digits, and no length of direction
/// overflows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) ray: Ray,
    /// Parameter from which on the line counts: that of the query's origin, `-inf` where the whole
    /// line does.
    pub(crate) origin: f64,
    /// Parameter of the query's end.
    pub(crate) end: f64,
    pub(crate) departure: Departure,
    shift: f64,
    scale: f64,
}

/// The direction divided by the power of two below its largest component, and that power.
#[inline(always)]
fn scaled(direction: DVec3, largest: f64) -> (DVec3, f64) {
    if (1e-300..1e300).contains(&largest) {
        let power = largest.to_bits() & EXPONENT_BITS;
        // The reciprocal of a power of two, without dividing.
        let inverse = f64::from_bits(2 * ONE_BITS - power);
        return (direction * inverse, f64::from_bits(power));
    }
    scaled_far(direction, largest)
}

/// The same for directions whose power of two, or its reciprocal, is no normal number.
#[cold]
fn scaled_far(direction: DVec3, largest: f64) -> (DVec3, f64) {
    let exponent = libm::ilogb(largest);
    let scaled = direction.to_array().map(|x| libm::ldexp(x, -exponent));
    (DVec3::from_array(scaled), libm::ldexp(1.0, exponent))
}

impl Line {
    /// `None` for a ray with a NaN, an infinity or no direction: it meets nothing.
    #[inline(always)]
    pub(crate) fn new(query: &RayQuery, place: &Place) -> Option<Self> {
        let Ray { origin, direction } = query.ray;
        let largest = direction.abs().max_element();
        if !(origin.is_finite() && direction.is_finite() && largest > 0.0) {
            return None;
        }
        // Powers of two: exact, except for directions so small that they have few digits anyway.
        let (direction, scale) = scaled(direction, largest);
        let unit = Ray::new(place.scene_from_world(origin), direction);
        let shift = place.short(unit.closest_approach(place.center));
        let ray = unit.shifted(shift);
        if !(ray.origin.is_finite() && scale > 0.0) {
            return None;
        }
        Some(Self {
            ray,
            origin: -shift,
            end: query.t_max * scale - shift,
            // Field by field: as a whole, with its padding, it is written and read in unequal parts.
            departure: Departure {
                face: query.departure.face,
                instance: query.departure.instance,
                outward: query.departure.outward,
            },
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

    /// Parameter of the ray's start, wherever the line counts from.
    pub(crate) fn start(&self) -> f64 {
        -self.shift
    }

    /// The same half-line counting from `s` on, which is where its start lies.
    pub(crate) const fn beyond(mut self, s: f64) -> Self {
        self.origin = s;
        self
    }

    /// The same line seen from a prototype's coordinates, where it is `ray` with the parameters of
    /// this line.
    pub(crate) fn seen_as(&self, ray: Ray, place: &Place, departure: Departure) -> Option<Self> {
        let query = RayQuery {
            ray,
            t_max: self.end,
            departure,
        };
        let mut line = Self::new(&query, place)?;
        line.origin = line.inner(self.origin);
        Some(line)
    }

    /// The parameter of the line that this one was seen from.
    pub(crate) fn outer(&self, s: f64) -> f64 {
        // There is one zero.
        (s + self.shift) / self.scale + 0.0
    }

    /// The parameter on this line, given that on the line it was seen from.
    pub(crate) fn inner(&self, s: f64) -> f64 {
        s * self.scale - self.shift
    }

    /// A parameter not before any that is at most `s` on the line this one was seen from.
    pub(crate) fn inner_limit(&self, s: f64) -> f64 {
        let limit = self.inner(s);
        if limit.is_finite() {
            limit + ((s * self.scale).abs() + self.shift.abs() + limit.abs()) * LIMIT_ROUNDING
        } else {
            limit
        }
    }

    /// The user's parameter. On a half-line it is 0 where that begins to count and never negative:
    /// what counts lies after the origin, and rounding must not say otherwise.
    pub(crate) fn t(&self, s: f64) -> f64 {
        let t = (s + self.shift) / self.scale;
        if !self.origin.is_finite() {
            t
        } else if s <= self.origin {
            0.0
        } else {
            t.max(0.0)
        }
    }
}
