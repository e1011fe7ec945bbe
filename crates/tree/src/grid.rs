//! The uniform grid: `i x j x k` equal voxels, walked by the 3DDDA (Fujimoto and Iwata 1985; Amanatides
//! and Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, 1987).

use octray_math::{Aabb, DVec3, Interval, Ray};

use crate::CellTree;
use crate::cell_tree::{Cell, Node, Subdivide};
use crate::traversal::Steps;

/// Voxels with their nodes; what occupied ones hold is kept beside it by whoever built it.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    bounds: Aabb,
    resolution: [u32; 3],
    /// x runs fastest.
    nodes: Vec<u32>,
    occupied: u64,
}

/// A block of voxels: from `low` to before `high`.
#[derive(Clone, Copy, Debug)]
struct Block {
    low: [u32; 3],
    high: [u32; 3],
}

impl Grid {
    /// The most voxels on one axis that one may ask for.
    pub const MAX_RESOLUTION: u32 = 1024;

    /// Voxels per axis for a number of things in a box: as many voxels as things, twice over, as near
    /// to cubes as they come, at most `limit` of them and at most 2048 on an axis.
    #[must_use]
    pub fn resolution_for(bounds: &Aabb, things: u64, limit: u64) -> [u32; 3] {
        let size = bounds.size();
        let longest = size.max_element();
        if longest <= 0.0 {
            return [1; 3];
        }
        let wanted = (2 * things).clamp(1, limit.max(1)) as f64;
        // A flat box has no volume: its thin sides count as one voxel.
        let shape = (size / longest).max(DVec3::splat(1e-3));
        let per_longest = libm::cbrt(wanted / (shape.x * shape.y * shape.z));
        let axis = |x: f64| libm::floor(per_longest * x).clamp(1.0, 2048.0) as u32;
        let [mut i, mut j, mut k] = [axis(shape.x), axis(shape.y), axis(shape.z)];
        while u64::from(i) * u64::from(j) * u64::from(k) > limit.max(1) {
            let most = i.max(j).max(k);
            for n in [&mut i, &mut j, &mut k] {
                if *n == most {
                    *n = (*n - n.div_ceil(16)).max(1);
                }
            }
        }
        [i, j, k]
    }

    /// Divides `bounds`, which must have a positive size on every axis, into voxels. Returns the
    /// contents of the occupied ones, in the order of their indices.
    pub fn build<S: Subdivide>(
        bounds: Aabb,
        content: S::Content,
        subdivide: &S,
        resolution: [u32; 3],
    ) -> (Self, Vec<S::Content>) {
        let resolution = resolution.map(|n| n.max(1));
        let [i, j, k] = resolution.map(|n| n as usize);
        let mut grid = Self {
            bounds,
            resolution,
            nodes: vec![Node::Empty(0).encode(); i * j * k],
            occupied: 0,
        };
        let mut found: Vec<(usize, S::Content)> = Vec::new();
        let whole = Block {
            low: [0; 3],
            high: resolution,
        };
        grid.divide(whole, content, subdivide, &mut found);
        found.sort_by_key(|(voxel, _)| *voxel);
        grid.occupied = found.len() as u64;
        let contents = found
            .into_iter()
            .enumerate()
            .map(|(leaf, (voxel, content))| {
                grid.nodes[voxel] = Node::Occupied(leaf as u32).encode();
                content
            })
            .collect();
        (grid, contents)
    }

    /// Halves a block until it is a voxel or empty, so that every voxel looks only at what its
    /// surroundings hold.
    fn divide<S: Subdivide>(
        &mut self,
        block: Block,
        content: S::Content,
        subdivide: &S,
        found: &mut Vec<(usize, S::Content)>,
    ) {
        let size = |axis: usize| block.high[axis] - block.low[axis];
        if let Cell::Empty(state) = subdivide.describe(&content) {
            for k in block.low[2]..block.high[2] {
                for j in block.low[1]..block.high[1] {
                    let row = self.voxel([block.low[0], j, k]);
                    self.nodes[row..row + size(0) as usize].fill(Node::Empty(state).encode());
                }
            }
            return;
        }
        let axis = (0..3).max_by_key(|&axis| size(axis)).unwrap_or(0);
        if size(axis) <= 1 {
            found.push((self.voxel(block.low), content));
            return;
        }
        let middle = block.low[axis] + size(axis) / 2;
        let (mut lower, mut upper) = (block, block);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        for half in [lower, upper] {
            let cell = self.block_bounds(half).inflated(self.content_margin());
            let part = subdivide.restrict(&content, &cell);
            self.divide(half, part, subdivide, found);
        }
    }

