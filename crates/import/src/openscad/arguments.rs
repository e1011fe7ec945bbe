//! The arguments of one statement: by name, by position, with OpenSCAD's defaults.

use octray_math::DVec3;

use crate::{Diagnostics, Span};

use super::facets::Resolution;
use super::syntax::{Argument, Statement, Value};

/// Gives out the arguments of a statement and reports those that nobody can use.
pub(super) struct Arguments<'s> {
    module: &'s str,
    span: Span,
    bound: Vec<(&'s str, &'s Argument<'s>)>,
}

impl<'s> Arguments<'s> {
    /// Binds arguments to `positional` in order or by name, to `named` by name only; names that
    /// begin with `$` are always allowed. The last one of a name counts, as in OpenSCAD.
    pub(super) fn bind(
        statement: &'s Statement<'s>,
        positional: &[&'s str],
        named: &[&'s str],
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut bound: Vec<(&str, &Argument<'_>)> = Vec::new();
        let mut free = positional.iter();
        for argument in &statement.arguments {
            let name = match argument.name {
                Some(name) => positional
                    .iter()
                    .chain(named)
                    .copied()
                    .find(|known| *known == name)
                    .or(name.starts_with('$').then_some(name)),
                None => free.next().copied(),
            };
            match name {
                Some(name) => {
                    bound.retain(|(other, _)| *other != name);
                    bound.push((name, argument));
                }
                None => {
                    let what = match argument.name {
                        Some(name) => format!("no parameter `{name}`"),
                        None => format!("only {} parameters without name", positional.len()),
                    };
                    let message = format!("`{}` has {what}; it is ignored", statement.name);
                    diagnostics.warning(argument.span, message);
                }
            }
        }
        Self {
            module: statement.name,
            span: statement.span,
            bound,
        }
    }

    /// The statement these are the arguments of.
    pub(super) const fn span(&self) -> Span {
        self.span
    }

    /// The argument of this name, unless it is missing or `undef`.
    pub(super) fn get(&self, name: &str) -> Option<&'s Argument<'s>> {
        self.bound
            .iter()
            .find(|(bound, _)| *bound == name)
            .map(|(_, argument)| *argument)
            .filter(|argument| argument.value != Value::Undefined)
    }

    fn wrong(
        &self,
        argument: &Argument<'_>,
        name: &str,
        needs: &str,
        diagnostics: &mut Diagnostics,
    ) {
        let message = format!(
            "`{name}` of `{}` must be {needs}, not {}; the default is used",
            self.module,
            argument.value.kind()
        );
        diagnostics.warning(argument.span, message);
    }

    /// A number; a warning if it is something else.
    pub(super) fn number(&self, name: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        let argument = self.get(name)?;
        let number = argument.value.number();
        if number.is_none() {
            self.wrong(argument, name, "a number", diagnostics);
        }
        number
    }

    /// A truth value, `false` by default; a warning if it is something else.
    pub(super) fn boolean(&self, name: &str, diagnostics: &mut Diagnostics) -> bool {
        match self.get(name) {
            None => false,
            Some(Argument {
                value: Value::Boolean(value),
                ..
            }) => *value,
            Some(argument) => {
                self.wrong(argument, name, "true or false", diagnostics);
                false
            }
        }
    }

    /// A radius, given as such or as a diameter, which goes first in OpenSCAD.
    pub(super) fn radius(
        &self,
        radius: &str,
        diameter: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let half = self.number(diameter, diagnostics).map(|d| d / 2.0);
        half.or_else(|| self.number(radius, diagnostics))
    }

    /// Three numbers, or one for all three.
    pub(super) fn size(&self, name: &str, diagnostics: &mut Diagnostics) -> Option<DVec3> {
        let argument = self.get(name)?;
        if let Some(number) = argument.value.number() {
            return Some(DVec3::splat(number));
        }
        match argument.value.numbers().as_deref() {
            Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
            _ => {
                self.wrong(argument, name, "a number or three", diagnostics);
                None
            }
        }
    }

    /// `$fn`, `$fa` and `$fs`, with OpenSCAD's defaults.
    pub(super) fn resolution(&self, diagnostics: &mut Diagnostics) -> Resolution {
        Resolution {
            count: self.number("$fn", diagnostics).unwrap_or(0.0),
            angle: self.number("$fa", diagnostics).unwrap_or(12.0),
            size: self.number("$fs", diagnostics).unwrap_or(2.0),
        }
    }
}
