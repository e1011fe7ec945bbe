//! Surfaces with two sides and no inside.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, transform};

use crate::mesh::TriangleMesh;
use crate::primitive::ShapeError;
use crate::solid::Solid;

/// A surface without an inside. As operand of a set operation it is refused.
#[derive(Clone, Debug)]
pub enum Sheet {
    /// Triangles, open or closed.
    Mesh {
        /// The triangles in their own frame.
        mesh: Arc<TriangleMesh>,
        /// Invertible. In a box, because a sheet is rare and solids are in one `enum` with it.
        world_from_mesh: Box<DAffine3>,
    },
    /// The part of the boundary of `solid` that lies in `clip`: discs, open cylinders and cones,
    /// POV-Ray's `clipped_by`.
    Shell {
        /// Whose boundary.
        solid: Solid,
        /// Which part of it.
        clip: Solid,
    },
}

impl Sheet {
    /// A mesh as it is.
    #[must_use]
    pub fn mesh(mesh: Arc<TriangleMesh>) -> Self {
        Self::Mesh {
            mesh,
            world_from_mesh: Box::new(DAffine3::IDENTITY),
        }
    }

    /// A flat disc, with a hole where `inner_radius > 0`.
    ///
    /// # Errors
    /// `normal` is zero, a radius is not finite, or not `0 <= inner_radius < radius`.
    pub fn disc(
        center: DVec3,
        normal: DVec3,
        radius: f64,
        inner_radius: f64,
    ) -> Result<Self, ShapeError> {
        let plane = Solid::half_space(DVec3::Z, 0.0)?;
        let mut clip = Solid::infinite_cylinder(radius)?;
        if inner_radius != 0.0 {
            if inner_radius >= radius {
                let value = radius - inner_radius;
                return Err(ShapeError::NotPositive {
                    what: "width of the ring",
                    value,
                });
            }
            clip = Solid::difference([clip, Solid::infinite_cylinder(inner_radius)?]);
        }
        let unit = (normal / normal.abs().max_element()).try_normalize();
        let unit = unit.ok_or(ShapeError::ZeroVector { what: "normal" })?;
        let (x, y) = unit.any_orthonormal_pair();
        let frame = DAffine3::from_cols(x, y, unit, center);
        Self::Shell { solid: plane, clip }.transform(frame)
    }

    /// This sheet under an affine map.
    ///
    /// # Errors
    /// [`ShapeError::SingularTransform`].
    pub fn transform(&self, parent_from_child: DAffine3) -> Result<Self, ShapeError> {
        if !transform::is_invertible(&parent_from_child) {
            return Err(ShapeError::SingularTransform);
        }
        Ok(match self {
            Self::Mesh {
                mesh,
                world_from_mesh,
            } => Self::Mesh {
                mesh: Arc::clone(mesh),
                world_from_mesh: Box::new(parent_from_child * **world_from_mesh),
            },
            Self::Shell { solid, clip } => Self::Shell {
                solid: solid.transform(parent_from_child)?,
                clip: clip.transform(parent_from_child)?,
            },
        })
    }

    /// How many faces it has; of a mesh, triangles.
    #[must_use]
    pub fn faces(&self) -> u64 {
        match self {
            Self::Mesh { mesh, .. } => mesh.triangles().len() as u64,
            Self::Shell { solid, clip } => solid.faces().saturating_add(clip.faces()),
        }
    }

    /// A box around the sheet.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh {
                mesh,
                world_from_mesh,
            } => Aabb::from_points(
                mesh.used_positions()
                    .map(|p| world_from_mesh.transform_point3(p)),
            ),
            Self::Shell { solid, clip } => {
                let common = solid.bounds().intersection(clip.bounds());
                if common.is_empty() {
                    Aabb::EMPTY
                } else {
                    common
                }
            }
        }
    }
}
