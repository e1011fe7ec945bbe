//! The solids of a world: faces, surfaces, the octree over them, and sweeps along lines.

mod candidates;
mod cells;
mod divide;
mod flat_object;
mod interact;
mod leaf;
mod listed_cells;
mod numbering;
mod object_tree;
mod operand_boxes;
mod operand_cells;
mod prepare;
mod region;
mod roots;
mod spans;
mod sweep;
mod volumes;

use octray_geometry::csg::Face;
use octray_geometry::mesh::{MeshSolid, TriangleTree};
use octray_geometry::surface::Surface;
use octray_math::{Aabb, Interval, Ray};
use octray_scene::ObjectId;
use octray_tree::{CellTree, Node, Partition};

pub(crate) use candidates::slack;
use leaf::LeafView;
pub(crate) use leaf::Leaves;
use object_tree::ObjectTree;
pub(crate) use roots::Scratch;
use volumes::Volumes;

pub(crate) use sweep::{Change, Interface, Passage};

use crate::figures::Held;
use crate::line::Line;
use crate::{Counters, MarkingStats, MemoryStats, Region};

/// An object made of faces. Their order is the rank by which regions are decided: higher priority
/// first, then the smaller object, then the later one.
#[derive(Debug)]
pub(crate) struct Ranked {
    pub(crate) object: ObjectId,
    priority: i32,
    /// Whether it is a sheet: its boundary counts, its inside does not.
    shell: bool,
}

/// A closed mesh as an operand.
#[derive(Debug)]
struct MeshSurface {
    solid: MeshSolid,
    /// The literal that stands for it in the expression.
    literal: u32,
    /// The identity of its first triangle.
    first_face: u32,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Solids {
    faces: Vec<Face>,
    /// For each face the index into `ranked` of the object it belongs to.
    face_owner: Vec<u32>,
    /// Surfaces of one formula; those of meshes are numbered after them.
    surfaces: Vec<Surface>,
    meshes: Vec<MeshSurface>,
    ranked: Vec<Ranked>,
    priorities_differ: bool,
    leaves: Leaves,
    /// The cells over the bounded objects; `None` for flat methods and without any.
    cells: Option<Partition>,
    /// Where all objects are small and the method leaves it open.
    objects: Option<ObjectTree>,
    /// What is tested before an object, by flat methods.
    volumes: Option<Volumes>,
    /// The leaf for what lies outside the cells: the unbounded objects, or everything.
    outer: Option<u32>,
    /// The leaf that holds everything, where the cells do not know what empty space is.
    whole: Option<u32>,
    /// The ranks of the solids that hold every point: leaves know only the first of them.
    everywhere: Vec<u32>,
    /// Whether any object has no end.
    has_unbounded: bool,
    merged_surfaces: usize,
    /// A box around the bounded objects and what rounding moves.
    bounds: Aabb,
    /// For each object of the scene its size; empty where there are no copies to compare it with.
    sizes: Vec<f64>,
    /// Where operands were marked.
    marking: Option<MarkingStats>,
}

/// A leaf on a line.
struct LeafVisit<'a> {
    /// Its index among the leaves of the cells; `None` for all others.
    index: Option<u32>,
    view: &'a LeafView<'a>,
    /// The part of the line that counts in it.
    span: Interval,
    limit: f64,
    scratch: &'a mut Scratch,
    counters: &'a mut Counters,
}

impl Solids {
    /// Whether neighbouring rays travel together.
    pub(crate) fn has_beams(&self) -> bool {
        self.cells.as_ref().is_some_and(Partition::has_beams)
    }

    /// Takes a run of rays, each with the part that counts, through the upper cells together; until
    /// [`Solids::leave`], only lines of the run may be swept. Returns what it cost.
    pub(crate) fn enter(&self, rays: &[(Ray, Interval)], scratch: &mut Scratch) -> Counters {
        let Some(cells) = &self.cells else {
            return Counters::default();
        };
        let steps = cells.enter(rays, &mut scratch.walk);
        Counters {
            cells: steps.cells,
            lookups: steps.lookups,
            ..Counters::default()
        }
    }

    /// The run has been answered.
    pub(crate) const fn leave(scratch: &mut Scratch) {
        scratch.walk.leave();
    }

    /// Sweeps along the line, cell by cell and front to back.
    ///
    /// `visit` gets every change and returns the parameter beyond which nothing matters any more. A
    /// change near a cell's face may be visited from both sides.
    pub(crate) fn sweep_line(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Change<'_>) -> f64,
    ) {
        self.visit_leaves(line, limit, scratch, counters, |leaf| {
            self.sweep(line, leaf, &mut visit)
        });
    }

