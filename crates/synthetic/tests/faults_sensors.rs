//! Faults of the other sensors (C1 to C12), put into the five-wheeled robot's run.

use grouser_slip::filter::{FilterSettings, SlipPrior};
use grouser_slip::{Degraded, Error, Health, Measurement, Sample};
use grouser_synthetic::{Event, Fault};

use crate::trial;
use crate::trial::{END_S, FREE, PHASES, Trial, honest, with_camera};

/// Runs with and without the fault; says and checks what it costs.
#[allow(
    clippy::needless_pass_by_value,
    reason = "each call makes its own trial"
)]
fn compare(what: &str, trial: Trial, fault: Fault, lasts: f64, most: f64) {
    let nominal = trial.run();
    for (phase, from) in PHASES {
        let out = trial.clone().fault(fault, from, from + lasts).run();
        let (lasted, ..) = out.silence();
        let after = from + lasts + 2.0;
        let back = if after < 18.0 {
            out.rms(after, 19.0) / nominal.rms(after, 19.0)
        } else {
            1.0
        };
        println!(
            "{what}, {phase}: rms {:.2} of nominal, {back:.2} after it; longest silence {lasted:.2} s; {} refused",
            out.rms(5.0, 23.0) / nominal.rms(5.0, 23.0),
            out.refused
        );
        honest(&out, what);
        assert!(
            back <= most,
            "{what}, {phase}: {back:.2} of nominal two seconds after"
        );
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "a list of every field")]
fn what_is_no_number_is_refused_counted_and_changes_no_bit() {
    let (_, samples) = with_camera(1).samples();
    let mut filter = with_camera(1).filter();
    for sample in &samples[..8000] {
        let _ = filter.update(*sample);
    }
    let time_ns = samples[8000].time_ns;
    let bad = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::from(f32::MAX),
        f64::MAX,
    ];
    for one in bad {
        for other in bad.into_iter().chain([0.0, -0.0, 5e-324]) {
            for measurement in [
                Measurement::WheelAngle {
                    wheel: 0,
                    angle: one,
                },
                Measurement::WheelRate {
                    wheel: 0,
                    rate: one,
                },
                Measurement::YawRate { rate: one },
                Measurement::Acceleration {
                    forward: one,
                    left: other,
                },
                Measurement::Acceleration {
                    forward: other,
                    left: one,
                },
                Measurement::WheelTorque {
                    wheel: 1,
                    torque: one,
                },
                Measurement::Displacement {
                    forward: one,
                    left: other,
                    turn: None,
                },
                Measurement::Displacement {
                    forward: other,
                    left: one,
                    turn: Some(other),
                },
                Measurement::Displacement {
                    forward: other,
                    left: other,
                    turn: Some(one),
                },
                Measurement::Pose {
                    x: one,
                    y: other,
                    yaw: other,
                },
                Measurement::Pose {
                    x: other,
                    y: one,
                    yaw: other,
                },
                Measurement::Pose {
                    x: other,
                    y: other,
                    yaw: one,
                },
                Measurement::Speed {
                    forward: one,
                    left: Some(other),
                },
                Measurement::Speed {
                    forward: other,
                    left: Some(one),
                },
            ] {
                let before = filter.clone();
                let mut after = filter.clone();
                // let it come through the horizon, beside a filter that never saw it
                let refused = after
                    .update(Sample {
                        time_ns,
                        measurement,
                    })
                    .is_err();
                let mut without = before;
                let mut faults = u64::from(refused);
                for sample in &samples[8000..8200] {
                    faults += u64::from(after.update(*sample).is_err());
                    let _ = without.update(*sample);
                }
                assert!(faults >= 1, "{measurement:?} was not refused");
                let (a, b) = (after.latest(), without.latest());
                // a displacement that is a number leaves a hole: what came since the last one is not known
                let hole = matches!(
                    measurement,
                    Measurement::Displacement { .. } | Measurement::Pose { .. }
                );
                if hole {
                    assert!((a.body.forward.value - b.body.forward.value).abs() < 0.002);
                    continue;
                }
                assert_eq!(
                    format!("{:?}", a.wheels),
                    format!("{:?}", b.wheels),
                    "{measurement:?}"
                );
                assert!(a.rejected.total() > b.rejected.total());
            }
        }
    }
}

