//! `#if`, `#while`, `#for`, `#switch` and the small directives.

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use crate::Span;

/// A directive that waits for its `#end`.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    pub(super) span: Span,
    pub(super) kind: FlowKind,
}

#[derive(Clone, Debug)]
pub(super) enum FlowKind {
    If,
    Switch,
    /// Where the condition begins.
    While(usize),
    For {
        body: usize,
        name: std::rc::Rc<str>,
        last: f64,
        step: f64,
    },
}

/// What counts as equal in `#switch` and as reached in `#for`, as in POV-Ray.
pub(super) const TOLERANCE: f64 = 1e-10;

impl Reader<'_> {
    /// Whether this directive, met in the value of a `#declare`, must wait until it is stored:
    /// any, except a branch where an operand has to come.
    pub(super) fn ends_value(&self, name: &str) -> bool {
        !(self.after_operator && matches!(name, "if" | "ifdef" | "ifndef" | "switch"))
    }

    /// Runs a directive whose name has been read.
    pub(super) fn directive(&mut self, name: &str, span: Span) -> Parsed<()> {
        match name {
            "declare" | "local" => self.declare(name == "local", span),
            "undef" => self.undef(),
            "include" => self.include(span),
            "macro" => self.define_macro(span),
            "if" => {
                let taken = self.condition()?;
                self.branch(taken, span)
            }
            "ifdef" | "ifndef" => {
                let declared = self.is_declared()?;
                self.branch(declared == (name == "ifdef"), span)
            }
            "else" | "elseif" => self.leave_branch(name, span),
            "while" => {
                let at = self.frames.last().map_or(0, |f| f.at);
                if self.condition()? {
                    self.open_flow(FlowKind::While(at), span);
                    Ok(())
                } else {
                    self.skip_to(&[], span).map(drop)
                }
            }
            "for" => self.start_for(span),
            "switch" => self.switch(span),
            "case" => self.bracketed(1).map(drop),
            "range" => self.bracketed(2).map(drop),
            "break" => self.leave_loop(span),
            "end" => self.end(span),
            "version" => {
                let version = self.held(|r| {
                    let version = r.float()?;
                    r.eat(";");
                    Ok(version)
                })?;
                self.version = version;
                Ok(())
            }
            "default" => self.default_directive(),
            "debug" | "render" | "statistics" => self.held(Self::text).map(drop),
            "warning" => {
                let text = self.held(Self::text)?;
                self.warn(span, format!("the scene warns: {}", text.trim()));
                Ok(())
            }
            "error" => {
                let text = self.held(Self::text)?;
                self.halt(span, format!("the scene stops: {}", text.trim()))
            }
            "fopen" | "fclose" | "read" | "write" => {
                self.halt(span, "reading and writing other files is not supported")
            }
            _ => {
                let known = DIRECTIVES.iter().copied();
                let near = crate::spelling::nearest(name, known);
                let help = near.map(|near| format!("a similar directive exists: `#{near}`"));
                self.fail_with_help(span, format!("there is no directive `#{name}`"), help)
            }
        }
    }

    pub(super) fn open_flow(&mut self, kind: FlowKind, span: Span) {
        self.flow.push(Flow { span, kind });
    }

    /// The innermost open directive of the present file or macro.
    pub(super) fn top_flow(&self) -> Option<&FlowKind> {
        let base = self.frames.last().map_or(0, |frame| frame.flow);
        self.flow[base.min(self.flow.len())..]
            .last()
            .map(|flow| &flow.kind)
    }

    /// `( expression )` as a truth value.
    pub(super) fn condition(&mut self) -> Parsed<bool> {
        Ok(self.bracketed(1)?[0] != 0.0)
    }

    /// `( number, ... )`, exactly `count` of them.
    fn bracketed(&mut self, count: usize) -> Parsed<Vec<f64>> {
        self.expect("(")?;
        let mut values = Vec::with_capacity(count);
        for index in 0..count {
            if index > 0 {
                self.expect(",")?;
            }
            values.push(self.expression()?.v[0]);
        }
        self.expect(")")?;
        Ok(values)
    }

    fn is_declared(&mut self) -> Parsed<bool> {
        let before = std::mem::replace(&mut self.raw_names, true);
        let result = self.expect("(").and_then(|_| {
            let token = self.next();
            let Some(word) = token.word() else {
                return self.fail(token.span, "expected a name");
            };
            let found = self.scopes.get(word).is_some();
            while !self.at(")") {
                // An element of an array counts as declared where the array is.
                if self.peek().kind == Kind::End {
                    return self.fail(token.span, "expected `)` after the name");
                }
                self.next();
            }
            self.next();
            Ok(found)
        });
        self.raw_names = before;
        result
    }

    /// After a condition: enters the branch, or goes on behind it.
    fn branch(&mut self, taken: bool, span: Span) -> Parsed<()> {
        if taken {
            self.open_flow(FlowKind::If, span);
            return Ok(());
        }
        loop {
            match &*self.skip_to(&["else", "elseif"], span)? {
                "else" => {
                    self.open_flow(FlowKind::If, span);
                    return Ok(());
                }
                "elseif" => {
                    if self.condition()? {
                        self.open_flow(FlowKind::If, span);
                        return Ok(());
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    /// `#else` met while running: the branch before it is over.
    fn leave_branch(&mut self, name: &str, span: Span) -> Parsed<()> {
        match self.top_flow() {
            Some(FlowKind::If) => {
                self.flow.pop();
                self.skip_to(&[], span).map(drop)
            }
            // The last case ran on into the rest.
            Some(FlowKind::Switch) if name == "else" => Ok(()),
            _ => self.fail(span, format!("this `#{name}` has no `#if` before it")),
        }
    }

    /// Goes on behind the next directive of `stops` or the `#end`, both of this level.
    pub(super) fn skip_to(&mut self, stops: &[&str], span: Span) -> Parsed<std::rc::Rc<str>> {
        let mut depth = 0_usize;
        if let Some(frame) = self.frames.last_mut() {
            while frame.at < frame.end {
                let (token, next) = frame.tape.token(frame.at, &mut self.words);
                if token.kind == Kind::End {
                    break;
                }
                self.ahead_at = frame.at;
                frame.at = next;
                self.steps += 1;
                let Kind::Directive(name) = &token.kind else {
                    continue;
                };
                match &**name {
                    "if" | "ifdef" | "ifndef" | "while" | "for" | "switch" | "macro" => depth += 1,
                    "end" if depth > 0 => depth -= 1,
                    "end" => return Ok(std::rc::Rc::clone(name)),
                    other if depth == 0 && stops.contains(&other) => {
                        return Ok(std::rc::Rc::clone(name));
                    }
                    _ => {}
                }
            }
        }
        self.fail(span, "this has no `#end`")
    }

    /// The place of the `#end` that closes what begins here; goes on behind it.
    pub(super) fn skip_body(&mut self, span: Span) -> Parsed<usize> {
        self.skip_to(&[], span)?;
        Ok(self.ahead_at)
    }

    fn switch(&mut self, span: Span) -> Parsed<()> {
        let value = self.bracketed(1)?[0];
        loop {
            let matched = match &*self.skip_to(&["case", "range", "else"], span)? {
                "case" => (self.bracketed(1)?[0] - value).abs() < TOLERANCE,
                "range" => {
                    let ends = self.bracketed(2)?;
                    (ends[0] - TOLERANCE..=ends[1] + TOLERANCE).contains(&value)
                }
                "else" => true,
                _ => return Ok(()),
            };
            if matched {
                self.open_flow(FlowKind::Switch, span);
                return Ok(());
            }
        }
    }
}

const DIRECTIVES: [&str; 22] = [
    "declare", "local", "undef", "include", "macro", "if", "ifdef", "ifndef", "else", "elseif",
    "while", "for", "switch", "case", "range", "break", "end", "version", "default", "debug",
    "warning", "error",
];
