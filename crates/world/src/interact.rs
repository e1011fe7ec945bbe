//! From a hit to what shading wants to know.

use octray_geometry::mesh::TrianglePoint;
use octray_geometry::{FaceId, MaterialId};
use octray_math::DVec3;
use octray_scene::ObjectId;

use crate::line::Line;
use crate::sheets::SheetHit;
use crate::solids::Interface;
use crate::{Hit, RayQuery, Region, SurfaceHit, World};

/// Where there is no surface.
const NOWHERE: TrianglePoint = TrianglePoint {
    normal: DVec3::Z,
    shading_normal: None,
    texcoord: None,
};

impl Interface {
    /// A triangle as an interface; the regions are not known yet.
    pub(crate) const fn of_sheet(hit: &SheetHit) -> Self {
        Self {
            s: hit.s,
            face: hit.face,
            instance: 0,
            entering: hit.entering,
            from: Region::OUTSIDE,
            to: Region::OUTSIDE,
        }
    }

    pub(crate) fn into_hit(self, line: &Line) -> Hit {
        Hit {
            t: line.t(self.s),
            face: self.face,
            instance: self.instance,
            entering: self.entering,
            from: self.from,
            to: self.to,
        }
    }
}

impl World {
    /// The object and material of a face, `None` for [`FaceId::NONE`] and faces of other worlds.
    #[must_use]
    pub fn owner(&self, face: FaceId) -> Option<(ObjectId, MaterialId)> {
        let scene = &self.scene;
        self.sheets
            .owner(face, scene)
            .or_else(|| self.solids.owner(face, scene))
            .or_else(|| self.instances.owner(face, scene))
    }

    /// Position, normals and materials of a hit of `query`.
    ///
    /// A miss gives a point at infinity with the first material; do not ask.
    #[must_use]
    pub fn interact(&self, query: &RayQuery, hit: &Hit) -> SurfaceHit {
        let position = query.ray.at(hit.t);
        let (object, material) = self.owner(hit.face).unwrap_or((ObjectId(0), MaterialId(0)));
        let line = self.line(query, false);
        let face = (hit.instance, hit.face, hit.entering);
        let point = line.and_then(|line| {
            let in_scene = self.place.scene_from_world(position);
            self.point(&line, face, in_scene)
        });
        let is_sheet = point.is_some_and(|(_, is_sheet)| is_sheet);
        let TrianglePoint {
            normal,
            shading_normal,
            texcoord,
        } = point.map_or(NOWHERE, |(point, _)| point);
        let shading_normal = match shading_normal {
            // On the same side as the face: seen from in front, a surface must not be lit from behind.
            Some(n) if n.dot(normal) > 0.0 => n,
            _ => normal,
        };
        let ior_in = |region: Region| {
            self.medium(region)
                .map_or(1.0, |m| self.scene.material(m).interior.ior)
        };
        let mut surface = SurfaceHit {
            position,
            normal,
            shading_normal,
            texcoord,
            object,
            material,
            entering: hit.entering,
            ior_from: ior_in(hit.from),
            ior_to: ior_in(hit.to),
            medium: self.medium(hit.from),
        };
        let bends = self.scene.material(material).interior.ior != 1.0;
        if is_sheet && bends {
            // As if the front bounded a solid of the sheet's material.
            let inside = self.scene.material(material).interior.ior;
            if hit.entering {
                surface.ior_to = inside;
            } else {
                surface.ior_from = inside;
                surface.medium = Some(material);
            }
        }
        surface
    }

    /// The normal of a hit of `query`, as [`World::interact`] has it, for less.
    #[must_use]
    pub fn normal(&self, query: &RayQuery, hit: &Hit) -> DVec3 {
        let of_sheet = self.sheets.normal(hit.face);
        of_sheet.unwrap_or_else(|| self.interact(query, hit).normal)
    }

    /// Shading data of a face (of which copy, and whether it is entered) that the line crosses at a
    /// position in the scene's coordinates, and whether it is a triangle of a sheet.
    pub(crate) fn point(
        &self,
        line: &Line,
        (instance, face, entering): (u32, FaceId, bool),
        position: DVec3,
    ) -> Option<(TrianglePoint, bool)> {
        if instance != 0 {
            return (self.instances).point(line, (instance, face, entering), position);
        }
        let of_sheet = self.sheets.point(line, face).map(|point| (point, true));
        of_sheet.or_else(|| {
            let point = self.solids.point(line, face, entering, position)?;
            Some((point, false))
        })
    }

    /// What fills a region.
    fn medium(&self, region: Region) -> Option<MaterialId> {
        region
            .object()
            .map(|object| self.scene.objects()[object.0 as usize].material)
    }
}