#[test]
fn a_sigma_that_is_none_is_refused_by_name() {
    let trial = Trial::new(2);
    let robot = trial.robot.described(16).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1.797e308] {
        let settings = [
            FilterSettings {
                yaw_sigma: bad,
                ..FilterSettings::default()
            },
            FilterSettings {
                position_sigma: bad,
                ..FilterSettings::default()
            },
            FilterSettings {
                speed_sigma: bad,
                ..FilterSettings::default()
            },
            FilterSettings {
                slip: SlipPrior {
                    mean: 0.1,
                    sigma: bad,
                },
                ..FilterSettings::default()
            },
        ];
        for settings in settings {
            let refused = grouser_slip::filter::SlipFilter::new(&robot, settings);
            assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{bad}");
        }
    }
}

#[test]
fn a_stuck_imu_does_no_lasting_harm() {
    compare("IMU stuck", Trial::new(3), Fault::ImuStuck, 3.0, 1.3);
}

/// A gyro that goes on as it was on the straight would make the inner wheels slip and the outer ones skid.
#[test]
fn a_gyro_that_sticks_before_a_bend_is_not_followed() {
    for seed in 3..8 {
        let nominal = Trial::new(seed).run();
        // the bend is from 12 to 20 s
        let out = Trial::new(seed).fault(Fault::ImuStuck, 11.0, 19.0).run();
        honest(&out, "IMU stuck before a bend");
        let ratio = out.rms(14.0, 19.0) / nominal.rms(14.0, 19.0);
        let nees = out.nees(14.0, 19.0);
        println!("IMU stuck before a bend: rms {ratio:.2} of nominal, NEES {nees:.2}");
        assert!(
            ratio < 2.0 && nees < 2.0,
            "{seed}: {ratio:.2} of nominal, {nees:.2}"
        );
    }
}

#[test]
fn an_impact_that_saturates_the_accelerometer_does_little() {
    compare(
        "saturated 0.1 s",
        Trial::new(4),
        Fault::AccelerometerSaturated(156.9),
        0.1,
        1.3,
    );
    compare(
        "saturated 1 s",
        Trial::new(4),
        Fault::AccelerometerSaturated(156.9),
        1.0,
        1.3,
    );
}

/// Within 30 s of a step, a ramp or the warming of a sensor the errors are those of a run without it, and the sigmas are right
/// meanwhile.
#[test]
fn a_bias_that_changes_is_learnt_within_thirty_seconds() {
    let mut long = Trial::new(5);
    long.robot.legs[2].seconds = 50.0;
    let nominal = long.run();
    for (what, fault) in [
        ("accelerometer +.5 m/s²", Fault::AccelerometerBias(0.5)),
        ("accelerometer -.5 m/s²", Fault::AccelerometerBias(-0.5)),
        ("accelerometer .02 m/s³", Fault::AccelerometerDrifts(0.02)),
        ("gyro +.05 rad/s", Fault::GyroBias(0.05)),
        ("gyro -.05 rad/s", Fault::GyroBias(-0.05)),
    ] {
        for (phase, from) in PHASES {
            let out = long.clone().fault(fault, from, 90.0).run();
            honest(&out, what);
            let (early, late) = (from + 5.0, from + 30.0);
            let to = late + 15.0;
            let ratio = out.rms(late, to) / nominal.rms(late, to);
            println!(
                "{what}, {phase}: rms {:.2} of nominal before, {ratio:.2} after 30 s; longest silence {:.2} s",
                out.rms(early, late) / nominal.rms(early, late),
                out.silence().0
            );
            // in motion no sensor shows the gyro's bias: the sigmas have it until the robot stops
            let is_shown = !what.starts_with("gyro") || phase == "start";
            assert!(!is_shown || ratio <= 1.3, "{what}, {phase}: {ratio:.2}");
        }
    }
}

