//! The crossings of one line with every surface it has been tested against: each is computed once,
//! however many cells ask.

use std::ops::Range;

use super::Solids;
use super::flat_object::Met;
use super::spans::Toggles;
use super::sweep::Event;
use super::volumes::LeafHits;
use crate::Counters;
use crate::beam::Runs;
use crate::chords::{Chord, ChordScratch};
use crate::line::Line;
use octray_geometry::FaceId;
use octray_geometry::mesh::SearchMemory;
use octray_tree::{WalkCost, WalkMemory};

/// A crossing of a surface, in the line's parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub(super) s: f64,
    /// For a mesh: which triangle.
    pub(super) triangle: u32,
}

impl Root {
    /// There is one zero: parameters are compared by value and sorted by their bits.
    fn new(s: f64, triangle: u32) -> Self {
        Self {
            s: s + 0.0,
            triangle,
        }
    }
}

/// Where one surface's roots lie in the scratch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slot {
    /// Valid if it equals the scratch's.
    stamp: u32,
    start: u32,
    end: u32,
    /// Roots before this one lie behind the start of the ray.
    first: u32,
    starts_negative: bool,
}

impl Slot {
    /// The roots that are not behind the start of the ray or before `s`, as indices, and on which
    /// side of the surface one is before them.
    pub(super) fn ahead(&self, roots: &[Root], s: f64) -> (Range<usize>, bool) {
        let (start, end) = (self.start as usize, self.end as usize);
        let passed = roots[start..end]
            .partition_point(|r| r.s < s)
            .max(self.first as usize);
        (
            start + passed..end,
            self.starts_negative ^ (passed % 2 == 1),
        )
    }
}

/// Working memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    stamp: u32,
    slots: Vec<Slot>,
    pub(super) roots: Vec<Root>,
    /// Which side of each surface the sweep is on.
    pub(super) negative: Vec<bool>,
    pub(super) events: Vec<Event>,
    pub(super) toggles: Toggles,
    pub(super) inside: Vec<bool>,
    pub(super) inside_after: Vec<bool>,
    /// Surfaces of a leaf and the objects that name them.
    pub(super) naming: Vec<(u32, u32)>,
    pub(super) walk: WalkMemory,
    pub(crate) runs: Runs,
    pub(crate) triangle_slice: crate::triangle_slice::TriangleSlice,
    /// For the triangles of sheets.
    pub(crate) triangles: SearchMemory,
    pub(super) leaf_hits: LeafHits,
    /// The objects of a tree of boxes that were asked and matter.
    pub(super) met: Vec<Met>,
    pub(crate) chords: ChordScratch,
    /// Chords that are only counted.
    pub(crate) counted: Vec<Chord>,
    /// For each prototype of copies.
    pub(crate) prototypes: Vec<Scratch>,
    mesh_roots: Vec<octray_geometry::mesh::MeshCrossing>,
}

impl Scratch {
    /// Forgets the last line.
    pub(super) fn begin(&mut self, surfaces: usize) {
        self.roots.clear();
        self.slots.resize(surfaces, Slot::default());
        self.negative.resize(surfaces, false);
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill(Slot::default());
            self.stamp = 1;
        }
    }
}

impl Solids {
    /// The crossings of `line` with a surface.
    pub(super) fn roots(
        &self,
        surface: u32,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Slot {
        let index = surface as usize;
        if scratch.slots[index].stamp != scratch.stamp {
            let departed_at = self.departed_at(surface, line, scratch, counters);
            let start = scratch.roots.len();
            let starts_negative = match self.surfaces.get(index) {
                Some(surface) => {
                    counters.surface_tests += 1;
                    let roots = &mut scratch.roots;
                    surface.crossings(&line.ray, |s| roots.push(Root::new(s, 0)))
                }
                None => {
                    let mesh = &self.meshes[index - self.surfaces.len()].solid;
                    scratch.mesh_roots.clear();
                    let mut cost = WalkCost::default();
                    mesh.crossings(&line.ray, &mut scratch.mesh_roots, &mut cost);
                    counters.add_walk(&cost);
                    let found = scratch.mesh_roots.iter();
                    let roots = found.map(|c| Root::new(c.t, c.triangle));
                    scratch.roots.extend(roots);
                    false
                }
            };
            let roots = &scratch.roots[start..];
            let mut first = self.first_ahead(surface, line, starts_negative, roots);
            if departed_at.is_some_and(|s| roots.get(first).is_some_and(|root| root.s == s)) {
                first += 1;
            }
            scratch.slots[index] = Slot {
                stamp: scratch.stamp,
                start: start as u32,
                end: scratch.roots.len() as u32,
                first: first as u32,
                starts_negative,
            };
        }
        scratch.slots[index]
    }

    /// Where the line crosses the surface that it departs from, if that or `surface` is a mesh.
    ///
    /// A mesh and another surface may coincide without being one: the crossings at one parameter
    /// are passed together.
    fn departed_at(
        &self,
        surface: u32,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<f64> {
        if self.meshes.is_empty() {
            return None;
        }
        let (departed, ..) = self.departed_surface(line)?;
        let is_mesh = |surface: u32| surface as usize >= self.surfaces.len();
        if departed == surface || !(is_mesh(departed) || is_mesh(surface)) {
            return None;
        }
        let slot = self.roots(departed, line, scratch, counters);
        let last_passed = slot.first.checked_sub(1)?;
        scratch
            .roots
            .get((slot.start + last_passed) as usize)
            .map(|root| root.s)
    }

    /// How many of the roots lie behind the start of the ray.
    ///
    /// On the surface that the ray departs from, the crossing at the origin is found by its sense
    /// and taken as passed together with all before it, wherever rounding put it. Elsewhere the
    /// parameter decides.
    fn first_ahead(
        &self,
        surface: u32,
        line: &Line,
        starts_negative: bool,
        roots: &[Root],
    ) -> usize {
        let passed = roots.partition_point(|r| r.s <= line.origin);
        let Some((departed, to_positive, triangle)) = self.departed_surface(line) else {
            return passed;
        };
        if departed != surface {
            return passed;
        }
        let nearest = roots
            .iter()
            .enumerate()
            .filter(|(i, root)| {
                let from_negative = starts_negative ^ (i % 2 == 1);
                from_negative == to_positive && triangle.is_none_or(|t| t == root.triangle)
            })
            .min_by(|a, b| {
                let away = |r: &Root| (r.s - line.origin).abs();
                away(a.1).total_cmp(&away(b.1))
            });
        nearest.map_or(passed, |(index, _)| index + 1)
    }

    /// The surface that the line departs from, whether it goes to the positive side, and for a mesh
    /// the triangle.
    pub(super) fn departed_surface(&self, line: &Line) -> Option<(u32, bool, Option<u32>)> {
        let departure = line.departure;
        if departure.face == FaceId::NONE {
            return None;
        }
        if let Some(face) = self.faces.get(departure.face.0 as usize) {
            // Outward is where the literal is false.
            let to_positive = departure.outward != face.inside_is_positive;
            return Some((face.surface.0, to_positive, None));
        }
        let (index, triangle) = self.mesh_triangle(departure.face)?;
        let surface = (self.surfaces.len() + index) as u32;
        let to_positive = departure.outward != self.mesh_is_complemented(index);
        Some((surface, to_positive, Some(triangle)))
    }
}
