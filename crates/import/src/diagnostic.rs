//! Messages about a user's file: where, what, and what would help.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// One of the files that an import read; 0 is the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceId(pub u32);

/// A range of bytes of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// Which source.
    pub source: SourceId,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes `range` of `source`.
    #[must_use]
    pub const fn new(source: SourceId, range: Range<usize>) -> Self {
        Self {
            source,
            start: range.start,
            end: range.end,
        }
    }

    /// From the start of this span to the end of `other` (of the same source).
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self {
            end: other.end.max(self.end),
            ..self
        }
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The rest is still rendered.
    Warning,
    /// No picture.
    Error,
}

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Where, if anywhere in particular.
    pub span: Option<Span>,
    /// What is wrong: one sentence without a full stop.
    pub message: String,
    /// What would help, if that is known.
    pub help: Option<String>,
}

struct Source {
    path: PathBuf,
    bytes: Arc<Vec<u8>>,
    line_starts: Vec<usize>,
}

/// The messages of one import, with the sources they point into.
///
/// After [`Diagnostics::LIMIT`] messages further ones are only counted.
#[derive(Default)]
pub struct Diagnostics {
    sources: Vec<Source>,
    items: Vec<Diagnostic>,
    dropped: usize,
    errors: usize,
}

impl fmt::Debug for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list()
            .entries(self.items.iter().map(|d| self.render(d)))
            .finish()
    }
}

impl Diagnostics {
    /// How many messages are kept.
    pub const LIMIT: usize = 200;

    /// Registers a source; its bytes are kept for excerpts.
    pub fn add_source(&mut self, path: &Path, bytes: Vec<u8>) -> SourceId {
        let newlines = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n');
        let line_starts = std::iter::once(0)
            .chain(newlines.map(|(i, _)| i + 1))
            .collect();
        self.sources.push(Source {
            path: path.to_owned(),
            bytes: Arc::new(bytes),
            line_starts,
        });
        SourceId(self.sources.len() as u32 - 1)
    }

    /// The bytes of a source.
    ///
    /// # Panics
    /// If the id is of another `Diagnostics`.
    #[must_use]
    pub fn source(&self, id: SourceId) -> &[u8] {
        &self.sources[id.0 as usize].bytes
    }

    /// The bytes of a source, to keep while messages are added.
    ///
    /// # Panics
    /// If the id is of another `Diagnostics`.
    #[must_use]
    pub fn shared_source(&self, id: SourceId) -> Arc<Vec<u8>> {
        Arc::clone(&self.sources[id.0 as usize].bytes)
    }

    /// The path of a source, as it was given.
    ///
    /// # Panics
    /// If the id is of another `Diagnostics`.
    #[must_use]
    pub fn path(&self, id: SourceId) -> &Path {
        &self.sources[id.0 as usize].path
    }

    /// The span of line `line`, counted from 1, for formats read by libraries that know only lines.
    #[must_use]
    pub fn line_span(&self, source: SourceId, line: usize) -> Span {
        let starts = &self.sources[source.0 as usize].line_starts;
        let end = self.sources[source.0 as usize].bytes.len();
        let index = line.saturating_sub(1).min(starts.len() - 1);
        let next = starts.get(index + 1).map_or(end, |s| s - 1);
        Span::new(source, starts[index]..next)
    }

