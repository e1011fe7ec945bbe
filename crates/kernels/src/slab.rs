//! One line against eight boxes at once, by slabs (Kay & Kajiya 1986), conservatively.
//!
//! # Why no box is missed
//! Let `u = 2^-24` be half an ulp of `f32`. The line is `p + s d` with `p`, `d` in `f64`, the
//! largest component of `d` in `[1, 2)`, and boxes in `f32` whose coordinates are at most `extent` in
//! size. A box *must* be reported if some `s` in `[s_min, s_max]` has `p + s d` inside the box grown by
//! `slack` on every side. Say that it is the one at `s`.
//!
//! 1. *Origin.* Per axis, `near` planes are measured from `q = p + m` (for `d >= 0`) and `far` planes
//!    from `p - m`, the other way round for `d < 0`, with `m = slack + u (3.25 extent + 4.5 |p|)`. The
//!    conversion of `q` to `f32` takes away at most `u |q|`. From there on `q` is exact data.
//! 2. *Arithmetic.* A plane's parameter is `(plane - q) * inverse`: a difference, a product, and the
//!    inverse itself, each rounded once, so it is off by at most `3.01 u |plane - q| / |d|`, which is less
//!    than `3.01 u (extent + |p| + m) / |d|`. Without rounding the parameter of a near plane would be at
//!    most `s - (m - u |q| - slack) / |d|`, and of a far plane as far behind `s`. So every near plane's is
//!    below `s` and every far plane's above: `m` covers the conversion, the arithmetic and `slack`;
//!    what is of second order, and products in the subnormal range, which are off by up to `2^-149`, the
//!    half of `slack` covers that callers leave unused (it is at least `2^-41`).
//! 3. *Components near zero.* For `|d| < 2^-100` (0 and the sign of 0 included) the inverse is
//!    `+-2^100`. A line between the planes, or on one, sees the near plane strictly behind its
//!    origin for that plane, at least one ulp of a number not below `slack` in size (a plane and
//!    an origin are floats, and `slack >= 2^-41`): at least `2^-65`, times `2^100`. So the entry
//!    is below `-2^34` and the exit above `2^34`, which never cuts: parameters that matter are
//!    below `2^8` in size, because callers move `p` next to the boxes, which lie within
//!    `[-16, 16]^3`; over such parameters the line moves by less than `2^-91`, far less than
//!    `slack`.
//! 4. *Comparisons* are exact. `s_min` is rounded down and `s_max` up; the entry is the largest of the
//!    near planes' parameters and `s_min`, the exit the least of the far planes' and `s_max`.
//!
//! An empty slot has `min = inf`, `max = -inf`: the entry is infinite and the exit infinitely far before
//! it, since origins are finite.

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
    /// Whether the line enters by the highest plane, per axis.
    down: [bool; 3],
    near_origin: [f32; 3],
    far_origin: [f32; 3],
    inverse: [f32; 3],
}

const U: f64 = 1.0 / (1 << 24) as f64;
/// `2^100`.
const STEEPEST: f64 = (1u128 << 100) as f64;

/// The lowest `f32` that is not below `x`.
#[must_use]
#[inline(always)]
pub fn round_up(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

/// The highest `f32` that is not above `x`.
#[must_use]
#[inline(always)]
pub fn round_down(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

impl SlabRay {
    /// The line `origin + s * direction` near boxes within `[-16, 16]^3` whose coordinates are at most
    /// `extent` in size.
    ///
    /// `direction` has its largest component in `[1, 2)`; `origin` and `slack` are finite in
    /// `f32`, and `slack >= 2^-41`.
    #[must_use]
    #[inline(always)]
    pub fn new(origin: [f64; 3], direction: [f64; 3], extent: f64, slack: f64) -> Self {
        let mut ray = Self {
            down: [false; 3],
            near_origin: [0.0; 3],
            far_origin: [0.0; 3],
            inverse: [0.0; 3],
        };
        let slack = slack + 3.25 * U * extent;
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            let outwards = slack + 4.5 * U * o.abs();
            let (above, below) = ((o + outwards) as f32, (o - outwards) as f32);
            let inverse = (1.0 / d.abs()).min(STEEPEST) as f32;
            let down = d < 0.0;
            ray.down[axis] = down;
            ray.near_origin[axis] = if down { below } else { above };
            ray.far_origin[axis] = if down { above } else { below };
            ray.inverse[axis] = if down { -inverse } else { inverse };
        }
        ray
    }

    /// The planes by which the line enters boxes, and those by which it leaves them.
    #[inline(always)]
    const fn planes<'a>(&self, boxes: &'a Boxes8, axis: usize) -> [&'a [f32; 8]; 2] {
        let (low, high) = (&boxes.planes[axis], &boxes.planes[axis + 3]);
        if self.down[axis] {
            [high, low]
        } else {
            [low, high]
        }
    }
}

/// Which of eight boxes a line meets.
pub trait BoxTest: Copy {
    /// Bit `i` of the mask is set where the line is in box `i` for some parameter of
    /// `[s_min, s_max]` (or nearly so); `entries[i]` is then a lower bound of those parameters.
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
                let plane = ray.planes(boxes, axis)[0][lane];
                (plane - ray.near_origin[axis]) * ray.inverse[axis]
            };
            let far = |axis: usize| {
                let plane = ray.planes(boxes, axis)[1][lane];
                (plane - ray.far_origin[axis]) * ray.inverse[axis]
            };
            let enter = max(max(near(0), near(1)), max(near(2), s_min));
            let leave = min(min(far(0), far(1)), min(far(2), s_max));
            *entry = enter;
            mask |= u32::from(enter <= leave) << lane;
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
        // Written out: closures are not always inlined, and vectors must not go through calls.
        let [near_x, far_x] = ray.planes(boxes, 0);
        let [near_y, far_y] = ray.planes(boxes, 1);
        let [near_z, far_z] = ray.planes(boxes, 2);
        let load = |planes: &[f32; 8]| f32x8::from_slice(simd, planes);
        let (near, far) = (&ray.near_origin, &ray.far_origin);
        let near_x = (load(near_x) - near[0]) * ray.inverse[0];
        let near_y = (load(near_y) - near[1]) * ray.inverse[1];
        let near_z = (load(near_z) - near[2]) * ray.inverse[2];
        let far_x = (load(far_x) - far[0]) * ray.inverse[0];
        let far_y = (load(far_y) - far[1]) * ray.inverse[1];
        let far_z = (load(far_z) - far[2]) * ray.inverse[2];
        let first = f32x8::splat(simd, s_min);
        let last = f32x8::splat(simd, s_max);
        let enter = near_x.max(near_y).max(near_z.max(first));
        let leave = far_x.min(far_y).min(far_z.min(last));
        enter.store_slice(entries);
        enter.simd_le(leave).to_bitmask() as u32
    }
}

#[cfg(test)]
mod tests;
