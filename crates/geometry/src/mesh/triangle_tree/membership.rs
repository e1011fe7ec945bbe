//! Which triangles touch a cell (Martinka, *Using an octree to accelerate ray tracing*, 1993,
//! section 6).

use std::sync::atomic::{AtomicU64, Ordering};

use octray_math::{Aabb, DVec3};
use octray_tree::triangle_cube::triangle_meets_cube;
use octray_tree::{Cell, Subdivide, filled_share};

use super::occupied::bounds_within;
use crate::Membership;

/// What decided which triangles touch which cells, and how many do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TriangleMarks {
    /// Questions asked while cells were divided: does this triangle touch this cell?
    pub questions: u64,
    /// How many of them each step of the four-step test decided, in the order of
    /// [`octray_tree::triangle_cube::Step`]. All 0 where boxes or spheres decide.
    pub steps: [u64; 4],
    /// Triangles in the lists of the finished cells: one counts as often as it is listed.
    pub references: u64,
    /// The length of the longest list.
    pub most: u64,
}

/// The contents of cells: the triangles that touch them, increasing.
pub(super) struct Touching<'a> {
    pub(super) positions: &'a [DVec3],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) membership: Membership,
    /// Questions, then those that each step decided. Sums do not depend on the order of threads.
    counts: [AtomicU64; 5],
}

/// Work of a triangle in one of its cells, in units of one plane intersected with a line; a ray tests
/// it only in the first that it meets. Measured over a smooth mesh of 70,000 triangles: with 1 the tree has
/// four times the cells and takes twice as long to build, and rays are no faster.
const TRIANGLE_COST: f64 = 0.3;
/// A triangle is covered by the boxes of `4^2` parts.
const COVER_LEVELS: u32 = 2;

impl<'a> Touching<'a> {
    pub(super) fn new(
        positions: &'a [DVec3],
        triangles: &'a [[u32; 3]],
        membership: Membership,
    ) -> Self {
        Self {
            positions,
            triangles,
            membership,
            counts: Default::default(),
        }
    }

    /// What has been asked so far.
    pub(super) fn marks(&self) -> TriangleMarks {
        let count = |index: usize| self.counts[index].load(Ordering::Relaxed);
        TriangleMarks {
            questions: count(0),
            steps: std::array::from_fn(|step| count(step + 1)),
            ..TriangleMarks::default()
        }
    }

    fn touches(&self, triangle: u32, cell: &Aabb, steps: &mut [u64; 4]) -> bool {
        let corners = self.triangles[triangle as usize].map(|i| self.positions[i as usize]);
        match self.membership {
            // Triangles are their own triangulation.
            Membership::Analytic | Membership::Shells => {
                let verdict = triangle_meets_cube(&corners, cell);
                steps[verdict.step as usize] += 1;
                verdict.meets
            }
            Membership::BoundingBox => Aabb::from_points(corners).overlaps(cell),
            Membership::BoundingSphere => sphere_touches(corners, cell),
            Membership::BoundingCover => cover_touches(corners, cell, COVER_LEVELS),
        }
    }
}

/// Whether the sphere about the middle of the longest edge touches the cell: the smallest that
/// holds the triangle if that is not acute.
fn sphere_touches([a, b, c]: [DVec3; 3], cell: &Aabb) -> bool {
    let length = |(p, q): (DVec3, DVec3)| p.distance_squared(q);
    let (mut longest, mut other) = ((a, b), c);
    for (edge, opposite) in [((b, c), a), ((c, a), b)] {
        if length(edge) > length(longest) {
            (longest, other) = (edge, opposite);
        }
    }
    let center = longest.0 * 0.5 + longest.1 * 0.5;
    let radius = (0.25 * length(longest)).max(center.distance_squared(other));
    center.distance_squared(center.clamp(cell.min, cell.max)) <= radius
}

/// Whether one of the boxes around the parts of the triangle overlaps the cell, each part a quarter
/// of the one before.
fn cover_touches([a, b, c]: [DVec3; 3], cell: &Aabb, levels: u32) -> bool {
    if !Aabb::from_points([a, b, c]).overlaps(cell) {
        return false;
    }
    if levels == 0 {
        return true;
    }
    let middle = |p: DVec3, q: DVec3| p * 0.5 + q * 0.5;
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        .into_iter()
        .any(|part| cover_touches(part, cell, levels - 1))
}

impl Subdivide for Touching<'_> {
    type Content = Vec<u32>;

    fn restrict(&self, parent: &Vec<u32>, cell: &Aabb) -> Vec<u32> {
        let mut steps = [0; 4];
        let touching = parent
            .iter()
            .copied()
            .filter(|&triangle| self.touches(triangle, cell, &mut steps))
            .collect();
        let asked = std::iter::once(parent.len() as u64).chain(steps);
        for (count, more) in self.counts.iter().zip(asked) {
            count.fetch_add(more, Ordering::Relaxed);
        }
        touching
    }

    fn describe(&self, content: &Vec<u32>) -> Cell {
        if content.is_empty() {
            return Cell::Empty(0);
        }
        Cell::Occupied {
            cost: TRIANGLE_COST * content.len() as f64,
            parts: content.len() as u32,
        }
    }

    fn share(&self, content: &Vec<u32>, cell: &Aabb) -> f64 {
        let corners = |&t: &u32| self.triangles[t as usize].map(|i| self.positions[i as usize]);
        let within = |triangle: &u32| bounds_within(corners(triangle), cell);
        filled_share(cell, content.iter().map(within))
    }

    fn bytes(&self, content: &Vec<u32>) -> u64 {
        match content.len() {
            0 => 0,
            n => (size_of::<usize>() + n * size_of::<u32>()) as u64,
        }
    }
}
