//! What a dump says, with places, before anything is made of it.

use crate::Span;

/// `name(arguments) { children }` with the marks before it.
#[derive(Debug)]
pub(super) struct Statement<'text> {
    pub(super) modifiers: Modifiers,
    pub(super) name: &'text str,
    /// From the name to the closing parenthesis.
    pub(super) span: Span,
    pub(super) arguments: Vec<Argument<'text>>,
    pub(super) children: Vec<Statement<'text>>,
}

/// The marks before a statement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Modifiers {
    /// `%`
    pub(super) background: bool,
    /// `*`
    pub(super) disable: bool,
    /// `!`
    pub(super) root: bool,
}

/// `name = value` or `value`.
#[derive(Debug)]
pub(super) struct Argument<'text> {
    pub(super) name: Option<&'text str>,
    pub(super) value: Value,
    pub(super) span: Span,
}

/// A value of OpenSCAD's language, as far as dumps hold them.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Undefined,
    Boolean(bool),
    Number(f64),
    Text(String),
    Vector(Vec<Value>),
}

impl Value {
    /// What it is, for messages.
    pub(super) const fn kind(&self) -> &'static str {
        match self {
            Self::Undefined => "undef",
            Self::Boolean(_) => "a boolean",
            Self::Number(_) => "a number",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a vector",
        }
    }

    pub(super) const fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The numbers of a vector of numbers.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Self::Vector(all) => all.iter().map(Self::number).collect(),
            _ => None,
        }
    }
}
