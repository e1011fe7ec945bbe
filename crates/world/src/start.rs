//! Rays that start on a surface without having been told so: a camera on a floor, a ray from a
//! point that was measured.
//!
//! The surface a ray starts on is behind it, like that of a [`crate::Departure`]. Whether a start
//! lies on a surface can be told only up to the rounding of its own coordinates, so a boundary
//! counts as behind that is no farther from the start than that. Where the ray grazes a surface it
//! cannot be told at all; there the parameter decides, as it does everywhere else.

use octray_math::DVec3;

use crate::line::Line;
use crate::solids::Interface;
use crate::{Departure, World};

/// How many rounding errors of its coordinates a start may be off the surface that it lies on.
const ROUNDINGS: f64 = 8.0;
/// Cosine of the flattest incidence at which a start lies on a surface.
const FLATTEST: f64 = 1.0 / (1u64 << 20) as f64;

impl World {
    /// Whether the line starts on a boundary that it crosses ahead of its start.
    pub(crate) fn starts_on(&self, line: &Line, found: &Interface) -> bool {
        let ahead = found.s - line.start();
        // The line's start is a point of the ray: no farther from the centre than this.
        let size = self.place.frame.size + line.start().abs();
        let rounding = ROUNDINGS * f64::EPSILON * size;
        if ahead * FLATTEST > rounding
            || line.departure != Departure::NONE
            || !line.origin.is_finite()
        {
            return false;
        }
        if ahead <= rounding {
            return true;
        }
        let start = line.ray.at(line.start());
        let face = (found.instance, found.face, found.entering);
        let point = self.point(line, face, start);
        let normal = point.map_or(DVec3::ZERO, |(point, _)| point.normal);
        let climb = normal.dot(line.ray.direction).abs();
        climb >= FLATTEST && ahead * climb <= rounding
    }
}
