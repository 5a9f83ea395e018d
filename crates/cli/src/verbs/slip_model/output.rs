//! What `slip-model` tells: text, a table, JSON.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_terra::{Mobilised, ModelSlip};
use serde_json::Value;

use super::Point;
use crate::report::Object;
use grouser_report::Table;
use grouser_report::number::{exact, short, shown};

/// One point has its keys at the top; several stand in `points`.
pub(super) fn object(points: &[Point], mobilised: Option<Mobilised>) -> Object {
    let mut object = Object::from_iter([
        (
            "model".to_owned(),
            Value::from("Ani et al. 2012, S = 1 - v/(r w)"),
        ),
        (
            "mobilised".to_owned(),
            Value::from(mobilised.map_or(0.0, |mobilised| mobilised.share)),
        ),
        (
            "k_shear_m".to_owned(),
            Value::from(mobilised.map(|mobilised| mobilised.k_shear)),
        ),
    ]);
    match points {
        [point] => object.extend(keys(point)),
        points => {
            let points = points
                .iter()
                .map(|point| Value::Object(keys(point)))
                .collect();
            object.insert("points".to_owned(), points);
        }
    }
    object
}

/// One point, for people.
pub(super) fn single(point: &Point, share: f64) -> String {
    let mut text = format!(
        "θ {} deg, sinkage {} mm, radius {} mm, {} of the strength mobilised\n",
        shown(point.theta_deg),
        shown(1e3 * point.sinkage_m),
        shown(1e3 * point.radius_m),
        if share == 0.0 {
            "none".to_owned()
        } else {
            shown(share)
        }
    );
    if let Some(slip) = point.slip() {
        let mut table = Table::new().text("").number("").text("");
        for (name, value, unit) in [
            ("slip S = 1 − v/(r ω)", slip.driving_formula, ""),
            ("its magnitude", slip.driving_formula.abs(), ""),
            ("as a slip ratio s", slip.slip.value(), ""),
            ("entry angle", slip.theta_1.deg(), "deg"),
        ] {
            table.row([name, &shown(value), unit]);
        }
        text.push_str(&table.render_body());
        if !slip.in_contact {
            let entry = shown(slip.theta_1.deg());
            let _ = writeln!(
                text,
                "caution: θ lies outside the contact, which ends at {entry} deg"
            );
        }
    }
    text
}

/// Several points, for people.
pub(super) fn table(points: &[Point]) -> String {
    let mut table = Table::new()
        .number("θ deg")
        .number("z mm")
        .number("r mm")
        .number("S")
        .number("|S|")
        .number("s")
        .text("");
    for point in points {
        let slip = point.slip();
        let number =
            |f: fn(&ModelSlip) -> f64| slip.as_ref().map(f).map_or_else(|| "–".to_owned(), shown);
        let remark = match slip {
            None => point.status(),
            Some(slip) if !slip.in_contact => "outside the contact",
            Some(_) => "",
        };
        table.row([
            shown(point.theta_deg),
            shown(1e3 * point.sinkage_m),
            shown(1e3 * point.radius_m),
            number(|slip| slip.driving_formula),
            number(|slip| slip.driving_formula.abs()),
            number(|slip| slip.slip.value()),
            remark.to_owned(),
        ]);
    }
    table.render()
}

/// All points as a table.
pub(super) fn csv(points: &[Point], share: f64) -> String {
    let mut lines = String::from(
        "theta_deg,sinkage_m,radius_m,mobilised,slip,slip_magnitude,slip_ratio,theta_1_deg,in_contact,status\n",
    );
    for point in points {
        let slip = point.slip();
        let number =
            |f: fn(&ModelSlip) -> f64| slip.as_ref().map(f).map_or_else(String::new, exact);
        let _ = writeln!(
            lines,
            "{},{},{},{},{},{},{},{},{},{}",
            short(point.theta_deg),
            short(point.sinkage_m),
            short(point.radius_m),
            short(share),
            number(|slip| slip.driving_formula),
            number(|slip| slip.driving_formula.abs()),
            number(|slip| slip.slip.value()),
            number(|slip| slip.theta_1.deg()),
            slip.map_or_else(String::new, |slip| slip.in_contact.to_string()),
            point.status()
        );
    }
    lines
}

fn keys(point: &Point) -> Object {
    let slip = point.slip();
    let number = |f: fn(&ModelSlip) -> f64| Value::from(slip.as_ref().map(f));
    [
        ("theta_deg", Value::from(point.theta_deg)),
        ("sinkage_m", Value::from(point.sinkage_m)),
        ("radius_m", Value::from(point.radius_m)),
        ("status", Value::from(point.status())),
        ("slip", number(|slip| slip.driving_formula)),
        ("slip_magnitude", number(|slip| slip.driving_formula.abs())),
        ("slip_ratio", number(|slip| slip.slip.value())),
        ("theta_1_deg", number(|slip| slip.theta_1.deg())),
        ("in_contact", Value::from(slip.map(|slip| slip.in_contact))),
        ("most_mobilised", Value::from(point.most())),
        ("cautions", Value::from(point.cautions())),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}
