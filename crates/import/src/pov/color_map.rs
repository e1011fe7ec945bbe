//! `color_map` and `pigment_map`.

use octray_scene::{Color, ColorStop, Pigment};

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::Value;

/// Colours over [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColorMap {
    /// Sorted, at least one.
    pub(super) stops: Vec<ColorStop>,
}

impl ColorMap {
    /// What patterns use that come without a map: black to white.
    pub(super) fn gray() -> Self {
        let stop = |position: f64| ColorStop {
            position,
            color: Color::rgb(position, position, position),
        };
        Self {
            stops: vec![stop(0.0), stop(1.0)],
        }
    }

    /// The mean colour over [0, 1], exactly: colours are linear between the stops.
    pub(super) fn mean(&self) -> Color {
        let mut sum = Color::default();
        let mut add = |color: Color, width: f64| {
            sum.rgb += color.rgb * width;
            sum.filter += color.filter * width;
            sum.transmit += color.transmit * width;
        };
        if let (Some(first), Some(last)) = (self.stops.first(), self.stops.last()) {
            add(first.color, first.position);
            add(last.color, 1.0 - last.position);
        }
        for pair in self.stops.windows(2) {
            let width = pair[1].position - pair[0].position;
            add(pair[0].color.lerp(&pair[1].color, 0.5), width);
        }
        sum
    }
}

impl Reader<'_> {
    /// `{ [0.0 color] [0.1, 0.5 color color] ... }`, or a name in the braces.
    pub(super) fn color_map(&mut self) -> Parsed<ColorMap> {
        let start = self.last;
        let mut stops: Vec<ColorStop> = Vec::new();
        self.block("colour map", |r| {
            if r.at("[") {
                return r.map_entry(&mut stops);
            }
            let token = r.peek();
            match r.reference()? {
                Value::ColorMap(map) => stops.extend_from_slice(&map.stops),
                Value::Unknown => stops.extend(ColorMap::gray().stops),
                other => {
                    let message = format!("expected a colour map, found {}", other.describe());
                    return r.fail(token.span, message);
                }
            }
            Ok(())
        })?;
        if stops.is_empty() {
            return self.fail(start.to(self.last), "a colour map needs an entry");
        }
        // Held to order and range, as a map is looked up from below.
        let mut lowest = 0.0;
        for stop in &mut stops {
            stop.position = stop.position.clamp(lowest, 1.0);
            lowest = stop.position;
        }
        Ok(ColorMap { stops })
    }

    fn map_entry(&mut self, stops: &mut Vec<ColorStop>) -> Parsed<()> {
        self.book(64)?;
        self.expect("[")?;
        let position = self.float()?;
        if position.is_nan() {
            return self.fail(self.last, "a position in a map must be a number");
        }
        self.comma();
        // The old form gives an interval and a colour for each of its ends.
        if let Kind::Number(end) = self.peek().kind {
            self.next();
            self.comma();
            for position in [position, end] {
                let color = self.map_color()?;
                stops.push(ColorStop { position, color });
                self.comma();
            }
        } else {
            let color = self.map_color()?;
            stops.push(ColorStop { position, color });
        }
        self.expect("]").map(drop)
    }

    /// A colour, or a pigment, of which the mean colour is taken.
    fn map_color(&mut self) -> Parsed<Color> {
        let token = self.peek();
        let pigment = match token.word().and_then(|word| self.scopes.get(word)) {
            Some(Value::Pigment(pigment)) => {
                let pigment = std::rc::Rc::clone(pigment);
                self.next();
                pigment
            }
            _ if token.word().is_some_and(|word| &**word == "pigment") => {
                self.next();
                std::rc::Rc::new(self.pigment(None)?)
            }
            _ => return self.color(),
        };
        if !matches!(*pigment, Pigment::Uniform(_)) {
            self.warn(
                token.span,
                "a pattern in a pigment map is not supported: its mean colour is taken",
            );
        }
        Ok(mean(&pigment))
    }
}

/// The mean colour of a pigment.
pub(super) fn mean(pigment: &Pigment) -> Color {
    use octray_scene::Pattern;
    match pigment {
        Pigment::Uniform(color) => *color,
        Pigment::Pattern { pattern, .. } => match pattern {
            Pattern::Checker(pair) => mean(&pair[0]).lerp(&mean(&pair[1]), 0.5),
            Pattern::Gradient { map, .. } => ColorMap { stops: map.clone() }.mean(),
        },
    }
}

#[cfg(test)]
mod tests {
    use octray_math::DVec3;

    use super::*;

    #[test]
    fn the_mean_is_the_integral() {
        let stop = |position: f64, value: f64| ColorStop {
            position,
            color: Color::rgb(value, 0.0, 0.0),
        };
        let map = ColorMap {
            stops: vec![stop(0.25, 1.0), stop(0.75, 0.0)],
        };
        // 0.25 at 1, then a ramp of width 0.5 with mean 0.5, then 0.
        assert_eq!(map.mean().rgb, DVec3::new(0.5, 0.0, 0.0));
        assert_eq!(ColorMap::gray().mean().rgb, DVec3::splat(0.5));
    }
}
