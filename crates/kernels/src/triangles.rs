//! One line against up to eight triangles at once, conservatively: which of them may be crossed,
//! which certainly are, and about where.
//!
//! # What it may say
//! Let `u = 2^-24` be half an ulp of `f32`, and let `*` mark the numbers of the exact test, which is
//! Woop, Benthin & Wald's (JCGT 2013) in `f64`: vertices relative to the line's origin, sheared so
//! that the line runs along the main axis `z`, `X* = vx - sx vz - X0` with `X0 = px - sx pz`, likewise
//! `Y*`, and three edge functions `E* = Xa Yb - Ya Xb`, whose signs it decides exactly. It reports a
//! crossing only if no two of them have opposite signs, and always if all three have the same.
//!
//! 1. *Vertices.* Rounded to `f32` are `vx`, `vz`, `sx` (`|sx| <= 1`), `X0`, then `vx - X0`,
//!    `sx vz` and their difference `X`, so
//!    `|X - X*| <= u (|vx| + 3 |sx vz| + |X0| + |vx - X0| + |X|)`, and with
//!    `|vx| <= |X| + |vz| + |X0|` and `|vx - X0| <= |X| + |vz|` at most `u (3 |X| + 5 |vz| + 2 |X0|)`.
//!    A vertex has the parameter `s = (vz - pz) / dz` with `1 <= |dz| < 2`, so `|vz| <= |pz| + 2 |s|`.
//!    Altogether `|X - X*| <= e + 4u |X|` with
//!    `e = slack + u (6 |pz| + 3 max(|X0|, |Y0|)) + 12u max |s|`,
//!    where `slack` covers what the exact test itself rounds, and the larger factors the products of
//!    two errors and the rounding of `e`.
//! 2. *Edges.* With `S` the largest of the six `|X|`, `|Y|`, an edge function is off by no more than
//!    `4 S (e + 4uS) + 2 (e + 4uS)^2 + 5u S^2 < (S + e) (4.5 e + 32u S)`, its own rounding included.
//!    This is `error`. `e >= 2^-40`, so nothing that matters is lost to underflow.
//! 3. So a triangle with an edge function above `error` and another below `-error` is not crossed; one
//!    whose three are all above `error`, or all below `-error`, is.
//! 4. *Parameter.* The crossing's lies between the corners', each of which is off by no more than
//!    `u (|vz| + |pz| + 3 |s|) < e`. Nearer, the exact test interpolates with weights `E*` of one sign.
//!    Since `sum E* (s_i - s*) = 0`, the same with `E` is off by at most
//!    `sum |E - E*| |s_i - s*| / |sum E| <= 3 error (max s - min s) / |sum E|`; evaluating it adds less
//!    than `16u (max s - min s)` and another `error / |sum E|` of that.
//!
//! Lanes beyond the number of triangles hold whatever comes next in memory, and are masked.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};

use crate::lane::Lane;
use crate::slab::{Scalar, Vector, round_up};

/// Floats per triangle: x of the three corners, then y, then z.
pub const FLOATS: usize = 9;
/// Floats of a leaf and what follows it, whatever its size.
pub const WINDOW: usize = 8 * FLOATS + 8;
/// Floats that must follow the last triangle of an array, so that every leaf has a window.
pub const PADDING: usize = WINDOW - FLOATS;

const U: f32 = 1.0 / (1 << 24) as f32;

/// A line prepared for the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleLine {
    /// Across, across, main axis.
    axes: [usize; 3],
    shear: [f32; 2],
    /// `X0`, `Y0`, `pz` of the module's analysis.
    origin: [f32; 3],
    /// `1 / dz`.
    s_per_depth: f32,
    /// `e` for `s = 0`.
    error: f32,
}

/// What is known of eight triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Bit `i`: triangle `i` may be crossed at a parameter between `s_min` and `s_max`.
    pub possible: u32,
    /// Those of them that are crossed beyond doubt.
    pub certain: u32,
    /// Lower bounds of the parameters of the crossings; of the possible ones only.
    pub nearest: [f32; 8],
    /// Upper bounds.
    pub farthest: [f32; 8],
}