    /// How much larger than itself a voxel is when its contents are decided.
    fn content_margin(&self) -> f64 {
        self.bounds.size().max_element() * CellTree::CONTENT_MARGIN
    }

    fn voxel(&self, [i, j, k]: [u32; 3]) -> usize {
        let [ni, nj, _] = self.resolution.map(|n| n as usize);
        i as usize + ni * (j as usize + nj * k as usize)
    }

    /// The face before voxel `index`.
    fn face(&self, axis: usize, index: u32) -> f64 {
        if index == self.resolution[axis] {
            return self.bounds.max[axis];
        }
        let share = f64::from(index) / f64::from(self.resolution[axis]);
        self.bounds.min[axis] + (self.bounds.max[axis] - self.bounds.min[axis]) * share
    }

    fn block_bounds(&self, block: Block) -> Aabb {
        let corner = |index: [u32; 3]| {
            DVec3::new(
                self.face(0, index[0]),
                self.face(1, index[1]),
                self.face(2, index[2]),
            )
        };
        Aabb::new(corner(block.low), corner(block.high))
    }

    /// The voxel that holds a point of the box.
    fn containing(&self, point: DVec3) -> [u32; 3] {
        std::array::from_fn(|axis| {
            let n = self.resolution[axis];
            let size = self.bounds.max[axis] - self.bounds.min[axis];
            let share = (point[axis] - self.bounds.min[axis]) / size;
            let mut index = libm::floor(share * f64::from(n)).clamp(0.0, f64::from(n - 1)) as u32;
            // The quotient may have rounded across a face.
            while index > 0 && point[axis] < self.face(axis, index) {
                index -= 1;
            }
            while index + 1 < n && point[axis] >= self.face(axis, index + 1) {
                index += 1;
            }
            index
        })
    }

    /// The box that is divided.
    #[must_use]
    pub const fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Voxels per axis.
    #[must_use]
    pub const fn resolution(&self) -> [u32; 3] {
        self.resolution
    }

    /// How many voxels have contents.
    #[must_use]
    pub const fn occupied(&self) -> u64 {
        self.occupied
    }

    /// Bytes of the nodes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        size_of_val(self.nodes.as_slice()) as u64
    }

    /// The node of the voxel that holds `point`, `None` outside the box.
    #[must_use]
    pub fn locate(&self, point: DVec3) -> Option<Node> {
        let inside = self.bounds.contains(point);
        inside.then(|| Node::decode(self.nodes[self.voxel(self.containing(point))]))
    }

    /// The nodes as they lie in memory.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        self.resolution
            .into_iter()
            .chain(self.nodes.iter().copied())
    }

    /// Visits the occupied voxels that the line meets in `within`, front to back, as
    /// [`CellTree::walk`] does.
    pub fn walk(
        &self,
        ray: &Ray,
        within: Interval,
        mut visit: impl FnMut(u32, Interval) -> f64,
    ) -> Steps {
        let mut steps = Steps::default();
        let margin = 0.5 * self.content_margin();
        let span = self.bounds.inflated(margin).clip(ray).intersection(&within);
        if span.is_empty() {
            return steps;
        }
        let d = ray.direction;
        let start = ray.at(span.start).clamp(self.bounds.min, self.bounds.max);
        let mut index = self.containing(start);
        // Where the line leaves the voxel on each axis. Computed from the face, not summed up.
        let exit = |axis: usize, index: u32| {
            let face = self.face(axis, index + u32::from(d[axis] > 0.0));
            let s = (face - ray.origin[axis]) / d[axis];
            if d[axis] == 0.0 || s.is_nan() {
                f64::INFINITY
            } else {
                s
            }
        };
        let mut exits: [f64; 3] = std::array::from_fn(|axis| exit(axis, index[axis]));
        let mut limit = within.end;
        loop {
            steps.cells += 1;
            if let Node::Occupied(leaf) = Node::decode(self.nodes[self.voxel(index)]) {
                let high = index.map(|i| i + 1);
                let grown = self
                    .block_bounds(Block { low: index, high })
                    .inflated(margin);
                let part = grown.clip(ray).intersection(&span);
                if !part.is_empty() && part.start <= limit {
                    limit = limit.min(visit(leaf, part));
                }
            }
            let axis = (0..3)
                .min_by(|&a, &b| exits[a].total_cmp(&exits[b]))
                .unwrap_or(0);
            if exits[axis] > limit.min(span.end) {
                return steps;
            }
            let next = if d[axis] > 0.0 {
                Some(index[axis] + 1).filter(|i| *i < self.resolution[axis])
            } else {
                index[axis].checked_sub(1)
            };
            let Some(next) = next else { return steps };
            index[axis] = next;
            exits[axis] = exit(axis, next);
        }
    }
}
