//! The statements of a scene.

use std::rc::Rc;

use octray_math::DVec3;
use octray_scene::{Encoding, Pigment};

use super::camera::CameraState;
use super::lexer::{Kind, Token};
use super::object::{OBJECTS, ObjectDef};
use super::reader::{Parsed, Reader};
use super::value::Value;
use crate::Span;

/// What the statements of a scene have made.
#[derive(Debug, Default)]
pub(super) struct Collected {
    pub(super) objects: Vec<Rc<ObjectDef>>,
    pub(super) camera: Option<(CameraState, Span)>,
    pub(super) background: DVec3,
    /// Of a sky sphere, the lowest first.
    pub(super) sky: Vec<Pigment>,
    pub(super) assumed_gamma: Option<Encoding>,
    pub(super) ambient_light: Option<DVec3>,
    pub(super) max_trace_level: Option<f64>,
    pub(super) adc_bailout: Option<f64>,
    /// A version of 3.7 or later was in force at some time.
    pub(super) modern: bool,
}

impl Reader<'_> {
    /// Reads statements to the end of the scene; goes on behind those that are wrong.
    pub(super) fn statements(&mut self) {
        loop {
            let token = self.peek();
            self.scene.modern |= self.version >= 3.7;
            if token.kind == Kind::End {
                return;
            }
            if self.statement().is_err() {
                self.resynchronise();
            }
        }
    }

    /// Takes tokens to the end of the statement that went wrong.
    fn resynchronise(&mut self) {
        self.hold = 0;
        self.raw_names = false;
        loop {
            let token: Token = self.peek();
            if token.kind == Kind::End {
                break;
            }
            let closes = token.is("}") && self.braces <= 1;
            let begins = self.braces == 0
                && token
                    .word()
                    .is_some_and(|word| super::STATEMENTS.contains(&&**word));
            if begins {
                break;
            }
            self.next();
            if closes {
                break;
            }
        }
        self.braces = 0;
    }

    /// An object of the top level goes into the scene at once where its look is known, so that what
    /// was written about it takes no memory any more. One that takes over the default texture has to
    /// wait for the last `#default`, and so have all behind it, to keep their order.
    fn add(&mut self, object: Rc<ObjectDef>) {
        if self.scene.objects.is_empty() && object.has_its_look() {
            std::mem::swap(&mut self.diagnostics, &mut self.lowering.diagnostics);
            self.lowering.add(&object);
            std::mem::swap(&mut self.diagnostics, &mut self.lowering.diagnostics);
        } else {
            self.scene.objects.push(object);
        }
    }

    fn statement(&mut self) -> Parsed<()> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            if token.is(";") || token.is(",") {
                self.next();
                return Ok(());
            }
            let found = token.describe();
            self.next();
            return self.fail(
                token.span,
                format!("expected an object or a statement, found {found}"),
            );
        };
        if OBJECTS.contains(&&*word) {
            if let Some(object) = self.object()? {
                self.add(object);
            }
            return Ok(());
        }
        match &*word {
            "camera" => {
                self.next();
                let camera = self.camera_block()?;
                self.scene.camera = Some((camera, token.span));
                Ok(())
            }
            "global_settings" => {
                self.next();
                self.global_settings()
            }
            "background" => {
                self.next();
                let mut color = DVec3::ZERO;
                self.block("background", |r| {
                    color = r.color()?.rgb;
                    Ok(())
                })?;
                self.scene.background = color;
                Ok(())
            }
            "sky_sphere" => {
                self.next();
                self.scene.sky = self.sky_block()?;
                Ok(())
            }
            other => {
                if let Some(what) = super::ignored(other) {
                    self.next();
                    self.warn(token.span, format!("{what} is not supported"));
                    return self.skip_block();
                }
                let known = self.scopes.get(&word).is_some();
                if !known && super::is_reserved(&word) {
                    self.next();
                    return self.fail(token.span, format!("`{word}` begins no statement"));
                }
                if known || self.partial_includes {
                    return self.stray_value();
                }
                self.next();
                self.undeclared(&word, token.span)
            }
        }
    }

    /// A value between the statements: macros leave them, and they do nothing.
    fn stray_value(&mut self) -> Parsed<()> {
        let token = self.peek();
        match self.rvalue()? {
            Value::Object(_) | Value::Texture(_) | Value::Pigment(_) => {
                let found = token.describe();
                self.fail(
                    token.span,
                    format!("{found} alone is no statement: write `object {{ ... }}`"),
                )
            }
            _ => Ok(()),
        }
    }

    /// `{ pigment{} ... }` behind `sky_sphere`.
    pub(super) fn sky_block(&mut self) -> Parsed<Vec<Pigment>> {
        let mut sky: Vec<Pigment> = Vec::new();
        self.block("sky sphere", |r| {
            if let Some(map) = r.transform_item()? {
                let inverse = map.inverse();
                for pigment in &mut sky {
                    *pigment = pigment.transformed(&inverse);
                }
                return Ok(());
            }
            if r.eat_word("pigment") {
                sky.push(r.pigment(None)?);
                return Ok(());
            }
            if r.eat_word("emission") {
                return r.color().map(drop);
            }
            match r.reference()? {
                Value::Sky(pigments) => sky.extend_from_slice(&pigments),
                Value::Unknown | Value::Ignored(_) => {}
                _ => return r.unexpected("a sky sphere"),
            }
            Ok(())
        })?;
        Ok(sky)
    }

    fn global_settings(&mut self) -> Parsed<()> {
        self.block("global settings", |r| {
            let token = r.peek();
            let Some(word) = token.word().cloned() else {
                return r.unexpected("the global settings");
            };
            r.next();
            match &*word {
                "assumed_gamma" => {
                    if r.eat_word("srgb") {
                        r.scene.assumed_gamma = Some(Encoding::Srgb);
                        return Ok(());
                    }
                    let gamma = r.float()?;
                    if !(gamma > 0.0 && gamma.is_finite()) {
                        return r.fail(token.span, "a gamma must be greater than 0");
                    }
                    r.scene.assumed_gamma = Some(if gamma == 1.0 {
                        Encoding::Linear
                    } else {
                        Encoding::Gamma(gamma)
                    });
                }
                "max_trace_level" => r.scene.max_trace_level = Some(r.float()?),
                "adc_bailout" => r.scene.adc_bailout = Some(r.float()?),
                "ambient_light" => r.scene.ambient_light = Some(r.color()?.rgb),
                "radiosity" | "photons" | "subsurface" => {
                    r.warn(token.span, format!("`{word}` is not supported"));
                    r.skip_block()?;
                }
                "max_intersections" | "number_of_waves" | "noise_generator" | "hf_gray_16"
                | "irid_wavelength" | "mm_per_unit" => {
                    if !r.at("}") {
                        r.color()?;
                    }
                }
                "charset" => {
                    r.next();
                }
                _ => {
                    return r.fail(token.span, format!("`{word}` is not a global setting"));
                }
            }
            Ok(())
        })
    }
}
