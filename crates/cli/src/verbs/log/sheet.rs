//! `log info` of a table.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::columns::Meaning;
use grouser_log::{Sheet, SheetColumn};
use serde_json::Value;

use super::{keyed, printable};
use crate::report::{Object, Report};
use grouser_report::Table;

pub(super) fn report(sheet: &Sheet) -> Report {
    let mut report = Report::done(object(sheet), text(sheet));
    if sheet.ragged > 0 {
        report.warnings.push(format!(
            "{} lines have another number of fields than the header",
            sheet.ragged
        ));
    }
    report
}

/// What an estimate of slip needs and no column seems to hold.
fn lacks(sheet: &Sheet) -> Vec<&'static str> {
    let has = |meanings: &[Meaning]| meanings.iter().any(|meaning| sheet.has(*meaning));
    let wheels = [Meaning::WheelCount, Meaning::WheelAngle, Meaning::WheelRate];
    let motion = [
        Meaning::PoseX,
        Meaning::SpeedForward,
        Meaning::DisplacementForward,
    ];
    let needs = [
        (sheet.time.is_some(), "a column of time"),
        (has(&wheels), "wheel counts, angles or rates"),
        (has(&[Meaning::YawRate]), "a yaw rate"),
        (
            has(&motion),
            "a pose, displacement or speed over ground (a free wheel does as well)",
        ),
    ];
    let missing = needs.into_iter().filter(|(has, _)| !has);
    missing.map(|(_, words)| words).collect()
}

fn meaning(sheet: &Sheet, index: usize) -> String {
    if let Some(time) = sheet.time.as_ref().filter(|time| time.column == index) {
        return format!("time in {}", time.unit);
    }
    let Some(guess) = &sheet.columns[index].guess else {
        return String::new();
    };
    let wheel = guess
        .wheel
        .as_ref()
        .map_or_else(String::new, |wheel| format!(" of {wheel}"));
    format!("{}{wheel} in {}", guess.meaning.name(), guess.unit)
}

fn object(sheet: &Sheet) -> Object {
    let bounded = |column: &SheetColumn, bound: f64| (column.numbers > 0).then_some(bound);
    let columns = sheet.columns.iter().enumerate().map(|(index, column)| {
        let probably = meaning(sheet, index);
        Value::Object(keyed([
            ("column", Value::from(column.name.as_str())),
            ("first", Value::from(column.first.as_str())),
            ("numbers", Value::from(column.numbers)),
            ("empty", Value::from(column.empty)),
            ("others", Value::from(column.others)),
            ("least", Value::from(bounded(column, column.min))),
            ("greatest", Value::from(bounded(column, column.max))),
            (
                "probably",
                Value::from((!probably.is_empty()).then_some(probably)),
            ),
        ]))
    });
    let time = sheet.time.as_ref();
    keyed([
        ("format", Value::from("CSV")),
        (
            "separator",
            Value::from(char::from(sheet.separator).to_string()),
        ),
        (
            "decimal",
            Value::from(char::from(sheet.decimal).to_string()),
        ),
        ("header_lines", Value::from(sheet.header_lines)),
        ("names_line", Value::from(sheet.names_line)),
        ("rows", Value::from(sheet.rows)),
        ("ragged_rows", Value::from(sheet.ragged)),
        ("duration_s", Value::from(time.map(|time| time.duration_s))),
        ("rate_hz", Value::from(time.and_then(|time| time.rate_hz))),
        (
            "longest_interval_s",
            Value::from(time.map(|time| time.longest_s)),
        ),
        ("gaps", Value::from(time.map(|time| time.gaps))),
        ("clock_jumps", Value::from(time.map(|time| time.jumps))),
        ("columns", columns.collect()),
        ("lacks", lacks(sheet).into()),
    ])
}

fn text(sheet: &Sheet) -> String {
    let mut out = format!(
        "CSV, {} rows of {} columns",
        sheet.rows,
        sheet.columns.len()
    );
    if let Some(time) = &sheet.time {
        let _ = write!(out, ", {:.3} s", time.duration_s);
        if let Some(rate) = time.rate_hz {
            let _ = write!(
                out,
                ", {rate:.2} Hz, longest interval {:.3} s, {} gaps, {} clock jumps",
                time.longest_s, time.gaps, time.jumps
            );
        }
    }
    out.push_str("\n\n");
    let mut table = Table::new()
        .text("column")
        .text("first")
        .number("least")
        .number("greatest")
        .number("empty")
        .text("probably");
    for (index, column) in sheet.columns.iter().enumerate() {
        let bound = |bound: f64| {
            if column.numbers > 0 {
                format!("{bound}")
            } else {
                "–".to_owned()
            }
        };
        table.row([
            printable(&column.name),
            printable(&column.first),
            bound(column.min),
            bound(column.max),
            column.empty.to_string(),
            meaning(sheet, index),
        ]);
    }
    out.push_str(&table.render());
    let missing = lacks(sheet);
    if missing.is_empty() {
        out.push_str("\nhas time, wheels, yaw rate and motion, by the names of its columns\n");
    } else {
        let _ = writeln!(
            out,
            "\nfor slip it lacks, by the names of its columns, {}",
            missing.join("; ")
        );
    }
    out
}
