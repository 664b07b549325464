//! The native half of the Python package `fieldtrace`.
//!
//! [`tracer`] traces, [`mod@drawing`] and [`mod@stroke`] are what comes out, [`mod@batch`] runs over many inputs. [`caller`] keeps
//! Python responsive while Rust works, and is the way back to functions of the caller's own ([`hooks`]).

mod batch;
mod caller;
mod drawing;
mod error;
mod hooks;
mod image;
mod options;
mod stroke;
mod tracer;

use pyo3::prelude::*;
use std::ffi::OsString;
use std::process::ExitCode;

/// As in the command: the stages make many large temporaries, which this allocator keeps for the next.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The native half of the package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::Batch;
    #[pymodule_export]
    use super::drawing::Drawing;
    #[pymodule_export]
    use super::stroke::{Solid, Stroke};
    #[pymodule_export]
    use super::tracer::Tracer;
    #[pymodule_export]
    use super::{formats, main, version};
}

/// The names of the formats that drawings are written in.
#[pyfunction]
fn formats() -> Vec<&'static str> {
    fieldtrace::write::formats().iter().map(|format| format.name()).collect()
}

/// The version of the package.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// Runs the command on arguments, of which the first is the program's name, and gives its exit code.
#[pyfunction]
fn main(py: Python<'_>, args: Vec<OsString>) -> u8 {
    let code = py.detach(|| fieldtrace::cli::main_with(args));
    (0..=u8::MAX).find(|&number| ExitCode::from(number) == code).unwrap_or(1)
}
