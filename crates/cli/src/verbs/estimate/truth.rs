//! `estimate --truth`: the slips compared with true ones.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_log::container::Container;
use grouser_replay::{Summary, Truth, TruthError};
use grouser_report::number::in_message;
use grouser_report::{Table, printable};

use super::Arguments;
use super::text::number;
use crate::error::{Error, Kind, Result};
use crate::session::Session;

/// A comparison of fewer slips of a wheel is doubtful, if there are twice as many: 0.4 s at 50 Hz.
const MIN_COMPARED: u64 = 20;
/// So is one that spans a smaller share of the time of the estimates.
const MIN_COMPARED_SPAN_SHARE: f64 = 0.05;
/// A wheel of which a smaller share of the slips has a truth is named.
const MIN_COMPARED_SHARE: f64 = 0.5;

/// The true slips to compare with: a file, else a topic of the log.
pub(super) fn source(
    arguments: &Arguments,
    log: &Log,
    robot: &RobotFile,
    session: &mut Session,
) -> Result<Option<Truth>> {
    let Some(source) = &arguments.truth else {
        return Ok(None);
    };
    if source.is_file() {
        session.used_file(source)?;
        return Truth::read(source, &robot.robot).map(Some).map_err(refused);
    }
    let topic = source.to_string_lossy();
    let recordings = log
        .files()
        .filter(|file| matches!(Container::kind(file), Ok(Some(_))));
    Ok(Some(Truth::read_topic(recordings, &topic, &robot.robot)?))
}

/// Rows of a table that are not in the order of time need another word than a log's clock.
fn refused(error: grouser_replay::Error) -> Error {
    let grouser_replay::Error::Log(grouser_log::Error::SetBack { at, by_s }) = error else {
        return error.into();
    };
    Error::new(
        Kind::Content,
        format!(
            "{at}: is {} s older than the row before it: rows of true slips must be in the order of time",
            in_message(by_s)
        ),
        Some("sort the table by time; true slips of several runs are one table each".into()),
    )
}

/// Why the comparison is doubtful; empty where it is not.
pub(super) fn doubts(errors: &[TruthError]) -> Vec<String> {
    let span = |span: Option<[f64; 2]>| {
        let [from, to] = span.unwrap_or_default();
        format!("{from:.1} s to {to:.1} s")
    };
    let compared = |of: &TruthError| of.compared_s.map_or(0.0, |[from, to]| to - from);
    let is_hardly = |of: &&TruthError| {
        let [from, to] = of.estimates_s.unwrap_or_default();
        let is_few = of.count < MIN_COMPARED && 2 * of.count < of.estimates;
        is_few || compared(of) < MIN_COMPARED_SPAN_SHARE * (to - from)
    };
    let line = |of: &TruthError| {
        format!(
            "{}: {} of {} estimated slips have a true slip at the same time: true slips are from {}, estimates from {} of the \
             log; is `time_s` counted in s from the log's start?",
            of.wheel,
            of.count,
            of.estimates,
            span(of.truth_s),
            span(of.estimates_s)
        )
    };
    let with_estimates = errors.iter().filter(|of| of.estimates > 0);
    with_estimates.filter(is_hardly).map(line).collect()
}

/// The errors against the truth.
pub(super) fn text(errors: &[TruthError], summary: &Summary) -> String {
    let mut text = String::from("\ncompared with the true slips:\n");
    let doubts = doubts(errors);
    for doubt in &doubts {
        let _ = writeln!(text, "WARNING: {doubt}");
    }
    for error in errors {
        let (count, all) = (error.count, error.estimates);
        let is_partial = (count as f64) < MIN_COMPARED_SHARE * all as f64;
        if doubts.is_empty() && is_partial {
            let _ = writeln!(
                text,
                "NOTE: {}: {count} of {all} estimated slips have a true slip at the same time",
                error.wheel
            );
        }
        if error.is_lag_beyond {
            let _ = writeln!(
                text,
                "NOTE: {}: the estimates fit best with a shift of more than 0.98 s: do log and true slips share a clock?",
                error.wheel
            );
        }
    }
    let without = |name: &String| !errors.iter().any(|error| error.wheel == *name);
    let powered = summary.wheels.iter().filter(|wheel| !wheel.is_reference);
    for name in powered
        .map(|wheel| &wheel.name)
        .filter(|name| without(name))
    {
        let _ = writeln!(text, "NOTE: there is no true slip of {}", printable(name));
    }
    let mut table = Table::new().text("wheel").number("compared");
    for column in ["RMSE", "bias", "NEES", "in 90 %", "lag s"] {
        table = table.number(column);
    }
    let compared = || errors.iter().filter(|error| error.count > 0);
    for error in compared() {
        let cells = [
            (error.rmse, 4),
            (error.bias, 4),
            (error.nees, 2),
            (error.coverage_90, 3),
            (error.lag_s, 2),
        ];
        let cells = cells.map(|(value, digits)| number(value, digits));
        let head = [error.wheel.clone(), error.count.to_string()];
        table.row(head.into_iter().chain(cells));
    }
    if compared().next().is_some() {
        text.push_str(&table.render());
    }
    text
}
