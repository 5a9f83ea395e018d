//! The drives of a report: those of the first seed to play, all of them in a table.

use grouser_page::run::Drive;
use grouser_report::Object;
use grouser_rover::drive::Scenario;
use serde_json::{Value, json};

use super::comparison::Comparison;
use super::run::{Run, pilots, warnings};
use super::text::summary;

pub(super) fn object(scenario: &Scenario, optimum: f64, runs: &[Run]) -> Object {
    let drive = |run| played(scenario, optimum, run);
    let played: Vec<Value> = runs.iter().filter_map(drive).collect();
    let drives: Vec<Value> = runs.iter().map(row).collect();
    let drivers = pilots(runs);
    let mut summaries: Vec<String> = if runs.len() > drivers.len() {
        drivers.iter().map(|pilot| summary(runs, *pilot)).collect()
    } else {
        Vec::new()
    };
    let comparison = Comparison::of(runs).map(|comparison| comparison.text());
    let lines = comparison.iter().flat_map(|text| text.lines());
    summaries.splice(0..0, lines.map(str::to_owned));
    summaries.extend(warnings(runs));
    let soils: Vec<(String, &str)> = scenario
        .ground
        .soils
        .iter()
        .map(|soil| (format!("soil {}", soil.name), soil.source.as_str()))
        .collect();
    Object::from_iter([
        ("runs".to_owned(), json!(played)),
        ("drives".to_owned(), json!(drives)),
        ("summaries".to_owned(), json!(summaries)),
        ("sources".to_owned(), json!(soils)),
        (
            "optimum_slip_meaning".to_owned(),
            json!(super::optimum::meaning(scenario)),
        ),
        (
            "note".to_owned(),
            json!(
                "Simulated: forces from the stresses under each wheel, sensors with their noise, and the estimator and \
                 controller that run on a robot. The same seed and files give the same numbers."
            ),
        ),
    ])
}

fn played(scenario: &Scenario, optimum: f64, run: &Run) -> Option<Value> {
    let drive = Drive {
        scenario,
        pilot: run.pilot,
        seed: run.seed,
        optimum,
        result: &run.result,
    };
    let mut shown = run.seen.as_ref()?.object(&drive);
    if let Some(planned) = &run.planned {
        shown["planned"] = super::object::planned().object(planned).into();
        shown["tile_m"] = scenario.learn.as_ref().map(|learn| learn.tile).into();
    }
    Some(shown)
}

fn row(run: &Run) -> Value {
    let result = &run.result;
    json!({
        "controller": run.pilot.name(),
        "seed": run.seed,
        "outcome": result.outcome.name(),
        "distance_m": result.distance,
        "duration_s": result.duration,
        "energy_j": result.energy,
        "energy_j_per_m": result.energy_per_metre(),
        "worst_slip": result.worst_slip,
        "slip_rmse": result.slip.rmse,
        "slip_bias": result.slip.bias,
    })
}
