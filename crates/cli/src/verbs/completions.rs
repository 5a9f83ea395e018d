//! `completions`: what a shell completes.

use clap_complete::Shell;

use crate::error::Result;
use crate::verb_report::Report;
use grouser_report::Object;

#[derive(clap::Args, Debug)]
#[command(
    about = "Print the completions of a shell",
    after_help = "Example:\n  grouser completions bash > ~/.local/share/bash-completion/completions/grouser"
)]
pub(crate) struct Arguments {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// The completions of `command`.
#[allow(clippy::unnecessary_wraps, reason = "every verb returns a result")]
pub(crate) fn run(arguments: &Arguments, mut command: clap::Command) -> Result<Report> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "grouser", &mut script);
    let text = String::from_utf8_lossy(&script).into_owned();
    Ok(Report::done(
        Object::from_iter([("text".to_owned(), text.as_str().into())]),
        text,
    ))
}
