//! Words and numbers of line-oriented text formats, each with its place in the file.

use std::borrow::Cow;

use crate::{SourceId, Span};

/// A run of bytes without blanks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'a> {
    /// What it says.
    pub bytes: &'a [u8],
    /// Its first byte's place in the file.
    pub start: usize,
}

impl<'a> Word<'a> {
    /// Where it stands.
    pub(crate) const fn span(&self, source: SourceId) -> Span {
        Span::new(source, self.start..self.start + self.bytes.len())
    }

    /// For messages: at most 40 characters, bytes that are not UTF-8 replaced.
    pub(crate) fn shown(&self) -> String {
        shown(self.bytes)
    }

    /// A decimal number; `None` if it is none. `nan` and `inf` are numbers here: whether they
    /// make sense is the caller's question.
    pub(crate) fn number(&self) -> Option<f64> {
        std::str::from_utf8(self.bytes).ok()?.parse().ok()
    }

    /// A decimal integer.
    pub(crate) fn integer(&self) -> Option<i64> {
        std::str::from_utf8(self.bytes).ok()?.parse().ok()
    }

    /// Whether it is `keyword`, in capitals or not.
    pub(crate) fn is(&self, keyword: &str) -> bool {
        self.bytes.eq_ignore_ascii_case(keyword.as_bytes())
    }

    /// As text, bytes that are not UTF-8 replaced.
    pub(crate) fn text(&self) -> Cow<'a, str> {
        String::from_utf8_lossy(self.bytes)
    }
}

/// Text of a file fit for a message.
pub(crate) fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]);
    let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut shown: String = text.chars().take(40).map(printable).collect();
    if text.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    shown
}

/// The words between `start` and `end`.
#[derive(Clone, Debug)]
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
}

impl<'a> Words<'a> {
    /// The words of `bytes[start..end]`.
    pub(crate) fn new(bytes: &'a [u8], start: usize, end: usize) -> Self {
        let end = end.min(bytes.len());
        Self {
            bytes,
            at: start.min(end),
            end,
        }
    }

    /// Everything after the words already taken, without blanks at both ends.
    pub(crate) fn rest(&self) -> Word<'a> {
        let rest = &self.bytes[self.at..self.end];
        let skipped = rest.len() - rest.trim_ascii_start().len();
        Word {
            bytes: rest.trim_ascii(),
            start: self.at + skipped,
        }
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        while self.at < self.end && is_blank(self.bytes[self.at]) {
            self.at += 1;
        }
        let start = self.at;
        while self.at < self.end && !is_blank(self.bytes[self.at]) {
            self.at += 1;
        }
        (start < self.at).then(|| Word {
            bytes: &self.bytes[start..self.at],
            start,
        })
    }
}

const fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// The lines of a text as byte ranges without their ends (`\n`, `\r\n`, or a `\r` alone as of old).
#[derive(Clone, Debug)]
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lines<'a> {
    /// The lines from byte `start` on.
    pub(crate) const fn new(bytes: &'a [u8], start: usize) -> Self {
        Self { bytes, at: start }
    }

    /// Where the next line starts.
    pub(crate) const fn offset(&self) -> usize {
        self.at
    }
}

impl Iterator for Lines<'_> {
    type Item = (usize, usize);

    fn next(&mut self) -> Option<(usize, usize)> {
        let start = self.at;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let Some(length) = length else {
            self.at = self.bytes.len();
            return Some((start, self.bytes.len()));
        };
        let ends = 1 + usize::from(rest[length] == b'\r' && rest.get(length + 1) == Some(&b'\n'));
        self.at = start + length + ends;
        Some((start, start + length))
    }
}

/// Why a file cannot be text of one byte per ASCII character, if it cannot.
pub(crate) fn encoding_problem(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => Some("UTF-32"),
        [0xfe, 0xff, ..] | [0xff, 0xfe, ..] => Some("UTF-16"),
        _ if bytes.iter().take(4096).any(|&b| b == 0) => Some("binary data"),
        _ => None,
    }
}

/// Where the text starts: behind the mark that some programs put before UTF-8.
pub(crate) fn text_start(bytes: &[u8]) -> usize {
    if bytes.starts_with(&[0xef, 0xbb, 0xbf]) {
        3
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_of_the_three_ways() {
        let bytes = b"a\nb\r\nc\rd\n\ne";
        let lines: Vec<&[u8]> = Lines::new(bytes, 0).map(|(a, b)| &bytes[a..b]).collect();
        assert_eq!(lines, [&b"a"[..], b"b", b"c", b"d", b"", b"e"]);
    }

    #[test]
    fn words_know_their_place() {
        let words: Vec<(usize, String)> = Words::new(b"  ab\t c ", 0, 8)
            .map(|w| (w.start, w.shown()))
            .collect();
        assert_eq!(words, [(2, "ab".to_owned()), (6, "c".to_owned())]);
    }
}
