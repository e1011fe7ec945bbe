//! Small steps of parsing: look, take, require.

use std::rc::Rc;

use super::lexer::{Kind, Token};
use super::reader::{Parsed, Reader};

impl Reader<'_> {
    /// Whether the next token is this sign.
    pub(super) fn at(&mut self, sign: &str) -> bool {
        self.look().is(sign)
    }

    /// Takes the sign if it is next.
    pub(super) fn eat(&mut self, sign: &str) -> bool {
        let found = self.at(sign);
        if found {
            self.next();
        }
        found
    }

    pub(super) fn expect(&mut self, sign: &str) -> Parsed<Token> {
        if self.at(sign) {
            return Ok(self.next());
        }
        let token = self.peek();
        let found = token.describe();
        self.fail(token.span, format!("expected `{sign}`, found {found}"))
    }

    /// The next token's word, left in place.
    pub(super) fn peek_word(&mut self) -> Option<Rc<str>> {
        self.look().word().cloned()
    }

    /// Takes the word if it is next.
    pub(super) fn eat_word(&mut self, word: &str) -> bool {
        let found = self.look().word().is_some_and(|w| &**w == word);
        if found {
            self.next();
        }
        found
    }

    /// Separators between items are optional in this language.
    pub(super) fn comma(&mut self) {
        self.eat(",");
    }

    /// `{ ... }`: `item` is called until the closing brace; it must take something.
    pub(super) fn block(
        &mut self,
        what: &str,
        mut item: impl FnMut(&mut Self) -> Parsed<()>,
    ) -> Parsed<()> {
        let open = self.expect("{")?;
        let held = std::mem::take(&mut self.hold);
        let result = self.nested(|r| {
            loop {
                let token = r.look();
                if token.is("}") {
                    return Ok(());
                }
                if token.kind == Kind::End {
                    return r.fail(open.span, format!("this `{{` of the {what} is not closed"));
                }
                if token.is(",") || token.is(";") {
                    r.next();
                    continue;
                }
                item(r)?;
            }
        });
        self.hold = held;
        if result.is_ok() {
            self.next();
        }
        result
    }

    /// Takes `{ ... }` with whatever is in it.
    pub(super) fn skip_block(&mut self) -> Parsed<()> {
        let open = self.expect("{")?;
        let held = std::mem::take(&mut self.hold);
        let mut depth = 1_usize;
        let mut result = Ok(());
        while depth > 0 {
            let token = self.peek();
            match token.kind {
                Kind::Sign("{") => depth += 1,
                Kind::Sign("}") => depth -= 1,
                Kind::End => {
                    result = self.fail(open.span, "this `{` is not closed");
                    break;
                }
                _ => {}
            }
            if depth == 0 {
                self.hold = held;
            }
            self.next();
        }
        self.hold = held;
        result
    }

    /// What to say about a token that nothing here begins with.
    pub(super) fn unexpected<T>(&mut self, place: &str) -> Parsed<T> {
        let token = self.peek();
        if let Some(word) = token.word() {
            let word = Rc::clone(word);
            if self.scopes.get(&word).is_some() {
                let what = self.scopes.get(&word).map_or("", |v| v.describe());
                return self.fail(
                    token.span,
                    format!("`{word}` is {what}, which has no place in {place}"),
                );
            }
            return self.undeclared(&word, token.span);
        }
        let found = token.describe();
        self.fail(token.span, format!("unexpected {found} in {place}"))
    }

    /// Whether an undeclared identifier may be one of an include that is not known in full.
    /// Reports it either way.
    pub(super) fn undeclared<T>(&mut self, word: &str, span: crate::Span) -> Parsed<T> {
        let near = crate::spelling::nearest(word, self.scopes.names().chain(super::KEYWORDS));
        let help = near.map(|name| format!("a similar name exists: `{name}`"));
        self.fail_with_help(span, format!("`{word}` is not declared"), help)
    }
}
