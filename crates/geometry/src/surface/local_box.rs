//! A box in a shape's own frame: the parallelepiped that it becomes.
//!
//! Shapes intersect two enclosures of their implicit function: one from the axis-aligned box around
//! the parallelepiped (tight far away and for large boxes), one from the function's value and
//! gradient at the centre plus a bound of its higher terms (error of second order in the size,
//! tight for small boxes in any orientation).

use octray_math::{Aabb, DAffine3, DVec3};

use super::Side;

/// Rounding allowance relative to the magnitudes that were added.
const SLACK: f64 = 1e-13;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalBox {
    pub(super) center: DVec3,
    /// Half edges.
    pub(super) edges: [DVec3; 3],
    /// Half size of the axis-aligned box around it.
    pub(super) reach: DVec3,
}

impl LocalBox {
    pub(super) fn new(bounds: &Aabb, local_from_world: &DAffine3) -> Self {
        let half = bounds.half_size();
        let m = local_from_world.matrix3;
        let edges = [m.x_axis * half.x, m.y_axis * half.y, m.z_axis * half.z];
        Self {
            center: local_from_world.transform_point3(bounds.center()),
            reach: edges[0].abs() + edges[1].abs() + edges[2].abs(),
            edges,
        }
    }

    /// The largest `|gradient . x|` over the edges' span.
    pub(super) fn linear(&self, gradient: DVec3) -> f64 {
        let [a, b, c] = &self.edges;
        gradient.dot(*a).abs() + gradient.dot(*b).abs() + gradient.dot(*c).abs()
    }

    /// The largest `|W x|^2` over the edges' span, for a diagonal matrix `W`.
    pub(super) fn quadratic(&self, weights: DVec3) -> f64 {
        // Written out: this is what building spends its time on.
        let [a, b, c] = &self.edges;
        let (a, b, c) = (*a * weights, *b * weights, *c * weights);
        let (sum, difference) = (a + b, a - b);
        let upper = (sum + c).length_squared().max((sum - c).length_squared());
        let lower = (difference + c)
            .length_squared()
            .max((difference - c).length_squared());
        upper.max(lower)
    }

    /// Smallest and largest `|x_axis|` over the axis-aligned box, per axis.
    pub(super) fn absolute_range(&self) -> (DVec3, DVec3) {
        let size = self.center.abs();
        ((size - self.reach).max(DVec3::ZERO), size + self.reach)
    }
}

/// The side, given an enclosure of the implicit function and the magnitudes that were added up.
pub(super) fn decide(low: f64, high: f64, magnitude: f64) -> Side {
    let slack = SLACK * magnitude;
    if low > slack {
        Side::Positive
    } else if high < -slack {
        Side::Negative
    } else {
        Side::Both
    }
}
