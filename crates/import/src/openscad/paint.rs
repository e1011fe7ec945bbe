//! Colours and the materials made of them.

use std::collections::BTreeMap;

use octray_math::DVec3;
use octray_scene::{Color, Material, MaterialId, Pigment, SceneBuilder, srgb_to_linear};

use crate::Diagnostics;

use super::arguments::Arguments;
use super::color_names::named_color;
use super::syntax::Value;

/// sRGB and opacity, each in `[0, 1]`; a negative number leaves that channel open.
pub(super) type Rgba = [f64; 4];

/// What `color()` gives when it is called without a colour.
const OPEN: Rgba = [-1.0; 4];

/// Surfaces that nobody coloured: a warm yellow like OpenSCAD's.
const SURFACE: Rgba = [0.96, 0.82, 0.2, 1.0];
/// Surfaces left by something subtracted that nobody coloured: a yellowish green like OpenSCAD's.
const CUT: Rgba = [0.6, 0.78, 0.3, 1.0];

/// The argument of a `color()`; a warning where it is no colour.
pub(super) fn color_argument(arguments: &Arguments<'_>, diagnostics: &mut Diagnostics) -> Rgba {
    let mut color = OPEN;
    let argument = arguments.get("c");
    match argument.map(|argument| &argument.value) {
        None => {}
        Some(Value::Vector(channels)) => {
            let numbers: Option<Vec<f64>> = channels.iter().map(Value::number).collect();
            match numbers.as_deref() {
                Some([r, g, b]) => color = [*r, *g, *b, 1.0],
                Some([r, g, b, a]) => color = [*r, *g, *b, *a],
                _ => {
                    let message = "a colour has 3 or 4 numbers; this one is ignored";
                    diagnostics.warning(argument.map(|a| a.span), message);
                }
            }
        }
        Some(Value::Text(name)) => match named_color(name) {
            Some(known) => color = known,
            None => {
                let message = format!("no colour is called `{name}`; it is ignored");
                diagnostics.warning(argument.map(|a| a.span), message);
            }
        },
        Some(other) => {
            let message = format!("{} is not a colour; it is ignored", other.kind());
            diagnostics.warning(argument.map(|a| a.span), message);
        }
    }
    if let Some(alpha) = arguments.number("alpha", diagnostics) {
        color[3] = alpha;
    }
    if color
        .iter()
        .any(|channel| *channel > 1.0 || channel.is_nan())
    {
        let message = "the numbers of a colour lie between 0 and 1; these are clipped";
        diagnostics.warning(argument.map(|a| a.span), message);
    }
    color.map(|channel| {
        if channel.is_nan() {
            -1.0
        } else {
            channel.clamp(-1.0, 1.0)
        }
    })
}

/// Whether `color()` says everything, so that no `color()` further in counts.
pub(super) fn is_complete(color: &Rgba) -> bool {
    color.iter().all(|channel| *channel >= 0.0)
}

/// The materials of one scene, one per colour.
#[derive(Debug, Default)]
pub(super) struct Palette {
    /// By the bits of the four channels, which are numbers.
    known: BTreeMap<[u64; 4], MaterialId>,
}

impl Palette {
    /// The material of faces without colour.
    pub(super) fn surface(&mut self, builder: &mut SceneBuilder) -> MaterialId {
        self.material(SURFACE, "surface", builder)
    }

    /// The material of faces without colour that a subtraction leaves.
    pub(super) fn cut(&mut self, builder: &mut SceneBuilder) -> MaterialId {
        self.material(CUT, "cut", builder)
    }

    /// The material of a colour; open channels are those of [`Palette::surface`].
    pub(super) fn color(&mut self, color: Rgba, builder: &mut SceneBuilder) -> MaterialId {
        let mut filled = color;
        for (channel, default) in filled.iter_mut().zip(SURFACE) {
            if *channel < 0.0 {
                *channel = default;
            }
        }
        let [r, g, b, a] = filled.map(|channel| (channel * 255.0).round() as u8);
        let name = if a == 255 {
            format!("#{r:02x}{g:02x}{b:02x}")
        } else {
            format!("#{r:02x}{g:02x}{b:02x}{a:02x}")
        };
        self.material(filled, &name, builder)
    }

    fn material(&mut self, color: Rgba, name: &str, builder: &mut SceneBuilder) -> MaterialId {
        let key = color.map(f64::to_bits);
        if let Some(id) = self.known.get(&key) {
            return *id;
        }
        let [r, g, b, alpha] = color;
        let rgb = DVec3::new(r, g, b).map(srgb_to_linear);
        let mut material = Material::matte(name, rgb);
        material.pigment = Pigment::Uniform(Color {
            rgb,
            filter: 0.0,
            transmit: 1.0 - alpha,
        });
        let id = builder.add_material(material);
        self.known.insert(key, id);
        id
    }
}
