//! The cross product of two vectors in the plane, without rounding.

/// `mantissa * 2^exponent`, wide enough for any product of two floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide {
    /// Zero, or at least 1 in size.
    pub(super) mantissa: f64,
    exponent: i32,
}

/// `ax by - ay bx` with a relative error below 2^-50 and the exact sign, for all finite
/// coordinates: subnormal ones, and those whose products overflow, too. Zero where a coordinate is
/// not finite.
pub(super) fn exact_cross(a: [f64; 2], b: [f64; 2]) -> Wide {
    if ![a[0], a[1], b[0], b[1]].iter().all(|x| x.is_finite()) {
        return Wide::ZERO;
    }
    let (p, p_exponent) = product(a[0], b[1]);
    let (q, q_exponent) = product(a[1], b[0]);
    if q == 0 {
        return Wide::new(p as f64, p_exponent);
    }
    if p == 0 {
        return Wide::new(-(q as f64), q_exponent);
    }
    // Products of normalised mantissas have 105 or 106 bits, so shifted by at most 4 they fit.
    let lead = p_exponent - q_exponent;
    match lead {
        0..=4 => Wide::new(((p << lead) - q) as f64, q_exponent),
        -4..0 => Wide::new((p - (q << -lead)) as f64, p_exponent),
        // At least 8 times as large: what is lost is far behind the last place.
        5.. => Wide::new(p as f64 - libm::scalbn(q as f64, -lead), p_exponent),
        _ => Wide::new(libm::scalbn(p as f64, lead) - q as f64, q_exponent),
    }
}

impl Wide {
    const ZERO: Self = Self {
        mantissa: 0.0,
        exponent: 0,
    };

    fn new(mantissa: f64, exponent: i32) -> Self {
        if mantissa == 0.0 {
            Self::ZERO
        } else {
            Self { mantissa, exponent }
        }
    }

    /// The binary exponent of the value; the lowest number for zero.
    pub(super) fn top(self) -> i32 {
        if self.mantissa == 0.0 {
            i32::MIN
        } else {
            libm::ilogb(self.mantissa) + self.exponent
        }
    }

    /// The value divided by `2^top`.
    pub(super) fn scaled_down(self, top: i32) -> f64 {
        libm::scalbn(self.mantissa, self.exponent.saturating_sub(top))
    }
}

/// The exact product as an integer and a power of two.
fn product(x: f64, y: f64) -> (i128, i32) {
    let (m, i) = decompose(x);
    let (n, j) = decompose(y);
    (i128::from(m) * i128::from(n), i + j)
}

/// A finite float as `integer * 2^exponent`, the integer 0 or with exactly 53 bits.
fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let field = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mut mantissa, mut exponent) = if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, field - 1075)
    };
    if mantissa != 0 {
        let shift = mantissa.leading_zeros() as i32 - 11;
        mantissa <<= shift;
        exponent -= shift;
    }
    (if x < 0.0 { -mantissa } else { mantissa }, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(w: Wide) -> f64 {
        libm::scalbn(w.mantissa, w.exponent)
    }

    #[test]
    fn the_last_bit_decides() {
        let e = f64::EPSILON;
        // (1 + e)(1 - e) - 1 = -e^2, which floats round to 0.
        let cross = exact_cross([1.0 + e, 1.0], [1.0, 1.0 - e]);
        assert_eq!(value(cross), -e * e);
        assert_eq!(value(exact_cross([3.0, 5.0], [6.0, 10.0])), 0.0);
    }

    #[test]
    fn tiny_and_huge_coordinates_keep_their_sign() {
        let tiny = f64::from_bits(1);
        assert!(exact_cross([tiny, 0.0], [0.0, tiny]).mantissa > 0.0);
        assert!(exact_cross([0.0, tiny], [tiny, 0.0]).mantissa < 0.0);
        let huge = f64::MAX;
        assert!(exact_cross([huge, huge], [huge.next_down(), huge]).mantissa > 0.0);
        assert_eq!(exact_cross([f64::NAN, 0.0], [1.0, 1.0]).mantissa, 0.0);
    }

    proptest! {
        #[test]
        fn integers_agree(x in -1i64 << 40..1 << 40, y in -1i64 << 40..1 << 40,
                          u in -1i64 << 40..1 << 40, v in -1i64 << 40..1 << 40) {
            let exact = i128::from(x) * i128::from(v) - i128::from(y) * i128::from(u);
            let cross = exact_cross([x as f64, y as f64], [u as f64, v as f64]);
            let error = (value(cross) - exact as f64).abs();
            prop_assert!(error <= 1e-15 * (exact as f64).abs(), "{cross:?} {exact}");
        }

        #[test]
        fn antisymmetric_for_any_floats(x in any::<f64>(), y in any::<f64>(),
                                        u in any::<f64>(), v in any::<f64>()) {
            let cross = exact_cross([x, y], [u, v]);
            let back = exact_cross([u, v], [x, y]);
            prop_assert_eq!(cross.mantissa, -back.mantissa);
            prop_assert_eq!(cross.top(), back.top());
        }
    }
}