    /// The same for some of the leaves: `has` is asked for the index among those of the cells, `None`
    /// for any other.
    pub(crate) fn sweep_some(
        &self,
        line: &Line,
        limit: f64,
        has: impl Fn(Option<u32>) -> bool,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Change<'_>) -> f64,
    ) {
        self.visit_leaves(line, limit, scratch, counters, |leaf| {
            if has(leaf.index) {
                self.sweep(line, leaf, &mut visit)
            } else {
                leaf.limit
            }
        });
    }

    /// Whether every change of an object is a boundary that is seen.
    pub(crate) fn shows_all(&self) -> bool {
        !self.priorities_differ && !self.ranked.iter().any(|ranked| ranked.shell)
    }

    /// Visits the leaves on the line front to back, each with its part of the line; `visit` returns
    /// the parameter beyond which nothing matters any more. Parts of neighbours overlap a little.
    fn visit_leaves(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(LeafVisit<'_>) -> f64,
    ) {
        scratch.begin(self.surfaces.len() + self.meshes.len());
        let all = Interval::new(line.origin, line.end);
        if let Some(volumes) = &self.volumes {
            self.visit_volumes(volumes, line, all, limit, scratch, counters, &mut visit);
            return;
        }
        if let Some(objects) = &self.objects {
            let span = Interval::new(all.start, all.end.min(limit));
            self.sweep_objects(objects, line, span, scratch, counters, &mut visit);
            return;
        }
        let outer = self.outer.map(|leaf| self.leaves.get(leaf));
        let visit_outer =
            |part: Interval,
             limit: f64,
             scratch: &mut Scratch,
             counters: &mut Counters,
             visit: &mut dyn FnMut(LeafVisit<'_>) -> f64| match &outer {
                Some(view) if part.start <= limit && !part.is_empty() => visit(LeafVisit {
                    index: None,
                    view,
                    span: part,
                    limit,
                    scratch,
                    counters,
                }),
                _ => limit,
            };
        let in_cells = self.cells.as_ref().and_then(|cells| {
            let margin = cells.bounds().size().max_element() * (0.5 * CellTree::CONTENT_MARGIN);
            let span = cells
                .bounds()
                .inflated(margin)
                .clip(&line.ray)
                .intersection(&all);
            (!span.is_empty()).then_some((cells, span))
        });
        let Some((cells, span)) = in_cells else {
            visit_outer(all, limit, scratch, counters, &mut visit);
            return;
        };
        // Outside the box all bounded objects are false, so the outer leaf is right there.
        let before = Interval::new(all.start, span.start);
        let mut limit = visit_outer(before, limit, scratch, counters, &mut visit);
        let within = Interval::new(span.start, span.end.min(limit));
        if !within.is_empty() {
            let mut memory = std::mem::take(&mut scratch.walk);
            let steps = cells.walk(&line.ray, within, &mut memory, |leaf, span| {
                limit = visit(LeafVisit {
                    index: Some(leaf),
                    view: &self.leaves.get(leaf),
                    span,
                    limit,
                    scratch,
                    counters,
                });
                limit
            });
            scratch.walk = memory;
            counters.cells += steps.cells;
            counters.lookups += steps.lookups;
        }
        let after = Interval::new(span.end, all.end);
        visit_outer(after, limit, scratch, counters, &mut visit);
    }

    /// Every passage of the line into or out of a solid, in order of (parameter, rank), to `found`,
    /// which is cleared first. Of two leaves that overlap, both see the same.
    pub(crate) fn passages(
        &self,
        line: &Line,
        found: &mut Vec<Passage>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        found.clear();
        self.visit_leaves(line, f64::INFINITY, scratch, counters, |leaf| {
            let LeafVisit {
                view,
                span,
                scratch,
                counters,
                ..
            } = leaf;
            self.leaf_passages(line, view, span, found, scratch, counters);
            f64::INFINITY
        });
        found.retain(|p| p.s < line.end);
        found.sort_unstable_by(|a, b| a.s.total_cmp(&b.s).then(a.rank.cmp(&b.rank)));
        found.dedup_by_key(|p| (p.s, p.rank));
    }

    /// The ranks of the unbounded solids that hold the start of the line, increasing, to `ranks`,
    /// which is cleared first. (A bounded solid that holds it is left later on.)
    pub(crate) fn unbounded_at_start(
        &self,
        line: &Line,
        ranks: &mut Vec<u32>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        ranks.clear();
        let Some(leaf) = self.outer.filter(|_| self.has_unbounded) else {
            ranks.extend(&self.everywhere);
            return;
        };
        scratch.begin(self.surfaces.len() + self.meshes.len());
        let start = line.origin;
        if let Some(objects) = &self.objects {
            let here = Interval::new(start, start);
            self.sweep_objects(objects, line, here, scratch, counters, &mut |leaf| {
                self.solids_in(line, leaf.view, start, ranks, leaf.scratch, leaf.counters);
                start
            });
        } else {
            let view = self.leaves.get(leaf);
            self.solids_in(line, &view, start, ranks, scratch, counters);
        }
        ranks.extend(&self.everywhere);
        ranks.sort_unstable();
        ranks.dedup();
    }

    /// The region at parameter `s` of the line.
    pub(crate) fn region_at(
        &self,
        line: &Line,
        s: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Region {
        scratch.begin(self.surfaces.len() + self.meshes.len());
        if let Some(objects) = &self.objects {
            let here = Interval::new(s, s);
            let mut region = Region::OUTSIDE;
            self.sweep_objects(objects, line, here, scratch, counters, &mut |leaf| {
                region = self.region_in(line, leaf.view, s, leaf.scratch, leaf.counters);
                s
            });
            return region;
        }
        let point = line.ray.at(s);
        let around = self.cells.as_ref().filter(|c| c.bounds().contains(point));
        let leaf = match around.map(|cells| cells.locate(point)) {
            Some(Some(Node::Empty(state))) => return self.region_of_state(state),
            Some(Some(Node::Occupied(leaf))) => Some(leaf),
            Some(_) => self.whole,
            None => self.outer,
        };
        match leaf {
            Some(leaf) => {
                let view = self.leaves.get(leaf);
                self.region_in(line, &view, s, scratch, counters)
            }
            None => Region::OUTSIDE,
        }
    }

    /// The region that an empty cell's (or a leaf's base) state stands for: 0 is outside.
    fn region_of_state(&self, state: u32) -> Region {
        match state {
            0 => Region::OUTSIDE,
            rank => Region::of(self.ranked[rank as usize - 1].object),
        }
    }

    pub(crate) fn object_of(&self, rank: u32) -> ObjectId {
        self.ranked[rank as usize].object
    }

    /// A box around the bounded objects and what rounding moves, in the coordinates of the scene.
    pub(crate) const fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// How large an object counts as where solids overlap.
    pub(crate) fn size_of(&self, object: ObjectId) -> f64 {
        self.sizes[object.0 as usize]
    }

    pub(crate) fn priority_of(&self, rank: u32) -> i32 {
        self.ranked[rank as usize].priority
    }

    /// The cells over the bounded objects.
    pub(crate) const fn partition(&self) -> Option<&Partition> {
        self.cells.as_ref()
    }

    /// What a leaf holds.
    pub(crate) fn held(&self, leaf: u32) -> Held {
        let view = self.leaves.get(leaf);
        Held {
            objects: view.objects.len() as u32,
            parts: view.surfaces.len() as u32,
        }
    }

    /// Memory by part.
    pub(crate) fn memory(&self) -> MemoryStats {
        let cells = self.cells.as_ref().map(|cells| &cells.stats().cells);
        let objects = self.objects.as_ref();
        let meshes = || self.meshes.iter().map(|mesh| mesh.solid.triangles());
        MemoryStats {
            cells: cells.map_or(0, |stats| stats.node_bytes),
            contents: self.leaves.list_bytes() + objects.map_or(0, ObjectTree::list_bytes),
            expressions: self.leaves.expression_bytes(),
            surfaces: size_of_val(self.surfaces.as_slice()) as u64,
            faces: (size_of_val(self.faces.as_slice()) + size_of_val(self.face_owner.as_slice()))
                as u64,
            triangles: meshes().map(TriangleTree::bytes).sum(),
            triangle_cells: meshes().map(TriangleTree::cell_bytes).sum(),
            wide_trees: meshes()
                .filter_map(TriangleTree::tree_stats)
                .chain(objects.map(|objects| objects.tree().stats()))
                .map(|stats| stats.bytes)
                .sum(),
            instances: 0,
            building: cells.map_or(0, |stats| stats.peak_bytes),
        }
    }

    /// The bytes of the tree and its leaves, for hashing.
    pub(crate) fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let cells = self.cells.iter().flat_map(Partition::words);
        let meshes = self.meshes.iter();
        cells
            .chain(self.leaves.words())
            .chain(meshes.flat_map(|mesh| mesh.solid.triangles().tree_words()))
    }

    pub(crate) fn surface_count(&self) -> usize {
        self.surfaces.len() + self.meshes.len()
    }

    pub(crate) const fn marking(&self) -> Option<&MarkingStats> {
        self.marking.as_ref()
    }

    pub(crate) const fn merged_surfaces(&self) -> usize {
        self.merged_surfaces
    }
}
