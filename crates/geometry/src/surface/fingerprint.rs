//! Numbers without dimension that agree exactly when two surfaces are the same set of points with
//! the same negative side.

use octray_math::{DAffine3, DMat3, DVec3, hash_combine, symmetric};

use super::table::{SURFACE_TOLERANCE, points_upward, upward};
use super::{Canonical, QuadricForm, Surface};
use crate::profile::Curve;

/// What surfaces are compared by. Only surfaces of one kind have as many numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fingerprint<'a> {
    pub(super) kind: u8,
    pub(super) numbers: &'a [f64],
}

impl<'a> Fingerprint<'a> {
    /// Of a surface in a scene of size `1 / scale`; the numbers are put where there were others.
    pub(super) fn new(surface: &Surface, scale: f64, numbers: &'a mut Vec<f64>) -> Self {
        numbers.clear();
        let kind = match surface {
            Surface::Plane { normal, offset } => {
                numbers.push(offset * scale);
                numbers.extend(normal.to_array());
                0
            }
            Surface::Curved {
                canonical,
                local_from_scene,
            } => curved(canonical, local_from_scene, scale, numbers),
        };
        Self { kind, numbers }
    }
}

/// Many of them, without an allocation for each.
#[derive(Debug, Default)]
pub(super) struct Fingerprints {
    numbers: Vec<f64>,
    /// Where the numbers of each end, and its kind.
    ends: Vec<(u32, u8)>,
}

impl Fingerprints {
    pub(super) fn push(&mut self, fingerprint: Fingerprint<'_>) {
        self.numbers.extend_from_slice(fingerprint.numbers);
        // Surfaces are numbered in 30 bits; those with many numbers are few.
        self.ends
            .push((self.numbers.len() as u32, fingerprint.kind));
    }

