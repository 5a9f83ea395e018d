//! One operating point.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_terra::{Angle, LoadSolution, LugPassage, Prescribed, SlopeOutcome, WheelOnSoil};

use super::Arguments;
use crate::error::Result;
use crate::exit::Outcome;
use crate::figure_file;
use crate::law_error::Names;
use crate::model_error;
use crate::operation::{self, passage};
use crate::session::Session;
use crate::verb_report::Report;
use grouser_report::number::{rounded, shown};
use grouser_report::{Fields, Table, fields};

/// The pull that a slope requires, and the slip that provides it.
struct OnSlope {
    degrees: f64,
    /// W sin α, N.
    pull: f64,
    outcome: SlopeOutcome,
}

/// Solves it; without a slip at the one that holds the slope.
pub(super) fn run(
    arguments: &Arguments,
    (prescribed, slip): (Prescribed, Option<f64>),
    session: &mut Session,
) -> Result<Report> {
    let refuse = |error| Names::Flags.error(&error);
    let target = arguments
        .figure
        .as_deref()
        .map(figure_file::Target::create)
        .transpose()?;
    let (pair, chosen) = arguments
        .wheel
        .pair(session, arguments.max_slip.settings())?;
    let weight = prescribed.load();
    let slope = match (arguments.slope_deg, weight) {
        (Some(degrees), Some(weight)) => Some(on_slope(&pair, degrees, weight).map_err(refuse)?),
        _ => None,
    };
    let demand = slope.as_ref().and_then(OnSlope::demand);
    let Some(slip) = slip.or(demand) else {
        return Ok(immobilised(arguments, &pair, &chosen.name, slope.as_ref()));
    };
    let kinematics = arguments.wheel.kinematics(slip)?;
    let prescribed = match (weight, &slope) {
        (Some(weight), Some(slope)) => {
            Prescribed::Load(weight * Angle::from_deg(slope.degrees).cos())
        }
        _ => prescribed,
    };
    let answer = pair.solve(prescribed, &kinematics).map_err(refuse)?;

    let point = answer.point();
    let lugs = point.and_then(|point| pair.lug_passage(&point));
    let solved = Solved {
        lugs,
        slip: Some(slip),
        weight,
        arguments,
        soil: &chosen.name,
        pair: &pair,
        answer: Some(&answer),
        slope: slope.as_ref(),
    };
    let mut text = text(solved);
    if let (Some(target), Some(point)) = (target, &point) {
        let figure = grouser_campaign::stress::draw(&pair, point, &chosen.name);
        text.push_str(&target.write(&figure)?);
    }
    let outcome = if point.is_some() {
        Outcome::Done
    } else {
        Outcome::NoResult
    };
    let failure = operation::complaint(&answer, prescribed);
    Ok(Report {
        outcome,
        ..Report::done(fields().object(solved), text).failing(failure)
    })
}

/// The report of a wheel that no slip holds on its slope.
fn immobilised(
    arguments: &Arguments,
    pair: &WheelOnSoil,
    soil: &str,
    slope: Option<&OnSlope>,
) -> Report {
    let solved = Solved {
        arguments,
        soil,
        pair,
        slip: None,
        weight: None,
        answer: None,
        slope,
        lugs: None,
    };
    let max_slip = shown(arguments.max_slip.max_slip);
    let failure = Some(format!("no slip up to {max_slip} holds the slope"));
    Report::done(fields().object(solved), text(solved)).failing(failure)
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
            SlopeOutcome::Immobilised { .. } | SlopeOutcome::Slides { .. } => None,
        }
    }

    /// The maximum pull, N, where it is too little.
    fn max_pull(&self) -> Option<f64> {
        match self.outcome {
            SlopeOutcome::Immobilised { max_pull, .. } => max_pull,
            SlopeOutcome::Holds { .. } | SlopeOutcome::Slides { .. } => None,
        }
    }

    fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |slope: &'a Self|
            "slope_pull_n" "required pull" .shown("N") = slope.pull;
            "slip_demand" "slip on the slope" .shown("").missing("none") = slope.demand();
            "max_pull_n" "maximum pull, where it does not hold the slope" = slope.max_pull();
        }
    }
}

/// The operating point and what it was solved for.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    arguments: &'a Arguments,
    soil: &'a str,
    pair: &'a WheelOnSoil,
    /// The slip that was given or that holds the slope.
    slip: Option<f64>,
    /// The weight on the wheel, N, where it is given.
    weight: Option<f64>,
    answer: Option<&'a LoadSolution>,
    slope: Option<&'a OnSlope>,
    lugs: Option<LugPassage>,
}

