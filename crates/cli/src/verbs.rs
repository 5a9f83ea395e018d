//! The verbs, one file each.
//!
//! To add one: its file with `Arguments` (clap) and `run`, and three lines here.

mod soils;

use crate::error::Result;
use crate::report::Report;
use crate::session::Session;

/// What the command can do.
#[derive(clap::Subcommand, Debug)]
pub(crate) enum Verb {
    /// List the soils of the catalogue with their sources
    Soils(soils::Arguments),
}

/// Runs the verb.
pub(crate) fn run(verb: Verb, session: &mut Session) -> Result<Report> {
    match verb {
        Verb::Soils(arguments) => soils::run(&arguments, session),
    }
}
