//! `drive` as text.

use std::fmt::Write as _;

use grouser_real::median;
use grouser_rover::drive::{Outcome, Pilot, Scenario, SlipScore};

use super::comparison::Comparison;
use super::optimum::meaning;
use super::run::{Run, count, pilots};
use grouser_report::number::rounded;

/// Decisions that are printed; the report and the JSON hold all.
const SHOWN: usize = 20;

pub(super) fn text(scenario: &Scenario, optimum: f64, runs: &[Run]) -> String {
    let mut out = format!(
        "{}\nrobot {}, slip setpoint {} ({})\n\n",
        scenario.title,
        scenario.robot.robot.name(),
        rounded(optimum, 3),
        meaning(scenario)
    );
    // writing to a string cannot fail
    let _ = writeln!(
        out,
        "{:<11} {:>8} {:<13} {:>8} {:>7} {:>9} {:>7} {:>10} {:>9}",
        "driver",
        "seed",
        "outcome",
        "distance",
        "time",
        "energy",
        "per m",
        "worst slip",
        "slip rmse"
    );
    let dash = || "—".to_owned();
    for run in runs {
        let result = &run.result;
        let _ = writeln!(
            out,
            "{:<11} {:>8} {:<13} {:>6.2} m {:>5.0} s {:>7.0} J {:>7} {:>10.2} {:>9}",
            run.pilot.name(),
            run.seed,
            result.outcome.name(),
            result.distance,
            result.duration,
            result.energy,
            result
                .energy_per_metre()
                .map_or_else(dash, |e| format!("{e:.0}")),
            result.worst_slip,
            result
                .slip
                .rmse
                .map_or_else(dash, |rmse| format!("{rmse:.3}")),
        );
    }
    let open = runs.iter().filter(|run| run.pilot == Pilot::OpenLoop);
    let paces = open.map(|run| run.pace);
    if let Some(low) = paces.clone().reduce(f64::min) {
        let high = paces.fold(low, f64::max);
        let mut share = rounded(low, 3);
        if high > low {
            share = format!("{share} to {}", rounded(high, 3));
        }
        let _ = writeln!(
            out,
            "\nopen loop has the controller's mean speed: wheels at {share} of the requested speed"
        );
    }
    if let Some(comparison) = Comparison::of(runs) {
        out.push_str(&comparison.text());
    }
    planned(runs, &mut out);
    super::soil::text(runs, &mut out);
    if let Some(law) = scenario.ground.world_laws
        && scenario.plan.is_none()
    {
        let _ = writeln!(
            out,
            "\nThe ground obeys the law `{}`; slip under it and under the estimator's own laws:",
            law.key()
        );
        for run in runs {
            let Some(own) = &run.own_laws else { continue };
            let of = |score: &SlipScore| {
                let number =
                    |value: Option<f64>| value.map_or_else(dash, |value| format!("{value:.3}"));
                format!(
                    "rmse {}, squared error over variance {}",
                    number(score.rmse),
                    number(score.nees)
                )
            };
            let (name, foreign) = (run.pilot.name(), of(&run.result.slip));
            let _ = writeln!(
                out,
                "{name:<11} {:>8} {foreign}; own: {}",
                run.seed,
                of(own)
            );
        }
    }
    let drivers = pilots(runs);
    if runs.len() > drivers.len() {
        out.push('\n');
        for pilot in &drivers {
            let _ = writeln!(out, "{}", summary(runs, *pilot));
        }
    }
    decisions(scenario, runs, &mut out);
    out
}

/// Ways planned and soil learnt, of the drives of a scenario with `[plan]`.
fn planned(runs: &[Run], out: &mut String) {
    for run in runs {
        let Some(planned) = &run.planned else {
            continue;
        };
        let _ = writeln!(
            out,
            "\nseed {}: {} ways planned after the first, risk of a place that cannot be left again at most {}, backed out {} \
             times; the goal is {:.2} m away",
            run.seed,
            planned.planning.count,
            rounded(planned.planning.risk, 3),
            planned.held,
            planned.to_goal
        );
        for tile in &planned.learnt {
            let _ = writeln!(
                out,
                "soil at ({:6.1}, {:6.1}) m lets the robot climb {:5.1}°, within [{:.1}°, {:.1}°]",
                tile.place.0,
                tile.place.1,
                tile.steepest.to_degrees(),
                tile.low.to_degrees(),
                tile.high.to_degrees()
            );
        }
    }
}

/// How a driver fared over all seeds.
pub(super) fn summary(runs: &[Run], pilot: Pilot) -> String {
    let own: Vec<&Run> = runs.iter().filter(|run| run.pilot == pilot).collect();
    let mut energies: Vec<f64> = own
        .iter()
        .filter_map(|run| run.result.energy_per_metre())
        .collect();
    let median = median(&mut energies);
    format!(
        "{}: {} of {} arrived, {} immobilised; median energy {} J/m",
        pilot.name(),
        count(runs, pilot, Outcome::Arrived),
        own.len(),
        count(runs, pilot, Outcome::Immobilised),
        median.map_or_else(|| "—".to_owned(), |e| format!("{e:.0}")),
    )
}

fn decisions(scenario: &Scenario, runs: &[Run], out: &mut String) {
    let Some(run) = runs
        .iter()
        .rev()
        .find(|run| run.seen.is_some() && !run.result.decisions.is_empty())
    else {
        return;
    };
    let _ = writeln!(
        out,
        "\nDecisions of the {} (seed {}):",
        run.pilot.name(),
        run.seed
    );
    let wheels = scenario.robot.robot.wheels();
    for named in run.result.decisions.iter().take(SHOWN) {
        let wheel = named.decision.wheel.and_then(|index| wheels.get(index));
        let of = wheel.map_or_else(String::new, |wheel| format!("  {}", wheel.name));
        let _ = writeln!(out, "{:>7.2} s  {}{of}", named.time, named.decision);
    }
    let more = run.result.decision_count.saturating_sub(SHOWN as u64);
    if more > 0 {
        let _ = writeln!(out, "  … and {more} more (--json, --report)");
    }
}
