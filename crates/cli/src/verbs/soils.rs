//! `soils`: the catalogue.

use crate::error::Result;
use crate::report::{Object, Report};
use crate::session::Session;

#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  grouser soils")]
pub(crate) struct Arguments {}

pub(crate) fn run(_arguments: &Arguments, _session: &mut Session) -> Result<Report> {
    Ok(Report::done(Object::new(), String::new()))
}
