//! Converts errors to Python exceptions.

use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use sinew_bindings::{Failure, caught};

pyo3::create_exception!(_sinew, SinewError, PyException, "A call that failed within Sinew.");
pyo3::create_exception!(
    _sinew,
    FileError,
    SinewError,
    "A file that cannot be read or written, or is invalid; the message names the file and the place."
);

pyo3::create_exception!(_sinew, Cancelled, SinewError, "A bake that its progress function ended.");

/// Returns the exception for a failure.
pub fn failed(failure: Failure) -> PyErr {
    if failure.is_of_file { FileError::new_err(failure.what) } else { PyValueError::new_err(failure.what) }
}

/// Returns the exception for a file that could not be read or written.
pub fn of_file(error: sinew::formats::Error) -> PyErr {
    failed(Failure::from(error))
}

/// Returns the exception for an invalid argument.
pub fn bad(what: impl Into<String>) -> PyErr {
    PyValueError::new_err(what.into())
}

/// Runs a call that panics about its arguments before it changes any state; the panic becomes a `ValueError`.
pub fn refused<T>(call: impl FnOnce() -> T) -> PyResult<T> {
    caught(call).map_err(bad)
}

/// Runs a call that must not panic: a bug becomes a `SinewError` instead of ending the interpreter.
pub fn guarded<T>(call: impl FnOnce() -> T) -> PyResult<T> {
    caught(call).map_err(SinewError::new_err)
}
