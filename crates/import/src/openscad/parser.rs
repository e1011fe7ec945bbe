//! Tokens into statements: recursive descent that goes on after a mistake.

use crate::{Diagnostics, SourceId, Span};

use super::cursor::{Parser, Reported};
use super::lexer::{Token, tokens};
use super::syntax::{Argument, Modifiers, Statement, Value};
use super::text::unescape;

/// Statements and brackets may be nested this deep; one stack frame each.
const MAX_NESTING: u32 = 500;

const EXPORT_HELP: &str =
    "this looks like an OpenSCAD program; export it with `openscad -o model.csg model.scad`";

/// Reads all statements of `text`, which is the source `source`; mistakes become diagnostics.
pub(super) fn parse<'text>(
    text: &'text str,
    source: SourceId,
    diagnostics: &mut Diagnostics,
) -> Vec<Statement<'text>> {
    let mut parser = Parser {
        text,
        lexemes: tokens(text),
        at: 0,
        nesting: 0,
        end_is_reported: false,
        source,
        diagnostics,
    };
    let mut statements = Vec::new();
    while parser.peek().is_some() {
        if parser.take(Token::CloseBrace) {
            let span = parser.last_span();
            parser.error(span, "this `}` closes nothing");
        } else {
            parser.statement_or_recover(&mut statements);
        }
    }
    statements
}

