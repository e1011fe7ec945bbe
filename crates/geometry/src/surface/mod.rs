//! Canonical surfaces: where a line crosses them, on which side of them a box lies, their normals.
//!
//! A surface divides space into a negative side (the inside of the primitive it comes from) and a
//! positive one. Solids are boolean expressions over sides (see [`crate::csg`]), so two operands
//! that share a surface share every bit of its crossings.

mod cone;
mod convex;
mod extrusion;
mod fingerprint;
mod found;
mod local_box;
mod near;
mod plane;
mod polynomial;
mod quadric;
mod reach;
mod revolution;
mod round;
mod superellipsoid;
mod table;
#[cfg(test)]
mod tests;
mod torus;

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, Ray};

use crate::Polynomial;
use crate::profile::Contour;
pub use convex::Stretch;
use local_box::LocalBox;
pub use near::{NEAR, NearPair};
pub(crate) use polynomial::range as polynomial_range;
pub use quadric::QuadricForm;
pub use reach::Reach;
pub(crate) use table::points_upward;
pub use table::{PLACE_TOLERANCE, SURFACE_TOLERANCE, SurfaceTable};
#[cfg(test)]
pub(crate) use tests::implicit_value;

/// A surface in the coordinates of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// `normal . x = offset`; negative where `normal . x < offset`.
    Plane {
        /// Unit length; the first component that is not 0 is positive.
        normal: DVec3,
        /// Distance from the origin along `normal`.
        offset: f64,
    },
    /// A curved surface that is canonical in its own frame.
    Curved {
        /// Which.
        canonical: Canonical,
        /// Invertible.
        local_from_scene: DAffine3,
    },
}

/// The curved surfaces, each in the frame in which its formula is simplest.
#[derive(Clone, Debug, PartialEq)]
pub enum Canonical {
    /// `x^2 + y^2 + z^2 = 1`.
    Sphere,
    /// `x^2 + y^2 = 1`.
    Cylinder,
    /// The cone `x^2 + y^2 = (1 + slope z)^2`, both nappes: radius 1 at height 0.
    ///
    /// Not in the frame of its apex: that lies far away for a frustum which is nearly a cylinder,
    /// and would take all digits along.
    Cone {
        /// Change of the radius per height, in `[-1, 0)` for the frusta that solids are made of.
        slope: f64,
    },
    /// The torus about z with major radius 1.
    Torus {
        /// Minor radius over major radius.
        minor: f64,
    },
    /// Another quadric.
    Quadric(QuadricForm),
    /// Where a polynomial is 0.
    Polynomial(Arc<Polynomial>),
    /// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) = 1`.
    Superellipsoid {
        /// `[e, n]`: of the cross-section, and of the outline.
        exponents: [f64; 2],
    },
    /// A closed curve in the xy plane, drawn out along z without end.
    Extrusion(Arc<Contour>),
    /// A closed curve in the half-plane of the distance from the z axis (its x, never negative)
    /// and the height (its y), turned about the axis.
    Revolution(Arc<Contour>),
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
    /// Visits the parameters at which the line changes sides, increasing, and returns whether it
    /// comes from the negative side.
    ///
    /// A line that touches the surface does not change sides. The number of changes is even for
    /// the bounded surfaces, whatever the rounding.
    ///
    /// Every solver moves its origin to the point of the line that is closest to the surface's
    /// centre first (Haines et al., *Precision Improvements for Ray/Sphere Intersection*, Ray
    /// Tracing Gems, chapter 7): then the constant term is a distance, not a difference of large
    /// numbers.
    pub fn crossings(&self, ray: &Ray, visit: impl FnMut(f64)) -> bool {
        match self {
            Self::Plane { normal, offset } => plane::crossings(*normal, *offset, ray).report(visit),
            Self::Curved {
                canonical,
                local_from_scene,
            } => {
                let Ray { origin, direction } = ray.transformed(local_from_scene);
                canonical.crossings(origin, direction, visit)
            }
        }
    }

    /// The side on which all of a bounded box lies. [`Side::Both`] too often, never too seldom.
    #[must_use]
    pub fn classify(&self, bounds: &Aabb) -> Side {
        match self {
            Self::Plane { normal, offset } => plane::classify(*normal, *offset, bounds),
            Self::Curved {
                canonical,
                local_from_scene,
            } => canonical.classify(&LocalBox::new(bounds, local_from_scene)),
        }
    }

