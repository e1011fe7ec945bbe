//! Which faces are an object's own: they follow one another, in the order of the objects.

use std::ops::Range;

use octray_geometry::FaceId;
use octray_scene::ObjectId;

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
}
