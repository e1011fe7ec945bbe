//! Complete elliptic integrals by the arithmetic-geometric mean (Abramowitz and Stegun 17.6).

use std::f64::consts::PI;

/// `K(k)` and `E(k)` for the modulus `k` in `[0, 1)`.
pub(crate) fn complete(k: f64) -> (f64, f64) {
    let (mut a, mut b) = (1.0_f64, (1.0 - k * k).sqrt());
    let (mut sum, mut power) = (0.5 * k * k, 0.5);
    while (a - b).abs() > 1e-15 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
    }
    let first = PI / (2.0 * a);
    (first, first * (1.0 - sum))
}

#[test]
fn integrals_have_their_tabulated_values_and_obey_legendre() {
    let (k, e) = complete(0.5_f64.sqrt());
    assert!((k - 1.854_074_677_301_371_9).abs() < 1e-14);
    assert!((e - 1.350_643_881_047_675_5).abs() < 1e-14);
    for modulus in [0.1, 0.6, 0.95_f64] {
        let (k, e) = complete(modulus);
        let (k1, e1) = complete((1.0 - modulus * modulus).sqrt());
        assert!((e * k1 + e1 * k - k * k1 - PI / 2.0).abs() < 1e-14);
    }
}
