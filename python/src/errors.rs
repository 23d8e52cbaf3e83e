//! Failures as exceptions of `fractum.errors`.

use fractum::{ExitCode, Failure};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// The exception that a failure is in Python, with the text of the program.
pub(crate) fn raise(py: Python<'_>, failure: &Failure) -> PyErr {
    let class = match failure.exit_code() {
        ExitCode::Interrupted => return PyKeyboardInterrupt::new_err(failure.to_string()),
        ExitCode::Stopped => "StoppedError",
        ExitCode::Machine => "MachineError",
        ExitCode::Input | ExitCode::Done => "CaseError",
    };
    let details = match failure {
        Failure::Input(diagnostics) => serde_json::to_string(&diagnostics.0).unwrap_or_default(),
        _ => "[]".to_owned(),
    };
    let made = py.import("fractum.errors").and_then(|module| module.getattr(class));
    match made.and_then(|class| class.call1((failure.to_string(), details))) {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// A mistake of the caller that is none of the case.
pub(crate) fn wrong(py: Python<'_>, text: impl Into<String>) -> PyErr {
    raise(py, &Failure::input(text))
}
