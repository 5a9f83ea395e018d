//! What a person reads of `estimate`.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::robot::RobotFile;
use grouser_replay::{FusedSummary, SoilReading, Spread, Summary, UNKNOWN};
use grouser_slip::Motion;

use crate::table::Table;

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
        match summary.fused {
            Some(_) => "by the filter".to_owned(),
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
    if let Some(fused) = &summary.fused {
        text.push_str(&filter(fused));
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
    if let Some(offset) = summary.clock_offset_s {
        let _ = writeln!(text, "the gyro's clock runs {offset:.3} s ahead: aligned");
    }
    if let Some(soil) = soil {
        let _ = writeln!(text, "\non {soil}, at each wheel's median slip and load:");
        text.push_str(&soils(readings));
    }
    text
}

/// How well the filter foresaw its readings.
fn filter(fused: &FusedSummary) -> String {
    let (Some(nis), Some(within)) = (fused.nis, fused.within_95) else {
        return String::new();
    };
    let mut text = format!(
        "filter: {} readings, squared residual over its variance {nis:.2} in the mean, {:.1} % within the expected 95 %\n",
        fused.readings,
        100.0 * within,
    );
    if let Some(alone) = fused.longest_alone_s {
        let _ = writeln!(text, "longest without a believed reference: {alone:.2} s");
    }
    text
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

/// A slip to the third decimal, with a true minus sign.
fn slip(value: Option<f64>) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |value| format!("{value:.3}").replace('-', "−"),
    )
}

fn soils(readings: &[SoilReading]) -> String {
    let mut table = Table::new()
        .text("wheel")
        .number("slip")
        .number("load N")
        .number("sinkage mm")
        .number("pull N")
        .number("torque N m")
        .number("efficiency")
        .number("best slip")
        .number("above best")
        .number("slip if the reference skids");
    let or_none = |value: Option<f64>, digits: usize| {
        value.map_or_else(
            || "–".to_owned(),
            |value| format!("{value:.digits$}").replace('-', "−"),
        )
    };
    for reading in readings {
        table.row([
            reading.wheel.clone(),
            slip(Some(reading.slip)),
            format!("{}", reading.load),
            or_none(reading.sinkage.map(|z| 1e3 * z), 1),
            or_none(reading.drawbar_pull, 2),
            or_none(reading.torque, 3),
            or_none(reading.efficiency, 3),
            slip(reading.best_slip),
            slip(reading.above_best),
            slip(reading.slip_with_skid),
        ]);
    }
    table.render()
}
