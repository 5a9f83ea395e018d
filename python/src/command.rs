//! The command `grouser`, for the console script.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command `grouser` with `arguments`, the program's name first, and returns its exit code.
///
/// An interrupt ends the process, as it does in a shell: call it from a launcher only.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| grouser::run_command(arguments))
}
