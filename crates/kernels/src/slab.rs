//! One line against eight boxes at once, by slabs (Kay & Kajiya 1986), conservatively.
//!
//! # Why no box is missed
//! Let `u = 2^-24` be half an ulp of `f32`. The line is `p + s d` with `p`, `d` in `f64`, the
//! largest component of `d` in `[1, 2)`, and boxes in `f32`. A box *must* be reported if some
//! `s` in `[s_min, s_max]` has `p + s d` inside the box grown by `slack` on every side.
//!
//! 1. *Origin.* Per axis, `near` planes are measured from `p + slack` (for `d >= 0`), rounded up
//!    to `f32`, and `far` planes from `p - slack`, rounded down; the other way round for `d < 0`.
//!    With these origins and exact arithmetic the entry can only be too early, the exit too late.
//!    The origins are floats now: from here on they are exact data.
//! 2. *Arithmetic.* A plane's parameter is `(plane - origin) * inverse`: a difference, a product,
//!    and the inverse itself, each rounded once, so it is off by a factor within
//!    `(1 + u)^3 < 1 + 4u`. The largest of the entries is one of them, and so is the smallest of
//!    the exits; hence `near - 8u |near|` and `far + 8u |far|`, each rounded twice more (at most
//!    `2.1u` in relative terms), are still on the safe side. Products in the subnormal range are
//!    off by up to `2^-149`; the half of `slack` that callers leave unused (it is at least
//!    `2^-41`) covers this.
//! 3. *Components near zero.* For `|d| < 2^-100` (0 and the sign of 0 included) the inverse is
//!    `+-2^100`. A line between the planes, or on one, sees the near plane strictly behind its
//!    origin for that plane, at least one ulp of a number not below `slack` in size (a plane and
//!    an origin are floats, and `slack >= 2^-41`): at least `2^-65`, times `2^100`. So the entry
//!    is below `-2^34` and the exit above `2^34`, which never cuts: parameters that matter are
//!    below `2^8` in size, because callers move `p` next to the boxes, which lie within
//!    `[-16, 16]^3`; over such parameters the line moves by less than `2^-91`, far less than
//!    `slack`.
//! 4. *Comparisons* are exact. `s_min` is rounded down and `s_max` up.
//!
//! An empty slot has `min = inf`, `max = -inf`: the entry becomes NaN or infinite and no comparison
//! with it holds, since origins are finite.

use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};

/// Eight boxes, one per lane.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Boxes8 {
    /// Lowest x, y, z, then highest x, y, z.
    pub planes: [[f32; 8]; 6],
}

impl Boxes8 {
    /// No box in any lane.
    pub const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
        ],
    };

    /// Sets one lane.
    pub fn set(&mut self, lane: usize, min: [f32; 3], max: [f32; 3]) {
        for axis in 0..3 {
            self.planes[axis][lane] = min[axis];
            self.planes[axis + 3][lane] = max[axis];
        }
    }
}

/// A line prepared for the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabRay {
    /// Which of the six planes the line enters by, per axis.
    near_plane: [usize; 3],
    far_plane: [usize; 3],
    near_origin: [f32; 3],
    far_origin: [f32; 3],
    inverse: [f32; 3],
}

/// The relative margin `8u` of the module's analysis.
const MARGIN: f32 = 1.0 / (1 << 21) as f32;
/// `2^100`.
const STEEPEST: f64 = (1u128 << 100) as f64;

