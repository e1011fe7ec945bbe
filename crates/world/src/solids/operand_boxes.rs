//! Boxes around the operands of solids, for the share of a cell that they fill.

use octray_geometry::csg::{self, Operand};
use octray_math::Aabb;
use octray_tree::filled_share;

use super::cells::Content;

/// For each face a box around the operand that it belongs to, as far as its object reaches.
#[derive(Debug)]
pub(super) struct OperandBoxes(Vec<Aabb>);

impl OperandBoxes {
    /// Faces of no operand in the list get the box of their object.
    pub(super) fn new(operands: &[Operand], face_owner: &[u32], object_bounds: &[Aabb]) -> Self {
        let mut boxes: Vec<Aabb> = face_owner
            .iter()
            .map(|rank| object_bounds[*rank as usize])
            .collect();
        for operand in operands {
            let bounds = operand.primitive.bounds();
            let bounds = bounds.transformed(&operand.scene_from_local);
            for face in operand.faces.clone() {
                let own = &mut boxes[face as usize];
                *own = own.intersection(bounds);
            }
        }
        Self(boxes)
    }

    /// The share of a cell that boxes of the operands in it fill.
    pub(super) fn share(&self, content: &Content, cell: &Aabb) -> f64 {
        let faces = content.expressions().flat_map(csg::faces);
        let mut boxes: Vec<Aabb> = Vec::new();
        for face in faces {
            let bounds = self.0[face.0 as usize];
            // The faces of one operand follow one another.
            if boxes.last() != Some(&bounds) {
                boxes.push(bounds);
            }
        }
        filled_share(cell, boxes)
    }
}
