//! `light_source { ... }`.

use octray_math::{DAffine3, DVec3};
use octray_scene::{Falloff, Light, LightKind};

use super::object::{Geometry, ObjectDef};
use super::reader::{Parsed, Reader};
use super::value::Value;

/// A light in the frame it was written in.
#[derive(Clone, Debug)]
pub(super) struct LightDef {
    position: DVec3,
    color: DVec3,
    spot: bool,
    parallel: bool,
    point_at: DVec3,
    /// Half angles in degrees.
    radius: f64,
    falloff: f64,
    tightness: f64,
    shadowless: bool,
    fade_distance: f64,
    fade_power: f64,
}

impl Reader<'_> {
    /// What stands in the braces behind `light_source`, up to its modifiers: a name or a place
    /// and a colour.
    pub(super) fn light_head(&mut self) -> Parsed<Option<ObjectDef>> {
        if let Some(word) = self.peek_word()
            && matches!(self.scopes.get(&word), Some(Value::Object(_)))
            && let Value::Object(object) = self.reference()?
        {
            return Ok(Some((*object).clone()));
        }
        let position = self.vector()?;
        self.comma();
        let color = self.color()?.rgb;
        let light = LightDef {
            position,
            color,
            spot: false,
            parallel: false,
            point_at: DVec3::ZERO,
            radius: 30.0,
            falloff: 45.0,
            tightness: 0.0,
            shadowless: false,
            fade_distance: 0.0,
            fade_power: 0.0,
        };
        Ok(Some(ObjectDef::new(Geometry::Light(light), self.last)))
    }

    /// A modifier of a light; `false` where the next word is none.
    pub(super) fn light_item(&mut self, object: &mut ObjectDef) -> Parsed<bool> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            return Ok(false);
        };
        if &*word == "looks_like" {
            self.next();
            let child = self.wrapped_objects("looks_like")?;
            let Geometry::Light(light) = &object.geometry else {
                return Ok(true);
            };
            let place = object.transform * DAffine3::from_translation(light.position);
            for mut child in child {
                child.apply(&place);
                child.no_shadow = true;
                object.companions.push(std::rc::Rc::new(child));
            }
            return Ok(true);
        }
        let Geometry::Light(light) = &mut object.geometry else {
            return Ok(false);
        };
        if !LIGHT_WORDS.contains(&&*word) {
            return Ok(false);
        }
        self.next();
        match &*word {
            "spotlight" => light.spot = true,
            "cylinder" => {
                light.spot = true;
                self.warn(
                    token.span,
                    "cylindrical lights are not supported: a spotlight is taken",
                );
            }
            "parallel" => light.parallel = true,
            "point_at" => light.point_at = self.vector()?,
            "radius" => light.radius = self.float()?,
            "falloff" => light.falloff = self.float()?,
            "tightness" => light.tightness = self.float()?,
            "shadowless" => light.shadowless = true,
            "fade_distance" => light.fade_distance = self.float()?,
            "fade_power" => light.fade_power = self.float()?,
            "area_light" => {
                for _ in 0..2 {
                    self.vector()?;
                    self.comma();
                }
                for _ in 0..2 {
                    self.float()?;
                    self.comma();
                }
                self.warn(
                    token.span,
                    "area lights are not supported: a point light in its middle is taken",
                );
            }
            "adaptive" => {
                self.float()?;
            }
            "jitter" | "circular" | "orient" => {}
            "area_illumination" | "media_attenuation" | "media_interaction" => {
                self.switch_value()?;
            }
            "groups" => {
                self.text()?;
                self.warn(
                    token.span,
                    "light groups are not supported: it shines on everything",
                );
            }
            _ => {
                self.warn(token.span, format!("`{word}` of a light is not supported"));
                self.skip_block()?;
            }
        }
        Ok(true)
    }
}

impl LightDef {
    /// The light in the world; `None` where it has no direction though it needs one.
    pub(super) fn light(&self, world_from_light: &DAffine3) -> Option<Light> {
        let position = world_from_light.transform_point3(self.position);
        let target = world_from_light.transform_point3(self.point_at);
        let direction = (target - position).try_normalize();
        let kind = if self.parallel {
            LightKind::Directional {
                direction: direction?,
            }
        } else if self.spot {
            let outer = self.falloff.clamp(0.0, 180.0).to_radians();
            LightKind::Spot {
                position,
                direction: direction?,
                inner: self.radius.clamp(0.0, 180.0).to_radians().min(outer),
                outer,
                tightness: self.tightness,
            }
        } else {
            LightKind::Point { position }
        };
        let fades = self.fade_distance > 0.0 && self.fade_power > 0.0;
        Some(Light {
            falloff: if fades {
                Falloff::Fade {
                    distance: self.fade_distance,
                    power: self.fade_power,
                }
            } else {
                Falloff::None
            },
            casts_shadows: !self.shadowless,
            makes_highlights: !self.shadowless,
            ..Light::new(kind, self.color)
        })
    }
}

const LIGHT_WORDS: [&str; 20] = [
    "spotlight",
    "cylinder",
    "parallel",
    "point_at",
    "radius",
    "falloff",
    "tightness",
    "shadowless",
    "fade_distance",
    "fade_power",
    "area_light",
    "adaptive",
    "jitter",
    "circular",
    "orient",
    "area_illumination",
    "media_attenuation",
    "media_interaction",
    "groups",
    "projected_through",
];