impl Candidates {
    /// No triangle.
    pub const NONE: Self = Self {
        possible: 0,
        certain: 0,
        nearest: [0.0; 8],
        farthest: [0.0; 8],
    };
}

impl TriangleLine {
    /// The line `origin + s * direction` near vertices within `[-16, 16]^3`.
    ///
    /// `direction` has its largest component in `[1, 2)`; `origin` is finite in `f32`. What the exact
    /// test rounds amounts to less than half of `slack`, and `slack >= 2^-41`.
    #[must_use]
    #[inline(always)]
    pub fn new(origin: [f64; 3], direction: [f64; 3], slack: f64) -> Self {
        let size = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        let z = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        let per_depth = 1.0 / direction[z];
        let shear = [direction[x] * per_depth, direction[y] * per_depth];
        let depth = origin[z];
        let across = [origin[x] - shear[0] * depth, origin[y] - shear[1] * depth];
        let u = f64::from(U);
        let error = slack + u * (6.0 * depth.abs() + 3.0 * across[0].abs().max(across[1].abs()));
        Self {
            axes: [x, y, z],
            shear: [shear[0] as f32, shear[1] as f32],
            origin: [across[0] as f32, across[1] as f32, depth as f32],
            s_per_depth: per_depth as f32,
            error: round_up(error),
        }
    }
}

impl TriangleLine {
    /// A line by the numbers of the module's analysis: the axes, the shears, `X0`, `Y0` and `pz`,
    /// `1 / dz`, and the error at `s = 0`.
    #[inline]
    pub(crate) const fn sheared(
        axes: [usize; 3],
        shear: [f32; 2],
        origin: [f32; 3],
        s_per_depth: f32,
        error: f32,
    ) -> Self {
        Self {
            axes,
            shear,
            origin,
            s_per_depth,
            error,
        }
    }
}

/// Corners of the triangles of a leaf, from one lane on.
struct Rows<'a, L: Lane> {
    rows: &'a [f32; WINDOW],
    /// At most eight.
    count: usize,
    lane: usize,
    token: L::Token,
}

impl<L: Lane> Rows<'_, L> {
    #[inline(always)]
    fn load(&self, axis: usize, corner: usize) -> L {
        let start = (3 * axis + corner) * self.count + self.lane;
        L::load(self.token, &self.rows[start..])
    }

    #[inline(always)]
    fn splat(&self, x: f32) -> L {
        L::all(self.token, x)
    }
}

/// Everything that decides about a triangle.
#[derive(Clone, Copy)]
struct Verdict<L> {
    edges: [L; 3],
    least: L,
    greatest: L,
    error: L,
    s: [L; 3],
    /// What a corner's parameter is off by, at most.
    near: L,
    /// Of the corners, widened by that.
    first: L,
    last: L,
}

impl<L: Lane> Verdict<L> {
    #[inline(always)]
    fn new(line: &TriangleLine, source: &Rows<'_, L>) -> Self {
        let [x, y, z] = line.axes;
        let (shear_x, shear_y) = (source.splat(line.shear[0]), source.splat(line.shear[1]));
        let (x0, y0) = (source.splat(line.origin[0]), source.splat(line.origin[1]));
        let (z0, s_per_depth) = (source.splat(line.origin[2]), source.splat(line.s_per_depth));
        // Written out: closures are not always inlined, and vectors must not go through calls.
        let (az, bz, cz) = (source.load(z, 0), source.load(z, 1), source.load(z, 2));
        let ax = (source.load(x, 0) - x0) - shear_x * az;
        let bx = (source.load(x, 1) - x0) - shear_x * bz;
        let cx = (source.load(x, 2) - x0) - shear_x * cz;
        let ay = (source.load(y, 0) - y0) - shear_y * az;
        let by = (source.load(y, 1) - y0) - shear_y * bz;
        let cy = (source.load(y, 2) - y0) - shear_y * cz;
        let sa = (az - z0) * s_per_depth;
        let sb = (bz - z0) * s_per_depth;
        let sc = (cz - z0) * s_per_depth;
        let edges = [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx];
        let least = edges[0].min(edges[1]).min(edges[2]);
        let greatest = edges[0].max(edges[1]).max(edges[2]);
        let first = sa.min(sb).min(sc);
        let last = sa.max(sb).max(sc);
        let size = ax.abs().max(ay.abs()).max(bx.abs());
        let size = size.max(by.abs().max(cx.abs()).max(cy.abs()));
        let near = source.splat(line.error) + source.splat(12.0 * U) * first.abs().max(last.abs());
        let error = (size + near) * (source.splat(4.5) * near + source.splat(32.0 * U) * size);
        Self {
            edges,
            least,
            greatest,
            error,
            s: [sa, sb, sc],
            near,
            first: first - near,
            last: last + near,
        }
    }

