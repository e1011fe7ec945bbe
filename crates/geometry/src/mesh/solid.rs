//! A closed mesh as an operand of set operations.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, Ray};

use super::{MeshCrossing, MeshError, Placement, TriangleMesh, TrianglePoint, TriangleRay};
use crate::MaterialId;
use crate::surface::Side;

/// A closed mesh in world coordinates.
#[derive(Clone, Debug)]
pub struct MeshSolid {
    mesh: Arc<TriangleMesh>,
    placement: Placement,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl MeshSolid {
    /// Places a mesh.
    ///
    /// # Errors
    /// The mesh is not closed.
    pub fn new(mesh: &Arc<TriangleMesh>, world_from_mesh: &DAffine3) -> Result<Self, MeshError> {
        mesh.check_closed()?;
        let placement = Placement::new(world_from_mesh);
        Ok(Self {
            positions: placement.positions(mesh).collect(),
            triangles: mesh
                .triangles()
                .iter()
                .map(|&t| placement.wound(t))
                .collect(),
            mesh: Arc::clone(mesh),
            placement,
        })
    }

    /// How many triangles it has.
    #[must_use]
    pub fn triangle_count(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// The material of one triangle, where the mesh has materials.
    #[must_use]
    pub fn material(&self, triangle: u32) -> Option<MaterialId> {
        self.mesh.materials().map(|all| all[triangle as usize])
    }

    /// Appends the crossings of the whole line, sorted. Returns how many triangles were tested.
    pub fn crossings(&self, ray: &Ray, out: &mut Vec<MeshCrossing>) -> u64 {
        let line = TriangleRay::new(ray);
        let start = out.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(hit) = line.intersect(corners.map(|i| self.positions[i as usize])) {
                out.push(MeshCrossing {
                    t: hit.t,
                    triangle: triangle as u32,
                    entering: hit.entering,
                });
            }
        }
        out[start..].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        self.triangles.len() as u64
    }

    /// On which side of the boundary a box lies; the inside is negative.
    #[must_use]
    pub fn classify(&self, bounds: &Aabb) -> Side {
        let near = |t: &[u32; 3]| {
            Aabb::from_points(t.map(|i| self.positions[i as usize])).overlaps(bounds)
        };
        if self.triangles.iter().any(near) {
            return Side::Both;
        }
        let mut crossings = Vec::new();
        self.crossings(&Ray::new(bounds.center(), DVec3::X), &mut crossings);
        let behind = crossings.iter().filter(|c| c.t < 0.0).count();
        if behind % 2 == 1 {
            Side::Negative
        } else {
            Side::Positive
        }
    }

    /// Normals where the line crosses one of the triangles.
    #[must_use]
    pub fn point(&self, ray: &Ray, triangle: u32) -> Option<TrianglePoint> {
        self.placement.point(&self.mesh, triangle, ray)
    }
}
