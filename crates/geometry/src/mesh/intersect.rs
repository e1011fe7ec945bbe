//! Watertight intersection of lines and triangles, in `f64`.
//!
//! The method is that of Woop, Benthin & Wald, *Watertight Ray/Triangle Intersection* (JCGT 2013):
//! move the ray's origin to (0, 0, 0), shear so that the ray runs along one axis, and ask whether
//! the triangle, seen in the plane of the other two axes, covers the point (0, 0). The vertices
//! are rounded once, each by itself; from there on every decision is exact:
//!
//! * The edge function of a and b is `ax by - ay bx`, a difference of two products. Rounding is
//!   monotone and a difference of two unequal floats is not zero, so a rounded value that is not
//!   zero has the sign of the exact one. Only a rounded zero (or an overflow) needs exact integers.
//! * An exact zero is decided as if the ray stood at (e, e^2) for an infinitesimal e > 0
//!   (Edelsbrunner & Mücke 1990). The moved edge function is `ax by - ay bx + e (ay - by) +
//!   e^2 (bx - ax)`, so the signs of `ay - by`, then of `bx - ax`, decide.
//!
//! Both are antisymmetric in a and b, so the two triangles of an edge never both claim or both
//! miss the line. A closed mesh, seen in the plane, covers every point as often from the front as
//! from the back: the line enters it exactly as often as it leaves it. A triangle without area in
//! the plane is never hit, because its three edge functions add up to zero.
//!
//! For eight lines at a time a kernel does the same ([`octray_kernels::crossings`]). An edge function
//! that is small beside its products is evaluated again without cancellation, so that its relative
//! error, and with it the weights', stays below 2^-45.
//!
//! Equal positions behave as one vertex whatever their indices.

use octray_kernels::crossings::{CANCELLED, SAFE_AREA};
use octray_math::{DVec3, Ray};

use super::TriangleMesh;
use super::exact_cross::exact_cross;

/// A line, set up for many triangles.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    origin: DVec3,
    axes: [usize; 3],
    shear: [f64; 2],
    depth_per_t: f64,
}

/// Where a line crosses a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Any sign, in units of the ray's direction.
    pub t: f64,
    /// Whether the line comes from the side on which the corners run counter-clockwise.
    pub entering: bool,
    /// Weights of the three corners: not negative, sum 1.
    pub barycentric: [f64; 3],
}

/// A crossing of a line with one triangle of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshCrossing {
    /// In units of the ray's direction.
    pub t: f64,
    /// Index of the triangle in its mesh.
    pub triangle: u32,
    /// Whether the line goes from the outside (the front of the triangle) to the inside.
    pub entering: bool,
}

/// A product pair: the edge function is `plus - minus`.
#[derive(Clone, Copy)]
struct Edge {
    plus: f64,
    minus: f64,
}

impl TriangleRay {
    /// Prepares the line through `ray`; only the parameters know where it starts.
    ///
    /// A ray that is not valid (see [`Ray::is_valid`]) meets no triangle.
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let [x, y, z] = Self::axes(d);
        Self {
            origin: ray.origin,
            axes: [x, y, z],
            shear: [d[x] / d[z], d[y] / d[z]],
            depth_per_t: d[z],
        }
    }

    /// Two axes across a direction, and the one along which it is longest.
    #[inline(always)]
    #[must_use]
    pub fn axes(direction: DVec3) -> [usize; 3] {
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // Keeps the sense of rotation as the ray sees it.
        if direction[z] < 0.0 {
            [y, x, z]
        } else {
            [x, y, z]
        }
    }

    /// The vertex relative to the origin, in the plane across the ray and along it.
    #[inline]
    fn sheared(&self, vertex: DVec3) -> ([f64; 2], f64) {
        let v = (vertex - self.origin).to_array();
        let [x, y, z] = self.axes;
        let depth = v[z];
        let across = [v[x] - self.shear[0] * depth, v[y] - self.shear[1] * depth];
        (across, depth)
    }

    /// Where the whole line (any `t`) crosses the triangle.
    ///
    /// `t` and the weights are the same bits for any order of the corners. The point at `t` lies
    /// in the box around the corners up to a few units in the last place of the largest of their
    /// distances to the origin, however thin the triangle.
    #[must_use]
    #[inline]
    pub fn intersect(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        // Written out: the closures of `map` are not always inlined, and this is the hottest code.
        let [a, b, c] = corners;
        let ((a, az), (b, bz), (c, cz)) = (self.sheared(a), self.sheared(b), self.sheared(c));
        let edges = [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)];
        let values = [edges[0].value(), edges[1].value(), edges[2].value()];
        let [u, v, w] = values;
        let (some_front, some_back) =
            (u > 0.0 || v > 0.0 || w > 0.0, u < 0.0 || v < 0.0 || w < 0.0);
        // Two clear and opposite signs are a miss without more ado.
        if some_front && some_back {
            return None;
        }
        let clear = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
        // Zeros (and NaN, from products that overflow) are looked at again.
        let leaving = if clear {
            u > 0.0
        } else {
            unanimous([sign(u, b, c), sign(v, c, a), sign(w, a, b)])?
        };
        let weights = weights(edges, values, [a, b, c]);
        let (t, barycentric) = self.parameter(weights, [az, bz, cz]);
        Some(TriangleHit {
            t,
            entering: !leaving,
            barycentric,
        })
    }

    /// Interpolates the depth, starting from the corner with the largest weight (the nearer one of
    /// equals), so that equal depths come out as they are and the order of corners is no matter.
    #[inline]
    fn parameter(&self, weights: [f64; 3], depths: [f64; 3]) -> (f64, [f64; 3]) {
        let mut first = 0;
        for i in 1..3 {
            if weights[i] > weights[first]
                || (weights[i] == weights[first] && depths[i] < depths[first])
            {
                first = i;
            }
        }
        let (second, third) = ((first + 1) % 3, (first + 2) % 3);
        let total = weights[first] + (weights[second] + weights[third]);
        let barycentric = [weights[0] / total, weights[1] / total, weights[2] / total];
        let offset = barycentric[second] * (depths[second] - depths[first])
            + barycentric[third] * (depths[third] - depths[first]);
        ((depths[first] + offset) / self.depth_per_t, barycentric)
    }
}

