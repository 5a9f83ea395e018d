//! `wheel`: one operating point.

mod figure;

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::PathBuf;

use grouser_terra::{Angle, OperatingPoint, SlopeOutcome, WheelOnSoil};
use serde_json::Value;

use crate::error::{Outcome, Result};
use crate::figure_file;
use crate::law_error::Names;
use crate::operation::{self, Answer, Asked};
use crate::report::{Object, Report};
use crate::session::Session;
use crate::wheel_choice::WheelArguments;
use grouser_report::Table;
use grouser_report::number::{parse_finite, shown};

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

    let mut object = inputs(arguments, &chosen.name, &pair);
    object.extend(answer.object());
    if let Some(slope) = &slope {
        object.extend(slope.object());
    }
    let mut text = text(arguments, &chosen.name, &pair, &answer, slope.as_ref());
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
        object,
        text,
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

    fn object(&self) -> Object {
        [
            ("slope_pull_n", Value::from(self.pull)),
            ("slip_demand", Value::from(self.demand())),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }
}

fn inputs(arguments: &Arguments, soil: &str, pair: &WheelOnSoil) -> Object {
    [
        ("soil", Value::from(soil)),
        ("radius_m", Value::from(arguments.wheel.radius_m)),
        ("width_m", Value::from(arguments.wheel.width_m)),
        ("rebound", Value::from(pair.soil().params().rebound)),
        ("slip", Value::from(arguments.slip)),
        (
            "slip_angle_deg",
            Value::from(arguments.wheel.slip_angle_deg),
        ),
        ("slope_deg", Value::from(arguments.slope_deg)),
        ("load_n", Value::from(arguments.asked.load_n)),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

fn text(
    arguments: &Arguments,
    soil: &str,
    pair: &WheelOnSoil,
    answer: &Answer,
    slope: Option<&OnSlope>,
) -> String {
    let mut table = Table::new().text("").number("").text("");
    if let Some(point) = &answer.point {
        add_point(&mut table, point);
    }
    if let Some(slope) = slope {
        table.row(["pull that the slope asks for", &shown(slope.pull), "N"]);
        let demand = slope.demand().map_or_else(|| "none".to_owned(), shown);
        table.row(["slip that holds the slope", &demand, ""]);
    }
    let rebound = pair.soil().params().rebound;
    let mut text = format!(
        "{soil}: wheel of radius {} m, width {} m, rebound {}, at slip {}\n",
        shown(arguments.wheel.radius_m),
        shown(arguments.wheel.width_m),
        shown(rebound),
        shown(arguments.slip),
    );
    if let Some(slope) = slope {
        let _ = writeln!(text, "on a slope of {} deg", shown(slope.degrees));
    }
    text.push_str(&table.render_body());
    for caution in answer.point.iter().flat_map(|point| point.cautions.iter()) {
        let _ = writeln!(text, "caution: {caution}");
    }
    text
}

fn add_point(table: &mut Table, point: &OperatingPoint) {
    let degrees = |radians: f64| shown(radians.to_degrees());
    let or_none = |value: Option<f64>| value.map_or_else(|| "none".to_owned(), shown);
    let forces = &point.forces;
    let angles = format!(
        "{} / {} / {}",
        degrees(point.angles.theta_1),
        degrees(point.angles.theta_m),
        degrees(point.angles.theta_2)
    );
    let efficiency = point.tractive_efficiency().map(|share| 100.0 * share);
    for (name, value, unit) in [
        ("sinkage", shown(1e3 * point.sinkage), "mm"),
        ("entry, greatest stress, exit", angles, "deg"),
        ("vertical force", shown(forces.vertical_force), "N"),
        ("drawbar pull", shown(forces.drawbar_pull), "N"),
        ("side force", shown(point.side_force), "N"),
        ("torque", shown(forces.torque), "N m"),
        ("tractive efficiency", or_none(efficiency), "%"),
        ("energy", or_none(point.energy_per_metre()), "J/m"),
        (
            "compaction resistance",
            shown(forces.compaction_resistance),
            "N",
        ),
        (
            "error of the integrals at most",
            shown(point.error_estimate),
            "N",
        ),
    ] {
        table.row([name, &value, unit]);
    }
}
