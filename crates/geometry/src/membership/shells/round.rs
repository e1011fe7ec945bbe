//! Inscribed and circumscribed triangulations of spheres, cylinders, cones and tori.
//!
//! Two closed triangulations with the same connections, one that does not enclose any point of the
//! surface and one that encloses all of it: while one is blended into the other, corner by corner, every
//! point of the surface is passed by some triangle, and so lies in the hull of that triangle in both.

use std::f64::consts::{PI, TAU};

use octray_math::DVec3;

use super::ShellPatch;

/// Larger than the rounding of what is computed here.
const ROUNDING: f64 = 1.0 + 1e-9;

/// The angle between the middle and the corner of a chord of the unit circle, for which the circle's shells
/// are `error` apart: `1 / cos - cos = error`.
fn half_angle(error: f64) -> f64 {
    libm::acos(0.5 * (libm::sqrt(error * error + 4.0) - error))
}

fn degenerate(t: &[DVec3; 3]) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

/// Triangles of a net of `columns` x `rows` quadrilaterals between points of both shells.
fn net(
    columns: u32,
    rows: u32,
    point: impl Fn(u32, u32) -> [DVec3; 2],
    patches: &mut Vec<ShellPatch>,
) {
    for i in 0..columns {
        for j in 0..rows {
            let quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| point(i, j));
            for t in [[0, 1, 2], [0, 2, 3]] {
                let patch = ShellPatch {
                    inner: t.map(|k| quad[k][0]),
                    outer: t.map(|k| quad[k][1]),
                };
                if !(degenerate(&patch.inner) && degenerate(&patch.outer)) {
                    patches.push(patch);
                }
            }
        }
    }
}

