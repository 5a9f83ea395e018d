//! A wheel over a range of slip.

mod figure;
pub(super) mod output;

use grouser_terra::{BestSlip, Kinematics, LoadSolution, Prescribed, WheelOnSoil};
use rayon::prelude::*;

use self::output::Frame;
use super::Arguments;
use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::law_error::Names;
use crate::output_choice::Output;
use crate::session::Session;
use crate::values::Values;
use crate::verb_report::Report;
use grouser_report::number::shown;

/// One curve: its load, and its points.
struct Family {
    prescribed: Prescribed,
    points: Vec<(f64, LoadSolution)>,
    most_pull: Option<BestSlip>,
    most_efficient: Option<BestSlip>,
}

/// Solves a curve for each load or sinkage.
pub(super) fn run(
    arguments: &Arguments,
    (prescribed, slips): (&[Prescribed], &Values),
    session: &mut Session,
) -> Result<Report> {
    let outputs = Output::begin(&arguments.output)?;
    let (pair, chosen) = arguments
        .wheel
        .pair(session, grouser_terra::Settings::default())?;
    let slips = slips.spread(arguments.points);
    let motions = slips.iter().map(|slip| arguments.wheel.kinematics(*slip));
    let motions = motions.collect::<Result<Vec<_>>>()?;
    let families: Vec<Family> = prescribed
        .iter()
        .map(|prescribed| family(arguments, &pair, *prescribed, (&slips, &motions)))
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
        || match slips.as_slice() {
            [_] => Err(Error::usage(
                "there is nothing to draw: `--slip` is one number",
                "give it as a range, such as `--slip 0:0.9`",
            )),
            _ => Ok(figure::draw(&chosen.name, &families)),
        },
    )?);
    let points = families.iter().flat_map(|family| &family.points);
    let solved = points
        .clone()
        .filter(|(_, answer)| answer.point().is_some());
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

/// From this slip on a wheel spins nearly on the spot.
const SPINNING_SLIP: f64 = 0.99;

/// The caution where the laws give the maximum pull to a wheel that spins on the spot.
fn most_at_spin(family: &Family) -> Option<String> {
    let best = family.most_pull.as_ref()?;
    (best.slip.value() >= SPINNING_SLIP).then(|| {
        "the maximum pull is at slip 1, where the laws do not hold: they neglect the thrust that disturbed soil loses"
            .to_owned()
    })
}

fn family(
    arguments: &Arguments,
    pair: &WheelOnSoil,
    prescribed: Prescribed,
    (slips, motions): (&[f64], &[Kinematics]),
) -> Result<Family> {
    let refuse = |error| Names::Flags.error(&error);
    let points = slips
        .par_iter()
        .zip(motions)
        .map(|(slip, motion)| {
            let answer = pair.solve(prescribed, motion).map_err(refuse)?;
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
