//! `drive` as text.

use std::fmt::Write as _;

use grouser_real::median;
use grouser_rover::drive::{Outcome, Pilot, Scenario, SlipScore};

use super::comparison::Comparison;
use super::object;
use super::optimum::meaning;
use super::run::{Run, count, pilots};
use grouser_report::number::{rounded, shown};
use grouser_report::{Layout, fields};

/// Number of decisions that are printed; the report and the JSON hold all.
const SHOWN: usize = 20;

pub(super) fn text(scenario: &Scenario, optimum: f64, runs: &[Run]) -> String {
    let mut out = format!("{}\n", scenario.title);
    // writing to a string cannot fail
    for pilot in pilots(runs) {
        let _ = writeln!(out, "{}", summary(runs, pilot));
    }
    if let Some(comparison) = Comparison::of(runs) {
        out.push_str(&comparison.text());
    }
    let table = object::run().pick(&object::COLUMNS);
    let _ = writeln!(
        out,
        "\n{}",
        table.table(runs.iter().map(|run| (scenario, run)))
    );
    for run in runs {
        if let Some(reason) = &run.refusal {
            let _ = writeln!(out, "seed {} could not begin: {reason}", run.seed);
        }
    }
    let _ = writeln!(
        out,
        "robot {}, slip setpoint {} ({})",
        scenario.robot.robot.name(),
        rounded(optimum, 3),
        meaning(scenario)
    );
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
            "open loop has the controller's mean speed: wheels at {share} of the requested speed"
        );
    }
    planned(runs, &mut out);
    super::soil::text(runs, &mut out);
    if let Some(law) = scenario.ground.world_laws
        && scenario.plan.is_none()
        && Layout::current().details
    {
        let _ = writeln!(
            out,
            "\nThe ground obeys the law `{}`; slip errors under it and under the estimator's own laws:",
            law.key()
        );
        let scores = runs
            .iter()
            .filter_map(|run| Some((run, run.own_laws.as_ref()?)));
        let score = fields! { |of: (&Run, &str, SlipScore)|
            remark "driver" = of.0.pilot.name();
            "seed" "seed" .shown("") = of.0.seed;
            remark "laws" = of.1;
            join(object::score()) = of.2;
        };
        let rows =
            scores.flat_map(|(run, own)| [(run, law.key(), run.result.slip), (run, "own", *own)]);
        out.push_str(&score.table(rows));
    }
    decisions(scenario, runs, &mut out);
    out
}

/// Routes planned and soil learnt, of the drives of a scenario with `[plan]`.
fn planned(runs: &[Run], out: &mut String) {
    for run in runs {
        let Some(planned) = &run.planned else {
            continue;
        };
        let _ = writeln!(
            out,
            "\nseed {}: {} routes planned after the first, probability to get stuck on them at most {}, backed out {} times; \
             {} m left to the goal",
            run.seed,
            planned.planning.count,
            rounded(planned.planning.risk, 3),
            planned.held,
            shown(planned.to_goal)
        );
        if Layout::current().details {
            out.push_str(
                "slope that the robot can climb, with its 90 % interval, by tiles of soil:\n",
            );
            out.push_str(&object::tile().table(&planned.learnt));
        }
    }
}

/// The outcomes of a driver over all seeds.
pub(super) fn summary(runs: &[Run], pilot: Pilot) -> String {
    let own: Vec<&Run> = runs.iter().filter(|run| run.pilot == pilot).collect();
    let mut energies: Vec<f64> = own
        .iter()
        .filter_map(|run| run.result.energy_per_metre())
        .collect();
    let others = [
        (Outcome::SensorsLost, "lost its sensors"),
        (Outcome::NoWay, "found no route on"),
        (Outcome::OffMap, "left the map"),
        (Outcome::TimeOut, "ran out of time"),
        (Outcome::Refused, "could not begin"),
        (Outcome::Tipped, "tipped over"),
    ];
    let others = others.map(|(outcome, words)| (count(runs, pilot, outcome), words));
    let others = others.into_iter().filter(|(count, _)| *count > 0);
    let others: Vec<String> = others
        .map(|(count, words)| format!(", {count} {words}"))
        .collect();
    let others = others.concat();
    let mut text = format!(
        "{}: {} of {} arrived, {} immobilised{others}; median energy {} J/m",
        pilot.name(),
        count(runs, pilot, Outcome::Arrived),
        own.len(),
        count(runs, pilot, Outcome::Immobilised),
        median(&mut energies).map_or_else(|| "-".to_owned(), shown),
    );
    // a chassis with actuators
    let margins = own.iter().filter_map(|run| run.result.min_tip_over_margin);
    if let Some(least) = margins.reduce(f64::min) {
        let mut drawn: Vec<f64> = own.iter().map(|run| run.result.ledger.actuators).collect();
        let _ = write!(
            text,
            "\n  actuators {} J; minimum tip-over margin {} deg",
            median(&mut drawn).map_or_else(|| "-".to_owned(), shown),
            shown(least.to_degrees()),
        );
    }
    text
}

fn decisions(scenario: &Scenario, runs: &[Run], out: &mut String) {
    let Some(run) = runs
        .iter()
        .rev()
        .find(|run| run.seen.is_some() && !run.result.decisions.is_empty())
    else {
        return;
    };
    let count = run.result.decision_count;
    if !Layout::current().details {
        let _ = writeln!(
            out,
            "{count} decisions of the {} (seed {}): -v lists them",
            run.pilot.name(),
            run.seed
        );
        return;
    }
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
    let more = count.saturating_sub(SHOWN as u64);
    if more > 0 {
        let _ = writeln!(out, "  and {more} more (--json, --report)");
    }
}
