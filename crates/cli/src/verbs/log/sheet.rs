//! `log info` of a table.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::columns::Meaning;
use grouser_log::{Sheet, SheetColumn};
use grouser_report::{Fields, fields};

use crate::verb_report::Report;

pub(super) fn report(sheet: &Sheet) -> Report {
    let mut report = Report::done(fields().object(sheet), text(sheet));
    let ragged = sheet.ragged - u64::from(sheet.is_cut_off);
    if ragged > 0 {
        report.warnings.push(format!(
            "{ragged} lines have another number of fields than the header"
        ));
    }
    if sheet.is_cut_off {
        let warning = "the last line is cut off: an estimate leaves it out";
        report.warnings.push(warning.to_owned());
    }
    report
}

/// What an estimate of slip needs and no column seems to hold.
fn lacks(sheet: &Sheet) -> Vec<&'static str> {
    let has = |meanings: &[Meaning]| meanings.iter().any(|meaning| sheet.has(*meaning));
    let wheels = [
        Meaning::WheelCount,
        Meaning::WheelAngle,
        Meaning::WheelDistance,
        Meaning::WheelRate,
        Meaning::WheelSpeed,
    ];
    let motion = [
        Meaning::PoseX,
        Meaning::Latitude,
        Meaning::SpeedForward,
        Meaning::SpeedSize,
        Meaning::DisplacementForward,
    ];
    let turn = [
        Meaning::YawRate,
        Meaning::PoseYaw,
        Meaning::OrientationZ,
        Meaning::DisplacementTurn,
    ];
    let needs = [
        (sheet.time.is_some(), "a column of time"),
        (has(&wheels), "wheel counts, angles, distances or rates"),
        (has(&turn), "a yaw rate or a heading"),
        (
            has(&motion),
            if has(&wheels) {
                "a pose, displacement or speed over ground (not needed if one of these wheels is not driven)"
            } else {
                "a pose, displacement or speed over ground (or a wheel that is not driven)"
            },
        ),
    ];
    let missing = needs.into_iter().filter(|(has, _)| !has);
    missing.map(|(_, words)| words).collect()
}

fn meaning(sheet: &Sheet, index: usize) -> String {
    if let Some(time) = sheet.time.as_ref().filter(|time| time.column == index) {
        return format!("time in {}", time.unit);
    }
    let beyond = sheet
        .time
        .as_ref()
        .filter(|time| time.nanoseconds == Some(index));
    if let Some(time) = beyond {
        let what = if time.unit == "date" {
            "time of day"
        } else {
            "nanoseconds beyond the time"
        };
        return what.to_owned();
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
#[derive(Clone, Copy)]
struct Column<'a> {
    sheet: &'a Sheet,
    index: usize,
}

impl<'a> Column<'a> {
    fn all(sheet: &'a Sheet) -> impl Iterator<Item = Self> {
        (0..sheet.columns.len()).map(move |index| Self { sheet, index })
    }

    fn of(self) -> &'a SheetColumn {
        &self.sheet.columns[self.index]
    }

    fn bound(self, bound: f64) -> Option<f64> {
        (self.of().numbers > 0).then_some(bound)
    }

    fn meaning(self) -> Option<String> {
        Some(meaning(self.sheet, self.index)).filter(|words| !words.is_empty())
    }
}

fn column<'a>() -> Fields<'a, Column<'a>> {
    fields! { |column: Column<'a>|
        "column" "column" .shown("") = column.of().name.as_str();
        "first" "first" .shown("") = column.of().first.as_str();
        "numbers" "cells with a number" = column.of().numbers;
        "empty" "empty" .shown("") = column.of().empty;
        "others" "cells with something else" = column.of().others;
        "least" "minimum" .shown("").label("min").all_digits() = column.bound(column.of().min);
        "greatest" "maximum" .shown("").label("max").all_digits() = column.bound(column.of().max);
        "probably" "probably" .shown("").missing("") = column.meaning();
    }
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Sheet> {
    let letter = |byte: u8| char::from(byte).to_string();
    fields! { |sheet: &'a Sheet|
        "format" "format" = "CSV";
        "separator" "character between fields" = letter(sheet.separator);
        "decimal" "decimal mark" = letter(sheet.decimal);
        "header_lines" "lines before the first row" = sheet.header_lines;
        "names_line" "line with the names" = sheet.names_line;
        "rows" "rows" = sheet.rows;
        "ragged_rows" "rows with another number of fields than the header" = sheet.ragged;
        "cut_off" "whether the last of them is cut off" = sheet.is_cut_off;
        "duration_s" "time from the first row to the last" = sheet.time.as_ref().map(|time| time.duration_s);
        "rate_hz" "rate" = sheet.time.as_ref().and_then(|time| time.rate_hz);
        "longest_interval_s" "longest interval" = sheet.time.as_ref().map(|time| time.longest_s);
        "gaps" "gaps" = sheet.time.as_ref().map(|time| time.gaps);
        "clock_jumps" "clock jumps" = sheet.time.as_ref().map(|time| time.jumps);
        "columns" "columns" rows(column()) = Column::all(sheet);
        "lacks" "what an estimate of slip needs and no column seems to hold" = lacks(sheet);
    }
}

fn text(sheet: &Sheet) -> String {
    let missing = lacks(sheet);
    let mut out = if missing.is_empty() {
        "slip can be estimated: time, wheels, turn and motion are there, by the names of the columns\n".to_owned()
    } else {
        format!(
            "for slip this log lacks, by the names of its columns: {}\n",
            missing.join("; ")
        )
    };
    let _ = write!(
        out,
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
    out + &seen.table(Column::all(sheet))
}
