//! Bytes to tokens, one at a time.

use std::collections::HashSet;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use crate::{SourceId, Span};

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
        // Nearly all are told apart by the first byte: cheaper than comparing strings.
        matches!(&self.kind, Kind::Sign(s)
            if s.len() == sign.len() && s.as_bytes().first() == sign.as_bytes().first())
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

/// Every word once.
#[derive(Debug, Default)]
pub(super) struct Words(HashSet<Rc<str>>);

impl Words {
    fn shared(&mut self, word: &str) -> Rc<str> {
        if let Some(known) = self.0.get(word) {
            return Rc::clone(known);
        }
        let word: Rc<str> = word.into();
        self.0.insert(Rc::clone(&word));
        word
    }
}

/// What tokens are read from. A place in it is a number: reading can go on at any that was met.
#[derive(Clone, Debug)]
pub(super) enum Tape {
    /// The bytes of a file: a place is an offset. Tokens are made when they are asked for, and made
    /// again where a loop or a macro comes by again: kept, they would take twenty times the text.
    Source { id: SourceId, bytes: Arc<Vec<u8>> },
    /// Tokens of a function's body: a place is an index.
    Tokens(Rc<[Token]>),
}

impl Tape {
    /// One past the last place.
    pub(super) fn end(&self) -> usize {
        match self {
            Self::Source { bytes, .. } => bytes.len(),
            Self::Tokens(tokens) => tokens.len(),
        }
    }

    /// The token that begins at or after a place, and the place behind it; [`Kind::End`] at the
    /// end.
    pub(super) fn token(&self, at: usize, words: &mut Words) -> (Token, usize) {
        match self {
            Self::Source { id, bytes } => {
                let (kind, range) = lex(bytes, at, words);
                let next = range.end;
                let span = Span::new(*id, range);
                (Token { kind, span }, next)
            }
            Self::Tokens(tokens) => match tokens.get(at) {
                Some(token) => (token.clone(), at + 1),
                None => {
                    let span = tokens
                        .last()
                        .map_or(Span::new(SourceId(0), 0..0), |t| t.span);
                    let kind = Kind::End;
                    (Token { kind, span }, at)
                }
            },
        }
    }

    /// `number, ... >`: the plain numbers of a vector from a place on, to its closing bracket, if
    /// nothing else stands there: how many, the place of the bracket and the one behind it. This is
    /// what files of many numbers consist of.
    pub(super) fn plain_vector(&self, mut at: usize, out: &mut [f64; 5]) -> Option<(usize, usize)> {
        let Self::Source { bytes, .. } = self else {
            return None;
        };
        let mut count = 0;
        loop {
            at = blank_end(bytes, at);
            let negative = bytes.get(at) == Some(&b'-');
            at = blank_end(bytes, at + usize::from(negative));
            let end = number_end(bytes, at)?;
            let value = number(&bytes[at..end])?;
            *out.get_mut(count)? = if negative { -value } else { value };
            count += 1;
            at = blank_end(bytes, end);
            match bytes.get(at) {
                Some(b',') => at += 1,
                Some(b'>') if count >= 2 && bytes.get(at + 1) != Some(&b'=') => {
                    return Some((count, at));
                }
                _ => return None,
            }
        }
    }
}

/// Where the next token may begin: behind blanks and byte order marks.
fn blank_end(bytes: &[u8], mut at: usize) -> usize {
    loop {
        match bytes.get(at) {
            Some(b' ' | b'\t' | b'\r' | b'\n' | 0x0c) => at += 1,
            Some(0xef) if bytes[at..].starts_with(&[0xef, 0xbb, 0xbf]) => at += 3,
            _ => return at,
        }
    }
}

/// Where the bytes from `at` on that `belongs` accepts end.
fn run_end(bytes: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> usize {
    let rest = &bytes[at.min(bytes.len())..];
    at + rest.iter().position(|&b| !belongs(b)).unwrap_or(rest.len())
}

/// The end of the number that begins at `at`: digits with or without a point, and an exponent.
fn number_end(bytes: &[u8], at: usize) -> Option<usize> {
    let digits = |at| run_end(bytes, at, |b| b.is_ascii_digit());
    let whole = digits(at);
    let mut end = whole;
    if bytes.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        if whole == at && fraction == end + 1 {
            return None;
        }
        end = fraction;
    } else if whole == at {
        return None;
    }
    if let Some(b'e' | b'E') = bytes.get(end) {
        let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let first = end + 1 + signed;
        let exponent = digits(first);
        if exponent > first {
            end = exponent;
        }
    }
    Some(end)
}

fn number(digits: &[u8]) -> Option<f64> {
    std::str::from_utf8(digits).ok()?.parse().ok()
}

