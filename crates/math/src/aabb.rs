use crate::{DAffine3, DVec3, Interval, Ray};

/// An axis-aligned box, possibly unbounded; empty where `min > max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The box that holds nothing: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    /// All of space: the neutral element of [`Aabb::intersection`].
    pub const ALL: Self = Self {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };

    /// The box between two corners.
    #[must_use]
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around the points.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// This box grown to hold `point`.
    #[must_use]
    pub fn including(self, point: DVec3) -> Self {
        Self::new(self.min.min(point), self.max.max(point))
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// The common part.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self::new(self.min.max(other.min), self.max.min(other.max))
    }

    /// Whether it holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether it is empty or has finite corners.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.is_empty() || (self.min.is_finite() && self.max.is_finite())
    }

    /// The point half way between the corners.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Half the edge lengths.
    #[must_use]
    pub fn half_size(&self) -> DVec3 {
        self.max * 0.5 - self.min * 0.5
    }

    /// Length of the space diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// Area of the six faces.
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        let s = self.size();
        2.0 * (s.x * s.y + s.y * s.z + s.z * s.x)
    }

    /// Whether `point` lies inside or on the boundary.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Whether all of `other` lies inside.
    #[must_use]
    pub fn contains_box(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && other.max.cmple(self.max).all())
    }

    /// Whether the boxes share a point.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// This box grown by `margin` on every side.
    #[must_use]
    pub fn inflated(&self, margin: f64) -> Self {
        Self::new(self.min - margin, self.max + margin)
    }

    /// The eight corners; bit 0 of the index chooses x, bit 1 y, bit 2 z.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The axis-aligned box around the transformed box (Arvo 1990); unbounded stays unbounded.
    #[must_use]
    pub fn transformed(&self, into_from_here: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() {
            return Self::ALL;
        }
        let center = into_from_here.transform_point3(self.center());
        let m = into_from_here.matrix3;
        let half = self.half_size();
        let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        Self::new(center - reach, center + reach)
    }

    /// The parameters at which the line is inside, by the slab method (Kay & Kajiya 1986).
    ///
    /// A line parallel to a slab is inside it or not as a whole. The ends carry a rounding
    /// error of a few ulps: inflate the box where that matters.
    #[must_use]
    pub fn clip(&self, ray: &Ray) -> Interval {
        let mut span = Interval::ALL;
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            if d == 0.0 {
                if o < self.min[axis] || o > self.max[axis] {
                    return Interval::EMPTY;
                }
                continue;
            }
            let a = (self.min[axis] - o) / d;
            let b = (self.max[axis] - o) / d;
            span = span.intersection(&Interval::new(a.min(b), a.max(b)));
        }
        span
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clip_of_a_parallel_line_is_all_or_nothing() {
        let unit = Aabb::new(DVec3::ZERO, DVec3::ONE);
        let along_x = |y: f64| Ray::new(DVec3::new(-1.0, y, 0.5), DVec3::X);
        assert_eq!(unit.clip(&along_x(0.5)), Interval::new(1.0, 2.0));
        assert!(unit.clip(&along_x(1.5)).is_empty());
    }

    #[test]
    fn transformed_box_holds_the_transformed_corners() {
        let unit = Aabb::new(DVec3::ZERO, DVec3::ONE);
        let m = DAffine3::from_rotation_z(0.3) * DAffine3::from_scale(DVec3::new(1.0, -2.0, 3.0));
        let moved = unit.transformed(&m).inflated(1e-12);
        for corner in unit.corners() {
            assert!(moved.contains(m.transform_point3(corner)));
        }
    }
}
