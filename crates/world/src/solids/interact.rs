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
        position: DVec3,
    ) -> Option<TrianglePoint> {
        if let Some((mesh, triangle)) = self.mesh_triangle(face) {
            let point = self.meshes[mesh].solid.point(&line.ray, triangle)?;
            let sign = if self.mesh_is_complemented(mesh) {
                -1.0
            } else {
                1.0
            };
            return Some(TrianglePoint {
                normal: point.normal * sign,
                shading_normal: point.shading_normal.map(|n| n * sign),
                texcoord: point.texcoord,
            });
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
