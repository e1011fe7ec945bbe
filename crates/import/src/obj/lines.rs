//! Lines of OBJ and MTL files: a backslash at the end of a line joins it to the next.

use crate::text::{Lines, Word, Words, text_start};

/// Joined lines as byte ranges of the file.
#[derive(Clone, Debug)]
pub(super) struct JoinedLines<'a> {
    bytes: &'a [u8],
    lines: Lines<'a>,
}

impl<'a> JoinedLines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let lines = Lines::new(bytes, text_start(bytes));
        Self { bytes, lines }
    }
}

impl<'a> Iterator for JoinedLines<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        let (start, mut end) = self.lines.next()?;
        while end > start && self.bytes[end - 1] == b'\\' {
            match self.lines.next() {
                Some((_, next)) => end = next,
                None => break,
            }
        }
        Some(Statement {
            bytes: self.bytes,
            words: Words::new(self.bytes, start, end),
        })
    }
}

/// The words of one joined line, without the backslashes that join it, up to a comment.
#[derive(Clone, Debug)]
pub(super) struct Statement<'a> {
    bytes: &'a [u8],
    words: Words<'a>,
}

impl<'a> Statement<'a> {
    /// The rest of the line, blanks and all, for names.
    pub(super) fn rest(&self) -> Word<'a> {
        self.words.rest()
    }
}

impl<'a> Iterator for Statement<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        loop {
            let mut word = self.words.next()?;
            let end = word.start + word.bytes.len();
            let at_line_end = matches!(self.bytes.get(end), None | Some(b'\n' | b'\r'));
            if let [before @ .., b'\\'] = word.bytes
                && at_line_end
            {
                word.bytes = before;
            }
            match word.bytes.first() {
                None => {}
                Some(b'#') => return None,
                Some(_) => return Some(word),
            }
        }
    }
}
