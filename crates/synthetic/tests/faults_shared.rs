//! Faults that look like slip: of the only reference, of all powered wheels, of one wheel's clock, name or number. Each over
//! fifty seeds: detected, or covered by sigma, or one of those that nothing on the robot shows (docs/online.md).

use grouser_slip::{Degraded, Health};
use grouser_synthetic::{Event, Fault};

use crate::trial::{END_S, FREE, Trial, with_camera};

const SEEDS: u64 = 50;
/// Missed pulses are found within this time by their own unevenness, s.
const FOUND_S: f64 = 1.5;

/// Runs of the fifty in which a slip is Ok and more than four sigma off for over a second, and the longest time, s.
fn silent(what: &str, trial: impl Fn(u64) -> Trial) -> (u32, f64) {
    let (mut runs, mut longest) = (0, 0.0_f64);
    for seed in 0..SEEDS {
        let (lasted, ..) = trial(seed).run().silence();
        runs += u32::from(lasted > 1.0);
        longest = longest.max(lasted);
    }
    println!(
        "{what}: {runs} of {SEEDS} runs Ok and wrong for over 1 s, the longest {longest:.2} s"
    );
    (runs, longest)
}

#[test]
fn the_health_of_all_follows_the_only_free_wheel_that_misses_pulses() {
    for (share, from) in [(0.05, 9.0), (0.15, 9.0), (0.2, 4.0), (0.3, 9.0)] {
        let what = format!("the free wheel misses {share} from {from} s");
        let (_, longest) = silent(&what, |seed| {
            Trial::new(seed).fault(Fault::PulsesLost(FREE, share), from, END_S)
        });
        assert!(longest <= FOUND_S, "{what}");
    }
    // and all are Ok again when it has them again
    let out = Trial::new(0)
        .fault(Fault::PulsesLost(FREE, 0.2), 4.0, 6.0)
        .run();
    let reported = out.between(5.5, 6.0);
    let suspect = Health::Degraded(Degraded::Suspect);
    assert!(
        reported
            .flat_map(|m| &m.wheels[..FREE])
            .all(|w| w.health == suspect)
    );
    let after = out.between(18.0, 20.0);
    assert!(
        after
            .flat_map(|m| &m.wheels[..FREE])
            .all(|w| w.health == Health::Ok)
    );
}

#[test]
fn a_camera_keeps_the_others_ok_beside_a_free_wheel_that_misses_pulses() {
    let (_, longest) = silent("the free wheel misses 0.2, next to a camera", |seed| {
        with_camera(seed).fault(Fault::PulsesLost(FREE, 0.2), 9.0, END_S)
    });
    assert!(longest <= FOUND_S);
}

#[test]
fn a_free_wheel_that_jams_while_the_robot_is_stuck_is_found_when_the_robot_comes_free() {
    let (runs, _) = silent("the free wheel jams meanwhile", |seed| {
        let later = 0.04 * seed as f64;
        Trial::new(seed).event(Event::Immobilised, 7.4, 12.4).fault(
            Fault::WheelStuck(FREE),
            8.0 + later,
            15.0 + later,
        )
    });
    assert_eq!(runs, 0);
    // a robot that is only stuck is no robot with a jammed wheel
    let out = Trial::new(0).event(Event::Immobilised, 7.4, 12.4).run();
    let stuck = out.between(8.5, 11.8);
    assert!(
        stuck
            .flat_map(|m| &m.wheels[..FREE])
            .all(|w| w.health == Health::Ok)
    );
}

#[test]
fn a_wheel_with_a_fast_clock_is_not_ok() {
    for wheel in [1, FREE] {
        let what = format!("wheel {wheel}'s clock is 10 % fast");
        let (runs, _) = silent(&what, |seed| {
            Trial::new(seed).fault(Fault::ClockRate(wheel, 0.1), 9.0, END_S)
        });
        assert_eq!(runs, 0, "{what}");
    }
}

/// The test drive with soft ground of another slip and place for each seed.
fn on_other_ground(seed: u64) -> Trial {
    let mut trial = Trial::new(seed);
    let share = seed as f64 / SEEDS as f64;
    trial.robot.patch = (2.5 + 2.5 * share, 4.3 + 2.5 * share);
    trial.robot.drive_slip = (0.02 + 0.1 * share, 0.5 - 0.3 * share);
    trial
}

/// Each powered wheel in turn.
fn wheel_of(seed: u64) -> usize {
    usize::try_from(seed).unwrap() % FREE
}

