//! The drives of a report: those of the first seed to play, all of them in a table.

use grouser_page::run::Drive;
use grouser_report::Object;
use grouser_rover::drive::Scenario;
use serde_json::{Value, json};

use super::comparison::Comparison;
use super::object;
use super::run::{Run, pilots, warnings};
use super::text::summary;

pub(super) fn report(scenario: &Scenario, optimum: f64, runs: &[Run]) -> Object {
    let drive = |run| played(scenario, optimum, run);
    let played: Vec<Value> = runs.iter().filter_map(drive).collect();
    let rows = object::run().pick(&object::COLUMNS);
    let drives: Vec<Object> = runs
        .iter()
        .map(|run| rows.object((scenario, run)))
        .collect();
    let drivers = pilots(runs).into_iter();
    let mut summaries: Vec<String> = drivers.map(|pilot| summary(runs, pilot)).collect();
    let comparison = Comparison::of(runs).map(|comparison| comparison.text());
    let lines = comparison.iter().flat_map(|text| text.lines());
    summaries.extend(lines.map(str::to_owned));
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
        shown["planned"] = object::planned().object(planned).into();
        shown["tile_m"] = scenario.learn.as_ref().map(|learn| learn.tile).into();
    }
    Some(shown)
}
