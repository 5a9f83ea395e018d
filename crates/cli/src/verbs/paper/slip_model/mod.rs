//! `paper slip-model`: the analytical slip model of the paper, at a point or over a range.

mod figure;
mod grid;
mod output;
mod point;

use std::path::PathBuf;

use grouser_terra::Mobilised;

use self::grid::Axes;
use self::point::{Point, evaluate};
use crate::error::{Error, Result};
use crate::law_error::Names;
use crate::output_choice::Output;
use crate::session::Session;
use crate::soil_choice::{Overrides, choose};
use crate::values::Values;
use crate::verb_report::Report;
use grouser_report::number::{parse_finite, shown};

#[derive(clap::Args, Debug)]
#[command(
    about = "Evaluate the analytical slip model of Ani et al. (2012)",
    long_about = "Evaluate the analytical slip model of Ani et al. (2012): the slip S at which the soil at an angle \
        on the wheel mobilises a share of its strength; by default none of it, S_0.\n\n\
        S is 1 - v/(r w), the driving formula continued below zero. S_0 is never positive (figures of the paper \
        apparently show its magnitude) and depends on the angle and on sinkage/radius alone: no soil can move it. \
        Outside the contact it is computed all the same, with a caution.",
    after_help = "Examples:\n  grouser paper slip-model --theta-deg 32 --sinkage-m 0.03 --radius-m 0.1\n  \
        grouser paper slip-model --theta-deg 0:40 --sinkage-m 0.01,0.014,0.02,0.03 --radius-m 0.1 -o slip.svg\n  \
        grouser paper slip-model --theta-deg 10 --sinkage-m 0.02 --radius-m 0.1 --mobilised 0.5 --soil dry-sand"
)]
pub(crate) struct Arguments {
    /// Angle on the wheel from the vertical, positive towards travel, in degrees: a number, a list `a,b,c` or a range `from:to`
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta_deg: Values,
    /// Sinkage in m: a number, a list or a range
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    sinkage_m: Values,
    /// Radius of the wheel in m: a number, a list or a range
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    radius_m: Values,
    /// Points of a range
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    points: u32,
    /// Share of the soil's strength that is mobilised, from 0 to less than 1; above 0 it needs K
    #[arg(long, value_name = "X", value_parser = parse_finite, allow_hyphen_values = true, default_value_t = 0.0)]
    mobilised: f64,
    /// A soil, for its K: a key of the catalogue, or a file when it contains `/` or `.`
    #[arg(long, value_name = "KEY|FILE")]
    soil: Option<std::ffi::OsString>,
    #[command(flatten)]
    overrides: Overrides,
    /// Write a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = Output::begin(&arguments.output)?;
    let mobilised = mobilised(arguments, session)?;
    let axes = Axes::new(
        &arguments.theta_deg,
        &arguments.sinkage_m,
        &arguments.radius_m,
        arguments.points,
    )?;
    let points: Vec<Point> = axes.points().map(|at| evaluate(at, mobilised)).collect();
    // A sweep may leave the model's range; a job that lies outside as a whole is bad input.
    if let [first, ..] = points.as_slice()
        && let Err(error) = &first.outcome
        && points.iter().all(|point| point.outcome.is_err())
    {
        return Err(Names::Flags.error(error));
    }
    let reached = points.iter().any(|point| point.slip().is_some());
    let failure = (!reached).then(|| failure(&points, arguments.mobilised));

    let mut text = match points.as_slice() {
        [point] => output::single(point, arguments.mobilised),
        points if outputs.is_empty() => output::table(points),
        points => format!("{} points\n", points.len()),
    };
    text.push_str(&Output::write_all(
        outputs,
        || output::csv(&points, arguments.mobilised),
        || figure::draw(&axes, &points, arguments.mobilised),
    )?);
    let object = output::fields().object((&points, mobilised));
    Ok(Report::done(object, text).failing(failure))
}

/// The share with the K that it needs: of a flag, else of the soil.
fn mobilised(arguments: &Arguments, session: &mut Session) -> Result<Option<Mobilised>> {
    let share = arguments.mobilised;
    if !(0.0..1.0).contains(&share) {
        return Err(Error::out_of_range(
            "--mobilised",
            share,
            ([0.0, 1.0], None),
            "lie in [0, 1)",
        ));
    }
    // Only K enters, and that only when something is mobilised: a soil that lacks the rest serves as well.
    let soil = match &arguments.soil {
        Some(name) => {
            let or = |given: Option<f64>, unused: f64| given.or(Some(unused));
            let overrides = Overrides {
                c_1: or(arguments.overrides.c_1, 0.0),
                c_2: or(arguments.overrides.c_2, 0.0),
                ..arguments.overrides
            };
            let overrides = if share > 0.0 {
                overrides
            } else {
                Overrides {
                    k_shear_m: or(overrides.k_shear_m, 1.0),
                    ..overrides
                }
            };
            let chosen = choose(name, &overrides)?;
            chosen.note(&arguments.overrides, session);
            Some(chosen.soil)
        }
        None => None,
    };
    if share == 0.0 {
        return Ok(None);
    }
    let k_shear = arguments
        .overrides
        .k_shear_m
        .or(soil.map(|soil| soil.params().k_shear));
    match k_shear {
        Some(k_shear) => Ok(Some(Mobilised { share, k_shear })),
        None => Err(Error::usage(
            "missing `--soil` or `--k-shear-m`, which `--mobilised` needs",
            "the share that is mobilised depends on the shear deformation modulus K",
        )),
    }
}

fn failure(points: &[Point], share: f64) -> String {
    let most = points
        .iter()
        .filter_map(Point::max_share)
        .fold(0.0, f64::max);
    format!(
        "`--mobilised` is {}, but even a wheel that spins on the spot mobilises at most {} there",
        grouser_report::number::in_message(share),
        shown(most)
    )
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    output::fields().schema()
}
