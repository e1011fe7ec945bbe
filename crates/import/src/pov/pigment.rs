//! `pigment { ... }`.

use octray_math::{DAffine3, DVec3};
use octray_scene::{Color, Pattern, Pigment};

use super::color_map::ColorMap;
use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::Value;

/// A pattern as it is being read.
enum Chosen {
    Checker,
    Gradient(DVec3),
    /// A pattern that is not rendered; its colours are averaged.
    Flat,
}

#[derive(Default)]
struct State {
    base: Option<Pigment>,
    chosen: Option<Chosen>,
    colors: Vec<Pigment>,
    map: Option<ColorMap>,
    pattern_from_pigment: DAffine3,
}

impl Reader<'_> {
    /// `{ ... }` behind `pigment`; `base` is what the words in it change.
    pub(super) fn pigment(&mut self, base: Option<&Pigment>) -> Parsed<Pigment> {
        let mut state = State {
            base: base.cloned(),
            ..State::default()
        };
        let mut transform = DAffine3::IDENTITY;
        self.block("pigment", |r| {
            if let Some(map) = r.transform_item()? {
                transform = map * transform;
                return Ok(());
            }
            r.pigment_item(&mut state)
        })?;
        let made = state.finish();
        Ok(made.transformed(&transform.inverse()))
    }

    fn pigment_item(&mut self, state: &mut State) -> Parsed<()> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            if matches!(state.chosen, Some(Chosen::Flat)) || matches!(token.kind, Kind::Text(_)) {
                return self.skip_argument();
            }
            state.base = Some(Pigment::Uniform(self.color()?));
            return Ok(());
        };
        match &*word {
            "checker" => {
                self.next();
                state.chosen = Some(Chosen::Checker);
                self.pattern_colors(&mut state.colors, 2)
            }
            "hexagon" | "brick" | "square" | "triangular" | "cubic" | "object" => {
                self.unsupported_pattern(&word);
                state.chosen = Some(Chosen::Flat);
                if &*word == "object" {
                    return self.skip_block();
                }
                self.pattern_colors(&mut state.colors, 6)
            }
            "gradient" => {
                self.next();
                state.chosen = Some(Chosen::Gradient(self.vector()?));
                Ok(())
            }
            "color_map" | "colour_map" | "pigment_map" => {
                self.next();
                state.map = Some(self.color_map()?);
                Ok(())
            }
            "quick_color" | "quick_colour" => {
                self.next();
                self.color().map(drop)
            }
            "pigment" => {
                self.next();
                state.base = Some(self.pigment(None)?);
                Ok(())
            }
            "image_map" | "pigment_pattern" | "image_pattern" | "density_file" | "average"
            | "function" | "slope" | "aoi" | "tiling" => {
                self.unsupported_pattern(&word);
                state.chosen = Some(Chosen::Flat);
                if self.at("{") {
                    self.skip_block()
                } else {
                    Ok(())
                }
            }
            "warp" => {
                self.warn(token.span, "`warp` is not supported");
                self.next();
                self.skip_block()
            }
            "uv_mapping" => {
                self.warn(token.span, "`uv_mapping` of pigments is not supported");
                self.next();
                self.switch_value().map(drop)
            }
            other if PATTERNS.contains(&other) => {
                self.unsupported_pattern(&word);
                state.chosen = Some(Chosen::Flat);
                Ok(())
            }
            other if MODIFIERS.contains(&other) => {
                if !matches!(state.chosen, Some(Chosen::Flat) | None) {
                    self.warn(
                        token.span,
                        format!("`{other}` of a pigment is not supported"),
                    );
                }
                self.next();
                self.skip_argument()
            }
            _ => self.pigment_base(&word, state),
        }
    }

    /// A colour or the name of a pigment.
    fn pigment_base(&mut self, word: &str, state: &mut State) -> Parsed<()> {
        match self.scopes.get(word) {
            Some(Value::Pigment(_) | Value::Unknown | Value::Ignored(_)) => {}
            Some(Value::ColorMap(_)) => return self.unexpected("a pigment"),
            None if self.partial_includes && !super::is_reserved(word) => {}
            _ => {
                state.base = Some(Pigment::Uniform(self.color()?));
                return Ok(());
            }
        }
        state.base = Some(match self.reference()? {
            Value::Pigment(pigment) => (*pigment).clone(),
            _ => Pigment::Uniform(Color::rgb(0.5, 0.5, 0.5)),
        });
        Ok(())
    }

    /// Up to `most` colours or pigments behind the name of a pattern of blocks.
    fn pattern_colors(&mut self, colors: &mut Vec<Pigment>, most: usize) -> Parsed<()> {
        while colors.len() < most {
            self.comma();
            let token = self.peek();
            let is_color = match &token.kind {
                Kind::Sign("<") => true,
                Kind::Word(word) => {
                    super::color::is_color_word(word)
                        || &**word == "pigment"
                        || matches!(
                            self.scopes.get(word),
                            Some(Value::Terms(_) | Value::Pigment(_) | Value::Array(_))
                        )
                }
                _ => false,
            };
            if !is_color {
                return Ok(());
            }
            if self.eat_word("pigment") {
                colors.push(self.pigment(None)?);
            } else if let Some(Value::Pigment(pigment)) =
                token.word().and_then(|word| self.scopes.get(word))
            {
                colors.push((**pigment).clone());
                self.next();
            } else {
                colors.push(Pigment::Uniform(self.color()?));
            }
        }
        Ok(())
    }

    fn unsupported_pattern(&mut self, word: &str) {
        let token = self.next();
        self.warn(
            token.span,
            format!("the pattern `{word}` is not supported: its mean colour is taken"),
        );
    }

    /// The value behind a word that changes nothing here, if there is one.
    fn skip_argument(&mut self) -> Parsed<()> {
        let token = self.peek();
        let is_value = match &token.kind {
            Kind::Number(_) | Kind::Sign("<" | "-" | "(" | "+") => true,
            Kind::Word(word) => {
                matches!(self.scopes.get(word), Some(Value::Terms(_)))
                    || matches!(
                        &**word,
                        "x" | "y" | "z" | "on" | "off" | "yes" | "no" | "pi"
                    )
            }
            Kind::Text(_) => {
                self.next();
                return Ok(());
            }
            _ => false,
        };
        if is_value {
            self.terms()?;
        } else if !matches!(token.kind, Kind::Word(_) | Kind::Sign("}")) {
            return self.unexpected("a pigment");
        }
        Ok(())
    }
}

