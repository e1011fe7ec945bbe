//! Colours: keywords, vectors and declared colours.

use octray_math::DVec3;
use octray_scene::{Color, srgb_to_linear};

use super::reader::{Parsed, Reader};
use super::value::Terms;

/// Words that begin a colour.
pub(super) fn is_color_word(word: &str) -> bool {
    matches!(
        word,
        "color"
            | "colour"
            | "rgb"
            | "rgbf"
            | "rgbt"
            | "rgbft"
            | "srgb"
            | "srgbf"
            | "srgbt"
            | "srgbft"
            | "red"
            | "green"
            | "blue"
            | "filter"
            | "transmit"
    )
}

impl Reader<'_> {
    /// A colour: keywords with numbers, a vector, a declared colour, or an expression of these.
    pub(super) fn color(&mut self) -> Parsed<Color> {
        if !self.eat_word("color") {
            self.eat_word("colour");
        }
        let word = self.peek_word();
        let mut color = match word.as_deref() {
            Some(
                key @ ("rgb" | "rgbf" | "rgbt" | "rgbft" | "srgb" | "srgbf" | "srgbt" | "srgbft"),
            ) => {
                self.next();
                let terms = self.terms()?;
                arranged(key, terms)
            }
            Some("red" | "green" | "blue" | "filter" | "transmit") => Color::default(),
            _ => self.terms()?.to_color(),
        };
        while let Some(word) = self.peek_word() {
            let slot = match &*word {
                "red" => &mut color.rgb.x,
                "green" => &mut color.rgb.y,
                "blue" => &mut color.rgb.z,
                "filter" => &mut color.filter,
                "transmit" => &mut color.transmit,
                _ => break,
            };
            self.next();
            *slot = self.float()?;
        }
        Ok(color)
    }
}

/// The numbers behind `rgb`, `rgbf`, ... as a colour.
fn arranged(key: &str, terms: Terms) -> Color {
    let linear = !key.starts_with('s');
    let key = key.trim_start_matches('s');
    let v = terms.promoted(key.len()).v;
    let mut color = Color::rgb(v[0], v[1], v[2]);
    match key {
        "rgbf" => color.filter = v[3],
        "rgbt" => color.transmit = v[3],
        "rgbft" => (color.filter, color.transmit) = (v[3], v[4]),
        // A declared colour keeps what it lets through.
        _ if terms.count == 5 => (color.filter, color.transmit) = (v[3], v[4]),
        _ => {}
    }
    if !linear {
        color.rgb = DVec3::from_array(color.rgb.to_array().map(srgb_to_linear));
    }
    color
}
