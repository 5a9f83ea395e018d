//! `live`: the node beside a running robot, which a program beside this one is.

use std::ffi::OsString;
use std::process::Command;

use crate::companion::Companion;
use crate::error::{Error, Result};
use crate::verb_report::Report;

/// The program of the node. It is not part of this one: its transports are five times the command's dependencies.
const PROGRAM: Companion = Companion {
    name: "grouser-live",
    does: "is the node",
    built_with: "`live/build`",
};

#[derive(clap::Args, Debug)]
#[command(
    about = "Slip of each wheel of a running ROS 2 robot, without a ROS installation",
    long_about = "Slip of each wheel of a running ROS 2 robot, without a ROS installation. The node is the program \
        `grouser-live`, which is found next to `grouser` or on the path; `live/build` builds it. It takes the arguments \
        unchanged.",
    after_help = "Examples:\n  grouser live --help\n  grouser live --robot robot.toml",
    disable_help_flag = true
)]
pub(crate) struct Arguments {
    /// The node's arguments; `--help` lists them
    #[arg(
        value_name = "ARGUMENTS",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    arguments: Vec<OsString>,
}

/// The node takes this process over: signals and the exit code are its own.
pub(crate) fn run(arguments: &Arguments) -> Result<Report> {
    let program = PROGRAM.find()?;
    let mut command = Command::new(&program);
    command.args(&arguments.arguments);
    #[cfg(unix)]
    let reason = std::os::unix::process::CommandExt::exec(&mut command);
    #[cfg(not(unix))]
    let reason = match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(1)),
        Err(reason) => reason,
    };
    Err(Error::file("run", &program, &reason))
}
