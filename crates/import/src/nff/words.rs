//! The words of an NFF file: blanks and line ends are alike, `#` begins a comment.

use crate::text::{Lines, Word, Words, text_start};

/// All words in order, with one word of look-ahead.
#[derive(Debug)]
pub(super) struct NffWords<'a> {
    bytes: &'a [u8],
    lines: Lines<'a>,
    words: Words<'a>,
    ahead: Option<Word<'a>>,
}

impl<'a> NffWords<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let mut words = Self {
            bytes,
            lines: Lines::new(bytes, text_start(bytes)),
            words: Words::new(bytes, 0, 0),
            ahead: None,
        };
        words.next();
        words
    }

    /// The next word, which stays.
    pub(super) const fn peek(&self) -> Option<Word<'a>> {
        self.ahead
    }
}

impl<'a> Iterator for NffWords<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let taken = self.ahead.take();
        loop {
            if let Some(word) = self.words.next() {
                self.ahead = Some(word);
                return taken;
            }
            let Some((start, end)) = self.lines.next() else {
                return taken;
            };
            let text = &self.bytes[start..end];
            let comment = text.iter().position(|&b| b == b'#');
            self.words = Words::new(self.bytes, start, comment.map_or(end, |at| start + at));
        }
    }
}
