//! `#include`: a file beside the scene first, then our own tables of the standard includes.

use std::path::Path;

use super::lexer::Tape;
use super::reader::{Parsed, Reader};
use super::standard::{self, Standard};
use crate::Span;

/// The folder that our own texts of standard includes seem to be in.
const STANDARD: &str = "<standard>";

impl Reader<'_> {
    pub(super) fn include(&mut self, span: Span) -> Parsed<()> {
        let name = self.text()?;
        let path = self.folder.join(&*name);
        match self.files.read(&path, self.max_bytes) {
            Ok(bytes) => self.open_source(&path, bytes),
            Err(error) if error.kind() == std::io::ErrorKind::FileTooLarge => {
                self.halt(span, format!("`{name}` is larger than the memory budget"))
            }
            Err(error) => match standard::find(&name) {
                Some(known) => self.standard(&name, &known, span),
                None => {
                    let help = standard::nearest(&name)
                        .map(|near| format!("a standard include has a similar name: \"{near}\""));
                    self.fail_with_help(
                        span.to(self.last),
                        format!("cannot read the include `{name}`: {error}"),
                        help,
                    )
                }
            },
        }
    }

    /// Registers a source and goes on at its beginning, with a table of local names of its own.
    pub(super) fn open_source(&mut self, path: &Path, bytes: Vec<u8>) -> Parsed<()> {
        self.book(bytes.len() as u64)?;
        let id = self.diagnostics.add_source(path, bytes);
        let bytes = self.diagnostics.shared_source(id);
        let tape = Tape::Source { id, bytes };
        let end = tape.end();
        let scopes = self.scopes.depth();
        self.push_frame(tape, 0, end, scopes)?;
        self.scopes.open();
        Ok(())
    }

    fn standard(&mut self, name: &str, known: &Standard, span: Span) -> Parsed<()> {
        self.partial_includes |= !known.complete;
        // What a standard include includes in turn was not the user's doing.
        let nested = self.diagnostics.path(span.source).starts_with(STANDARD);
        if !known.complete && !nested {
            let message = if known.text.is_empty() {
                format!(
                    "octray has no definitions for the standard include `{name}`: what uses them is left out"
                )
            } else {
                format!("octray knows the standard include `{name}` only in part")
            };
            self.warn(span.to(self.last), message);
        }
        for include in known.needs {
            if let Some(needed) = standard::find(include) {
                self.declare_colors(&needed);
            }
        }
        self.declare_colors(known);
        if known.text.is_empty() {
            return Ok(());
        }
        let path = Path::new(STANDARD).join(name);
        self.open_source(&path, known.text.as_bytes().to_vec())
    }

    fn declare_colors(&mut self, known: &Standard) {
        if known.colors {
            for (name, value) in standard::colors::table() {
                self.scopes.declare(name.into(), value);
            }
        }
    }
}
