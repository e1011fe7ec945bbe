//! Triangles as a beam sees them.

use super::{BeamFrame, BeamTriangles, Group, U};
use crate::lane::Lane;
use crate::triangles::WINDOW;

/// Fills the lanes of prepared triangles from one on.
#[inline(always)]
pub(super) fn prepare<L: Lane>(
    token: L::Token,
    beam: &BeamFrame,
    rows: &[f32; WINDOW],
    count: usize,
    lane: usize,
    out: &mut BeamTriangles,
) {
    let count = count.min(8);
    let mut c = [[L::all(token, 0.0); 3]; 3];
    let mut v = c;
    for corner in 0..3 {
        for i in 0..3 {
            let start = (3 * beam.axes[i] + corner) * count + lane;
            let x = L::load(token, &rows[start..]);
            let origin = L::all(token, beam.origin[i]);
            if i == 2 && beam.down {
                v[corner][i] = L::all(token, 0.0) - x;
                c[corner][i] = origin - x;
            } else {
                v[corner][i] = x;
                c[corner][i] = x - origin;
            }
            c[corner][i].store(&mut out.corners[corner][i][lane..]);
        }
    }
    let mut size = L::all(token, 0.0);
    for corner in 0..3 {
        let (from, to) = ((corner + 1) % 3, (corner + 2) % 3);
        let e = [
            v[to][0] - v[from][0],
            v[to][1] - v[from][1],
            v[to][2] - v[from][2],
        ];
        let a = c[from];
        size = size.max(e[0].abs()).max(e[1].abs()).max(e[2].abs());
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            (a[j] * e[k] - a[k] * e[j]).store(&mut out.normals[corner][i][lane..]);
        }
    }
    let error = L::all(token, beam.error);
    size.store(&mut out.size[lane..]);
    (c[0][2].min(c[1][2]).min(c[2][2]) - error).store(&mut out.first[lane..]);
    (c[0][2].max(c[1][2]).max(c[2][2]) + error).store(&mut out.last[lane..]);
}

/// How far triangles reach into a group on one axis across, and the largest `|x - a z|`.
#[inline(always)]
fn reach<L: Lane>(
    token: L::Token,
    triangles: &BeamTriangles,
    axis: usize,
    [least, most]: [f32; 2],
    lane: usize,
) -> [L; 2] {
    let (least, most) = (L::all(token, least), L::all(token, most));
    let [a, b, c] = &triangles.corners;
    let (az, bz, cz) = (
        L::load(token, &a[2][lane..]),
        L::load(token, &b[2][lane..]),
        L::load(token, &c[2][lane..]),
    );
    let (ax, bx, cx) = (
        L::load(token, &a[axis][lane..]),
        L::load(token, &b[axis][lane..]),
        L::load(token, &c[axis][lane..]),
    );
    let (ap, bp, cp) = (ax - least * az, bx - least * bz, cx - least * cz);
    let (aq, bq, cq) = (most * az - ax, most * bz - bx, most * cz - cx);
    let inside = ap.max(bp).max(cp).min(aq.max(bq).max(cq));
    let sheared = ap.abs().max(bp.abs()).max(cp.abs());
    let sheared = sheared.max(aq.abs().max(bq.abs()).max(cq.abs()));
    [inside, sheared]
}

/// The overlap of triangles with a group, and the error of their edge functions.
#[inline(always)]
pub(super) fn cull<L: Lane>(
    token: L::Token,
    beam: &BeamFrame,
    group: &Group,
    triangles: &BeamTriangles,
    lane: usize,
) -> [L; 2] {
    let [inside_x, sheared_x] = reach::<L>(token, triangles, 0, group.bounds.slopes[0], lane);
    let [inside_y, sheared_y] = reach::<L>(token, triangles, 1, group.bounds.slopes[1], lane);
    let sheared = sheared_x.max(sheared_y);
    let p = L::all(token, beam.error);
    let size = L::load(token, &triangles.size[lane..]);
    let error = p * (L::all(token, 4.5) * sheared + L::all(token, 4.0) * p)
        + L::all(token, beam.edge_error) * size;
    [inside_x.min(inside_y), error]
}

/// Everything that decides about a line and a triangle.
pub(super) struct Edges<L> {
    pub(super) values: [L; 3],
    pub(super) least: L,
    pub(super) greatest: L,
}

impl<L: Lane> Edges<L> {
    #[inline(always)]
    pub(super) fn new(
        token: L::Token,
        group: &Group,
        triangles: &BeamTriangles,
        triangle: usize,
        line: usize,
    ) -> Self {
        let a = L::load(token, &group.slopes[0][line..]);
        let b = L::load(token, &group.slopes[1][line..]);
        let mut values = [a; 3];
        for (value, normal) in values.iter_mut().zip(&triangles.normals) {
            let n0 = L::all(token, normal[0][triangle]);
            let n1 = L::all(token, normal[1][triangle]);
            let n2 = L::all(token, normal[2][triangle]);
            *value = n0 * a + n1 * b + n2;
        }
        Self {
            values,
            least: values[0].min(values[1]).min(values[2]),
            greatest: values[0].max(values[1]).max(values[2]),
        }
    }

    /// Bounds of the depth of a crossing.
    #[inline(always)]
    pub(super) fn depths(
        &self,
        token: L::Token,
        beam: &BeamFrame,
        triangles: &BeamTriangles,
        triangle: usize,
        error: f32,
    ) -> [L; 2] {
        let (first, last) = (triangles.first[triangle], triangles.last[triangle]);
        let range = last - first;
        let [a, b, c] = &triangles.corners;
        let [u, v, w] = self.values;
        let sum = u + v + w;
        let numerator = u * L::all(token, a[2][triangle] - first)
            + v * L::all(token, b[2][triangle] - first)
            + w * L::all(token, c[2][triangle] - first);
        // Tiny sums make the margin larger than any range.
        let size = sum.abs().max(L::all(token, 1e-37));
        let share = L::all(token, 1.0) / size;
        let depth = L::all(token, first) + numerator * (sum * share) * share;
        let margin = L::all(token, range)
            * (L::all(token, 5.0 * error) * share + L::all(token, 32.0 * U))
            + L::all(token, 3.0 * beam.error);
        [
            (depth - margin).max(L::all(token, first)),
            (depth + margin).min(L::all(token, last)),
        ]
    }
}
