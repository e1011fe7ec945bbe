//! What matters in a cell: every object's expression, reduced to the faces that pass through.

use std::sync::{Mutex, PoisonError};

use octray_geometry::FaceId;
use octray_geometry::csg::{self, Constant, Face, truth_on};
use octray_geometry::mesh::MeshSolid;
use octray_geometry::surface::{Reach, Side, Surface};
use octray_math::{Aabb, DVec3};
use octray_tree::{Cell, Subdivide};

use super::operand_boxes::OperandBoxes;
use super::{MeshSurface, Ranked};

/// The contents of a cell in one allocation: there are millions of them while a large scene is divided.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Content {
    /// Three words for each object (its rank, and where its expression and its clip end), then the
    /// words of the expressions, then the surfaces of their faces, increasing.
    words: Box<[u32]>,
    objects: u32,
    surfaces: u32,
    /// 1 + the lowest rank among the solids that fill the cell, 0 for none.
    pub(super) base: u32,
    /// The work of the surfaces, in planes.
    cost: u32,
}

/// An object whose boundary may pass through, with what is left of its expressions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Active<'a> {
    pub(super) rank: u32,
    pub(super) expression: &'a [u32],
    /// The part of the boundary that counts; empty: all of it.
    pub(super) clip: &'a [u32],
}

/// Words for each object.
const OBJECT_WORDS: usize = 3;

impl Content {
    pub(super) const fn object_count(&self) -> usize {
        self.objects as usize
    }

    fn parts(&self) -> (&[u32], &[u32], &[u32]) {
        let (objects, rest) = self.words.split_at(OBJECT_WORDS * self.object_count());
        let (words, surfaces) = rest.split_at(rest.len() - self.surfaces as usize);
        (objects, words, surfaces)
    }

    /// By rank.
    pub(super) fn objects(&self) -> impl Iterator<Item = Active<'_>> {
        let (objects, words, _) = self.parts();
        let mut start = 0;
        objects.chunks_exact(OBJECT_WORDS).map(move |object| {
            let (middle, end) = (object[1] as usize, object[2] as usize);
            let active = Active {
                rank: object[0],
                expression: &words[start..middle],
                clip: &words[middle..end],
            };
            start = end;
            active
        })
    }

    /// The surfaces of the expressions' faces, increasing.
    pub(super) fn surfaces(&self) -> &[u32] {
        self.parts().2
    }

    /// The expressions and clips of all objects.
    pub(super) fn expressions(&self) -> impl Iterator<Item = &[u32]> {
        self.objects()
            .flat_map(|object| [object.expression, object.clip])
    }
}

/// A content that is being written.
#[derive(Debug, Default)]
pub(super) struct Draft {
    objects: Vec<[u32; OBJECT_WORDS]>,
    words: Vec<u32>,
    surfaces: Vec<u32>,
    base: u32,
}

impl Draft {
    /// Forgets what was written; `base` is that of the cell around.
    pub(super) fn begin(&mut self, base: u32) {
        self.objects.clear();
        self.words.clear();
        self.base = base;
    }

    /// Adds an object as far as `truth` leaves it undecided, those of lower rank first. `expression` and
    /// `clip` are words, no clip meaning all of the boundary.
    pub(super) fn add(
        &mut self,
        rank: u32,
        is_shell: bool,
        expression: &[u32],
        clip: &[u32],
        truth: &mut impl FnMut(FaceId) -> Option<bool>,
    ) {
        let start = self.words.len();
        match csg::reduce(expression, truth, &mut self.words) {
            Some(Constant::True) if !is_shell => return self.fill(rank),
            Some(_) => return,
            None => {}
        }
        let middle = self.words.len();
        if !clip.is_empty() && csg::reduce(clip, truth, &mut self.words) == Some(Constant::False) {
            self.words.truncate(start);
            return;
        }
        let end = self.words.len();
        self.objects.push([rank, middle as u32, end as u32]);
    }

    /// Notes that the solid of this rank fills the cell.
    pub(super) fn fill(&mut self, rank: u32) {
        if self.base == 0 || rank + 1 < self.base {
            self.base = rank + 1;
        }
    }

    /// The content, once all objects are there.
    pub(super) fn finish(&mut self, faces: &[Face], cost: impl Fn(u32) -> u32) -> Content {
        let surface = |face: FaceId| faces[face.0 as usize].surface.0;
        self.surfaces.clear();
        self.surfaces.extend(csg::faces(&self.words).map(surface));
        self.surfaces.sort_unstable();
        self.surfaces.dedup();
        let all = [self.objects.as_flattened(), &self.words, &self.surfaces];
        Content {
            words: all.concat().into_boxed_slice(),
            objects: self.objects.len() as u32,
            surfaces: self.surfaces.len() as u32,
            base: self.base,
            cost: self.surfaces.iter().map(|&s| cost(s)).sum(),
        }
    }
}

