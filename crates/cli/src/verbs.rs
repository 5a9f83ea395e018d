//! The verbs, one file each.
//!
//! To add one: its file with `Arguments` (clap) and `run`, and three lines here.

mod batch;
mod batch_columns;
mod batch_lanes;
mod batch_sink;
mod batch_stream;
mod curve;
mod curve_figure;
mod curve_output;
mod drive;
mod drive_charts;
mod drive_decisions;
mod drive_log;
mod drive_map;
mod drive_mcap;
mod drive_object;
mod drive_optimum;
mod drive_relief;
mod drive_report;
mod drive_text;
mod drive_track;
mod estimate;
mod estimate_calibration;
mod estimate_figure;
mod estimate_mcap;
mod estimate_object;
mod estimate_output;
mod estimate_text;
mod identify;
mod identify_figure;
mod identify_text;
mod log;
mod log_convert;
mod log_info;
mod log_recover;
mod log_sheet;
mod optimize;
mod optimize_csv;
mod optimize_figure;
mod optimize_object;
mod optimize_text;
mod paper;
mod paper_figures;
mod paper_page;
mod paper_problem;
mod paper_run;
mod robot;
mod slip_model;
mod slip_model_figure;
mod slip_model_grid;
mod slip_model_output;
mod soils;
mod validate;
mod validate_csv;
mod validate_figure;
mod validate_object;
mod validate_text;
mod wheel;
mod wheel_figure;

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