/// The lowest `f32` that is not below `x`.
#[must_use]
#[inline]
pub fn round_up(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

/// The highest `f32` that is not above `x`.
#[must_use]
#[inline]
pub fn round_down(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

impl SlabRay {
    /// The line `origin + s * direction` near boxes within `[-16, 16]^3`.
    ///
    /// `direction` has its largest component in `[1, 2)`; `origin` and `slack` are finite in
    /// `f32`, and `slack >= 2^-41`.
    #[must_use]
    #[inline]
    pub fn new(origin: [f64; 3], direction: [f64; 3], slack: f64) -> Self {
        let mut ray = Self {
            near_plane: [0; 3],
            far_plane: [0; 3],
            near_origin: [0.0; 3],
            far_origin: [0.0; 3],
            inverse: [0.0; 3],
        };
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            // Two ulps beyond: the conversion rounds by half of one, either way.
            let outwards = slack + o.abs() * (4.0 * f64::from(f32::EPSILON / 4.0));
            let (above, below) = ((o + outwards) as f32, (o - outwards) as f32);
            let inverse = (1.0 / d.abs()).min(STEEPEST) as f32;
            if d < 0.0 {
                (ray.near_plane[axis], ray.far_plane[axis]) = (axis + 3, axis);
                (ray.near_origin[axis], ray.far_origin[axis]) = (below, above);
                ray.inverse[axis] = -inverse;
            } else {
                (ray.near_plane[axis], ray.far_plane[axis]) = (axis, axis + 3);
                (ray.near_origin[axis], ray.far_origin[axis]) = (above, below);
                ray.inverse[axis] = inverse;
            }
        }
        ray
    }
}

/// Which of eight boxes a line meets.
pub trait BoxTest: Copy {
    /// Bit `i` of the mask is set where the line is in box `i` for some parameter of
    /// `[s_min, s_max]` (or nearly so); `entries[i]` is then a lower bound of those parameters,
    /// not cut at `s_min`.
    fn test(
        self,
        ray: &SlabRay,
        boxes: &Boxes8,
        s_min: f32,
        s_max: f32,
        entries: &mut [f32; 8],
    ) -> u32;
}

/// One lane at a time.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

/// All lanes at once. To be used inside `dispatch!`.
#[derive(Clone, Copy, Debug)]
pub struct Vector<S>(pub S);

impl BoxTest for Scalar {
    #[inline]
    fn test(
        self,
        ray: &SlabRay,
        boxes: &Boxes8,
        s_min: f32,
        s_max: f32,
        entries: &mut [f32; 8],
    ) -> u32 {
        // As the vector instructions choose: the second of equals.
        let max = |a: f32, b: f32| if a > b { a } else { b };
        let min = |a: f32, b: f32| if a < b { a } else { b };
        let mut mask = 0;
        for (lane, entry) in entries.iter_mut().enumerate() {
            let near = |axis: usize| {
                (boxes.planes[ray.near_plane[axis]][lane] - ray.near_origin[axis])
                    * ray.inverse[axis]
            };
            let far = |axis: usize| {
                (boxes.planes[ray.far_plane[axis]][lane] - ray.far_origin[axis]) * ray.inverse[axis]
            };
            let enter = max(max(near(0), near(1)), near(2));
            let leave = min(min(far(0), far(1)), far(2));
            let enter = enter - enter.abs() * MARGIN;
            let leave = leave + leave.abs() * MARGIN;
            *entry = enter;
            let hit = enter <= leave && enter <= s_max && leave >= s_min;
            mask |= u32::from(hit) << lane;
        }
        mask
    }
}

impl<S: Simd> BoxTest for Vector<S> {
    #[inline(always)]
    fn test(
        self,
        ray: &SlabRay,
        boxes: &Boxes8,
        s_min: f32,
        s_max: f32,
        entries: &mut [f32; 8],
    ) -> u32 {
        let simd = self.0;
        let near = |axis: usize| {
            let planes = f32x8::from_slice(simd, &boxes.planes[ray.near_plane[axis]]);
            (planes - ray.near_origin[axis]) * ray.inverse[axis]
        };
        let far = |axis: usize| {
            let planes = f32x8::from_slice(simd, &boxes.planes[ray.far_plane[axis]]);
            (planes - ray.far_origin[axis]) * ray.inverse[axis]
        };
        let enter = near(0).max(near(1)).max(near(2));
        let leave = far(0).min(far(1)).min(far(2));
        let enter = enter - enter.abs() * MARGIN;
        let leave = leave + leave.abs() * MARGIN;
        enter.store_slice(entries);
        let hit = enter.simd_le(leave)
            & enter.simd_le(f32x8::splat(simd, s_max))
            & leave.simd_ge(f32x8::splat(simd, s_min));
        hit.to_bitmask() as u32
    }
}

#[cfg(test)]
mod tests;
