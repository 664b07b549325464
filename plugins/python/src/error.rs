//! The library's errors as exceptions; the classes are in `fieldtrace/errors.py`.

use fieldtrace::Error;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::io::ErrorKind;

/// The exception for an error: that of a function of the caller's own as it was raised, else one of the package's with the
/// library's text.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    own(py, error).unwrap_or_else(|| {
        let (class, cause) = class(error);
        make(py, class, &text(error), cause.and_then(std::io::Error::raw_os_error)).unwrap_or_else(|e| e)
    })
}

/// The exception of an option that is out of its range.
pub fn option(py: Python<'_>, name: &str, reason: &str) -> PyErr {
    make(py, "OptionError", &format!("{name}: {reason}"), None).unwrap_or_else(|e| e)
}

/// The exception of an option that is not of a type that it can be.
pub fn wrong_type(name: &str, wanted: &str, value: &Bound<'_, PyAny>) -> PyErr {
    let given = value.get_type().name().map_or_else(|_| "this".into(), |name| name.to_string());
    PyTypeError::new_err(format!("{name} is to be {wanted}, not {given}"))
}

fn make(py: Python<'_>, class: &str, text: &str, errno: Option<i32>) -> PyResult<PyErr> {
    let error = py.import("fieldtrace.errors")?.getattr(class)?.call1((text,))?;
    if let Some(errno) = errno {
        error.setattr("errno", errno)?;
    }
    Ok(PyErr::from_value(error))
}

/// What a function of the caller's own raised.
fn own(py: Python<'_>, error: &Error) -> Option<PyErr> {
    let mut next: Option<&(dyn std::error::Error + 'static)> = Some(error);
    while let Some(error) = next {
        if let Some(raised) = error.downcast_ref::<PyErr>() {
            return Some(raised.clone_ref(py));
        }
        next = error.source();
    }
    None
}

/// An error and its causes on one line, options by the names that they have in Python.
fn text(error: &Error) -> String {
    let mut text = match error {
        Error::Option { option, reason } => format!("{}: {reason}", option.replace('-', "_")),
        _ => error.to_string().replace("--page", "page"),
    };
    let mut next = std::error::Error::source(error);
    while let Some(cause) = next {
        text = format!("{text}: {cause}");
        next = cause.source();
    }
    text
}

/// The name of an error's class, and what the operating system said.
fn class(error: &Error) -> (&'static str, Option<&std::io::Error>) {
    match error {
        Error::Read { cause, .. } | Error::List { cause, .. } if cause.kind() == ErrorKind::NotFound => {
            ("MissingFileError", Some(cause))
        }
        Error::Read { cause, .. } | Error::List { cause, .. } | Error::Write { cause, .. } => {
            ("FileError", Some(cause))
        }
        Error::Exists { .. } => ("ExistingFileError", None),
        Error::Option { .. } | Error::Plan { .. } => ("OptionError", None),
        Error::Decode { .. }
        | Error::TooLarge { .. }
        | Error::ManyPages { .. }
        | Error::NoSuchPage { .. }
        | Error::NothingVisible { .. }
        | Error::Graph { .. }
        | Error::FieldSize { .. }
        | Error::InkSize { .. }
        | Error::Weights { .. } => ("InputError", None),
        Error::TimedOut { .. } => ("TimedOut", None),
        Error::Cancelled => ("Cancelled", None),
        _ => ("Error", None),
    }
}
