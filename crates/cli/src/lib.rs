//! The command `grouser`: arguments in, tables, files and figures out. It computes nothing about wheels
//! itself.
//!
//! A verb is one file in `verbs/`: its arguments (clap), a function that runs it in a session and gives a
//! report, and nothing else. Whatever a verb shares with the others stands once:
//! errors and exit codes in `error`, the JSON envelope in `report`, files in `input` and `output`.
#![forbid(unsafe_code)]

mod command;
mod csv_line;
mod error;
mod exit;
mod figure_file;
mod input;
mod interrupt;
mod law_error;
mod library_error;
mod lines;
mod operation;
mod output;
mod output_choice;
#[cfg(feature = "parquet")]
mod parquet_table;
mod progress;
mod report;
mod session;
mod soil_choice;
mod terminal;
mod usage;
mod verbs;
mod wheel_choice;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser as _;

use crate::command::Command;
use crate::session::Session;

/// Runs the command with `arguments`, the program's name first; writes to standard output and standard
/// error and gives the exit code: 0 done, 1 ended without its result, 2 bad usage or input, 3 partial.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    interrupt::install();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let command = match Command::try_parse_from(&arguments) {
        Ok(command) => command,
        Err(error) => return usage::answer(&error, &arguments),
    };
    let command_json = command.json;
    let mut session = Session::new(command_json);
    let ended = verbs::run(command.verb, &mut session).and_then(|report| session.print(report));
    match ended {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => terminal::complain(&error, command_json),
    }
}

/// The Rust of the tutorials compiles and holds.
#[cfg(doctest)]
mod tutorials {
    #[doc = include_str!("../../../docs/tutorials/5-on-the-robot.md")]
    mod on_the_robot {}
    #[doc = include_str!("../../../docs/tutorials/6-as-a-library.md")]
    mod as_a_library {}
}
