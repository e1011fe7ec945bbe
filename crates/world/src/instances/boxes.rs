//! Where a copy can be met: its box, with room for everything that rounding does on the way.

use octray_math::{Aabb, DAffine3, DMat3, DVec3};

/// Roundings of one number on the way from the scene's line to a parameter, many times over.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// How far from the origin a line is, where it meets the scene, in sizes of the scene: it begins near
/// its closest approach to the centre.
const REACH: f64 = 16.0;

/// A box around a copy, in the coordinates of the scene, of the prototype's `bounds`.
///
/// The transform of a line into the prototype's coordinates has an error, which the prototype's
/// boundaries seen from the scene are displaced by. The bound of it holds also for transforms that
/// nearly flatten: the entries of the inverse are quotients of sums of products (Cramer's rule), and
/// each sum's error is bounded by the sum of the products' magnitudes.
pub(super) fn copy_box(
    bounds: &Aabb,
    scene_from_prototype: &DAffine3,
    scene_size: f64,
    prototype_largest: f64,
) -> Aabb {
    if bounds.is_empty() {
        return Aabb::EMPTY;
    }
    let matrix = scene_from_prototype.matrix3;
    let reach = REACH * scene_size + scene_from_prototype.translation.abs().max_element();
    let in_prototype = inverse_error(&matrix) * DVec3::splat(reach) + prototype_largest;
    let displaced = magnitudes(&matrix) * in_prototype + reach;
    let margin = displaced * ROUNDINGS;
    let exact = bounds.transformed(scene_from_prototype);
    Aabb::new(exact.min - margin, exact.max + margin)
}

fn magnitudes(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// A bound of the errors of the inverse's entries, in roundings, and of what is multiplied with them.
fn inverse_error(m: &DMat3) -> DMat3 {
    // The cross product with all signs positive.
    let products = |a: DVec3, b: DVec3| {
        let (a, b) = (a.abs(), b.abs());
        DVec3::new(
            a.y * b.z + a.z * b.y,
            a.z * b.x + a.x * b.z,
            a.x * b.y + a.y * b.x,
        )
    };
    // Scaled to columns of about unit length, so that no product leaves the range of numbers.
    let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| {
        let exponent = libm::ilogb(axis.abs().max_element());
        libm::ldexp(1.0, -exponent)
    });
    let [x, y, z] = [
        m.x_axis * scale[0],
        m.y_axis * scale[1],
        m.z_axis * scale[2],
    ];
    let largest_products = [products(y, z), products(z, x), products(x, y)];
    let determinant = z.dot(x.cross(y)).abs();
    let largest_determinant = z.abs().dot(largest_products[2]);
    // Rows of the inverse: |inverse| is at most the products over the determinant.
    let relative = (1.0 + largest_determinant / determinant) / determinant;
    let rows: [DVec3; 3] = std::array::from_fn(|i| largest_products[i] * (relative * scale[i]));
    DMat3::from_cols(rows[0], rows[1], rows[2]).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transform of a point forth and back, in roundings as the box allows for them.
    #[test]
    fn the_margin_covers_the_inverse_of_nearly_flat_transforms() {
        for step in 0..40 {
            let lean = libm::ldexp(1.0, -step);
            let matrix = DMat3::from_cols(
                DVec3::new(1.3, 0.2, -0.7),
                DVec3::new(1.3, 0.2, -0.7) + DVec3::new(0.1, 0.7, 0.3) * lean,
                DVec3::new(-0.4, 0.9, 0.6) * 1e-3,
            );
            let placed = DAffine3::from_mat3(matrix);
            let point = DVec3::new(0.3, -0.9, 0.77);
            let back = matrix * (matrix.inverse() * point);
            let unit = Aabb::from_points([DVec3::ZERO]);
            let margin = copy_box(&unit, &placed, 1.0, 1.0).max;
            let error = (back - point).abs();
            assert!(error.cmple(margin).all(), "step {step}: {error} {margin}");
        }
    }

    #[test]
    fn the_margin_of_a_plain_copy_is_small() {
        let placed = DAffine3::from_rotation_y(0.3) * DAffine3::from_scale(DVec3::splat(1e-3));
        let margin = copy_box(&Aabb::from_points([DVec3::ZERO]), &placed, 1.0, 1.0).max;
        assert!(margin.max_element() < 1e-11, "{margin}");
    }
}
