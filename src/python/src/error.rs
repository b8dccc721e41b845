//! The library's errors as Python exceptions.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use tokosen::Error;

/// The exception of an error, an instance of a class of `tokosen._errors`.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let name = match error.root() {
        root if root.is_about_parameters() => "ParameterError",
        Error::Io { .. } => "FileError",
        Error::OutOfMemory { .. } => "OutOfMemoryError",
        _ => "InputError",
    };
    named(py, name, error.with_causes())
}

/// An exception for a wrong argument.
pub fn parameter(py: Python<'_>, message: impl Into<String>) -> PyErr {
    named(py, "ParameterError", message.into())
}

/// An exception of a class of `tokosen._errors`.
fn named(py: Python<'_>, class: &str, message: String) -> PyErr {
    let made = py.import("tokosen._errors").and_then(|module| module.getattr(class)?.call1((message.as_str(),)));
    made.map_or_else(|_| PyRuntimeError::new_err(message), PyErr::from_value)
}

/// A finding for a warning: severity, code, message.
pub type Warned = (&'static str, &'static str, String);
