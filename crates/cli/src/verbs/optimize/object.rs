//! The JSON object of `optimize`.

use grouser_design::{Answer, Compromise, Design, Optimum, Trade};
use grouser_opt::{Counts, Kkt, Status};
use serde_json::Value;

use crate::report::Object;

/// Every key, `null` where it does not apply.
pub(super) fn object(design: &Design, answer: &Answer) -> Object {
    match answer {
        Answer::Optimum(optimum) => of_optimum(design, optimum),
        Answer::Trade(trade) => of_trade(design, trade),
        _ => Object::new(),
    }
}

fn named<'n>(names: impl IntoIterator<Item = &'n str>, values: &[f64]) -> Value {
    names
        .into_iter()
        .zip(values)
        .map(|(name, value)| (name.to_owned(), Value::from(*value)))
        .collect::<Object>()
        .into()
}

fn listed(pairs: &[(String, f64)]) -> Value {
    pairs
        .iter()
        .map(|(name, value)| (name.clone(), Value::from(*value)))
        .collect::<Object>()
        .into()
}

fn variables(design: &Design) -> impl Iterator<Item = &str> {
    design.variables.iter().map(|v| v.name.as_str())
}

fn objectives(design: &Design) -> impl Iterator<Item = &str> {
    design.objectives.iter().map(|o| o.name.as_str())
}

fn violated(status: &Status) -> Value {
    match status {
        Status::NoFeasiblePoint(violations) => violations
            .iter()
            .map(|v| (v.name.clone(), Value::from(v.amount)))
            .collect::<Object>()
            .into(),
        _ => Value::Null,
    }
}

fn kkt(kkt: &Kkt) -> Value {
    Object::from_iter([
        ("stationarity".to_owned(), Value::from(kkt.stationarity)),
        ("gradient_scale".to_owned(), Value::from(kkt.gradient_scale)),
        (
            "complementarity".to_owned(),
            Value::from(kkt.complementarity),
        ),
        ("violation".to_owned(), Value::from(kkt.violation)),
    ])
    .into()
}

fn counts(object: &mut Object, counts: Counts) {
    for (key, count) in [
        ("iterations", counts.iterations),
        ("values", counts.values),
        ("jacobians", counts.jacobians),
    ] {
        object.insert(key.to_owned(), Value::from(count));
    }
}

fn of_optimum(design: &Design, optimum: &Optimum) -> Object {
    let mut object = Object::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    put("method", Value::from(design.task.name()));
    put("status", Value::from(optimum.status.name()));
    put("x", named(variables(design), &optimum.x));
    put("objectives", listed(&optimum.objectives));
    put("max", Value::from(optimum.maximum));
    put("utility", Value::from(optimum.utility));
    put("attainment", Value::from(optimum.attainment));
    put(
        "objective_multipliers",
        listed(&optimum.objective_multipliers),
    );
    put(
        "constraint_multipliers",
        listed(&optimum.constraint_multipliers),
    );
    let bounds = variables(design).zip(&optimum.bound_multipliers);
    put(
        "bound_multipliers",
        bounds
            .map(|(name, (lower, upper))| {
                let pair = named(["lower", "upper"], &[*lower, *upper]);
                (name.to_owned(), pair)
            })
            .collect::<Object>()
            .into(),
    );
    put(
        "active",
        optimum.active.iter().map(String::as_str).collect(),
    );
    put("violated", violated(&optimum.status));
    put("kkt", kkt(&optimum.kkt));
    counts(&mut object, optimum.counts);
    let starts = optimum.starts.iter().map(|start| {
        Value::from(Object::from_iter([
            ("x".to_owned(), named(variables(design), &start.x)),
            ("max".to_owned(), Value::from(start.maximum)),
            ("status".to_owned(), Value::from(start.status.name())),
        ]))
    });
    object.insert("starts".to_owned(), starts.collect());
    let optima = optimum.optima.iter().map(|(start, count)| {
        Value::from(Object::from_iter([
            ("start".to_owned(), Value::from(*start)),
            ("reached_by".to_owned(), Value::from(*count)),
        ]))
    });
    object.insert("optima".to_owned(), optima.collect());
    object.insert("front".to_owned(), Value::Null);
    object.insert("knee".to_owned(), Value::Null);
    object
}

fn of_trade(design: &Design, trade: &Trade) -> Object {
    let mut object = Object::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    let found = !trade.points.is_empty();
    put("method", Value::from(design.task.name()));
    put(
        "status",
        Value::from(if found {
            "converged"
        } else {
            "no_feasible_point"
        }),
    );
    // One point stands for the front where one is asked for: its knee.
    let knee = trade.knee.and_then(|knee| trade.points.get(knee));
    let of_knee = |f: &dyn Fn(&Compromise) -> Value| knee.map_or(Value::Null, f);
    put("x", of_knee(&|p| named(variables(design), &p.x)));
    put(
        "objectives",
        of_knee(&|p| named(objectives(design), &p.objectives)),
    );
    put("max", of_knee(&|p| Value::from(maximum(design, p))));
    put("utility", Value::Null);
    put("attainment", Value::Null);
    put(
        "objective_multipliers",
        of_knee(&|p| {
            p.multipliers
                .as_ref()
                .map_or(Value::Null, |m| named(objectives(design), m))
        }),
    );
    for key in [
        "constraint_multipliers",
        "bound_multipliers",
        "active",
        "violated",
        "kkt",
    ] {
        put(key, Value::Null);
    }
    counts(&mut object, trade.counts);
    object.insert("starts".to_owned(), Value::Array(Vec::new()));
    object.insert("optima".to_owned(), Value::Array(Vec::new()));
    let front = trade.points.iter().map(|point| {
        let multipliers = point
            .multipliers
            .as_ref()
            .map_or(Value::Null, |m| named(objectives(design), m));
        Value::from(Object::from_iter([
            ("x".to_owned(), named(variables(design), &point.x)),
            (
                "objectives".to_owned(),
                named(objectives(design), &point.objectives),
            ),
            ("objective_multipliers".to_owned(), multipliers),
        ]))
    });
    object.insert("front".to_owned(), front.collect());
    object.insert("knee".to_owned(), Value::from(trade.knee));
    object
}

fn maximum(design: &Design, point: &Compromise) -> f64 {
    design
        .objectives
        .iter()
        .zip(&point.objectives)
        .map(|(o, f)| if o.absolute { f.abs() } else { *f })
        .fold(f64::NEG_INFINITY, f64::max)
}
