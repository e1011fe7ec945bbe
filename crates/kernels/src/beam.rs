//! Many lines through one point against boxes and triangles, conservatively.
//!
//! A beam is a pencil of lines through about one point `c` that run along one main axis `z`, in
//! groups of sixteen. Coordinates are relative to `c`, with the sign of `z` turned so that the lines
//! go up: a line is `x = a z`, `y = b z` with `|a|, |b| <= 5/4`, all of it in `f32`.
//!
//! # What it may say
//! As in [`crate::triangles`], with `u = 2^-24` and `*` for the numbers of the exact test. Let `R` be
//! the largest coordinate of anything relative to `c`, and `S` the largest that a sheared vertex,
//! `(x - a z, y - b z)`, has.
//!
//! 1. *Vertices.* Rounded are the vertex, `c`, and `a` and `b`, which is as if the sheared vertex were
//!    moved by `u (|v| + |c|) (1 + 5/4) + (5/4) u R`; the line misses `c`, and the exact test rounds, by
//!    no more than `slack`. With `|v| <= |c| + R` this is below `p = slack + u (8 |c| + 6 R)`.
//! 2. *Boxes.* A box is missed by the group between `a_min` and `a_max` if all of it has
//!    `x < a_min z - 2p`: evaluating that rounds by less than `6u R`, which the second `p` covers.
//!    Likewise on the other three sides and in `z`.
//! 3. *Edges.* The edge function of A and B, `det(A, B, d) = (A x e) . d` with `e = B - A` and
//!    `d = (a, b, 1)`, is the same as the sheared one. The vertices' errors move it by less than
//!    `4.5 S p + 4 p^2`. Rounded further are `A` and `e` (`u` of their own size; that of the vertices
//!    is in `p`), the cross product and the sum; with `M` the largest component of an edge this is
//!    below `72 u R M`. `S` is bounded for a whole group by its outermost lines, since `x - a z` is
//!    linear in `a`.
//! 4. *Depths* of corners are off by less than `p`. That of a crossing is interpolated with the edge
//!    functions; the bound is that of [`crate::triangles`].

mod boxes;
mod edges;

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, f32x16};

use boxes::{BoxSides, box_verdict, passes};
use edges::{Edges, cull, prepare};

use crate::slab::{Boxes8, Scalar, Vector, round_up};
use crate::triangles::{TriangleLine, WINDOW};

/// Lines in a group.
pub const GROUP: usize = 16;
/// Components of a line's direction across the main axis may be so many times the one along it.
pub const STEEPEST_SLOPE: f64 = 1.25;

const U: f32 = 1.0 / (1 << 24) as f32;

/// The point that the lines of a beam go through, and how exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamFrame {
    /// Across, across, main axis.
    axes: [usize; 3],
    /// Whether the lines go down the main axis.
    down: bool,
    /// The common point, by these axes.
    origin: [f32; 3],
    /// `p` of the module's analysis.
    error: f32,
    /// `72 u R`.
    edge_error: f32,
}

impl BeamFrame {
    /// Lines through about `origin` that run along the axis `main`, near boxes with coordinates of up
    /// to `extent` in size. They miss the point, and the exact test rounds, by no more than `slack`,
    /// at least `2^-41`.
    #[must_use]
    pub fn new(origin: [f64; 3], main: usize, down: bool, extent: f64, slack: f64) -> Self {
        let size = origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
        let reach = size + extent;
        let u = f64::from(U);
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        Self {
            axes,
            down,
            origin: [
                origin[axes[0]] as f32,
                origin[axes[1]] as f32,
                origin[axes[2]] as f32,
            ],
            error: round_up(slack + u * (8.0 * size + 6.0 * reach)),
            edge_error: round_up(72.0 * u * reach),
        }
    }

    /// Across, across, main axis.
    #[must_use]
    pub const fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// One line of the beam for [`crate::TriangleTest`], whose parameters are depths then.
    ///
    /// What [`crate::triangles`] proves for `|sx| <= 1` holds with a little more for `5/4`, and with the
    /// rounding of this function.
    #[must_use]
    #[inline]
    pub fn line(&self, [a, b]: [f32; 2]) -> TriangleLine {
        let (sign, [x0, y0, z0]) = (if self.down { -1.0 } else { 1.0 }, self.origin);
        let shear = [a * sign, b * sign];
        let origin = [x0 - shear[0] * z0, y0 - shear[1] * z0, z0];
        let across = origin[0].abs() + origin[1].abs();
        let error = self.error + U * (10.0 * z0.abs() + 5.0 * across);
        TriangleLine::sheared(self.axes, shear, origin, sign, error)
    }

    /// By how much depths are off, at most.
    #[must_use]
    pub const fn error(&self) -> f32 {
        self.error
    }
}

/// Where some lines of a beam are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest and largest `a`, then `b`.
    pub slopes: [[f32; 2]; 2],
    /// The largest depth at which one counts.
    pub end: f32,
}