impl Edge {
    #[inline]
    fn new(a: [f64; 2], b: [f64; 2]) -> Self {
        Self {
            plus: a[0] * b[1],
            minus: a[1] * b[0],
        }
    }

    #[inline]
    fn value(self) -> f64 {
        self.plus - self.minus
    }
}

/// The sign of the edge function, of the moved point where it vanishes; 0 for a single point.
fn sign(value: f64, a: [f64; 2], b: [f64; 2]) -> i8 {
    if value > 0.0 {
        return 1;
    }
    if value < 0.0 {
        return -1;
    }
    let order = |p: f64, q: f64| p.partial_cmp(&q).map_or(0, |o| o as i8);
    let candidates = [
        order(exact_cross(a, b).mantissa, 0.0),
        order(a[1], b[1]),
        order(b[0], a[0]),
    ];
    candidates.into_iter().find(|&s| s != 0).unwrap_or(0)
}

/// Whether all signs are positive (or all negative); `None` where they differ or one is zero.
fn unanimous(signs: [i8; 3]) -> Option<bool> {
    match signs {
        [1, 1, 1] => Some(true),
        [-1, -1, -1] => Some(false),
        _ => None,
    }
}

/// The sizes of the edge functions up to a common factor, with small relative errors.
#[inline]
fn weights(edges: [Edge; 3], values: [f64; 3], points: [[f64; 2]; 3]) -> [f64; 3] {
    let sizes = [values[0].abs(), values[1].abs(), values[2].abs()];
    let products = |e: Edge| CANCELLED * (e.plus.abs() + e.minus.abs());
    // Without branches in between.
    let accurate = (sizes[0] >= products(edges[0]))
        & (sizes[1] >= products(edges[1]))
        & (sizes[2] >= products(edges[2]));
    if accurate && SAFE_AREA.contains(&sizes[0].max(sizes[1]).max(sizes[2])) {
        return sizes;
    }
    let [a, b, c] = points;
    let exact = [exact_cross(b, c), exact_cross(c, a), exact_cross(a, b)];
    let top = exact.iter().map(|e| e.top()).max().unwrap_or(0);
    exact.map(|e| e.scaled_down(top).abs())
}

impl TriangleMesh {
    /// The corners of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles()[triangle as usize].map(|i| self.positions()[i as usize])
    }

    /// Appends every crossing of the whole line, in the order of the triangles: the oracle of all
    /// faster ways.
    pub fn crossings_brute_force(&self, ray: &Ray, out: &mut Vec<MeshCrossing>) {
        let line = TriangleRay::new(ray);
        for triangle in 0..self.triangles().len() as u32 {
            if let Some(hit) = line.intersect(self.corners(triangle)) {
                out.push(MeshCrossing {
                    t: hit.t,
                    triangle,
                    entering: hit.entering,
                });
            }
        }
    }
}
