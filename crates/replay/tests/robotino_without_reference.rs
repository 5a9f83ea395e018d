//! Robotino by currents and encoders alone, each run judged by what the others taught; and a change of ground.

use std::path::Path;

use grouser_files::{Document, columns};
use grouser_log::Log;
use grouser_replay::{
    Coverage, EffortUnit, Error, GroundChange, GroundSlips, KnownGrounds, Options,
    known_grounds_to_toml, learn_grounds, read_known_grounds, run as run_log,
    slips_by_known_grounds,
};
use grouser_slip::{Measurement, Reference};

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

fn learn(runs: &[(&Path, &str)]) -> (KnownGrounds, Vec<Coverage>) {
    let logs: Vec<(String, Log)> = runs
        .iter()
        .map(|(folder, name)| ((*name).to_owned(), log(folder, name, true)))
        .collect();
    let robot = example("robotino").robot;
    learn_grounds(&logs, &robot, &Options::default()).unwrap()
}

fn by_known(log: &Log, known: &KnownGrounds) -> GroundSlips {
    let robot = example("robotino").robot;
    slips_by_known_grounds(log, &robot, &Options::default(), known).unwrap()
}

/// Six runs on three grounds, then six more that drive from one ground onto another: each run by the others.
#[test]
fn currents_hold_the_cameras_slip() {
    let (Some(one), Some(two)) = (data("robotino"), data("robotino-two-surfaces")) else {
        return;
    };
    let mut runs: Vec<(&Path, &str)> = ROBOTINO.iter().map(|name| (one.as_path(), *name)).collect();
    for (max_half_width, min_coverage) in [(0.17, 0.95), (0.25, 0.9)] {
        let (known, coverages) = learn(&runs);
        for of in &coverages {
            println!("{}: {} of {} seconds", of.run, of.contained, of.seconds);
        }
        let (coverage, half_width) = (known.coverage.unwrap(), known.half_width.unwrap());
        println!("all: {coverage:.3}, median half-width {half_width:.3}");
        assert!(coverage >= min_coverage, "{coverage}");
        assert!(half_width <= max_half_width, "{half_width}");
        runs.extend(TWO_SURFACES.iter().map(|name| (two.as_path(), *name)));
    }
}

/// A log without a camera: what was learnt of five runs bounds the slip that the camera saw in the sixth.
#[test]
fn a_run_without_a_camera_is_bounded_by_a_file_of_known_grounds() {
    let Some(folder) = data("robotino") else {
        return;
    };
    for tried in ["table_surface_exp53", "gray_surface_exp01"] {
        let others: Vec<(&Path, &str)> = ROBOTINO
            .iter()
            .filter(|name| **name != tried)
            .map(|name| (folder.as_path(), *name))
            .collect();
        let (known, _) = learn(&others);
        assert_eq!(known.unit, EffortUnit::Ampere);
        let path =
            std::env::temp_dir().join(format!("grouser-{}-{tried}.toml", std::process::id()));
        std::fs::write(&path, known_grounds_to_toml(&known)).unwrap();
        let read = read_known_grounds(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read, known);
        let slips = by_known(&log(&folder, tried, false), &read);
        assert_eq!(slips.stretches.len(), 1, "{slips:?}");
        let found = slips.stretches[0];
        assert!(found.by_reference.is_none());
        let camera = by_known(&log(&folder, tried, true), &read).stretches[0];
        // The camera changes nothing but what stands beside the interval.
        assert_eq!((camera.stretch, camera.range), (found.stretch, found.range));
        let slip = camera.by_reference.unwrap();
        println!("{tried}: camera {slip:.3}, {:?}", found.range);
        assert!(found.range.low < slip && slip < found.range.high);
        assert!(found.range.known_share > 0.9);
        let nearest = &known.grounds[found.range.nearest].run;
        assert_eq!(nearest[..5], tried[..5]);
    }
}

/// Where every known ground draws far more, the ground is called unknown and the interval says little.
#[test]
fn an_unknown_ground_is_not_taken_for_a_known_one() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let soft = [
        "gray_surface_exp01",
        "gray_surface_exp26",
        "green_surface_exp01",
    ];
    let (known, _) = learn(&soft.map(|name| (folder.as_path(), name)));
    let slips = by_known(&log(&folder, "table_surface_exp01", false), &known);
    let range = slips.stretches[0].range;
    println!("{range:?}");
    assert!(range.known_share < 0.5);
    assert!(range.low < 0.12 && range.high - range.low > 0.5);
}

#[test]
fn grounds_that_do_not_fit_are_refused() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let runs = ROBOTINO.map(|name| (folder.as_path(), name));
    let (known, _) = learn(&runs[..4]);
    let (table, robot) = (log(&folder, ROBOTINO[0], false), example("robotino").robot);
    let by = |known: &KnownGrounds, options: &Options| {
        slips_by_known_grounds(&table, &robot, options, known).unwrap_err()
    };
    let other = KnownGrounds {
        robot: "another".into(),
        ..known.clone()
    };
    assert!(matches!(
        by(&other, &Options::default()),
        Error::OtherRobot { .. }
    ));
    let torques = KnownGrounds {
        unit: EffortUnit::NewtonMetre,
        ..known.clone()
    };
    assert!(matches!(
        by(&torques, &Options::default()),
        Error::MixedEfforts { .. }
    ));
    let chosen = Options {
        reference: Some(Reference::Speed),
        ..Options::default()
    };
    assert!(matches!(by(&known, &chosen), Error::NoReference { .. }));
    let few = [("run".to_owned(), log(&folder, ROBOTINO[0], true))];
    let few = learn_grounds(&few, &robot, &Options::default()).unwrap_err();
    assert!(matches!(few, Error::TooFewGrounds { known: 1 }));
    let blind = [("run".to_owned(), log(&folder, ROBOTINO[0], false))];
    let blind = learn_grounds(&blind, &robot, &Options::default()).unwrap_err();
    assert!(matches!(blind, Error::NoReference { .. }));
    let whole = known_grounds_to_toml(&known);
    let path = std::env::temp_dir().join(format!("grouser-{}-wrong.toml", std::process::id()));
    for (old, new, reason) in [
        ("effort_a", "effort_v", "no such key as `effort_v`"),
        ("slip = 0.", "slip = 1.", "must lie in"),
        ("ripple_hz = ", "ripple_hz = -", "must lie in"),
        ("coverage = ", "coverage = 1", "must lie in"),
    ] {
        let text = whole.replacen(old, new, 1);
        assert_ne!(text, whole, "{old}");
        std::fs::write(&path, text).unwrap();
        let error = read_known_grounds(&path).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    std::fs::remove_file(&path).unwrap();
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
