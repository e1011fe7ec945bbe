//! Normals of the solids' faces.

use octray_geometry::FaceId;
use octray_geometry::mesh::TrianglePoint;
use octray_math::DVec3;

use super::Solids;
use crate::line::Line;

impl Solids {
    /// The unit normal out of the object; for a triangle of a mesh operand also what the mesh
    /// brings along. `None` if the face is not of the solids.
    pub(crate) fn point(
        &self,
        line: &Line,
        face: FaceId,
        entering: bool,
        position: DVec3,
    ) -> Option<TrianglePoint> {
        if let Some((mesh, triangle)) = self.mesh_triangle(face) {
            // That the object is entered says which way is out, for complements too.
            return self.meshes[mesh].solid.point(&line.ray, triangle, entering);
        }
        let face = self.faces.get(face.0 as usize)?;
        let normal = self.surfaces.get(face.surface.0 as usize)?.normal(position);
        Some(TrianglePoint {
            normal: if face.inside_is_positive {
                -normal
            } else {
                normal
            },
            shading_normal: None,
            texcoord: None,
        })
    }
}
