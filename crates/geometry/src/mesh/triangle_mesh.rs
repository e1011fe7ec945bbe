use octray_math::{Aabb, DVec2, DVec3};
use thiserror::Error;

use super::MeshReport;
use crate::MaterialId;

/// Why a mesh is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError {
    /// A corner index is not below the number of positions (or of normals, texture coordinates).
    #[error("triangle {triangle} uses {what} {index}, but there are only {count}")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// `vertex`, `normal` or `texture coordinate`.
        what: &'static str,
        /// The index used, from 0.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite: ({}, {}, {})", position.x, position.y, position.z)]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its coordinates.
        position: DVec3,
    },
    /// Per-triangle data does not match the number of triangles.
    #[error("{what}: {given} given for {triangles} triangles")]
    WrongCount {
        /// Which data.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many triangles there are.
        triangles: usize,
    },
    /// More triangles or vertices than 32-bit identities can name.
    #[error("the mesh has {0} {1}; at most 2^30 are supported")]
    TooLarge(usize, &'static str),
    /// As a solid: there are no triangles.
    #[error("the mesh has no triangles, so it has no inside")]
    Empty,
    /// As a solid: an edge has an unequal number of triangles on its two sides, so there is no
    /// winding number.
    #[error("the mesh is not closed, so it has no inside: {0}")]
    NoInside(Box<MeshReport>),
    /// As a solid: the mesh is not the boundary of a solid beyond doubt.
    #[error("the mesh is not the boundary of a solid: {0}")]
    NotASolid(Box<MeshReport>),
    /// The octree over its triangles would be too large.
    #[error(transparent)]
    Tree(#[from] octray_tree::WideTreeError),
}

/// Per-corner data with its own indices, so that a position may carry several normals or texture
/// coordinates without being split (splitting would open the mesh).
#[derive(Clone, Debug, PartialEq)]
pub struct CornerAttribute<T> {
    /// The distinct values.
    pub values: Vec<T>,
    /// One triple of indices into `values` per triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// Triangles over shared positions. Counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) normals: Option<CornerAttribute<DVec3>>,
    pub(super) texcoords: Option<CornerAttribute<DVec2>>,
    pub(super) materials: Option<Vec<MaterialId>>,
}

const LIMIT: usize = 1 << 30;

impl TriangleMesh {
    /// A mesh of positions and corner triples.
    ///
    /// Triangles without area are kept: they have identity, and no line meets them.
    ///
    /// # Errors
    /// An index out of range, a used coordinate that is not finite, or too many of either.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if positions.len() > LIMIT {
            return Err(MeshError::TooLarge(positions.len(), "vertices"));
        }
        if triangles.len() > LIMIT {
            return Err(MeshError::TooLarge(triangles.len(), "triangles"));
        }
        check_indices("vertex", positions.len(), &triangles)?;
        if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
            let position = positions[vertex];
            return Err(MeshError::NotFinite { vertex, position });
        }
        Ok(Self {
            positions,
            triangles,
            normals: None,
            texcoords: None,
            materials: None,
        })
    }

    /// The same mesh with shading normals (any length; zero means "use the face's").
    ///
    /// # Errors
    /// The number of triangles differs, or an index is out of range.
    pub fn with_normals(mut self, normals: CornerAttribute<DVec3>) -> Result<Self, MeshError> {
        self.check_attribute("normal", &normals)?;
        self.normals = Some(normals);
        Ok(self)
    }

    /// The same mesh with texture coordinates.
    ///
    /// # Errors
    /// The number of triangles differs, or an index is out of range.
    pub fn with_texcoords(mut self, uv: CornerAttribute<DVec2>) -> Result<Self, MeshError> {
        self.check_attribute("texture coordinate", &uv)?;
        self.texcoords = Some(uv);
        Ok(self)
    }

    /// The same mesh with a material per triangle.
    ///
    /// # Errors
    /// The number of triangles differs.
    pub fn with_materials(mut self, materials: Vec<MaterialId>) -> Result<Self, MeshError> {
        self.check_count("materials", materials.len())?;
        self.materials = Some(materials);
        Ok(self)
    }

    fn check_count(&self, what: &'static str, given: usize) -> Result<(), MeshError> {
        let triangles = self.triangles.len();
        if given == triangles {
            Ok(())
        } else {
            Err(MeshError::WrongCount {
                what,
                given,
                triangles,
            })
        }
    }

    fn check_attribute<T>(
        &self,
        what: &'static str,
        attribute: &CornerAttribute<T>,
    ) -> Result<(), MeshError> {
        self.check_count(what, attribute.triangles.len())?;
        check_indices(what, attribute.values.len(), &attribute.triangles)
    }

    /// The vertices.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Corner indices into [`TriangleMesh::positions`].
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Shading normals.
    #[must_use]
    pub const fn normals(&self) -> Option<&CornerAttribute<DVec3>> {
        self.normals.as_ref()
    }

    /// Texture coordinates.
    #[must_use]
    pub const fn texcoords(&self) -> Option<&CornerAttribute<DVec2>> {
        self.texcoords.as_ref()
    }

    /// One material per triangle.
    #[must_use]
    pub fn materials(&self) -> Option<&[MaterialId]> {
        self.materials.as_deref()
    }

    /// The positions that some triangle uses (with repetitions).
    pub fn used_positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.triangles
            .iter()
            .flatten()
            .map(|&i| self.positions[i as usize])
    }

    /// The box around all triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.used_positions())
    }
}

fn check_indices(
    what: &'static str,
    count: usize,
    triangles: &[[u32; 3]],
) -> Result<(), MeshError> {
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= count) {
            return Err(MeshError::IndexOutOfRange {
                triangle,
                what,
                index,
                count,
            });
        }
    }
    Ok(())
}
