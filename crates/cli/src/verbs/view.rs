//! `view`: the page, which a program next to this one shows.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use crate::companion::Companion;
use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::files_in_use;
use crate::output::OutputFile;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

/// The program that shows the page. It is not part of this one: a web server and WebAssembly are more than
/// the command needs.
const PROGRAM: Companion = Companion {
    name: "grouser-view",
    does: "shows the page",
    built_with: "`page/build`",
};

#[derive(clap::Args, Debug)]
#[command(
    about = "Open the page: a wheel on soil to explore, a run to look at",
    long_about = "Open the page: a wheel on soil to explore, a run to look at. The page is a local server's \
        (127.0.0.1, with a random token), or one HTML file that opens without a server. It is shown by the \
        program `grouser-view`, which is found next to `grouser` or on the path; `page/build` builds it.",
    after_help = "Examples:\n  grouser view\n  grouser view estimates.csv\n  grouser view log.mcap --robot robot.toml\n  \
        grouser view log.mcap --robot robot.toml --follow\n  grouser view --export page.html"
)]
pub(crate) struct Arguments {
    /// A run to open: the table of `estimate -o`, or a log
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// The robot of the log: the server estimates while the page shows it, so that a log of any size opens
    #[arg(
        long,
        value_name = "R.toml",
        requires = "file",
        conflicts_with = "export"
    )]
    robot: Option<PathBuf>,
    /// The column map of a CSV log [default: the robot file's, or `columns.toml` next to it]
    #[arg(long, value_name = "C.toml", requires = "robot")]
    map: Option<PathBuf>,
    /// The log (a table, MCAP or a bag) is still written: the page shows its newest moment
    #[arg(long, requires = "robot")]
    follow: bool,
    /// Write the page, with the run in it, as one HTML file instead of serving it
    #[arg(long, value_name = "F.html")]
    export: Option<PathBuf>,
    /// Port to listen on [default: a free one]
    #[arg(long, value_name = "PORT", conflicts_with = "export")]
    port: Option<u16>,
}

/// What was run.
#[derive(Clone, Copy)]
struct Ran<'a> {
    program: &'a Path,
    arguments: &'a Arguments,
    status: ExitStatus,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Report> {
    let program = PROGRAM.find()?;
    let mut command = Command::new(&program);
    if let Some(file) = &arguments.file {
        files_in_use::reads(file);
    }
    for (flag, path) in [("--robot", &arguments.robot), ("--map", &arguments.map)] {
        if let Some(path) = path {
            files_in_use::reads(path);
            command.arg(flag).arg(path);
        }
    }
    if arguments.follow {
        command.arg("--follow");
    }
    if let Some(path) = &arguments.export {
        // refused here, by the rules of all outputs, before the program begins it
        drop(OutputFile::create(path)?);
        command.arg("--export").arg(path);
    }
    if let Some(port) = arguments.port {
        command.arg("--port").arg(port.to_string());
    }
    if let Some(file) = &arguments.file {
        command.arg("--").arg(file);
    }
    // standard output is this program's: its object under --json
    let status = command
        .stdout(Stdio::from(std::io::stderr()))
        .status()
        .map_err(|reason| Error::file("run", &program, &reason))?;
    let ran = Ran {
        program: &program,
        arguments,
        status,
    };
    let text = match &arguments.export {
        Some(path) if status.success() => format!("wrote {}\n", path.display()),
        _ => String::new(),
    };
    Ok(Report {
        outcome: if status.success() {
            Outcome::Done
        } else {
            Outcome::NoResult
        },
        failure: (!status.success()).then(|| format!("`{}` ended with {status}", PROGRAM.name)),
        ..Report::done(fields().object(ran), text)
    })
}

fn fields<'a>() -> Fields<'a, Ran<'a>> {
    fields! { |ran: Ran<'a>|
        "program" "the program that was run" = ran.program.display().to_string();
        "export" "the file that was written" = ran.arguments.export.as_ref().map(|path| path.display().to_string());
        "exit_code" "the program's exit code" = ran.status.code().map(i64::from);
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}
