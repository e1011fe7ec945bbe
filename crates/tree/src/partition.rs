//! A partition of space into cells, kept and walked in one of several ways: the table of what can be
//! combined.

#[cfg(test)]
mod tests;

use octray_math::{Aabb, CellKey, DVec3, Interval, Ray};

use crate::cell_tree::{
    CellTree, CellTreeStats, Criteria, Node, Subdivide, WalkStack, enclosing_cube,
};
use crate::encoding::{Lvsi, LvsiStats, LvsiStore, LvsiTable};
use crate::grid::Grid;
use crate::traversal::{BeamMemory, LeafSearch, Steps, TreePath};

/// How an octree is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Nodes that point to their children.
    #[default]
    Tree,
    /// A hash table of the leaves; see [`Lvsi`].
    Lvsi(LvsiStore),
}

impl Encoding {
    /// The deepest level that it can hold.
    #[must_use]
    pub const fn max_depth(self) -> u32 {
        match self {
            Self::Lvsi(LvsiStore::Occupied) => UNITS_DEPTH,
            _ => octray_math::MAX_DEPTH,
        }
    }
}

/// How an octree is walked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Traversal {
    /// Front to back from the root: [`CellTree::walk`].
    #[default]
    Ordered,
    /// [`CellTree::walk_neighbours`].
    FujimotoIwata,
    /// [`LeafSearch::walk_units`].
    Sung,
    /// Neighbouring rays together: [`CellTree::enter`]; a ray alone as with [`Traversal::Ordered`].
    Beam,
}

/// How space is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Division {
    /// Into cubes, adaptively.
    Octree(Encoding, Traversal),
    /// Into equal voxels: so many on each axis, or as [`Grid::resolution_for`] finds.
    Grid(Option<u32>),
}

impl Default for Division {
    fn default() -> Self {
        Self::Octree(Encoding::Tree, Traversal::Ordered)
    }
}

impl Division {
    /// Why this combination makes no sense, if it does not.
    #[must_use]
    pub const fn objection(self) -> Option<&'static str> {
        match self {
            Self::Octree(Encoding::Lvsi(_), Traversal::Ordered) => Some(
                "the ordered traversal goes from a cell to its children, and the hash table knows only leaves: use `sung` with it",
            ),
            Self::Octree(Encoding::Lvsi(_), Traversal::Beam) => Some(
                "beams go from a cell to its children, and the hash table knows only leaves: use `sung` with it",
            ),
            Self::Octree(Encoding::Lvsi(_), Traversal::FujimotoIwata) => Some(
                "the traversal of Fujimoto and Iwata goes up and down the tree, and the hash table knows only leaves: use `sung` with it",
            ),
            Self::Grid(Some(0)) => Some("a grid needs at least one voxel on an axis"),
            Self::Grid(Some(n)) if n > Grid::MAX_RESOLUTION => {
                Some("a grid may have at most 1024 voxels on an axis")
            }
            _ => None,
        }
    }
}

/// The deepest Basic Traversal Units where empty space is not stored: a line takes up to three times
/// 2^depth steps through it.
const UNITS_DEPTH: u32 = 10;

/// Cells and the way to walk them.
#[derive(Clone, Debug, PartialEq)]
pub struct Partition {
    bounds: Aabb,
    cells: Cells,
    stats: PartitionStats,
}

#[derive(Clone, Debug, PartialEq)]
enum Cells {
    Ordered(CellTree),
    Beam(CellTree),
    FujimotoIwata(CellTree),
    Sung(CellTree),
    Lvsi(Lvsi),
    Grid(Grid),
}

/// What was built.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartitionStats {
    /// Cells by kind, with the bytes of the nodes (or the hash table, or the voxels) as they are kept
    /// and of the contents. Of a grid: voxels, at depth 0.
    pub cells: CellTreeStats,
    /// The hash table, if there is one.
    pub lvsi: Option<LvsiStats>,
    /// Voxels on each axis, of a grid.
    pub resolution: Option<[u32; 3]>,
}

/// A leaf of an octree, or a voxel of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Depth and indices; of a voxel, depth 0 and its indices in the grid.
    pub key: CellKey,
    /// The cell itself, without the margin of its contents.
    pub bounds: Aabb,
    /// Empty or occupied.
    pub node: Node,
}

/// Working memory of a walk.
#[derive(Clone, Debug, Default)]
pub struct WalkMemory {
    stack: WalkStack,
    path: TreePath,
    beam: BeamMemory,
    /// Whether the lines to come are those that `beam` was made for.
    in_beam: bool,
}

impl WalkMemory {
    /// The lines to come are others than those of the run that entered last.
    pub const fn leave(&mut self) {
        self.in_beam = false;
    }
}

