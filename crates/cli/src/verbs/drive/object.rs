//! `drive` as JSON.

use grouser_rover::drive::{NamedDecision, Scenario};
use serde_json::{Value, json};

use super::Run;
use crate::report::Object;

pub(super) fn object(scenario: &Scenario, optimum: f64, seed: u64, runs: &[Run]) -> Object {
    Object::from_iter([
        ("scenario".to_owned(), json!(scenario.name)),
        ("title".to_owned(), json!(scenario.title)),
        ("seed".to_owned(), json!(seed)),
        ("optimum_slip".to_owned(), json!(optimum)),
        (
            "runs".to_owned(),
            runs.iter().map(|run| run_object(scenario, run)).collect(),
        ),
    ])
}

fn run_object(scenario: &Scenario, run: &Run) -> Value {
    let result = &run.result;
    let ledger = &result.ledger;
    json!({
        "controller": run.pilot.name(),
        "seed": run.seed,
        "distance_m": result.distance,
        "way_m": result.way,
        "duration_s": result.duration,
        "outcome": result.outcome.name(),
        "energy_j": result.energy,
        "energy_j_per_m": result.energy_per_metre(),
        "energy_in_soil_j": ledger.soil,
        "energy_books_error": result.energy_error,
        "slip_rmse": result.slip.rmse,
        "slip_rmse_without_starts": result.slip.settled,
        "slip_bias": result.slip.bias,
        "slip_squared_error_over_variance": result.slip.nees,
        "slip_wrong_longest_s": result.slip.longest_wrong,
        "worst_slip": result.worst_slip,
        "refused_samples": result.refused,
        "decision_count": result.decision_count,
        "decisions": result.decisions.iter().map(|d| decision(scenario, d)).collect::<Vec<_>>(),
    })
}

fn decision(scenario: &Scenario, named: &NamedDecision) -> Value {
    let decision = &named.decision;
    let wheels = scenario.robot.robot.wheels();
    json!({
        "time_s": named.time,
        "action": decision.action.name(),
        "reason": decision.reason.name(),
        "wheel": decision.wheel.and_then(|index| wheels.get(index)).map(|wheel| &wheel.name),
        "value": Some(decision.value).filter(|value| value.is_finite()),
        "limit": Some(decision.limit).filter(|limit| limit.is_finite()),
        "x_m": named.place.0,
        "y_m": named.place.1,
    })
}
