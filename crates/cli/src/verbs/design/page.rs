//! The front for the page, in the form of an optimiser's answer.

use grouser_design::mission::{DesignPoint, WheelDesign};
use grouser_report::Object;
use serde_json::{Value, json};

use super::object::Designed;
use super::problem;
use crate::error::Result;

/// What the page shows: the front of mass and energy, the problem of its chosen wheel, and the report in words.
pub(super) fn shown(designed: &Designed<'_>, text: &str) -> Result<Object> {
    let params = designed.mission.params();
    let variables =
        WheelDesign::NAMES
            .iter()
            .zip(params.ranges.list())
            .map(|(name, (lower, upper))| {
                let unit = if name.ends_with("_m") { "m" } else { "" };
                json!({ "name": name, "unit": unit, "lower": lower, "upper": upper })
            });
    let point = |point: &DesignPoint| {
        let sizes = WheelDesign::NAMES.iter().zip(point.wheel.sizes());
        let sizes: Object = sizes
            .map(|(name, size)| ((*name).to_owned(), size.into()))
            .collect();
        json!({
            "x": sizes,
            "objectives": { "wheel_mass_kg": point.wheel_mass, "energy_j_per_m": point.energy },
            "objective_multipliers": Value::Null,
        })
    };
    let chosen = designed.chosen();
    let points: Vec<&DesignPoint> = designed
        .front
        .points
        .iter()
        .filter(|p| p.energy.is_some())
        .collect();
    let is_chosen = |p: &&DesignPoint| chosen.is_some_and(|chosen| std::ptr::eq(*p, chosen));
    let answer = json!({
        "title": format!("The wheel of {}", designed.carrier.name()),
        "method": "pareto",
        "variables": variables.collect::<Vec<_>>(),
        "objectives": [
            { "name": "wheel_mass_kg", "text": params.mass_formula },
            { "name": "energy_j_per_m", "text": "energy of the mission per metre" },
        ],
        "status": if points.is_empty() { "no_feasible_point" } else { "converged" },
        "is_solved": !points.is_empty(),
        "front": points.iter().map(|p| point(p)).collect::<Vec<_>>(),
        "knee": points.iter().position(is_chosen),
        "violation": 0.0,
    });
    let problem = match designed.shown() {
        Some(one) => problem::toml(designed.mission, one, designed.carrier.wheel_count())?,
        None => String::new(),
    };
    Ok(Object::from_iter([
        ("answer".to_owned(), answer),
        ("problem".to_owned(), problem.into()),
        ("proof".to_owned(), text.into()),
    ]))
}