#[test]
fn an_imu_that_is_silent_or_noise_does_no_lasting_harm() {
    compare("IMU silent", Trial::new(6), Fault::ImuSilent, 3.0, 1.3);
    compare("IMU noise", Trial::new(6), Fault::ImuGarbage(2.0), 3.0, 1.3);
    compare("IMU zero", Trial::new(6), Fault::ImuValue(0.0), 3.0, 1.3);
}

#[test]
fn a_camera_that_fails_is_left() {
    let lasts = 3.0;
    compare("camera lost", with_camera(7), Fault::CameraLost, lasts, 1.3);
    compare(
        "camera jumps 2 m",
        with_camera(7),
        Fault::CameraJumps(2.0),
        lasts,
        1.3,
    );
    compare(
        "camera frozen",
        with_camera(7),
        Fault::CameraFrozen,
        lasts,
        1.3,
    );
    compare(
        "camera half",
        with_camera(7),
        Fault::CameraScale(0.5),
        lasts,
        1.3,
    );
    compare(
        "camera twice",
        with_camera(7),
        Fault::CameraScale(2.0),
        lasts,
        1.3,
    );
    compare(
        "camera NaN",
        with_camera(7),
        Fault::CameraValue(f64::NAN),
        lasts,
        1.3,
    );
    // Without the free wheel the camera is the only reference. A wrong scale is then the slip's (docs/online.md).
    let mut alone = with_camera(7);
    alone.faults.push((Fault::WheelSilent(FREE), (0.0, END_S)));
    for (what, fault) in [
        ("camera alone lost", Fault::CameraLost),
        ("camera alone jumps", Fault::CameraJumps(2.0)),
        // it scatters while the robot waits to start: then it never repeats itself
        ("camera alone frozen", Fault::CameraFrozen),
    ] {
        for (phase, from) in PHASES {
            let out = alone.clone().fault(fault, from, from + lasts).run();
            let (lasted, ..) = out.silence();
            println!("{what}, {phase}: longest silence {lasted:.2} s");
            assert!(lasted <= 1.5, "{what}, {phase}: {lasted:.2} s");
        }
    }
}

#[test]
fn wrong_units_and_signs_never_pass_silently() {
    for (what, scale) in [
        ("degrees for radians", 57.3),
        ("sign", -1.0),
        ("revolutions", 9.55),
    ] {
        let out = Trial::new(8)
            .fault(Fault::GyroScale(scale), 0.0, END_S)
            .run();
        let (lasted, ..) = out.silence();
        println!(
            "gyro {what}: rms {:.3}, longest silence {lasted:.2} s, {} refused",
            out.rms(5.0, 23.0),
            out.refused
        );
        honest(&out, what);
        // in the bend, which begins at 12 s
        let suspect = |health| health == Health::Degraded(Degraded::Suspect);
        let delay = out.delay(0, (12.0, 17.0), suspect);
        println!("gyro {what}: found after {delay:.2?} s of the bend");
        assert!(delay.is_some_and(|delay| delay <= 1.5), "{what}: {delay:?}");
    }
    for (what, scale) in [
        ("millimetres for metres", 1000.0),
        ("metres for millimetres", 0.001),
    ] {
        let mut trial = with_camera(8);
        trial.faults.push((Fault::CameraScale(scale), (0.0, END_S)));
        let out = trial.run();
        let (lasted, ..) = out.silence();
        println!(
            "camera {what}: rms {:.3}, longest silence {lasted:.2} s, {} refused",
            out.rms(5.0, 23.0),
            out.refused
        );
        honest(&out, what);
    }
}

#[test]
fn bad_torques_do_not_move_the_slips() {
    for fault in [
        Fault::TorqueOffset(3.0),
        Fault::TorqueZero,
        Fault::TorqueNoise(3.0),
    ] {
        compare("torque", Trial::new(10), fault, 5.0, 1.1);
    }
}

#[test]
fn when_all_is_silent_the_estimate_ends() {
    for (phase, from) in PHASES {
        let trial = Trial::new(11).fault(Fault::AllSilent, from, END_S + 60.0);
        let (_, samples) = trial.samples();
        let mut filter = trial.filter();
        for sample in &samples {
            let _ = filter.update(*sample);
        }
        let last = samples.last().unwrap().time_ns;
        let known = filter.estimate_at(last + 1_000_000_000);
        for wheel in known.wheels {
            let ended = matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised);
            assert!(ended && wheel.slip.is_none(), "{phase}: {}", wheel.health);
        }
    }
}

