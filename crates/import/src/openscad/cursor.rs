//! Going through tokens, and saying what was expected.

use crate::{Diagnostic, Diagnostics, Severity, SourceId, Span};

use super::lexer::{Lexeme, Token};

/// A mistake that has been reported; the statement it is in is given up.
pub(super) struct Reported;

/// A place in the tokens of a text, and where mistakes go.
pub(super) struct Parser<'text, 'd> {
    pub(super) text: &'text str,
    pub(super) lexemes: Vec<Lexeme>,
    pub(super) at: usize,
    /// How many blocks and brackets are open.
    pub(super) nesting: u32,
    /// Whether a block that the file ends in has been named.
    pub(super) end_is_reported: bool,
    pub(super) source: SourceId,
    pub(super) diagnostics: &'d mut Diagnostics,
}

impl<'text> Parser<'text, '_> {
    pub(super) fn peek(&self) -> Option<Token> {
        self.lexemes.get(self.at).map(|lexeme| lexeme.token)
    }

    pub(super) fn take(&mut self, token: Token) -> bool {
        let found = self.peek() == Some(token);
        self.at += usize::from(found);
        found
    }

    pub(super) fn span_at(&self, at: usize) -> Span {
        let end = self.text.len();
        let range = self.lexemes.get(at).map_or(end..end, |lexeme| {
            lexeme.start as usize..lexeme.end as usize
        });
        Span::new(self.source, range)
    }

    pub(super) fn here(&self) -> Span {
        self.span_at(self.at)
    }

    pub(super) fn last_span(&self) -> Span {
        self.span_at(self.at.saturating_sub(1))
    }

    pub(super) fn text_at(&self, at: usize) -> &'text str {
        let span = self.span_at(at);
        &self.text[span.start..span.end]
    }

    pub(super) fn error(&mut self, span: Span, message: impl Into<String>) -> Reported {
        self.diagnostics.error(span, message);
        Reported
    }

    pub(super) fn error_with_help(&mut self, span: Span, message: String, help: &str) -> Reported {
        self.diagnostics.push(Diagnostic {
            severity: Severity::Error,
            span: Some(span),
            message,
            help: Some(help.to_owned()),
        });
        Reported
    }

    /// Reports that something else was expected at the present token.
    pub(super) fn expected(&mut self, what: &str) -> Reported {
        let span = self.here();
        let message = match self.peek() {
            None => format!("expected {what}, but the file ends here"),
            Some(Token::OpenText) => "this string has no closing quote".to_owned(),
            Some(Token::Unknown) if self.text_at(self.at).starts_with("/*") => {
                "this comment has no end".to_owned()
            }
            Some(_) => {
                let found: String = self.text_at(self.at).chars().take(40).collect();
                format!("expected {what}, found `{found}`")
            }
        };
        self.error(span, message)
    }

    pub(super) fn expect(&mut self, token: Token, what: &str) -> Result<(), Reported> {
        if self.take(token) {
            Ok(())
        } else {
            Err(self.expected(what))
        }
    }
}