    /// Bounds of the parameter of a crossing.
    #[inline(always)]
    fn bounds(&self, source: &Rows<'_, L>) -> [L; 2] {
        let [u, v, w] = self.edges;
        let [a, b, c] = self.s;
        let sum = u + v + w;
        let numerator = u * (a - self.first) + v * (b - self.first) + w * (c - self.first);
        let range = self.last - self.first;
        // Tiny sums make the margin larger than any range.
        let size = sum.abs().max(source.splat(1e-37));
        let sign = sum / size;
        let s = self.first + numerator * sign / size;
        let margin = range * (source.splat(5.0) * self.error / size + source.splat(24.0 * U));
        let margin = margin + self.near + self.near;
        [(s - margin).max(self.first), (s + margin).min(self.last)]
    }
}

/// Which of eight triangles a line crosses.
pub trait TriangleTest: Copy {
    /// Tests the `count` triangles whose corners begin `rows`: `count` times x of corner 0, of
    /// corner 1, of corner 2, then y and z. There are at most eight.
    fn test_triangles(
        self,
        line: &TriangleLine,
        rows: &[f32; WINDOW],
        count: usize,
        s_min: f32,
        s_max: f32,
        found: &mut Candidates,
    );
}

impl TriangleTest for Scalar {
    #[inline]
    fn test_triangles(
        self,
        line: &TriangleLine,
        rows: &[f32; WINDOW],
        count: usize,
        s_min: f32,
        s_max: f32,
        found: &mut Candidates,
    ) {
        (found.possible, found.certain) = (0, 0);
        let count = count.min(8);
        for lane in 0..count {
            let one = Rows::<f32> {
                rows,
                count,
                lane,
                token: (),
            };
            let verdict = Verdict::new(line, &one);
            let error = verdict.error;
            let crossed = verdict.least >= -error || verdict.greatest <= error;
            if !(crossed && verdict.first <= s_max && verdict.last >= s_min) {
                continue;
            }
            found.possible |= 1 << lane;
            if verdict.least > error || verdict.greatest < -error {
                found.certain |= 1 << lane;
            }
            [found.nearest[lane], found.farthest[lane]] = verdict.bounds(&one);
        }
    }
}

impl<S: Simd> TriangleTest for Vector<S> {
    #[inline(always)]
    fn test_triangles(
        self,
        line: &TriangleLine,
        rows: &[f32; WINDOW],
        count: usize,
        s_min: f32,
        s_max: f32,
        found: &mut Candidates,
    ) {
        let simd = self.0;
        let count = count.min(8);
        let all = Rows::<f32x8<S>> {
            rows,
            count,
            lane: 0,
            token: simd,
        };
        let verdict = Verdict::new(line, &all);
        let error = verdict.error;
        let crossed = verdict.least.simd_ge(-error) | verdict.greatest.simd_le(error);
        let possible = crossed
            & verdict.first.simd_le(all.splat(s_max))
            & verdict.last.simd_ge(all.splat(s_min));
        found.possible = possible.to_bitmask() as u32 & ((1 << count) - 1);
        if found.possible == 0 {
            return;
        }
        let certain = verdict.least.simd_gt(error) | verdict.greatest.simd_lt(-error);
        found.certain = certain.to_bitmask() as u32 & found.possible;
        let [nearest, farthest] = verdict.bounds(&all);
        nearest.store_slice(&mut found.nearest);
        farthest.store_slice(&mut found.farthest);
    }
}

#[cfg(test)]
mod tests;
