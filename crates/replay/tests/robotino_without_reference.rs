//! Robotino by currents and encoders alone, each run judged by what the five others taught; and a change of ground.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking and may say what it measured"
)]

mod shipped;

use grouser_files::{Document, columns};
use grouser_log::Log;
use grouser_replay::{
    GroundChange, KnownGround, Options, Stretch, roller_ripple, run as run_log,
    slip_without_reference,
};
use grouser_slip::Measurement;
use shipped::{ROBOTINO, data, example, root};

/// The robot stands and starts before this, s.
const CUT: f64 = 2.0;

/// One row of a run.
#[derive(Clone, Copy, Default)]
struct Row {
    time: f64,
    current: [f64; 3],
    /// Of the motors, rad/s.
    rate: [f64; 3],
    /// Along the commanded way since the row before, m: by the camera, and by the wheels.
    passed: f64,
    rolled: f64,
}

struct Run {
    rows: Vec<Row>,
    stretch: Stretch,
    /// Of the whole way and of each second, by the camera.
    slip: f64,
    seconds: Vec<f64>,
}

/// The shipped columns, and what the motors draw (its sign is not in the data; their torque per ampere is not known).
fn log(name: &str) -> Option<Log> {
    let folder = data("robotino")?;
    let text = std::fs::read_to_string(root().join("examples/robotino/columns.toml")).unwrap();
    let currents = ["m1", "m2", "m3"].map(|wheel| {
        format!(
            "    {{ column = \"{wheel}cur\", meaning = \"wheel_torque\", wheel = \"{wheel}\", unit = \"N m\" }},\n"
        )
    });
    let currents = currents.concat();
    let text = text.replace("columns = [\n", &format!("columns = [\n{currents}"));
    let map = columns::parse(&Document::from_text("columns.toml", text).unwrap()).unwrap();
    Some(Log::find(&[folder.join(format!("{name}.csv.gz"))], map).unwrap())
}

fn run(name: &str) -> Option<Run> {
    let robot = example("robotino").robot.robot;
    let log = log(name)?;
    let mut rows: Vec<Row> = Vec::new();
    let mut heading: Option<f64> = None;
    let mut start_ns = None;
    for record in log.samples(&[]).unwrap() {
        let record = record.unwrap();
        let start = *start_ns.get_or_insert(record.time_ns);
        let time = (record.time_ns - start) as f64 * 1e-9;
        if rows.last().is_none_or(|row| row.time < time) {
            rows.push(Row {
                time,
                ..Row::default()
            });
        }
        let row = rows.last_mut().unwrap();
        match record.measurement {
            Measurement::WheelRate { wheel, rate } => row.rate[wheel] = rate,
            Measurement::WheelTorque { wheel, torque } => row.current[wheel] = torque,
            Measurement::Command { forward, left } => {
                heading.get_or_insert(left.atan2(forward));
            }
            Measurement::Displacement { forward, left, .. } => {
                let (sin, cos) = heading.unwrap_or(0.0).sin_cos();
                row.passed = cos * forward + sin * left;
            }
            _ => {}
        }
    }
    let heading = heading.unwrap();
    let wheels = robot.wheels();
    // three wheels 120 degrees apart: v = 2/3 Σ e u for the same slip of all
    let speed = |row: &Row| {
        let parts = wheels.iter().zip(row.rate).map(|(wheel, rate)| {
            wheel.travel_per_radian() * rate * (wheel.heading.rad() - heading).cos()
        });
        parts.sum::<f64>() * 2.0 / 3.0
    };
    for k in 1..rows.len() {
        rows[k].rolled = speed(&rows[k]) * (rows[k].time - rows[k - 1].time);
    }
    rows.retain(|row| row.time >= CUT);
    let across = |i: usize| (wheels[i].heading.rad() - heading).sin().abs();
    let crosswise = (0..3)
        .max_by(|&a, &b| across(a).total_cmp(&across(b)))
        .unwrap();
    let series: Vec<_> = rows
        .iter()
        .map(|r| (r.time, r.current[crosswise]))
        .collect();
    let count = rows.len() as f64;
    let slip = |part: &[Row]| {
        1.0 - part.iter().map(|r| r.passed).sum::<f64>()
            / part.iter().map(|r| r.rolled).sum::<f64>()
    };
    let mut seconds = Vec::new();
    let mut from = CUT;
    while from + 1.0 < rows.last().unwrap().time {
        let place = |time: f64| rows.partition_point(|row| row.time < time);
        seconds.push(slip(&rows[place(from)..place(from + 1.0)]));
        from += 1.0;
    }
    Some(Run {
        stretch: Stretch {
            current: rows
                .iter()
                .flat_map(|r| r.current)
                .map(f64::abs)
                .sum::<f64>()
                / count,
            speed: rows.iter().map(speed).sum::<f64>() / count,
            across: across(crosswise),
            ripple: roller_ripple(&series).unwrap(),
        },
        slip: slip(&rows),
        seconds,
        rows,
    })
}

impl Run {
    fn known(&self) -> KnownGround {
        let count = self.seconds.len() as f64;
        let mean = self.seconds.iter().sum::<f64>() / count;
        let square = self.seconds.iter().map(|s| (s - mean).powi(2)).sum::<f64>();
        KnownGround {
            stretch: self.stretch,
            slip: self.slip,
            scatter: (square / (count - 1.0)).sqrt(),
        }
    }
}

/// All of them; `None` without the data.
fn runs() -> Option<Vec<Run>> {
    ROBOTINO.iter().map(|name| run(name)).collect()
}

