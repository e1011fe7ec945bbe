//! Does a triangle meet a cube? The four-step test of Martinka, *Using an octree to accelerate ray
//! tracing* (1993), section 6.3, with every sign exact.
//!
//! 1. A vertex inside the cube: yes.
//! 2. All three vertices beyond one face: no. (Outcodes of Cohen and Sutherland, with six bits.)
//! 3. An edge meets the cube: yes. Outcodes again; where they do not decide, the edge misses
//!    exactly if, seen along some axis, all corners of the cube's square lie on one side of it.
//! 4. Otherwise only the inside of the triangle can meet the cube, and what the plane cuts out of
//!    the cube lies wholly inside the triangle or wholly outside. The plane cuts the cube exactly
//!    where it cuts the space diagonal that is most perpendicular to it: the triangle meets the cube
//!    if it meets that diagonal.
//!
//! Both are closed: touching counts. Orientations come from adaptive exact predicates (Shewchuk
//! 1997), so the answer is right unless a product of coordinate differences underflows or overflows;
//! then it may be *yes* too often, never *no*.

use octray_math::{Aabb, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The step at which a case was decided, in the order in which they are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Step {
    /// A vertex lies inside.
    Vertex,
    /// All vertices lie beyond one face.
    Face,
    /// An edge meets the cube.
    Edge,
    /// The triangle meets the diagonal most perpendicular to it, or not.
    Diagonal,
}

/// Whether a triangle meets a cube, and which step found out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Whether they have a point in common.
    pub meets: bool,
    /// What decided it.
    pub step: Step,
}

/// The six bits of a point: beyond which faces of the cube it lies.
fn outcode(p: DVec3, cube: &Aabb) -> u8 {
    let bit = |beyond: bool, bit: u8| u8::from(beyond) << bit;
    bit(p.x < cube.min.x, 0)
        | bit(p.x > cube.max.x, 1)
        | bit(p.y < cube.min.y, 2)
        | bit(p.y > cube.max.y, 3)
        | bit(p.z < cube.min.z, 4)
        | bit(p.z > cube.max.z, 5)
}

/// Whether the closed triangle meets the closed box (of any proportions). All numbers finite.
#[must_use]
pub fn triangle_meets_cube(triangle: &[DVec3; 3], cube: &Aabb) -> Verdict {
    let codes = triangle.map(|p| outcode(p, cube));
    let decided = |step, meets| Verdict { meets, step };
    if codes.contains(&0) {
        return decided(Step::Vertex, true);
    }
    if codes[0] & codes[1] & codes[2] != 0 {
        return decided(Step::Face, false);
    }
    // The last step would say so after all edges.
    if plane_clearly_misses(triangle, cube) {
        return decided(Step::Diagonal, false);
    }
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        if codes[i] & codes[j] != 0 {
            continue;
        }
        match separating_axis(triangle[i], triangle[j], cube) {
            None => return decided(Step::Edge, true),
            // Seen along this axis, the triangle lies on the other side of the edge: all of it
            // misses, which the last step would find.
            Some((axis, side)) if !is_beyond(triangle, (i, j, k), axis, side) => {
                return decided(Step::Diagonal, false);
            }
            Some(_) => {}
        }
    }
    decided(Step::Diagonal, meets_diagonal(triangle, cube))
}

/// Whether the triangle's plane misses the box by more than rounding. Most triangles that fool their
/// outcodes do, and this is much faster than asking their edges.
fn plane_clearly_misses([a, b, c]: &[DVec3; 3], cube: &Aabb) -> bool {
    let (u, v) = (*b - *a, *c - *a);
    let normal = u.cross(v);
    let down = normal.cmplt(DVec3::ZERO);
    let lowest = DVec3::select(down, cube.max, cube.min) - *a;
    let highest = DVec3::select(down, cube.min, cube.max) - *a;
    // Each component of the normal is right to 4 units in the last place of this, each product with
    // it to 2 more; the three products and their sums stay below 32 of them.
    let size = u.abs().max_element() * v.abs().max_element();
    let reach = lowest.abs().element_sum().max(highest.abs().element_sum());
    let error = 32.0 * f64::EPSILON * size * reach;
    error > UNDERFLOW && (normal.dot(lowest) > error || normal.dot(highest) < -error)
}

