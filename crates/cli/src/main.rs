//! The command `grouser`: arguments in, tables, files and figures out.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(grouser::run_command(std::env::args_os()))
}
