//! `wheel`: one operating point.

mod figure;

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::PathBuf;

use grouser_terra::{Angle, SlopeOutcome, WheelOnSoil};
use serde_json::Value;

use crate::error::Result;
use crate::exit::Outcome;
use crate::figure_file;
use crate::law_error::Names;
use crate::operation::{self, Answer, Asked};
use crate::session::Session;
use crate::verb_report::Report;
use crate::wheel_choice::WheelArguments;
use grouser_report::number::{parse_finite, shown};
use grouser_report::{Fields, Table, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve one operating point of a wheel on a soil",
    after_help = "Example:\n  grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    wheel: WheelArguments,
    /// Slip, from −1 (locked) by 0 to 1 (spinning on the spot)
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_negative_numbers = true)]
    slip: f64,
    #[command(flatten)]
    asked: LoadOrSinkage,
    /// Slope in degrees, uphill positive: the wheel's weight is the load, W cos α of it is carried, and the pull must hold W sin α
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_negative_numbers = true, requires = "load_n")]
    slope_deg: Option<f64>,
    /// Draw the wheel and the stress under it (.svg or .png)
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
}

/// Exactly one of the two.
#[derive(clap::Args, Clone, Copy, Debug)]
#[group(required = true, multiple = false)]
struct LoadOrSinkage {
    /// Load that the wheel carries in N
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_negative_numbers = true)]
    load_n: Option<f64>,
    /// Sinkage in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    sinkage_m: Option<f64>,
}

/// What a slope asks and gets.
struct OnSlope {
    degrees: f64,
    /// W sin α, N.
    pull: f64,
    outcome: SlopeOutcome,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let refuse = |error| Names::Flags.error(&error);
    let target = arguments
        .figure
        .as_deref()
        .map(figure_file::Target::of)
        .transpose()?;
    let (pair, chosen) = arguments.wheel.pair(session)?;
    let kinematics = arguments.wheel.kinematics(arguments.slip)?;
    let slope = match (arguments.slope_deg, arguments.asked.load_n) {
        (Some(degrees), Some(weight)) => Some(on_slope(&pair, degrees, weight).map_err(refuse)?),
        _ => None,
    };
    let asked = match (arguments.asked.load_n, arguments.asked.sinkage_m, &slope) {
        (Some(weight), _, Some(slope)) => {
            Asked::Load(weight * Angle::from_deg(slope.degrees).cos())
        }
        (Some(load), _, None) => Asked::Load(load),
        (None, sinkage, _) => Asked::Sinkage(sinkage.unwrap_or(f64::NAN)),
    };
    let answer = operation::solve(&pair, asked, &kinematics).map_err(refuse)?;

    let solved = Solved {
        arguments,
        soil: &chosen.name,
        pair: &pair,
        answer: &answer,
        slope: slope.as_ref(),
    };
    let mut text = text(solved);
    if let (Some(target), Some(point)) = (target, &answer.point) {
        let figure = figure::draw(&pair, point, &chosen.name);
        text.push_str(&target.write(&figure)?);
    }
    let outcome = if answer.point.is_some() {
        Outcome::Done
    } else {
        Outcome::NoResult
    };
    let failure = answer.status.complaint(asked);
    Ok(Report {
        outcome,
        object: fields().object(solved),
        text,
        is_aside: false,
        failure,
        warnings: Vec::new(),
    })
}

fn on_slope(pair: &WheelOnSoil, degrees: f64, weight: f64) -> grouser_terra::Result<OnSlope> {
    let slope = Angle::from_deg(degrees);
    let outcome = pair.slip_demand(weight, slope)?;
    Ok(OnSlope {
        degrees,
        pull: weight * slope.sin(),
        outcome,
    })
}

impl OnSlope {
    fn demand(&self) -> Option<f64> {
        match self.outcome {
            SlopeOutcome::Holds { slip } => Some(slip.value()),
            _ => None,
        }
    }
}

impl OnSlope {
    fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |slope: &'a Self|
            "slope_pull_n" "pull that the slope asks for" .shown("N") = slope.pull;
            "slip_demand" "slip that holds the slope" .shown("").missing("none") = slope.demand();
        }
    }
}

/// The operating point and what it was solved for.
#[derive(Clone, Copy)]
struct Solved<'a> {
    arguments: &'a Arguments,
    soil: &'a str,
    pair: &'a WheelOnSoil,
    answer: &'a Answer,
    slope: Option<&'a OnSlope>,
}

fn fields<'a>() -> Fields<'a, Solved<'a>> {
    fields! { |of: Solved<'a>|
        "soil" "soil" = of.soil;
        "radius_m" "radius of the wheel" = of.arguments.wheel.radius_m;
        "width_m" "width of the wheel" = of.arguments.wheel.width_m;
        "rebound" "rebound ratio" = of.pair.soil().params().rebound;
        "slip" "slip" = of.arguments.slip;
        "slip_angle_deg" "slip angle" = of.arguments.wheel.slip_angle_deg;
        "slope_deg" "slope" = of.arguments.slope_deg;
        "load_n" "load" = of.arguments.asked.load_n;
        join(operation::fields()) = of.answer;
        also(OnSlope::fields()) = of.slope;
    }
}

/// The JSON schema.
pub(crate) fn schema() -> Value {
    fields().schema()
}

/// The quantities that people see.
const LINES: [&str; 10] = [
    "sinkage_m",
    "entry, greatest stress, exit",
    "vertical_force_n",
    "drawbar_pull_n",
    "side_force_n",
    "torque_nm",
    "tractive_efficiency",
    "energy_j_per_m",
    "compaction_resistance_n",
    "error_estimate_n",
];

fn text(solved: Solved<'_>) -> String {
    let wheel = &solved.arguments.wheel;
    let mut text = format!(
        "{}: wheel of radius {} m, width {} m, rebound {}, at slip {}\n",
        solved.soil,
        shown(wheel.radius_m),
        shown(wheel.width_m),
        shown(solved.pair.soil().params().rebound),
        shown(solved.arguments.slip),
    );
    if let Some(slope) = solved.slope {
        let _ = writeln!(text, "on a slope of {} deg", shown(slope.degrees));
    }
    let mut table = Table::new().text("").number("").text("");
    if solved.answer.point.is_some() {
        operation::fields()
            .pick(&LINES)
            .add_lines(&mut table, solved.answer);
    }
    if let Some(slope) = solved.slope {
        OnSlope::fields().add_lines(&mut table, slope);
    }
    text.push_str(&table.render_body());
    for caution in solved
        .answer
        .point
        .iter()
        .flat_map(|point| point.cautions.iter())
    {
        let _ = writeln!(text, "caution: {caution}");
    }
    text
}
