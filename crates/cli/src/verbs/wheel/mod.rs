//! `wheel`: one operating point, or a range of slip.

mod point;
mod range;

use std::path::PathBuf;

use grouser_terra::Prescribed;
use serde_json::Value;

use crate::error::{Error, Result};
use crate::session::Session;
use crate::values::Values;
use crate::verb_report::Report;
use crate::wheel_choice::{GravityArgument, MaxSlip, WheelArguments};
use grouser_report::number::parse_finite;

/// More points than this are no range any more.
const MAX_POINTS: i64 = 100_000;

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a wheel on a soil, at one operating point or over a range of slip",
    after_help = "Examples:\n  grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2\n  \
        grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0:0.9 --points 10\n  \
        grouser wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 40 --load-n 65 --slip 0:0.9 -o pull.svg"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    wheel: WheelArguments,
    /// Slip, from -1 (locked) by 0 to 1 (spinning on the spot): a number, a list `a,b,c` or a range `from:to`; with
    /// `--slope-deg` the default is the slip that holds the slope
    #[arg(
        long,
        value_name = "S",
        allow_hyphen_values = true,
        required_unless_present = "slope_deg"
    )]
    slip: Option<Values>,
    #[command(flatten)]
    prescribed: LoadsOrSinkages,
    /// Slope in degrees, uphill positive: the wheel's weight is the load, W cos α of it is carried, and the pull must hold W sin α
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true, conflicts_with = "sinkage_m")]
    slope_deg: Option<f64>,
    #[command(flatten)]
    max_slip: MaxSlip,
    #[command(flatten)]
    gravity: GravityArgument,
    /// Points of a range of slip, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 91, value_parser = clap::value_parser!(u32).range(2..=MAX_POINTS))]
    points: u32,
    /// Write a range of slip as a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Draw the wheel and the stress under it, at one operating point (.svg or .png)
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
}

/// Exactly one of the three, once or several times.
#[derive(clap::Args, Clone, Debug)]
#[group(required = true, multiple = false)]
struct LoadsOrSinkages {
    /// Load that the wheel carries in N; several times for several curves
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_hyphen_values = true)]
    load_n: Vec<f64>,
    /// Mass on the wheel in kg, instead of its load; several times for several curves
    #[arg(long, value_name = "KG", value_parser = parse_finite, allow_hyphen_values = true)]
    mass_kg: Vec<f64>,
    /// Sinkage in m; several times for several curves
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true)]
    sinkage_m: Vec<f64>,
}

impl Arguments {
    /// Loads, by themselves or as masses, or sinkages.
    fn prescribed(&self) -> Result<Vec<Prescribed>> {
        let given = &self.prescribed;
        let gravity = self.gravity.with_mass(!given.mass_kg.is_empty())?;
        let weights = given.mass_kg.iter().map(|mass| mass * gravity);
        let loads = given.load_n.iter().copied().chain(weights);
        let sinkages = given.sinkage_m.iter().copied().map(Prescribed::Sinkage);
        Ok(loads.map(Prescribed::Load).chain(sinkages).collect())
    }

    /// Is it more than one operating point?
    pub(crate) fn is_range(&self) -> bool {
        let given = &self.prescribed;
        let several = given.load_n.len() + given.mass_kg.len() + given.sinkage_m.len() > 1;
        several
            || self
                .slip
                .as_ref()
                .is_some_and(|slip| slip.single().is_none())
    }
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    match (arguments.prescribed()?.as_slice(), &arguments.slip) {
        ([prescribed], slip) if !arguments.is_range() => {
            if !arguments.output.is_empty() {
                return Err(Error::usage(
                    "`--output` writes a range of slip, but there is one operating point",
                    "give `--slip` a range `from:to` or a list `a,b,c`; `--figure` draws one operating point",
                ));
            }
            let slip = slip.as_ref().and_then(Values::single);
            point::run(arguments, (*prescribed, slip), session)
        }
        (prescribed, Some(slips)) => {
            let alone = [
                ("--slope-deg", arguments.slope_deg.is_some()),
                ("--figure", arguments.figure.is_some()),
            ];
            if let Some((flag, _)) = alone.iter().find(|(_, is_given)| *is_given) {
                return Err(Error::usage(
                    format!("`{flag}` is for one operating point, but there are several"),
                    "give one slip and one load",
                ));
            }
            range::run(arguments, (prescribed, slips), session)
        }
        (_, None) => Err(Error::usage(
            "`--slope-deg` is for one operating point, but there are several",
            "give one load",
        )),
    }
}

/// The JSON schema.
pub(crate) fn schema() -> Value {
    serde_json::json!({"anyOf": [point::fields().schema(), range::output::fields().schema()]})
}