impl<'text> Parser<'text, '_> {
    /// One level deeper; the caller goes back up.
    fn descend(&mut self) -> Result<(), Reported> {
        if self.nesting == MAX_NESTING {
            let span = self.here();
            let message = format!("this is nested deeper than {MAX_NESTING} levels");
            return Err(self.error(span, message));
        }
        self.nesting += 1;
        Ok(())
    }

    /// Reads one statement, or passes over what cannot be read. Always moves on.
    fn statement_or_recover(&mut self, into: &mut Vec<Statement<'text>>) {
        let (start, nesting) = (self.at, self.nesting);
        if self.statement(into).is_err() {
            self.nesting = nesting;
            if self.at == start && self.peek() != Some(Token::OpenBrace) {
                self.at += 1;
            }
            self.skip_statement();
        }
    }

    /// Moves past the next `;`, or past a block, or to a `}` that closes a block around.
    fn skip_statement(&mut self) {
        let mut open = 0_u32;
        while let Some(token) = self.peek() {
            match token {
                Token::CloseBrace if open == 0 => return,
                Token::OpenBrace => open += 1,
                Token::CloseBrace => open -= 1,
                _ => {}
            }
            self.at += 1;
            if open == 0 && matches!(token, Token::Semicolon | Token::CloseBrace) {
                return;
            }
        }
    }

    fn statement(&mut self, into: &mut Vec<Statement<'text>>) -> Result<(), Reported> {
        let modifiers = self.modifiers();
        match self.peek() {
            Some(Token::Semicolon) => {
                self.at += 1;
                return Ok(());
            }
            Some(Token::OpenBrace) if modifiers == Modifiers::default() => {
                return self.children(into);
            }
            Some(Token::Word) => {}
            _ => return Err(self.expected("a shape or an operation")),
        }
        let (name, name_span) = (self.text_at(self.at), self.here());
        self.at += 1;
        self.refuse_programs(name, name_span)?;
        self.expect(Token::OpenParen, "`(`")?;
        let arguments = self.arguments()?;
        let span = name_span.to(self.last_span());
        let mut children = Vec::new();
        // The header is good: whatever is wrong with the children, it is kept.
        let read = self.children(&mut children);
        into.push(Statement {
            modifiers,
            name,
            span,
            arguments,
            children,
        });
        read
    }

    fn modifiers(&mut self) -> Modifiers {
        let mut modifiers = Modifiers::default();
        loop {
            match self.peek() {
                Some(Token::Background) => modifiers.background = true,
                Some(Token::Disable) => modifiers.disable = true,
                Some(Token::Root) => modifiers.root = true,
                // A highlight changes nothing in a finished picture.
                Some(Token::Highlight) => {}
                _ => return modifiers,
            }
            self.at += 1;
        }
    }

    /// Programs have names where dumps have none; one message says what to do.
    fn refuse_programs(&mut self, name: &str, span: Span) -> Result<(), Reported> {
        let keyword = matches!(name, "module" | "function" | "use" | "include");
        if self.peek() == Some(Token::Equals) || (keyword && self.peek() != Some(Token::OpenParen))
        {
            let message = format!("definitions like this one of `{name}` are not part of a dump");
            let message = if keyword {
                format!("`{name}` is not part of a dump")
            } else {
                message
            };
            return Err(self.error_with_help(span, message, EXPORT_HELP));
        }
        Ok(())
    }

    /// `;`, a block, or one statement.
    fn children(&mut self, into: &mut Vec<Statement<'text>>) -> Result<(), Reported> {
        if self.take(Token::Semicolon) {
            return Ok(());
        }
        self.descend()?;
        if self.take(Token::OpenBrace) {
            let opening = self.last_span();
            while !self.take(Token::CloseBrace) {
                if self.peek().is_none() {
                    // Of all blocks that the file ends in, the innermost is named.
                    if !std::mem::replace(&mut self.end_is_reported, true) {
                        self.error(opening, "this `{` is never closed");
                    }
                    return Err(Reported);
                }
                self.statement_or_recover(into);
            }
        } else if self.peek().is_some_and(|token| token != Token::CloseBrace) {
            self.statement(into)?;
        } else {
            return Err(self.expected("`;` or `{`"));
        }
        self.nesting -= 1;
        Ok(())
    }

    /// Up to and with the closing parenthesis.
    fn arguments(&mut self) -> Result<Vec<Argument<'text>>, Reported> {
        let mut all = Vec::new();
        while !self.take(Token::CloseParen) {
            let start = self.here();
            let named = self.peek() == Some(Token::Word)
                && self.lexemes.get(self.at + 1).map(|l| l.token) == Some(Token::Equals);
            let name = named.then(|| self.text_at(self.at));
            self.at += 2 * usize::from(named);
            let value = self.value()?;
            let span = start.to(self.last_span());
            all.push(Argument { name, value, span });
            if !self.take(Token::Comma) {
                self.expect(Token::CloseParen, "`,` or `)`")?;
                break;
            }
        }
        Ok(all)
    }

    fn value(&mut self) -> Result<Value, Reported> {
        let negative = match self.peek() {
            Some(sign @ (Token::Minus | Token::Plus)) => {
                self.at += 1;
                Some(sign == Token::Minus)
            }
            _ => None,
        };
        let text = self.text_at(self.at);
        let value = match (self.peek(), text) {
            (Some(Token::Number), _) => Value::Number(text.parse().unwrap_or(f64::NAN)),
            (Some(Token::Word), "inf") => Value::Number(f64::INFINITY),
            (Some(Token::Word), "nan") => Value::Number(f64::NAN),
            (Some(Token::Word), "undef") if negative.is_none() => Value::Undefined,
            (Some(Token::Word), "true") if negative.is_none() => Value::Boolean(true),
            (Some(Token::Word), "false") if negative.is_none() => Value::Boolean(false),
            (Some(Token::Text), _) if negative.is_none() => {
                Value::Text(unescape(&text[1..text.len() - 1]))
            }
            (Some(Token::OpenBracket), _) if negative.is_none() => return self.vector(),
            (Some(Token::Word), name) => {
                let (span, message) = (self.here(), format!("`{name}` is not a value"));
                return Err(self.error_with_help(span, message, EXPORT_HELP));
            }
            _ => return Err(self.expected("a value")),
        };
        self.at += 1;
        Ok(match value {
            Value::Number(number) if negative == Some(true) => Value::Number(-number),
            value => value,
        })
    }

    fn vector(&mut self) -> Result<Value, Reported> {
        self.descend()?;
        self.at += 1;
        let mut all = Vec::new();
        while !self.take(Token::CloseBracket) {
            all.push(self.value()?);
            if !self.take(Token::Comma) {
                self.expect(Token::CloseBracket, "`,` or `]`")?;
                break;
            }
        }
        self.nesting -= 1;
        Ok(Value::Vector(all))
    }
}
