//! One number or several: what a kernel and its scalar twin have in common.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, SimdBase, f32x8, f32x16};

/// A number, or one in each of several lanes.
pub(crate) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// What instructions are used.
    type Token: Copy;

    /// In all lanes.
    fn all(token: Self::Token, x: f32) -> Self;
    /// The first numbers of a slice, as many as there are lanes.
    fn load(token: Self::Token, from: &[f32]) -> Self;
    fn store(self, to: &mut [f32]);
    /// The second of equals, and of two that cannot be compared.
    fn min(self, other: Self) -> Self;
    /// The second of equals, and of two that cannot be compared.
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
}

impl Lane for f32 {
    type Token = ();

    #[inline(always)]
    fn all((): (), x: f32) -> Self {
        x
    }

    #[inline(always)]
    fn load((): (), from: &[f32]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
}

macro_rules! vector_lanes {
    ($vector:ident, $lanes:literal, $min:ident, $max:ident, $abs:ident) => {
        impl<S: Simd> Lane for $vector<S> {
            type Token = S;

            #[inline(always)]
            fn all(token: S, x: f32) -> Self {
                <Self as SimdBase<S>>::splat(token, x)
            }

            #[inline(always)]
            fn load(token: S, from: &[f32]) -> Self {
                Self::from_slice(token, &from[..$lanes])
            }

            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                self.store_slice(&mut to[..$lanes]);
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.simd.$min(self, other)
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.simd.$max(self, other)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                self.simd.$abs(self)
            }
        }
    };
}

vector_lanes!(f32x8, 8, min_f32x8, max_f32x8, abs_f32x8);
vector_lanes!(f32x16, 16, min_f32x16, max_f32x16, abs_f32x16);
