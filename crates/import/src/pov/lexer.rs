//! Bytes to tokens.

use std::rc::Rc;

use logos::{Lexer, Logos};

use crate::{Diagnostics, SourceId, Span};

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// A keyword or an identifier: which, depends on the place.
    Word(Rc<str>),
    /// A number.
    Number(f64),
    /// A string, escapes resolved.
    Text(Rc<str>),
    /// An operator or a bracket.
    Sign(&'static str),
    /// `#name`, without the `#`.
    Directive(Rc<str>),
    /// Bytes that begin no token: the message.
    Bad(&'static str),
    /// After the last token.
    End,
}

/// A token and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Span,
}

impl Token {
    pub(super) fn is(&self, sign: &str) -> bool {
        matches!(&self.kind, Kind::Sign(s) if *s == sign)
    }

    pub(super) fn word(&self) -> Option<&Rc<str>> {
        match &self.kind {
            Kind::Word(word) => Some(word),
            _ => None,
        }
    }

    /// For messages: what was found.
    pub(super) fn describe(&self) -> String {
        match &self.kind {
            Kind::Word(word) => format!("`{word}`"),
            Kind::Number(value) => format!("the number {value}"),
            Kind::Text(_) => "a string".to_owned(),
            Kind::Sign(sign) => format!("`{sign}`"),
            Kind::Directive(name) => format!("`#{name}`"),
            Kind::Bad(what) => (*what).to_owned(),
            Kind::End => "the end of the file".to_owned(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Fault {
    #[default]
    Character,
    Comment,
    Text,
}

#[derive(Logos, Clone, Copy, Debug, PartialEq)]
#[logos(error = Fault)]
#[logos(skip r"[ \t\r\n\x0c\u{feff}]+")]
enum Raw {
    #[regex(r"//[^\n]*", logos::skip, allow_greedy = true)]
    LineComment,
    #[token("/*", block_comment)]
    BlockComment,
    #[regex("[A-Za-z_][A-Za-z0-9_]*")]
    Word,
    #[regex(r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")]
    Number,
    #[token("\"", text)]
    Text,
    #[regex(r"#[ \t]*[A-Za-z_]+")]
    Directive,
    #[regex(r"[{}()\[\]<>=!&|+\-*/?:;,.^]")]
    #[token("<=")]
    #[token(">=")]
    #[token("!=")]
    Sign,
}

/// Block comments nest.
fn block_comment(lexer: &mut Lexer<'_, Raw>) -> Result<logos::Skip, Fault> {
    let rest = lexer.remainder().as_bytes();
    let (mut depth, mut at) = (1, 0);
    while at < rest.len() {
        match &rest[at..] {
            [b'*', b'/', ..] => {
                (depth, at) = (depth - 1, at + 2);
                if depth == 0 {
                    lexer.bump(at);
                    return Ok(logos::Skip);
                }
            }
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            _ => at += 1,
        }
    }
    lexer.bump(rest.len());
    Err(Fault::Comment)
}

fn text(lexer: &mut Lexer<'_, Raw>) -> Result<(), Fault> {
    let rest = lexer.remainder().as_bytes();
    let mut at = 0;
    while at < rest.len() {
        match rest[at] {
            b'"' => {
                lexer.bump(at + 1);
                return Ok(());
            }
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    lexer.bump(rest.len());
    Err(Fault::Text)
}

const SIGNS: [&str; 26] = [
    "{", "}", "(", ")", "[", "]", "<", ">", "=", "!", "&", "|", "+", "-", "*", "/", "?", ":", ";",
    ",", ".", "^", "<=", ">=", "!=", "",
];

fn unescape(text: &str) -> Rc<str> {
    if !text.contains('\\') {
        return text.into();
    }
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        out.push(match c {
            '\\' => match chars.next() {
                Some('n') => '\n',
                Some('t') => '\t',
                Some('r') => '\r',
                Some(other) => other,
                None => break,
            },
            other => other,
        });
    }
    out.into()
}

/// All tokens of a source, the last one [`Kind::End`].
pub(super) fn tokens(diagnostics: &Diagnostics, source: SourceId) -> Rc<[Token]> {
    let bytes = diagnostics.source(source);
    // Old scenes have Latin-1 in comments and strings. A question mark keeps the byte offsets.
    let ascii;
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(_) => {
            let plain = bytes
                .iter()
                .map(|&b| if b < 0x80 { b as char } else { '?' });
            ascii = plain.collect::<String>();
            &ascii
        }
    };
    let mut out = Vec::new();
    let mut lexer = Raw::lexer(text);
    while let Some(raw) = lexer.next() {
        let slice = lexer.slice();
        let kind = match raw {
            Ok(Raw::Word) => Kind::Word(slice.into()),
            Ok(Raw::Number) => slice
                .parse()
                .map_or(Kind::Bad("a malformed number"), Kind::Number),
            Ok(Raw::Text) => Kind::Text(unescape(&slice[1..slice.len() - 1])),
            Ok(Raw::Directive) => Kind::Directive(slice[1..].trim_start().into()),
            Ok(Raw::Sign) => SIGNS
                .iter()
                .find(|sign| **sign == slice)
                .map_or(Kind::Bad("an unknown sign"), |sign| Kind::Sign(sign)),
            Ok(Raw::LineComment | Raw::BlockComment) => continue,
            Err(Fault::Comment) => Kind::Bad("a comment that is not closed by `*/`"),
            Err(Fault::Text) => Kind::Bad("a string that is not closed by `\"`"),
            Err(Fault::Character) => Kind::Bad("a character that has no meaning here"),
        };
        out.push(Token {
            kind,
            span: Span::new(source, lexer.span()),
        });
    }
    out.push(Token {
        kind: Kind::End,
        span: Span::new(source, text.len()..text.len()),
    });
    out.into()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn kinds(text: &str) -> Vec<Kind> {
        let mut diagnostics = Diagnostics::default();
        let source = diagnostics.add_source(Path::new("t.pov"), text.as_bytes().to_vec());
        let all = tokens(&diagnostics, source);
        all.iter().map(|token| token.kind.clone()).collect()
    }

    #[test]
    fn numbers_in_all_their_spellings() {
        assert_eq!(
            kinds("1 .5 2. 3.25e-2 1E3"),
            [1.0, 0.5, 2.0, 0.0325, 1000.0]
                .map(Kind::Number)
                .into_iter()
                .chain([Kind::End])
                .collect::<Vec<_>>()
        );
    }

    #[test]
    fn comments_nest_and_strings_hide_them() {
        let word = |w: &str| Kind::Word(w.into());
        assert_eq!(
            kinds("a /* b /* c */ d */ e // f\n\"/* g\\\"\""),
            [word("a"), word("e"), Kind::Text("/* g\"".into()), Kind::End]
        );
    }

    #[test]
    fn faults_are_tokens_with_a_message() {
        assert!(matches!(kinds("/* a")[0], Kind::Bad(_)));
        assert!(matches!(kinds("\"a")[0], Kind::Bad(_)));
        assert!(matches!(kinds("\"a\\")[0], Kind::Bad(_)));
        assert!(matches!(kinds("@")[0], Kind::Bad(_)));
    }

    #[test]
    fn directives_may_stand_apart_from_their_sign() {
        assert_eq!(kinds("# declare")[0], Kind::Directive("declare".into()));
    }
}
