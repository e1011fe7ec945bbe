//! What matters in a cell: every object's expression, reduced to the faces that pass through.

use std::ops::Range;

use octray_geometry::FaceId;
use octray_geometry::csg::{self, Constant, Face, truth_on};
use octray_geometry::mesh::MeshSolid;
use octray_geometry::surface::{Side, Surface};
use octray_math::{Aabb, DVec3};
use octray_tree::{Cell, Subdivide};

use super::operand_boxes::OperandBoxes;
use super::{MeshSurface, Ranked};

/// The contents of a cell, all expressions in one array.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Content {
    /// Objects whose boundary may pass through, by rank.
    pub(super) objects: Vec<Active>,
    /// Their expressions.
    pub(super) words: Vec<u32>,
    /// The surfaces of the expressions' faces, increasing.
    pub(super) surfaces: Vec<u32>,
    /// 1 + the lowest rank among the solids that fill the cell, 0 for none.
    pub(super) base: u32,
}

/// An object with what is left of its expressions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Active {
    pub(super) rank: u32,
    expression: Range<usize>,
    /// The part of the boundary that counts; empty: all of it.
    clip: Range<usize>,
}

impl Content {
    pub(super) fn expression(&self, object: &Active) -> &[u32] {
        &self.words[object.expression.clone()]
    }

    /// Empty where all of the boundary counts.
    pub(super) fn clip(&self, object: &Active) -> &[u32] {
        &self.words[object.clip.clone()]
    }

    /// The expressions and clips of all objects.
    pub(super) fn expressions(&self) -> impl Iterator<Item = &[u32]> {
        (self.objects.iter()).flat_map(|object| [self.expression(object), self.clip(object)])
    }

    /// Adds an object as far as `truth` leaves it undecided. `expression` and `clip` are words, no
    /// clip meaning all of the boundary.
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
        self.objects.push(Active {
            rank,
            expression: start..middle,
            clip: middle..end,
        });
    }

    /// Notes that the solid of this rank fills the cell.
    pub(super) fn fill(&mut self, rank: u32) {
        if self.base == 0 || rank + 1 < self.base {
            self.base = rank + 1;
        }
    }

    /// Lists the surfaces, once all objects are there.
    pub(super) fn finish(&mut self, faces: &[Face]) {
        let surface = |face: FaceId| faces[face.0 as usize].surface.0;
        self.surfaces.clear();
        for object in &self.objects {
            let words = [object.expression.clone(), object.clip.clone()];
            let own = words
                .into_iter()
                .flat_map(|range| csg::faces(&self.words[range]));
            self.surfaces.extend(own.map(surface));
        }
        self.surfaces.sort_unstable();
        self.surfaces.dedup();
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
    /// Where shares of cells count.
    pub(super) operands: Option<&'a OperandBoxes>,
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
    fn cost(&self, surface: u32) -> f64 {
        self.surfaces
            .get(surface as usize)
            .map_or(8.0, Surface::cost)
    }
}

impl Subdivide for Cells<'_> {
    type Content = Content;

    fn restrict(&self, parent: &Content, cell: &Aabb) -> Content {
        // Decided when first asked for: most surfaces belong to objects that are far away.
        let mut sides: Vec<Option<Side>> = vec![None; parent.surfaces.len()];
        let mut truth = |face: FaceId| {
            let face = &self.faces[face.0 as usize];
            let at = parent.surfaces.binary_search(&face.surface.0).ok()?;
            let side = *sides[at].get_or_insert_with(|| self.classify(face.surface.0, cell));
            truth_on(side, face.inside_is_positive)
        };
        let mut content = Content {
            base: parent.base,
            ..Content::default()
        };
        for object in &parent.objects {
            if !self.bounds[object.rank as usize].overlaps(cell) {
                continue;
            }
            let is_shell = self.ranked[object.rank as usize].shell;
            let (expression, clip) = (parent.expression(object), parent.clip(object));
            content.add(object.rank, is_shell, expression, clip, &mut truth);
        }
        content.finish(self.faces);
        content
    }

    fn describe(&self, content: &Content) -> Cell {
        if content.objects.is_empty() {
            return Cell::Empty(content.base);
        }
        Cell::Occupied {
            cost: content.surfaces.iter().map(|&s| self.cost(s)).sum(),
            parts: content.surfaces.len() as u32,
        }
    }

    fn share(&self, content: &Content, cell: &Aabb) -> f64 {
        self.operands
            .map_or(0.0, |boxes| boxes.share(content, cell))
    }

    fn bytes(&self, content: &Content) -> u64 {
        let words = 5 + 5 * content.objects.len() + content.words.len() + content.surfaces.len();
        4 * words as u64
    }
}
