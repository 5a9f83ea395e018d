//! The verbs: one folder each, or one file where that is enough.
//!
//! To add one: its file or folder with `Arguments` (clap) and `run`, and three lines here.

mod batch;
mod curve;
mod drive;
mod estimate;
mod identify;
mod log;
mod optimize;
mod paper;
mod robot;
mod slip_model;
mod soils;
mod validate;
mod wheel;

use crate::error::Result;
use crate::report::Report;
use crate::session::Session;

/// What the command can do.
#[derive(clap::Subcommand, Debug)]
pub(crate) enum Verb {
    Soils(soils::Arguments),
    Wheel(wheel::Arguments),
    Curve(curve::Arguments),
    Batch(batch::Arguments),
    SlipModel(slip_model::Arguments),
    Estimate(estimate::Arguments),
    Drive(drive::Arguments),
    Optimize(optimize::Arguments),
    Paper(paper::Arguments),
    Robot(robot::Arguments),
    Identify(identify::Arguments),
    Validate(validate::Arguments),
    Log(log::Arguments),
}

/// Runs the verb.
pub(crate) fn run(verb: Verb, session: &mut Session) -> Result<Report> {
    match verb {
        Verb::Soils(arguments) => soils::run(&arguments, session),
        Verb::Wheel(arguments) => wheel::run(&arguments, session),
        Verb::Curve(arguments) => curve::run(&arguments, session),
        Verb::Batch(arguments) => batch::run(&arguments, session),
        Verb::SlipModel(arguments) => slip_model::run(&arguments, session),
        Verb::Estimate(arguments) => estimate::run(&arguments, session),
        Verb::Drive(arguments) => drive::run(&arguments, session),
        Verb::Optimize(arguments) => optimize::run(&arguments, session),
        Verb::Paper(arguments) => paper::run(&arguments, session),
        Verb::Robot(arguments) => robot::run(&arguments, session),
        Verb::Identify(arguments) => identify::run(&arguments, session),
        Verb::Validate(arguments) => validate::run(&arguments, session),
        Verb::Log(arguments) => log::run(&arguments, session),
    }
}
