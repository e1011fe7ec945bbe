//! What the builder moves about: a box in the tree's coordinates, with the item that it is of.

use octray_kernels::slab::{round_down, round_up};
use octray_math::Aabb;

use super::frame::Frame;

/// A box of `f32` with room for one number more on either side, so that four lanes go together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub(super) struct PaddedBox {
    pub(super) min: [f32; 4],
    pub(super) max: [f32; 4],
}

/// A box around an item or a part of it. The item is written in the fourth lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference(pub(super) PaddedBox);

/// The lower of two numbers, in one instruction; neither is NaN.
#[inline(always)]
fn lower(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn higher(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn lanes(a: [f32; 4], b: [f32; 4], of: impl Fn(f32, f32) -> f32) -> [f32; 4] {
    [
        of(a[0], b[0]),
        of(a[1], b[1]),
        of(a[2], b[2]),
        of(a[3], b[3]),
    ]
}

impl PaddedBox {
    pub(super) const EMPTY: Self = Self {
        min: [f32::INFINITY; 4],
        max: [f32::NEG_INFINITY; 4],
    };

    /// Rounded outwards.
    pub(super) fn outward(frame: &Frame, bounds: &Aabb) -> Self {
        Self::rounded(
            frame.point(bounds.min).to_array(),
            frame.point(bounds.max).to_array(),
        )
    }

    pub(super) fn rounded([x, y, z]: [f64; 3], [u, v, w]: [f64; 3]) -> Self {
        Self {
            min: [round_down(x), round_down(y), round_down(z), 0.0],
            max: [round_up(u), round_up(v), round_up(w), 0.0],
        }
    }

    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            min: lanes(self.min, other.min, lower),
            max: lanes(self.max, other.max, higher),
        }
    }

    #[inline(always)]
    pub(super) fn including(&self, point: [f32; 4]) -> Self {
        Self {
            min: lanes(self.min, point, lower),
            max: lanes(self.max, point, higher),
        }
    }

    /// Twice the centre.
    #[inline(always)]
    pub(super) fn center(&self) -> [f32; 4] {
        lanes(self.min, self.max, |a, b| a + b)
    }

    #[inline(always)]
    pub(super) fn size(&self) -> [f32; 4] {
        lanes(self.max, self.min, |a, b| a - b)
    }

    /// 0 for the empty box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z, _] = self.size();
        higher(x * (y + z) + y * z, 0.0)
    }
}

impl Reference {
    /// Room for one.
    pub(super) const BLANK: Self = Self(PaddedBox::EMPTY);

    pub(super) fn new(mut bounds: PaddedBox, item: u32) -> Self {
        // Below 2^28 this is the pattern of an ordinary, tiny number: no NaN.
        bounds.min[3] = f32::from_bits(item);
        bounds.max[3] = 0.0;
        Self(bounds)
    }

    #[inline]
    pub(super) fn item(&self) -> u32 {
        self.0.min[3].to_bits()
    }
}
