//! The answer of the optimiser, with the numbers of `grouser optimize --json`.

use grouser_design::{Answer, Compromise, Design, Optimum, Trade};
use grouser_opt::Status;
use serde_json::{Map, Value, json};

/// The answer as the page shows it; `None` for a kind of answer that it does not know.
///
/// ```
/// use grouser_files::Document;
///
/// let problem = r#"
///     format = 1
///     method = "minimax"
///     [variables]
///     x = { start = 1.0 }
///     [objectives]
///     f = "(x - 2)^2 + 1"
/// "#;
/// let design = grouser_design::parse(&Document::from_text("p.toml", problem.to_owned())?)?;
/// let shown = grouser_page::answer::object(&design, &design.solve()?).expect("a known kind");
/// assert!((shown["x"]["x"].as_f64().expect("a number") - 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn object(design: &Design, answer: &Answer) -> Option<Value> {
    let mut out = json!({
        "title": design.title,
        "method": design.task.name(),
        "variables": design.variables.iter().enumerate().map(|(i, variable)| json!({
            "name": variable.name,
            "unit": design.units.get(i),
            "lower": finite(variable.lower),
            "upper": finite(variable.upper),
        })).collect::<Vec<_>>(),
        "objectives": design.objectives.iter().map(|objective| json!({
            "name": objective.name,
            "text": objective.text,
        })).collect::<Vec<_>>(),
    });
    match answer {
        Answer::Optimum(optimum) => add_optimum(&mut out, design, optimum),
        Answer::Trade(trade) => add_front(&mut out, design, trade),
        _ => return None,
    }
    Some(out)
}

fn finite(bound: f64) -> Option<f64> {
    bound.is_finite().then_some(bound)
}

fn named<'a>(values: impl IntoIterator<Item = (&'a str, f64)>) -> Value {
    let object: Map<String, Value> = values
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect();
    object.into()
}

fn pairs(values: &[(String, f64)]) -> Value {
    named(values.iter().map(|(name, value)| (name.as_str(), *value)))
}

fn variables(design: &Design, x: &[f64]) -> Value {
    let names = design
        .variables
        .iter()
        .map(|variable| variable.name.as_str());
    named(names.zip(x.iter().copied()))
}

fn objectives(design: &Design, values: &[f64]) -> Value {
    let names = design
        .objectives
        .iter()
        .map(|objective| objective.name.as_str());
    named(names.zip(values.iter().copied()))
}

fn add_optimum(out: &mut Value, design: &Design, optimum: &Optimum) {
    out["status"] = json!(optimum.status.name());
    out["is_solved"] = json!(optimum.status.is_solved());
    out["x"] = variables(design, &optimum.x);
    out["values"] = pairs(&optimum.objectives);
    out["max"] = json!(optimum.maximum);
    out["objective_multipliers"] = pairs(&optimum.objective_multipliers);
    out["constraint_multipliers"] = pairs(&optimum.constraint_multipliers);
    out["active"] = json!(optimum.active);
    out["iterations"] = json!(optimum.counts.iterations);
    out["starts"] = json!(optimum.starts.len());
    out["is_ambiguous"] = json!(optimum.is_ambiguous);
    if let Status::NoFeasiblePoint(violations) = &optimum.status {
        out["violated"] = named(violations.iter().map(|v| (v.name.as_str(), v.amount)));
    }
}

fn add_front(out: &mut Value, design: &Design, trade: &Trade) {
    let point = |point: &Compromise| {
        let multipliers = point.multipliers.as_ref();
        json!({
            "x": variables(design, &point.x),
            "objectives": objectives(design, &point.objectives),
            "objective_multipliers": multipliers.map(|shares| objectives(design, shares)),
        })
    };
    out["status"] = json!(if trade.points.is_empty() {
        "no_feasible_point"
    } else {
        "converged"
    });
    out["is_solved"] = json!(!trade.points.is_empty());
    out["front"] = trade.points.iter().map(point).collect();
    out["knee"] = json!(trade.knee);
    out["violation"] = json!(trade.violation);
}
