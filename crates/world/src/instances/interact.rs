//! Faces and normals of copies.

use octray_geometry::mesh::TrianglePoint;
use octray_geometry::{FaceId, MaterialId};
use octray_math::DVec3;
use octray_scene::{ObjectId, Prototype, Scene};

use super::{Copies, Copy, Instances};
use crate::World;
use crate::line::Line;

impl Instances {
    /// The object of copies that a face is of, with the face's number in the prototype.
    fn copies_of(&self, face: FaceId) -> Option<(&Copies, FaceId)> {
        let after = self.objects.partition_point(|o| o.first_face <= face.0);
        let copies = self.objects[..after].last()?;
        let own = face.0 - copies.first_face;
        let known = self.prototypes[copies.prototype].own_face_count();
        (own < known).then_some((copies, FaceId(own)))
    }

    /// The object and material of a copied face.
    pub(crate) fn owner(&self, face: FaceId, scene: &Scene) -> Option<(ObjectId, MaterialId)> {
        let (copies, own) = self.copies_of(face)?;
        let (_, material) = self.prototypes[copies.prototype].owner(own)?;
        let material = match material {
            Prototype::INHERITED => scene.objects()[copies.object.0 as usize].material,
            own => own,
        };
        Some((copies.object, material))
    }

    /// How many faces an object of copies has, those of its prototype; `None` for other objects.
    pub(crate) fn face_count(&self, object: ObjectId) -> Option<u32> {
        let index = self.objects.binary_search_by_key(&object, |o| o.object);
        let copies = &self.objects[index.ok()?];
        Some(face_count(&self.prototypes[copies.prototype]))
    }

    /// The object of a copied face, and the face's number in the prototype: part by part as in
    /// objects.
    pub(crate) fn face_in_object(&self, face: FaceId) -> Option<(ObjectId, u32)> {
        let (copies, own) = self.copies_of(face)?;
        let prototype = &self.prototypes[copies.prototype];
        let (part, number) = prototype.face_in_object(own)?;
        let before: u32 = (0..part.0).map(|p| prototype.face_count(ObjectId(p))).sum();
        Some((copies.object, before + number))
    }

    /// The object of a copy, and which of that object's copies it is, from 0.
    pub(crate) fn number_in_object(&self, instance: u32) -> Option<(ObjectId, u32)> {
        let copies = self.copy(instance)?.copies;
        Some((copies.object, instance - 1 - copies.first_copy))
    }

    /// Shading data of a copy's face that the line crosses at a position in the scene's coordinates,
    /// and whether it is a triangle of a sheet.
    pub(crate) fn point(
        &self,
        line: &Line,
        (instance, face, entering): (u32, FaceId, bool),
        position: DVec3,
    ) -> Option<(TrianglePoint, bool)> {
        let copy = self.copy(instance)?;
        let inner = copy.line(line)?;
        let own = copy.own_face(face);
        let World {
            solids,
            sheets,
            place,
            ..
        } = copy.prototype;
        let sheet = sheets.point(&inner, own);
        let is_sheet = sheet.is_some();
        let of_solid = || {
            let position = copy.prototype_from_scene * (position - copy.position);
            let position = place.scene_from_world(position);
            solids.point(&inner, own, entering, position)
        };
        let point = sheet.or_else(of_solid)?;
        let point = TrianglePoint {
            normal: copy.normal(point.normal),
            shading_normal: point.shading_normal.map(|n| copy.normal(n)),
            ..point
        };
        Some((point, is_sheet))
    }
}

impl Copy<'_> {
    /// A unit normal of the prototype, seen from the scene: planes move by the transposed inverse.
    fn normal(&self, normal: DVec3) -> DVec3 {
        if self.prototype_from_scene == octray_math::DMat3::IDENTITY {
            return normal;
        }
        let moved = self.prototype_from_scene.transpose() * normal;
        // Scaled first, because the squares of a huge or tiny copy's normals leave the range.
        (moved / moved.abs().max_element()).normalize_or_zero()
    }
}

fn face_count(prototype: &World) -> u32 {
    let parts = 0..prototype.scene.objects().len() as u32;
    parts.map(|part| prototype.face_count(ObjectId(part))).sum()
}
