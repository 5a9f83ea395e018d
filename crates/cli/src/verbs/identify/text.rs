//! `identify` for people and for programs.

use std::fmt::Write as _;

use grouser_identify::least_squares::{Interval, Verdict};
use grouser_identify::plate::PlateFit;
use grouser_identify::wheel::Quantity;
use grouser_identify::{Identification, WheelStage};
use serde_json::Value;

use crate::report::Object;
use grouser_report::Table;
use grouser_report::number::rounded;

/// One number: name, value, standard error, interval, verdict, in the unit of its name.
struct Line {
    name: String,
    value: f64,
    standard_error: f64,
    interval: Interval,
    verdict: Verdict,
}

/// What was found, as tables.
pub(super) fn text(found: &Identification) -> String {
    let mut out = String::new();
    if let Some(stage) = &found.plates {
        let readings: usize = stage.fit.residuals.iter().map(Vec::len).sum();
        let _ = writeln!(
            out,
            "{} plate tests, {readings} readings that tell as much as {} independent ones, {} % of scatter about the law",
            stage.tests.len(),
            rounded(readings as f64 / stage.fit.redundancy, 3),
            rounded(100.0 * stage.fit.relative_deviation, 2),
        );
        for record in &stage.records {
            let _ = writeln!(
                out,
                "{}: clocks {} s apart ({} s after time zones), surface at {} mm",
                record.test.name,
                rounded(record.zone_s + record.offset_s, 7),
                rounded(record.offset_s, 2),
                rounded(1e3 * record.contact_height, 4),
            );
        }
        let _ = writeln!(
            out,
            "k_c {} kN/m^(n+1), k_phi {} kN/m^(n+2)",
            rounded(stage.fit.k_c / 1e3, 4),
            rounded(stage.fit.k_phi / 1e3, 4)
        );
        out.push_str(&table(&plate_lines(&stage.fit)));
    }
    if let Some(stage) = &found.shear {
        let _ = writeln!(out, "{} shear readings", stage.readings.len());
        out.push_str(&table(&shear_lines(found)));
    }
    if let Some(stage) = &found.wheel {
        let _ = writeln!(
            out,
            "{} wheel tests: {}, {} of {} starts ended here, condition {}",
            stage.tests.len(),
            stage.status.key(),
            stage.reached,
            stage.starts,
            rounded(stage.condition, 2)
        );
        out.push_str(&table(&wheel_lines(stage)));
        for (quantity, rmse, count) in errors(stage) {
            let _ = writeln!(
                out,
                "{} of {count} readings: RMSE {} {}",
                quantity.key(),
                rounded(rmse, 3),
                quantity.unit()
            );
        }
        if let Some((a, b, r)) = strongest(stage) {
            let _ = writeln!(
                out,
                "most alike: {a} and {b}, correlation {}",
                rounded(r, 2)
            );
        }
    }
    out
}

/// What must not be overlooked.
pub(super) fn warnings(found: &Identification) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(stage) = &found.plates {
        lines.extend(plate_lines(&stage.fit));
    }
    lines.extend(shear_lines(found));
    if let Some(stage) = &found.wheel {
        lines.extend(wheel_lines(stage));
    }
    lines
        .iter()
        .filter_map(|line| {
            let what = match line.verdict {
                Verdict::NotIdentifiable => "cannot be told from these tests",
                Verdict::OnBound => "lies on its bound",
                Verdict::Loose => "is hardly told: its interval is as wide as its bounds",
                _ => return None,
            };
            Some(format!("{} {what}", line.name))
        })
        .collect()
}

/// The same for programs.
pub(super) fn object(found: &Identification) -> Object {
    let stage = |lines: Vec<Line>| -> Object {
        lines
            .into_iter()
            .map(|line| (line.name.clone(), line_object(&line)))
            .collect()
    };
    let mut out = Object::new();
    out.insert(
        "plates".to_owned(),
        found
            .plates
            .as_ref()
            .map_or(Value::Null, |stage| plate_object(&stage.fit)),
    );
    out.insert(
        "shear".to_owned(),
        found
            .shear
            .as_ref()
            .map_or(Value::Null, |_| Value::Object(stage(shear_lines(found)))),
    );
    out.insert(
        "wheel".to_owned(),
        found.wheel.as_ref().map_or(Value::Null, |wheel| {
            let correlation = wheel
                .correlation
                .iter()
                .map(|row| row.iter().copied().map(Value::from).collect::<Value>())
                .collect::<Value>();
            let rmse = errors(wheel)
                .into_iter()
                .map(|(quantity, rmse, _)| {
                    let key = format!("{}_{}", quantity.key(), unit_key(quantity));
                    (key, Value::from(rmse))
                })
                .collect::<Object>();
            Value::Object(Object::from_iter([
                ("status".to_owned(), Value::from(wheel.status.key())),
                ("tests".to_owned(), Value::from(wheel.tests.len())),
                ("starts".to_owned(), Value::from(wheel.starts)),
                ("reached".to_owned(), Value::from(wheel.reached)),
                ("condition".to_owned(), Value::from(wheel.condition)),
                (
                    "parameters".to_owned(),
                    Value::Object(stage(wheel_lines(wheel))),
                ),
                ("correlation".to_owned(), correlation),
                ("rmse".to_owned(), Value::Object(rmse)),
            ]))
        }),
    );
    out.insert(
        "missing".to_owned(),
        found.missing().into_iter().map(Value::from).collect(),
    );
    out
}

