//! Changes of ground by currents and wheels of a Robotino.

use std::path::Path;

use grouser_files::{Document, columns};
use grouser_log::Log;
use grouser_replay::{GroundChange, Options, run as run_log};
use grouser_slip::Measurement;

use crate::shipped::{ROBOTINO, TWO_SURFACES, data, example, root};

/// The shipped columns, without the camera's if the reference is to be hidden.
fn log(folder: &Path, name: &str, has_camera: bool) -> Log {
    let mut text = std::fs::read_to_string(root().join("examples/robotino/columns.toml")).unwrap();
    if !has_camera {
        let kept = text.lines().filter(|line| !line.contains("displacement_"));
        text = kept.flat_map(|line| [line, "\n"]).collect();
    }
    let map = columns::parse(&Document::from_text("columns.toml", text).unwrap()).unwrap();
    Log::find(&[folder.join(format!("{name}.csv.gz"))], map).unwrap()
}

/// Time, currents and rim speeds of a run from 2 s on, by the samples of its log.
fn rows(folder: &Path, name: &str) -> Vec<(f64, [f64; 2])> {
    let mut out: Vec<(f64, [f64; 2])> = Vec::new();
    let (mut currents, mut rates) = ([0.0_f64; 3], [0.0_f64; 3]);
    let mut start_ns = None;
    for sample in log(folder, name, false).samples(&[]).unwrap() {
        let sample = sample.unwrap();
        let start = *start_ns.get_or_insert(sample.time_ns);
        match sample.measurement {
            Measurement::WheelRate { wheel, rate } => rates[wheel] = rate.abs(),
            Measurement::WheelTorque { wheel, torque } => currents[wheel] = torque.abs(),
            _ => {}
        }
        let time_s = (sample.time_ns - start) as f64 * 1e-9;
        if time_s < 2.0 {
            continue;
        }
        if out.last().is_none_or(|row| row.0 < time_s) {
            out.push((time_s, [0.0; 2]));
        }
        // 40 mm of radius and a gear of 16, three wheels
        let rim = rates.iter().sum::<f64>() * 0.04 / 16.0 / 3.0;
        out.last_mut().unwrap().1 = [currents.iter().sum::<f64>().ln(), rim.ln()];
    }
    out
}

#[test]
fn a_change_of_ground_is_called_within_two_seconds() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let parts = |first: usize, second: usize| {
        let (mut first, second) = (
            rows(&folder, ROBOTINO[first]),
            rows(&folder, ROBOTINO[second]),
        );
        let joint = first.last().unwrap().0 + 0.031;
        first.extend(second.iter().map(|row| (row.0 - 2.0 + joint, row.1)));
        (first, joint)
    };
    // Two soft grounds that draw the same current at the same speed are not told apart in the other order.
    for (what, (rows, joint)) in [
        ("gray, then green", parts(3, 5)),
        ("table, then gray", parts(0, 3)),
        ("green, then table", parts(5, 0)),
    ] {
        let mut change = GroundChange::new();
        let called: Vec<f64> = rows
            .iter()
            .filter(|row| change.take(row.0, &row.1))
            .map(|row| row.0 - joint)
            .collect();
        println!("{what}: called {called:?} s after the joint");
        assert!(
            called.first().is_some_and(|&t| t > 0.0 && t < 2.0),
            "{what}"
        );
    }
}

/// The verb's own way: torques or currents in the log, and one command. On one ground nothing is called; where a robot drives
/// from one surface onto another, four of the five runs that are long enough are called at least.
#[test]
fn a_change_of_ground_is_called_on_two_surfaces() {
    let (Some(one), Some(two)) = (data("robotino"), data("robotino-two-surfaces")) else {
        return;
    };
    let robot = example("robotino").robot;
    let called = |folder: &Path, name: &str| {
        let summary = run_log(
            &log(folder, name, true),
            &robot,
            &Options::default(),
            |_| Ok(()),
        );
        let summary = summary.unwrap();
        println!(
            "{name}: {:?} of {:.1} s",
            summary.ground_changes_s, summary.duration_s
        );
        summary.ground_changes_s
    };
    for name in ROBOTINO {
        assert!(called(&one, name).is_empty(), "{name}");
    }
    let runs = TWO_SURFACES.map(|name| called(&two, name));
    let found = runs.iter().filter(|called| !called.is_empty()).count();
    assert!(found >= 4, "{runs:?}");
    // Those whose slip changes by more than 0.1.
    assert!(
        runs[..3].iter().all(|called| !called.is_empty()),
        "{runs:?}"
    );
}
