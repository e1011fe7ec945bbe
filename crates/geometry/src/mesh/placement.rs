//! A mesh where it stands: its triangles in world coordinates, and what shading asks of them.

use octray_math::{DAffine3, DMat3, DVec2, DVec3, Ray};

use super::{TriangleMesh, TriangleRay};

/// How a mesh is put into the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    world_from_mesh: DAffine3,
    /// The inverse transposed matrix up to a positive factor.
    normal_from_mesh: DMat3,
    mirrored: bool,
}

/// What shading wants to know of a point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrianglePoint {
    /// Unit normal of the front; zero for a triangle without area.
    pub normal: DVec3,
    /// Unit interpolated normal, where the mesh has normals.
    pub shading_normal: Option<DVec3>,
    /// Interpolated texture coordinates, where the mesh has them.
    pub texcoord: Option<DVec2>,
}

impl TrianglePoint {
    /// The same seen as the boundary of what is in front: the normal turned round, and the shading
    /// normal if it does not look that way already.
    #[must_use]
    pub fn flipped(self) -> Self {
        let normal = -self.normal;
        let towards = |n: DVec3| if n.dot(normal) < 0.0 { -n } else { n };
        Self {
            normal,
            shading_normal: self.shading_normal.map(towards),
            ..self
        }
    }
}

impl Placement {
    /// By an invertible transform.
    #[must_use]
    pub fn new(world_from_mesh: &DAffine3) -> Self {
        let m = world_from_mesh.matrix3;
        let mirrored = m.determinant() < 0.0;
        let cofactor = DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        Self {
            world_from_mesh: *world_from_mesh,
            normal_from_mesh: if mirrored { cofactor * -1.0 } else { cofactor },
            mirrored,
        }
    }

    /// The mesh's positions in the world.
    pub fn positions<'a>(&'a self, mesh: &'a TriangleMesh) -> impl Iterator<Item = DVec3> + 'a {
        let world = |p: &DVec3| self.world_from_mesh.transform_point3(*p);
        mesh.positions().iter().map(world)
    }

    /// The corner indices of a triangle, counter-clockwise seen from the front in the world.
    #[must_use]
    pub const fn wound(&self, [a, b, c]: [u32; 3]) -> [u32; 3] {
        if self.mirrored { [a, c, b] } else { [a, b, c] }
    }

    /// The corners of a triangle in the world, counter-clockwise seen from the front; `None` if there
    /// is no such triangle.
    fn corners(&self, mesh: &TriangleMesh, triangle: u32) -> Option<[DVec3; 3]> {
        let wound = self.wound(*mesh.triangles().get(triangle as usize)?);
        Some(wound.map(|i| {
            self.world_from_mesh
                .transform_point3(mesh.positions()[i as usize])
        }))
    }

    /// The normal of a triangle as [`Placement::point`] has it; `None` if there is no such triangle.
    #[must_use]
    pub fn normal(&self, mesh: &TriangleMesh, triangle: u32) -> Option<DVec3> {
        self.corners(mesh, triangle).map(normal)
    }

    /// Normals and texture coordinates where the line crosses a triangle, and whether it comes from
    /// the front; `None` if it does not cross it.
    #[must_use]
    pub fn point(
        &self,
        mesh: &TriangleMesh,
        triangle: u32,
        ray: &Ray,
    ) -> Option<(TrianglePoint, bool)> {
        let index = triangle as usize;
        let corners = self.corners(mesh, triangle)?;
        let hit = TriangleRay::new(ray).intersect(corners)?;
        let [a, b, c] = hit.barycentric;
        let weights = if self.mirrored { [a, c, b] } else { [a, b, c] };
        let shading_normal = mesh.normals().and_then(|normals| {
            let corners = normals.triangles[index].map(|i| normals.values[i as usize]);
            let weighted = corners.into_iter().zip(weights);
            let sum: DVec3 = weighted.map(|(n, w)| n.normalize_or_zero() * w).sum();
            unit(self.normal_from_mesh * sum)
        });
        let texcoord = mesh.texcoords().map(|uv| {
            let corners = uv.triangles[index].map(|i| uv.values[i as usize]);
            corners.into_iter().zip(weights).map(|(t, w)| t * w).sum()
        });
        let point = TrianglePoint {
            normal: normal(corners),
            shading_normal,
            texcoord,
        };
        Some((point, hit.entering))
    }
}

/// The unit normal of a triangle's front, zero if it has no area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    unit((b - a).cross(c - a)).unwrap_or(DVec3::ZERO)
}

/// Scaled first, because the squares of a huge or tiny mesh's normals leave the range.
fn unit(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}
