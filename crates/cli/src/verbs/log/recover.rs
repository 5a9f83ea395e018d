//! `log recover`: everything that can be read of a damaged file, written anew.

use std::path::PathBuf;

use grouser_log::container::Container;
use grouser_log::write::{copy, verify};

use super::copied::{self, Copy, copy_error, damages_text, target};
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::files_in_use;
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    after_help = "The output is read again before it gets its name. Exit 0: nothing is lost; 3: a part is \
        lost, and reported with its place; 1: nothing can be read.\n\nExample:\n  grouser log recover cut.mcap \
        whole.mcap"
)]
pub(super) struct Arguments {
    /// The damaged file: MCAP or a ROS 1 bag
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The new file: .mcap, or .bag for messages of ROS 1
    #[arg(value_name = "OUT")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let (file, path) = (&arguments.file, &arguments.output);
    let Some(format) = target(path)? else {
        return Err(Error::usage(
            "`log recover` writes MCAP files and bags",
            "`log convert` writes a topic as a table",
        ));
    };
    if Container::kind(file)?.is_none() {
        return Err(Error::usage_without_hint(format!(
            "{} begins neither like an MCAP file nor like a ROS 1 bag",
            shown(file)
        )));
    }
    files_in_use::reads(file);
    let mut output = OutputFile::create(path)?;
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let copied = copy(file, &mut output, format, |offset| progress.reach(offset));
    let copied = copied.map_err(|error| copy_error(error, path))?;
    drop(progress);
    session.used_file(file)?;
    let object = |output| {
        copied::fields().object(Copy {
            copied: &copied,
            output,
        })
    };
    if copied.messages == 0 && copied.is_partial() {
        // Dropped, the empty file leaves nothing behind.
        let failure = format!("no message can be read of {}", shown(file));
        let report = Report::done(object(None), damages_text(&copied.damages));
        return Ok(report.failing(Some(failure)));
    }
    verify(output.unfinished()?, &copied).map_err(|error| copy_error(error, path))?;
    output.finish()?;
    let mut report = Report::done(object(Some(path)), copied::text(&copied, path));
    if copied.is_partial() {
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}
