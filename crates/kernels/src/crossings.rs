//! Eight lines with a triangle each: where they cross, in `f64`.
//!
//! This kernel decides, so every lane does what `TriangleRay::intersect` of the geometry does for one
//! line and triangle (Woop, Benthin & Wald, JCGT 2013): the same additions, multiplications, divisions and
//! comparisons in the same order. What that function looks at again, because a sign is zero or an edge
//! function has cancelled, is left undecided here. The scalar twin leaves all of it undecided.

use fearless_simd::prelude::Select;
use fearless_simd::{Simd, SimdBase, SimdMask, f64x8};

use crate::slab::{Scalar, Vector};

/// Lines and triangles of one run of the kernel.
pub const PAIRS: usize = 8;

/// Below this share of its products an edge function is evaluated again without cancellation.
pub const CANCELLED: f64 = 1.0 / 128.0;
/// Twice the area in the plane across the line between these bounds suffers no harm from under- or
/// overflow.
pub const SAFE_AREA: std::ops::Range<f64> = 1e-280..1e280;

/// Lines, with a triangle each. Coordinates are by the line's axes: two across, then the main one, along
/// which the direction is longest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Pairs {
    /// Of the triangles, by corner and axis.
    pub corners: [[[f64; PAIRS]; 3]; 3],
    /// Of the lines.
    pub origins: [[f64; PAIRS]; 3],
    /// Of the lines.
    pub directions: [[f64; PAIRS]; 3],
}

/// What is known of the pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Crossings {
    /// Bit `i`: pair `i` is decided.
    pub decided: u32,
    /// Those of them whose line crosses the triangle.
    pub crossed: u32,
    /// Those whose edge functions are positive.
    pub leaving: u32,
    /// Parameters of the crossings.
    pub t: [f64; PAIRS],
}

/// Whether lines cross triangles.
pub trait CrossingTest: Copy {
    /// Decides as many of the pairs as it can.
    fn cross(self, pairs: &Pairs, found: &mut Crossings);
}

impl CrossingTest for Scalar {
    #[inline]
    fn cross(self, _pairs: &Pairs, found: &mut Crossings) {
        (found.decided, found.crossed, found.leaving) = (0, 0, 0);
    }
}

/// An edge function and the sum of its products' sizes.
#[inline(always)]
fn edge<S: Simd>(simd: S, a: [f64x8<S>; 2], b: [f64x8<S>; 2]) -> (f64x8<S>, f64x8<S>) {
    let (plus, minus) = (a[0] * b[1], a[1] * b[0]);
    (plus - minus, simd.abs_f64x8(plus) + simd.abs_f64x8(minus))
}

impl<S: Simd> CrossingTest for Vector<S> {
    #[inline(always)]
    fn cross(self, pairs: &Pairs, found: &mut Crossings) {
        let simd = self.0;
        // Written out: closures are not always inlined, and vectors must not go through calls.
        let d = &pairs.directions;
        let (dx, dy) = (
            f64x8::from_slice(simd, &d[0]),
            f64x8::from_slice(simd, &d[1]),
        );
        let dz = f64x8::from_slice(simd, &d[2]);
        let (shear_x, shear_y) = (dx / dz, dy / dz);
        let mut across = [[dz; 2]; 3];
        let mut depths = [dz; 3];
        for corner in 0..3 {
            let [x, y, z] = &pairs.corners[corner];
            let [ox, oy, oz] = &pairs.origins;
            let x = f64x8::from_slice(simd, x) - f64x8::from_slice(simd, ox);
            let y = f64x8::from_slice(simd, y) - f64x8::from_slice(simd, oy);
            let z = f64x8::from_slice(simd, z) - f64x8::from_slice(simd, oz);
            across[corner] = [x - shear_x * z, y - shear_y * z];
            depths[corner] = z;
        }
        let [a, b, c] = across;
        let (u, u_products) = edge(simd, b, c);
        let (v, v_products) = edge(simd, c, a);
        let (w, w_products) = edge(simd, a, b);
        let zero = f64x8::splat(simd, 0.0);
        let (u_front, v_front, w_front) = (u.simd_gt(zero), v.simd_gt(zero), w.simd_gt(zero));
        let (u_back, v_back, w_back) = (u.simd_lt(zero), v.simd_lt(zero), w.simd_lt(zero));
        let missed = (u_front | v_front | w_front) & (u_back | v_back | w_back);
        let leaving = u_front & v_front & w_front;
        let clear = leaving | (u_back & v_back & w_back);
        let u = simd.abs_f64x8(u);
        let v = simd.abs_f64x8(v);
        let w = simd.abs_f64x8(w);
        let share = f64x8::splat(simd, CANCELLED);
        let accurate = u.simd_ge(share * u_products)
            & v.simd_ge(share * v_products)
            & w.simd_ge(share * w_products);
        let largest = u.max(v).max(w);
        let safe = largest.simd_ge(f64x8::splat(simd, SAFE_AREA.start))
            & largest.simd_lt(f64x8::splat(simd, SAFE_AREA.end));
        let crossed = clear & accurate & safe;
        // The corner with the largest weight comes first, of equals the nearer one.
        let [da, db, dc] = depths;
        let second = v.simd_gt(u) | (v.simd_eq(u) & db.simd_lt(da));
        let (weight, depth) = (second.select(v, u), second.select(db, da));
        let third = w.simd_gt(weight) | (w.simd_eq(weight) & dc.simd_lt(depth));
        let first_weight = third.select(w, weight);
        let first_depth = third.select(dc, depth);
        let next_weight = third.select(u, second.select(w, v));
        let next_depth = third.select(da, second.select(dc, db));
        let last_weight = third.select(v, second.select(u, w));
        let last_depth = third.select(db, second.select(da, dc));
        let total = first_weight + (next_weight + last_weight);
        let (next, last) = (next_weight / total, last_weight / total);
        let offset = next * (next_depth - first_depth) + last * (last_depth - first_depth);
        ((first_depth + offset) / dz).store_slice(&mut found.t);
        found.crossed = crossed.to_bitmask() as u32;
        found.leaving = leaving.to_bitmask() as u32;
        found.decided = missed.to_bitmask() as u32 | found.crossed;
    }
}
