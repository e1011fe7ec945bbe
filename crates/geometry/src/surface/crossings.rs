//! Where a line crosses a surface.
//!
//! Every solver moves its origin to the point of the line that is closest to the surface's centre
//! first (Haines et al., *Precision Improvements for Ray/Sphere Intersection*, Ray Tracing Gems,
//! chapter 7): then the constant term is a distance, not a difference of large numbers.

use octray_math::roots::{self, SignChanges};
use octray_math::{DVec3, Ray};

use super::{Quadric, Surface};

impl Surface {
    /// The parameters at which the line changes sides, and the side it comes from.
    ///
    /// A line that touches the surface does not change sides. The number of changes is even for
    /// the bounded surfaces, whatever the rounding.
    #[must_use]
    pub fn crossings(&self, ray: &Ray) -> SignChanges {
        match self {
            Self::Plane { normal, offset } => plane(*normal, *offset, ray),
            Self::Quadric {
                kind,
                local_from_world,
            } => {
                let local = ray.transformed(local_from_world);
                match kind {
                    Quadric::Sphere => sphere(local.origin, local.direction),
                    Quadric::Cylinder => cylinder(local.origin, local.direction),
                }
            }
            Self::Cone {
                slope,
                local_from_world,
            } => {
                let local = ray.transformed(local_from_world);
                cone(*slope, local.origin, local.direction)
            }
            Self::Torus {
                minor,
                local_from_world,
            } => {
                let local = ray.transformed(local_from_world);
                torus(*minor, local.origin, local.direction)
            }
        }
    }
}

fn plane(normal: DVec3, offset: f64, ray: &Ray) -> SignChanges {
    let height = normal.dot(ray.origin) - offset;
    let slope = normal.dot(ray.direction);
    let t = -height / slope;
    if slope == 0.0 || !t.is_finite() {
        return SignChanges::none(height < 0.0);
    }
    SignChanges::one(slope > 0.0, t)
}

/// `|p|^2 < 1` on a line, given `p . d = 0` at `t = 0` after a shift: `a t^2 + c` with
/// `a = d . d > 0`, symmetric about the shift.
fn symmetric(shift: f64, a: f64, c: f64) -> SignChanges {
    let half_squared = -c / a;
    if half_squared > 0.0 && half_squared.is_finite() {
        let half = half_squared.sqrt();
        SignChanges::two(false, shift - half, shift + half)
    } else {
        SignChanges::none(false)
    }
}

fn sphere(o: DVec3, d: DVec3) -> SignChanges {
    let a = d.length_squared();
    let shift = -o.dot(d) / a;
    let near = o + d * shift;
    symmetric(shift, a, near.length_squared() - 1.0)
}

fn cylinder(o: DVec3, d: DVec3) -> SignChanges {
    let a = d.x * d.x + d.y * d.y;
    let shift = -(o.x * d.x + o.y * d.y) / a;
    if !shift.is_finite() {
        // Along the axis: inside or outside for good.
        return SignChanges::none(o.x * o.x + o.y * o.y < 1.0);
    }
    let (x, y) = (o.x + d.x * shift, o.y + d.y * shift);
    symmetric(shift, a, x * x + y * y - 1.0)
}

fn cone(slope: f64, o: DVec3, d: DVec3) -> SignChanges {
    let shift = -o.dot(d) / d.length_squared();
    let p = o + d * shift;
    let (radius, growth) = (1.0 + slope * p.z, slope * d.z);
    let a = d.x * d.x + d.y * d.y - growth * growth;
    let b = p.x * d.x + p.y * d.y - radius * growth;
    let rho = (p.x * p.x + p.y * p.y).sqrt();
    let c = (rho - radius) * (rho + radius);
    shifted(roots::quadratic(a, b, c), shift, 1.0)
}