/// The end of a comment that begins at `at` with two slashes, or with a slash and a star: those
/// nest. `Err`, at the end of the text, where it is not closed.
fn comment_end(bytes: &[u8], at: usize) -> Option<Result<usize, usize>> {
    match bytes.get(at..at + 2)? {
        b"//" => Some(Ok(run_end(bytes, at, |b| b != b'\n'))),
        b"/*" => {
            let (mut depth, mut at) = (1, at + 2);
            while at < bytes.len() {
                match &bytes[at..] {
                    [b'*', b'/', ..] => {
                        (depth, at) = (depth - 1, at + 2);
                        if depth == 0 {
                            return Some(Ok(at));
                        }
                    }
                    [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
                    _ => at += 1,
                }
            }
            Some(Err(bytes.len()))
        }
        _ => None,
    }
}

/// The end of the string whose opening quote stands at `at`, behind the closing one.
fn text_end(bytes: &[u8], at: usize) -> Option<usize> {
    let mut at = at + 1;
    while at < bytes.len() {
        match bytes[at] {
            b'"' => return Some(at + 1),
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    None
}

fn sign(bytes: &[u8]) -> Option<&'static str> {
    let followed = bytes.get(1) == Some(&b'=');
    Some(match bytes.first()? {
        b'<' if followed => "<=",
        b'>' if followed => ">=",
        b'!' if followed => "!=",
        b'{' => "{",
        b'}' => "}",
        b'(' => "(",
        b')' => ")",
        b'[' => "[",
        b']' => "]",
        b'<' => "<",
        b'>' => ">",
        b'=' => "=",
        b'!' => "!",
        b'&' => "&",
        b'|' => "|",
        b'+' => "+",
        b'-' => "-",
        b'*' => "*",
        b'/' => "/",
        b'?' => "?",
        b':' => ":",
        b';' => ";",
        b',' => ",",
        b'.' => ".",
        b'^' => "^",
        _ => return None,
    })
}

/// A string without its quotes, escapes resolved. Old scenes have Latin-1 in it: a question mark
/// stands for what is not UTF-8.
fn unescape(bytes: &[u8]) -> Rc<str> {
    let plain;
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(_) => {
            let ascii = |&b: &u8| if b < 0x80 { b as char } else { '?' };
            plain = bytes.iter().map(ascii).collect::<String>();
            &plain
        }
    };
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

/// The token that begins at or after `at`, and its bytes.
fn lex(bytes: &[u8], mut at: usize, words: &mut Words) -> (Kind, Range<usize>) {
    loop {
        at = blank_end(bytes, at);
        match comment_end(bytes, at) {
            Some(Ok(end)) => at = end,
            Some(Err(end)) => {
                return (Kind::Bad("a comment that is not closed by `*/`"), at..end);
            }
            None => break,
        }
    }
    let Some(&first) = bytes.get(at) else {
        return (Kind::End, bytes.len()..bytes.len());
    };
    let is_word = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let mut word = |range: Range<usize>| {
        let text = std::str::from_utf8(&bytes[range]).unwrap_or_default();
        words.shared(text)
    };
    if first.is_ascii_alphabetic() || first == b'_' {
        let end = run_end(bytes, at, is_word);
        return (Kind::Word(word(at..end)), at..end);
    }
    if let Some(end) = number_end(bytes, at) {
        let value = number(&bytes[at..end]);
        return (
            value.map_or(Kind::Bad("a malformed number"), Kind::Number),
            at..end,
        );
    }
    match first {
        b'"' => match text_end(bytes, at) {
            Some(end) => (Kind::Text(unescape(&bytes[at + 1..end - 1])), at..end),
            None => {
                let message = "a string that is not closed by `\"`";
                (Kind::Bad(message), at..bytes.len())
            }
        },
        b'#' => {
            let start = run_end(bytes, at + 1, |b| matches!(b, b' ' | b'\t'));
            let end = run_end(bytes, start, |b| b.is_ascii_alphabetic() || b == b'_');
            if end > start {
                (Kind::Directive(word(start..end)), at..end)
            } else {
                (Kind::Bad(NO_MEANING), at..at + 1)
            }
        }
        _ => match sign(&bytes[at..]) {
            Some(sign) => (Kind::Sign(sign), at..at + sign.len()),
            None => {
                // All of a character of several bytes.
                let end = run_end(bytes, at + 1, |b| {
                    first >= 0x80 && (0x80..0xc0).contains(&b)
                });
                (Kind::Bad(NO_MEANING), at..end)
            }
        },
    }
}

const NO_MEANING: &str = "a character that has no meaning here";

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Kind> {
        let tape = Tape::Source {
            id: SourceId(0),
            bytes: Arc::new(text.as_bytes().to_vec()),
        };
        let mut words = Words::default();
        let (mut all, mut at) = (Vec::new(), 0);
        while all.last() != Some(&Kind::End) {
            let (token, next) = tape.token(at, &mut words);
            all.push(token.kind);
            at = next;
        }
        all
    }

    #[test]
    fn a_plain_vector_is_read_at_once_like_its_tokens() {
        let read = |text: &str| {
            let tape = Tape::Source {
                id: SourceId(0),
                bytes: Arc::new(text.as_bytes().to_vec()),
            };
            let mut out = [0.0; 5];
            let found = tape.plain_vector(0, &mut out);
            found.map(|(count, at)| (out[..count].to_vec(), text[at..].to_owned()))
        };
        let rest = |numbers: &[f64], rest: &str| Some((numbers.to_vec(), rest.to_owned()));
        assert_eq!(read("1, -.5,\n2e3> x"), rest(&[1.0, -0.5, 2000.0], "> x"));
        assert_eq!(read("- 1 , 2 >"), rest(&[-1.0, 2.0], ">"));
        for other in [
            "1>",
            "1,2",
            "1,a>",
            "1 2>",
            "1,2*3>",
            "1,2>=3",
            "1,2,3,4,5,6>",
            "",
            "1,,2>",
        ] {
            assert_eq!(read(other), None, "{other}");
        }
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
