//! Canonical surfaces: where a line crosses them, on which side of them a box lies, their normals.
//!
//! A surface divides space into a negative side (the inside of the primitive it comes from) and a
//! positive one. Solids are boolean expressions over sides (see [`crate::csg`]), so two operands
//! that share a surface share every bit of its crossings.

mod classify;
mod crossings;
mod table;

use octray_math::{DAffine3, DVec3};

pub(crate) use table::points_upward;
pub use table::{SURFACE_TOLERANCE, SurfaceTable};

/// A surface in world coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// `normal . x = offset`; negative where `normal . x < offset`.
    Plane {
        /// Unit length; the first component that is not 0 is positive.
        normal: DVec3,
        /// Distance from the origin along `normal`.
        offset: f64,
    },
    /// A quadric that is canonical in its own frame.
    Quadric {
        /// Which.
        kind: Quadric,
        /// Invertible.
        local_from_world: DAffine3,
    },
    /// In its own frame the cone `x^2 + y^2 = (1 + slope z)^2`, both nappes: radius 1 at height 0.
    ///
    /// Not in the frame of its apex: that lies far away for a frustum which is nearly a cylinder,
    /// and would take all digits along.
    Cone {
        /// Change of the radius per height, in `[-1, 0)` for the frusta that solids are made of.
        slope: f64,
        /// Invertible.
        local_from_world: DAffine3,
    },
    /// In its own frame the torus about z with major radius 1.
    Torus {
        /// Minor radius over major radius.
        minor: f64,
        /// Invertible.
        local_from_world: DAffine3,
    },
}

/// The quadrics whose negative side is a primitive, in their canonical frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quadric {
    /// `x^2 + y^2 + z^2 = 1`.
    Sphere,
    /// `x^2 + y^2 = 1`.
    Cylinder,
}

/// On which side of a surface all points of a box lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// All on the negative side.
    Negative,
    /// All on the positive side.
    Positive,
    /// Not known to be on one side.
    Both,
}

impl Surface {
    /// The unit normal at a point of the surface, pointing to the positive side.
    ///
    /// Where the surface has none (the apex of a cone) it is the axis.
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Plane { normal, .. } => *normal,
            Self::Quadric {
                kind,
                local_from_world,
            } => {
                let p = local_from_world.transform_point3(point);
                let gradient = match kind {
                    Quadric::Sphere => p,
                    Quadric::Cylinder => DVec3::new(p.x, p.y, 0.0),
                };
                pull_back(local_from_world, gradient)
            }
            Self::Cone {
                slope,
                local_from_world,
            } => {
                let p = local_from_world.transform_point3(point);
                let gradient = DVec3::new(p.x, p.y, -slope * (1.0 + slope * p.z));
                pull_back(local_from_world, gradient)
            }
            Self::Torus {
                local_from_world, ..
            } => {
                let p = local_from_world.transform_point3(point);
                let rho = (p.x * p.x + p.y * p.y).sqrt();
                let ring = if rho > 0.0 {
                    DVec3::new(p.x / rho, p.y / rho, 0.0)
                } else {
                    DVec3::X
                };
                pull_back(local_from_world, p - ring)
            }
        }
    }
}

/// A gradient in the local frame as a unit normal in the world's.
fn pull_back(local_from_world: &DAffine3, gradient: DVec3) -> DVec3 {
    let m = local_from_world.matrix3;
    let normal = m.transpose() * gradient;
    // Scaled first: entries of a huge or tiny object's matrix would overflow when squared.
    let largest = normal.abs().max_element();
    (normal / largest)
        .try_normalize()
        .unwrap_or_else(|| (m.transpose() * DVec3::Z).normalize_or(DVec3::Z))
}

#[cfg(test)]
impl Surface {
    /// The implicit function whose sign is the side, written down independently of the solvers.
    pub(crate) fn implicit_value(&self, p: DVec3) -> f64 {
        match self {
            Surface::Plane { normal, offset } => normal.dot(p) - offset,
            Surface::Quadric {
                kind,
                local_from_world,
            } => {
                let q = local_from_world.transform_point3(p);
                match kind {
                    Quadric::Sphere => q.length_squared() - 1.0,
                    Quadric::Cylinder => q.x * q.x + q.y * q.y - 1.0,
                }
            }
            Surface::Cone {
                slope,
                local_from_world,
            } => {
                let q = local_from_world.transform_point3(p);
                libm::hypot(q.x, q.y) - (1.0 + slope * q.z).abs()
            }
            Surface::Torus {
                minor,
                local_from_world,
            } => {
                let q = local_from_world.transform_point3(p);
                libm::hypot(libm::hypot(q.x, q.y) - 1.0, q.z) - minor
            }
        }
    }
}