/// A wheel in the air turns the wheels' yaw rate: it takes no gyro's place, and clears none.
#[test]
fn a_wheel_in_the_air_is_no_yaw_rate() {
    let (silent_gyro, wrong_gyro, alone) = (
        silent("a wheel in the air, no gyro", |seed| {
            let wheel = wheel_of(seed);
            on_other_ground(seed)
                .event(Event::LiftOff { wheel }, 17.1, 22.1)
                .fault(Fault::ImuSilent, 17.7, 22.7)
        }),
        silent("a wheel in the air, a gyro of the wrong sign", |seed| {
            let wheel = wheel_of(seed);
            on_other_ground(seed)
                .event(Event::LiftOff { wheel }, 14.2, 16.2)
                .fault(Fault::GyroScale(-1.0), 12.8, 17.8)
        }),
        silent("a wheel in the air", |seed| {
            let wheel = wheel_of(seed);
            on_other_ground(seed).event(Event::LiftOff { wheel }, 18.2, 23.2)
        }),
    );
    // a wrong gyro is found within a second and a tenth
    assert!(wrong_gyro.0 <= 1 && wrong_gyro.1 <= 1.2);
    assert_eq!((silent_gyro.0, alone.0), (0, 0));
}

/// Pulses that all powered wheels miss are not found either: the page lists it. The slips are so noisy that none is more than
/// four sigma off for a second without a gap, so that their share is measured.
#[test]
fn powered_wheels_that_all_miss_pulses_are_what_the_page_lists() {
    let wrong = |trial: &dyn Fn(u64) -> Trial| {
        let shares = (0..SEEDS).map(|seed| trial(seed).run().share_wrong(9.0, 19.0));
        100.0 * shares.sum::<f64>() / SEEDS as f64
    };
    let missed = wrong(&|seed| {
        (0..FREE).fold(Trial::new(seed), |trial, wheel| {
            trial.fault(Fault::PulsesLost(wheel, 0.2), 9.0, END_S)
        })
    });
    let none = wrong(&Trial::new);
    println!(
        "all powered wheels miss 0.2: {missed:.1} % of slips Ok and wrong, {none:.1} % without a fault"
    );
    assert!(none < 0.5, "{none:.1} %");
    assert!(
        missed > 10.0,
        "{missed:.1} %: found, so it goes from the page"
    );
}

/// What no sensor of the robot shows, or the filter does not find. The page lists it (docs/online.md); what is found one
/// day goes from here and from the page.
#[test]
fn what_is_silent_is_what_the_page_lists() {
    let is_silent = |what: String, trial: &dyn Fn(u64) -> Trial| {
        let silent = (0..10)
            .filter(|&seed| trial(seed).run().silence().0 > 1.0)
            .count();
        println!("{what}: {silent} of 10 runs Ok and wrong for over 1 s");
        assert!(silent > 0, "{what}: found, so it goes from the page");
    };
    for factor in [0.8, 1.2] {
        is_silent(format!("all powered wheels count {factor}"), &|seed| {
            (0..FREE).fold(Trial::new(seed), |trial, wheel| {
                trial.fault(Fault::CountsScaled(wheel, factor), 9.0, END_S)
            })
        });
        is_silent(format!("the free wheel counts {factor}"), &|seed| {
            Trial::new(seed).fault(Fault::CountsScaled(FREE, factor), 9.0, END_S)
        });
        is_silent(format!("free wheel and camera show {factor}"), &|seed| {
            with_camera(seed)
                .fault(Fault::CountsScaled(FREE, factor), 9.0, END_S)
                .fault(Fault::CameraScale(factor), 9.0, END_S)
        });
    }
    for (share, from) in [(0.8, 8.0), (0.8, 3.0), (2.0, 3.0)] {
        is_silent(
            format!("the free wheel skids at {share} from {from} s"),
            &|seed| Trial::new(seed).event(Event::FreeWheelSkids { share }, from, from + 3.0),
        );
    }
    for factor in [0.5, 2.0] {
        is_silent(format!("the camera alone shows {factor}"), &|seed| {
            with_camera(seed)
                .fault(Fault::WheelSilent(FREE), 0.0, END_S)
                .fault(Fault::CameraScale(factor), 9.0, 12.0)
        });
    }
    for fault in [
        Fault::Exchanged(0, 1),
        Fault::Exchanged(0, 2),
        Fault::Exchanged(1, FREE),
        Fault::Copies(0, 1),
        Fault::Copies(0, 2),
        Fault::Copies(1, FREE),
        Fault::Copies(FREE, 1),
    ] {
        is_silent(format!("{fault:?}"), &|seed| {
            Trial::new(seed).fault(fault, 0.0, END_S)
        });
    }
}
