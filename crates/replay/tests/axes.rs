//! Sensors whose axes are described wrongly are named, and an acceleration along one axis is of use.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::io;

use grouser_doctor::Mistake;
use grouser_files::Document;
use grouser_files::robot::{self, RobotFile, WheelSensor};
use grouser_replay::{Doubt, Engine, Inputs, Options, Row, Sink, Status, Summary};
use grouser_slip::{Health, Measurement, Motion, Reference};
use grouser_synthetic::{Disturbance, KnownTruth, SlipProfile};

fn file(more: &str) -> RobotFile {
    let mut text = format!(
        "format = 1\nname = \"known truth\"\n[estimator]\nposition_sigma_m = 0.02\n{more}\n"
    );
    for wheel in KnownTruth::robot().unwrap().wheels() {
        let (name, x, y) = (&wheel.name, wheel.x, wheel.y);
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {x:?}\ny_m = {y:?}\nradius_m = 0.1\ndrive = \"powered\"\n\
             ticks_per_turn = 1000"
        )
        .unwrap();
    }
    robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
}

/// Sum of the squared errors of the slips after 10 s, and their number.
struct Errors<'a> {
    truth: &'a [[f64; 4]],
    sum: f64,
    count: f64,
}

impl Sink for Errors<'_> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a row's number"
        )]
        let step = (row.time_s * 100.0).round() as usize;
        if let Some(slip) = row.slip.filter(|_| row.time_s > 10.0) {
            self.sum += (slip - self.truth[step][row.wheel]).powi(2);
            self.count += 1.0;
        }
        Ok(())
    }
}

const DRIVE: KnownTruth = KnownTruth {
    rim_speed: 2.0,
    accelerations: false,
    disturbance: Disturbance::Clean,
    profile: SlipProfile::Waves,
    position_sigma: 0.02,
    duration_s: 60,
    seed: 7,
};

const INPUTS: Inputs = Inputs {
    wheel_sensor: WheelSensor::Count,
    reference: Reference::Pose,
    speed_place: [0.0; 2],
    position_sigma: None,
    is_acceleration_forward_only: false,
};

/// The drive with poses that are no numbers up to a time, s.
fn run_to(until_s: f64, smooth: bool, sink: &mut Trusted) -> Summary {
    let options = Options {
        offline: smooth,
        ..Options::default()
    };
    let mut engine = Engine::new(&file(""), INPUTS, &options).unwrap();
    let steps = DRIVE.steps();
    let start_ns = steps[0].samples[0].time_ns;
    for mut sample in steps.iter().flat_map(|step| step.samples.clone()) {
        let time_s = (sample.time_ns - start_ns) as f64 * 1e-9;
        if let Measurement::Pose { yaw, .. } = &mut sample.measurement
            && time_s < until_s
        {
            *yaw = f64::NAN;
        }
        engine.push(sample, sink).unwrap();
    }
    engine.finish(sink).unwrap()
}

/// A drive with its samples changed: the summary and the RMSE of the slips.
fn run(
    accelerations: bool,
    is_acceleration_forward_only: bool,
    more: &str,
    change: impl Fn(&mut Measurement),
) -> (Summary, f64) {
    let drive = KnownTruth {
        accelerations,
        ..DRIVE
    };
    let inputs = Inputs {
        is_acceleration_forward_only,
        ..INPUTS
    };
    let steps = drive.steps();
    let truth: Vec<[f64; 4]> = steps.iter().map(|step| step.wheel_slips).collect();
    let mut errors = Errors {
        truth: &truth,
        sum: 0.0,
        count: 0.0,
    };
    let mut engine = Engine::new(&file(more), inputs, &Options::default()).unwrap();
    for mut sample in steps.iter().flat_map(|step| step.samples.clone()) {
        change(&mut sample.measurement);
        engine.push(sample, &mut errors).unwrap();
    }
    let summary = engine.finish(&mut errors).unwrap();
    (summary, (errors.sum / errors.count).sqrt())
}

#[test]
fn right_axes_raise_no_doubt() {
    for accelerations in [true, false] {
        let (summary, rmse) = run(accelerations, false, "", |_| ());
        assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
        assert!(rmse < 0.1, "{rmse}");
    }
}

