//! Cells of space with lists of triangles: the grid and the octrees of the papers.
//!
//! Why no crossing is lost. Let `size` be that of the divided box. The point at the `t` of a hit is,
//! but for rounding, a point of the triangle itself, however thin: `t` interpolates the depths of
//! the corners with weights that are right to 2^-45 for the corners as the ray sees them. Rounded are
//! the corners relative to the ray's origin, that point, and the faces of cells where the line is
//! clipped to them; each by a few units in the last place of a distance to the ray's origin, or of a
//! coordinate. Both are held below `REACH * size` (farther rays try every triangle, and the box is
//! made large enough for its place), so together they stay below `2^-27 size`. Contents are decided
//! for cells grown by `2^-20 size` ([`CellTree::CONTENT_MARGIN`]), and lines are clipped to cells
//! grown by half of that: a cell that the walk enters where the line passes the point at `t` lists
//! the triangle, and its part of the line holds `t`. So
//!
//! * a flat mesh in a face between cells, even in the root's middle, is listed on both sides;
//! * a hit at an end of the span is found: clipping is closed, and the cell that holds the end is
//!   walked;
//! * of triangles that share the edge a ray goes through every one is shown: the walk ends before
//!   cells that begin beyond the best `t`, never at it, and which of equals wins is the visitor's to
//!   say;
//! * triangles without area are listed like others, and never hit.
//!
//! [`CellTree::CONTENT_MARGIN`]: octray_tree::CellTree::CONTENT_MARGIN

use octray_math::{Aabb, DVec3, Interval, Ray};
use octray_tree::traversal::Steps;
use octray_tree::{Criteria, Division, LvsiTable, Partition};

use super::membership::{Touching, TriangleMarks};
use super::search::{SearchCost, SearchMemory};
use crate::Membership;

/// The cells and their lists.
#[derive(Clone, Debug)]
pub(super) struct TriangleCells {
    partition: Partition,
    /// The list of cell `i` is `items[starts[i]..starts[i + 1]]`.
    starts: Vec<usize>,
    items: Vec<u32>,
    triangles: usize,
    marks: TriangleMarks,
}

/// Coordinates of the box and of ray origins may be this many times as large as the box.
const REACH: f64 = (1u64 << 22) as f64;
/// Products of three lengths between these bounds suffer no harm from under- or overflow.
const TAME: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

impl TriangleCells {
    /// `None` where coordinates are so extreme that cells would lose crossings: every triangle must
    /// be tried.
    pub(super) fn build(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        (division, table): (Division, LvsiTable),
        membership: Membership,
        criteria: &Criteria,
    ) -> Option<Self> {
        let corners = triangles.iter().flatten().map(|&i| positions[i as usize]);
        let bounds = Aabb::from_points(corners);
        if bounds.is_empty() {
            return None;
        }
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        if farthest > *TAME.end() {
            return None;
        }
        let least = (farthest / REACH).max(*TAME.start());
        let bounds = if bounds.size().max_element() < least {
            bounds.inflated(least)
        } else {
            bounds
        };
        let touching = Touching::new(positions, triangles, membership);
        let all = (0..triangles.len() as u32).collect();
        let (partition, contents) =
            Partition::build(&bounds, all, &touching, division, criteria, table);
        let mut starts = Vec::with_capacity(contents.len() + 1);
        let mut items = Vec::with_capacity(contents.iter().map(Vec::len).sum());
        let mut marks = touching.marks();
        starts.push(0);
        for content in contents {
            marks.most = marks.most.max(content.len() as u64);
            items.extend(content);
            starts.push(items.len());
        }
        marks.references = items.len() as u64;
        Some(Self {
            partition,
            starts,
            items,
            triangles: triangles.len(),
            marks,
        })
    }

    pub(super) const fn partition(&self) -> &Partition {
        &self.partition
    }

    /// The triangles that touch an occupied cell, increasing.
    pub(super) fn listed(&self, leaf: u32) -> &[u32] {
        let leaf = leaf as usize;
        &self.items[self.starts[leaf]..self.starts[leaf + 1]]
    }

    /// Bytes of the cells and of their lists.
    pub(super) fn bytes(&self) -> u64 {
        let lists = size_of_val(self.starts.as_slice()) + size_of_val(self.items.as_slice());
        self.partition.stats().cells.node_bytes + lists as u64
    }

    pub(super) const fn marks(&self) -> &TriangleMarks {
        &self.marks
    }

    /// Cells and lists as they lie in memory.
    pub(super) fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let starts = self.starts.iter().map(|&start| start as u32);
        let lists = starts.chain(self.items.iter().copied());
        self.partition.words().chain(lists)
    }

    /// Whether rounding is small enough for this ray.
    pub(super) fn can_walk(&self, ray: &Ray) -> bool {
        let size = self.partition.bounds().size().max_element();
        ray.origin.abs().max_element() <= REACH * size
            && TAME.contains(&ray.direction.abs().max_element())
    }

    /// Whether neighbouring rays travel together.
    pub(super) const fn has_beams(&self) -> bool {
        self.partition.has_beams()
    }

    /// See [`Partition::enter`]. Where rounding is too large for one of the rays, each walks by
    /// itself.
    pub(super) fn enter(&self, rays: &[(Ray, Interval)], memory: &mut SearchMemory) -> Steps {
        memory.leave();
        if rays.iter().all(|(ray, _)| self.can_walk(ray)) {
            self.partition.enter(rays, &mut memory.walk)
        } else {
            Steps::default()
        }
    }

    /// Shows `test` the triangles in the cells on the line, each once; it returns the new end.
    pub(super) fn visit(
        &self,
        ray: &Ray,
        span: Interval,
        memory: &mut SearchMemory,
        cost: &mut SearchCost,
        mut test: impl FnMut(u32, f64) -> f64,
    ) {
        let SearchMemory { walk, mailbox, .. } = memory;
        mailbox.begin(self.triangles);
        let mut end = span.end;
        let steps = self.partition.walk(ray, span, walk, |leaf, _| {
            for &triangle in self.listed(leaf) {
                if !mailbox.is_new(triangle) {
                    cost.mailbox += 1;
                    continue;
                }
                cost.walk.items += 1;
                end = test(triangle, end);
                if end < span.start {
                    break;
                }
            }
            end
        });
        cost.steps.cells += steps.cells;
        cost.steps.lookups += steps.lookups;
    }
}
