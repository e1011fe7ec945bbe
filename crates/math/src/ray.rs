use glam::{DAffine3, DVec3};

/// The line `p(t) = origin + t * direction`.
///
/// The direction has any non-zero length; `t` is measured in units of it, and transforms keep
/// `t` because they never renormalise. Which values of `t` count is said beside the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at `t = 0`.
    pub origin: DVec3,
    /// The point at `t = 1` minus the point at `t = 0`.
    pub direction: DVec3,
}

impl Ray {
    /// A ray from `origin` along `direction`.
    #[must_use]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction }
    }

    /// The point at parameter `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The same line seen from another frame; parameters are unchanged.
    #[must_use]
    pub fn transformed(&self, into_from_here: &DAffine3) -> Self {
        Self {
            origin: into_from_here.transform_point3(self.origin),
            direction: into_from_here.transform_vector3(self.direction),
        }
    }

    /// The parameter at which the line comes closest to `point`.
    #[must_use]
    pub fn closest_approach(&self, point: DVec3) -> f64 {
        let length_squared = self.direction.length_squared();
        -(self.origin - point).dot(self.direction) / length_squared
    }

    /// The same line with its origin moved to parameter `shift`.
    ///
    /// A parameter `t` of `self` is `t - shift` of the result.
    #[must_use]
    pub fn shifted(&self, shift: f64) -> Self {
        Self {
            origin: self.at(shift),
            direction: self.direction,
        }
    }

    /// Whether every coordinate is finite and the direction is not zero.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction.length_squared() > 0.0
            && self.direction.length_squared().is_finite()
    }
}