/// The direction of step `index` of `count` round the z axis; the last is the first, to the bit.
fn direction(index: u32, count: u32) -> DVec3 {
    let angle = TAU * f64::from(index % count) / f64::from(count);
    DVec3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

/// The sphere of radius 1 about the origin. Returns the largest distance of the shells too.
///
/// Octants divided into triangles with corners on the sphere: each is the base of a cone from the centre,
/// and the sphere's part of that cone lies between the triangle and the same one scaled by the reciprocal of its
/// distance from the centre.
pub(super) fn sphere(chord_error: f64, limit: usize) -> (Vec<ShellPatch>, f64) {
    // The largest triangles have corners 0.7 of the division of an edge away from their middle.
    let division = half_angle(chord_error.clamp(1e-7, 1.0)) / 0.7;
    let wanted = libm::ceil(0.5 * PI / division).clamp(1.0, 1e4) as u32;
    let most = libm::sqrt(limit as f64 / 8.0).max(1.0) as u32;
    let n = wanted.min(most);
    let corner = |i: u32, j: u32, signs: DVec3| {
        let p = DVec3::new(f64::from(i), f64::from(j), f64::from(n - i - j));
        // Evenly by angle along the edges: nearly equal triangles.
        let bent = p.to_array().map(|x| libm::sin(0.5 * PI * x / f64::from(n)));
        DVec3::from_array(bent).normalize() * signs
    };
    let mut patches = Vec::with_capacity(8 * (n * n) as usize);
    let mut least: f64 = 1.0;
    for octant in 0..8_u32 {
        let sign = |axis: u32| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
        let signs = DVec3::new(sign(0), sign(1), sign(2));
        for i in 0..n {
            for j in 0..n - i {
                let [a, b, d] = [(i, j), (i + 1, j), (i, j + 1)].map(|(i, j)| corner(i, j, signs));
                let mut triangles = vec![[a, b, d]];
                if i + j + 2 <= n {
                    triangles.push([b, corner(i + 1, j + 1, signs), d]);
                }
                for inner in triangles {
                    let normal = (inner[1] - inner[0]).cross(inner[2] - inner[0]).normalize();
                    least = least.min(normal.dot(inner[0]).abs());
                    patches.push(ShellPatch::flat(inner));
                }
            }
        }
    }
    let scale = ROUNDING / least;
    for patch in &mut patches {
        patch.outer = patch.outer.map(|p| p * scale);
    }
    (patches, scale - least)
}

/// The frustum about z with `radius[0]` at `z[0]` and `radius[1]` at `z[1]`, with the caps that are asked
/// for: a prism or pyramid inside, and the same scaled from the axis.
pub(super) fn frustum(
    radius: [f64; 2],
    z: [f64; 2],
    caps: [bool; 2],
    chord_error: f64,
    limit: usize,
) -> (Vec<ShellPatch>, f64) {
    let largest = radius[0].max(radius[1]);
    let relative = (chord_error / largest).clamp(1e-7, 1.0);
    let wanted = libm::ceil(PI / half_angle(relative)).clamp(6.0, 1e5) as u32;
    let most = u32::try_from(limit / 4).unwrap_or(u32::MAX).max(6);
    let n = wanted.min(most);
    let scale = ROUNDING / libm::cos(PI / f64::from(n));
    let ring = |i: u32, end: usize, scale: f64| {
        direction(i, n) * (radius[end] * scale) + DVec3::Z * z[end]
    };
    let mut patches = Vec::with_capacity(4 * n as usize);
    let both = |i: u32, j: u32| [1.0, scale].map(|s| ring(i, j as usize, s));
    net(n, 1, both, &mut patches);
    for end in [0, 1] {
        if caps[end] && radius[end] > 0.0 {
            let middle = DVec3::Z * z[end];
            patches.extend(
                (0..n).map(|i| {
                    ShellPatch::flat([middle, ring(i, end, scale), ring(i + 1, end, scale)])
                }),
            );
        }
    }
    (patches, largest * (scale - libm::cos(PI / f64::from(n))))
}

/// The torus about z with major radius 1, of a spindle its outer shape: tubes of two radii.
///
/// A flat triangle over a net with steps `du` round the axis and `dv` round the tube of radius `r` is nowhere
/// farther from the torus than `((1 + r) du^2 + 2 r du dv + r dv^2) / 8` (Filip, Magedson and Markot,
/// *Surface algorithms using bounds on derivatives*, 1986).
pub(super) fn torus(minor: f64, chord_error: f64, limit: usize) -> (Vec<ShellPatch>, f64) {
    // Each shell is one bound away from its triangles and one from the torus; half is for each direction.
    let allowed = (0.24 * chord_error).max(1e-12);
    let steps = |reach: f64, least: u32| {
        let step = libm::sqrt(4.0 * allowed / reach);
        (libm::ceil(TAU / step).clamp(f64::from(least), 1e6)) as u32
    };
    let (mut nu, mut nv) = (steps(1.0 + 2.0 * minor, 6), steps(2.0 * minor, 6));
    while nu as usize * nv as usize * 2 > limit && (nu > 6 || nv > 6) {
        if nv > 6 && (nv > nu || nu <= 6) {
            nv = (nv - nv.div_ceil(8)).max(6);
        } else {
            nu = (nu - nu.div_ceil(8)).max(6);
        }
    }
    let (du, dv) = (TAU / f64::from(nu), TAU / f64::from(nv));
    let (fixed, relative) = (du * du / 8.0, (du + dv) * (du + dv) / 8.0);
    // Every triangle of the one net has a tube distance of at most `minor`, of the other of at least that.
    let slack = 1e-14 * (1.0 + minor);
    let inside = ((minor - fixed) / (1.0 + relative) / ROUNDING - slack).max(0.0);
    let outside = (minor + fixed) / (1.0 - relative) * ROUNDING + slack;
    // A spindle's profile goes from the axis to the axis.
    let half_turn = |r: f64| if r > 1.0 { libm::acos(-1.0 / r) } else { PI };
    // Where only the outer net reaches the axis, a membrane closes the hole of the inner one: then both
    // are nets from pole to pole, and blend without a gap.
    let membrane = outside > 1.0 && inside <= 1.0;
    let rows = if membrane { nv + 2 } else { nv };
    let point = |r: f64, i: u32, row: u32| {
        if membrane && r <= 1.0 && (row == 0 || row == rows) {
            return DVec3::ZERO;
        }
        let j = if membrane {
            row.clamp(1, nv + 1) - 1
        } else {
            row
        };
        let j = if r > 1.0 { j } else { j % nv };
        let v = half_turn(r) * (2.0 * f64::from(j) / f64::from(nv) - 1.0);
        let from_axis = (1.0 + r * libm::cos(v)).max(0.0);
        direction(i, nu) * from_axis + DVec3::Z * (r * libm::sin(v))
    };
    let mut patches = Vec::with_capacity(2 * nu as usize * rows as usize);
    let both = |i: u32, j: u32| [inside, outside].map(|r| point(r, i, j));
    net(nu, rows, both, &mut patches);
    (
        patches,
        outside - inside + 2.0 * (fixed + relative * outside),
    )
}
