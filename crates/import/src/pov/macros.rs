//! `#macro`: definition and expansion; `function { ... }`.

use std::rc::Rc;

use super::lexer::{Kind, Tape, Token};
use super::reader::{Parsed, Reader};
use super::value::{Function, Macro, Terms, Value};
use crate::Span;

impl Reader<'_> {
    /// `#macro Name (A, B) ... #end`.
    pub(super) fn define_macro(&mut self, span: Span) -> Parsed<()> {
        let before = std::mem::replace(&mut self.raw_names, true);
        let head = self.macro_head();
        self.raw_names = before;
        let (name, parameters) = head?;
        let start = self.frames.last().map_or(0, |frame| frame.at);
        let end = self.skip_body(span)?;
        let Some(frame) = self.frames.last() else {
            return Ok(());
        };
        let tape = frame.tape.clone();
        let defined = Macro {
            parameters,
            tape,
            start,
            end,
        };
        self.scopes.declare(name, Value::Macro(Rc::new(defined)));
        Ok(())
    }

    fn macro_head(&mut self) -> Parsed<(Rc<str>, Vec<Rc<str>>)> {
        let name = self.new_name()?;
        self.expect("(")?;
        let mut parameters = Vec::new();
        while !self.eat(")") {
            if self.eat(",") || self.eat_word("optional") {
                continue;
            }
            parameters.push(self.new_name()?);
        }
        Ok((name, parameters))
    }

    /// A name that is being declared.
    pub(super) fn new_name(&mut self) -> Parsed<Rc<str>> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            let found = token.describe();
            return self.fail(token.span, format!("expected a name, found {found}"));
        };
        self.next();
        Ok(word)
    }

    /// Reads the arguments of a macro and goes on in its body.
    pub(super) fn call_macro(&mut self, name: &str, called: &Macro, span: Span) -> Parsed<()> {
        let held = std::mem::take(&mut self.hold);
        let arguments = self.macro_arguments(name, called, span);
        self.hold = held;
        let arguments = arguments?;
        let scopes = self.scopes.depth();
        self.scopes.open();
        for (parameter, (value, outer)) in called.parameters.iter().zip(arguments) {
            if let Some(value) = value {
                self.scopes.local(Rc::clone(parameter), value);
            }
            if let Some(outer) = outer {
                self.scopes.bind(Rc::clone(parameter), outer);
            }
        }
        let tape = called.tape.clone();
        let pushed = self.push_frame(tape, called.start, called.end, scopes);
        if pushed.is_err() {
            self.scopes.truncate(scopes);
        }
        pushed
    }

    #[allow(
        clippy::type_complexity,
        reason = "a pair that lives for the length of one call"
    )]
    fn macro_arguments(
        &mut self,
        name: &str,
        called: &Macro,
        span: Span,
    ) -> Parsed<Vec<(Option<Value>, Option<Rc<str>>)>> {
        self.expect("(")?;
        let mut arguments = Vec::new();
        while !self.at(")") {
            if self.peek().kind == Kind::End {
                return self.fail(span, "the arguments of this macro are not closed by `)`");
            }
            if arguments.len() >= called.parameters.len() {
                let count = called.parameters.len();
                return self.fail(
                    self.last,
                    format!("`{name}` takes {count} arguments, here are more"),
                );
            }
            arguments.push(self.argument()?);
            if !self.eat(",") && !self.at(")") {
                self.expect(")")?;
            }
        }
        if arguments.len() < called.parameters.len() {
            let (given, count) = (arguments.len(), called.parameters.len());
            return self.fail(
                span,
                format!("`{name}` takes {count} arguments, here are {given}"),
            );
        }
        self.next();
        Ok(arguments)
    }

    /// One argument: a value, or a lone name, which is passed by reference.
    fn argument(&mut self) -> Parsed<(Option<Value>, Option<Rc<str>>)> {
        let token = self.peek();
        if let Some(word) = token.word() {
            let alone = self
                .behind_next()
                .is_some_and(|next| next.is(",") || next.is(")"));
            let value = self.scopes.get(word).cloned();
            if alone && (value.is_some() || !super::is_reserved(word)) {
                if value.is_none() && self.partial_includes {
                    return Ok((Some(self.rvalue()?), None));
                }
                self.next();
                return Ok((value, Some(Rc::clone(word))));
            }
        }
        Ok((Some(self.rvalue()?), None))
    }

    /// `(x, y) { expression }` or `{ expression }` behind `function`.
    pub(super) fn function(&mut self) -> Parsed<Value> {
        let parameters = if self.eat("(") {
            let mut names = Vec::new();
            while !self.eat(")") {
                if !self.eat(",") {
                    names.push(self.new_name()?);
                }
            }
            names
        } else {
            ["x", "y", "z"].map(Rc::from).to_vec()
        };
        let open = self.expect("{")?;
        let held = std::mem::take(&mut self.hold);
        let body = self.function_body(open.span, &parameters);
        self.hold = held;
        let Some(body) = body? else {
            return Ok(Value::Ignored("a function of a pattern"));
        };
        self.book(64 * body.len() as u64)?;
        Ok(Value::Function(Rc::new(Function { parameters, body })))
    }

    /// The tokens to the closing brace, numbers put in for names as they are now.
    fn function_body(&mut self, open: Span, parameters: &[Rc<str>]) -> Parsed<Option<Rc<[Token]>>> {
        let mut body: Vec<Token> = Vec::new();
        let mut depth = 1;
        let mut pattern = false;
        loop {
            let mut token = self.peek();
            match &token.kind {
                Kind::Sign("{") => (depth, pattern) = (depth + 1, true),
                Kind::Sign("}") => depth -= 1,
                Kind::End => return self.fail(open, "this `{` of the function is not closed"),
                Kind::Word(word)
                    if !parameters.contains(word)
                        && !body.last().is_some_and(|before| before.is(".")) =>
                {
                    if let Some(Value::Terms(Terms { count: 1, v })) = self.scopes.get(word) {
                        token.kind = Kind::Number(v[0]);
                    }
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
            self.next();
            body.push(token);
        }
        let close = self.peek();
        self.next();
        // A sign that continues no expression, so that evaluation stops here.
        body.push(Token {
            kind: Kind::Sign(";"),
            span: close.span,
        });
        Ok((!pattern).then(|| body.into()))
    }

    /// The value of a function at `arguments`.
    pub(super) fn evaluate(&mut self, called: &Function, arguments: &[f64]) -> Parsed<f64> {
        let scopes = self.scopes.depth();
        self.scopes.open();
        for (parameter, &argument) in called.parameters.iter().zip(arguments) {
            let value = Value::Terms(Terms::number(argument));
            self.scopes.local(Rc::clone(parameter), value);
        }
        let frames = self.frames.len();
        let held = std::mem::take(&mut self.hold);
        let ahead = self.swap_look_ahead(None);
        let body = Rc::clone(&called.body);
        let end = body.len();
        let result = self
            .push_frame(Tape::Tokens(body), 0, end, scopes)
            .and_then(|()| self.nested(Self::expression))
            .and_then(|terms| {
                if self.at(";") {
                    Ok(terms.v[0])
                } else {
                    self.unexpected("the function")
                }
            });
        self.frames.truncate(frames);
        self.scopes.truncate(scopes);
        self.hold = held;
        self.swap_look_ahead(ahead);
        result
    }
}
