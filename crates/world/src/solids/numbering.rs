//! Whose faces are which: those of an object follow one another, in the order of the objects.

use std::ops::Range;

use octray_geometry::{FaceId, MaterialId};
use octray_scene::{ObjectId, Scene};

use super::Solids;

impl Solids {
    /// The object's triangles of mesh operands, and its other faces, as ranges of ids.
    pub(crate) fn faces_of(&self, object: ObjectId) -> [Range<u32>; 2] {
        let owner = |literal: u32| self.object_of(self.face_owner[literal as usize]);
        let mesh = |after: bool| {
            let before = |m: &super::MeshSurface| {
                let owner = owner(m.literal);
                owner < object || (after && owner == object)
            };
            let index = self.meshes.partition_point(before);
            self.meshes
                .get(index)
                .map_or(self.face_count(), |m| m.first_face)
        };
        let face = |after: bool| {
            let before = |rank: &u32| {
                let owner = self.object_of(*rank);
                owner < object || (after && owner == object)
            };
            self.face_owner.partition_point(before) as u32
        };
        [mesh(false)..mesh(true), face(false)..face(true)]
    }

    /// How many of these faces stand for whole meshes.
    pub(crate) fn mesh_literals(&self, faces: &Range<u32>) -> u32 {
        let before = |face: u32| self.meshes.partition_point(|m| m.literal < face);
        (before(faces.end) - before(faces.start)) as u32
    }

    /// Whether the face is of the solids.
    pub(crate) fn has(&self, face: FaceId) -> bool {
        face.0 < self.face_count()
    }

    /// How many face ids the solids use; triangles of sheets are numbered from here.
    pub(crate) fn face_count(&self) -> u32 {
        match self.meshes.last() {
            Some(mesh) => mesh.first_face + mesh.solid.triangle_count(),
            None => self.faces.len() as u32,
        }
    }

    /// The object and material of one of the solids' faces.
    pub(crate) fn owner(&self, face: FaceId, scene: &Scene) -> Option<(ObjectId, MaterialId)> {
        let (literal, triangle) = match self.mesh_triangle(face) {
            Some((mesh, triangle)) => (self.meshes[mesh].literal, Some((mesh, triangle))),
            None => (face.0, None),
        };
        let owner = *self.face_owner.get(literal as usize)?;
        let object = self.ranked[owner as usize].object;
        let of_triangle = triangle.and_then(|(mesh, t)| self.meshes[mesh].solid.material(t));
        let material = of_triangle
            .or(self.faces[literal as usize].material)
            .unwrap_or(scene.objects()[object.0 as usize].material);
        Some((object, material))
    }

    /// Which mesh operand and which of its triangles a face is.
    pub(super) fn mesh_triangle(&self, face: FaceId) -> Option<(usize, u32)> {
        let mesh = self
            .meshes
            .partition_point(|m| m.first_face <= face.0)
            .checked_sub(1)?;
        let triangle = face.0 - self.meshes[mesh].first_face;
        (triangle < self.meshes[mesh].solid.triangle_count()).then_some((mesh, triangle))
    }

    /// Whether the expression wants the outside of a mesh operand.
    pub(super) fn mesh_is_complemented(&self, mesh: usize) -> bool {
        self.faces[self.meshes[mesh].literal as usize].inside_is_positive
    }
}
