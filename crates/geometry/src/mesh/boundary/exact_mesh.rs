//! Triangles with exact predicates: on which side is a point, and how often is it wound round?

use std::cell::Cell;

use octray_math::{Aabb, DVec3, Ray};
use octray_tree::{WalkCost, WideTree, WideTreeConfig};
use robust::{Coord, Coord3D};

use crate::mesh::{TriangleMesh, TriangleRay};

/// A mesh scaled by a power of two, so that no predicate over- or underflows: the largest
/// coordinate lies about 2^300, those below 2^-300 are 0. Then the lowest bit of a product of three
/// differences is at least 2^-1056.
pub(super) struct ExactMesh {
    positions: Vec<DVec3>,
    /// Positions of equal coordinates have one index. Triangles without area are left out.
    triangles: Vec<[u32; 3]>,
    /// Which triangles of the mesh they are.
    sources: Vec<u32>,
    bounds: Vec<Aabb>,
    tree: Option<WideTree>,
    /// The exponent of the factor.
    shift: i32,
    /// Triangles that lines may still be tested against.
    tests_left: Cell<u64>,
}

/// So many tests of lines against triangles are spent on one mesh, and this many more for every
/// triangle.
const TESTS: u64 = 5_000_000;
const TESTS_PER_TRIANGLE: u64 = 300;

const LARGEST_EXPONENT: i32 = 300;

