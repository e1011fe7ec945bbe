//! The functions of the language that give numbers and vectors.

use octray_math::{DVec3, transform};

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::{Terms, Value};
use crate::Span;

/// Functions of numbers: name and how many.
const NUMERIC: [(&str, usize); 26] = [
    ("abs", 1),
    ("acos", 1),
    ("acosh", 1),
    ("asin", 1),
    ("asinh", 1),
    ("atan", 1),
    ("atan2", 2),
    ("atanh", 1),
    ("ceil", 1),
    ("cos", 1),
    ("cosh", 1),
    ("degrees", 1),
    ("div", 2),
    ("exp", 1),
    ("floor", 1),
    ("int", 1),
    ("ln", 1),
    ("log", 1),
    ("mod", 2),
    ("pow", 2),
    ("radians", 1),
    ("sin", 1),
    ("sinh", 1),
    ("sqrt", 1),
    ("tan", 1),
    ("tanh", 1),
];

/// Functions with arguments of their own kinds.
const OTHER: [&str; 19] = [
    "asc",
    "defined",
    "dimension_size",
    "dimensions",
    "file_exists",
    "max",
    "min",
    "rand",
    "seed",
    "select",
    "strcmp",
    "strlen",
    "val",
    "vaxis_rotate",
    "vcross",
    "vdot",
    "vlength",
    "vnormalize",
    "vrotate",
];

/// Functions that give strings.
const TEXTUAL: [&str; 7] = ["chr", "concat", "str", "strlwr", "strupr", "substr", "vstr"];

pub(super) fn is_text_function(word: &str) -> bool {
    TEXTUAL.contains(&word)
}

pub(super) fn is_function(word: &str) -> bool {
    OTHER.contains(&word) || NUMERIC.iter().any(|(name, _)| *name == word)
}

/// A seeded generator's next number in [0, 1] (POV-Ray's: a linear congruence modulo 2^32).
fn next_random(state: &mut u32) -> f64 {
    *state = state.wrapping_mul(1_812_433_253).wrapping_add(12_345);
    f64::from(*state) / f64::from(u32::MAX)
}

fn numeric(name: &str, a: &[f64]) -> f64 {
    let x = a[0];
    let limited = x.clamp(-1.0, 1.0);
    match name {
        "abs" => x.abs(),
        "acos" => libm::acos(limited),
        "acosh" => libm::acosh(x),
        "asin" => libm::asin(limited),
        "asinh" => libm::asinh(x),
        "atan" => libm::atan(x),
        "atan2" => libm::atan2(x, a[1]),
        "atanh" => libm::atanh(x),
        "ceil" => libm::ceil(x),
        "cos" => libm::cos(x),
        "cosh" => libm::cosh(x),
        "degrees" => x.to_degrees(),
        "div" => libm::trunc(x / a[1]),
        "exp" => libm::exp(x),
        "floor" => libm::floor(x),
        "int" => libm::trunc(x),
        "ln" => libm::log(x),
        "log" => libm::log10(x),
        "mod" => libm::fmod(x, a[1]),
        "pow" => libm::pow(x, a[1]),
        "radians" => x.to_radians(),
        "sin" => libm::sin(x),
        "sinh" => libm::sinh(x),
        "sqrt" => libm::sqrt(x),
        "tan" => libm::tan(x),
        _ => libm::tanh(x),
    }
}

