//! Faults of wheels and their encoders (A1 to A15), put into the five-wheeled robot's run in every phase.

use grouser_slip::detect::{DetectSettings, Detector, Event as Said};
use grouser_slip::{Degraded, Health, Invalid, Measurement, Motion};
use grouser_synthetic::{Event, Fault};

use crate::trial;
use crate::trial::{END_S, FREE, PHASES, Trial, honest};

const fn is_invalid(health: Health) -> bool {
    matches!(health, Health::Invalid(_))
}

#[test]
fn a_silent_encoder_is_held_then_invalid_and_costs_the_others_little() {
    let nominal = Trial::new(1).run();
    for (phase, from) in PHASES {
        for (gap, invalid) in [(0.05, false), (0.5, true), (60.0, true)] {
            let trial = Trial::new(1).fault(Fault::WheelSilent(1), from, from + gap);
            let out = trial.run();
            honest(&out, phase);
            let to = (from + gap).min(END_S);
            let delay = out.delay(1, (from, to), |health| {
                health == Health::Invalid(Invalid::Dropout)
            });
            assert_eq!(delay.is_some(), invalid, "{phase} {gap} s");
            if let Some(delay) = delay {
                // the estimate is of the horizon's beginning: it may say so earlier, never later
                assert!(delay <= 0.1 + 1e-9, "{phase} {gap} s: {delay}");
            }
            // the others
            for moment in out.between(from, END_S) {
                for wheel in [0, 2, 3] {
                    assert!(
                        !is_invalid(moment.wheels[wheel].health),
                        "{phase} {gap} s {:.2}",
                        moment.time
                    );
                }
            }
            // and back again within 2 s
            if to + 2.0 < 20.0 {
                assert!(
                    out.between(to + 2.0, 20.0)
                        .all(|m| !is_invalid(m.wheels[1].health))
                );
            }
            let ratio = out.speed_rms(5.0, 23.0) / nominal.speed_rms(5.0, 23.0);
            assert!(
                ratio <= 1.5,
                "{phase} {gap} s: the robot's speed is {ratio:.2} times as wrong"
            );
        }
    }
    // the free wheel and a powered one
    let out = Trial::new(1)
        .fault(Fault::WheelSilent(1), 9.0, END_S)
        .fault(Fault::WheelSilent(3), 9.0, END_S)
        .run();
    let ratio = out.speed_rms(5.0, 23.0) / nominal.speed_rms(5.0, 23.0);
    println!("two of five lost: speed {ratio:.2} times as wrong");
    assert!(ratio <= 2.0);
}

#[test]
fn a_stuck_encoder_is_found_and_is_no_skid() {
    for (phase, from) in [("converge", 3.0), ("steady", 9.0), ("stop", 20.5)] {
        let out = Trial::new(2)
            .fault(Fault::WheelStuck(1), from, from + 2.0)
            .run();
        honest(&out, phase);
        let delay = out.delay(1, (from, from + 2.0), is_invalid).unwrap();
        println!("stuck, {phase}: found after {delay:.2} s");
        assert!(delay <= 0.3);
        for moment in out.between(from, from + 2.0) {
            let wheel = &moment.wheels[1];
            let skid = wheel.slip.is_some_and(|slip| slip.value() < -0.9);
            assert!(
                !(skid && wheel.health == Health::Ok),
                "{phase} {:.2} s",
                moment.time
            );
        }
    }
    // one that is stuck from the start is found when the robot moves
    let out = Trial::new(2).fault(Fault::WheelStuck(1), 0.5, 6.0).run();
    assert!(out.delay(1, (2.6, 6.0), is_invalid).unwrap() <= 0.5);
}

