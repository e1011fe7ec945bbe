//! Figures about what was built: memory by part, and the cells themselves.

use octray_geometry::membership::MarkerStats;
use octray_math::{Aabb, CellKey};
use octray_tree::{Node, Partition, Tally};

use crate::World;

/// Bytes of what a world keeps beside its scene, by part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryStats {
    /// Nodes of the trees over solids and triangles, or the hash tables, or the voxels.
    pub cells: u64,
    /// What occupied cells hold: lists of objects and surfaces, and of triangles.
    pub contents: u64,
    /// The reduced expressions of the objects in cells; equal ones are kept once.
    pub expressions: u64,
    /// Surfaces of solids, without coefficients of polynomials.
    pub surfaces: u64,
    /// Faces of solids.
    pub faces: u64,
    /// Triangles with their corners, of sheets and mesh operands.
    pub triangles: u64,
    /// Cells over triangles, with the lists of triangles in them.
    pub triangle_cells: u64,
    /// The octrees with wide nodes over triangles, and the corners that stand with them.
    pub wide_trees: u64,
    /// The octree with wide nodes over copies of prototypes; the copies' transforms are the scene's.
    pub instances: u64,
    /// The most bytes that cells and their contents took while they were built, with what building
    /// keeps beside them.
    pub building: u64,
}

impl MemoryStats {
    /// What is there after building.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.cells
            + self.contents
            + self.expressions
            + self.surfaces
            + self.faces
            + self.triangles
            + self.triangle_cells
            + self.wide_trees
            + self.instances
    }

    /// With what a prototype takes.
    fn add(&mut self, prototype: &Self) {
        self.cells += prototype.cells;
        self.contents += prototype.contents;
        self.expressions += prototype.expressions;
        self.surfaces += prototype.surfaces;
        self.faces += prototype.faces;
        self.triangles += prototype.triangles;
        self.triangle_cells += prototype.triangle_cells;
        self.wide_trees += prototype.wide_trees;
        self.building = self.building.max(prototype.building);
    }
}

/// How cells were found to touch operands, where a membership test asks about operands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkingStats {
    /// The operands, the temporary pieces of their boundaries, and what decided.
    pub marker: MarkerStats,
    /// Pairs of an occupied cell and an operand with a face in its expressions.
    pub marks: u64,
    /// Bytes of temporary pieces that were still there after the build: always 0.
    pub pieces_left: u64,
}

/// What cells were made over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellsOf {
    /// Solids, and sheets of quadric surfaces.
    Solids,
    /// Triangles of mesh sheets.
    Triangles,
}

/// A leaf of an octree, or a voxel of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldCell {
    /// Depth and indices; of a voxel, depth 0 and its indices in the grid.
    pub key: CellKey,
    /// In coordinates of the world.
    pub bounds: Aabb,
    /// How many objects it holds whose boundary may pass through; `None` if it is empty.
    pub objects: Option<u32>,
    /// How many surfaces (or triangles) that may pass through.
    pub parts: u32,
}

/// What an occupied leaf holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Held {
    pub(crate) objects: u32,
    pub(crate) parts: u32,
}

impl World {
    /// The box that is divided into cells, in coordinates of the world; `None` where the method makes
    /// no cells or there is nothing to make them over.
    #[must_use]
    pub fn root(&self, of: CellsOf) -> Option<Aabb> {
        let (partition, _) = self.partition(of)?;
        Some(self.in_world(partition.bounds()))
    }

    /// Visits the leaves, or voxels: of a hash table, those it stores. Nothing where there is no
    /// [`World::root`].
    pub fn visit_cells(&self, of: CellsOf, mut visit: impl FnMut(WorldCell)) {
        let Some((partition, held)) = self.partition(of) else {
            return;
        };
        partition.visit_leaves(|leaf| {
            let held = match leaf.node {
                Node::Occupied(index) => Some(held(index)),
                _ => None,
            };
            visit(WorldCell {
                key: leaf.key,
                bounds: self.in_world(&leaf.bounds),
                objects: held.map(|h| h.objects),
                parts: held.map_or(0, |h| h.parts),
            });
        });
    }

    /// The cells, and what the occupied ones hold.
    fn partition(&self, of: CellsOf) -> Option<(&Partition, impl Fn(u32) -> Held + '_)> {
        let triangles = self.sheets.triangles();
        let partition = match of {
            CellsOf::Solids => self.solids.partition()?,
            CellsOf::Triangles => triangles.partition()?,
        };
        Some((partition, move |leaf| match of {
            CellsOf::Solids => self.solids.held(leaf),
            CellsOf::Triangles => self.sheets.held(leaf),
        }))
    }

    fn in_world(&self, bounds: &Aabb) -> Aabb {
        let origin = self.place.frame.origin;
        Aabb::new(bounds.min + origin, bounds.max + origin)
    }

    pub(crate) fn memory(&self) -> MemoryStats {
        let mut memory = self.solids.memory();
        let triangles = self.sheets.triangles();
        memory.triangles += triangles.bytes();
        memory.triangle_cells += triangles.cell_bytes();
        memory.wide_trees += triangles.tree_stats().map_or(0, |stats| stats.bytes);
        memory.wide_trees += triangles.packed_bytes();
        if let Some(cells) = triangles.partition().map(|cells| &cells.stats().cells) {
            memory.building = memory.building.max(cells.peak_bytes);
        }
        memory.instances = self.instances.tree().map_or(0, |tree| tree.stats().bytes);
        for prototype in self.instances.prototypes() {
            memory.add(&prototype.memory());
        }
        memory
    }

    /// How many objects the occupied cells hold.
    pub(crate) fn objects_per_leaf(&self, of: CellsOf) -> Tally {
        let mut tally = Tally::default();
        if let Some((cells, held)) = self.partition(of) {
            let leaves = cells.stats().cells.occupied;
            tally.extend((0..leaves as u32).map(|leaf| u64::from(held(leaf).objects)));
        }
        tally
    }
}
