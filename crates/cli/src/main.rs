//! The command `grouser`.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    grouser::run(std::env::args_os())
}
