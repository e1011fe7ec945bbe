//! Numbers, vectors and colours: operators, promotion, constants.

use std::rc::Rc;

use octray_math::DVec3;

use super::color::is_color_word;
use super::lexer::{Kind, Token};
use super::operators::{CONDITIONAL, PRODUCT, SUM, apply, level, truth};
use super::reader::{Parsed, Reader};
use super::value::{Terms, Value};

impl Reader<'_> {
    /// An expression with all operators, as between brackets.
    pub(super) fn expression(&mut self) -> Parsed<Terms> {
        self.nested(|r| r.binary(CONDITIONAL, None))
    }

    /// Goes on with an expression whose first operand has been read.
    pub(super) fn continue_expression(&mut self, left: Terms) -> Parsed<Terms> {
        let left = self.postfix(left)?;
        self.binary(CONDITIONAL, Some(left))
    }

    /// A number, vector or colour as an item of an object.
    pub(super) fn terms(&mut self) -> Parsed<Terms> {
        self.nested(|r| r.binary(SUM, None))
    }

    /// A number.
    pub(super) fn float(&mut self) -> Parsed<f64> {
        let start = self.look().span;
        let terms = self.terms()?;
        if terms.count != 1 {
            let count = terms.count;
            let message = format!("expected a number, found a vector of {count}");
            return self.fail(start.to(self.last), message);
        }
        Ok(terms.v[0])
    }

    /// A vector of three; a number is repeated.
    pub(super) fn vector(&mut self) -> Parsed<DVec3> {
        Ok(self.terms()?.to_vec3())
    }

    /// An optional truth value behind a keyword: `on`, `off`, a number; alone it means yes.
    pub(super) fn switch_value(&mut self) -> Parsed<bool> {
        let follows = match &self.look().kind {
            Kind::Number(_) => true,
            Kind::Word(word) => matches!(&**word, "on" | "off" | "yes" | "no" | "true" | "false"),
            _ => false,
        };
        Ok(!follows || self.float()? != 0.0)
    }

    fn binary(&mut self, lowest: u8, left: Option<Terms>) -> Parsed<Terms> {
        let mut left = match left {
            Some(left) => left,
            None => self.unary()?,
        };
        loop {
            let Kind::Sign(sign) = self.look().kind else {
                return Ok(left);
            };
            let Some(level) = level(sign).filter(|level| *level >= lowest) else {
                return Ok(left);
            };
            let token = self.next();
            if level == CONDITIONAL {
                let yes = self.expression()?;
                self.expect(":")?;
                let no = self.expression()?;
                left = if left.v[0] == 0.0 { no } else { yes };
                continue;
            }
            let right = self.binary(level + 1, None)?;
            if sign == "/" && right.v[..right.count].contains(&0.0) {
                return self.fail(token.span, "division by zero");
            }
            left = apply(sign, left, right);
        }
    }

    fn unary(&mut self) -> Parsed<Terms> {
        match self.look().kind {
            Kind::Sign("-") => {
                self.next();
                let operand = self.nested(|r| {
                    let operand = r.unary()?;
                    // `-2^2` is -4.
                    r.binary(PRODUCT + 1, Some(operand))
                })?;
                Ok(operand.map(|x| -x))
            }
            Kind::Sign("+") => {
                self.next();
                self.nested(Self::unary)
            }
            Kind::Sign("!") => {
                self.next();
                let operand = self.nested(Self::unary)?;
                Ok(Terms::number(truth(operand.v[0] == 0.0)))
            }
            _ => {
                let value = self.primary()?;
                self.postfix(value)
            }
        }
    }

    /// `.x`, `.red`, ... behind a value.
    fn postfix(&mut self, mut value: Terms) -> Parsed<Terms> {
        while self.at(".") {
            self.next();
            let token = self.next();
            let Some(name) = token.word() else {
                return self.fail(token.span, "expected the name of a component after `.`");
            };
            let index = match &**name {
                "x" | "u" | "red" => 0,
                "y" | "v" | "green" => 1,
                "z" | "blue" => 2,
                "t" | "filter" => 3,
                "transmit" => 4,
                "gray" | "grey" => {
                    let c = value.to_vec3();
                    value = Terms::number(0.297 * c.x + 0.589 * c.y + 0.114 * c.z);
                    continue;
                }
                other => {
                    let message = format!("there is no component `{other}`");
                    return self.fail(token.span, message);
                }
            };
            value = Terms::number(value.promoted(5).v[index]);
        }
        Ok(value)
    }

    fn primary(&mut self) -> Parsed<Terms> {
        if let Kind::Number(value) = self.look().kind {
            self.next();
            return Ok(Terms::number(value));
        }
        let token = self.peek();
        match &token.kind {
            Kind::Sign("(") => {
                self.next();
                let value = self.expression()?;
                self.expect(")")?;
                Ok(value)
            }
            Kind::Sign("<") => self.vector_literal(),
            Kind::Word(word) => self.word_value(&Rc::clone(word), &token),
            _ => {
                let found = token.describe();
                self.fail(token.span, format!("expected a value, found {found}"))
            }
        }
    }

    fn vector_literal(&mut self) -> Parsed<Terms> {
        let open = self.next();
        let mut value = Terms {
            count: 0,
            v: [0.0; 5],
        };
        if let Some(count) = self.plain_vector(&mut value.v) {
            self.next();
            value.count = count;
            return Ok(value);
        }
        value.v = [0.0; 5];
        while !self.eat(">") {
            if value.count == 5 {
                return self.fail(open.span, "a vector has at most 5 components");
            }
            let item = self.float()?;
            value.v[value.count] = item;
            value.count += 1;
            if !self.eat(",") && !self.at(">") && !starts_value(self.look()) {
                return self.expect(">").map(|_| value);
            }
        }
        if value.count < 2 {
            return self.fail(open.span, "a vector has at least 2 components");
        }
        Ok(value)
    }

    fn word_value(&mut self, word: &Rc<str>, token: &Token) -> Parsed<Terms> {
        match self.scopes.get(word) {
            Some(Value::Terms(terms)) => {
                let terms = *terms;
                self.next();
                return Ok(terms);
            }
            Some(Value::Function(function)) => {
                let function = Rc::clone(function);
                self.next();
                let arguments = self.function_arguments(function.parameters.len(), token.span)?;
                return Ok(Terms::number(self.evaluate(&function, &arguments)?));
            }
            Some(_) => return self.reference_value(token),
            None => {}
        }
        if let Some(value) = self.constant(word) {
            self.next();
            return Ok(value);
        }
        if is_color_word(word) {
            return Ok(Terms::color(&self.color()?));
        }
        if super::functions::is_function(word) {
            self.next();
            return self.call(word, token.span);
        }
        if super::KEYWORDS.contains(&&**word) {
            return self.fail(token.span, format!("expected a value, found `{word}`"));
        }
        self.reference_value(token)
    }

    fn reference_value(&mut self, token: &Token) -> Parsed<Terms> {
        match self.reference()? {
            Value::Terms(terms) => Ok(terms),
            Value::Unknown | Value::Ignored(_) => Ok(Terms {
                count: 3,
                v: [0.5, 0.5, 0.5, 0.0, 0.0],
            }),
            other => {
                let what = other.describe();
                let found = token.describe();
                self.fail(
                    token.span,
                    format!("expected a value, but {found} is {what}"),
                )
            }
        }
    }

    fn constant(&mut self, word: &str) -> Option<Terms> {
        let unit = |i: usize, count: usize| {
            let mut v = [0.0; 5];
            v[i] = 1.0;
            Terms { count, v }
        };
        Some(match word {
            "x" => unit(0, 3),
            "y" => unit(1, 3),
            "z" => unit(2, 3),
            "u" => unit(0, 2),
            "v" => unit(1, 2),
            "t" => unit(3, 4),
            "pi" => Terms::number(std::f64::consts::PI),
            "tau" => Terms::number(std::f64::consts::TAU),
            "yes" | "on" | "true" => Terms::number(1.0),
            "no" | "off" | "false" | "clock" | "clock_on" | "clock_delta" => Terms::number(0.0),
            "initial_frame" | "final_frame" | "frame_number" => Terms::number(1.0),
            "initial_clock" | "final_clock" => Terms::number(0.0),
            "version" => Terms::number(self.version),
            "image_width" => {
                self.read_image_size = true;
                Terms::number(super::IMAGE_SIZE.0)
            }
            "image_height" => {
                self.read_image_size = true;
                Terms::number(super::IMAGE_SIZE.1)
            }
            _ => return None,
        })
    }
}

/// Whether an expression may begin with this word though nobody has declared it.
pub(super) fn is_built_in(word: &str) -> bool {
    is_constant(word) || is_color_word(word) || super::functions::is_function(word)
}

fn is_constant(word: &str) -> bool {
    CONSTANTS.contains(&word)
}

const CONSTANTS: [&str; 25] = [
    "x",
    "y",
    "z",
    "u",
    "v",
    "t",
    "pi",
    "tau",
    "yes",
    "on",
    "true",
    "no",
    "off",
    "false",
    "clock",
    "clock_on",
    "clock_delta",
    "initial_frame",
    "final_frame",
    "frame_number",
    "initial_clock",
    "final_clock",
    "version",
    "image_width",
    "image_height",
];

fn starts_value(token: &Token) -> bool {
    match &token.kind {
        Kind::Number(_) | Kind::Word(_) => true,
        Kind::Sign(sign) => matches!(*sign, "(" | "-" | "+" | "!"),
        _ => false,
    }
}
