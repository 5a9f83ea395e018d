//! `log recover`: everything that can be read of a damaged file, written anew.

use std::path::PathBuf;

use grouser_log::container::Container;
use grouser_log::write::{copy, verify};

use super::{copied_object, copied_text, copy_error, refuse_same, target};
use crate::error::{Error, Outcome, Result, shown};
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::report::Report;
use crate::session::Session;
use crate::verbs::estimate::{log_error, note_input};

#[derive(clap::Args, Debug)]
#[command(
    after_help = "The output is read again before it gets its name. Exit 0: nothing is lost; 3: a part is \
        lost, and told with its place; 1: nothing can be read.\n\nExample:\n  grouser log recover cut.mcap \
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
    if Container::kind(file).map_err(log_error)?.is_none() {
        return Err(Error::usage_without_hint(format!(
            "{} begins neither like an MCAP file nor like a ROS 1 bag",
            shown(file)
        )));
    }
    refuse_same(file, path)?;
    let mut output = OutputFile::create(path)?;
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let copied = copy(file, &mut output, format, |offset| progress.reach(offset));
    let copied = copied.map_err(|error| copy_error(error, path))?;
    drop(progress);
    note_input(session, file)?;
    let mut report = Report::done(copied_object(&copied, path), copied_text(&copied, path));
    if copied.messages == 0 && copied.is_partial() {
        // Dropped, the empty file leaves nothing behind.
        report.outcome = Outcome::NoResult;
        report
            .object
            .insert("output".into(), serde_json::Value::Null);
        report.object.insert("verified".into(), false.into());
        report.text = super::damages_text(&copied.damages);
        report.failure = Some(format!("no message can be read of {}", shown(file)));
        return Ok(report);
    }
    verify(output.unfinished()?, &copied).map_err(|error| copy_error(error, path))?;
    output.finish()?;
    if copied.is_partial() {
        report.outcome = Outcome::Partial;
    }
    Ok(report)
}