/// Whether corner `k` lies on the given side of the edge from `i` to `j`, seen along the axis.
fn is_beyond(
    triangle: &[DVec3; 3],
    (i, j, k): (usize, usize, usize),
    axis: usize,
    side: f64,
) -> bool {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let [from, to, third] = [i, j, k].map(|corner| Coord {
        x: triangle[corner][u],
        y: triangle[corner][v],
    });
    // Written so that a NaN, or a zero that may have underflowed, means yes.
    let turn = orient2d(from, to, third) * side;
    !(turn < 0.0)
}

/// The axis along which one sees that the segment misses the box, and the side of it on which the
/// box lies, given that no face separates them; `None` if they meet.
fn separating_axis(a: DVec3, b: DVec3, cube: &Aabb) -> Option<(usize, f64)> {
    // The other axes that can separate are perpendicular to the edge and to an axis: seen along
    // that axis, the edge's line has the whole square on one side.
    (0..3).find_map(|axis| {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let point = |p: DVec3| Coord { x: p[u], y: p[v] };
        let (from, to) = (point(a), point(b));
        let corners = [
            (cube.min[u], cube.min[v]),
            (cube.max[u], cube.min[v]),
            (cube.max[u], cube.max[v]),
            (cube.min[u], cube.max[v]),
        ];
        let sides = corners.map(|(x, y)| orient2d(from, to, Coord { x, y }));
        if sides.iter().all(|s| *s > 0.0) {
            Some((axis, 1.0))
        } else if sides.iter().all(|s| *s < 0.0) {
            Some((axis, -1.0))
        } else {
            None
        }
    })
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

/// Products of three lengths below this may have lost their sign.
const UNDERFLOW: f64 = 1e-280;

/// Whether the triangle, no edge of which meets the cube, meets the diagonal that is most
/// perpendicular to its plane.
fn meets_diagonal([a, b, c]: &[DVec3; 3], cube: &Aabb) -> bool {
    if a == b || b == c || c == a {
        return false;
    }
    let (u, v) = (*b - *a, *c - *a);
    let normal = u.cross(v);
    // Where rounding leaves a component's sign open, both diagonals may be the right one.
    let size = u.abs().max_element() * v.abs().max_element();
    if size * cube.size().max_element() < UNDERFLOW {
        return true;
    }
    let unsure = normal.abs().cmple(DVec3::splat(8.0 * f64::EPSILON * size));
    let choices = |axis: usize| match (unsure.test(axis), normal[axis] < 0.0) {
        (true, _) => [Some(false), Some(true)],
        (false, down) => [Some(down), None],
    };
    for x in choices(0).into_iter().flatten() {
        for y in choices(1).into_iter().flatten() {
            for z in choices(2).into_iter().flatten() {
                let pick = |down: bool, axis: usize| {
                    if down {
                        (cube.max[axis], cube.min[axis])
                    } else {
                        (cube.min[axis], cube.max[axis])
                    }
                };
                let (x, y, z) = (pick(x, 0), pick(y, 1), pick(z, 2));
                let from = DVec3::new(x.0, y.0, z.0);
                let to = DVec3::new(x.1, y.1, z.1);
                if coplanar(from, to, *a, *b, *c) {
                    // Not the diagonal to ask, or no triangle but a line, which its edges are.
                    continue;
                }
                if segment_meets_triangle(from, to, *a, *b, *c) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether both points lie in the triangle's plane.
fn coplanar(p: DVec3, q: DVec3, a: DVec3, b: DVec3, c: DVec3) -> bool {
    let [p, q, a, b, c] = [p, q, a, b, c].map(coord);
    orient3d(a, b, c, p) == 0.0 && orient3d(a, b, c, q) == 0.0
}

/// Whether a segment meets a closed triangle, given that both are not in one plane.
fn segment_meets_triangle(p: DVec3, q: DVec3, a: DVec3, b: DVec3, c: DVec3) -> bool {
    let [p, q, a, b, c] = [p, q, a, b, c].map(coord);
    let (below, above) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    if (below > 0.0 && above > 0.0) || (below < 0.0 && above < 0.0) {
        return false;
    }
    // The segment's line passes the three edges on one side. Written so that a NaN means yes.
    let sides = [
        orient3d(p, q, a, b),
        orient3d(p, q, b, c),
        orient3d(p, q, c, a),
    ];
    !(sides.iter().any(|s| *s > 0.0) && sides.iter().any(|s| *s < 0.0))
}
