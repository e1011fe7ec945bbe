//! How much light an interface mirrors.

/// The share of unpolarised light that a dielectric interface mirrors (Fresnel's equations).
///
/// `cos_incident` in `[0, 1]`, indices of refraction positive; 1 at total internal reflection.
#[must_use]
pub fn dielectric_reflectance(cos_incident: f64, ior_from: f64, ior_to: f64) -> f64 {
    let cos_i = cos_incident.clamp(0.0, 1.0);
    let eta = ior_from / ior_to;
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    if ior_from == ior_to {
        return 0.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let perpendicular = (ior_from * cos_i - ior_to * cos_t) / (ior_from * cos_i + ior_to * cos_t);
    let parallel = (ior_to * cos_i - ior_from * cos_t) / (ior_to * cos_i + ior_from * cos_t);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// POV-Ray's empirical reflectivity of metals at the angle whose cosine is given: about 0 seen
/// head on, 1 seen grazing. It says how far a metallic highlight keeps the light's colour.
///
/// With `x = acos(cos) / (pi / 2)` it is `0.014567225 / (x - 1.12)^2 - 0.011612903`, clamped to
/// `[0, 1]` (the formula of POV-Ray since version 3.0).
#[must_use]
pub fn metal_reflectivity(cos_incident: f64) -> f64 {
    let x = libm::acos(cos_incident.clamp(-1.0, 1.0)).abs() / std::f64::consts::FRAC_PI_2;
    let d = x - 1.12;
    (0.014_567_225 / (d * d) - 0.011_612_903).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn head_on_it_is_the_squared_ratio_of_the_indices() {
        for (a, b) in [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4)] {
            let r: f64 = (a - b) / (a + b);
            assert!((dielectric_reflectance(1.0, a, b) - r * r).abs() < 1e-15);
        }
    }

    #[test]
    fn at_brewsters_angle_only_one_polarisation_is_mirrored() {
        let (a, b) = (1.0_f64, 1.5_f64);
        let angle = (b / a).atan();
        // tan(i) = b / a: the parallel part vanishes, the other is sin^2(i - t) with t = 90 deg - i.
        let expected = 0.5 * (2.0 * angle - std::f64::consts::FRAC_PI_2).sin().powi(2);
        let got = dielectric_reflectance(angle.cos(), a, b);
        assert!((got - expected).abs() < 1e-15, "{got} {expected}");
    }

    #[test]
    fn beyond_the_critical_angle_everything_is_mirrored() {
        let critical = (1.0_f64 / 1.5).asin();
        assert_eq!(
            dielectric_reflectance((critical + 1e-6).cos(), 1.5, 1.0),
            1.0
        );
        assert!(dielectric_reflectance((critical - 1e-3).cos(), 1.5, 1.0) < 1.0);
        assert_eq!(dielectric_reflectance(0.0, 1.0, 1.5), 1.0);
    }

    #[test]
    fn both_directions_of_one_path_mirror_alike() {
        let (a, b) = (1.0_f64, 1.7_f64);
        for step in 0..90 {
            let i = f64::from(step).to_radians();
            let t = (i.sin() * a / b).asin();
            let there = dielectric_reflectance(i.cos(), a, b);
            let back = dielectric_reflectance(t.cos(), b, a);
            assert!((there - back).abs() < 1e-12);
        }
    }

    #[test]
    fn metal_is_dark_head_on_and_bright_grazing() {
        assert!(metal_reflectivity(1.0) < 1e-3);
        assert!((metal_reflectivity(0.0) - 1.0).abs() < 1e-6);
        // At 45 degrees, x = 1/2: 0.014567225 / 0.62^2 - 0.011612903.
        let at_45 = metal_reflectivity(std::f64::consts::FRAC_1_SQRT_2);
        assert!(
            (at_45 - (0.014_567_225 / (0.62 * 0.62) - 0.011_612_903)).abs() < 1e-12,
            "{at_45}"
        );
    }
}
