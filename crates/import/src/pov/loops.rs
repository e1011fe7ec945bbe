//! `#for`, `#end` and `#break`: where reading goes on.

use super::directives::{FlowKind, TOLERANCE};
use super::reader::{Parsed, Reader};
use super::value::{Terms, Value};
use crate::Span;

impl Reader<'_> {
    /// `#break`: behind the `#end` of the innermost loop or switch.
    pub(super) fn leave_loop(&mut self, span: Span) -> Parsed<()> {
        loop {
            match self.top_flow() {
                Some(FlowKind::If) => {
                    self.flow.pop();
                    self.skip_to(&[], span)?;
                }
                Some(_) => {
                    self.flow.pop();
                    return self.skip_to(&[], span).map(drop);
                }
                None => return self.fail(span, "this `#break` is in no loop and no `#switch`"),
            }
        }
    }

    /// `#for (Name, first, last [, step])`.
    pub(super) fn start_for(&mut self, span: Span) -> Parsed<()> {
        self.expect("(")?;
        let token = self.next();
        let Some(name) = token.word().cloned() else {
            return self.fail(token.span, "expected the loop's variable");
        };
        self.expect(",")?;
        let first = self.expression()?.v[0];
        self.expect(",")?;
        let last = self.expression()?.v[0];
        let step = if self.eat(",") {
            self.expression()?.v[0]
        } else {
            1.0
        };
        self.expect(")")?;
        if step == 0.0 || step.is_nan() {
            return self.fail(span, "a loop cannot go in steps of 0");
        }
        let body = self.frames.last().map_or(0, |frame| frame.at);
        let value = Value::Terms(Terms::number(first));
        self.scopes.local(std::rc::Rc::clone(&name), value);
        if past(first, last, step) {
            return self.skip_to(&[], span).map(drop);
        }
        let kind = FlowKind::For {
            body,
            name,
            last,
            step,
        };
        self.open_flow(kind, span);
        Ok(())
    }

    pub(super) fn end(&mut self, span: Span) -> Parsed<()> {
        let Some(kind) = self.top_flow().cloned() else {
            return self.fail(span, "this `#end` closes nothing");
        };
        let behind = self.frames.last().map_or(0, |frame| frame.at);
        let again = match kind {
            FlowKind::If | FlowKind::Switch => false,
            FlowKind::While(condition) => {
                self.jump(condition);
                self.condition()?
            }
            FlowKind::For {
                body,
                name,
                last,
                step,
            } => {
                let now = match self.scopes.get(&name) {
                    Some(Value::Terms(terms)) => terms.v[0] + step,
                    _ => return self.fail(span, format!("`{name}` is no number any more")),
                };
                self.scopes.local(name, Value::Terms(Terms::number(now)));
                self.jump(body);
                !past(now, last, step)
            }
        };
        if !again {
            self.flow.pop();
            self.jump(behind);
        }
        Ok(())
    }
}

fn past(value: f64, last: f64, step: f64) -> bool {
    if step > 0.0 {
        value > last + TOLERANCE
    } else {
        value < last - TOLERANCE
    }
}