impl Reader<'_> {
    /// `( number, ... )`.
    pub(super) fn function_arguments(&mut self, count: usize, span: Span) -> Parsed<Vec<f64>> {
        self.expect("(")?;
        let mut values = Vec::new();
        while !self.eat(")") {
            if values.len() > count || self.peek().kind == Kind::End {
                break;
            }
            values.push(self.expression()?.v[0]);
            if !self.at(")") {
                self.expect(",")?;
            }
        }
        if values.len() != count {
            let given = values.len();
            let message = format!("this function takes {count} arguments, here are {given}");
            return self.fail(span, message);
        }
        Ok(values)
    }

    /// A built-in function whose name has been read.
    pub(super) fn call(&mut self, name: &str, span: Span) -> Parsed<Terms> {
        if let Some((_, count)) = NUMERIC.iter().find(|(known, _)| *known == name) {
            let arguments = self.function_arguments(*count, span)?;
            let value = numeric(name, &arguments);
            if value.is_nan() && !arguments.iter().any(|a| a.is_nan()) {
                return self.fail(span, format!("`{name}` has no value at {}", arguments[0]));
            }
            return Ok(Terms::number(value));
        }
        match name {
            "defined" => return self.defined(),
            "dimensions" | "dimension_size" => return self.dimensions(name, span),
            _ => {}
        }
        self.expect("(")?;
        let value = match name {
            "asc" => {
                let text = self.text()?;
                let first = text.chars().next().map_or(0, |c| c as u32);
                Terms::number(f64::from(first))
            }
            "strlen" => Terms::number(self.text()?.chars().count() as f64),
            "strcmp" => {
                let a = self.text()?;
                self.expect(",")?;
                let order = a.cmp(&self.text()?);
                Terms::number(f64::from(order as i8))
            }
            "val" => Terms::number(self.text()?.trim().parse().unwrap_or(0.0)),
            "file_exists" => {
                let name = self.text()?;
                let path = self.folder.join(&*name);
                let found = self.files.read(&path, self.max_bytes).is_ok();
                Terms::number(f64::from(u8::from(found)))
            }
            "min" | "max" => {
                let mut best = self.expression()?;
                while self.eat(",") {
                    let other = self.expression()?;
                    best = best.zip(other, if name == "min" { f64::min } else { f64::max });
                }
                best
            }
            "seed" => {
                let start = self.expression()?.v[0];
                self.book(4)?;
                self.random.push(start as i64 as u32);
                Terms::number((self.random.len() - 1) as f64)
            }
            "rand" => {
                let index = self.expression()?.v[0];
                match self.random.get_mut(index as usize) {
                    Some(state) => Terms::number(next_random(state)),
                    None => return self.fail(span, "`rand` needs what `seed` has given"),
                }
            }
            "select" => self.select()?,
            _ => self.vector_function(name)?,
        };
        self.expect(")")?;
        Ok(value)
    }

    /// `select(a, below, zero [, above])`.
    fn select(&mut self) -> Parsed<Terms> {
        let a = self.expression()?.v[0];
        self.expect(",")?;
        let below = self.expression()?;
        self.expect(",")?;
        let zero = self.expression()?;
        let above = if self.eat(",") {
            self.expression()?
        } else {
            zero
        };
        Ok(if a < 0.0 {
            below
        } else if a == 0.0 {
            zero
        } else {
            above
        })
    }

    fn vector_function(&mut self, name: &str) -> Parsed<Terms> {
        let a = self.expression()?.to_vec3();
        let mut second = || -> Parsed<DVec3> {
            self.expect(",")?;
            Ok(self.expression()?.to_vec3())
        };
        Ok(match name {
            "vlength" => Terms::number(a.length()),
            "vnormalize" => Terms::vector(a.normalize_or_zero()),
            "vdot" => Terms::number(a.dot(second()?)),
            "vcross" => Terms::vector(a.cross(second()?)),
            "vrotate" => {
                let turn = transform::rotation_xyz_degrees(second()?);
                Terms::vector(turn.transform_vector3(a))
            }
            _ => {
                let axis = second()?;
                self.expect(",")?;
                let degrees = self.expression()?.v[0];
                if axis.normalize_or_zero() == DVec3::ZERO {
                    return self.fail(self.last, "the axis of `vaxis_rotate` has no length");
                }
                let turn = transform::rotation_degrees(axis, degrees);
                Terms::vector(turn.transform_vector3(a))
            }
        })
    }

    fn defined(&mut self) -> Parsed<Terms> {
        let before = std::mem::replace(&mut self.raw_names, true);
        let result = self.expect("(").and_then(|_| {
            let name = self.new_name()?;
            self.expect(")")?;
            let found = self.scopes.get(&name).is_some();
            Ok(Terms::number(f64::from(u8::from(found))))
        });
        self.raw_names = before;
        result
    }

    fn dimensions(&mut self, name: &str, span: Span) -> Parsed<Terms> {
        self.expect("(")?;
        let Value::Array(array) = self.reference()? else {
            return self.fail(span, format!("`{name}` needs an array"));
        };
        let value = if name == "dimensions" {
            array.sizes.len()
        } else {
            self.expect(",")?;
            let which = self.expression()?.v[0];
            match array.sizes.get((which as usize).wrapping_sub(1)) {
                Some(size) => *size,
                None => return self.fail(span, format!("the array has no dimension {which}")),
            }
        };
        self.expect(")")?;
        Ok(Terms::number(value as f64))
    }
}
