//! On which side of a surface a box lies: conservative, never wrong, seldom undecided.
//!
//! In the surface's own frame the box is a parallelepiped with centre `c` and half edges `e_i`.
//! Two enclosures of the implicit function are intersected: one from the axis-aligned box around
//! the parallelepiped (tight far away and for large boxes), one from the function's value and
//! gradient at the centre plus a bound of its quadratic part (error of second order in the size,
//! tight for small boxes in any orientation).

use octray_math::{Aabb, DAffine3, DVec3};

use super::{Quadric, Side, Surface};

/// Rounding allowance relative to the magnitudes that were added.
const SLACK: f64 = 1e-13;

struct LocalBox {
    center: DVec3,
    edges: [DVec3; 3],
    /// Half size of the axis-aligned box around it.
    reach: DVec3,
}

impl LocalBox {
    fn new(bounds: &Aabb, local_from_world: &DAffine3) -> Self {
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
    fn linear(&self, gradient: DVec3) -> f64 {
        self.edges.iter().map(|e| gradient.dot(*e).abs()).sum()
    }

    /// The largest `|W x|^2` over the edges' span, for a diagonal matrix `W`.
    fn quadratic(&self, weights: DVec3) -> f64 {
        let [a, b, c] = self.edges.map(|e| e * weights);
        [a + b + c, a + b - c, a - b + c, a - b - c]
            .into_iter()
            .map(DVec3::length_squared)
            .fold(0.0, f64::max)
    }

    /// Smallest and largest `|x_axis|` over the axis-aligned box, per axis.
    fn absolute_range(&self) -> (DVec3, DVec3) {
        let size = self.center.abs();
        ((size - self.reach).max(DVec3::ZERO), size + self.reach)
    }
}

fn decide(low: f64, high: f64, magnitude: f64) -> Side {
    let slack = SLACK * magnitude;
    if low > slack {
        Side::Positive
    } else if high < -slack {
        Side::Negative
    } else {
        Side::Both
    }
}

impl Surface {
    /// The side on which all of a bounded box lies. [`Side::Both`] too often, never too seldom.
    #[must_use]
    pub fn classify(&self, bounds: &Aabb) -> Side {
        match self {
            Self::Plane { normal, offset } => {
                let (center, half) = (bounds.center(), bounds.half_size());
                let height = normal.dot(center) - offset;
                let reach = normal.abs().dot(half);
                let magnitude = normal.abs().dot(center.abs()) + offset.abs() + reach;
                decide(height - reach, height + reach, magnitude)
            }
            Self::Quadric {
                kind,
                local_from_world,
            } => {
                let local = LocalBox::new(bounds, local_from_world);
                let magnitude = local.center.length_squared() + local.reach.length_squared() + 1.0;
                match kind {
                    Quadric::Sphere => round(&local, DVec3::ONE, magnitude),
                    Quadric::Cylinder => round(&local, DVec3::new(1.0, 1.0, 0.0), magnitude),
                }
            }
            Self::Cone {
                slope,
                local_from_world,
            } => cone(*slope, &LocalBox::new(bounds, local_from_world)),
            Self::Torus {
                minor,
                local_from_world,
            } => torus(*minor, &LocalBox::new(bounds, local_from_world)),
        }
    }
}

/// `|W x|^2 - 1`.
fn round(local: &LocalBox, weights: DVec3, magnitude: f64) -> Side {
    let (near, far) = local.absolute_range();
    let center = local.center * weights;
    let value = center.length_squared() - 1.0;
    let linear = local.linear(center * 2.0);
    let low = ((near * weights).length_squared() - 1.0).max(value - linear);
    let high =
        ((far * weights).length_squared() - 1.0).min(value + linear + local.quadratic(weights));
    decide(low, high, magnitude)
}

/// `x^2 + y^2 - (1 + slope z)^2`.
fn cone(slope: f64, local: &LocalBox) -> Side {
    let (near, far) = local.absolute_range();
    let c = local.center;
    let radius = 1.0 + slope * c.z;
    let growth = (slope * local.reach.z).abs();
    let (least, most) = ((radius.abs() - growth).max(0.0), radius.abs() + growth);
    let value = c.x * c.x + c.y * c.y - radius * radius;
    let linear = local.linear(DVec3::new(c.x, c.y, -slope * radius) * 2.0);
    let across = DVec3::new(1.0, 1.0, 0.0);
    let low = ((near * across).length_squared() - most * most)
        .max(value - linear - local.quadratic(DVec3::Z * slope));
    let high = ((far * across).length_squared() - least * least)
        .min(value + linear + local.quadratic(across));
    // The height enters the radius with its own rounding.
    let height = slope * (c.z.abs() + local.reach.z);
    let magnitude = c.length_squared() + local.reach.length_squared() + height * height + 1.0;
    decide(low, high, magnitude)
}

/// `hypot(rho - 1, z) - minor`, which changes by at most the distance moved.
fn torus(minor: f64, local: &LocalBox) -> Side {
    let distance = |rho: f64, z: f64| {
        let from_ring = rho - 1.0;
        (from_ring * from_ring + z * z).sqrt() - minor
    };
    let c = local.center;
    let value = distance((c.x * c.x + c.y * c.y).sqrt(), c.z);
    let radius = local.quadratic(DVec3::ONE).sqrt();
    let (near, far) = local.absolute_range();
    let rho_near = (near.x * near.x + near.y * near.y).sqrt();
    let rho_far = (far.x * far.x + far.y * far.y).sqrt();
    let ring_near = 1.0_f64.clamp(rho_near, rho_far);
    let ring_far = if 1.0 - rho_near > rho_far - 1.0 {
        rho_near
    } else {
        rho_far
    };
    let low = distance(ring_near, near.z).max(value - radius);
    let high = distance(ring_far, far.z).min(value + radius);
    decide(low, high, 1.0 + minor + c.length() + radius)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        (0..5, frame, 0.01..2.0f64).prop_map(|(which, local_from_world, minor)| match which {
            0 => Surface::Quadric {
                kind: Quadric::Sphere,
                local_from_world,
            },
            1 => Surface::Quadric {
                kind: Quadric::Cylinder,
                local_from_world,
            },
            2 => Surface::Cone {
                slope: -0.5 * minor,
                local_from_world,
            },
            3 => Surface::Torus {
                minor,
                local_from_world,
            },
            _ => Surface::Plane {
                normal: local_from_world.matrix3.x_axis.normalize(),
                offset: local_from_world.translation.x,
            },
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
                let v = surface.implicit_value(center + half * s);
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
            prop_assume!(surface.implicit_value(center).abs() > 0.05);
            prop_assert_ne!(surface.classify(&bounds), Side::Both);
        }
    }
}