#[test]
fn lost_pulses_bias_the_slip_by_no_more_than_their_share() {
    let nominal = Trial::new(3).run();
    let mean = |out: &trial::Outcome| {
        let errors: Vec<f64> = out
            .between(8.0, 19.0)
            .filter_map(|m| Some(m.error(1)?.0))
            .collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    for share in [0.01, 0.05, 0.2] {
        let out = Trial::new(3)
            .fault(Fault::PulsesLost(1, share), 6.0, END_S)
            .run();
        let bias = mean(&out) - mean(&nominal);
        println!("{share} of the pulses lost: bias {bias:.4}");
        assert!(bias.abs() <= share + 0.01);
    }
}

/// When pulses of wheel 1 are first said to be missed, s, and whether any other wheel's ever are.
fn missed(trial: &Trial, from: f64) -> (Option<f64>, bool) {
    let (mut first, mut others) = (None, false);
    trial.watch(|time, _, known| {
        for (wheel, check) in known.checks.iter().enumerate() {
            if check.misses_pulses && wheel == 1 {
                first.get_or_insert(time - from);
                let reported = known.wheels[1];
                let fine = reported.health == Health::Ok && reported.slip.is_some();
                assert!(!fine, "{time:.2} s: missed, and Ok");
            }
            others |= check.misses_pulses && wheel != 1;
        }
    });
    (first, others)
}

#[test]
fn a_twentieth_of_the_pulses_lost_is_said_within_five_seconds() {
    // at rest and while braking there are no pulses, or too few, to be lost
    for (phase, from) in [
        ("start", 2.5),
        ("converge", 4.0),
        ("steady", 9.0),
        ("bend", 13.0),
    ] {
        for share in [0.05, 0.2] {
            for seed in 3..6 {
                let trial = Trial::new(seed).fault(Fault::PulsesLost(1, share), from, END_S);
                let (first, others) = missed(&trial, from);
                println!("{share} lost, {phase}, seed {seed}: said after {first:.2?} s");
                assert!(first.is_some_and(|delay| (0.0..=5.0).contains(&delay)));
                assert!(!others, "{phase}: another wheel is blamed");
            }
        }
    }
    // and nothing is said of what is whole, on smooth ground and on rough
    for rim_noise in [0.0, 0.07] {
        let mut trial = Trial::new(3);
        trial.sensors.rim_noise = rim_noise;
        assert_eq!(missed(&trial, 0.0), (None, false), "{rim_noise}");
    }
}

#[test]
fn a_broken_slot_is_named_and_is_no_slip() {
    let mut trial = Trial::new(4);
    trial.robot.legs[2].seconds = 60.0;
    let broken = |trial: &Trial| {
        let (mut first, mut others) = (None, false);
        trial.watch(|time, _, known| {
            for (wheel, check) in known.checks.iter().enumerate() {
                if check.broken_slot && wheel == 1 {
                    first.get_or_insert(time);
                }
                others |= check.broken_slot && wheel != 1;
            }
        });
        (first, others)
    };
    assert_eq!(broken(&trial), (None, false));
    let with = trial.clone().fault(Fault::SlotBroken(1, 960), 4.0, 90.0);
    let (first, others) = broken(&with);
    println!(
        "broken slot: named after {:.1?} s",
        first.map(|at| at - 4.0)
    );
    // eight turns at .5 turns a second, and the scatter of whole ticks on top
    assert!(first.is_some_and(|at| at - 4.0 < 40.0) && !others);
    // one tick in 960 moves no slip
    let (with, without) = (with.run(), trial.run());
    honest(&with, "broken slot");
    for (a, b) in with.between(6.0, 60.0).zip(without.between(6.0, 60.0)) {
        if let (Some(a), Some(b)) = (a.wheels[1].slip, b.wheels[1].slip) {
            assert!((a.value() - b.value()).abs() < 0.05);
        }
    }
}

#[test]
fn swapped_tracks_are_found() {
    for (phase, from) in [("converge", 3.0), ("steady", 9.0), ("stop", 20.5)] {
        let out = Trial::new(5)
            .fault(Fault::Swapped(1), from, from + 2.0)
            .run();
        honest(&out, phase);
        let delay = out.delay(1, (from, from + 2.0), is_invalid).unwrap();
        println!("swapped, {phase}: found after {delay:.2} s");
        assert!(delay <= 1.0);
    }
}

#[test]
fn a_counter_that_goes_round_is_the_same_to_the_bit() {
    let reported = |bits: u32, ticks: f64, start: i64, back: bool| {
        let mut trial = Trial::new(6);
        trial.sensors.bits = bits;
        for wheel in &mut trial.robot.wheels {
            wheel.ticks = ticks;
            wheel.count_at_start = start;
        }
        if back {
            for leg in &mut trial.robot.legs {
                leg.speed = -leg.speed;
            }
        }
        let (course, samples) = trial.samples();
        let out = trial.follow(&course, &samples);
        assert_eq!(out.refused, 0);
        let last = out.moments[out.moments.len() / 2];
        format!("{:?} {:?}", last.wheels, last.known_speed)
    };
    for back in [false, true] {
        let whole = reported(64, 960.0, 0, back);
        for (bits, start) in [
            (8, 255),
            (8, 0),
            (16, 65_535),
            (16, 0),
            (32, 2_147_483_647),
            (32, 0),
            (32, 4_294_967_295),
        ] {
            assert_eq!(
                reported(bits, 960.0, start, back),
                whole,
                "{bits} bits from {start}"
            );
        }
        // twice round in one row: 0.3 m/s are 573 ticks a row
        assert_eq!(
            reported(8, 120_000.0, 255, back),
            reported(64, 120_000.0, 255, back)
        );
    }
}

#[test]
fn a_counter_that_begins_again_costs_one_sample() {
    for (phase, from) in PHASES {
        let mut trial = Trial::new(7).fault(Fault::CounterReset(1), from, END_S);
        trial.sensors.bits = 32;
        trial.robot.wheels[1].count_at_start = 1_000_000;
        let out = trial.run();
        honest(&out, phase);
        assert_eq!(out.refused, 1, "{phase}");
        let back = out
            .between(from + 0.5, 20.0)
            .all(|m| !is_invalid(m.wheels[1].health));
        assert!(back, "{phase}");
    }
}

#[test]
fn a_single_jump_is_refused_and_moves_nothing() {
    for (phase, from) in PHASES {
        for ticks in [1_000_000, -1_000_000] {
            let mut trial = Trial::new(8);
            trial.sensors.bits = 32;
            let without = trial.run();
            let out = trial
                .fault(Fault::CounterJumps(1, ticks), from, from + 1.0)
                .run();
            assert_eq!(out.refused, 1, "{phase}");
            for (a, b) in out.between(from, END_S).zip(without.between(from, END_S)) {
                if let (Some(slip), Some(other), Some(sigma)) =
                    (a.wheels[0].slip, b.wheels[0].slip, b.wheels[0].sigma)
                {
                    assert!(
                        (slip.value() - other.value()).abs() < 0.25 * sigma,
                        "{phase} {:.2}",
                        a.time
                    );
                }
            }
        }
    }
}

#[test]
fn a_crawling_wheel_is_called_slow_without_chatter() {
    let mut trial = Trial::new(9);
    for leg in &mut trial.robot.legs {
        leg.speed *= 0.005 / 0.3;
        leg.yaw_rate = 0.0;
    }
    let out = trial.run();
    let mut changes = 0;
    let mut last = None;
    for moment in out.between(6.0, 19.0) {
        let wheel = &moment.wheels[0];
        assert!(
            wheel.slip.is_none(),
            "{:.2} s: {:?}",
            moment.time,
            wheel.slip
        );
        let slow = matches!(wheel.health, Health::Degraded(Degraded::LowSpeed));
        let stands = wheel.motion == Some(Motion::Standstill);
        assert!(
            slow || stands,
            "{:.2} s: {} {:?}",
            moment.time,
            wheel.health,
            wheel.motion
        );
        changes += u32::from(last.is_some_and(|last| last != wheel.health));
        last = Some(wheel.health);
    }
    println!("crawling: {changes} changes of health in 13 s");
    assert!(changes <= 13);
}

#[test]
fn a_towed_robot_slips_backwards() {
    let mut trial = Trial::new(12);
    trial.robot.drive_slip = (-0.08, -0.2);
    let out = trial.run();
    honest(&out, "towed");
    for moment in out.between(5.0, 19.0) {
        for wheel in 0..FREE {
            let (error, sigma) = moment.error(wheel).unwrap();
            assert!(error.abs() < 0.15 + 4.0 * sigma, "{:.2} s", moment.time);
        }
    }
    println!(
        "towed: rms {:.4} nees {:.2}",
        out.rms(5.0, 20.0),
        out.nees(5.0, 20.0)
    );
    assert!(out.rms(5.0, 20.0) < 0.03);
}

#[test]
fn an_immobilised_robot_slips_wholly() {
    let mut trial = Trial::new(13);
    trial.robot.legs[2].seconds = 68.0;
    trial = trial.event(Event::Immobilised, 6.0, 66.0);
    let out = trial.run();
    honest(&out, "immobilised");
    for moment in out.between(7.0, 65.4) {
        for wheel in 0..FREE {
            let slip = moment.wheels[wheel].slip.unwrap().value();
            let near = (slip - 1.0).abs() <= 0.03;
            assert!(near && slip <= 1.0, "{:.2} s: {slip}", moment.time);
            assert_eq!(
                moment.wheels[wheel].health,
                Health::Ok,
                "{:.2} s",
                moment.time
            );
        }
    }
}

/// What the detector says in a run, with its times, s.
fn said(trial: &Trial) -> Vec<(f64, Said, bool)> {
    let settings = DetectSettings {
        stall_torque: 5.0,
        ..DetectSettings::default()
    };
    let robot = trial.robot.described(16).unwrap();
    let mut detector = Detector::new(&robot, settings).unwrap();
    let mut torques = [None; FREE + 1];
    let mut seen = Vec::new();
    let mut last = 0;
    trial.watch(|time, sample, known| {
        if let Measurement::WheelTorque { wheel, torque } = sample.measurement {
            torques[wheel] = Some(torque);
        }
        if core::mem::replace(&mut last, known.time_ns) != known.time_ns {
            let changes = detector.update(known.time_ns, known.wheels, &torques);
            seen.extend(changes.map(|change| (time, change.event, change.begins)));
            for wheel in 0..FREE {
                let on = detector.is_on(Said::LiftOff { wheel });
                assert!(!(on && detector.feels_the_ground(wheel)));
            }
        }
    });
    seen
}

#[test]
fn a_wheel_in_the_air_is_called_so_and_no_high_slip() {
    for (phase, from) in [("converge", 4.0), ("steady", 9.0), ("bend", 14.0)] {
        let trial = Trial::new(10).event(Event::LiftOff { wheel: 2 }, from, from + 2.0);
        let seen = said(&trial);
        honest(&trial.run(), phase);
        let lift = Said::LiftOff { wheel: 2 };
        let begun = seen.iter().find(|s| s.1 == lift && s.2).unwrap().0 - from;
        let ended = seen.iter().find(|s| s.1 == lift && !s.2).unwrap().0 - from - 2.0;
        println!("in the air, {phase}: called after {begun:.2} s, ended after {ended:.2} s");
        // it ends when the torque is half of the usual one again, for a tenth of a second
        assert!((0.0..=0.2).contains(&begun) && (0.0..=0.6).contains(&ended));
        let high = seen.iter().any(|s| s.1 == Said::HighSlip { wheel: 2 });
        assert!(!high, "{phase}: {seen:?}");
        // the others stay on the ground, also those that leave the patch
        assert!(seen.iter().all(|s| s.1 == lift), "{phase}: {seen:?}");
    }
}

#[test]
fn a_stalled_robot_is_called_so() {
    // from rest, and out of motion: the motors push with 8 N m and nothing turns
    for (phase, from, most) in [("start", 1.0, 0.08), ("steady", 9.0, 0.3)] {
        let trial = Trial::new(11).event(Event::Stall { torque: 8.0 }, from, from + 1.0);
        let seen = said(&trial);
        for wheel in 0..FREE {
            let stall = Said::Stall { wheel };
            let begun = seen.iter().find(|s| s.1 == stall && s.2).unwrap().0 - from;
            println!("stall, {phase}, wheel {wheel}: called after {begun:.2} s");
            assert!((0.0..=most).contains(&begun));
            assert!(seen.iter().any(|s| s.1 == stall && !s.2));
        }
        let out = trial.run();
        honest(&out, phase);
        // v = 0 and ω = 0 have no slip; what is said is finite, or nothing
        for moment in out.between(from + 0.5, from + 1.0) {
            assert!(moment.wheels[..FREE].iter().all(|w| w.slip.is_none()));
        }
    }
}

#[test]
fn a_wrong_radius_is_distinguished_from_slip() {
    // all wheels, and one: a worn or a wrong tyre
    for (what, error) in [
        ("right", [0.0; FREE + 1]),
        ("all 10 % too large", [0.1, 0.1, 0.1, 0.1, 0.0]),
        ("all 10 % too small", [-0.1, -0.1, -0.1, -0.1, 0.0]),
        ("one 10 % too large", [0.0, 0.1, 0.0, 0.0, 0.0]),
        ("one 10 % too small", [0.0, 0.0, -0.1, 0.0, 0.0]),
    ] {
        let mut trial = Trial::new(14);
        trial.radius_error = error;
        // a calibration: it starts, drives and brakes three times
        let drive = trial.robot.legs.clone();
        for _ in 0..2 {
            trial.robot.legs.extend(drive.iter().copied());
        }
        let mut found = [None; FREE + 1];
        trial.watch(|_, _, known| {
            found = core::array::from_fn(|wheel| known.checks[wheel].radius_excess);
        });
        for wheel in 0..FREE {
            let excess = found[wheel].unwrap();
            let (off, sigma) = (excess.value - error[wheel], excess.sigma());
            println!(
                "radius {what}, wheel {wheel}: {:.3} ± {sigma:.3}",
                excess.value
            );
            assert!(off.abs() < 3.0 * sigma, "{what}");
            if error[wheel] != 0.0 {
                // named: beyond what the radius was said to be known to
                assert!(excess.value.abs() > 3.0 * sigma, "{what}");
            }
        }
        assert!(found[FREE].is_none());
    }
}

#[test]
fn play_in_the_gears_makes_no_lasting_slip() {
    // 30 ticks of 960 at once
    let play = 30.0 / 960.0 * std::f64::consts::TAU * 0.1;
    for (phase, from) in PHASES {
        let with = Trial::new(15)
            .event(Event::Backlash { play }, from, from + 1.0)
            .run();
        let without = Trial::new(15).run();
        let mut since = None;
        for (a, b) in with
            .between(from, from + 3.0)
            .zip(without.between(from, from + 3.0))
        {
            let far = (0..FREE).any(|wheel| match (a.wheels[wheel].slip, b.wheels[wheel].slip) {
                (Some(a), Some(b)) => (a.value() - b.value()).abs() > 0.1,
                _ => false,
            });
            if !far {
                since = None;
                continue;
            }
            let lasted = a.time - *since.get_or_insert(a.time);
            // three steps of the estimate
            assert!(lasted < 0.155, "{phase}: {lasted:.2} s");
        }
    }
}
