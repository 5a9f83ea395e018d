//! What a person reads of `estimate`.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::robot::RobotFile;
use grouser_replay::{FusedSummary, SoilReading, Spread, Summary, TurnCheck, UNKNOWN};
use grouser_slip::Motion;

use super::object::{self, cause, event_name};
use grouser_report::{Fields, Table};

/// So many events are told; a file has them all.
const EVENTS: usize = 10;

pub(super) fn text(
    robot: &RobotFile,
    summary: &Summary,
    soil: Option<&str>,
    readings: &[SoilReading],
) -> String {
    let mut text = format!(
        "{}: slip of {:.1} s, wheels by {}, reference: {}, {}\n\n",
        robot.robot.name(),
        summary.duration_s,
        summary.wheel_sensor,
        summary.reference.name(),
        match &summary.fused {
            Some(fused) if fused.is_smoothed => "filtered both ways".to_owned(),
            Some(_) => "filtered".to_owned(),
            None => format!("windows of {} s", summary.window_s),
        },
    );
    text.push_str(&wheels(summary));
    let along = &summary.along;
    if let Some(overall) = along.overall {
        let _ = writeln!(
            text,
            "\nwhole way: the wheels ran {:.3} m, the robot went {:.3} m: slip {}",
            along.travel_wheels,
            along.travel_reference,
            slip(Some(overall)),
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
    if let Some(turns) = &summary.turns {
        text.push_str(&apart(turns, summary));
    }
    if let Some(odometry) = &summary.odometry {
        let [x, y, yaw] = odometry.pose;
        let _ = writeln!(
            text,
            "odometry: {:.3} m driven, {:.3} m without compensation; ends at x {} m, y {} m, {}°",
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

/// Whether wheels and gyro disagree, and the cause.
fn apart(turns: &TurnCheck, summary: &Summary) -> String {
    let Some(alarm) = turns.alarm_s else {
        return String::new();
    };
    let since = alarm - turns.first_motion_s.unwrap_or(alarm);
    format!(
        "wheels and gyro go apart: first at {alarm:.1} s, {since:.1} s after the robot first drove; which wheel slips: {}\n",
        cause(turns, summary),
    )
}

fn filter(fused: &FusedSummary, summary: &Summary) -> String {
    let shares: Vec<String> = fused
        .consistency
        .iter()
        .filter_map(|(kind, nis)| {
            let share = 100.0 * nis.in_band?;
            Some(format!("{} {share:.1} %", kind.replace('_', " ")))
        })
        .collect();
    let mut text = format!(
        "residuals within the filter's 95 %: {}; samples rejected {}, missing {}\n",
        shares.join(", "),
        summary.rejected.total(),
        fused.dropped,
    );
    let begun = fused.events.iter().filter(|at| at.change.begins);
    for at in begun.clone().take(EVENTS) {
        let (name, wheel) = event_name(at.change.event);
        let wheel = wheel.and_then(|wheel| summary.wheels.get(wheel));
        let of = wheel.map_or_else(String::new, |wheel| format!(" of {}", wheel.name));
        let _ = writeln!(text, "{name}{of} from {:.1} s", at.time_s);
    }
    let more = begun.count().saturating_sub(EVENTS);
    if more > 0 {
        let _ = writeln!(text, "and {more} events more (`--json` lists them)");
    }
    text
}

/// A number with a true minus sign.
fn number(value: Option<f64>, digits: usize) -> String {
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
    for state in &states {
        table = table.number(state);
    }
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
        table.row(
            std::iter::once(name)
                .chain(numbers(&wheel.slip))
                .chain(shares),
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
