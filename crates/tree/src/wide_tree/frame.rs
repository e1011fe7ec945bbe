//! The coordinates that the kernels see: centred on the tree, scaled by a power of two.

use octray_kernels::slab::{round_down, round_up};
use octray_kernels::{SlabRay, TriangleLine};
use octray_math::{Aabb, DVec3, Ray};

/// Maps space to about `[-1, 1]^3` around the tree's centre.
///
/// All error margins of the tree come from here. With `r` the largest coordinate of the line's
/// origin in these coordinates, the things that are rounded are: the origin (`2^-52 r`), its move
/// along the line to the closest approach (`2^-49 r`), the boxes beyond their outward rounding to
/// `f32` (`2^-48`), and the parameters that visitors return (promised in [`super::WideTree`]:
/// `2^-43 (r + 16)`). Together they stay below half of the slack `2^-41 (r + 16)` by which the
/// kernel moves planes outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    center: DVec3,
    exponent: i32,
    scale: f64,
    /// The largest coordinate of boxes.
    extent: f64,
}

/// A box in the frame's coordinates, rounded outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LocalBox {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

/// A line in the tree's coordinates, its origin at the closest approach to the centre or near it.
#[derive(Clone, Copy, Debug)]
pub struct LocalLine {
    pub(super) slab: SlabRay,
    origin: DVec3,
    direction: DVec3,
    slack: f64,
    /// A local parameter is `t * rate - shift`.
    rate: f64,
    shift: f64,
    /// Numbers are so extreme that nothing is ruled out.
    blind: bool,
}

/// Farther than this from the centre no line meets the tree: boxes lie within 16.
const REACH: f64 = 64.0;
/// A line whose origin is as near as this is not moved.
const NEAR: f64 = 2.0;

impl Frame {
    pub(super) fn new(bounds: &Aabb) -> Self {
        let half = bounds.half_size().max_element();
        let exponent = if half > 0.0 {
            (-libm::ilogb(half) - 1).clamp(-1020, 1020)
        } else {
            0
        };
        let mut frame = Self {
            center: bounds.center(),
            exponent,
            scale: libm::ldexp(1.0, exponent),
            extent: 0.0,
        };
        let corners = [bounds.min, bounds.max].map(|p| frame.point(p).abs().max_element());
        // More than boxes are rounded outwards by.
        frame.extent = corners[0].max(corners[1]) * (1.0 + 1.0 / f64::from(1 << 20));
        frame
    }

    pub(super) const fn center(&self) -> DVec3 {
        self.center
    }

    pub(super) const fn scale(&self) -> f64 {
        self.scale
    }

    #[inline(always)]
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) * self.scale
    }

    pub(super) fn outward(&self, bounds: &Aabb) -> LocalBox {
        LocalBox {
            min: self.point(bounds.min).to_array().map(round_down),
            max: self.point(bounds.max).to_array().map(round_up),
        }
    }

    /// `None` for a ray that cannot meet the tree, or is none (not finite, or without direction).
    #[inline(always)]
    pub(super) fn ray(&self, ray: &Ray) -> Option<LocalLine> {
        let longest = ray.direction.abs().max_element();
        if !(ray.origin.is_finite() && ray.direction.is_finite() && longest > 0.0) {
            return None;
        }
        let power = binary_exponent(longest);
        let direction = scaled(ray.direction, -power);
        let origin = self.point(ray.origin);
        let distance = origin.abs().max_element();
        let slack = (distance + 16.0) * (1.0 / (1u64 << 41) as f64);
        let rate = self.exponent + power;
        if !(slack < 16.0 && rate.abs() < 1000) {
            return Some(LocalLine {
                slab: SlabRay::new([0.0; 3], [1.0; 3], self.extent, (1u64 << 60) as f64),
                origin: DVec3::ZERO,
                direction: DVec3::ONE,
                slack,
                rate: 0.0,
                shift: 0.0,
                blind: true,
            });
        }
        let (mut shift, mut nearest) = (0.0, origin);
        // Lines of a world begin there.
        if distance > NEAR {
            shift = -origin.dot(direction) / direction.length_squared();
            nearest = origin + direction * shift;
            if nearest.abs().max_element() > REACH {
                return None;
            }
        }
        Some(LocalLine {
            slab: SlabRay::new(nearest.to_array(), direction.to_array(), self.extent, slack),
            origin: nearest,
            direction,
            slack,
            rate: power_of_two(rate),
            shift,
            blind: false,
        })
    }
}

/// The least number in `f32`, about.
const TINY: f64 = 1.0 / (1u128 << 127) as f64 / (1u64 << 22) as f64;

impl LocalLine {
    /// For tests of triangles whose corners are [`super::WideTree::local`] ones; `None` where numbers
    /// are so extreme that every triangle must be looked at.
    ///
    /// Covered is an exact test that rounds as little as [`super::WideTree`] asks of visitors.
    #[must_use]
    #[inline(always)]
    pub fn triangle_line(&self) -> Option<TriangleLine> {
        let (origin, direction) = (self.origin.to_array(), self.direction.to_array());
        (!self.blind).then(|| TriangleLine::new(origin, direction, self.slack))
    }

    /// A local parameter not above the one at `t`.
    #[must_use]
    #[inline(always)]
    pub fn lower(&self, t: f64) -> f32 {
        -self.rounded_up(-t, -self.shift, f32::INFINITY)
    }

    /// A local parameter not below the one at `t`.
    #[must_use]
    #[inline(always)]
    pub fn upper(&self, t: f64) -> f32 {
        self.rounded_up(t, self.shift, f32::INFINITY)
    }

    #[inline(always)]
    fn rounded_up(&self, t: f64, shift: f64, unknown: f32) -> f32 {
        if self.blind {
            return unknown;
        }
        if t.is_infinite() {
            return t as f32;
        }
        let s = t * self.rate;
        let error = (s.abs() + shift.abs()) * (1.0 / (1u64 << 50) as f64);
        let above = (s - shift) + error;
        // Rounding to the nearest takes away less, and less than the last term of the smallest.
        (above + (above.abs() * f64::from(f32::EPSILON) + TINY)) as f32
    }
}

/// `floor(log2 x)` for finite `x > 0`.
#[inline(always)]
fn binary_exponent(x: f64) -> i32 {
    let field = (x.to_bits() >> 52) as i32;
    if field == 0 {
        libm::ilogb(x)
    } else {
        field - 1023
    }
}

/// `2^n` for `|n| <= 1022`.
#[inline(always)]
fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

#[inline(always)]
fn scaled(v: DVec3, n: i32) -> DVec3 {
    if n.abs() <= 1022 {
        v * power_of_two(n)
    } else {
        DVec3::from_array(v.to_array().map(|x| libm::ldexp(x, n)))
    }
}
