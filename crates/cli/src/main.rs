//! The command `grouser`: arguments in, tables, files and figures out. It computes nothing about wheels
//! itself.
//!
//! A verb is a folder or a file in `verbs/`: its arguments (clap), and a function that runs it in a session and returns
//! a report. What verbs share stands once: errors in `error`, exit codes in `exit`, files in `input` and `output`.
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
mod wrap;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser as _};

use crate::command::Command;
use crate::session::Session;

fn main() -> ExitCode {
    interrupt::install();
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let command = match Command::try_parse_from(&arguments) {
        Ok(command) => command,
        Err(error) => return usage::answer(&error, &arguments),
    };
    let command_json = command.json;
    let mut session = Session::new(command_json);
    let ended = verbs::run(command.verb, Command::command(), &mut session)
        .and_then(|report| session.print(report));
    match ended {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => terminal::complain(&error, command_json),
    }
}