    pub(super) fn get(&self, index: usize) -> Fingerprint<'_> {
        let start = index.checked_sub(1).map_or(0, |i| self.ends[i].0);
        let (end, kind) = self.ends[index];
        Fingerprint {
            kind,
            numbers: &self.numbers[start as usize..end as usize],
        }
    }

    pub(super) const fn len(&self) -> usize {
        self.ends.len()
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
        Canonical::Cone { slope } => cone(center, &axes, [1.0, *slope], numbers),
        Canonical::Quadric(form) => quadric(*form, center, &axes, numbers),
        Canonical::Polynomial(polynomial) => {
            // Coefficients mean no lengths: they are the same to the bit or another surface, while
            // the frames may differ.
            put(&center.to_array());
            put(&axes.to_cols_array());
            let hash = polynomial
                .coefficients()
                .iter()
                .fold(0, |hash, c| hash_combine(hash, (c + 0.0).to_bits()));
            put(&[f64::from((hash >> 32) as u32), f64::from(hash as u32)]);
            10
        }
        Canonical::Superellipsoid { exponents } => {
            let (x, y) = ordered(upward_vector(axes.x_axis), upward_vector(axes.y_axis));
            put(&center.to_array());
            put(&x.to_array());
            put(&y.to_array());
            put(&upward_vector(axes.z_axis).to_array());
            put(exponents);
            11
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

/// Of the cone about the frame's z axis whose radius is `radius + slope z`.
///
/// The cross-section at the point of the axis nearest to the origin, and how it grows from there:
/// the same wherever along the axis the frame stands, on a scale of lengths, and for a frustum that
/// is nearly a cylinder too.
fn cone(center: DVec3, axes: &DMat3, [radius, slope]: [f64; 2], numbers: &mut Vec<f64>) -> u8 {
    let along = axes.z_axis;
    let axis = upward(along.normalize());
    let height = -center.dot(along) / along.length_squared();
    let radius = radius + slope * height;
    let growth = slope / along.dot(axis);
    let section = |size: f64| ellipse(axes.x_axis, axes.y_axis, size);
    // Both nappes belong to it: radius and growth are given up to a common sign, that of the radius
    // at a fixed height. (Both are in units of the frame's own radius here.)
    let size = radius + std::f64::consts::SQRT_2 * growth;
    let sign = 1.0_f64.copysign(size);
    numbers.extend((center + along * height).to_array());
    numbers.extend(section(sign * radius));
    numbers.extend(section(sign * growth));
    numbers.extend(axis.to_array());
    3
}

/// Of a quadric in this frame, whichever of the frames in which it has its form: from the half
/// axes, or from the vertex and the curvatures there.
fn quadric(form: QuadricForm, center: DVec3, axes: &DMat3, numbers: &mut Vec<f64>) -> u8 {
    let (squares, ..) = form.coefficients();
    let rows = axes.inverse().transpose();
    let dyad = |v: DVec3, k: f64| DMat3::from_cols(v * v.x, v * v.y, v * v.z) * k;
    let form_matrix = dyad(rows.x_axis, squares.x) + dyad(rows.y_axis, squares.y);
    match form {
        QuadricForm::DoubleCone => {
            // Of the many frames in which it has its form, that of its own axes.
            let (values, own) = symmetric::eigen(&(form_matrix + dyad(rows.z_axis, squares.z)));
            let [z, x, y] = [0, 1, 2].map(|i| own.col(i) / values[i].abs().sqrt());
            cone(center, &DMat3::from_cols(x, y, z), [0.0, 1.0], numbers)
        }
        QuadricForm::OneSheet | QuadricForm::TwoSheets => {
            let axes = half_axes(&(form_matrix + dyad(rows.z_axis, squares.z)));
            numbers.extend(center.to_array());
            numbers.extend(symmetric_entries(&axes));
            // Where the waist is small against the scene, the slopes far away count too.
            numbers.extend(symmetric_entries(&(axes * (1.0 / norm(&axes)))));
            if form == QuadricForm::OneSheet { 5 } else { 6 }
        }
        QuadricForm::HyperbolicCylinder => {
            let free = upward(axes.z_axis.normalize());
            let axes = half_axes(&form_matrix);
            numbers.extend((center - free * free.dot(center)).to_array());
            numbers.extend(symmetric_entries(&axes));
            numbers.extend(symmetric_entries(&(axes * (1.0 / norm(&axes)))));
            numbers.extend(free.to_array());
            7
        }
        QuadricForm::EllipticParaboloid | QuadricForm::HyperbolicParaboloid => {
            let up = axes.z_axis.normalize();
            let steep = rows.z_axis.dot(up);
            let curvatures = form_matrix * (1.0 / steep);
            // Squares completed across the axis give the vertex.
            let tilt = (rows.z_axis - up * steep) / steep;
            let aside = apply(&curvatures, tilt, |k| 0.5 / k);
            let vertex = center + aside - up * (0.5 * tilt.dot(aside));
            numbers.extend(vertex.to_array());
            numbers.extend(symmetric_entries(&function(&curvatures, width)));
            numbers.extend(up.to_array());
            if form == QuadricForm::EllipticParaboloid {
                8
            } else {
                9
            }
        }
        QuadricForm::ParabolicCylinder => {
            let across = rows.x_axis.normalize();
            let sideways = across.dot(rows.z_axis);
            let upright = rows.z_axis - across * sideways;
            let (steep, up) = (upright.length(), upright.normalize());
            let curvature = rows.x_axis.length_squared() / steep;
            let aside = 0.5 * sideways / (steep * curvature);
            let vertex = center + across * aside - up * (0.5 * sideways / steep * aside);
            let in_plane = across * across.dot(vertex) + up * up.dot(vertex);
            numbers.extend(in_plane.to_array());
            numbers.push(width(curvature));
            numbers.extend(upward(across).to_array());
            numbers.extend(up.to_array());
            12
        }
    }
}

/// A measure of a parabola's curvature whose change says how far the curve moves, at most, within
/// the scene's size: proportional to the height above the vertex where it is flat, to the width
/// where it is steep.
fn width(curvature: f64) -> f64 {
    (2.0 - 2.0 / (1.0 + curvature.abs()).sqrt()).copysign(curvature)
}

/// The half axes of the quadric with this matrix, signed, each in its direction: lengths.
fn half_axes(matrix: &DMat3) -> DMat3 {
    // Of an infinite axis, which rounding makes a very long one, nothing.
    let most = norm(matrix) * 1e-14;
    function(matrix, |value| {
        if value.abs() > most {
            (1.0 / value.abs().sqrt()).copysign(value)
        } else {
            0.0
        }
    })
}

/// A function of a symmetric matrix.
fn function(matrix: &DMat3, of: impl Fn(f64) -> f64) -> DMat3 {
    let (values, axes) = symmetric::eigen(matrix);
    let values = DVec3::from_array(values.to_array().map(of));
    axes * DMat3::from_diagonal(values) * axes.transpose()
}

/// `function(matrix) v`, with 0 where the matrix is 0 but for rounding.
fn apply(matrix: &DMat3, v: DVec3, of: impl Fn(f64) -> f64) -> DVec3 {
    let most = norm(matrix) * 1e-14;
    let guarded = |value: f64| if value.abs() > most { of(value) } else { 0.0 };
    function(matrix, guarded) * v
}

/// Square root of the sum of the squared entries.
fn norm(m: &DMat3) -> f64 {
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}

/// The two in an order that does not depend on which was first.
fn ordered(u: DVec3, v: DVec3) -> (DVec3, DVec3) {
    let apart = (u - v)
        .to_array()
        .into_iter()
        .find(|x| x.abs() > SURFACE_TOLERANCE * u.length());
    if apart.is_none_or(|x| x > 0.0) {
        (u, v)
    } else {
        (v, u)
    }
}

/// The symmetric matrix `S` of the polar decomposition `axes = S R`, six numbers: the ellipsoid
/// that `axes` makes of the unit ball, in lengths.
///
/// By Newton's iteration for the rotation (Higham, *Computing the Polar Decomposition*, 1986).
fn stretch(axes: &DMat3) -> [f64; 6] {
    // Most balls are neither turned nor squeezed.
    let size = axes.x_axis.x;
    if size > 0.0 && *axes == DMat3::from_diagonal(DVec3::splat(size)) {
        return [size, size, size, 0.0, 0.0, 0.0];
    }
    let mut r = *axes;
    for _ in 0..60 {
        let back = r.inverse().transpose();
        // Scaling by the norms takes a uniformly scaled rotation home in one step.
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
    symmetric_entries(&((s + s.transpose()) * 0.5))
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
    symmetric_entries(&(sum * scale))
}

fn symmetric_entries(m: &DMat3) -> [f64; 6] {
    [
        m.x_axis.x, m.y_axis.y, m.z_axis.z, m.x_axis.y, m.y_axis.z, m.z_axis.x,
    ]
}

fn upward_vector(v: DVec3) -> DVec3 {
    if points_upward(v.normalize()) { v } else { -v }
}
