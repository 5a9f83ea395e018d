//! What a person reads of `estimate`.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_doctor::{ReferenceDelay, TurnCheck};
use grouser_files::robot::RobotFile;
use grouser_replay::{EventAt, FusedSummary, Options, SoilReading, Spread, Summary, UNKNOWN};
use grouser_slip::{Motion, Reference};

use super::object::{self, Found, cause, event_name};
use super::reservations::reservations;
use grouser_report::number::{rounded, shown};
use grouser_report::{Fields, Layout, Table};

/// At most this many events are printed; a file has all of them.
const EVENTS: usize = 10;

pub(super) fn text(
    robot: &RobotFile,
    found: Found<'_>,
    soil: Option<&str>,
    options: &Options,
) -> String {
    let (summary, readings) = (found.summary, found.readings);
    let mut text = format!(
        "{}: {}\n{}\n{}",
        robot.robot.name(),
        headline(summary),
        reserved(found),
        wheels(summary)
    );
    let _ = writeln!(
        text,
        "\n{} of log, wheels by {}, reference: {}, {}",
        span(summary.duration_s, options),
        summary.wheel_sensor,
        summary.reference.name(),
        if summary.fused.is_offline {
            "each slip by the whole log"
        } else {
            "each slip by the log before it (online)"
        },
    );
    let exchanged = object::exchanged(summary);
    if !exchanged.is_empty() {
        let _ = writeln!(
            text,
            "encoders of the two sides probably exchanged: {}",
            exchanged.join(", ")
        );
    }
    for time_s in summary.ground_changes_s.iter().take(EVENTS) {
        let _ = writeln!(text, "ground change at {time_s:.1} s (from motor current)");
    }
    if let Some(odometry) = &summary.odometry {
        let [x, y, yaw] = odometry.pose;
        let _ = writeln!(
            text,
            "{}: {} m driven, {} m without slip compensation; ends at x {} m, y {} m, yaw {:.1}°",
            if summary.reference == Reference::Grip {
                "odometry with the prior of the common slip"
            } else {
                "odometry"
            },
            shown(odometry.distance),
            shown(odometry.distance_of_wheels),
            shown(x),
            shown(y),
            yaw.to_degrees(),
        );
    }
    text.push_str(&filter(&summary.fused, summary));
    if let Some(soil) = soil {
        let _ = writeln!(text, "\non {soil}, at each wheel's median slip and load:");
        let table = Fields::new()
            .remark("wheel", |reading: &SoilReading| reading.wheel.as_str())
            .join(object::soil(), |reading| reading);
        text.push_str(&table.table(readings));
    }
    text
}

/// Slip over the total distance, or why there is none.
fn headline(summary: &Summary) -> String {
    let along = &summary.along;
    let metres = |distance: f64| rounded(distance, 4);
    let wheels = metres(along.travel_wheels);
    match along.overall.zip(along.travel_reference) {
        _ if summary.reference == Reference::Grip => {
            "slip differences only, no slip over the total distance".to_owned()
        }
        Some((overall, robot)) => format!(
            "slip {}{}{} over the total distance\nshare of distance lost: wheels {wheels} m, robot {} m{}",
            slip(Some(overall)),
            interval(along.overall_90, |slip| number(Some(slip), 3)),
            if summary.doubts().is_empty() {
                ""
            } else {
                ", uncertain,"
            },
            metres(robot),
            interval(along.travel_reference_90, metres)
        ),
        None if along.travel_reference.is_none() && uses_reference(summary) => {
            format!("wheels {wheels} m; the positions alone do not show the distance of the robot")
        }
        None => format!("wheels {wheels} m, no slip over the total distance"),
    }
}

/// How much of a log was estimated.
fn span(duration_s: f64, options: &Options) -> String {
    let from_s = options.from_s.unwrap_or(0.0).max(0.0);
    let to_s = options.to_s.unwrap_or(duration_s).min(duration_s);
    if (from_s, to_s) == (0.0, duration_s) {
        format!("{duration_s:.1} s")
    } else {
        format!("{:.1} s of {duration_s:.1} s", (to_s - from_s).max(0.0))
    }
}

/// Did a reading of the reference change the filter's state?
fn uses_reference(summary: &Summary) -> bool {
    summary.fused.reference.is_some_and(|of| of.used > 0)
}

/// Why the result is uncertain, and what the log does not show.
fn reserved(found: Found<'_>) -> String {
    let doubts = found.summary.doubts();
    let doubts = doubts.iter().map(|doubt| format!("WARNING: {doubt}\n"));
    let reservations = reservations(found).into_iter();
    let lines = doubts.chain(reservations.map(|line| format!("NOTE: {line}\n")));
    let is_corrected = |delay: &ReferenceDelay| delay.is_clear && !delay.is_beyond_correction();
    let delay = found.summary.reference_delay.filter(is_corrected);
    let delay = delay.map(|delay| format!("{delay}\n"));
    let hidden = format!("{}\n", object::not_observable(found.summary.reference));
    let turns = found.summary.findings.turns.as_ref();
    let turns = turns.filter(|_| object::exchanged(found.summary).is_empty());
    let turns = turns.map(|turns| disagreement(turns, found.summary));
    lines.chain(turns).chain(delay).chain([hidden]).collect()
}

