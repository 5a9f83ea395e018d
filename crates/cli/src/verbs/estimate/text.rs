//! What a person reads of `estimate`.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_doctor::TurnCheck;
use grouser_files::robot::RobotFile;
use grouser_replay::{EventAt, FusedSummary, Options, SoilReading, Spread, Summary, UNKNOWN};
use grouser_slip::{Motion, Reference};

use super::object::{self, Found, cause, event_name};
use super::reservations::reservations;
use grouser_report::{Fields, Table};

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
        "{}: slip of {}, wheels by {}, reference: {}, {}\n\n",
        robot.robot.name(),
        span(summary.duration_s, options),
        summary.wheel_sensor,
        summary.reference.name(),
        match &summary.fused {
            Some(fused) if fused.is_offline => "by the whole log".to_owned(),
            Some(_) => "online".to_owned(),
            None => format!("windows of {} s", summary.window_s),
        },
    );
    text.push_str(&observability(found));
    text.push_str(&wheels(summary));
    let along = &summary.along;
    if let Some((overall, travel_reference)) = along.overall.zip(along.travel_reference) {
        let _ = writeln!(
            text,
            "\ntotal distance: wheels {:.3} m, robot {:.3} m, slip {}",
            along.travel_wheels,
            travel_reference,
            slip(Some(overall)),
        );
    } else if along.travel_reference.is_none() && uses_reference(summary) {
        let _ = writeln!(
            text,
            "\ntotal distance: wheels {:.3} m; the positions alone do not show that of the robot",
            along.travel_wheels,
        );
    }
    if let Some(yaw) = &summary.yaw
        && let Some(median) = yaw.residual.median
    {
        let _ = writeln!(
            text,
            "turn by the wheels and turn as measured: {median:.4} rad apart in {} s (median)",
            yaw.window
        );
    }
    let exchanged = object::exchanged(summary);
    if !exchanged.is_empty() {
        let _ = writeln!(
            text,
            "wheels that show the other side's bends: {}",
            exchanged.join(", ")
        );
    } else if let Some(turns) = &summary.findings.turns {
        text.push_str(&apart(turns, summary));
    }
    for time_s in summary.ground_changes_s.iter().take(EVENTS) {
        let _ = writeln!(text, "another ground from {time_s:.1} s on, by the motors");
    }
    if let Some(odometry) = &summary.odometry {
        let [x, y, yaw] = odometry.pose;
        let _ = writeln!(
            text,
            "{}: {:.3} m driven, {:.3} m without compensation; ends at x {} m, y {} m, {}°",
            if summary.reference == Reference::Grip {
                "odometry by the wheel that grips best"
            } else {
                "odometry"
            },
            odometry.distance,
            odometry.distance_of_wheels,
            number(Some(x), 3),
            number(Some(y), 3),
            number(Some(yaw.to_degrees()), 1),
        );
    }
    if let Some(fused) = &summary.fused {
        text.push_str(&filter(fused, summary));
    }
    if let Some(offset) = summary.clock_offset_s {
        let _ = writeln!(text, "the gyro's clock runs {offset:.3} s ahead: aligned");
    }
    if let Some(soil) = soil {
        let _ = writeln!(text, "\non {soil}, at each wheel's median slip and load:");
        let table = Fields::new()
            .remark("wheel", |reading: &SoilReading| reading.wheel.as_str())
            .join(object::soil(), |reading| reading);
        text.push_str(&table.table(readings));
    }
    text
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
    let reference = summary.fused.as_ref().and_then(|fused| fused.reference);
    reference.is_some_and(|of| of.used > 0)
}

/// What the log can show, and why the result is doubtful.
fn observability(found: Found<'_>) -> String {
    let summary = found.summary;
    let doubts = summary.doubts();
    let doubts = doubts.iter().map(|doubt| format!("WARNING: {doubt}\n"));
    let reservations = reservations(found).into_iter();
    let doubts = doubts.chain(reservations.map(|line| format!("NOTE: {line}\n")));
    let delay = summary
        .reference_delay
        .filter(|delay| delay.is_clear && !delay.is_beyond_correction());
    let delay = delay.map_or_else(String::new, |delay| format!("{delay}\n"));
    if summary.reference == Reference::Grip {
        let differences = format!(
            "{}; differences only\n\n",
            object::not_observable(summary.reference)
        );
        return doubts.chain([differences]).collect();
    }
    let used = summary.fused.as_ref().and_then(|fused| fused.reference);
    let used = used.map_or_else(String::new, |of| {
        format!(
            "{} of {} readings of the reference used\n",
            of.used, of.readings
        )
    });
    let hidden = format!("{}\n\n", object::not_observable(summary.reference));
    doubts.chain([delay, used, hidden]).collect()
}

/// Whether wheels and gyro disagree, and the cause.
fn apart(turns: &TurnCheck, summary: &Summary) -> String {
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
        "wheels and gyro go apart: first at {alarm:.1} s, {since:.1} s after the robot first drove; {cause}\n",
    )
}

fn filter(fused: &FusedSummary, summary: &Summary) -> String {
    let mut text = format!(
        "samples rejected {}, missing {}\n",
        summary.rejected.total(),
        fused.dropped,
    );
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

/// When an event ended, s; `None` where no end is known.
fn end(begun: &EventAt, events: &[EventAt]) -> Option<f64> {
    let mut later = events.iter().filter(|at| at.time_s >= begun.time_s);
    let ends = |at: &&EventAt| !at.change.begins && at.change.event == begun.change.event;
    Some(later.find(ends)?.time_s)
}

/// A number with a true minus sign.
pub(super) fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |value| format!("{value:.digits$}").replace('-', "−"),
    )
}

fn wheels(summary: &Summary) -> String {
    let seen = |state: &str| {
        let mut states = summary.wheels.iter().flat_map(|wheel| &wheel.states);
        states.any(|(name, _)| *name == state)
    };
    let states: Vec<&str> = Motion::ALL
        .iter()
        .map(|motion| motion.name())
        .chain([UNKNOWN])
        .filter(|state| seen(state))
        .collect();
    let mut table = Table::new()
        .text("wheel")
        .number("median")
        .number("p5")
        .number("p95");
    let doubtful = summary
        .wheels
        .iter()
        .any(|wheel| wheel.window_slip.is_some());
    if doubtful {
        table = table.number("by windows");
    }
    for state in &states {
        table = table.number(state);
    }
    table = table.number("Ok");
    for wheel in &summary.wheels {
        let name = if wheel.is_reference {
            format!("{} (reference)", wheel.name)
        } else {
            wheel.name.clone()
        };
        let shares = states.iter().map(|state| {
            let share = wheel.states.iter().find(|(name, _)| name == state);
            share.map_or_else(String::new, |(_, share)| format!("{:.1} %", 100.0 * share))
        });
        let windows = wheel.window_slip.map(|of| slip(of.median));
        let ok = wheel.healths.get("Ok").copied().unwrap_or(0.0);
        table.row(
            std::iter::once(name)
                .chain(numbers(&wheel.slip))
                .chain(windows.filter(|_| doubtful))
                .chain(shares)
                .chain([format!("{:.1} %", 100.0 * ok)]),
        );
    }
    let along = std::iter::once("along the track".to_owned());
    table.row(along.chain(numbers(&summary.along.slip)));
    table.render()
}

fn numbers(spread: &Spread) -> [String; 3] {
    [spread.median, spread.p5, spread.p95].map(slip)
}

/// A slip to the third decimal.
fn slip(value: Option<f64>) -> String {
    number(value, 3)
}
