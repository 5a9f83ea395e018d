//! One run of the command, from its arguments to its exit code.

use std::ffi::OsString;

use clap::{CommandFactory as _, Parser as _};

use crate::command::Command;
use crate::session::Session;
use crate::{files_in_use, interrupt, terminal, usage, verbs};

/// Runs the command `grouser` with `arguments`, the program's name first: results go to standard output,
/// messages to standard error, and signals are handled until the process ends. Returns the exit code.
///
/// This is for programs that bring the command along under a launcher of their own; within a program, call
/// the libraries. An interrupt (Ctrl-C, SIGTERM) ends the process with exit code 130.
pub fn run_command(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    interrupt::install();
    files_in_use::clear();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let command = match Command::try_parse_from(&arguments) {
        Ok(command) => command,
        Err(error) => {
            terminal::lay_out(3, false);
            return usage::answer(&error, &arguments);
        }
    };
    let command_json = command.json;
    terminal::lay_out(command.digits.into(), command.verbose);
    let mut session = Session::new(command_json);
    let ended = verbs::run(command.verb, Command::command(), &mut session)
        .and_then(|report| session.print(report));
    match ended {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => terminal::complain(&error, command_json),
    }
}