impl ExactMesh {
    pub(super) fn new(mesh: &TriangleMesh, ids: &[u32]) -> Self {
        let largest = mesh
            .used_positions()
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
        // In two steps: the whole factor may leave the range.
        let shift = if largest > 0.0 {
            LARGEST_EXPONENT - libm::ilogb(largest)
        } else {
            0
        };
        let smallest = libm::scalbn(1.0, -LARGEST_EXPONENT);
        let scaled = |x: f64| {
            let y = libm::scalbn(x, shift);
            if y.abs() < smallest { 0.0 } else { y }
        };
        let positions: Vec<DVec3> = mesh
            .positions()
            .iter()
            .map(|p| DVec3::from_array(p.to_array().map(scaled)))
            .collect();
        let (mut triangles, mut sources, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        for (source, corners) in mesh.triangles().iter().enumerate() {
            let corners = corners.map(|i| ids[i as usize]);
            let points = corners.map(|i| positions[i as usize]);
            if has_area(points) {
                triangles.push(corners);
                sources.push(source as u32);
                bounds.push(Aabb::from_points(points));
            }
        }
        let config = WideTreeConfig {
            memory_limit: u64::MAX,
            ..WideTreeConfig::default()
        };
        // At most 2^30 bounded triangles: only beyond 2^28 there is no tree.
        let tree = WideTree::build(&bounds, &config).ok();
        let tests = TESTS + TESTS_PER_TRIANGLE * triangles.len() as u64;
        Self {
            tests_left: Cell::new(tests),
            positions,
            triangles,
            sources,
            bounds,
            tree,
            shift,
        }
    }

    pub(super) fn len(&self) -> u32 {
        self.triangles.len() as u32
    }

    pub(super) fn source(&self, triangle: u32) -> u32 {
        self.sources[triangle as usize]
    }

    /// Which of these triangles is the one of this number in the mesh.
    pub(super) fn of_source(&self, source: u32) -> Option<u32> {
        self.sources.binary_search(&source).ok().map(|i| i as u32)
    }

    /// Position ids of the corners.
    pub(super) fn ids(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.ids(triangle).map(|i| self.positions[i as usize])
    }

    /// In the mesh's own units.
    pub(super) fn unscaled(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(point.to_array().map(|x| libm::scalbn(x, -self.shift)))
    }

    /// Shows `visit` every later triangle whose box overlaps that of `triangle`, in no particular
    /// order.
    pub(super) fn later_neighbours(&self, triangle: u32, mut visit: impl FnMut(u32)) {
        let own = &self.bounds[triangle as usize];
        let mut look = |other: u32| {
            if other > triangle && own.overlaps(&self.bounds[other as usize]) {
                visit(other);
            }
            false
        };
        match &self.tree {
            Some(tree) => drop(tree.any_overlapping(own, &mut look)),
            None => drop((0..self.len()).any(look)),
        }
    }

    /// Whether so many lines have been tested that no more should be: the mesh is a tangle.
    pub(super) fn is_exhausted(&self) -> bool {
        self.tests_left.get() == 0
    }

    /// Triangles whose boxes the line may meet.
    fn along(&self, ray: &Ray, mut visit: impl FnMut(u32)) {
        let mut visit = |triangle: u32| {
            let left = self.tests_left.get().saturating_sub(1);
            self.tests_left.set(left);
            visit(triangle);
        };
        match &self.tree {
            Some(tree) => tree.all(
                ray,
                octray_math::Interval::ALL,
                &mut WalkCost::default(),
                visit,
            ),
            None => (0..self.len()).for_each(&mut visit),
        }
    }

    /// Points close to the triangle on either side of it, on the line that crosses it at `at`: half
    /// way to whatever comes next. What they are good for must be found out exactly.
    pub(super) fn beside(&self, triangle: u32, at: DVec3) -> [Option<DVec3>; 2] {
        let [a, b, c] = self.corners(triangle);
        let size = (b - a).abs().max_element().max((c - a).abs().max_element());
        let normal = ((b - a) / size).cross((c - a) / size);
        let normal = normal / normal.abs().max_element();
        if !normal.is_finite() {
            return [None, None];
        }
        let ray = Ray::new(at, normal);
        let line = TriangleRay::new(&ray);
        let Some(own) = line.intersect([a, b, c]) else {
            return [None, None];
        };
        let (mut before, mut after) = (own.t - size, own.t + size);
        self.along(&ray, |other| {
            if let Some(hit) = line.intersect(self.corners(other)) {
                if hit.t < own.t {
                    before = before.max(hit.t);
                } else if hit.t > own.t {
                    after = after.min(hit.t);
                }
            }
        });
        [before, after].map(|t| Some(ray.at(0.5 * (own.t + t))))
    }

    /// How often the mesh runs round a point; `None` if the point lies on it. Exact if the mesh is
    /// closed.
    ///
    /// Counts the triangles that the line from the point along x crosses. One that passes through
    /// an edge or vertex is moved by (e, e^2) in y and z for an infinitesimal e > 0, as in
    /// [`TriangleRay`].
    pub(super) fn winding_number(&self, point: DVec3) -> Option<i64> {
        let (mut winding, mut on_surface) = (0, false);
        self.along(&Ray::new(point, DVec3::X), |triangle| {
            let [a, b, c] = self.corners(triangle);
            let Some(facing) = covers(a, b, c, point) else {
                return;
            };
            let below = side([a, b, c], point);
            on_surface |= below == 0.0;
            if (below > 0.0) == (facing > 0) {
                winding += facing;
            }
        });
        (!on_surface).then_some(winding)
    }
}

/// Whether the triangle, seen along x, covers the moved point: 1 if its corners run
/// counter-clockwise seen from +x, -1 if clockwise.
fn covers(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> Option<i64> {
    let order = |p: f64, q: f64| p.partial_cmp(&q).map_or(0, |o| o as i64);
    let sign = |a: DVec3, b: DVec3| {
        let area = robust::orient2d(flat(a, 0), flat(b, 0), flat(p, 0));
        let candidates = [order(area, 0.0), order(a.z, b.z), order(b.y, a.y)];
        candidates.into_iter().find(|&s| s != 0).unwrap_or(0)
    };
    let first = sign(a, b);
    (first != 0 && sign(b, c) == first && sign(c, a) == first).then_some(first)
}

/// Positive behind the triangle, negative in front of it (where the corners run
/// counter-clockwise), 0 in its plane; about six times the volume between.
pub(super) fn side([a, b, c]: [DVec3; 3], p: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    robust::orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// The point seen along an axis.
pub(super) fn flat(p: DVec3, axis: usize) -> Coord<f64> {
    let p = p.to_array();
    Coord {
        x: p[(axis + 1) % 3],
        y: p[(axis + 2) % 3],
    }
}

/// Whether the corners are not on one line.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    (0..3).any(|axis| robust::orient2d(flat(a, axis), flat(b, axis), flat(c, axis)) != 0.0)
}
