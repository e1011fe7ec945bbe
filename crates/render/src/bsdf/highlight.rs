//! The shiny terms: Phong's and Blinn's highlights and what metal does to their colour.

use octray_math::DVec3;
use octray_scene::Finish;

use super::fresnel::metal_reflectivity;

/// Phong's highlight (1975) plus Blinn's (1977): the share of a light's colour that is seen
/// shining from the surface, before the metallic tint.
///
/// All vectors have unit length; `view` points to the viewer, `light` to the light.
#[must_use]
pub fn highlight(finish: &Finish, normal: DVec3, view: DVec3, light: DVec3) -> f64 {
    let mut amount = 0.0;
    if finish.phong != 0.0 {
        let mirrored = normal * (2.0 * view.dot(normal)) - view;
        let cos = mirrored.dot(light);
        if cos > 0.0 {
            amount += finish.phong * libm::pow(cos, finish.phong_size);
        }
    }
    if finish.specular != 0.0 {
        let half = view + light;
        let length = half.length();
        if length > 0.0 {
            let cos = half.dot(normal) / length;
            if cos > 0.0 {
                amount += finish.specular * libm::pow(cos, 1.0 / finish.roughness);
            }
        }
    }
    amount
}

/// What a highlight or reflection is multiplied by on metal: white where `metallic` is 0 and at
/// grazing angles, the surface's own colour where `metallic` is 1 and the light comes head on.
#[must_use]
pub fn metallic_tint(metallic: f64, rgb: DVec3, cos_incident: f64) -> DVec3 {
    if metallic == 0.0 {
        return DVec3::ONE;
    }
    let own = metallic * (1.0 - metal_reflectivity(cos_incident));
    DVec3::ONE + (rgb - DVec3::ONE) * own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_degrees(angle: f64) -> DVec3 {
        DVec3::new(angle.to_radians().sin(), 0.0, angle.to_radians().cos())
    }

    #[test]
    fn phong_falls_with_the_angle_to_the_mirrored_direction() {
        let finish = Finish {
            phong: 0.8,
            phong_size: 20.0,
            ..Finish::default()
        };
        for off in [0.0_f64, 5.0, 15.0] {
            let got = highlight(&finish, DVec3::Z, at_degrees(-30.0), at_degrees(30.0 + off));
            let expected = 0.8 * off.to_radians().cos().powf(20.0);
            assert!((got - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn blinn_falls_with_half_that_angle() {
        let finish = Finish {
            specular: 0.5,
            roughness: 0.02,
            ..Finish::default()
        };
        for off in [0.0_f64, 5.0, 15.0] {
            let got = highlight(&finish, DVec3::Z, at_degrees(-30.0), at_degrees(30.0 + off));
            let expected = 0.5 * (0.5 * off).to_radians().cos().powf(50.0);
            assert!((got - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn metal_colours_head_on_highlights_only() {
        let gold = DVec3::new(1.0, 0.7, 0.2);
        assert_eq!(metallic_tint(0.0, gold, 1.0), DVec3::ONE);
        assert!((metallic_tint(1.0, gold, 1.0) - gold).length() < 1e-3);
        assert!((metallic_tint(1.0, gold, 0.0) - DVec3::ONE).length() < 1e-6);
    }
}
