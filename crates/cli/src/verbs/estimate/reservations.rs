//! Reservations that concern a part of a result, or one wheel.

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
    if summary.reference == Reference::Grip {
        out.extend(differences(summary));
    }
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
             are stationary or turn backwards (carried or towed?); the total distance includes that"
        )];
    }
    let line = |(name, [from, to]): (String, [f64; 2])| {
        format!(
            "{name} is `Invalid(Inconsistent)` from {from:.1} s to {to:.1} s: its sensor is stuck, or contradicts the other wheels; \
             the total distance excludes it"
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
            "{}: `Ok` for at most {:.0} % of the time in motion, otherwise mostly `{health}`",
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
            "`{}` is measured too but not used (reference: `{}`); `--reference {}` selects it",
            other.name(),
            summary.reference.name(),
            other.name()
        )
    };
    unused.map(line).collect()
}

/// The wheels whose slips differ most, which is what a log without a measured speed shows.
fn differences(summary: &Summary) -> Option<String> {
    let slips = summary.wheels.iter();
    let slips = slips.filter_map(|wheel| Some((wheel.slip.median?, &wheel.name)));
    let by_slip = |a: &(f64, &String), b: &(f64, &String)| a.0.total_cmp(&b.0);
    let (high, low) = (slips.clone().max_by(by_slip)?, slips.min_by(by_slip)?);
    (high.1 != low.1).then(|| {
        format!(
            "slips differ by up to {:.3} (medians of {} and {})",
            high.0 - low.0,
            high.1,
            low.1
        )
    })
}
