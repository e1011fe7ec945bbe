//! The transfer curve of sRGB (IEC 61966-2-1).

/// Linear light to the sRGB value; 0 to 0 and 1 to 1, not clipped.
#[must_use]
pub fn srgb_encode(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    }
}

/// The sRGB value to linear light; not clipped.
#[must_use]
pub fn srgb_decode(value: f64) -> f64 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // Mid grey: 18 % and 50 % light, and the 8-bit value 128.
        for (light, value) in [
            (0.0, 0.0),
            (1.0, 1.0),
            (0.18, 0.461_356_129_500_441_64),
            (0.5, 0.735_356_983_052_449_5),
            (0.002, 0.025_84),
        ] {
            assert!((srgb_encode(light) - value).abs() < 1e-12, "{light}");
        }
        assert!((srgb_decode(128.0 / 255.0) - 0.215_860_500_113_899_26).abs() < 1e-12);
    }

    #[test]
    fn the_curves_undo_each_other() {
        for step in 0..=1000 {
            let v = f64::from(step) / 500.0;
            assert!((srgb_encode(srgb_decode(v)) - v).abs() < 1e-6);
        }
    }
}
