//! The 3DDDA over Basic Traversal Units, the cubes of an octree's deepest level: from one leaf to the
//! next by integer steps.

use octray_math::{Aabb, CellKey, DVec3, Interval, Ray};

use crate::CellTree;

/// A line on its way through the cube.
///
/// A step never floors a point on the axis on which it leaves a cell, and never goes back on
/// another: rounding cannot make the walk stop, skip a cell by more than rounding, or go round.
#[derive(Clone, Debug)]
pub(super) struct Stepper<'a> {
    root: &'a Aabb,
    ray: Ray,
    /// Depth of the units.
    depth: u32,
    /// The unit one is in.
    index: [u32; 3],
    /// The part of the line that counts, inside the cube grown by the margin.
    span: Interval,
    margin: f64,
}

impl<'a> Stepper<'a> {
    /// At the first unit in `within`; `None` if the line misses the cube.
    pub(super) fn new(root: &'a Aabb, depth: u32, ray: &Ray, within: Interval) -> Option<Self> {
        let margin = root.size().x * (0.5 * CellTree::CONTENT_MARGIN);
        let span = root.inflated(margin).clip(ray).intersection(&within);
        if span.is_empty() {
            return None;
        }
        let start = ray.at(span.start).clamp(root.min, root.max);
        let unit = CellKey::containing(root, depth, start)?;
        Some(Self {
            root,
            ray: *ray,
            depth,
            index: unit.index,
            span,
            margin,
        })
    }

    /// The unit one is in.
    pub(super) const fn unit(&self) -> CellKey {
        CellKey {
            depth: self.depth,
            index: self.index,
        }
    }

    /// The part of the line in a cell that holds the unit, grown by the margin.
    pub(super) fn part(&self, cell: CellKey) -> Interval {
        let grown = cell.bounds(self.root).inflated(self.margin);
        grown.clip(&self.ray).intersection(&self.span)
    }

    /// Leaves a cell that holds the unit for the next unit, and returns the axis on which it does;
    /// `None` where the line leaves the cube or gets past `limit`.
    pub(super) fn leave(&mut self, cell: CellKey, limit: f64) -> Option<usize> {
        let bounds = cell.bounds(self.root);
        let d = self.ray.direction;
        let last_cell = (1_u32 << cell.depth) - 1;
        let exit = |axis: usize| {
            // A line may run beside the cube, inside its margin, and away from it: it is in there until
            // it leaves the margin.
            let face = if d[axis] > 0.0 {
                let is_last = cell.index[axis] == last_cell;
                bounds.max[axis] + if is_last { self.margin } else { 0.0 }
            } else {
                let is_first = cell.index[axis] == 0;
                bounds.min[axis] - if is_first { self.margin } else { 0.0 }
            };
            let s = (face - self.ray.origin[axis]) / d[axis];
            // Parallel, or so nearly that the face is out of reach.
            if s.is_nan() { f64::INFINITY } else { s }
        };
        let (axis, s) = (0..3)
            .filter(|&axis| d[axis] != 0.0)
            .map(|axis| (axis, exit(axis)))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        if s > limit.min(self.span.end) {
            return None;
        }
        let below = self.depth - cell.depth;
        let units = 1_u32 << self.depth;
        let size = self.root.size().x / f64::from(units);
        let point = self.ray.at(s) - self.root.min;
        for other in 0..3 {
            let first = cell.index[other] << below;
            let last = first + ((1_u32 << below) - 1);
            if other == axis {
                let next = if d[axis] > 0.0 {
                    last.checked_add(1).filter(|i| *i < units)
                } else {
                    first.checked_sub(1)
                };
                self.index[axis] = next?;
            } else if d[other] != 0.0 {
                let here =
                    libm::floor(point[other] / size).clamp(f64::from(first), f64::from(last));
                let here = here as u32;
                self.index[other] = if d[other] > 0.0 {
                    here.max(self.index[other])
                } else {
                    here.min(self.index[other])
                };
            }
        }
        Some(axis)
    }

    /// Whether the walk is past `limit` where the line meets `part`.
    pub(super) fn is_past(part: &Interval, limit: f64) -> bool {
        part.is_empty() || part.start > limit
    }
}

/// The largest coordinate difference is finite and the cube has a size: what the walks rely on.
pub(super) fn is_walkable(root: &Aabb, ray: &Ray) -> bool {
    root.size().x > 0.0 && ray.direction != DVec3::ZERO
}
