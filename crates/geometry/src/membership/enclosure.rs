//! Volumes around operands: the bounding approximation of Martinka (1993), section 6.1.

use octray_math::{Aabb, DAffine3, DVec3};

use crate::Primitive;
use crate::csg::Operand;

/// A simple volume that holds an operand's primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Enclosure {
    /// The primitive has no end, or none that is known.
    Everything,
    /// An axis-aligned box.
    Box(Aabb),
    /// A ball.
    Sphere {
        /// Its middle.
        center: DVec3,
        /// Not negative.
        radius: f64,
    },
}

/// What the rounding of a radius may take away.
const ROUNDING: f64 = 1.0 + 1e-12;

impl Enclosure {
    /// The box around an operand, larger by `slack` on every side.
    #[must_use]
    pub fn cuboid(operand: &Operand, slack: f64) -> Self {
        let place = &operand.scene_from_local;
        let bounds = match corners(&operand.primitive) {
            Some(corners) => Aabb::from_points(corners.iter().map(|c| place.transform_point3(*c))),
            None => operand.primitive.bounds().transformed(place),
        };
        if bounds.is_bounded() {
            Self::Box(bounds.inflated(slack))
        } else {
            Self::Everything
        }
    }

    /// A sphere around an operand, its radius larger by `slack`: around the image of the middle of
    /// the primitive's own box, through its farthest corner, or smaller where the shape says so. It
    /// is the smallest one for balls and tori that were not deformed.
    #[must_use]
    pub fn sphere(operand: &Operand, slack: f64) -> Self {
        let place = &operand.scene_from_local;
        let bounds = operand.primitive.bounds();
        if !bounds.is_bounded() || bounds.is_empty() {
            return Self::cuboid(operand, slack);
        }
        let middle = bounds.center();
        let center = place.transform_point3(middle);
        let reach = |points: &[DVec3]| {
            let distance = |p: &DVec3| place.transform_point3(*p).distance(center);
            points.iter().map(distance).fold(0.0, f64::max)
        };
        let radius = match corners(&operand.primitive) {
            Some(corners) => reach(&corners),
            None => {
                let stretched = radius_about(&operand.primitive, &bounds) * stretch(place);
                reach(&bounds.corners()).min(stretched)
            }
        };
        let radius = radius * ROUNDING + slack;
        if center.is_finite() && radius.is_finite() {
            Self::Sphere { center, radius }
        } else {
            Self::Everything
        }
    }

    /// Whether a box has a point in common with the volume. Yes where numbers overflow.
    #[must_use]
    pub fn meets(&self, cell: &Aabb) -> bool {
        match self {
            Self::Everything => true,
            Self::Box(bounds) => bounds.overlaps(cell),
            Self::Sphere { center, radius } => {
                let nearest = center.clamp(cell.min, cell.max);
                let apart = (nearest - *center).length() > *radius * ROUNDING;
                !apart
            }
        }
    }
}

/// The corners of what is made of flat faces.
fn corners(primitive: &Primitive) -> Option<Vec<DVec3>> {
    match primitive {
        Primitive::Convex(polyhedron) => Some(polyhedron.vertices.clone()),
        Primitive::Mesh(mesh) => Some(mesh.used_positions().collect()),
        _ => None,
    }
}

/// The radius of the sphere about the middle of the primitive's box that holds it.
fn radius_about(primitive: &Primitive, bounds: &Aabb) -> f64 {
    match primitive {
        Primitive::Sphere { radius } => *radius,
        Primitive::Torus { major, minor } => major + minor,
        Primitive::Cylinder { radius, z } => libm::hypot(*radius, 0.5 * (z[1] - z[0])),
        Primitive::Cone { radius, z } => libm::hypot(radius[0].max(radius[1]), 0.5 * (z[1] - z[0])),
        _ => 0.5 * bounds.diagonal(),
    }
}

/// How much longer a vector can become, or more; sharp where no angle is changed. (The largest
/// eigenvalue of a symmetric matrix is at most its largest sum of absolute values in a row.)
fn stretch(place: &DAffine3) -> f64 {
    let m = place.matrix3;
    let squared = m.transpose() * m;
    let sums = squared.x_axis.abs() + squared.y_axis.abs() + squared.z_axis.abs();
    libm::sqrt(sums.max_element())
}
