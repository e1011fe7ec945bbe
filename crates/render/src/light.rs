//! What arrives from a lamp at a point, if nothing is in the way.

use octray_math::DVec3;
use octray_scene::{Falloff, Light, LightKind};

/// Light from one lamp at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit direction to the lamp.
    pub direction: DVec3,
    /// From the point to the lamp where the lamp has a position: a shadow ray has `t_max` 1.
    /// The unit direction where it has none: a shadow ray has no end.
    pub to_light: DVec3,
    /// Whether `to_light` ends at the lamp.
    pub is_finite: bool,
    /// Colour after falloff and cone: what a surface facing the lamp receives.
    pub color: DVec3,
}

/// What `light` sends to `point`; `None` where it sends nothing.
#[must_use]
pub fn illuminate(light: &Light, point: DVec3) -> Option<Illumination> {
    let (to_light, is_finite) = match light.kind {
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            (position - point, true)
        }
        LightKind::Directional { direction } => (-direction, false),
    };
    let distance = to_light.length();
    let direction = to_light / distance;
    if !direction.is_finite() {
        return None;
    }
    let color = light.color * (cone(light, -direction) * falloff(light, distance));
    (color != DVec3::ZERO).then_some(Illumination {
        direction,
        to_light: if is_finite { to_light } else { direction },
        is_finite,
        color,
    })
}

/// The spot's weakening off its axis, in `[0, 1]`; `away` is the unit direction from the lamp.
fn cone(light: &Light, away: DVec3) -> f64 {
    let LightKind::Spot {
        direction,
        inner,
        outer,
        tightness,
        ..
    } = light.kind
    else {
        return 1.0;
    };
    let cos = away.dot(direction.normalize_or_zero());
    let (cos_inner, cos_outer) = (libm::cos(inner), libm::cos(outer));
    let edge = if cos >= cos_inner {
        1.0
    } else if cos <= cos_outer {
        return 0.0;
    } else {
        let s = (cos - cos_outer) / (cos_inner - cos_outer);
        s * s * (3.0 - 2.0 * s)
    };
    if tightness == 0.0 {
        edge
    } else {
        edge * libm::pow(cos.max(0.0), tightness)
    }
}

fn falloff(light: &Light, distance: f64) -> f64 {
    // A light from infinitely far has no distance to weaken with.
    if matches!(light.kind, LightKind::Directional { .. }) {
        return 1.0;
    }
    match light.falloff {
        Falloff::None => 1.0,
        Falloff::InverseSquare => 1.0 / (distance * distance),
        Falloff::Fade {
            distance: nominal,
            power,
        } => 2.0 / (1.0 + libm::pow(distance / nominal, power)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: DVec3 = DVec3::ONE;

    fn color_at(light: &Light, point: DVec3) -> f64 {
        illuminate(light, point).map_or(0.0, |i| i.color.x)
    }

    #[test]
    fn falloffs_follow_their_formulas() {
        let mut light = Light::point(DVec3::new(0.0, 0.0, 3.0), WHITE * 8.0);
        assert_eq!(color_at(&light, DVec3::ZERO), 8.0);
        light.falloff = Falloff::InverseSquare;
        assert!((color_at(&light, DVec3::ZERO) - 8.0 / 9.0).abs() < 1e-15);
        light.falloff = Falloff::Fade {
            distance: 3.0,
            power: 2.0,
        };
        assert_eq!(color_at(&light, DVec3::ZERO), 8.0);
        light.falloff = Falloff::Fade {
            distance: 1.0,
            power: 2.0,
        };
        assert!((color_at(&light, DVec3::ZERO) - 1.6).abs() < 1e-15);
    }

    #[test]
    fn a_spot_is_full_inside_nothing_outside_and_half_between() {
        let (inner, outer) = (20.0_f64.to_radians(), 40.0_f64.to_radians());
        let spot = Light::new(
            LightKind::Spot {
                position: DVec3::ZERO,
                direction: DVec3::X,
                inner,
                outer,
                tightness: 0.0,
            },
            WHITE,
        );
        let at = |angle: f64| color_at(&spot, DVec3::new(angle.cos(), angle.sin(), 0.0) * 5.0);
        assert_eq!(at(0.0), 1.0);
        assert_eq!(at(19.9_f64.to_radians()), 1.0);
        assert_eq!(at(40.1_f64.to_radians()), 0.0);
        let middle = f64::midpoint(inner.cos(), outer.cos()).acos();
        assert!((at(middle) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn tightness_is_a_power_of_the_cosine() {
        let spot = Light::new(
            LightKind::Spot {
                position: DVec3::ZERO,
                direction: DVec3::X,
                inner: 1.0,
                outer: 1.2,
                tightness: 10.0,
            },
            WHITE,
        );
        let got = color_at(&spot, DVec3::new(0.5_f64.cos(), 0.5_f64.sin(), 0.0));
        assert!((got - 0.5_f64.cos().powi(10)).abs() < 1e-12);
    }

    #[test]
    fn a_point_in_the_lamp_gets_nothing_rather_than_nan() {
        assert_eq!(
            illuminate(&Light::point(DVec3::ONE, WHITE), DVec3::ONE),
            None
        );
    }

    #[test]
    fn directional_light_comes_from_where_it_does_not_go() {
        let sun = Light::directional(DVec3::NEG_Z, WHITE);
        let got = illuminate(&sun, DVec3::new(1.0, 2.0, 3.0)).expect("light");
        assert_eq!((got.direction, got.is_finite), (DVec3::Z, false));
    }
}
