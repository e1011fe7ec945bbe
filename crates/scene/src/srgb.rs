//! The transfer curve of sRGB (IEC 61966-2-1), one channel at a time.

/// Light from an encoded value; 0 to 0, 1 to 1. Negative values mirror, values above 1 continue.
#[must_use]
pub fn srgb_to_linear(encoded: f64) -> f64 {
    let magnitude = encoded.abs();
    let linear = if magnitude <= 0.040_45 {
        magnitude / 12.92
    } else {
        libm::pow((magnitude + 0.055) / 1.055, 2.4)
    };
    linear.copysign(encoded)
}

/// The encoded value of light: the inverse of [`srgb_to_linear`].
#[must_use]
pub fn linear_to_srgb(linear: f64) -> f64 {
    let magnitude = linear.abs();
    let encoded = if magnitude <= 0.003_130_8 {
        magnitude * 12.92
    } else {
        1.055 * libm::pow(magnitude, 1.0 / 2.4) - 0.055
    };
    encoded.copysign(linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_its_published_values_and_an_inverse() {
        // Mid grey: 18 % and 50 % light, a value of the straight part, and the 8-bit value 128.
        for (light, value) in [
            (0.18, 0.461_356_129_500_441_64),
            (0.5, 0.735_356_983_052_449_5),
            (0.002, 0.025_84),
        ] {
            assert!((linear_to_srgb(light) - value).abs() < 1e-12, "{light}");
        }
        assert!((srgb_to_linear(128.0 / 255.0) - 0.215_860_500_113_899_26).abs() < 1e-12);
        assert_eq!((srgb_to_linear(0.0), srgb_to_linear(1.0)), (0.0, 1.0));
        for code in -300..=300 {
            let encoded = f64::from(code) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(encoded)) - encoded).abs() < 1e-4);
        }
        for code in 0..=255u8 {
            let back = linear_to_srgb(srgb_to_linear(f64::from(code) / 255.0)) * 255.0;
            assert_eq!(back.round() as u8, code);
        }
    }
}
