//! `log`: what a recorded log holds, in another format, and what can be saved of a damaged one.

mod convert;
mod copied;
mod info;
mod recover;
mod sheet;

use crate::error::Result;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    about = "List what a recorded log holds, convert it, recover a damaged one (MCAP, ROS 1 bag, CSV)",
    after_help = "Examples:\n  grouser log info log.mcap\n  grouser log convert log.bag log.mcap"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    job: Job,
}

#[derive(clap::Subcommand, Debug)]
enum Job {
    /// Topics or columns, types, rates, gaps, clock jumps, damage, and what Grouser can use
    Info(info::Arguments),
    /// Write a log in another format, chosen by the ending of OUT: .mcap, .bag, or .csv for one topic
    Convert(convert::Arguments),
    /// Write everything that can be read of a damaged MCAP file or bag, and say what is lost
    Recover(recover::Arguments),
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    match &arguments.job {
        Job::Info(arguments) => info::run(arguments, session),
        Job::Convert(arguments) => convert::run(arguments, session),
        Job::Recover(arguments) => recover::run(arguments, session),
    }
}

/// The schema of a job's JSON object.
pub(crate) fn schemas() -> [(&'static str, serde_json::Value); 3] {
    [
        ("log info", info::schema()),
        ("log convert", convert::schema()),
        ("log recover", copied::fields().schema()),
    ]
}
