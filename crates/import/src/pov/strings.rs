//! Strings: literals, names and the functions that make them.

use std::fmt::Write as _;
use std::rc::Rc;

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::Value;

impl Reader<'_> {
    /// A string.
    pub(super) fn text(&mut self) -> Parsed<Rc<str>> {
        let token = self.peek();
        match &token.kind {
            Kind::Text(text) => {
                self.next();
                Ok(Rc::clone(text))
            }
            Kind::Word(word) if super::functions::is_text_function(word) => {
                let word = Rc::clone(word);
                self.next();
                self.nested(|r| r.text_function(&word))
            }
            Kind::Word(_) => match self.reference()? {
                Value::Text(text) => Ok(text),
                Value::Unknown => Ok("".into()),
                other => {
                    let what = other.describe();
                    let found = token.describe();
                    self.fail(
                        token.span,
                        format!("expected a string, but {found} is {what}"),
                    )
                }
            },
            _ => {
                let found = token.describe();
                self.fail(token.span, format!("expected a string, found {found}"))
            }
        }
    }

    fn text_function(&mut self, name: &str) -> Parsed<Rc<str>> {
        let span = self.last;
        self.expect("(")?;
        let mut out = String::new();
        match name {
            "chr" => {
                let code = self.expression()?.v[0] as u32;
                out.push(char::from_u32(code).unwrap_or('?'));
            }
            "concat" => {
                while !self.at(")") {
                    let part = self.text()?;
                    self.book(part.len() as u64)?;
                    out.push_str(&part);
                    if !self.at(")") {
                        self.expect(",")?;
                    }
                }
            }
            "strlwr" => out = self.text()?.to_lowercase(),
            "strupr" => out = self.text()?.to_uppercase(),
            "substr" => {
                let text = self.text()?;
                self.expect(",")?;
                let start = self.expression()?.v[0];
                self.expect(",")?;
                let count = self.expression()?.v[0];
                let length = text.chars().count() as f64;
                if !(start >= 1.0 && count >= 0.0 && start - 1.0 + count <= length) {
                    let message = format!("the string has {length} characters");
                    return self.fail(span, message);
                }
                let rest = text.chars().skip(start as usize - 1);
                out = rest.take(count as usize).collect();
            }
            "str" => {
                let value = self.expression()?.v[0];
                let (width, digits) = self.format_arguments()?;
                out = formatted(value, width, digits);
            }
            _ => {
                let count = self.expression()?.v[0].clamp(1.0, 5.0) as usize;
                self.expect(",")?;
                let vector = self.expression()?.promoted(5);
                self.expect(",")?;
                let between = self.text()?;
                let (width, digits) = self.format_arguments()?;
                for (index, value) in vector.v.iter().take(count).enumerate() {
                    if index > 0 {
                        out.push_str(&between);
                    }
                    out.push_str(&formatted(*value, width, digits));
                }
            }
        }
        self.expect(")")?;
        self.book(out.len() as u64)?;
        Ok(out.into())
    }

    /// `, width, digits`.
    fn format_arguments(&mut self) -> Parsed<(f64, f64)> {
        self.expect(",")?;
        let width = self.expression()?.v[0];
        self.expect(",")?;
        Ok((width, self.expression()?.v[0]))
    }
}

/// As C's `printf("%*.*f")`; a negative width pads with zeros, negative digits mean 6.
fn formatted(value: f64, width: f64, digits: f64) -> String {
    let digits = if digits < 0.0 {
        6
    } else {
        digits.min(40.0) as usize
    };
    let mut out = String::new();
    let places = width.abs().min(200.0) as usize;
    let _ = if width < 0.0 {
        write!(out, "{value:0places$.digits$}")
    } else {
        write!(out, "{value:places$.digits$}")
    };
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_printf_writes_them() {
        assert_eq!(formatted(123.456, 1.0, 0.0), "123");
        assert_eq!(formatted(1.5, 8.0, 3.0), "   1.500");
        assert_eq!(formatted(1.5, -8.0, 3.0), "0001.500");
        assert_eq!(formatted(-2.0, 0.0, -1.0), "-2.000000");
    }
}
