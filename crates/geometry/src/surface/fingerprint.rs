//! Numbers without dimension that agree exactly when two surfaces are the same set of points with
//! the same negative side.

use octray_math::{DAffine3, DMat3, DVec3};

use super::table::{points_upward, upward};
use super::{Canonical, Surface};
use crate::profile::Curve;

/// What surfaces are compared by. Only surfaces of one kind have as many numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fingerprint {
    pub(super) kind: u8,
    pub(super) numbers: Vec<f64>,
}

impl Fingerprint {
    /// Of a surface in a scene of size `1 / scale`.
    pub(super) fn new(surface: &Surface, scale: f64) -> Self {
        let mut numbers = Vec::with_capacity(16);
        let kind = match surface {
            Surface::Plane { normal, offset } => {
                numbers.push(offset * scale);
                numbers.extend(normal.to_array());
                0
            }
            Surface::Curved {
                canonical,
                local_from_scene,
            } => curved(canonical, local_from_scene, scale, &mut numbers),
        };
        Self { kind, numbers }
    }
}

fn curved(
    canonical: &Canonical,
    local_from_scene: &DAffine3,
    scale: f64,
    numbers: &mut Vec<f64>,
) -> u8 {
    let scene_from_local = local_from_scene.inverse();
    let center = scene_from_local.translation * scale;
    let axes = scene_from_local.matrix3 * scale;
    let mut put = |values: &[f64]| numbers.extend(values);
    match canonical {
        Canonical::Sphere => {
            // The ellipsoid's shape, which no rotation before the scaling changes.
            put(&center.to_array());
            put(&stretch(&axes));
            1
        }
        Canonical::Cylinder => {
            // Axis as a line, cross-section seen along it.
            let axis = upward(axes.z_axis.normalize());
            let across = |v: DVec3| v - axis * axis.dot(v);
            put(&across(center).to_array());
            put(&ellipse(across(axes.x_axis), across(axes.y_axis), 1.0));
            put(&axis.to_array());
            2
        }
        Canonical::Cone { slope } => {
            // The cross-section at the point of the axis nearest to the origin, and how it grows
            // from there: the same wherever along the axis the frame stands, on a scale of lengths,
            // and for a frustum that is nearly a cylinder too.
            let along = axes.z_axis;
            let axis = upward(along.normalize());
            let height = -center.dot(along) / along.length_squared();
            let radius = 1.0 + slope * height;
            let growth = slope / along.dot(axis);
            let section = |size: f64| ellipse(axes.x_axis, axes.y_axis, size);
            // Both nappes belong to it: radius and growth are given up to a common sign.
            let size = radius + std::f64::consts::SQRT_2 * growth * axes.x_axis.length();
            let sign = 1.0_f64.copysign(size);
            put(&(center + along * height).to_array());
            put(&section(sign * radius));
            put(&section(sign * growth));
            put(&axis.to_array());
            3
        }
        Canonical::Torus { minor } => {
            put(&center.to_array());
            put(&ellipse(axes.x_axis, axes.y_axis, 1.0));
            put(&upward_vector(axes.z_axis).to_array());
            put(&[*minor]);
            4
        }
        Canonical::Extrusion(contour) => {
            // The axis as a direction, every control point seen along it.
            let axis = axes.z_axis.normalize();
            for p in contour.curves().iter().flat_map(Curve::weighted_points) {
                let at = center + (axes.x_axis * p.x + axes.y_axis * p.y) / p.z;
                put(&(at - axis * axis.dot(at)).to_array());
                put(&[p.z]);
            }
            put(&upward(axis).to_array());
            5
        }
        Canonical::Revolution(contour) => {
            // Every control point as the point of the axis at its height and the ellipse there.
            put(&center.to_array());
            put(&upward(axes.z_axis.normalize()).to_array());
            for p in contour.curves().iter().flat_map(Curve::weighted_points) {
                put(&(center + axes.z_axis * (p.y / p.z)).to_array());
                put(&ellipse(axes.x_axis, axes.y_axis, p.x / p.z));
                put(&[p.z]);
            }
            6
        }
    }
}

/// The symmetric matrix `S` of the polar decomposition `axes = S R`, six numbers: the ellipsoid
/// that `axes` makes of the unit ball, in lengths.
///
/// By Newton's iteration for the rotation (Higham, *Computing the Polar Decomposition*, 1986).
fn stretch(axes: &DMat3) -> [f64; 6] {
    let mut r = *axes;
    for _ in 0..60 {
        let back = r.inverse().transpose();
        // Scaling by the norms takes a uniformly scaled rotation home in one step.
        let norm = |m: &DMat3| {
            (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared())
                .sqrt()
        };
        let gain = (norm(&back) / norm(&r)).sqrt();
        let next = (r * gain + back * (1.0 / gain)) * 0.5;
        if !next.is_finite() {
            break;
        }
        let step = norm(&(next - r));
        r = next;
        if step <= 1e-15 {
            break;
        }
    }
    let s = *axes * r.transpose();
    symmetric(&((s + s.transpose()) * 0.5))
}

/// The symmetric root of `u u' + v v'`, times `size`: the ellipse with the half diameters `u` and
/// `v`, whichever conjugate pair they are, in lengths.
fn ellipse(u: DVec3, v: DVec3, size: f64) -> [f64; 6] {
    let normal = u.cross(v);
    let area = normal.length();
    let normal = normal / area;
    let squares = u.length_squared() + v.length_squared();
    let scale = size / (squares + 2.0 * area).sqrt();
    let plane = |a: DVec3, k: f64| DMat3::from_cols(a * a.x, a * a.y, a * a.z) * k;
    let sum = plane(u, 1.0) + plane(v, 1.0) + DMat3::from_diagonal(DVec3::splat(area))
        - plane(normal, area);
    symmetric(&(sum * scale))
}

fn symmetric(m: &DMat3) -> [f64; 6] {
    [
        m.x_axis.x, m.y_axis.y, m.z_axis.z, m.x_axis.y, m.y_axis.z, m.z_axis.x,
    ]
}

fn upward_vector(v: DVec3) -> DVec3 {
    if points_upward(v.normalize()) { v } else { -v }
}