/// The keys.
pub(super) fn fields<'a>() -> Fields<'a, Solved<'a>> {
    fields! { |of: Solved<'a>|
        "soil" "soil" = of.soil;
        "radius_m" "radius of the wheel" = of.arguments.wheel.radius_m;
        "width_m" "width of the wheel" = of.arguments.wheel.width_m;
        "rebound" "rebound ratio" = of.pair.soil().params().rebound;
        "slip" "slip" = of.slip;
        "slip_angle_deg" "slip angle" = of.arguments.wheel.slip_angle_deg;
        "slope_deg" "slope" = of.arguments.slope_deg;
        "load_n" "load" = of.weight;
        also(operation::fields()) = of.answer;
        also(OnSlope::fields()) = of.slope;
        "grouser_height_m" "height of the lugs" = of.pair.wheel().grousers().map(|lugs| lugs.height);
        also(passage()) = of.lugs.map(Some);
    }
}

/// The quantities that people see; the last one is a detail.
const LINES: [&str; 10] = [
    "sinkage_m",
    "entry, peak stress, exit",
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
    let point = solved.answer.and_then(LoadSolution::point);
    let mut text = match (&point, solved.slip) {
        (Some(point), Some(slip)) if solved.slope.and_then(OnSlope::demand) == Some(slip) => {
            format!(
                "{}: holds {}° at slip {}: pulls {} N under {} N, sinks {} mm\n",
                solved.soil,
                shown(solved.slope.map_or(0.0, |slope| slope.degrees)),
                shown(slip),
                shown(point.forces.drawbar_pull),
                shown(point.forces.vertical_force),
                shown(1e3 * point.sinkage)
            )
        }
        (Some(point), Some(slip)) => format!(
            "{}: pulls {} N at slip {} under {} N, sinks {} mm\n",
            solved.soil,
            shown(point.forces.drawbar_pull),
            shown(slip),
            shown(point.forces.vertical_force),
            shown(1e3 * point.sinkage)
        ),
        _ => match solved.slope {
            Some(slope) => format!(
                "{}: does not hold {}°: needs {} N, has {} up to slip {}\n",
                solved.soil,
                shown(slope.degrees),
                shown(slope.pull),
                (slope.max_pull())
                    .map_or_else(|| "none".to_owned(), |pull| format!("{} N", shown(pull))),
                shown(solved.arguments.max_slip.max_slip)
            ),
            None => format!("{}: no operating point\n", solved.soil),
        },
    };
    let error = point.map(|point| (point.forces.vertical_force, point.model_error));
    if let Some((load, Some(error))) = error {
        let _ = writeln!(
            text,
            "90 % of measurements lie within ±{} N of the drawbar pull, ±{} N of the side force and ±{} mm of the sinkage",
            rounded(error.pull_per_load * load, 2),
            rounded(error.side_per_load * load, 2),
            rounded(
                1e3 * error.sinkage_per_radius * solved.pair.wheel().radius(),
                2
            ),
        );
    } else if error.is_some() {
        let _ = writeln!(text, "caution: {}", model_error::UNKNOWN);
    }
    for caution in point.iter().flat_map(|point| point.cautions.iter()) {
        let _ = writeln!(text, "caution: {caution}");
    }
    let _ = write!(
        text,
        "wheel of radius {} m and width {} m",
        shown(wheel.radius_m),
        shown(wheel.width_m)
    );
    if let Some(slope) = solved.slope {
        let _ = write!(text, " on a slope of {} deg", shown(slope.degrees));
    }
    let rebound = solved.pair.soil().params().rebound;
    if rebound > 0.0 {
        let _ = write!(text, ", rebound ratio of the soil {}", shown(rebound));
    }
    text.push('\n');
    let mut table = Table::new().text("").number("").text("");
    if let Some(answer) = solved.answer.filter(|_| point.is_some()) {
        operation::fields()
            .pick(&LINES)
            .detail()
            .add_lines(&mut table, answer);
    }
    if let Some(slope) = solved.slope {
        OnSlope::fields().add_lines(&mut table, slope);
    }
    if let Some(lugs) = solved.lugs {
        passage().add_lines(&mut table, Some(lugs));
    }
    text + &table.render_body()
}
