//! What is said of statements that are not read.

use crate::{Diagnostic, Severity, Span};

use super::lower::Lowering;
use super::modules;
use super::syntax::Statement;

impl Lowering<'_> {
    pub(super) fn left_out(&mut self, span: Span, why: &str) {
        self.diagnostics
            .warning(span, format!("{why}; it is left out"));
    }

    pub(super) fn unknown_module(&mut self, statement: &Statement<'_>) {
        let name = statement.name;
        let help = if modules::is_evaluated(name) {
            Some(
                "a dump has the outcome of this in its place; export one with \
                 `openscad -o model.csg model.scad`"
                    .to_owned(),
            )
        } else {
            let near = crate::spelling::nearest(name, modules::names());
            near.map(|near| format!("did you mean `{near}`?"))
        };
        self.diagnostics.push(Diagnostic {
            severity: Severity::Error,
            span: Some(statement.span),
            message: format!("there is no module called `{name}`"),
            help,
        });
    }
}
