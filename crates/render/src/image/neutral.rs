use octray_math::DVec3;

/// Khronos' PBR Neutral tone mapper (specification of 2024): keeps colours up to 0.8 - 0.04 but
/// for a small offset that undoes Fresnel's base reflection, compresses what is brighter and
/// lets it fade to white. Linear light in, linear light in `[0, 1]` out for non-negative light.
#[must_use]
pub fn neutral(light: DVec3) -> DVec3 {
    const F90: f64 = 0.04;
    const START: f64 = 0.8 - F90;
    const DESATURATION: f64 = 0.15;
    let lowest = light.min_element();
    let offset = if lowest < 2.0 * F90 {
        lowest - lowest * lowest / (4.0 * F90)
    } else {
        F90
    };
    let color = light - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let whitening = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    let color = color * (compressed / peak);
    color * (1.0 - whitening) + compressed * whitening
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moderate_colours_lose_only_the_offset() {
        // Above 0.08 the offset is 0.04; below, 6.25 x^2 remains of the lowest channel.
        let kept = neutral(DVec3::new(0.5, 0.3, 0.1));
        assert!((kept - DVec3::new(0.46, 0.26, 0.06)).length() < 1e-15);
        let dark = neutral(DVec3::new(0.5, 0.3, 0.04));
        assert!((dark.z - 6.25 * 0.04 * 0.04).abs() < 1e-15);
        assert_eq!(neutral(DVec3::ZERO), DVec3::ZERO);
    }

    #[test]
    fn bright_colours_are_compressed_as_specified() {
        // By hand: offset 0.04, peak 1.96, new peak 1 - 0.0576 / 1.44 = 0.96,
        // g = 1 - 1 / (0.15 * 1.0 + 1), red stays at the new peak.
        let got = neutral(DVec3::new(2.0, 1.0, 0.5));
        let g = 1.0 - 1.0 / 1.15;
        let scaled = DVec3::new(1.96, 0.96, 0.46) * (0.96 / 1.96);
        let expected = scaled * (1.0 - g) + DVec3::splat(0.96 * g);
        assert!((got - expected).length() < 1e-12);
        assert!((got.x - 0.96).abs() < 1e-12);
    }

    #[test]
    fn it_is_continuous_and_stays_below_white() {
        let mut before = 0.0;
        for step in 0..100_000 {
            let v = f64::from(step) * 1e-4;
            let got = neutral(DVec3::splat(v)).x;
            assert!((0.0..1.0).contains(&got) && got >= before && got - before < 2e-4);
            before = got;
        }
    }
}
