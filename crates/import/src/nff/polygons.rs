//! Polygons and patches of one material as one mesh.

use std::sync::Arc;

use octray_geometry::{CornerAttribute, MeshError, TriangleMesh};
use octray_math::DVec3;

use crate::weld::Welder;

/// Triangles that share vertices where they are equal.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    positions: Welder,
    triangles: Vec<[u32; 3]>,
    normals: Welder,
    normal_triangles: Vec<[u32; 3]>,
    has_patches: bool,
}

impl Polygons {
    pub(super) const fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Adds a polygon that has been split into `triangles` of indices into `corners`.
    pub(super) fn add(
        &mut self,
        corners: &[DVec3],
        normals: Option<&[DVec3]>,
        triangles: &[[u32; 3]],
    ) {
        self.has_patches |= normals.is_some();
        for triangle in triangles {
            let position = |i: u32| self.positions.vertex(corners[i as usize]);
            self.triangles.push(triangle.map(position));
            // Zero stands for "as the face".
            let normal = |i: u32| normals.map_or(DVec3::ZERO, |n| n[i as usize]);
            let corner = |i: u32| self.normals.vertex(normal(i));
            self.normal_triangles.push(triangle.map(corner));
        }
    }

    pub(super) fn into_mesh(self) -> Result<Arc<TriangleMesh>, MeshError> {
        let mesh = TriangleMesh::new(self.positions.into_positions(), self.triangles)?;
        let mesh = if self.has_patches {
            mesh.with_normals(CornerAttribute {
                values: self.normals.into_positions(),
                triangles: self.normal_triangles,
            })?
        } else {
            mesh
        };
        Ok(Arc::new(mesh))
    }
}