#[test]
fn an_imu_that_is_turned_round_is_named() {
    // The rims hardly change their speed here: the reference shows when the robot speeds up.
    let (summary, rmse) = run(true, false, "", |measurement| {
        if let Measurement::Acceleration { forward, left } = measurement {
            (*forward, *left) = (-*forward, -*left);
        }
    });
    println!("turned round: rmse {rmse:.4}");
    let is_turned = |doubt: &Doubt| matches!(doubt, Doubt::Description(Mistake::AccelerationTurned(angle)) if angle.abs() > 3.0);
    assert!(
        summary.doubts().iter().any(is_turned),
        "{:?}",
        summary.doubts()
    );
}

#[test]
fn a_pose_that_is_turned_round_is_named_and_corrected() {
    let turned = |measurement: &mut Measurement| {
        if let Measurement::Pose { yaw, .. } = measurement {
            *yaw += PI;
        }
    };
    let (summary, _) = run(false, false, "", turned);
    let is_turned = |doubt: &Doubt| matches!(doubt, Doubt::Description(Mistake::ReferenceTurned([angle, _])) if angle.abs() > 3.0);
    assert!(
        summary.doubts().iter().any(is_turned),
        "{:?}",
        summary.doubts()
    );
    let (summary, rmse) = run(false, false, "pose_yaw_offset_deg = 180.0", turned);
    assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
    let right = run(false, false, "", |_| ()).1;
    assert!((rmse - right).abs() < 1e-3, "{rmse} and {right}");
}

/// A camera 0.3 m ahead and 0.4 m to the right of the origin that looks 30° to the left.
#[test]
fn a_pose_of_a_sensor_that_is_mounted_elsewhere_is_corrected() {
    let mounted = |measurement: &mut Measurement| {
        if let Measurement::Pose { x, y, yaw } = measurement {
            let (sin, cos) = yaw.sin_cos();
            (*x, *y) = (*x + 0.3 * cos + 0.4 * sin, *y + 0.3 * sin - 0.4 * cos);
            *yaw += PI / 6.0;
        }
    };
    let keys = "reference_x_m = 0.3\nreference_y_m = -0.4\npose_yaw_offset_deg = 30.0";
    let (summary, rmse) = run(false, false, keys, mounted);
    assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
    let right = run(false, false, "", |_| ()).1;
    assert!((rmse - right).abs() < 1e-3, "{rmse} and {right}");
}

#[test]
fn an_acceleration_forwards_alone_is_of_use() {
    let without = run(false, false, "", |_| ()).1;
    let both = run(true, false, "", |_| ()).1;
    let forward = run(true, true, "", |measurement| {
        if let Measurement::Acceleration { left, .. } = measurement {
            *left = 0.0;
        }
    });
    println!(
        "rmse: without {without:.4}, both axes {both:.4}, forwards alone {:.4}",
        forward.1
    );
    assert!(forward.1 < 1.1 * both && forward.1 < 0.9 * without);
}

/// The rows of a drive whose poses are no numbers before a time, s: times with a slip, and those that are trusted while moving.
#[derive(Default)]
struct Trusted(Vec<f64>, Vec<f64>);

impl Sink for Trusted {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        assert_eq!(row.slip.is_some(), row.slip_sigma.is_some());
        self.0.extend(row.slip.map(|_| row.time_s));
        let is_moving = row.motion != Some(Motion::Standstill);
        self.1
            .extend((is_moving && row.health == Health::Ok).then_some(row.time_s));
        Ok(())
    }
}

/// Poses of which none is a number: no way and no slip, instead of the slip that was expected beforehand.
#[test]
fn a_reference_without_a_usable_reading_leaves_no_slip() {
    for (until_s, smooth) in [(f64::INFINITY, false), (f64::INFINITY, true), (20.0, false)] {
        let mut rows = Trusted::default();
        let summary = run_to(until_s, smooth, &mut rows);
        let [first, trusted] = [&rows.0, &rows.1].map(|times| times.first().copied());
        if until_s < 60.0 {
            assert!(
                first.is_some_and(|time| (20.0..21.0).contains(&time)),
                "{first:?}"
            );
            assert!(trusted.is_some_and(|time| time > 20.0), "{trusted:?}");
            continue;
        }
        assert_eq!((first, trusted), (None, None));
        assert!(summary.doubts().contains(&Doubt::ReferenceUnused));
        assert_eq!(summary.status, Status::NoSlip);
        assert_eq!(
            (summary.along.overall, summary.along.travel_reference),
            (None, None)
        );
        assert!((summary.wheels.iter()).all(|wheel| wheel.slip.median.is_none()));
        assert!(summary.odometry.is_none() && summary.rejected.total() > 0);
    }
}
