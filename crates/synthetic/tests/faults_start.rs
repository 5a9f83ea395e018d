//! What is wrong from the start (C8, C9, C12): units, signs, axes, which way is up. Each is refused with the name of its field,
//! and a robot that is as described never is.

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::start::{Progress, StartCheck, check_gravity};
use grouser_slip::{Fault as Refusal, Measurement, Robot, Sample};
use grouser_synthetic::{Event, Fault};
use grouser_terra::Angle;

use crate::trial;
use crate::trial::{END_S, FREE, Trial, with_camera};

/// What the check says in the end, when it said so first (s), and whether it was through with everything.
fn check(
    trial: &Trial,
    alter: impl Fn(Measurement) -> Measurement,
) -> (Option<Refusal>, f64, bool) {
    let (_, samples) = trial.samples();
    let mut filter = trial.filter();
    let mut check = StartCheck::new(&trial.robot.described(16).unwrap()).unwrap();
    let (mut found, mut at, mut through) = (None, 0.0, false);
    for sample in &samples {
        let sample = Sample {
            measurement: alter(sample.measurement),
            ..*sample
        };
        let _ = filter.update(sample);
        match check.take(&sample, &filter.latest()) {
            Err(refusal) => {
                if found.is_none() {
                    (found, at) = (Some(refusal), sample.time_ns as f64 * 1e-9);
                }
                assert_eq!(found, Some(refusal), "it stays with what it said");
            }
            Ok(progress) => through = progress == Progress::Plausible,
        }
    }
    (found, at, through)
}

type Turned = fn(f64, f64) -> (f64, f64);

fn named(what: &str, found: (Option<Refusal>, f64, bool), name: &str, like: &str) {
    let (refusal, at, _) = found;
    let text = refusal.map_or_else(|| "nothing".into(), |refusal| refusal.to_string());
    println!("{what}: after {at:.1} s: {text}");
    assert!(text.starts_with(name), "{what}: {text}");
    assert!(text.contains(like), "{what}: {text}");
}

#[test]
fn a_robot_that_is_as_described_is_plausible() {
    for seed in 0..10 {
        let (found, _, through) = check(&with_camera(seed), |m| m);
        assert_eq!(found, None, "{seed}");
        assert!(through, "{seed}: something was never looked at");
    }
    // loose ground, a wheel in the air, a robot that digs itself in, a bad clock: none is a unit
    let mut loose = with_camera(11);
    loose.robot.drive_slip = (0.6, 0.8);
    let dug_in = with_camera(12).event(Event::Immobilised, 3.0, 20.0);
    let lifted = with_camera(13).event(Event::LiftOff { wheel: 1 }, 3.0, 20.0);
    let late = with_camera(14).fault(Fault::Shuffled(10_000_000), 0.0, END_S);
    for trial in [loose, dug_in, lifted, late] {
        let (found, at, _) = check(&trial, |m| m);
        assert_eq!(found, None, "{:?} {at:.1} s", trial.events);
    }
}

#[test]
fn a_wrong_unit_is_refused_by_the_name_of_its_field() {
    for (what, scale, like) in [
        ("gyro in degrees", 57.295_78, "degrees given as radians"),
        (
            "gyro in revolutions a minute",
            9.549_3,
            "revolutions a minute",
        ),
    ] {
        let trial = with_camera(1).fault(Fault::GyroScale(scale), 0.0, END_S);
        named(what, check(&trial, |m| m), "yaw rate", like);
    }
    for (what, scale, like) in [
        (
            "camera in millimetres",
            1000.0,
            "millimetres given as metres",
        ),
        ("camera in kilometres", 0.001, "metres given as millimetres"),
    ] {
        let trial = with_camera(2).fault(Fault::CameraScale(scale), 0.0, END_S);
        named(what, check(&trial, |m| m), "displacement forward", like);
    }
    named(
        "accelerometer in g",
        check(&with_camera(3), |m| match m {
            Measurement::Acceleration { forward, left } => Measurement::Acceleration {
                forward: forward / 9.806_65,
                left: left / 9.806_65,
            },
            other => other,
        }),
        "acceleration forward",
        "g given as m/s²",
    );
}

