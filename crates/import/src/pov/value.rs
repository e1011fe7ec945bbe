//! What an identifier can stand for.

use std::rc::Rc;

use octray_math::{DAffine3, DVec3};
use octray_scene::{Color, Interior, Pigment};

use super::camera::CameraState;
use super::color_map::ColorMap;
use super::finish::SurfaceFinish;
use super::lexer::{Tape, Token};
use super::object::ObjectDef;
use super::texture::Texture;

/// A number, a vector of 2 to 5 numbers, or a colour (five numbers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Terms {
    /// How many of the numbers are meant, 1 to 5.
    pub(super) count: usize,
    /// The numbers; those beyond `count` are 0.
    pub(super) v: [f64; 5],
}

impl Terms {
    pub(super) const fn number(value: f64) -> Self {
        Self {
            count: 1,
            v: [value, 0.0, 0.0, 0.0, 0.0],
        }
    }

    pub(super) const fn vector(v: DVec3) -> Self {
        Self {
            count: 3,
            v: [v.x, v.y, v.z, 0.0, 0.0],
        }
    }

    pub(super) const fn color(c: &Color) -> Self {
        Self {
            count: 5,
            v: [c.rgb.x, c.rgb.y, c.rgb.z, c.filter, c.transmit],
        }
    }

    /// With `count` numbers: a single number is repeated, a vector is filled up with 0.
    pub(super) fn promoted(self, count: usize) -> Self {
        if self.count == 1 && count > 1 {
            let mut v = [0.0; 5];
            v[..count].fill(self.v[0]);
            return Self { count, v };
        }
        Self {
            count: self.count.max(count),
            ..self
        }
    }

    pub(super) fn to_vec3(self) -> DVec3 {
        let v = self.promoted(3).v;
        DVec3::new(v[0], v[1], v[2])
    }

    pub(super) fn to_color(self) -> Color {
        let v = self.promoted(5).v;
        Color {
            rgb: DVec3::new(v[0], v[1], v[2]),
            filter: v[3],
            transmit: v[4],
        }
    }

    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut v = [0.0; 5];
        for (out, value) in v.iter_mut().zip(self.v).take(self.count) {
            *out = f(value);
        }
        Self { v, ..self }
    }

    /// Term by term, after promotion to the longer of both.
    pub(super) fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let count = self.count.max(other.count);
        let (a, b) = (self.promoted(count), other.promoted(count));
        let mut v = [0.0; 5];
        for (out, (x, y)) in v.iter_mut().zip(a.v.into_iter().zip(b.v)).take(count) {
            *out = f(x, y);
        }
        Self { count, v }
    }
}

/// An array of values, of one or more dimensions, in row-major order.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) sizes: Vec<usize>,
    pub(super) items: Vec<Option<Value>>,
    /// How deep arrays are nested in this one, counted from 1.
    pub(super) depth: usize,
}

/// A piece of a source that is read again where its name is used.
#[derive(Clone, Debug)]
pub(super) struct Macro {
    pub(super) parameters: Vec<Rc<str>>,
    pub(super) tape: Tape,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// `function(x, y) { ... }`: an expression that is read again at each call.
#[derive(Clone, Debug)]
pub(super) struct Function {
    pub(super) parameters: Vec<Rc<str>>,
    /// The tokens of the body, closed by [`super::lexer::Kind::End`].
    pub(super) body: Rc<[Token]>,
}

/// The value of an identifier.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Terms(Terms),
    Text(Rc<str>),
    Array(Rc<Array>),
    Object(Rc<ObjectDef>),
    Texture(Rc<Texture>),
    Pigment(Rc<Pigment>),
    Finish(SurfaceFinish),
    Interior(Interior),
    Material(Option<Rc<Texture>>, Option<Interior>),
    ColorMap(Rc<ColorMap>),
    Transform(DAffine3),
    Camera(Box<CameraState>),
    Sky(Rc<Vec<Pigment>>),
    Macro(Rc<Macro>),
    Function(Rc<Function>),
    /// Something that is read and not rendered (a normal, a fog, ...).
    Ignored(&'static str),
    /// What a missing standard include would have declared: whoever uses it is left out.
    Unknown,
}

impl Value {
    /// For messages.
    pub(super) const fn describe(&self) -> &'static str {
        match self {
            Self::Terms(Terms { count: 1, .. }) => "a number",
            Self::Terms(Terms { count: 5, .. }) => "a colour",
            Self::Terms(_) => "a vector",
            Self::Text(_) => "a string",
            Self::Array(_) => "an array",
            Self::Object(_) => "an object",
            Self::Texture(_) => "a texture",
            Self::Pigment(_) => "a pigment",
            Self::Finish(_) => "a finish",
            Self::Interior(_) => "an interior",
            Self::Material(..) => "a material",
            Self::ColorMap(_) => "a colour map",
            Self::Transform(_) => "a transform",
            Self::Camera(_) => "a camera",
            Self::Sky(_) => "a sky sphere",
            Self::Macro(_) => "a macro",
            Self::Function(_) => "a function",
            Self::Ignored(what) => what,
            Self::Unknown => "unknown",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_repeated_and_a_vector_is_filled_with_zeros() {
        assert_eq!(Terms::number(2.0).promoted(3).v, [2.0, 2.0, 2.0, 0.0, 0.0]);
        let v = Terms::vector(DVec3::ONE);
        let sum = v.zip(Terms::color(&Color::rgb(1.0, 2.0, 3.0)), |a, b| a + b);
        assert_eq!((sum.count, sum.v), (5, [2.0, 3.0, 4.0, 0.0, 0.0]));
    }
}