/// What one thread needs to restrict contents.
#[derive(Debug, Default)]
struct Scratch {
    draft: Draft,
    /// For each surface the number of the cell that it was last classified for, and the side.
    sides: Vec<(u32, Side)>,
    /// The number of the present cell.
    cell: u32,
}

/// Scratch of threads that have none at the moment.
#[derive(Debug, Default)]
pub(super) struct ScratchPool(Mutex<Vec<Scratch>>);

impl ScratchPool {
    fn with<R>(&self, work: impl FnOnce(&mut Scratch) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = lock().pop().unwrap_or_default();
        let result = work(&mut scratch);
        lock().push(scratch);
        result
    }
}

/// Restricts contents to cells.
pub(super) struct Cells<'a> {
    pub(super) faces: &'a [Face],
    pub(super) surfaces: &'a [Surface],
    pub(super) meshes: &'a [MeshSurface],
    pub(super) ranked: &'a [Ranked],
    /// A box around each object, by rank.
    pub(super) bounds: &'a [Aabb],
    /// By surface, a box outside of which all is on its positive side.
    pub(super) reaches: &'a [Reach],
    /// Where shares of cells count.
    pub(super) operands: Option<&'a OperandBoxes>,
    pub(super) scratch: ScratchPool,
}

impl Cells<'_> {
    pub(super) fn classify(&self, surface: u32, cell: &Aabb) -> Side {
        match self.surfaces.get(surface as usize) {
            Some(surface) => surface.classify(cell),
            None => self.mesh(surface).classify(cell),
        }
    }

    /// The side on which a point lies; of a mesh, one that is not on its boundary.
    pub(super) fn side_of(&self, surface: u32, point: DVec3) -> Side {
        match self.surfaces.get(surface as usize) {
            Some(surface) => surface.classify(&Aabb::new(point, point)),
            None if self.mesh(surface).contains(point) => Side::Negative,
            None => Side::Positive,
        }
    }

    fn mesh(&self, surface: u32) -> &MeshSolid {
        &self.meshes[surface as usize - self.surfaces.len()].solid
    }

    /// The work of a surface in a cell, in planes. A line crosses each surface once, however many
    /// cells ask, so the costly ones count less than a single crossing costs.
    pub(super) fn cost(&self, surface: u32) -> u32 {
        cost(self.surfaces, surface)
    }

    fn restrict_with(&self, parent: &Content, cell: &Aabb, scratch: &mut Scratch) -> Content {
        let Scratch {
            draft,
            sides,
            cell: number,
        } = scratch;
        // Decided when first asked for: most surfaces belong to objects that are far away.
        if sides.is_empty() || *number == u32::MAX {
            sides.clear();
            sides.resize(self.surfaces.len() + self.meshes.len(), (0, Side::Both));
            *number = 0;
        }
        *number += 1;
        let mut truth = |face: FaceId| {
            let face = &self.faces[face.0 as usize];
            let surface = face.surface.0;
            let known = &mut sides[surface as usize];
            if known.0 != *number {
                let reach = self.reaches.get(surface as usize);
                let side = if reach.is_some_and(|reach| !reach.overlaps(cell)) {
                    Side::Positive
                } else {
                    self.classify(surface, cell)
                };
                *known = (*number, side);
            }
            truth_on(known.1, face.inside_is_positive)
        };
        draft.begin(parent.base);
        for object in parent.objects() {
            if !self.bounds[object.rank as usize].overlaps(cell) {
                continue;
            }
            let is_shell = self.ranked[object.rank as usize].shell;
            let (expression, clip) = (object.expression, object.clip);
            draft.add(object.rank, is_shell, expression, clip, &mut truth);
        }
        draft.finish(self.faces, |surface| self.cost(surface))
    }
}

/// See [`Cells::cost`].
pub(super) fn cost(surfaces: &[Surface], surface: u32) -> u32 {
    surfaces
        .get(surface as usize)
        .map_or(8, |surface| surface.cost() as u32)
}

impl Subdivide for Cells<'_> {
    type Content = Content;

    fn restrict(&self, parent: &Content, cell: &Aabb) -> Content {
        self.scratch
            .with(|scratch| self.restrict_with(parent, cell, scratch))
    }

    fn restrict_each(&self, parent: &Content, cells: &[Aabb]) -> Vec<Content> {
        self.scratch.with(|scratch| {
            let restricted = cells
                .iter()
                .map(|cell| self.restrict_with(parent, cell, scratch));
            restricted.collect()
        })
    }

    fn describe(&self, content: &Content) -> Cell {
        if content.objects == 0 {
            return Cell::Empty(content.base);
        }
        Cell::Occupied {
            cost: f64::from(content.cost),
            parts: content.surfaces,
        }
    }

    fn share(&self, content: &Content, cell: &Aabb) -> f64 {
        self.operands
            .map_or(0.0, |boxes| boxes.share(content, cell))
    }

    fn bytes(&self, content: &Content) -> u64 {
        let (objects, words, surfaces) = content.parts();
        let objects = 5 * objects.len() / OBJECT_WORDS;
        4 * (5 + objects + words.len() + surfaces.len()) as u64
    }
}
