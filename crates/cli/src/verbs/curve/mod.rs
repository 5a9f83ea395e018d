//! `curve`: a wheel over a range of slip.

mod family;
mod figure;
mod output;

use std::path::PathBuf;

use grouser_terra::WheelOnSoil;
use rayon::prelude::*;

use self::family::Family;
use self::output::Frame;
use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::law_error::Names;
use crate::operation::{self, Prescribed};
use crate::output_choice::Output;
use crate::session::Session;
use crate::verb_report::Report;
use crate::wheel_choice::{GravityArgument, WheelArguments};
use grouser_report::number::{in_message, parse_finite, shown};

/// More points than this are no curve any more.
const MAX_POINTS: i64 = 100_000;

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a wheel on a soil over a range of slip",
    after_help = "Examples:\n  grouser curve --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip-from 0 --slip-to 0.9 --points 10\n  \
        grouser curve --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 40 --load-n 65 --load-n 90 -o curve.svg"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    wheel: WheelArguments,
    #[command(flatten)]
    prescribed: LoadsOrSinkages,
    #[command(flatten)]
    gravity: GravityArgument,
    /// First slip
    #[arg(long, value_name = "S", default_value = "0", value_parser = parse_finite, allow_hyphen_values = true)]
    slip_from: f64,
    /// Last slip
    #[arg(long, value_name = "S", default_value = "0.9", value_parser = parse_finite, allow_hyphen_values = true)]
    slip_to: f64,
    /// Number of points, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 91, value_parser = clap::value_parser!(u32).range(2..=MAX_POINTS))]
    points: u32,
    /// Write a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// Loads, by themselves or as masses, or sinkages, once or several times.
#[derive(clap::Args, Clone, Debug)]
#[group(required = true)]
struct LoadsOrSinkages {
    /// Load that the wheel carries in N; several times for several curves
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_hyphen_values = true, conflicts_with = "sinkage_m")]
    load_n: Vec<f64>,
    /// Mass on the wheel in kg, instead of its load; several times for several curves
    #[arg(long, value_name = "KG", value_parser = parse_finite, allow_hyphen_values = true, conflicts_with = "sinkage_m")]
    mass_kg: Vec<f64>,
    /// Sinkage in m; several times for several curves
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true)]
    sinkage_m: Vec<f64>,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = Output::begin(&arguments.output)?;
    let (pair, chosen) = arguments
        .wheel
        .pair(session, grouser_terra::Settings::default())?;
    let slips = slips(arguments)?;
    let gravity = (arguments.gravity).with_mass(!arguments.prescribed.mass_kg.is_empty())?;
    let families: Vec<Family> = prescribed(&arguments.prescribed, gravity)
        .map(|prescribed| family(arguments, &pair, prescribed, &slips))
        .collect::<Result<_>>()?;

    let mut text = format!(
        "{}: wheel of radius {} m, width {} m\n",
        chosen.name,
        shown(arguments.wheel.radius_m),
        shown(arguments.wheel.width_m)
    );
    for family in &families {
        text.push_str(&output::summary(family));
    }
    let frame = Frame {
        wheel: &arguments.wheel,
        pair: &pair,
        soil: &chosen.name,
        families: &families,
    };
    if outputs.is_empty() {
        text.push_str(&frame.table());
    }
    text.push_str(&Output::write_all(
        outputs,
        || frame.csv(),
        || Ok(figure::draw(&chosen.name, &families)),
    )?);
    let points = families.iter().flat_map(|family| &family.points);
    let solved = points.clone().filter(|(_, answer)| answer.point.is_some());
    let (solved, all) = (solved.count(), points.count());
    let failure = (solved == 0).then(|| "no point of the curve has a solution".to_owned());
    let report = Report {
        outcome: if solved < all {
            Outcome::Doubtful
        } else {
            Outcome::Done
        },
        warnings: families.iter().filter_map(most_at_spin).collect(),
        ..Report::done(output::fields().object(frame), text)
    };
    Ok(report.failing(failure))
}

fn prescribed(given: &LoadsOrSinkages, gravity: f64) -> impl Iterator<Item = Prescribed> {
    let loads = given.load_n.iter().map(|load| Prescribed::Load(*load));
    let weights = given
        .mass_kg
        .iter()
        .map(move |mass| Prescribed::Load(mass * gravity));
    loads.chain(weights).chain(
        given
            .sinkage_m
            .iter()
            .map(|sinkage| Prescribed::Sinkage(*sinkage)),
    )
}

fn slips(arguments: &Arguments) -> Result<Vec<f64>> {
    let (from, to) = (arguments.slip_from, arguments.slip_to);
    for (flag, value) in [("--slip-from", from), ("--slip-to", to)] {
        if !(-1.0..=1.0).contains(&value) {
            return Err(Error::out_of_range(
                flag,
                value,
                ([-1.0, 1.0], None),
                "lie in [-1, 1]",
            ));
        }
    }
    if !(from < to) {
        let limit = format!("be less than `--slip-to`, {}", in_message(to));
        return Err(Error::out_of_range(
            "--slip-from",
            from,
            ([-1.0, to], None),
            limit,
        ));
    }
    let last = arguments.points - 1;
    let share = |i: u32| f64::from(i) / f64::from(last);
    // The last point is exactly the requested end.
    Ok((0..=last)
        .map(|i| {
            if i == last {
                to
            } else {
                from + (to - from) * share(i)
            }
        })
        .collect())
}

/// From this slip on a wheel spins nearly on the spot.
pub(super) const SPINNING_SLIP: f64 = 0.99;

/// The caution where the laws give the most pull to a wheel that spins on the spot.
fn most_at_spin(family: &Family) -> Option<String> {
    let best = family.most_pull.as_ref()?;
    (best.slip.value() >= SPINNING_SLIP).then(|| {
        "the most pull is at slip 1, where the laws do not hold: they do not count the thrust that disturbed soil loses"
            .to_owned()
    })
}

fn family(
    arguments: &Arguments,
    pair: &WheelOnSoil,
    prescribed: Prescribed,
    slips: &[f64],
) -> Result<Family> {
    let refuse = |error| Names::Flags.error(&error);
    let points = slips
        .par_iter()
        .map(|slip| {
            let kinematics = arguments.wheel.kinematics(*slip)?;
            let answer = operation::solve(pair, prescribed, &kinematics).map_err(refuse)?;
            Ok((*slip, answer))
        })
        .collect::<Result<_>>()?;
    let straight = arguments.wheel.slip_angle_deg == 0.0;
    let (most_pull, most_efficient) = match prescribed {
        Prescribed::Load(load) if straight => (
            pair.slip_of_maximum_pull(load).map_err(refuse)?,
            pair.slip_of_maximum_efficiency(load).map_err(refuse)?,
        ),
        _ => (None, None),
    };
    Ok(Family {
        prescribed,
        points,
        most_pull,
        most_efficient,
    })
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    output::fields().schema()
}