#[test]
fn wheel_rates_in_revolutions_a_minute_are_refused_and_a_radius_in_millimetres_too() {
    // the powered wheels' counters as rates, beside a free wheel and a camera, or beside a camera alone
    let trial = with_camera(4);
    let (course, samples) = trial.samples();
    let rate = f64::from(trial::RATE);
    let whole = trial.robot.described(16).unwrap();
    let powered = Robot::new("without".into(), whole.wheels()[..FREE].to_vec()).unwrap();
    for (what, robot, factor) in [
        ("rates in revolutions a minute", &whole, 9.549_3),
        ("the same without a free wheel", &powered, 9.549_3),
        ("right rates without a free wheel", &powered, 1.0),
    ] {
        let mut filter = SlipFilter::new(robot, FilterSettings::default()).unwrap();
        let mut check = StartCheck::new(robot).unwrap();
        let mut found = None;
        for sample in &samples {
            let row = usize::try_from(sample.time_ns / 10_000_000).unwrap();
            let measurement = match sample.measurement {
                Measurement::WheelCount { wheel, .. } if wheel < FREE => {
                    let rad_per_s = course.steps[row.saturating_sub(1)].rim[wheel] / 0.1;
                    let rate_noise = 0.01 * ((row * 7 + wheel) % 13) as f64 / rate;
                    Measurement::WheelRate {
                        wheel,
                        rate: factor * rad_per_s + rate_noise,
                    }
                }
                // beside an accelerometer that is the one named: its factor in g is nearly the same
                Measurement::WheelCount { .. } | Measurement::Acceleration { .. }
                    if robot.wheels().len() == FREE =>
                {
                    continue;
                }
                other => other,
            };
            let sample = Sample {
                measurement,
                ..*sample
            };
            let _ = filter.update(sample);
            found = check.take(&sample, &filter.latest()).err();
        }
        if factor == 1.0 {
            assert_eq!(found, None, "{what}");
        } else {
            let (name, like) = ("speed of a wheel", "revolutions a minute");
            named(what, (found, 0.0, false), name, like);
        }
    }
    let mut wheels = trial.robot.described(16).unwrap().wheels().to_vec();
    wheels[1].radius *= 1000.0;
    let refused = Robot::new("in millimetres".into(), wheels).unwrap_err();
    println!("{refused}");
    assert!(refused.to_string().contains("radius is 100"));
}

/// A lone camera's scale cannot be seen from the start: what it halves looks like soft ground. One that runs ahead of all wheels
/// is no reference at all for the filter.
#[test]
fn a_lone_camera_is_not_refused_for_what_soft_ground_would_show_as_well() {
    let mut trial = with_camera(5);
    trial.faults.push((Fault::WheelSilent(FREE), (0.0, END_S)));
    trial.faults.push((Fault::CameraScale(0.5), (0.0, END_S)));
    assert_eq!(check(&trial, |m| m).0, None);
}

#[test]
fn signs_and_exchanged_axes_are_refused_by_name() {
    let trial = with_camera(6).fault(Fault::GyroScale(-1.0), 0.0, END_S);
    named(
        "gyro, sign",
        check(&trial, |m| m),
        "yaw rate",
        "the other sign",
    );
    let trial = with_camera(6).fault(Fault::CameraScale(-1.0), 0.0, END_S);
    let found = check(&trial, |m| m);
    named(
        "camera, sign",
        found,
        "displacement forward",
        "the other sign",
    );
    let turned: [(&str, Turned, &str, &str); 2] = [
        (
            "accelerometer, sign",
            |f, l| (-f, -l),
            "acceleration forward",
            "the other sign",
        ),
        (
            "accelerometer, axes",
            |f, l| (l, f),
            "acceleration left",
            "exchanged",
        ),
    ];
    for (what, turn, name, like) in turned {
        let found = check(&with_camera(7), |m| match m {
            Measurement::Acceleration { forward, left } => {
                let (forward, left) = turn(forward, left);
                Measurement::Acceleration { forward, left }
            }
            other => other,
        });
        named(what, found, name, like);
    }
    let found = check(&with_camera(8), |m| match m {
        Measurement::Displacement {
            forward,
            left,
            turn,
        } => Measurement::Displacement {
            forward: left,
            left: forward,
            turn,
        },
        other => other,
    });
    named("camera, axes", found, "displacement left", "exchanged");
}

#[test]
fn gravity_tells_which_way_is_up() {
    let steepest = Angle::from_deg(40.0);
    // any axis along gravity but up, either way
    for (force, name) in [
        ([9.8, 0.2, 0.1], "acceleration forward"),
        ([-9.8, 0.2, 0.1], "acceleration forward"),
        ([0.1, 9.8, -0.3], "acceleration left"),
        ([0.1, -9.8, -0.3], "acceleration left"),
        ([0.1, 0.3, -9.8], "acceleration up"),
        ([0.0, 0.0, 1.0], "acceleration up"),
        ([0.0, 0.0, 9806.0], "acceleration up"),
        ([f64::NAN, 0.0, 9.8], "acceleration forward"),
    ] {
        let refused = check_gravity(force, steepest).unwrap_err();
        assert!(refused.to_string().starts_with(name), "{refused}");
    }
    // a start on a slope is one
    for deg in [0.0_f64, 10.0, 25.0, 39.0] {
        let (sin, cos) = deg.to_radians().sin_cos();
        let tilt = check_gravity([9.81 * sin, 0.0, 9.81 * cos], steepest).unwrap();
        assert!((tilt.deg() - deg).abs() < 1e-9);
    }
}

#[test]
fn a_robot_on_its_side_is_refused_and_one_on_a_slope_or_in_motion_is_not() {
    for (tilt, name) in [
        ((9.8, 0.0), "acceleration forward"),
        ((0.0, -9.8), "acceleration left"),
    ] {
        let mut trial = with_camera(9);
        trial.sensors.acceleration_bias = tilt;
        named(
            "on its side",
            check(&trial, |m| m),
            name,
            "gravity lies along",
        );
    }
    // 20° uphill, and nothing heard before 6 s
    let mut slope = with_camera(9);
    slope.sensors.acceleration_bias = (3.35, 0.5);
    let moving = with_camera(9).fault(Fault::AllSilent, 0.0, 6.0);
    for trial in [slope, moving] {
        assert_eq!(check(&trial, |m| m).0, None);
    }
}