/// Whether wheels and gyro disagree, and the cause.
fn disagreement(turns: &TurnCheck, summary: &Summary) -> String {
    let Some(alarm) = turns.alarm_s else {
        return String::new();
    };
    let since = alarm - turns.first_motion_s.unwrap_or(alarm);
    let cause = if turns.alarms_beyond_geometry > 0 {
        format!("which wheel slips: {}", cause(turns, summary))
    } else {
        let [track, radii] = turns.geometry.map(|error| 100.0 * error.value);
        format!(
            "slip, or an error of the description (track {track:+.1} %, right radii {radii:+.1} %): not observable by these two"
        )
    };
    format!(
        "wheels and gyro disagree: first at {alarm:.1} s, {since:.1} s after the robot first drove; {cause}\n",
    )
}

fn filter(fused: &FusedSummary, summary: &Summary) -> String {
    let mut text = String::new();
    if Layout::current().details {
        text = checks(fused, summary);
    }
    let begun = fused.events.iter().filter(|at| at.change.begins);
    for at in begun.clone().take(EVENTS) {
        let (name, wheel) = event_name(at.change.event);
        let wheel = wheel.and_then(|wheel| summary.wheels.get(wheel));
        let of = wheel.map_or_else(String::new, |wheel| format!(" of {}", wheel.name));
        let end =
            end(at, &fused.events).map_or_else(String::new, |end_s| format!(" to {end_s:.1} s"));
        let _ = writeln!(text, "{name}{of} from {:.1} s{end}", at.time_s);
    }
    let more = begun.count().saturating_sub(EVENTS);
    if more > 0 {
        let _ = writeln!(text, "and {more} events more (`--json` lists them)");
    }
    text
}

/// How far readings were used, and how well they agree.
fn checks(fused: &FusedSummary, summary: &Summary) -> String {
    let mut text = format!(
        "samples rejected {}, missing {}\n",
        summary.rejected.total(),
        fused.dropped,
    );
    if let Some(of) = fused.reference {
        let _ = writeln!(
            text,
            "{} of {} readings of the reference used",
            of.used, of.readings
        );
    }
    if let Some(yaw) = &summary.yaw
        && let Some(median) = yaw.residual.median
    {
        let _ = writeln!(
            text,
            "turn by the wheels and turn as measured differ by {} rad in {} s (median)",
            shown(median),
            yaw.window
        );
    }
    if let Some(offset) = summary.clock_offset_s {
        let _ = writeln!(text, "the gyro's clock runs {offset:.3} s ahead: aligned");
    }
    text
}

/// When an event ended, s; `None` where no end is known.
fn end(begun: &EventAt, events: &[EventAt]) -> Option<f64> {
    let mut later = events.iter().filter(|at| at.time_s >= begun.time_s);
    let ends = |at: &&EventAt| !at.change.begins && at.change.event == begun.change.event;
    Some(later.find(ends)?.time_s)
}

/// A number with these decimals, or a dash.
pub(super) fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

fn wheels(summary: &Summary) -> String {
    let percent = |share: f64| format!("{:.1}", 100.0 * share);
    let names = Motion::ALL.iter().map(|motion| motion.name());
    let states: Vec<&str> = names
        .chain([UNKNOWN])
        .filter(|_| Layout::current().details)
        .collect();
    let mut table = Table::new().text("wheel").number("median slip");
    for header in ["5 %", "95 %", "Ok %"] {
        table = table.number(header);
    }
    for state in &states {
        table = table.number(&format!("{state} %"));
    }
    for wheel in &summary.wheels {
        let name = if wheel.is_reference {
            format!("{} (reference)", wheel.name)
        } else {
            wheel.name.clone()
        };
        let shares = states.iter().map(|state| {
            let share = wheel.states.iter().find(|(name, _)| name == state);
            percent(share.map_or(0.0, |(_, share)| *share))
        });
        let ok = percent(wheel.healths.get("Ok").copied().unwrap_or(0.0));
        let cells = std::iter::once(name).chain(numbers(&wheel.slip));
        table.row(cells.chain([ok]).chain(shares));
    }
    let along = std::iter::once("along the track".to_owned());
    table.row(along.chain(numbers(&summary.along.slip)));
    table.render()
}

fn numbers(spread: &Spread) -> [String; 3] {
    [spread.median, spread.p5, spread.p95].map(slip)
}

/// A slip to the third decimal.
/// A 90 % interval in brackets.
fn interval(of: Option<[f64; 2]>, shown: impl Fn(f64) -> String) -> String {
    of.map_or_else(String::new, |[low, high]| {
        format!(" (90 %: {} to {})", shown(low), shown(high))
    })
}

fn slip(value: Option<f64>) -> String {
    number(value, 3)
}