impl State {
    fn finish(self) -> Pigment {
        let map = |map: Option<ColorMap>| map.unwrap_or_else(ColorMap::gray);
        let pattern = match self.chosen {
            None => {
                let base = self.base.unwrap_or(Pigment::Uniform(Color::default()));
                return match (base, self.map) {
                    // A declared pattern with another map.
                    (
                        Pigment::Pattern {
                            pattern: Pattern::Gradient { axis, .. },
                            pattern_from_world,
                        },
                        Some(map),
                    ) => Pigment::Pattern {
                        pattern: Pattern::Gradient {
                            axis,
                            map: map.stops,
                        },
                        pattern_from_world,
                    },
                    (Pigment::Uniform(_), Some(map)) => Pigment::Uniform(map.mean()),
                    (base, _) => base,
                };
            }
            Some(Chosen::Checker) => {
                let mut colors = self.colors.into_iter();
                let blue = Pigment::Uniform(Color::rgb(0.0, 0.0, 1.0));
                let green = Pigment::Uniform(Color::rgb(0.0, 1.0, 0.0));
                Pattern::Checker(Box::new([
                    colors.next().unwrap_or(blue),
                    colors.next().unwrap_or(green),
                ]))
            }
            Some(Chosen::Gradient(axis)) => Pattern::Gradient {
                axis,
                map: map(self.map).stops,
            },
            Some(Chosen::Flat) => {
                let count = self.colors.len() as f64;
                let mut sum = Color::default();
                for color in self.colors.iter().map(super::color_map::mean) {
                    sum.rgb += color.rgb / count;
                    sum.filter += color.filter / count;
                    sum.transmit += color.transmit / count;
                }
                return Pigment::Uniform(if self.colors.is_empty() {
                    map(self.map).mean()
                } else {
                    sum
                });
            }
        };
        Pigment::Pattern {
            pattern,
            pattern_from_world: self.pattern_from_pigment,
        }
    }
}

/// Patterns that are read and not rendered.
const PATTERNS: [&str; 34] = [
    "agate",
    "boxed",
    "bozo",
    "bumps",
    "cells",
    "crackle",
    "cylindrical",
    "dents",
    "facets",
    "granite",
    "julia",
    "leopard",
    "magnet",
    "mandel",
    "marble",
    "onion",
    "planar",
    "quilted",
    "radial",
    "ripples",
    "spherical",
    "spiral1",
    "spiral2",
    "spotted",
    "waves",
    "wood",
    "wrinkles",
    "proximity",
    "gif",
    "png",
    "jpeg",
    "tga",
    "ppm",
    "pavement",
];

/// Words of patterns with at most one value behind them.
pub(super) const MODIFIERS: [&str; 29] = [
    "turbulence",
    "octaves",
    "omega",
    "lambda",
    "frequency",
    "phase",
    "ramp_wave",
    "sine_wave",
    "triangle_wave",
    "scallop_wave",
    "cubic_wave",
    "poly_wave",
    "noise_generator",
    "control0",
    "control1",
    "agate_turb",
    "brick_size",
    "mortar",
    "form",
    "metric",
    "offset",
    "solid",
    "exponent",
    "map_type",
    "interpolate",
    "once",
    "use_index",
    "use_color",
    "accuracy",
];
