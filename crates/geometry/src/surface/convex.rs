//! Surfaces with a convex side: a line is on it in one stretch, which is cheaper to work with than
//! a list of crossings.

use octray_math::Ray;
use octray_math::roots::SignChanges;

use super::{Canonical, Surface, plane, round};

/// Where a line is on the convex side of a surface: between the parameters `enter` and `leave`, which
/// are infinite where the line does not cross the surface. `enter > leave`: nowhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it comes to that side.
    pub enter: f64,
    /// Where it leaves it.
    pub leave: f64,
}

impl Stretch {
    /// No part of a line.
    pub const NOTHING: Self = Self {
        enter: f64::INFINITY,
        leave: f64::NEG_INFINITY,
    };

    /// All of a line.
    pub const ALL: Self = Self {
        enter: f64::NEG_INFINITY,
        leave: f64::INFINITY,
    };
}

impl Surface {
    /// Whether the negative side (or the positive one) is convex and [`Surface::convex_stretch`]
    /// knows it.
    #[must_use]
    pub const fn has_convex_side(&self, negative: bool) -> bool {
        match self {
            Self::Plane { .. } => true,
            Self::Curved { canonical, .. } => {
                negative && matches!(canonical, Canonical::Sphere | Canonical::Cylinder)
            }
        }
    }

    /// Where the line is on a side that is convex, by the very crossings that
    /// [`Surface::crossings`] visits; [`Stretch::NOTHING`] for a side that is not.
    #[must_use]
    #[inline]
    pub fn convex_stretch(&self, negative: bool, ray: &Ray) -> Stretch {
        match self {
            Self::Plane { normal, offset } => {
                let changes = plane::crossings(*normal, *offset, ray);
                let starts_here = changes.starts_negative == negative;
                match (changes.as_slice().first(), starts_here) {
                    (None, true) => Stretch::ALL,
                    (None, false) => Stretch::NOTHING,
                    (Some(&leave), true) => Stretch {
                        leave,
                        ..Stretch::ALL
                    },
                    (Some(&enter), false) => Stretch {
                        enter,
                        ..Stretch::ALL
                    },
                }
            }
            Self::Curved {
                canonical,
                local_from_scene,
            } => {
                let Ray { origin, direction } = ray.transformed(local_from_scene);
                let changes = match canonical {
                    Canonical::Sphere => round::sphere(origin, direction),
                    Canonical::Cylinder => round::cylinder(origin, direction),
                    _ => SignChanges::none(false),
                };
                match (changes.as_slice(), changes.starts_negative) {
                    (&[enter, leave], _) => Stretch { enter, leave },
                    (_, true) => Stretch::ALL,
                    _ => Stretch::NOTHING,
                }
            }
        }
    }
}
