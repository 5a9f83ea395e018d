//! `log info` of a table.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::columns::Meaning;
use grouser_log::{Sheet, SheetColumn};
use grouser_report::Fields;

use crate::report::Report;

pub(super) fn report(sheet: &Sheet) -> Report {
    let mut report = Report::done(fields().object(sheet), text(sheet));
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

/// A column and its place in the sheet.
type Column<'a> = (&'a Sheet, usize);

fn column<'a>() -> Fields<'a, Column<'a>> {
    fn of<'a>((sheet, index): Column<'a>) -> &'a SheetColumn {
        &sheet.columns[index]
    }
    fn bound(column: &SheetColumn, bound: f64) -> Option<f64> {
        (column.numbers > 0).then_some(bound)
    }
    let probably =
        |(sheet, index): Column<'a>| Some(meaning(sheet, index)).filter(|words| !words.is_empty());
    Fields::new()
        .field("column", "column", |c: Column<'a>| of(c).name.as_str())
        .shown("")
        .field("first", "first", |c| of(c).first.as_str())
        .shown("")
        .field("numbers", "cells with a number", |c| of(c).numbers)
        .field("empty", "empty", |c| of(c).empty)
        .shown("")
        .field("others", "cells with something else", |c| of(c).others)
        .field("least", "least", |c| bound(of(c), of(c).least))
        .shown("")
        .all_digits()
        .field("greatest", "greatest", |c| bound(of(c), of(c).greatest))
        .shown("")
        .all_digits()
        .field("probably", "probably", probably)
        .shown("")
        .missing("")
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Sheet> {
    let letter = |byte: u8| char::from(byte).to_string();
    Fields::new()
        .field("format", "format", |_: &Sheet| "CSV")
        .field("separator", "character between fields", move |sheet| {
            letter(sheet.separator)
        })
        .field("decimal", "decimal mark", move |sheet| {
            letter(sheet.decimal)
        })
        .field("header_lines", "lines before the first row", |sheet| {
            sheet.header_lines
        })
        .field("names_line", "line with the names", |sheet| {
            sheet.names_line
        })
        .field("rows", "rows", |sheet| sheet.rows)
        .field(
            "ragged_rows",
            "rows with another number of fields than the header",
            |sheet| sheet.ragged,
        )
        .field(
            "duration_s",
            "time from the first row to the last",
            |sheet| Some(sheet.time.as_ref()?.duration_s),
        )
        .field("rate_hz", "rate", |sheet| sheet.time.as_ref()?.rate_hz)
        .field("longest_interval_s", "longest interval", |sheet| {
            Some(sheet.time.as_ref()?.longest_s)
        })
        .field("gaps", "gaps", |sheet| Some(sheet.time.as_ref()?.gaps))
        .field("clock_jumps", "clock jumps", |sheet| {
            Some(sheet.time.as_ref()?.jumps)
        })
        .rows("columns", "columns", column(), |sheet: &'a Sheet| {
            (0..sheet.columns.len()).map(move |index| (sheet, index))
        })
        .field(
            "lacks",
            "what an estimate of slip needs and no column seems to hold",
            lacks,
        )
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
    let seen = column().pick(&["column", "first", "least", "greatest", "empty", "probably"]);
    out.push_str(&seen.table((0..sheet.columns.len()).map(|index| (sheet, index))));
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
