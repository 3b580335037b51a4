//! Errors of the library as Python's.

use std::io;
use std::path::Path;

use cancellation::RunError;
use grainsmooth::Error;
use pyo3::create_exception;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    grainsmooth._grainsmooth,
    InternalError,
    PyRuntimeError,
    "A mistake in grainsmooth itself; please report it."
);

/// The numbers that systems have for what `io::ErrorKind` names, and for all else "input/output error".
const NO_ENTRY: i32 = 2;
const INPUT_OUTPUT: i32 = 5;

/// The same text: `OSError` for files, `MemoryError` for what does not fit, else `ValueError`.
pub fn to_python(error: Error) -> PyErr {
    let text = error.to_string();
    match &error {
        Error::Memory(_) => PyMemoryError::new_err(text),
        Error::NoOutputDirectory { path, .. } => os_error(NO_ENTRY, text, path),
        _ => match error.file_cause() {
            // What has an error within is no failure of the system, but of what is to be written.
            Some((path, cause)) if cause.get_ref().is_none() => os_error(number(cause), text, path),
            _ => PyValueError::new_err(text),
        },
    }
}

/// A mistake in an argument.
pub fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What ended a run that gave no result.
pub fn ended(error: RunError) -> PyErr {
    match error {
        RunError::Threads(_) => PyOSError::new_err(error.to_string()),
        _ => InternalError::new_err(error.to_string()),
    }
}

fn os_error(number: i32, text: String, path: &Path) -> PyErr {
    PyOSError::new_err((number, text, path.as_os_str().to_owned()))
}

fn number(cause: &io::Error) -> i32 {
    cause.raw_os_error().unwrap_or(if cause.kind() == io::ErrorKind::NotFound {
        NO_ENTRY
    } else {
        INPUT_OUTPUT
    })
}
