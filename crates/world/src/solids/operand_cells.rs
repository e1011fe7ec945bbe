//! What matters in a cell by the methods that mark operands: an operand that a cell does not touch is
//! constant in it, one that it may touch keeps all of its faces.

use octray_geometry::FaceId;
use octray_geometry::csg::{self, Constant, Operand, truth_on};
use octray_geometry::membership::{Marker, Marks, witnesses};
use octray_geometry::surface::Side;
use octray_math::Aabb;
use octray_tree::{Cell, Subdivide};

use super::cells::{Cells, Content, Draft};

/// The contents of a cell, and the operands that it touches.
#[derive(Clone, Debug, Default)]
pub(super) struct MarkedContent {
    pub(super) content: Content,
    /// Those with a face in the expressions.
    pub(super) marks: Marks,
}

/// Restricts contents to cells, operand by operand.
pub(super) struct OperandCells<'a> {
    cells: &'a Cells<'a>,
    operands: &'a [Operand],
    marker: &'a Marker,
    /// For each face the index of its operand.
    operand_of: &'a [u32],
}

/// For each face the index of its operand.
pub(super) fn operands_of_faces(operands: &[Operand]) -> Vec<u32> {
    let of = |(index, operand): (usize, &Operand)| {
        std::iter::repeat_n(index as u32, operand.faces.len())
    };
    operands.iter().enumerate().flat_map(of).collect()
}

/// The operands with a face in the expressions, increasing.
pub(super) fn operands_in<'w>(
    expressions: impl Iterator<Item = &'w [u32]>,
    operand_of: &[u32],
) -> Vec<u32> {
    let mut found: Vec<u32> = Vec::new();
    for face in expressions.flat_map(csg::faces) {
        let operand = operand_of[face.0 as usize];
        if found.last() != Some(&operand) {
            found.push(operand);
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

impl<'a> OperandCells<'a> {
    pub(super) const fn new(
        cells: &'a Cells<'a>,
        operands: &'a [Operand],
        marker: &'a Marker,
        operand_of: &'a [u32],
    ) -> Self {
        Self {
            cells,
            operands,
            marker,
            operand_of,
        }
    }

    /// The contents with the operands that they are made of.
    pub(super) fn root(&self, content: Content) -> MarkedContent {
        let operands = operands_in(content.expressions(), self.operand_of);
        let marks = self.marker.all(operands);
        MarkedContent { content, marks }
    }

    /// The value of an operand's literals in a cell that its boundary does not meet; `None` where
    /// that cannot be told.
    fn constant(&self, operand: u32, cell: &Aabb) -> Option<bool> {
        if self.marker.is_outside(operand, cell) {
            return Some(self.operands[operand as usize].complemented);
        }
        let in_cell = |surface| self.cells.classify(surface, cell);
        (witnesses(cell).into_iter())
            .find_map(|point| self.value(operand, |surface| self.cells.side_of(surface, point)))
            .or_else(|| self.value(operand, in_cell))
    }

    /// The value of an operand's expression, by the sides of its surfaces.
    fn value(&self, operand: u32, side: impl Fn(u32) -> Side) -> Option<bool> {
        let code = match &self.operands[operand as usize].expression {
            Ok(code) => code,
            Err(constant) => return Some(*constant == Constant::True),
        };
        let mut truth = |face: FaceId| {
            let face = &self.cells.faces[face.0 as usize];
            truth_on(side(face.surface.0), face.inside_is_positive)
        };
        csg::reduce(code.words(), &mut truth, &mut Vec::new()).map(|c| c == Constant::True)
    }

    /// The operands that matter in a cell: these, and those of a larger one that lie there.
    pub(super) fn touched_besides(
        &self,
        parent: &Marks,
        mut operands: Vec<u32>,
        cell: &Aabb,
    ) -> Marks {
        let there = |operand: &&u32| !self.marker.is_outside(**operand, cell);
        operands.extend(parent.operands.iter().filter(there));
        operands.sort_unstable();
        operands.dedup();
        self.marker.all(operands)
    }

    /// The contents of a cell that touches these operands, of a larger one's. `as_marked`: also those
    /// without end are not decided where they are marked.
    pub(super) fn reduce(
        &self,
        parent: &MarkedContent,
        touched: Marks,
        cell: &Aabb,
        as_marked: bool,
    ) -> MarkedContent {
        // What the parent's operands are here, as far as it was asked for.
        let candidates = &parent.marks.operands;
        let mut known: Vec<Option<Option<bool>>> = vec![None; candidates.len()];
        let mut truth = |face: FaceId| {
            let operand = self.operand_of[face.0 as usize];
            let at = candidates.binary_search(&operand).ok()?;
            *known[at].get_or_insert_with(|| match touched.operands.binary_search(&operand) {
                // Where it ends is not known, so its surfaces say where it is.
                Ok(_) if !as_marked && self.marker.is_unbounded(operand) => {
                    self.value(operand, |surface| self.cells.classify(surface, cell))
                }
                Ok(_) => None,
                Err(_) => self.constant(operand, cell),
            })
        };
        let before = &parent.content;
        let mut draft = Draft::default();
        draft.begin(before.base);
        for object in before.objects() {
            let is_shell = self.cells.ranked[object.rank as usize].shell;
            let (expression, clip) = (object.expression, object.clip);
            draft.add(object.rank, is_shell, expression, clip, &mut truth);
        }
        let content = draft.finish(self.cells.faces, |surface| self.cells.cost(surface));
        let marks = self
            .marker
            .keep(touched, operands_in(content.expressions(), self.operand_of));
        MarkedContent { content, marks }
    }
}

impl Subdivide for OperandCells<'_> {
    type Content = MarkedContent;

    fn restrict(&self, parent: &MarkedContent, cell: &Aabb) -> MarkedContent {
        let touched = self.marker.restrict(&parent.marks, cell);
        self.reduce(parent, touched, cell, false)
    }

    fn describe(&self, content: &MarkedContent) -> Cell {
        self.cells.describe(&content.content)
    }

    fn bytes(&self, content: &MarkedContent) -> u64 {
        self.cells.bytes(&content.content)
    }

    fn building_bytes(&self, content: &MarkedContent) -> u64 {
        self.bytes(content) + content.marks.bytes()
    }

    fn settle(&self, content: &mut MarkedContent) {
        content.marks = Marks::default();
    }

    fn share(&self, content: &MarkedContent, cell: &Aabb) -> f64 {
        self.cells.share(&content.content, cell)
    }
}
