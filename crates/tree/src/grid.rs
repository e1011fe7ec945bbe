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
    peak_bytes: u64,
}

/// A block of voxels: from `low` to before `high`.
#[derive(Clone, Copy, Debug)]
struct Block {
    low: [u32; 3],
    high: [u32; 3],
}

impl Block {
    const fn size(&self, axis: usize) -> u32 {
        self.high[axis] - self.low[axis]
    }

    fn is_voxel(&self) -> bool {
        (0..3).all(|axis| self.size(axis) == 1)
    }
}

/// What there is while a grid is built.
struct Building<C> {
    /// Occupied voxels with their contents.
    found: Vec<(usize, C)>,
    /// Of contents, those of blocks on the way too.
    bytes: u64,
    peak: u64,
    room: u64,
}

impl<C> Building<C> {
    /// What is kept beside contents, and what allocating them costs.
    const BESIDE: u64 = size_of::<(usize, C)>() as u64 + 64;

    /// Takes so many bytes, if there is room.
    fn take(&mut self, bytes: u64) -> bool {
        self.bytes += bytes;
        self.peak = self.peak.max(self.bytes);
        self.bytes <= self.room
    }
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

    /// Divides `bounds`, which must have a positive size on every axis, into voxels: so many on each
    /// axis, or half as many again and again until nodes and contents take no more than
    /// `memory_limit` bytes or one voxel is left. Returns the contents of the occupied ones, in the
    /// order of their indices.
    pub fn build<S: Subdivide>(
        bounds: Aabb,
        content: S::Content,
        subdivide: &S,
        resolution: [u32; 3],
        memory_limit: u64,
    ) -> (Self, Vec<S::Content>) {
        let mut resolution = resolution.map(|n| n.max(1));

        let mut peak_bytes = 0;
        loop {
            let voxels: u64 = resolution.into_iter().map(u64::from).product();
            let room = memory_limit.saturating_sub(voxels * size_of::<u32>() as u64);
            if voxels > 1 && room == 0 {
                resolution = resolution.map(|n| n.div_ceil(2));
                continue;
            }
            let mut grid = Self {
                bounds,
                resolution,
                nodes: vec![Node::Empty(0).encode(); voxels as usize],
                occupied: 0,
                peak_bytes: 0,
            };
            let mut building = Building {
                found: Vec::new(),
                bytes: 0,
                peak: 0,
                room,
            };
            let whole = Block {
                low: [0; 3],
                high: resolution,
            };
            if voxels == 1 {
                building.take(subdivide.bytes(&content));
            }
            let done = voxels == 1 || grid.divide(whole, &content, subdivide, &mut building);
            peak_bytes = peak_bytes.max(grid.bytes() + building.peak);
            if !done {
                resolution = resolution.map(|n| n.div_ceil(2));
                continue;
            }
            if voxels == 1 {
                match subdivide.describe(&content) {
                    Cell::Empty(state) => grid.nodes[0] = Node::Empty(state).encode(),
                    Cell::Occupied { .. } => building.found.push((0, content)),
                }
            }
            let mut found = building.found;
            found.sort_by_key(|(voxel, _)| *voxel);
            grid.occupied = found.len() as u64;
            grid.peak_bytes = peak_bytes;
            let contents = found
                .into_iter()
                .enumerate()
                .map(|(leaf, (voxel, content))| {
                    grid.nodes[voxel] = Node::Occupied(leaf as u32).encode();
                    content
                })
                .collect();
            return (grid, contents);
        }
    }

    /// Halves a block of several voxels until each half is a voxel or empty, so that every voxel looks
    /// only at what its surroundings hold. Returns whether there was room.
    fn divide<S: Subdivide>(
        &mut self,
        block: Block,
        content: &S::Content,
        subdivide: &S,
        building: &mut Building<S::Content>,
    ) -> bool {
        if let Cell::Empty(state) = subdivide.describe(content) {
            for k in block.low[2]..block.high[2] {
                for j in block.low[1]..block.high[1] {
                    let row = self.voxel([block.low[0], j, k]);
                    let size = block.size(0) as usize;
                    self.nodes[row..row + size].fill(Node::Empty(state).encode());
                }
            }
            return true;
        }
        let axis = (0..3).max_by_key(|&axis| block.size(axis)).unwrap_or(0);
        let middle = block.low[axis] + block.size(axis) / 2;
        let (mut lower, mut upper) = (block, block);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        for half in [lower, upper] {
            let cell = self.block_bounds(half).inflated(self.content_margin());
            let part = subdivide.restrict(content, &cell);
            let bytes = subdivide.bytes(&part) + Building::<S::Content>::BESIDE;
            if !building.take(bytes) {
                return false;
            }
            let is_occupied = matches!(subdivide.describe(&part), Cell::Occupied { .. });
            if is_occupied && half.is_voxel() {
                building.found.push((self.voxel(half.low), part));
                continue;
            }
            if !self.divide(half, &part, subdivide, building) {
                return false;
            }
            building.bytes -= bytes;
        }
        true
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

    /// The most bytes that nodes and contents took while the grid was built.
    #[must_use]
    pub const fn peak_bytes(&self) -> u64 {
        self.peak_bytes
    }

    /// Visits all voxels with their indices and boxes; x runs fastest.
    pub fn visit_voxels(&self, mut visit: impl FnMut([u32; 3], Aabb, Node)) {
        let [ni, nj, nk] = self.resolution;
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..ni {
                    let low = [i, j, k];
                    let high = low.map(|n| n + 1);
                    let node = Node::decode(self.nodes[self.voxel(low)]);
                    visit(low, self.block_bounds(Block { low, high }), node);
                }
            }
        }
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
        // Where the line leaves the voxel on each axis. Computed from the face, not summed up. A line that
        // runs beside the grid, inside its margin, is in there until it leaves the margin.
        let exit = |axis: usize, index: u32| {
            let face = match (d[axis] > 0.0, index) {
                (true, i) if i + 1 == self.resolution[axis] => self.bounds.max[axis] + margin,
                (true, i) => self.face(axis, i + 1),
                (false, 0) => self.bounds.min[axis] - margin,
                (false, i) => self.face(axis, i),
            };
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
