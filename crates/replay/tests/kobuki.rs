//! Kobuki: the yaw of the encoders against the gyro's, clocks aligned.

use grouser_files::robot::WheelSensor;
use grouser_replay::{Options, Summary};
use grouser_slip::{Counter, CounterWidth, Measurement};

use crate::shipped::{data, example};

fn summary(run: &str, sensor: Option<WheelSensor>) -> Option<Summary> {
    let folder = data("kobuki")?;
    let options = Options {
        wheel_sensor: sensor,
        ..Options::default()
    };
    // A run is named by the beginning of its files' names.
    Some(example("kobuki").summary(folder.join(run), &options))
}

#[test]
fn a_slipping_wheel_stands_clearly_apart() {
    let (Some(good), Some(faulty)) = (summary("nonfaulty", None), summary("left_faulty", None))
    else {
        return;
    };
    let residual = |summary: &Summary| summary.yaw.unwrap().residual.median.unwrap();
    let (good, faulty) = (residual(&good), residual(&faulty));
    println!("median |encoder yaw - gyro yaw| in 0.5 s: {good:.5} and {faulty:.5} rad");
    // The page: .0012 and .0233, windows in which the robot moves (0.05 m/s and more). Its offset of the
    // clocks is "about 0.06 s": 0.02 s more or less change the second figure by a tenth; its windows overlap, these do not.
    assert!((good - 0.0012).abs() < 0.0004, "{good}");
    assert!((faulty - 0.0233).abs() < 0.0025, "{faulty}");
    assert!(faulty > 10.0 * good);
}

#[test]
fn the_clocks_differ_by_about_six_hundredths_of_a_second() {
    for run in ["nonfaulty", "left_faulty"] {
        let Some(summary) = summary(run, None) else {
            return;
        };
        let offset = summary.clock_offset_s.unwrap();
        println!("{run}: {offset:.3} s");
        // One gyro sample is 0.02 s.
        assert!((offset - 0.06).abs() <= 0.02, "{offset}");
    }
}

#[test]
fn sixteen_bit_counters_unwrap_to_the_joint_angles() {
    // The driver's own unwrapping is the oracle: the same travel by the raw counters of another file.
    let Some(folder) = data("kobuki") else { return };
    let kobuki = example("kobuki");
    let log = kobuki.log(folder.join("left_faulty"));
    let mut counter = Counter::new(CounterWidth::new(16).unwrap());
    let mut wraps = 0;
    let mut last_raw = None;
    let mut angle_span = (f64::INFINITY, f64::NEG_INFINITY);
    for record in log.samples(&[]).unwrap() {
        match record.unwrap().measurement {
            Measurement::WheelCount { wheel: 0, raw } => {
                wraps += u32::from(last_raw.is_some_and(|last: u64| last.abs_diff(raw) > 32_768));
                last_raw = Some(raw);
                counter.advance(raw);
            }
            Measurement::WheelAngle { wheel: 0, angle } => {
                angle_span = (angle_span.0.min(angle), angle_span.1.max(angle));
            }
            _ => {}
        }
    }
    assert!(wraps >= 3, "{wraps}");
    let turned = counter.total() as f64 / 2578.33 * std::f64::consts::TAU;
    let span = angle_span.1 - angle_span.0;
    // The two files begin and end within a row or two of each other, at standstill.
    assert!((turned - span).abs() < 1e-3 * span, "{turned} {span}");
}

#[test]
fn counts_and_angles_give_the_same_residual() {
    let (Some(angle), Some(count)) = (
        summary("left_faulty", Some(WheelSensor::Angle)),
        summary("left_faulty", Some(WheelSensor::Count)),
    ) else {
        return;
    };
    let residual = |summary: &Summary| summary.yaw.unwrap().residual.median.unwrap();
    // Stamped by another topic of the same driver.
    assert!((residual(&angle) - residual(&count)).abs() < 0.002);
}

#[test]
fn the_slipping_run_is_called_within_five_seconds_and_no_wheel_is_blamed_without_reason() {
    let (Some(good), Some(faulty)) = (summary("nonfaulty", None), summary("left_faulty", None))
    else {
        return;
    };
    let (good, faulty) = (good.findings.turns.unwrap(), faulty.findings.turns.unwrap());
    println!("nonfaulty: {good:?}");
    println!("left_faulty: {faulty:?}");
    assert_eq!(good.alarms, 0);
    let delay = faulty.alarm_s.unwrap() - faulty.first_motion_s.unwrap();
    assert!(delay < 5.0, "{delay}");
}