impl Bounds {
    /// No line.
    pub const NONE: Self = Self {
        slopes: [[f32::INFINITY, f32::NEG_INFINITY]; 2],
        end: f32::NEG_INFINITY,
    };

    /// Around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let around = |i: usize| {
            let ([a, b], [c, d]) = (self.slopes[i], other.slopes[i]);
            [a.min(c), b.max(d)]
        };
        Self {
            slopes: [around(0), around(1)],
            end: self.end.max(other.end),
        }
    }
}

/// Sixteen lines of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Group {
    /// `a` and `b` of each line.
    pub slopes: [[f32; GROUP]; 2],
    /// Up to which depth each line counts.
    pub ends: [f32; GROUP],
    /// Of the lines that count.
    pub bounds: Bounds,
}

impl Group {
    /// No line that counts.
    pub const NONE: Self = Self {
        slopes: [[0.0; GROUP]; 2],
        ends: [f32::NEG_INFINITY; GROUP],
        bounds: Bounds::NONE,
    };

    /// After ends have changed.
    #[inline]
    pub fn shorten(&mut self) {
        let mut end = f32::NEG_INFINITY;
        for &e in &self.ends {
            end = if e > end { e } else { end };
        }
        self.bounds.end = end;
    }
}

/// Triangles of a leaf as a beam sees them, one per lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct BeamTriangles {
    /// Of the edges opposite to the corners: `A x e`, by the beam's axes.
    normals: [[[f32; 8]; 3]; 3],
    /// The corners, by the beam's axes.
    corners: [[[f32; 8]; 3]; 3],
    /// The largest component of an edge.
    size: [f32; 8],
    /// Smallest and largest depth, widened.
    first: [f32; 8],
    last: [f32; 8],
}

/// What is known of sixteen lines and a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct RayCandidates {
    /// Bit `i`: line `i` may cross the triangle before its end.
    pub possible: u32,
    /// Those of them that do so beyond doubt.
    pub certain: u32,
    /// Lower bounds of the depths of the crossings; of the possible ones only.
    pub nearest: [f32; GROUP],
    /// Upper bounds.
    pub farthest: [f32; GROUP],
}

/// Tests of beams.
pub trait BeamTest: Copy {
    /// Bit `i` is set where a line within the bounds may meet box `i` before their end; `entries[i]` is
    /// the least depth of the box.
    fn test_boxes(
        self,
        beam: &BeamFrame,
        bounds: &Bounds,
        boxes: &Boxes8,
        entries: &mut [f32; 8],
    ) -> u32;

    /// Bit `i` is set where line `i` of the group may meet one of the boxes before its end.
    fn test_box(self, beam: &BeamFrame, group: &Group, boxes: &Boxes8, lane: usize) -> u32;

    /// Prepares the triangles of a leaf; for `rows` see [`crate::TriangleTest`].
    fn prepare(
        self,
        beam: &BeamFrame,
        rows: &[f32; WINDOW],
        count: usize,
        triangles: &mut BeamTriangles,
    );

    /// Bit `i` is set where a line of the group may meet triangle `i` before its end; `errors[i]` is
    /// what [`BeamTest::test_rays`] wants to know.
    fn cull(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        errors: &mut [f32; 8],
    ) -> u32;

    /// The lines of a group against one of the triangles.
    fn test_rays(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        triangle: usize,
        error: f32,
        found: &mut RayCandidates,
    );
}

impl BeamTest for Scalar {
    #[inline]
    fn test_boxes(
        self,
        beam: &BeamFrame,
        bounds: &Bounds,
        boxes: &Boxes8,
        entries: &mut [f32; 8],
    ) -> u32 {
        let margin = 2.0 * beam.error;
        let mut mask = 0;
        for (lane, entry) in entries.iter_mut().enumerate() {
            let [across, first, last] = box_verdict::<f32>((), beam, bounds, boxes, lane);
            *entry = first - margin;
            let met = across >= -margin && *entry <= bounds.end && last >= -margin;
            mask |= u32::from(met) << lane;
        }
        mask
    }

    #[inline]
    fn test_box(self, beam: &BeamFrame, group: &Group, boxes: &Boxes8, lane: usize) -> u32 {
        let margin = 2.0 * beam.error;
        let sides = BoxSides::new(beam, boxes, lane);
        let mut mask = 0;
        for line in 0..GROUP {
            let [a, b] = [0, 1].map(|i| {
                let slopes = &group.slopes[i][line..];
                passes::<f32>((), slopes, sides.across[i], sides.depths)
            });
            let met = a >= -margin && b >= -margin && sides.depths[0] - margin <= group.ends[line];
            mask |= u32::from(met) << line;
        }
        mask
    }

    #[inline]
    fn prepare(
        self,
        beam: &BeamFrame,
        rows: &[f32; WINDOW],
        count: usize,
        triangles: &mut BeamTriangles,
    ) {
        for lane in 0..8 {
            prepare::<f32>((), beam, rows, count, lane, triangles);
        }
    }