impl Partition {
    /// Divides the space around `bounds`; returns the contents of the occupied cells too.
    ///
    /// A grid is refined as far as `criteria` give memory. `table` says how large a hash table is,
    /// where there is one. Works inside the current thread pool; the
    /// result does not depend on it. An invalid combination ([`Division::objection`]) is built as its
    /// nearest valid one.
    pub fn build<S: Subdivide>(
        bounds: &Aabb,
        content: S::Content,
        subdivide: &S,
        division: Division,
        criteria: &Criteria,
        table: LvsiTable,
    ) -> (Self, Vec<S::Content>) {
        let mut contents = Vec::new();
        let mut keep = |content| contents.push(content);
        let how = (division, table);
        let partition = Self::build_into(bounds, content, subdivide, how, criteria, &mut keep);
        (partition, contents)
    }

    /// Like [`Partition::build`], but hands over the contents of the occupied cells one by one, in the
    /// order of their indices; an octree does so while it is built ([`CellTree::build_into`]).
    pub fn build_into<S: Subdivide>(
        bounds: &Aabb,
        content: S::Content,
        subdivide: &S,
        (division, table): (Division, LvsiTable),
        criteria: &Criteria,
        leaf: &mut impl FnMut(S::Content),
    ) -> Self {
        match division {
            Division::Octree(encoding, traversal) => {
                let how = (encoding, traversal, table);
                Self::octree(bounds, content, subdivide, how, criteria, leaf)
            }
            Division::Grid(resolution) => {
                let (grid, contents) = Self::grid(bounds, content, subdivide, resolution, criteria);
                contents.into_iter().for_each(leaf);
                grid
            }
        }
    }

    fn octree<S: Subdivide>(
        bounds: &Aabb,
        content: S::Content,
        subdivide: &S,
        (encoding, traversal, size): (Encoding, Traversal, LvsiTable),
        criteria: &Criteria,
        leaf: &mut impl FnMut(S::Content),
    ) -> Self {
        let mut criteria = *criteria;
        criteria.max_depth = criteria.max_depth.min(encoding.max_depth());
        let cube = enclosing_cube(bounds);
        let tree = CellTree::build_into(cube, content, subdivide, &criteria, leaf);
        let mut stats = PartitionStats {
            cells: tree.stats().clone(),
            ..PartitionStats::default()
        };
        let bounds = *tree.root();
        let cells = match (encoding, traversal) {
            (Encoding::Tree, Traversal::Ordered) => Cells::Ordered(tree),
            (Encoding::Tree, Traversal::Beam) => Cells::Beam(tree),
            (Encoding::Tree, Traversal::FujimotoIwata) => Cells::FujimotoIwata(tree),
            (Encoding::Tree, Traversal::Sung) => Cells::Sung(tree),
            (Encoding::Lvsi(store), _) => {
                let table = Lvsi::new(&tree, store, size);
                let lvsi = table.stats();
                stats.cells.bytes = stats.cells.bytes - tree.node_bytes() + lvsi.bytes;
                stats.cells.node_bytes = lvsi.bytes;
                // Tree and table are there together for a while.
                let both = stats.cells.bytes + tree.node_bytes();
                stats.cells.peak_bytes = stats.cells.peak_bytes.max(both);
                stats.lvsi = Some(lvsi);
                Cells::Lvsi(table)
            }
        };
        Self {
            bounds,
            cells,
            stats,
        }
    }

    fn grid<S: Subdivide>(
        bounds: &Aabb,
        content: S::Content,
        subdivide: &S,
        resolution: Option<u32>,
        criteria: &Criteria,
    ) -> (Self, Vec<S::Content>) {
        let parts = match subdivide.describe(&content) {
            crate::Cell::Empty(_) => 0,
            crate::Cell::Occupied { parts, .. } => u64::from(parts),
        };
        // Room on every side, so that flat things have a box and nothing lies in its faces.
        let size = bounds.size().max_element();
        let bounds = bounds.inflated(if size > 0.0 { size / 1024.0 } else { 1.0 });
        // Most of the memory is for the contents.
        let limit = (criteria.memory_limit / 64).clamp(1, 1 << 30);
        let resolution = match resolution {
            Some(n) => [n.clamp(1, Grid::MAX_RESOLUTION); 3],
            None => Grid::resolution_for(&bounds, parts, limit),
        };
        let (grid, contents) = Grid::build(
            bounds,
            content,
            subdivide,
            resolution,
            criteria.memory_limit,
        );
        let mut stats = PartitionStats {
            cells: CellTreeStats {
                bytes: grid.bytes(),
                node_bytes: grid.bytes(),
                peak_bytes: grid.peak_bytes(),
                stopped_by_memory: grid.resolution() != resolution,
                ..CellTreeStats::default()
            },
            resolution: Some(grid.resolution()),
            ..PartitionStats::default()
        };
        for content in &contents {
            stats.cells.bytes += subdivide.bytes(content);
            if let crate::Cell::Occupied { parts, .. } = subdivide.describe(content) {
                stats.cells.count_leaf(0, Some(parts));
            }
        }
        let voxels: u64 = grid.resolution().into_iter().map(u64::from).product();
        stats.cells.empty = voxels - grid.occupied();
        stats.cells.empty_by_depth = vec![stats.cells.empty];
        let partition = Self {
            bounds,
            cells: Cells::Grid(grid),
            stats,
        };
        (partition, contents)
    }

