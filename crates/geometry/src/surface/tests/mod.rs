//! All surfaces against their implicit functions.

mod classify;
mod crossings;

use octray_math::{DVec2, DVec3};

use super::{Canonical, Surface};

/// The function whose sign is the side, written down independently of the solvers.
pub(crate) fn implicit_value(surface: &Surface, p: DVec3) -> f64 {
    let (canonical, q) = match surface {
        Surface::Plane { normal, offset } => return normal.dot(p) - offset,
        Surface::Curved {
            canonical,
            local_from_scene,
        } => (canonical, local_from_scene.transform_point3(p)),
    };
    match canonical {
        Canonical::Sphere => q.length_squared() - 1.0,
        Canonical::Cylinder => q.x * q.x + q.y * q.y - 1.0,
        Canonical::Cone { slope } => libm::hypot(q.x, q.y) - (1.0 + slope * q.z).abs(),
        Canonical::Torus { minor } => libm::hypot(libm::hypot(q.x, q.y) - 1.0, q.z) - minor,
        Canonical::Extrusion(contour) => outside(contour.contains(q.truncate())),
        Canonical::Revolution(contour) => {
            outside(contour.contains(DVec2::new(q.truncate().length(), q.z)))
        }
    }
}

/// Only the sign means something.
fn outside(inside: bool) -> f64 {
    if inside { -1.0 } else { 1.0 }
}