    #[inline]
    fn cull(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        errors: &mut [f32; 8],
    ) -> u32 {
        let margin = 2.0 * beam.error;
        let mut mask = 0;
        for (lane, out) in errors.iter_mut().enumerate() {
            let [across, error] = cull::<f32>((), beam, group, triangles, lane);
            *out = error;
            let met = across >= -margin
                && triangles.first[lane] <= group.bounds.end
                && triangles.last[lane] >= -margin;
            mask |= u32::from(met) << lane;
        }
        mask
    }

    #[inline]
    fn test_rays(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        triangle: usize,
        error: f32,
        found: &mut RayCandidates,
    ) {
        (found.possible, found.certain) = (0, 0);
        for line in 0..GROUP {
            let edges = Edges::<f32>::new((), group, triangles, triangle, line);
            let crossed = edges.least >= -error || edges.greatest <= error;
            if !(crossed && group.ends[line] >= triangles.first[triangle]) {
                continue;
            }
            let [nearest, farthest] = edges.depths((), beam, triangles, triangle, error);
            (found.nearest[line], found.farthest[line]) = (nearest, farthest);
            if nearest <= group.ends[line] {
                found.possible |= 1 << line;
                let certain = edges.least > error || edges.greatest < -error;
                found.certain |= u32::from(certain) << line;
            }
        }
    }
}

impl<S: Simd> BeamTest for Vector<S> {
    #[inline(always)]
    fn test_boxes(
        self,
        beam: &BeamFrame,
        bounds: &Bounds,
        boxes: &Boxes8,
        entries: &mut [f32; 8],
    ) -> u32 {
        let simd = self.0;
        let splat = f32x8::splat(simd, 2.0 * beam.error);
        let [across, first, last] = box_verdict::<f32x8<S>>(simd, beam, bounds, boxes, 0);
        let entry = first - splat;
        entry.store_slice(entries);
        let met = across.simd_ge(-splat)
            & entry.simd_le(f32x8::splat(simd, bounds.end))
            & last.simd_ge(-splat);
        met.to_bitmask() as u32
    }

    #[inline(always)]
    fn test_box(self, beam: &BeamFrame, group: &Group, boxes: &Boxes8, lane: usize) -> u32 {
        let simd = self.0;
        let margin = 2.0 * beam.error;
        let sides = BoxSides::new(beam, boxes, lane);
        let (x, y) = (&group.slopes[0], &group.slopes[1]);
        let a = passes::<f32x16<S>>(simd, x, sides.across[0], sides.depths);
        let b = passes::<f32x16<S>>(simd, y, sides.across[1], sides.depths);
        let limit = f32x16::splat(simd, -margin);
        let ends = f32x16::from_slice(simd, &group.ends);
        let met = a.simd_ge(limit)
            & b.simd_ge(limit)
            & ends.simd_ge(f32x16::splat(simd, sides.depths[0] - margin));
        met.to_bitmask() as u32
    }

    #[inline(always)]
    fn prepare(
        self,
        beam: &BeamFrame,
        rows: &[f32; WINDOW],
        count: usize,
        triangles: &mut BeamTriangles,
    ) {
        prepare::<f32x8<S>>(self.0, beam, rows, count, 0, triangles);
    }

    #[inline(always)]
    fn cull(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        errors: &mut [f32; 8],
    ) -> u32 {
        let simd = self.0;
        let margin = f32x8::splat(simd, -2.0 * beam.error);
        let [across, error] = cull::<f32x8<S>>(simd, beam, group, triangles, 0);
        error.store_slice(errors);
        let first = f32x8::from_slice(simd, &triangles.first);
        let last = f32x8::from_slice(simd, &triangles.last);
        let met = across.simd_ge(margin)
            & first.simd_le(f32x8::splat(simd, group.bounds.end))
            & last.simd_ge(margin);
        met.to_bitmask() as u32
    }

    #[inline(always)]
    fn test_rays(
        self,
        beam: &BeamFrame,
        group: &Group,
        triangles: &BeamTriangles,
        triangle: usize,
        error: f32,
        found: &mut RayCandidates,
    ) {
        let simd = self.0;
        found.possible = 0;
        let edges = Edges::<f32x16<S>>::new(simd, group, triangles, triangle, 0);
        let limit = f32x16::splat(simd, error);
        let ends = f32x16::from_slice(simd, &group.ends);
        let crossed = (edges.least.simd_ge(-limit) | edges.greatest.simd_le(limit))
            & ends.simd_ge(f32x16::splat(simd, triangles.first[triangle]));
        let crossed = crossed.to_bitmask() as u32;
        if crossed == 0 {
            return;
        }
        let [nearest, farthest] = edges.depths(simd, beam, triangles, triangle, error);
        found.possible = crossed & nearest.simd_le(ends).to_bitmask() as u32;
        let certain = edges.least.simd_gt(limit) | edges.greatest.simd_lt(-limit);
        found.certain = certain.to_bitmask() as u32 & found.possible;
        nearest.store_slice(&mut found.nearest);
        farthest.store_slice(&mut found.farthest);
    }
}

#[cfg(test)]
mod tests;
