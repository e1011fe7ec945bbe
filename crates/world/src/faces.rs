//! How faces are numbered: in the scene, and within their object.

use octray_geometry::FaceId;
use octray_scene::ObjectId;

use crate::World;

impl World {
    /// How many faces an object has: triangles of its meshes, and faces of its other parts. Of
    /// instances, those of one copy.
    #[must_use]
    pub fn face_count(&self, object: ObjectId) -> u32 {
        if let Some(count) = self.instances.face_count(object) {
            return count;
        }
        let sheet = self.sheets.faces_of(object);
        let [triangles, others] = self.solids.faces_of(object);
        let stand_in = self.solids.mesh_literals(&others);
        sheet.len() as u32 + triangles.len() as u32 + others.len() as u32 - stand_in
    }

    /// A face's object, and its number among that object's faces, from 0: triangles of meshes in
    /// the order of the mesh, then the faces of other parts. So for a mesh it is the triangle.
    ///
    /// `None` for [`FaceId::NONE`] and faces of other worlds.
    #[must_use]
    pub fn face_in_object(&self, face: FaceId) -> Option<(ObjectId, u32)> {
        if let Some(found) = self.instances.face_in_object(face) {
            return Some(found);
        }
        let (object, _) = self.owner(face)?;
        if !self.solids.has(face) {
            return Some((object, face.0 - self.sheets.faces_of(object).start));
        }
        let [triangles, others] = self.solids.faces_of(object);
        let number = if triangles.contains(&face.0) {
            face.0 - triangles.start
        } else {
            // A mesh has a face of its own in the expression, which no ray ever meets.
            let before = others.start..face.0;
            triangles.len() as u32 + before.len() as u32 - self.solids.mesh_literals(&before)
        };
        Some((object, number))
    }

    /// The object of a copy that a hit names ([`crate::Hit::instance`]), and which of that object's
    /// copies it is, from 0; `None` for 0 and numbers without a copy.
    #[must_use]
    pub fn instance(&self, instance: u32) -> Option<(ObjectId, u32)> {
        self.instances.number_in_object(instance)
    }
}