#[test]
fn currents_and_encoders_alone_hold_the_cameras_slip() {
    let Some(runs) = runs() else { return };
    let (mut held, mut all, mut widths) = (0, 0, Vec::new());
    for (index, tried) in runs.iter().enumerate() {
        let others = runs.iter().enumerate().filter(|(other, _)| *other != index);
        let known: Vec<KnownGround> = others.map(|(_, run)| run.known()).collect();
        let range = slip_without_reference(&tried.stretch, &known).unwrap();
        let seconds = &tried.seconds;
        let inside = |slip: &&f64| (range.low..=range.high).contains(*slip);
        let here = seconds.iter().filter(inside).count();
        println!(
            "{}: camera {:.3}; current {:.2} A, ripple {:.2} Hz at {:.4} m/s by the wheels: slip {:.2} [{:.2}, {:.2}], holds {here} of {} seconds",
            ROBOTINO[index],
            tried.slip,
            tried.stretch.current,
            tried.stretch.ripple,
            tried.stretch.speed,
            range.median,
            range.low,
            range.high,
            seconds.len()
        );
        held += here;
        all += seconds.len();
        widths.extend(std::iter::repeat_n(
            0.5 * (range.high - range.low),
            seconds.len(),
        ));
    }
    widths.sort_by(f64::total_cmp);
    let median = widths[widths.len() / 2];
    let share = f64::from(u32::try_from(held).unwrap()) / f64::from(u32::try_from(all).unwrap());
    println!("held {held} of {all} seconds, {share:.3}; median half-width {median:.3}");
    assert!(share >= 0.9, "{share}");
    assert!(median <= 0.25, "{median}");
}

/// Rows of one run after another, as one drive; gives when a change was called, s from the joint, and the greatest
/// statistic.
fn called(parts: &[&Run]) -> (Vec<f64>, f64) {
    let mut change = GroundChange::new();
    let mut out = Vec::new();
    let mut shift = 0.0;
    let mut joint = 0.0;
    for (index, part) in parts.iter().enumerate() {
        shift -= part.rows[0].time;
        if index == 1 {
            joint = part.rows[0].time + shift;
        }
        for row in &part.rows {
            let current: f64 = row.current.iter().map(|current| current.abs()).sum();
            // 40 mm of radius and a gear of 16, three wheels
            let rim = row.rate.iter().map(|rate| rate.abs()).sum::<f64>() * 0.04 / 16.0 / 3.0;
            if change.take(row.time + shift, &[current.ln(), rim.ln()]) {
                out.push(row.time + shift - joint);
            }
        }
        shift += part.rows.last().unwrap().time + 0.031;
    }
    (out, change.max_statistic())
}

#[test]
fn a_change_of_ground_is_called_within_two_seconds() {
    let Some(runs) = runs() else { return };
    for (name, run) in ROBOTINO.iter().zip(&runs) {
        let (called, greatest) = called(&[run]);
        println!("{name} alone: {called:?}, greatest statistic {greatest:.0}");
        assert!(called.is_empty(), "{name}");
    }
    let (table, gray, green) = (&runs[0], &runs[3], &runs[5]);
    for (what, parts, is_asked) in [
        ("gray, then green", [gray, green], true),
        ("green, then gray", [green, gray], false),
        ("table, then gray", [table, gray], true),
        ("green, then table", [green, table], true),
    ] {
        let (called, greatest) = called(&parts);
        println!("{what}: called {called:?} s after the joint, greatest statistic {greatest:.0}");
        if is_asked {
            assert!(
                called.first().is_some_and(|&t| t > 0.0 && t < 2.0),
                "{what}"
            );
        }
    }
}

/// The verb's own way: torques or currents in the log, and one command. On one ground nothing is called; where a robot drives
/// from one surface onto another, four of the five runs that are long enough are called at least.
#[test]
fn a_change_of_ground_is_called_on_two_surfaces() {
    let (Some(one), Some(two)) = (data("robotino"), data("robotino-two-surfaces")) else {
        return;
    };
    let text = std::fs::read_to_string(root().join("examples/robotino/columns.toml")).unwrap();
    let currents = ["m1", "m2", "m3"].map(|wheel| {
        format!(
            "    {{ column = \"{wheel}cur\", meaning = \"motor_current\", wheel = \"{wheel}\", unit = \"A\" }},\n"
        )
    });
    let text = text.replace(
        "columns = [\n",
        &format!("columns = [\n{}", currents.concat()),
    );
    let map = columns::parse(&Document::from_text("columns.toml", text).unwrap()).unwrap();
    let robot = example("robotino").robot;
    let called = |folder: &std::path::Path, name: &str| {
        let log = Log::find(&[folder.join(format!("{name}.csv.gz"))], map.clone()).unwrap();
        let summary = run_log(&log, &robot, &Options::default(), |_| Ok(())).unwrap();
        println!(
            "{name}: {:?} of {:.1} s",
            summary.ground_changes_s, summary.duration_s
        );
        summary.ground_changes_s
    };
    for name in ROBOTINO {
        assert!(called(&one, name).is_empty(), "{name}");
    }
    let names = [
        "green_table_exp00",
        "green_table_exp14",
        "green_table_exp27",
        "table_gray_exp02",
        "table_gray_exp17",
        "table_gray_exp25",
    ];
    let runs = names.map(|name| called(&two, name));
    let found = runs.iter().filter(|called| !called.is_empty()).count();
    assert!(found >= 4, "{runs:?}");
    // Those whose slip changes by more than 0.1.
    assert!(
        runs[..3].iter().all(|called| !called.is_empty()),
        "{runs:?}"
    );
}
