//! A piece of a surface between two triangles, and whether it touches a cube.

use std::ops::AddAssign;

use octray_math::{Aabb, DAffine3, DVec3};
use octray_tree::triangle_cube::{Step, triangle_meets_cube};

/// A piece of a surface: while one triangle is blended into the other, corner by corner, it passes every
/// point of the piece. So the piece lies in the convex hull of both, and so do the pieces of a patch that
/// is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellPatch {
    /// Of the inscribed shell.
    pub inner: [DVec3; 3],
    /// Of the circumscribed shell; the same triangle where the surface is flat.
    pub outer: [DVec3; 3],
}

/// How often each step of the triangle-cube test decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepCounts {
    /// A vertex lies in the cube.
    pub vertex: u64,
    /// All vertices lie beyond one face.
    pub face: u64,
    /// An edge meets the cube.
    pub edge: u64,
    /// The triangle meets the diagonal most perpendicular to it, or not.
    pub diagonal: u64,
    /// Both triangles miss the cube: whether it lies between them was decided.
    pub between: u64,
}

impl StepCounts {
    fn count(&mut self, step: Step) {
        *match step {
            Step::Vertex => &mut self.vertex,
            Step::Face => &mut self.face,
            Step::Edge => &mut self.edge,
            Step::Diagonal => &mut self.diagonal,
        } += 1;
    }
}

impl AddAssign for StepCounts {
    fn add_assign(&mut self, other: Self) {
        self.vertex += other.vertex;
        self.face += other.face;
        self.edge += other.edge;
        self.diagonal += other.diagonal;
        self.between += other.between;
    }
}

impl ShellPatch {
    /// A piece of a plane.
    #[must_use]
    pub const fn flat(triangle: [DVec3; 3]) -> Self {
        Self {
            inner: triangle,
            outer: triangle,
        }
    }

    /// The patch in another frame: convex hulls stay what they are.
    #[must_use]
    pub fn transformed(&self, to: &DAffine3) -> Self {
        let move_all = |triangle: [DVec3; 3]| triangle.map(|p| to.transform_point3(p));
        Self {
            inner: move_all(self.inner),
            outer: move_all(self.outer),
        }
    }

    /// The box around both triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.inner.into_iter().chain(self.outer))
    }

    /// Whether the cube may hold a point of the hull of both triangles: exactly where one of them meets
    /// it, too often where it lies between them.
    #[must_use]
    pub fn meets(&self, cell: &Aabb, counts: &mut StepCounts) -> bool {
        let mut met = |triangle: &[DVec3; 3]| {
            let verdict = triangle_meets_cube(triangle, cell);
            counts.count(verdict.step);
            verdict.meets
        };
        if met(&self.inner) {
            return true;
        }
        if self.inner == self.outer {
            return false;
        }
        if met(&self.outer) {
            return true;
        }
        counts.between += 1;
        !self.is_apart(cell)
    }

    /// Whether some plane has the hull on one side and the cube on the other (Gottschalk, Lin and
    /// Manocha 1996). Asked of the directions that separate most often; a plane that leaves no doubt
    /// about rounding is needed.
    fn is_apart(&self, cell: &Aabb) -> bool {
        let (center, half) = (cell.center(), cell.half_size());
        let points = [
            self.inner[0] - center,
            self.inner[1] - center,
            self.inner[2] - center,
            self.outer[0] - center,
            self.outer[1] - center,
            self.outer[2] - center,
        ];
        let largest = points
            .iter()
            .fold(half.max(center.abs()), |largest, p| largest.max(p.abs()))
            .max_element();
        let separates = |axis: DVec3| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for p in &points {
                let x = axis.dot(*p);
                low = low.min(x);
                high = high.max(x);
            }
            let size = axis.abs();
            let slack = 16.0 * f64::EPSILON * (size.x + size.y + size.z) * largest;
            let reach = size.dot(half) + slack + f64::MIN_POSITIVE;
            low > reach || high < -reach
        };
        let edges = |t: usize| {
            let t = 3 * t;
            [
                points[t + 1] - points[t],
                points[t + 2] - points[t + 1],
                points[t] - points[t + 2],
            ]
        };
        let (inner, outer) = (edges(0), edges(1));
        let walls = (0..3).map(|i| inner[i].cross(points[3 + i] - points[i]));
        let outer_walls = (0..3).map(|i| outer[i].cross(points[3 + i] - points[i]));
        let crossed = inner
            .into_iter()
            .chain(outer)
            .flat_map(|e| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| e.cross(axis)));
        [DVec3::X, DVec3::Y, DVec3::Z]
            .into_iter()
            .chain([inner[0].cross(inner[1]), outer[0].cross(outer[1])])
            .chain(walls)
            .chain(outer_walls)
            .chain(crossed)
            .any(separates)
    }

    /// Both halves of the patch, cut across its longest edge.
    pub(super) fn halves(&self) -> [Self; 2] {
        let length = |i: usize| self.outer[i].distance_squared(self.outer[(i + 1) % 3]);
        let longest = (0..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
        let (i, j, k) = (longest, (longest + 1) % 3, (longest + 2) % 3);
        let half = |from: usize, to: usize| {
            let cut = |t: &[DVec3; 3]| [t[from], (t[i] + t[j]) * 0.5, t[to]];
            Self {
                inner: cut(&self.inner),
                outer: cut(&self.outer),
            }
        };
        [half(i, k), half(j, k)]
    }
}
