//! What holds of parts of a result, or of one wheel, and is no doubt about all of it.

use std::collections::BTreeMap;

use grouser_files::columns::Meaning;
use grouser_log::Log;
use grouser_replay::{Doubt, Summary};
use grouser_slip::{Health, Reference};

use super::object::Found;
use super::row_watch::WheelRows;

/// A wheel that is `Ok` for less of the time in which it moves is named.
const MIN_OK_SHARE: f64 = 0.5;
/// A wheel that contradicts the others for less time is not, s.
const MIN_INCONSISTENT_S: f64 = 2.0;
/// Means between readings are taken over this number of periods of the wheels: readings scatter.
const WINDOW_PERIODS: f64 = 1.2;

/// One line each.
pub(super) fn reservations(found: Found<'_>) -> Vec<String> {
    let (summary, rows) = (found.summary, found.rows);
    let mut out = summary.reservations();
    out.extend(inconsistent(summary, rows));
    // without a reference no wheel is `Ok`, and other lines say why
    let has_reference =
        summary.reference != Reference::Grip && !summary.doubts().contains(&Doubt::ReferenceUnused);
    if has_reference {
        out.extend(mostly_not_ok(summary, rows));
        out.extend(unused_columns(summary, found.log));
    }
    out.extend(seldom_read(summary, rows));
    out
}

/// Wheels that contradict the others for long.
pub(super) fn inconsistent(summary: &Summary, rows: &[WheelRows]) -> Vec<String> {
    let wheels = summary.wheels.iter().zip(rows);
    let found = wheels.filter_map(|(wheel, rows)| {
        let [from, to] = rows.inconsistent_s()?;
        (to - from >= MIN_INCONSISTENT_S).then(|| (wheel.name.clone(), [from, to]))
    });
    let found: Vec<_> = found.collect();
    let powered = summary.wheels.iter().filter(|wheel| !wheel.is_reference);
    let last_begin = found.iter().map(|(_, [from, _])| *from).fold(0.0, f64::max);
    let first_end = (found.iter().map(|(_, [_, to])| *to)).fold(f64::INFINITY, f64::min);
    if found.len() > 1 && found.len() == powered.count() && last_begin < first_end {
        return vec![format!(
            "every wheel is `Invalid(Inconsistent)` from {last_begin:.1} s to {first_end:.1} s: the robot moves while its wheels \
             stand or turn against it (is it carried or towed?); the total distance counts that"
        )];
    }
    let line = |(name, [from, to]): (String, [f64; 2])| {
        format!(
            "{name} is `Invalid(Inconsistent)` from {from:.1} s to {to:.1} s: its sensor stands, or turns against the others; \
             the total distance leaves it out"
        )
    };
    found.into_iter().map(line).collect()
}

/// Wheels that are not `Ok` for most of the time in which they move, by what they mostly are instead.
fn mostly_not_ok(summary: &Summary, rows: &[WheelRows]) -> Vec<String> {
    let mut found: BTreeMap<String, (Vec<&str>, f64)> = BTreeMap::new();
    let wheels = summary.wheels.iter().zip(rows);
    for (wheel, rows) in wheels.filter(|(wheel, _)| !wheel.is_reference) {
        let healths = || rows.healths_moving();
        let ok = healths().find(|(health, _)| *health == Health::Ok);
        let ok = ok.map_or(0.0, |(_, share)| share);
        let others = healths().filter(|(health, _)| *health != Health::Ok);
        let most = others.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((health, _)) = most.filter(|_| ok < MIN_OK_SHARE) {
            let (names, share) = found.entry(health.to_string()).or_default();
            names.push(&wheel.name);
            *share = share.max(ok);
        }
    }
    let line = |(health, (names, share)): (String, (Vec<&str>, f64))| {
        format!(
            "{}: `Ok` for at most {:.0} % of the time in which the wheel moves, else mostly `{health}`",
            names.join(", "),
            100.0 * share
        )
    };
    found.into_iter().map(line).collect()
}

/// References of tables that are not used; of topics their list says it.
fn unused_columns(summary: &Summary, log: &Log) -> Vec<String> {
    if log.topics().next().is_some() {
        return Vec::new();
    }
    let measured = Meaning::ALL
        .iter()
        .filter(|(_, meaning, _)| log.measures(*meaning));
    let unused = measured
        .filter_map(|(_, meaning, _)| meaning.reference())
        .filter(|reference| *reference != summary.reference);
    let line = |other: Reference| {
        format!(
            "`{}` is measured too, and not used beside `{}`: `--reference {}` uses it instead",
            other.name(),
            summary.reference.name(),
            other.name()
        )
    };
    unused.map(line).collect()
}

/// Wheels that are read more seldom than the filter follows them.
pub(super) fn seldom_read(summary: &Summary, rows: &[WheelRows]) -> Option<String> {
    let periods = rows.iter().filter_map(WheelRows::period_s);
    let period = periods.fold(0.0, f64::max);
    // means over windows bridge up to two of them
    let windows = if summary.fused.is_some() { 1.0 } else { 2.0 };
    (period > windows * summary.window_s).then(|| {
        format!(
            "wheels are read every {period:.2} s and `window_s` is {} s: `--method window --window-s {:.1}` takes means from \
             reading to reading, which are closer than the filter there",
            summary.window_s,
            (10.0 * WINDOW_PERIODS * period).ceil() / 10.0
        )
    })
}