    /// The box that is divided.
    #[must_use]
    pub const fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// What was built.
    #[must_use]
    pub const fn stats(&self) -> &PartitionStats {
        &self.stats
    }

    /// The structure as it lies in memory, for hashing and comparing.
    pub fn words(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        match &self.cells {
            Cells::Ordered(tree)
            | Cells::Beam(tree)
            | Cells::FujimotoIwata(tree)
            | Cells::Sung(tree) => Box::new(tree.words()),
            Cells::Lvsi(table) => Box::new(table.words()),
            Cells::Grid(grid) => Box::new(grid.words()),
        }
    }

    fn leaf(&self, key: CellKey, node: Node) -> Leaf {
        let bounds = key.bounds(&self.bounds);
        Leaf { key, bounds, node }
    }

    /// Visits the leaves, or voxels: of a hash table, those it stores.
    pub fn visit_leaves(&self, mut visit: impl FnMut(Leaf)) {
        match &self.cells {
            Cells::Ordered(tree)
            | Cells::FujimotoIwata(tree)
            | Cells::Sung(tree)
            | Cells::Beam(tree) => {
                tree.visit_leaves(|key, node| visit(self.leaf(key, node)));
            }
            Cells::Lvsi(table) => table.visit_leaves(|key, node| visit(self.leaf(key, node))),
            Cells::Grid(grid) => grid.visit_voxels(|index, bounds, node| {
                let key = CellKey { depth: 0, index };
                visit(Leaf { key, bounds, node });
            }),
        }
    }

    /// What lies at a point inside the box; `None` where the structure does not say, because a hash
    /// table of occupied cells knows nothing of the others.
    #[must_use]
    pub fn locate(&self, point: DVec3) -> Option<Node> {
        match &self.cells {
            Cells::Ordered(tree)
            | Cells::Beam(tree)
            | Cells::FujimotoIwata(tree)
            | Cells::Sung(tree) => tree.locate(point).map(|(_, node)| node),
            Cells::Lvsi(table) => table.locate(&self.bounds, point),
            Cells::Grid(grid) => grid.locate(point),
        }
    }

    /// Whether neighbouring rays travel together: then [`Partition::enter`] is worth its call.
    #[must_use]
    pub const fn has_beams(&self) -> bool {
        matches!(self.cells, Cells::Beam(_))
    }

    /// Takes a run of neighbouring rays through the upper cells together, each with the part of it
    /// that counts. Until [`WalkMemory::leave`], all walks with this memory must be of these rays and
    /// within those parts. Returns what it cost all of them together; does nothing without beams.
    pub fn enter(&self, rays: &[(Ray, Interval)], memory: &mut WalkMemory) -> Steps {
        memory.in_beam = false;
        let Cells::Beam(tree) = &self.cells else {
            return Steps::default();
        };
        let entered = tree.enter(rays, &mut memory.beam);
        memory.in_beam = entered.is_some();
        Steps {
            cells: entered.unwrap_or(0),
            lookups: 0,
        }
    }

    /// Visits the occupied cells that the line meets in `within`, front to back.
    ///
    /// `visit` gets the index of the contents and the part of the line inside the cell (grown by
    /// half of [`CellTree::CONTENT_MARGIN`]); it returns the parameter beyond which nothing
    /// matters any more.
    pub fn walk(
        &self,
        ray: &Ray,
        within: Interval,
        memory: &mut WalkMemory,
        visit: impl FnMut(u32, Interval) -> f64,
    ) -> Steps {
        match &self.cells {
            Cells::Ordered(tree) => Steps {
                cells: tree.walk(ray, within, &mut memory.stack, visit),
                lookups: 0,
            },
            Cells::Beam(tree) if memory.in_beam => Steps {
                cells: tree.walk_from(&memory.beam, ray, within, &mut memory.stack, visit),
                lookups: 0,
            },
            Cells::Beam(tree) => Steps {
                cells: tree.walk(ray, within, &mut memory.stack, visit),
                lookups: 0,
            },
            Cells::FujimotoIwata(tree) => {
                tree.walk_neighbours(ray, within, &mut memory.path, visit)
            }
            Cells::Sung(tree) => tree.walk_units(&self.bounds, ray, within, visit),
            Cells::Lvsi(table) => table.walk_units(&self.bounds, ray, within, visit),
            Cells::Grid(grid) => grid.walk(ray, within, visit),
        }
    }
}