/// Changes found at `u` moved to `t = shift + u * scale`, `scale > 0`; pairs that round together vanish.
fn shifted(mut changes: SignChanges, shift: f64, scale: f64) -> SignChanges {
    let mut kept = 0;
    for i in 0..changes.count {
        let t = shift + changes.t[i] * scale;
        if kept > 0 && changes.t[kept - 1] >= t {
            kept -= 1;
        } else {
            changes.t[kept] = t;
            kept += 1;
        }
    }
    changes.count = kept;
    changes
}

/// The torus of major radius 1 about z.
///
/// In units of length along the line, with the origin at its closest approach to the centre, the
/// quartic has no cubic term. Its turning points separate its roots; the sign of the distance
/// `hypot(rho - 1, z) - minor`, which is accurate for thin tubes where the quartic is not, decides
/// in which pieces there is a root and where. The ends lie outside the bounding sphere, so the
/// number of sign changes is even. A spindle's quartic also vanishes on the inner lemon, where
/// the distance does not change sign: those roots only add pieces.
fn torus(minor: f64, o: DVec3, d: DVec3) -> SignChanges {
    let length = d.length();
    let unit = d / length;
    let closest = -o.dot(unit);
    let p = o + unit * closest;
    let reach = 1.0 + minor;
    let limit_squared = reach * reach - p.length_squared();
    if !matches!(
        limit_squared.partial_cmp(&0.0),
        Some(std::cmp::Ordering::Greater)
    ) {
        return SignChanges::none(false);
    }
    let limit = limit_squared.sqrt();
    let distance = |u: f64| {
        let (x, y, z) = (p.x + unit.x * u, p.y + unit.y * u, p.z + unit.z * u);
        let from_ring = (x * x + y * y).sqrt() - 1.0;
        // The squares differ only where the product does: no square root is needed for the sign.
        from_ring * from_ring + z * z - minor * minor
    };
    let k = p.length_squared() + 1.0 - minor * minor;
    let a2 = unit.x * unit.x + unit.y * unit.y;
    let b = p.x * unit.x + p.y * unit.y;
    let (turning, count) =
        roots::depressed_quartic_turning_points(2.0 * k - 4.0 * a2, -8.0 * b, limit);
    let mut knots = [-limit, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    knots[1..=count].copy_from_slice(&turning[..count]);
    let mut knot_count = count + 1;
    if minor >= 1.0 {
        // The distance of a spindle may turn inside the lemon, at the point nearest to the axis.
        let axis = -b / a2;
        if axis.abs() < limit {
            let at = knots[..knot_count].partition_point(|&u| u < axis);
            knots.copy_within(at..knot_count, at + 1);
            knots[at] = axis;
            knot_count += 1;
        }
    }
    knots[knot_count] = limit;
    let mut changes = SignChanges::none(false);
    let (mut u0, mut f0) = (knots[0], 1.0_f64);
    for (i, &u1) in knots.iter().enumerate().take(knot_count + 1).skip(1) {
        let f1 = if i == knot_count { 1.0 } else { distance(u1) };
        if (f0 < 0.0) != (f1 < 0.0) && changes.count < 4 {
            changes.t[changes.count] = roots::bracketed(distance, u0, u1, f0, f1);
            changes.count += 1;
        }
        (u0, f0) = (u1, f1);
    }
    // At most four changes are real; an odd count cannot happen because both ends are outside.
    changes.count &= !1;
    shifted(changes, closest / length, 1.0 / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_math::DAffine3;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
        (range.clone(), range.clone(), range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    fn local(kind: Quadric) -> Surface {
        Surface::Quadric {
            kind,
            local_from_world: DAffine3::IDENTITY,
        }
    }

    fn torus_surface(minor: f64) -> Surface {
        Surface::Torus {
            minor,
            local_from_world: DAffine3::IDENTITY,
        }
    }

    #[test]
    fn sphere_chord_has_its_analytic_length() {
        let surface = Surface::Quadric {
            kind: Quadric::Sphere,
            local_from_world: DAffine3::from_scale(DVec3::splat(0.5)),
        };
        for distance in [0.0, 1.0, 1.9, 1.999_999] {
            let ray = Ray::new(DVec3::new(-1e6, distance, 0.0), DVec3::X * 4.0);
            let changes = surface.crossings(&ray);
            let chord = (changes.t[1] - changes.t[0]) * 4.0;
            let exact = 2.0 * (4.0 - distance * distance).sqrt();
            assert!((chord - exact).abs() < 1e-9, "{chord} {exact}");
        }
    }

    #[test]
    fn lines_through_a_torus_in_special_position() {
        let ring = torus_surface(0.25);
        let along = |o: DVec3, d: DVec3| ring.crossings(&Ray::new(o, d)).count;
        // The axis misses; a diameter meets the tube twice; the plane z = r only touches.
        assert_eq!(along(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), 0);
        assert_eq!(along(DVec3::new(-5.0, 0.0, 0.0), DVec3::X), 4);
        assert_eq!(along(DVec3::new(-5.0, 0.0, 0.25), DVec3::X), 0);
        // Tangent to the inner equator: the double root there is no crossing, the outer two are.
        let tangent = ring.crossings(&Ray::new(DVec3::new(-5.0, 0.75, 0.0), DVec3::X));
        let expected = 2.0 * (1.0_f64 * 0.25).sqrt();
        assert!(tangent.count >= 2);
        assert!((tangent.t[tangent.count - 1] - 5.0 - expected).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn roots_of_a_torus_lie_on_it(
            minor in prop_oneof![1e-3..1.0f64, 1.0..3.0f64],
            angle in 0.0..TAU, tube in 0.0..TAU, d in vector(-1.0..1.0), far in 0.0..1e3f64,
        ) {
            prop_assume!(d.length() > 1e-2);
            // Aim at a point inside the tube, so that the line must cross.
            let (s, c) = libm::sincos(angle);
            let rho = 1.0 + 0.9 * minor * libm::cos(tube);
            let target = DVec3::new(rho * c, rho * s, 0.9 * minor * libm::sin(tube));
            let ray = Ray::new(target - d * far, d);
            let changes = torus_surface(minor).crossings(&ray);
            prop_assert!(changes.count >= 2 && changes.count.is_multiple_of(2));
            prop_assert!(!changes.starts_negative);
            let mut inside = false;
            for (i, &t) in changes.as_slice().iter().enumerate() {
                let p = ray.at(t);
                let from_ring = (p.x * p.x + p.y * p.y).sqrt() - 1.0;
                let error = (from_ring * from_ring + p.z * p.z).sqrt() - minor;
                prop_assert!(error.abs() < 1e-12 * (1.0 + far), "{}", error);
                prop_assert!(i == 0 || changes.t[i - 1] < t);
                inside ^= t < far;
            }
            prop_assert!(inside, "the target is inside");
        }

        #[test]
        fn sides_between_crossings_are_those_of_the_implicit_function(
            surface in prop_oneof![
                Just(Quadric::Sphere).prop_map(local),
                Just(Quadric::Cylinder).prop_map(local),
                prop_oneof![Just(-1.0), -1.0..-1e-3, Just(-1e-9), Just(-f64::EPSILON)].prop_map(
                    |slope| Surface::Cone { slope, local_from_world: DAffine3::IDENTITY },
                ),
            ],
            o in vector(-3.0..3.0), d in vector(-1.0..1.0),
        ) {
            prop_assume!(d.length() > 1e-3);
            let ray = Ray::new(o, d);
            let changes = surface.crossings(&ray);
            for i in -40..=40 {
                let t = f64::from(i) * 0.25;
                let p = ray.at(t);
                let value = surface.implicit_value(p);
                let passed = changes.as_slice().iter().filter(|&&c| c < t).count();
                let negative = changes.starts_negative ^ (passed % 2 == 1);
                prop_assert!(value.abs() < 1e-9 || negative == (value < 0.0));
            }
        }
    }
}