#[test]
fn a_start_in_motion_or_on_a_slope_is_right_or_says_that_it_is_not() {
    // in motion: nothing is heard before
    let moving = Trial::new(12).fault(Fault::AllSilent, 0.0, 6.0).run();
    honest(&moving, "moving");
    println!(
        "start in motion: rms {:.3} from 0.5 s on",
        moving.rms(6.5, 10.0)
    );
    assert!(moving.rms(6.5, 10.0) < 0.04);
    // a slope of 11 degrees, and upside down
    for tilt in [2.0, -2.0] {
        let mut slope = Trial::new(12);
        slope.sensors.acceleration_bias = (tilt, 0.5);
        let out = slope.run();
        honest(&out, "slope");
        println!("slope: rms {:.3}", out.rms(5.0, 20.0));
        assert!(out.rms(5.0, 20.0) < 0.04);
    }
}

#[test]
fn a_free_wheel_that_fails_is_found() {
    for (what, event) in [
        ("locked", Event::FreeWheelLocked),
        ("half", Event::FreeWheelSkids { share: 0.5 }),
        ("0.8", Event::FreeWheelSkids { share: 0.8 }),
        ("twice", Event::FreeWheelSkids { share: 2.0 }),
    ] {
        for (phase, from) in [("converge", 3.0), ("steady", 8.0), ("steady", 14.5)] {
            let out = Trial::new(14).event(event, from, from + 3.0).run();
            let (lasted, at, wheel) = out.silence();
            let delay = out.delay(FREE, (from, from + 3.0), |h| {
                matches!(h, Health::Invalid(_))
            });
            println!(
                "free wheel {what}, {phase}: found after {delay:.2?} s; wheel {wheel} silent for {lasted:.2} s until {at:.2}"
            );
            if what == "locked" {
                assert!(lasted <= 1.0, "{phase} from {from} s");
                assert!(
                    delay.is_some_and(|delay| delay <= 0.45),
                    "{phase}: {delay:?}"
                );
            }
        }
    }
    // a great change of speed is one that no deceleration explains; what remains is in faults_shared.rs
    for (share, from) in [(0.5, 8.0), (0.5, 14.5), (2.0, 8.0), (2.0, 14.5)] {
        let event = Event::FreeWheelSkids { share };
        for seed in 0..10 {
            let out = Trial::new(seed).event(event, from, from + 3.0).run();
            honest(&out, &format!("{event:?} from {from} s, seed {seed}"));
        }
    }
    // one that is locked from the start: either the robot is stuck or the wheel
    let out = Trial::new(14).event(Event::FreeWheelLocked, 0.0, 8.0).run();
    let suspect = Health::Degraded(Degraded::Suspect);
    let known = |moment: &trial::Moment| moment.wheels[..FREE].iter().all(|w| w.health == suspect);
    assert!(out.between(3.5, 8.0).all(known));
}

/// A free wheel that crosses a rut slows and catches up within half a second: it remains the reference.
#[test]
fn a_free_wheel_that_crosses_a_rut_remains_the_reference() {
    for (share, from) in [(0.4, 8.0), (0.5, 14.5), (0.6, 8.0), (1.5, 14.5)] {
        let mut trusted = 0.0;
        for seed in 0..10 {
            let event = Event::FreeWheelSkids { share };
            let out = Trial::new(seed).event(event, from, from + 0.25).run();
            honest(&out, &format!("{event:?} from {from} s, seed {seed}"));
            let after: Vec<_> = out.between(from + 0.75, from + 3.75).collect();
            let known = |moment: &&&trial::Moment| moment.wheels[0].health == Health::Ok;
            let share = after.iter().filter(known).count() as f64 / after.len() as f64;
            trusted += share / 10.0;
        }
        println!("{share} from {from} s: trusted for {trusted:.2}");
        assert!(trusted >= 0.9, "{share} from {from} s: {trusted:.2}");
    }
}