    /// Adds a message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.errors += usize::from(diagnostic.severity == Severity::Error);
        if self.items.len() < Self::LIMIT {
            self.items.push(diagnostic);
        } else {
            self.dropped += 1;
        }
    }

    /// Adds an error.
    pub fn error(&mut self, span: impl Into<Option<Span>>, message: impl Into<String>) {
        self.push(Diagnostic {
            severity: Severity::Error,
            span: span.into(),
            message: message.into(),
            help: None,
        });
    }

    /// Adds a warning.
    pub fn warning(&mut self, span: impl Into<Option<Span>>, message: impl Into<String>) {
        self.push(Diagnostic {
            severity: Severity::Warning,
            span: span.into(),
            message: message.into(),
            help: None,
        });
    }

    /// The messages kept, in the order they were added.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.items.iter()
    }

    /// How many messages were not kept.
    #[must_use]
    pub const fn dropped(&self) -> usize {
        self.dropped
    }

    /// Whether any message is an error.
    #[must_use]
    pub const fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// The line a span starts in, counted from 1. Unlike [`Diagnostics::position`] it does not
    /// read the line, so that it can be asked for every statement of a file.
    #[must_use]
    pub fn line(&self, span: Span) -> usize {
        let source = &self.sources[span.source.0 as usize];
        let start = span.start.min(source.bytes.len());
        source.line_starts.partition_point(|&s| s <= start)
    }

    /// `(path, line, column)`, both counted from 1, the column in characters.
    #[must_use]
    pub fn position(&self, span: Span) -> (&Path, usize, usize) {
        let source = &self.sources[span.source.0 as usize];
        let start = span.start.min(source.bytes.len());
        let line = self.line(span);
        let before = &source.bytes[source.line_starts[line - 1]..start];
        (
            &source.path,
            line,
            String::from_utf8_lossy(before).chars().count() + 1,
        )
    }

    /// The message for a terminal: `file:line:column: error: text`, then the excerpt.
    #[must_use]
    pub fn render(&self, diagnostic: &Diagnostic) -> String {
        let (level, word) = match diagnostic.severity {
            Severity::Warning => (Level::WARNING, "warning"),
            Severity::Error => (Level::ERROR, "error"),
        };
        let mut text = match diagnostic.span {
            Some(span) => {
                let (path, line, column) = self.position(span);
                format!(
                    "{}:{line}:{column}: {word}: {}",
                    path.display(),
                    diagnostic.message
                )
            }
            None => match self.sources.first() {
                Some(source) => {
                    format!("{}: {word}: {}", source.path.display(), diagnostic.message)
                }
                None => format!("{word}: {}", diagnostic.message),
            },
        };
        if let Some(excerpt) = diagnostic.span.and_then(|span| self.excerpt(span, level)) {
            text.push('\n');
            text.push_str(&excerpt);
        }
        if let Some(help) = &diagnostic.help {
            text.push_str("\n  = help: ");
            text.push_str(help);
        }
        text
    }

    /// The line of the span with a mark below it; `None` where it is not text or too long to show.
    fn excerpt(&self, span: Span, level: Level<'_>) -> Option<String> {
        let source = &self.sources[span.source.0 as usize];
        let (_, line, _) = self.position(span);
        let start = source.line_starts[line - 1];
        let end = source
            .line_starts
            .get(line)
            .map_or(source.bytes.len(), |next| next - 1);
        let text = std::str::from_utf8(&source.bytes[start..end]).ok()?;
        let text = text.trim_end_matches('\r');
        if text.len() > 500 || text.contains(|c: char| c.is_control() && c != '\t') {
            return None;
        }
        let mark = (span.start - start).min(text.len())
            ..(span.end.max(span.start) - start).min(text.len());
        if !text.is_char_boundary(mark.start) || !text.is_char_boundary(mark.end) {
            return None;
        }
        let snippet = Snippet::source(text)
            .line_start(line)
            .annotation(AnnotationKind::Primary.span(mark));
        let report = [level.no_name().primary_title("").element(snippet)];
        let rendered = Renderer::plain().render(&report);
        // The first line repeats level and title, which stand in our own first line.
        rendered.split_once('\n').map(|(_, rest)| rest.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_names_file_line_and_column_and_shows_the_line() {
        let mut diagnostics = Diagnostics::default();
        let text = b"sphere {\n  <0, 0>, wrong\n}\n".to_vec();
        let source = diagnostics.add_source(Path::new("a.pov"), text);
        diagnostics.error(Span::new(source, 19..24), "`wrong` is not declared");
        let shown = diagnostics.render(diagnostics.iter().next().expect("one"));
        let mut lines = shown.lines();
        assert_eq!(
            lines.next(),
            Some("a.pov:2:11: error: `wrong` is not declared")
        );
        assert!(shown.contains("<0, 0>, wrong"), "{shown}");
        assert!(shown.contains("^^^^^"), "{shown}");
    }

    #[test]
    fn positions_outside_the_text_do_not_panic() {
        let mut diagnostics = Diagnostics::default();
        let source = diagnostics.add_source(Path::new("a.bin"), vec![0xff, b'\n', 0xc3]);
        for start in 0..6 {
            for end in 0..6 {
                diagnostics.error(Span::new(source, start..end), "x");
            }
        }
        diagnostics.error(diagnostics.line_span(source, 99), "x");
        for diagnostic in diagnostics.iter() {
            assert!(diagnostics.render(diagnostic).starts_with("a.bin:"));
        }
    }
}
