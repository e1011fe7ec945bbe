//! Eigenvalues and eigenvectors of symmetric matrices.

use glam::{DMat3, DVec3};

/// Eigenvalues in increasing order and, as the columns of a rotation, unit eigenvectors of the
/// symmetric matrix whose upper triangle is that of `m`.
///
/// Jacobi's method (Golub & Van Loan, *Matrix Computations*, section 8.5): a diagonal matrix keeps
/// its entries to the bit, and small eigenvalues of a graded matrix keep their digits. Only
/// arithmetic and square roots are used.
#[must_use]
pub fn eigen(m: &DMat3) -> (DVec3, DMat3) {
    let mut a = m.to_cols_array_2d();
    let mut v = DVec3::AXES;
    for (row, column) in [(1, 0), (2, 0), (2, 1)] {
        a[column][row] = a[row][column];
    }
    // Convergence is quadratic: five or six sweeps are usual.
    for _ in 0..60 {
        let mut turned = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a[p][q];
            let (app, aqq) = (a[p][p], a[q][q]);
            if off == 0.0 || !off.is_finite() {
                continue;
            }
            if off.abs() < f64::EPSILON * f64::EPSILON * app.abs().min(aqq.abs()) {
                (a[p][q], a[q][p]) = (0.0, 0.0);
                continue;
            }
            turned = true;
            let theta = (aqq - app) / (2.0 * off);
            let root = (theta * theta + 1.0).sqrt();
            let t = if theta < 0.0 {
                -1.0 / (root - theta)
            } else {
                1.0 / (root + theta)
            };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            (a[p][p], a[q][q]) = (app - t * off, aqq + t * off);
            (a[p][q], a[q][p]) = (0.0, 0.0);
            let r = 3 - p - q;
            let (arp, arq) = (a[r][p], a[r][q]);
            a[r][p] = c * arp - s * arq;
            a[r][q] = s * arp + c * arq;
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
            let (vp, vq) = (v[p], v[q]);
            v[p] = vp * c - vq * s;
            v[q] = vp * s + vq * c;
        }
        if !turned {
            break;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let [i, j, k] = order;
    let (x, y, z) = (v[i], v[j], v[k]);
    // A rotation, not a reflection.
    let z = if x.cross(y).dot(z) < 0.0 { -z } else { z };
    (
        DVec3::new(a[i][i], a[j][j], a[k][k]),
        DMat3::from_cols(x, y, z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    #[test]
    fn a_diagonal_matrix_keeps_its_entries() {
        let (values, axes) = eigen(&DMat3::from_diagonal(DVec3::new(3.0, -0.1, 1e-30)));
        assert_eq!(values, DVec3::new(-0.1, 1e-30, 3.0));
        assert_eq!(
            [axes.x_axis, axes.y_axis, axes.z_axis],
            [DVec3::Y, DVec3::Z, DVec3::X]
        );
    }

    proptest! {
        #[test]
        fn the_parts_make_the_matrix(
            values in (-1.0..1.0f64, prop_oneof![-1.0..1.0f64, -1e-12..1e-12], prop_oneof![-1e3..1e3f64, Just(0.5)]),
            turn in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.1..1.0f64),
        ) {
            let q = DMat3::from_quat(DQuat::from_xyzw(turn.0, turn.1, turn.2, turn.3).normalize());
            let diagonal = DMat3::from_diagonal(DVec3::new(values.0, values.1, values.2));
            let m = q * diagonal * q.transpose();
            let (found, axes) = eigen(&m);
            prop_assert!(found.x <= found.y && found.y <= found.z);
            prop_assert!((axes.determinant() - 1.0).abs() < 1e-14);
            let back = axes * DMat3::from_diagonal(found) * axes.transpose();
            let size = found.abs().max_element();
            let error = (back - m).to_cols_array().iter().fold(0.0, |e: f64, x| e.max(x.abs()));
            prop_assert!(error <= 4e-15 * size, "{}", error);
        }
    }
}
