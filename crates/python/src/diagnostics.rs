//! What an importer has to say, as Python objects.

use octray::import::{Diagnostics, Severity};
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    octray,
    SceneError,
    PyValueError,
    "A scene that cannot be rendered. `diagnostics` lists what is wrong, with positions."
);

/// One message about a scene file.
#[pyclass(frozen, get_all, module = "octray")]
#[derive(Clone, Debug)]
pub(crate) struct Diagnostic {
    /// `"error"` or `"warning"`.
    severity: &'static str,
    /// What is wrong, one sentence.
    message: String,
    /// What would help, if that is known.
    help: Option<String>,
    /// The file, as it was named; `None` if the message is about no place in particular.
    file: Option<String>,
    /// Line in the file, from 1.
    line: Option<usize>,
    /// Column in characters, from 1.
    column: Option<usize>,
    /// The message for a terminal, with position and excerpt.
    text: String,
}

#[pymethods]
impl Diagnostic {
    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let first = self.text.lines().next().unwrap_or_default();
        format!("<Diagnostic {first}>")
    }
}

/// All messages of one import; the last one counts those that were not kept.
pub(crate) fn listed(diagnostics: &Diagnostics) -> Vec<Diagnostic> {
    let mut list: Vec<Diagnostic> = diagnostics
        .iter()
        .map(|d| {
            let place = d.span.map(|span| diagnostics.position(span));
            Diagnostic {
                severity: match d.severity {
                    Severity::Warning => "warning",
                    Severity::Error => "error",
                },
                message: d.message.clone(),
                help: d.help.clone(),
                file: place.map(|(path, ..)| path.display().to_string()),
                line: place.map(|(_, line, _)| line),
                column: place.map(|(.., column)| column),
                text: diagnostics.render(d),
            }
        })
        .collect();
    if diagnostics.dropped() > 0 {
        let message = format!("{} more messages are not shown", diagnostics.dropped());
        list.push(Diagnostic {
            severity: "warning",
            text: format!("warning: {message}"),
            message,
            help: None,
            file: None,
            line: None,
            column: None,
        });
    }
    list
}

/// The exception for an import that has errors.
pub(crate) fn scene_error(py: Python<'_>, diagnostics: &Diagnostics) -> PyErr {
    let list = listed(diagnostics);
    let texts: Vec<&str> = list.iter().map(|d| d.text.as_str()).collect();
    let error = SceneError::new_err(texts.join("\n"));
    match error.value(py).setattr("diagnostics", list) {
        Ok(()) => error,
        Err(failed) => failed,
    }
}

/// The exception for a scene that was put together wrongly; it has no positions.
pub(crate) fn invalid_scene(py: Python<'_>, problems: &[impl std::fmt::Display]) -> PyErr {
    let mut diagnostics = Diagnostics::default();
    for problem in problems {
        diagnostics.error(None, problem.to_string());
    }
    scene_error(py, &diagnostics)
}