/// What plates told, for programs.
pub(crate) fn plate_object(fit: &PlateFit) -> Value {
    let numbers: Object = plate_lines(fit)
        .iter()
        .map(|line| (line.name.clone(), line_object(line)))
        .collect();
    Value::Object(Object::from_iter([
        ("n".to_owned(), Value::from(fit.n)),
        ("k_c_kn_per_m_n1".to_owned(), Value::from(fit.k_c / 1e3)),
        ("k_phi_kn_per_m_n2".to_owned(), Value::from(fit.k_phi / 1e3)),
        ("redundancy".to_owned(), Value::from(fit.redundancy)),
        (
            "relative_deviation".to_owned(),
            Value::from(fit.relative_deviation),
        ),
        ("parameters".to_owned(), Value::Object(numbers)),
    ]))
}

fn line_object(line: &Line) -> Value {
    Value::Object(Object::from_iter([
        ("value".to_owned(), Value::from(line.value)),
        (
            "standard_error".to_owned(),
            Value::from(line.standard_error),
        ),
        ("low".to_owned(), Value::from(line.interval.low)),
        ("high".to_owned(), Value::from(line.interval.high)),
        ("verdict".to_owned(), Value::from(line.verdict.key())),
    ]))
}

fn unit_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pull | Quantity::Side => "n",
        Quantity::Torque => "nm",
        Quantity::Sinkage => "mm",
    }
}

fn plate_lines(fit: &PlateFit) -> Vec<Line> {
    fit.parameters
        .iter()
        .map(|number| Line {
            name: number.name.clone(),
            value: number.value,
            standard_error: number.standard_error,
            interval: number.interval,
            verdict: number.verdict,
        })
        .collect()
}

fn shear_lines(found: &Identification) -> Vec<Line> {
    let Some(stage) = &found.shear else {
        return Vec::new();
    };
    let names = [
        ("cohesion_kpa", 1e3),
        ("phi_deg", std::f64::consts::PI / 180.0),
        ("k_shear_m", 1.0),
    ];
    names
        .into_iter()
        .enumerate()
        .map(|(index, (name, unit))| Line {
            name: name.to_owned(),
            value: stage.fit.values[index] / unit,
            standard_error: stage.fit.standard_errors[index] / unit,
            interval: scaled(stage.fit.intervals[index], |v| v / unit),
            verdict: stage.fit.uncertainty.verdicts[index],
        })
        .collect()
}

fn wheel_lines(stage: &WheelStage) -> Vec<Line> {
    stage
        .numbers
        .iter()
        .map(|number| {
            let unit = |value| number.parameter.to_key_unit(value);
            Line {
                name: number.parameter.key().to_owned(),
                value: unit(number.value),
                standard_error: unit(number.standard_error),
                interval: scaled(number.interval, unit),
                verdict: number.verdict,
            }
        })
        .collect()
}

fn scaled(interval: Interval, unit: impl Fn(f64) -> f64) -> Interval {
    Interval {
        low: interval.low.map(&unit),
        high: interval.high.map(&unit),
    }
}

fn table(lines: &[Line]) -> String {
    let mut table = Table::new()
        .text("  number")
        .number("value")
        .number("± std. error")
        .number("95 % from")
        .number("to")
        .text("");
    let end = |value: Option<f64>| value.map_or("open".to_owned(), |v| rounded(v, 4));
    for line in lines {
        let error = if line.standard_error.is_nan() {
            String::new()
        } else {
            rounded(line.standard_error, 2)
        };
        table.row([
            format!("  {}", line.name),
            rounded(line.value, 4),
            error,
            end(line.interval.low),
            end(line.interval.high),
            line.verdict.key().to_owned(),
        ]);
    }
    table.render()
}

/// Root mean square error of each quantity that was read, in its unit.
fn errors(stage: &WheelStage) -> Vec<(Quantity, f64, usize)> {
    Quantity::ALL
        .into_iter()
        .filter_map(|quantity| {
            let errors: Vec<f64> = stage
                .tests
                .iter()
                .zip(&stage.said)
                .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
                .collect();
            let squares: f64 = errors.iter().map(|e| e * e).sum();
            let count = errors.len();
            (count > 0).then(|| {
                let rmse = (squares / count as f64).sqrt() / quantity.scale();
                (quantity, rmse, count)
            })
        })
        .collect()
}

/// The two numbers that are hardest to tell apart.
fn strongest(stage: &WheelStage) -> Option<(&'static str, &'static str, f64)> {
    let mut best: Option<(&'static str, &'static str, f64)> = None;
    for (i, row) in stage.correlation.iter().enumerate() {
        for (j, r) in row.iter().enumerate().take(i) {
            if r.is_finite() && best.is_none_or(|(_, _, most)| r.abs() > most.abs()) {
                let key = |index: usize| stage.numbers[index].parameter.key();
                best = Some((key(j), key(i), *r));
            }
        }
    }
    best
}
