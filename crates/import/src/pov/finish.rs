//! `finish { ... }` and `interior { ... }`.

use octray_math::DVec3;
use octray_scene::{Fade, Finish, Interior, Reflection};

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::Value;

/// A finish, with the index of refraction that old scenes give in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SurfaceFinish {
    pub(super) terms: Finish,
    pub(super) ior: Option<f64>,
}

impl Reader<'_> {
    /// `{ ... }` behind `finish`; `base` is what the words in it change.
    pub(super) fn finish(&mut self, base: SurfaceFinish) -> Parsed<SurfaceFinish> {
        let mut made = base;
        self.block("finish", |r| r.finish_item(&mut made))?;
        Ok(made)
    }

    /// A number, or a colour of which all parts count.
    fn share(&mut self) -> Parsed<DVec3> {
        if self.eat_word("albedo") {
            // Energy-normalised amounts are taken as plain ones.
            self.warn(
                self.last,
                "`albedo` is not supported: the plain amount is taken",
            );
        }
        Ok(self.color()?.rgb)
    }

    fn finish_item(&mut self, made: &mut SurfaceFinish) -> Parsed<()> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            return self.unexpected("a finish");
        };
        let known = FINISH_WORDS.contains(&&*word);
        if known {
            self.next();
        }
        let f = &mut made.terms;
        match &*word {
            "ambient" => f.ambient = self.share()?,
            "emission" => f.emission = self.share()?,
            "diffuse" => {
                if self.eat_word("albedo") {
                    self.warn(
                        token.span,
                        "`albedo` is not supported: the plain amount is taken",
                    );
                }
                f.diffuse = self.float()?;
                if self.at(",") {
                    self.next();
                    self.float()?;
                    self.warn(
                        token.span,
                        "light through a surface from behind is not supported",
                    );
                }
            }
            "brilliance" => f.brilliance = self.float()?,
            "phong" => f.phong = self.amount()?,
            "phong_size" => f.phong_size = self.float()?,
            "specular" => f.specular = self.amount()?,
            "roughness" => {
                let value = self.float()?;
                if value > 0.0 {
                    f.roughness = value;
                } else {
                    self.warn(
                        token.span.to(self.last),
                        "a roughness must be greater than 0",
                    );
                }
            }
            "metallic" => f.metallic = self.optional_number()?,
            "reflection" => {
                f.reflection = if self.at("{") {
                    self.reflection_block()?
                } else {
                    Reflection::constant(self.color()?.rgb)
                }
            }
            "reflection_exponent" | "refraction" => {
                self.float()?;
            }
            "ior" => made.ior = Some(self.float()?),
            "caustics" | "fade_distance" | "fade_power" | "crand" | "dispersion" => {
                self.float()?;
                if &*word == "crand" {
                    self.warn(token.span, "`crand` is not supported");
                }
            }
            "conserve_energy" => f.conserve_energy = self.switch_value()?,
            "irid" | "subsurface" => {
                self.warn(token.span, format!("`{word}` is not supported"));
                self.skip_block()?;
            }
            "use_alpha" => {
                self.switch_value()?;
            }
            _ => match self.reference()? {
                Value::Finish(finish) => *made = finish,
                Value::Unknown | Value::Ignored(_) => {}
                other => {
                    let message = format!("expected a finish, found {}", other.describe());
                    return self.fail(token.span, message);
                }
            },
        }
        Ok(())
    }

    fn amount(&mut self) -> Parsed<f64> {
        if self.eat_word("albedo") {
            self.warn(
                self.last,
                "`albedo` is not supported: the plain amount is taken",
            );
        }
        self.float()
    }

    /// A number that may be left out and is then 1.
    fn optional_number(&mut self) -> Parsed<f64> {
        let token = self.peek();
        let follows = match &token.kind {
            Kind::Number(_) | Kind::Sign("(" | "-") => true,
            Kind::Word(word) => matches!(&**word, "on" | "off" | "yes" | "no"),
            _ => false,
        };
        if follows { self.float() } else { Ok(1.0) }
    }

    /// `{ min, max fresnel on falloff 2 exponent 1 metallic 0.5 }`.
    fn reflection_block(&mut self) -> Parsed<Reflection> {
        let mut colors: Vec<DVec3> = Vec::new();
        let mut made = Reflection::constant(DVec3::ZERO);
        self.block("reflection", |r| {
            let word = r.peek_word();
            match word.as_deref() {
                Some("fresnel") => {
                    r.next();
                    made.fresnel = r.switch_value()?;
                }
                Some("falloff") => {
                    r.next();
                    made.falloff = r.float()?;
                }
                Some("metallic") => {
                    r.next();
                    made.metallic = r.optional_number()?;
                }
                Some("exponent") => {
                    r.next();
                    if r.float()? != 1.0 {
                        r.warn(r.last, "a reflection exponent is not supported");
                    }
                }
                _ if colors.len() < 2 => colors.push(r.color()?.rgb),
                _ => return r.unexpected("a reflection"),
            }
            Ok(())
        })?;
        match colors[..] {
            [] => {}
            // One colour alone: the same from every angle.
            [all] => (made.min, made.max) = (all, all),
            [min, max, ..] => (made.min, made.max) = (min, max),
        }
        // With Fresnel's law a single amount is the most, reached at grazing angles.
        if made.fresnel && colors.len() == 1 {
            made.min = DVec3::ZERO;
        }
        Ok(made)
    }

    /// `{ ... }` behind `interior`.
    pub(super) fn interior(&mut self) -> Parsed<Interior> {
        let mut made = Interior::default();
        // Both numbers must be given for it to mean anything.
        let mut fade = Fade {
            half_distance: 0.0,
            power: 0.0,
            color: DVec3::ZERO,
        };
        self.block("interior", |r| {
            let token = r.peek();
            let word = r.peek_word();
            match word.as_deref() {
                Some("ior") => {
                    r.next();
                    let ior = r.float()?;
                    if ior > 0.0 {
                        made.ior = ior;
                    } else {
                        r.warn(token.span, "an index of refraction must be greater than 0");
                    }
                }
                Some(name @ ("caustics" | "dispersion" | "dispersion_samples")) => {
                    let name = name.to_owned();
                    r.next();
                    r.float()?;
                    r.warn(
                        token.span,
                        format!("`{name}` of an interior is not supported"),
                    );
                }
                Some("fade_distance") => {
                    r.next();
                    fade.half_distance = r.float()?;
                }
                Some("fade_power") => {
                    r.next();
                    fade.power = r.float()?;
                }
                Some("fade_color" | "fade_colour") => {
                    r.next();
                    fade.color = r.color()?.rgb;
                }
                Some("media") => {
                    r.next();
                    r.warn(token.span, "`media` is not supported");
                    r.skip_block()?;
                }
                _ => match r.reference()? {
                    Value::Interior(interior) => {
                        made = interior;
                        fade = interior.fade.unwrap_or(fade);
                    }
                    Value::Unknown | Value::Ignored(_) => {}
                    other => {
                        let message = format!("expected an interior, found {}", other.describe());
                        return r.fail(token.span, message);
                    }
                },
            }
            Ok(())
        })?;
        made.fade = (fade.half_distance > 0.0 && fade.power > 0.0).then_some(fade);
        Ok(made)
    }
}

const FINISH_WORDS: [&str; 22] = [
    "ambient",
    "emission",
    "diffuse",
    "brilliance",
    "phong",
    "phong_size",
    "specular",
    "roughness",
    "metallic",
    "reflection",
    "reflection_exponent",
    "refraction",
    "ior",
    "caustics",
    "fade_distance",
    "fade_power",
    "crand",
    "dispersion",
    "conserve_energy",
    "irid",
    "subsurface",
    "use_alpha",
];