    /// The unit normal at a point of the surface, pointing to the positive side.
    ///
    /// Where the surface has none (the apex of a cone) it is the axis.
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Plane { normal, .. } => *normal,
            Self::Curved {
                canonical,
                local_from_scene,
            } => {
                let p = local_from_scene.transform_point3(point);
                pull_back(local_from_scene, canonical.gradient(p))
            }
        }
    }

    /// The work of crossing it, in planes.
    #[must_use]
    pub fn cost(&self) -> f64 {
        match self {
            Self::Plane { .. } => 1.0,
            Self::Curved { canonical, .. } => canonical.cost(),
        }
    }
}

impl Canonical {
    /// See [`Surface::crossings`]; the line in the local frame.
    #[inline]
    fn crossings(&self, origin: DVec3, direction: DVec3, visit: impl FnMut(f64)) -> bool {
        let changes = match self {
            Self::Sphere => round::sphere(origin, direction),
            Self::Cylinder => round::cylinder(origin, direction),
            Self::Cone { slope } => cone::crossings(*slope, origin, direction),
            Self::Torus { minor } => torus::crossings(*minor, origin, direction),
            Self::Quadric(form) => quadric::crossings(*form, origin, direction),
            _ => return self.many_crossings(origin, direction, visit),
        };
        changes.report(visit)
    }

    /// Of the surfaces that may be crossed more than four times: apart, so that the function for
    /// the common ones stays small.
    #[inline(never)]
    fn many_crossings(&self, o: DVec3, d: DVec3, mut visit: impl FnMut(f64)) -> bool {
        match self {
            Self::Polynomial(polynomial) => polynomial::crossings(polynomial, o, d).report(visit),
            Self::Superellipsoid { exponents } => {
                superellipsoid::crossings(*exponents, o, d).report(visit)
            }
            Self::Extrusion(contour) => extrusion::crossings(contour, o, d, &mut visit),
            Self::Revolution(contour) => revolution::crossings(contour, o, d, &mut visit),
            // The others are dealt with by the caller.
            _ => false,
        }
    }

    fn classify(&self, local: &LocalBox) -> Side {
        match self {
            Self::Sphere => round::classify(round::SPHERE, local),
            Self::Cylinder => round::classify(round::CYLINDER, local),
            Self::Cone { slope } => cone::classify(*slope, local),
            Self::Torus { minor } => torus::classify(*minor, local),
            Self::Quadric(form) => quadric::classify(*form, local),
            Self::Polynomial(polynomial) => polynomial::classify(polynomial, local),
            Self::Superellipsoid { exponents } => superellipsoid::classify(*exponents, local),
            Self::Extrusion(contour) => extrusion::classify(contour, local),
            Self::Revolution(contour) => revolution::classify(contour, local),
        }
    }

    /// A vector towards the positive side, normal to the surface; of any length, 0 where there is
    /// no normal.
    fn gradient(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Sphere => p,
            Self::Cylinder => p * round::CYLINDER,
            Self::Cone { slope } => cone::gradient(*slope, p),
            Self::Torus { .. } => torus::gradient(p),
            Self::Quadric(form) => quadric::gradient(*form, p),
            Self::Polynomial(polynomial) => polynomial::gradient(polynomial, p),
            Self::Superellipsoid { exponents } => superellipsoid::gradient(*exponents, p),
            Self::Extrusion(contour) => extrusion::gradient(contour, p),
            Self::Revolution(contour) => revolution::gradient(contour, p),
        }
    }

    fn cost(&self) -> f64 {
        match self {
            Self::Sphere | Self::Cylinder => 2.0,
            Self::Cone { .. } | Self::Quadric(_) => 3.0,
            Self::Torus { .. } => 5.0,
            Self::Polynomial(_) => 20.0,
            Self::Superellipsoid { .. } => 40.0,
            Self::Extrusion(contour) => 2.0 + 2.0 * contour.curves().len() as f64,
            Self::Revolution(contour) => 5.0 + 5.0 * contour.curves().len() as f64,
        }
    }
}

/// A gradient in the local frame as a unit normal in the scene's.
fn pull_back(local_from_scene: &DAffine3, gradient: DVec3) -> DVec3 {
    let m = local_from_scene.matrix3;
    let normal = m.transpose() * gradient;
    // Scaled first: entries of a huge or tiny object's matrix would overflow when squared.
    let largest = normal.abs().max_element();
    (normal / largest)
        .try_normalize()
        .unwrap_or_else(|| (m.transpose() * DVec3::Z).normalize_or(DVec3::Z))
}
