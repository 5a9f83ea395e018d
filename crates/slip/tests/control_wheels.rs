//! The wheels' loops, their motors' protection and the robot's motion against closed forms of the rules in
//! `control/mod.rs` and in the settings' documentation.

use grouser_slip::control::{
    Action, ControlInput, ControlSettings, Controller, Decides, Ending, Reason, Request,
    WheelCommand, WheelObservation,
};
use grouser_slip::{Health, Invalid, Motion, Robot, Wheel};

use crate::open_loop::{OpenLoop, SPEED_M_PER_S, STEP_S, at, close, rolling, smoothed};

/// Rims follow their setpoint at once, the feedforward is off, and the robot never changes its mode.
fn direct() -> ControlSettings {
    let mut settings = ControlSettings::default();
    settings.max_acceleration = 100.0;
    settings.max_feedforward = 0.0;
    settings.decides = Decides::Stops;
    settings
}

fn rims(commands: &[WheelCommand; 4]) -> [f64; 4] {
    commands.map(|command| command.rim_speed)
}

fn all_close(rims: [f64; 4], expected: f64) -> bool {
    rims.iter().all(|rim| close(*rim, expected))
}

// --- Slip limit: rim = v̂/(1 − s*), s* = s_opt + k_p e + k_i ∫ e dt, e = (s_opt − ŝ) trust ---

#[test]
fn a_rim_is_limited_to_the_travel_over_one_less_the_setpoint() {
    // the integral off, sigma 0: s* = 0.3 + 0.3 (0.3 − ŝ)
    let mut settings = direct();
    settings.integral_gain = 0.0;
    for (slip, travel) in [
        (0.5, 0.1),
        (0.9, 0.05),
        (0.2, 0.12),
        (-0.4, 0.08),
        (1.7, 0.06),
    ] {
        let mut open = OpenLoop::new(&settings);
        open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(slip), Some(travel)));
        open.step();
        let slip = f64::clamp(slip, -1.0, 1.0);
        let expected = travel / (1.0 - (0.3 + 0.3 * (0.3 - slip)));
        assert!(expected < SPEED_M_PER_S);
        let commands = open.step().commands;
        assert!(
            all_close(rims(&commands), expected),
            "{slip}: {commands:?}, not {expected}"
        );
        assert!(
            commands
                .iter()
                .all(|command| command.traction == settings.max_traction)
        );
        // backwards it is the mirror image
        let mut back = OpenLoop::new(&settings);
        back.request.speed = -SPEED_M_PER_S;
        back.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(slip), Some(-travel)));
        back.step();
        assert!(all_close(rims(&back.step().commands), -expected));
    }
}

#[test]
fn the_setpoint_stays_between_0_02_and_0_95_and_the_rim_above_its_floor() {
    let mut settings = direct();
    settings.integral_gain = 0.0;
    settings.gain = 100.0;
    settings.crawl = 0.0;
    let limit = |slip: f64, travel: f64| {
        let mut open = OpenLoop::new(&settings);
        open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(slip), Some(travel)));
        open.step();
        open.step().commands[0].rim_speed
    };
    assert!(close(limit(0.9, 0.1), 0.1 / 0.98));
    assert!(close(limit(0.1, 0.005), 0.005 / 0.05));
    // a wheel that moves against the request does not travel
    assert!(close(limit(0.9, -0.1), 0.0));
    // a setpoint above the request does not limit
    assert!(close(limit(0.9, 0.3), SPEED_M_PER_S));
    // the floor: `crawl` of the speed on level ground, `creep` on a slope
    settings.crawl = 0.15;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.9), Some(0.0)));
    open.step();
    assert!(all_close(rims(&open.step().commands), 0.15 * SPEED_M_PER_S));
    open.pitch = Some(-0.3);
    // the tilt is smoothed over a second: 0.09 rad of 0.3 are reached after 36 steps, 1.01^−36 < 0.7
    assert!(all_close(
        rims(&open.run(35).commands),
        0.15 * SPEED_M_PER_S
    ));
    assert!(all_close(rims(&open.run(2).commands), 0.6 * SPEED_M_PER_S));
}

#[test]
fn an_uncertain_slip_moves_the_setpoint_less() {
    let mut settings = direct();
    settings.integral_gain = 0.0;
    // trust 1/(1 + (σ/0.1)²); without a sigma as with `sigma_half`
    for (sigma, trust) in [
        (Some(0.1), 0.5),
        (Some(0.2), 0.2),
        (None, 0.5),
        (Some(f64::NAN), 0.5),
    ] {
        let mut open = OpenLoop::new(&settings);
        open.each(|wheel| {
            (wheel.slip, wheel.sigma, wheel.forward_speed) = (Some(0.7), sigma, Some(0.1));
        });
        open.step();
        let expected = 0.1 / (1.0 - (0.3 - 0.3 * 0.4 * trust));
        assert!(
            all_close(rims(&open.step().commands), expected),
            "{sigma:?}"
        );
    }
}

#[test]
fn the_integral_moves_while_slip_limits_and_decays_otherwise() {
    let mut settings = direct();
    settings.gain = 0.0;
    settings.integral_gain = 0.5;
    let mut open = OpenLoop::new(&settings);
    let rim = |integral: f64| 0.1 / (1.0 - (0.3 + integral));
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.7), Some(0.1)));
    open.step();
    // e = −0.4; the integral of a step counts from the next one on
    assert!(all_close(rims(&open.step().commands), rim(0.0)));
    assert!(all_close(
        rims(&open.step().commands),
        rim(-0.4 * 0.5 * STEP_S)
    ));
    assert!(all_close(
        rims(&open.run(49).commands),
        rim(-0.4 * 0.5 * 50.0 * STEP_S)
    ));
    // at most a quarter either way
    assert!(all_close(rims(&open.run(200).commands), rim(-0.25)));
    // where the travel allows more than requested it decays by a hundredth a step
    open.each(|wheel| wheel.forward_speed = Some(1.0));
    assert!(all_close(rims(&open.run(50).commands), SPEED_M_PER_S));
    open.each(|wheel| wheel.forward_speed = Some(0.1));
    assert!(all_close(
        rims(&open.step().commands),
        rim(-0.25 * 0.99_f64.powi(50))
    ));
    // upwards
    open.each(|wheel| wheel.slip = Some(-0.9));
    assert!(all_close(
        rims(&open.run(300).commands),
        SPEED_M_PER_S.min(rim(0.25))
    ));
}

#[test]
fn wheels_of_which_too_little_is_known_are_not_limited() {
    let free = |change: fn(&mut WheelObservation)| {
        let mut open = OpenLoop::new(&direct());
        open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.9), Some(0.05)));
        change(&mut open.wheels[2]);
        open.step();
        let rims = rims(&open.step().commands);
        assert!(rims[0] < 0.1 && close(rims[0], rims[1]) && close(rims[0], rims[3]));
        close(rims[2], SPEED_M_PER_S)
    };
    assert!(free(
        |wheel| wheel.health = Health::Invalid(Invalid::Dropout)
    ));
    assert!(free(|wheel| wheel.health = Health::Uninitialised));
    assert!(free(|wheel| wheel.motion = Some(Motion::LiftOff)));
    assert!(free(|wheel| wheel.forward_speed = None));
    assert!(free(|wheel| wheel.forward_speed = Some(f64::INFINITY)));
    assert!(!free(|wheel| wheel.motion = Some(Motion::Standstill)));
    // without a slip the optimum is the setpoint; a wheel that rolls back counts as one that slips wholly
    let mut settings = direct();
    settings.integral_gain = 0.0;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| wheel.forward_speed = Some(0.1));
    open.wheels[0].slip = None;
    open.wheels[1].motion = Some(Motion::RollBack);
    open.step();
    let rims = rims(&open.step().commands);
    assert!(close(rims[0], 0.1 / 0.7) && close(rims[1], 0.1 / (1.0 - (0.3 - 0.3 * 0.7))));
    // and where slip may not limit, nothing does
    settings.limits_slip = false;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.9), Some(0.05)));
    open.step();
    assert!(all_close(self::rims(&open.step().commands), SPEED_M_PER_S));
}

/// At a crawl both speeds may lie below their noise, so that no slip is ever known: after a second such a rim creeps.
#[test]
fn a_rim_whose_slip_stays_unknown_creeps_after_a_second() {
    for (crawl, creep) in [(0.15, 0.6), (0.0, 0.3), (0.5, 0.2)] {
        let mut settings = direct();
        (settings.crawl, settings.creep) = (crawl, creep);
        (settings.optimum, settings.integral_gain) = (0.5, 0.0);
        let mut open = OpenLoop::new(&settings);
        let known = |open: &mut OpenLoop, slip: Option<f64>, motion: Motion| {
            open.each(|wheel| {
                (wheel.slip, wheel.motion, wheel.forward_speed) = (slip, Some(motion), Some(0.0));
            });
        };
        let share = |open: &mut OpenLoop, steps: usize| {
            let rims = rims(&open.run(steps).commands);
            assert!(all_close(rims, rims[0]));
            rims[0] / SPEED_M_PER_S
        };
        known(&mut open, None, Motion::Standstill);
        open.step();
        assert!(close(share(&mut open, 98), crawl));
        assert!(close(share(&mut open, 500), crawl.max(creep)));
        // a slip that is known and too high holds it again, and the second begins anew
        known(&mut open, Some(0.9), Motion::Driving);
        assert!(close(share(&mut open, 1), crawl));
        known(&mut open, None, Motion::Standstill);
        assert!(close(share(&mut open, 98), crawl));
        assert!(close(share(&mut open, 5), crawl.max(creep)));
        // and where the travel does not limit: 0.1/(1 − 0.5) m/s
        open.each(|wheel| (wheel.slip, wheel.forward_speed) = (None, Some(0.1)));
        assert!(close(share(&mut open, 300), 1.0));
        known(&mut open, None, Motion::Standstill);
        assert!(close(share(&mut open, 98), crawl));
    }
}

#[test]
fn rims_accelerate_at_their_limit_and_brake_twice_as_fast_at_a_stop() {
    let mut settings = ControlSettings::default();
    settings.decides = Decides::Stops;
    settings.max_feedforward = 0.0;
    let mut open = OpenLoop::new(&settings);
    // nothing is known: nothing limits the slip
    open.each(|wheel| {
        *wheel = WheelObservation {
            health: Health::Ok,
            ..WheelObservation::unknown(50.0)
        }
    });
    assert!(
        all_close(rims(&open.step().commands), 0.0),
        "the first step has no length"
    );
    for step in 1..=39 {
        assert!(all_close(
            rims(&open.step().commands),
            0.005 * f64::from(step)
        ));
    }
    assert!(all_close(rims(&open.run(5).commands), SPEED_M_PER_S));
    open.request.speed = -SPEED_M_PER_S;
    assert!(all_close(
        rims(&open.run(10).commands),
        SPEED_M_PER_S - 0.05
    ));
    open.request.speed = SPEED_M_PER_S;
    open.run(20);
    open.speed = None;
    // silence for more than a second, then 0.01 m/s a step
    assert!(all_close(rims(&open.run(99).commands), SPEED_M_PER_S));
    let (steps, _) = open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout);
    assert!(at(steps, 1), "{steps}");
    assert!(all_close(
        open.controller.commands().try_into().map(rims).unwrap(),
        SPEED_M_PER_S - 0.01
    ));
    assert!(all_close(rims(&open.run(9).commands), 0.5 * SPEED_M_PER_S));
    assert!(all_close(rims(&open.run(10).commands), 0.0));
}

#[test]
fn a_wheel_without_an_observation_rests_and_starts_again_from_rest() {
    let mut settings = direct();
    settings.max_acceleration = 1.0;
    let mut open = OpenLoop::new(&settings);
    open.run(50);
    let mut input = open.clone();
    // three wheels are observed
    let output = input.controller.step(&ControlInput {
        time_ns: open.time_ns + 10_000_000,
        wheels: &open.wheels[..3],
        speed: open.speed,
        heading: open.heading,
        pitch: open.pitch,
        roll: open.roll,
        slip_demand: None,
        request: open.request,
    });
    assert_eq!(output.commands[3], WheelCommand::default());
    assert!(close(output.commands[2].rim_speed, SPEED_M_PER_S));
    input.time_ns += 10_000_000;
    let commands = input.step().commands;
    assert!(close(commands[3].rim_speed, STEP_S) && close(commands[2].rim_speed, SPEED_M_PER_S));
}

#[test]
fn a_limit_that_lasts_half_a_second_is_reported_and_its_end_too() {
    let mut open = OpenLoop::new(&direct());
    open.step();
    open.wheels[1].slip = Some(0.8);
    open.wheels[1].forward_speed = Some(0.05);
    let (steps, decision) = open.until(Action::ReduceTorque, Reason::SlipHigh);
    assert!(at(steps, 50) && decision.wheel == Some(1), "{steps}");
    assert!(close(decision.value, 0.8) && close(decision.limit, 0.3));
    open.quiet(100);
    // a slip that is back
    open.wheels[1].slip = Some(0.25);
    let (steps, decision) = open.until(Action::RaiseTorque, Reason::SlipRegained);
    assert!(at(steps, 50) && decision.wheel == Some(1), "{steps}");
    assert!(close(decision.value, 0.25) && close(decision.limit, 0.3));
    open.quiet(100);
    // a shorter limit is noise: 0.5 s are not passed, and the time begins anew
    for _ in 0..5 {
        open.wheels[1].slip = Some(0.8);
        open.quiet(49);
        open.wheels[1].slip = Some(0.25);
        open.quiet(1);
    }
    // a slip above its setpoint where nothing is limited is not reported: the travel allows more than the request
    open.wheels[1].slip = Some(0.8);
    open.wheels[1].forward_speed = Some(1.0);
    open.quiet(200);
    // nor is a limited wheel whose slip is at its setpoint
    open.wheels[1].slip = Some(0.3);
    open.wheels[1].forward_speed = Some(0.05);
    open.quiet(200);
    // without a slip the rim is limited by the wheel's speed of 0.05 m/s and a setpoint of 0.3 at most
    open.wheels[1].slip = None;
    let (steps, decision) = open.until(Action::ReduceTorque, Reason::SlipUnknown);
    assert!(at(steps, 50), "{steps}");
    assert!(decision.value >= SPEED_M_PER_S, "{decision}");
    assert!((0.05..0.05 / 0.699).contains(&decision.limit), "{decision}");
    // a limit that ends while the slip is still high is no slip regained
    open.wheels[1].slip = Some(0.8);
    open.wheels[1].forward_speed = Some(1.0);
    open.quiet(200);
    open.wheels[1].slip = Some(0.3);
    assert_eq!(open.until(Action::RaiseTorque, Reason::SlipRegained).0, 1);
}

// --- Feedforward: x follows s/(1 − s) at 2/s ---

/// The share by which rims run faster, with a slip that is the same from the first step on.
fn shares(settings: &ControlSettings, slip: f64, steps: usize) -> f64 {
    let mut open = OpenLoop::new(settings);
    open.each(|wheel| wheel.slip = Some(slip));
    open.step();
    open.run(steps).commands[0].rim_speed / SPEED_M_PER_S - 1.0
}

#[test]
fn rims_run_faster_by_what_slip_takes() {
    let mut settings = direct();
    settings.limits_slip = false;
    settings.max_feedforward = 4.0;
    for (slip, share) in [
        (0.2, 0.25),
        (0.5, 1.0),
        (0.75, 3.0),
        (0.9, 4.0),
        (1.0, 4.0),
        (-0.5, 0.0),
    ] {
        for steps in [1, 7, 100, 2000] {
            let expected = share * (1.0 - 0.98_f64.powf(steps as f64));
            let given = shares(&settings, slip, steps);
            assert!(
                close(given, expected),
                "{slip}, {steps} steps: {given}, not {expected}"
            );
        }
    }
    // a gain of more than one step follows at once
    settings.feedforward_gain = 100.0;
    assert!(close(shares(&settings, 0.5, 1), 1.0));
}

#[test]
fn the_feedforward_holds_without_a_slip_and_falls_where_nothing_is_to_be_fed() {
    let mut settings = direct();
    settings.limits_slip = false;
    settings.max_feedforward = 4.0;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| wheel.slip = Some(0.5));
    open.step();
    let share = |open: &mut OpenLoop| open.step().commands[0].rim_speed / SPEED_M_PER_S - 1.0;
    open.run(49);
    let before = share(&mut open);
    assert!(close(before, 1.0 - 0.98_f64.powi(50)));
    open.each(|wheel| wheel.slip = None);
    open.run(20);
    assert!(close(share(&mut open), before), "unknown: held");
    open.each(|wheel| wheel.slip = Some(0.5));
    // at rest
    let mut rest = open.clone();
    rest.request.speed = 0.0;
    rest.run(10);
    rest.request.speed = SPEED_M_PER_S;
    let expected = 1.0 + (before * 0.98_f64.powi(10) - 1.0) * 0.98;
    assert!(close(share(&mut rest), expected));
    // while it turns on the spot: 1 rad off its heading
    let mut turning = open.clone();
    turning.heading = Some(1.0);
    turning.run(10);
    turning.heading = Some(0.0);
    assert!(close(share(&mut turning), expected));
}

// --- A motor's protection ---

/// The traction of wheel 1 over the greatest.
fn torque_share(open: &mut OpenLoop) -> f64 {
    let last = open.step();
    assert!([0, 2, 3].iter().all(|i| last.commands[*i].traction == 0.8));
    last.commands[1].traction / 0.8
}

#[test]
fn a_stall_is_a_standing_rim_with_more_than_four_fifths_of_the_torque() {
    // (rim, torque, motion): stalled?
    for (rim, torque, motion, stalls) in [
        (0.003, 0.81, Motion::Driving, true),
        (-0.003, -0.81, Motion::Driving, true),
        (0.003, 0.79, Motion::Driving, false),
        // at the limits themselves it has not
        (0.003, 0.8, Motion::Driving, false),
        (0.004, 0.81, Motion::Driving, false),
        (0.005, 0.81, Motion::Driving, false),
        (0.2, 0.3, Motion::Stall, true),
    ] {
        let mut open = OpenLoop::new(&direct());
        open.run(10);
        open.wheels[1].rim_speed = Some(rim);
        open.wheels[1].torque_share = Some(torque);
        open.wheels[1].motion = Some(motion);
        // 30 ms
        let shares = [0; 3].map(|_| torque_share(&mut open));
        let expected = if stalls { 0.1 } else { 1.0 };
        assert!(
            close(shares[0], 1.0) && close(shares[1], 1.0),
            "{rim} {torque}: {shares:?}"
        );
        let share = if close(shares[2], 1.0) {
            torque_share(&mut open)
        } else {
            shares[2]
        };
        assert!(close(share, expected), "{rim} {torque} {motion:?}: {share}");
    }
}

#[test]
fn a_stall_is_reported_once_and_the_torque_returns_within_two_seconds() {
    let mut open = OpenLoop::new(&direct());
    open.run(10);
    open.wheels[1].rim_speed = Some(0.0);
    open.wheels[1].torque_share = Some(-0.95);
    let (steps, decision) = open.until(Action::ShedTorque, Reason::Stall);
    assert!((3..=4).contains(&steps), "{steps}");
    assert_eq!(decision.wheel, Some(1));
    assert!(close(decision.value, 0.95) && close(decision.limit, 0.8));
    open.quiet(300);
    assert!(close(torque_share(&mut open), 0.1));
    open.wheels[1].rim_speed = Some(0.2);
    for step in 1..=179 {
        let share = torque_share(&mut open);
        assert!(
            close(share, 0.1 + 0.005 * f64::from(step)),
            "{step}: {share}"
        );
    }
    torque_share(&mut open);
    assert!(close(torque_share(&mut open), 1.0) && close(torque_share(&mut open), 1.0));
    // a stall within the first 0.8 s of the return is the same one: not reported again
    open.wheels[1].rim_speed = Some(0.0);
    open.until(Action::ShedTorque, Reason::Stall);
    open.wheels[1].rim_speed = Some(0.2);
    open.quiet(70);
    open.wheels[1].rim_speed = Some(0.0);
    open.quiet(10);
    open.wheels[1].rim_speed = Some(0.2);
    open.quiet(90);
    open.wheels[1].rim_speed = Some(0.0);
    open.until(Action::ShedTorque, Reason::Stall);
}

#[test]
fn a_rim_that_is_to_stand_has_not_stalled() {
    for (speed, stalls) in [
        (0.0, false),
        (0.0079, false),
        (0.008, false),
        (0.0081, true),
        (-0.0081, true),
    ] {
        let mut open = OpenLoop::new(&direct());
        open.request.speed = speed;
        open.each(|wheel| {
            (wheel.rim_speed, wheel.torque_share, wheel.slip) = (Some(0.0), Some(0.9), Some(0.0));
        });
        open.each(|wheel| wheel.forward_speed = Some(1.0_f64.copysign(speed)));
        let last = open.run(20);
        assert_eq!(close(last.commands[0].traction, 0.08), stalls, "{speed}");
    }
}

#[test]
fn without_torque_a_standing_rim_stalls_after_half_a_second() {
    // (torque, rim, requested speed): after how many steps
    for (torque, rim, speed, expected) in [
        (None, 0.0, 0.2, Some(50)),
        (Some(f64::NAN), 0.0, 0.2, Some(50)),
        (None, -0.0039, -0.2, Some(50)),
        (None, 0.0041, 0.2, None),
        (None, 0.0, 0.029, None),
        (None, 0.0, 0.03, None),
        (None, 0.0, 0.031, Some(50)),
        (Some(0.3), 0.0, 0.2, None),
    ] {
        let mut open = OpenLoop::new(&direct());
        open.request.speed = speed;
        open.each(|wheel| wheel.forward_speed = Some(1.0_f64.copysign(speed)));
        open.step();
        open.wheels[1].torque_share = torque;
        open.wheels[1].rim_speed = Some(rim);
        if let Some(expected) = expected {
            let (steps, decision) = open.until(Action::ShedTorque, Reason::Stall);
            assert!(
                (expected..=expected + 1).contains(&steps),
                "{torque:?} {rim} {speed}: {steps}"
            );
            assert!((decision.value - 0.5).abs() < 0.011 && close(decision.limit, 0.5));
        } else {
            open.quiet(200);
        }
    }
    // a tick in between begins the time anew
    let mut open = OpenLoop::new(&direct());
    open.step();
    open.wheels[1].torque_share = None;
    for _ in 0..4 {
        open.wheels[1].rim_speed = Some(0.0);
        open.quiet(45);
        open.wheels[1].rim_speed = Some(0.1);
        open.quiet(1);
    }
}

#[test]
fn a_rim_that_is_measured_against_its_command_sheds_its_torque_after_a_fifth_of_a_second() {
    // (rim, torque, forward speed, requested): reversed?
    for (rim, torque, forward, speed, reversed) in [
        (-0.031, 0.3, 0.2, 0.2, true),
        (0.031, -0.3, -0.2, -0.2, true),
        (-0.029, 0.3, 0.2, 0.2, false),
        (-0.03, 0.3, 0.2, 0.2, false),
        // a wheel that is to stand, one that does not push, and one whose robot stands
        (-0.1, 0.3, 0.2, 0.0, false),
        (-0.1, 0.0, 0.2, 0.2, false),
        (-0.1, 0.3, 0.0, 0.2, true),
        (0.1, 0.3, 0.2, 0.2, false),
        // it pushes the way that it is measured to turn
        (-0.1, -0.3, 0.2, 0.2, false),
        // it rolls back with its robot
        (-0.1, 0.3, -0.1, 0.2, false),
    ] {
        let mut settings = direct();
        settings.limits_slip = false;
        let mut open = OpenLoop::new(&settings);
        open.request.speed = speed;
        open.step();
        open.wheels[1].rim_speed = Some(rim);
        open.wheels[1].torque_share = Some(torque);
        open.wheels[1].forward_speed = Some(forward);
        if reversed {
            let (steps, decision) = open.until(Action::ShedTorque, Reason::EncoderReversed);
            assert!((20..=21).contains(&steps), "{steps}");
            assert!(close(decision.value, rim) && close(decision.limit, 0.03));
            assert_eq!(decision.wheel, Some(1));
        } else {
            open.quiet(100);
        }
    }
    // with an interruption the time begins anew
    let mut settings = direct();
    settings.limits_slip = false;
    let mut open = OpenLoop::new(&settings);
    open.step();
    for _ in 0..4 {
        open.wheels[1].rim_speed = Some(-0.1);
        open.quiet(15);
        open.wheels[1].rim_speed = Some(0.1);
        open.quiet(1);
    }
}

// --- The motion of the robot, wheel by wheel ---

#[test]
fn off_its_heading_a_robot_turns_rather_than_travels() {
    // error; share of the speed; yaw rate, 0.8/s, at most 0.4 rad/s. Wheels stand 0.2 m aside
    for (heading, requested, share, yaw_rate) in [
        (0.0_f64, 0.3_f64, 1.0, 0.24),
        (0.0, -0.34, 1.0, -0.272),
        (0.0, 0.36, 0.36_f64.cos() - 0.5, 0.288),
        (0.5, -0.5, 0.2, -0.4),
        (3.0, -3.0, 1.0, 0.8 * (std::f64::consts::TAU - 6.0)),
        (-0.4, 0.0, 0.4_f64.cos() - 0.5, 0.32),
    ] {
        let mut open = OpenLoop::new(&direct());
        open.heading = Some(heading);
        open.request.heading = requested;
        // so much travel that no slip limits
        open.each(|wheel| wheel.forward_speed = Some(1.0));
        open.step();
        let last = open.step();
        for (rim, y) in rims(&last.commands).iter().zip([0.2, -0.2, 0.2, -0.2]) {
            let expected = share * SPEED_M_PER_S - yaw_rate * y;
            assert!(
                close(*rim, expected),
                "{heading} to {requested}: {rim}, not {expected}"
            );
        }
        assert!(close(last.heading, requested));
        assert!(
            last.commands
                .iter()
                .all(|command| command.steering_angle == 0.0)
        );
    }
    // of a heading that is not measured nothing is held; a robot that is to rest does not turn
    let mut open = OpenLoop::new(&direct());
    open.heading = None;
    open.request.heading = 0.3;
    open.step();
    assert!(all_close(rims(&open.step().commands), SPEED_M_PER_S));
    open.heading = Some(0.0);
    open.request.speed = 0.0;
    assert!(all_close(rims(&open.step().commands), 0.0));
}

/// A robot that turns by the speeds of its rims slips for it: from 20° off until it is within 6° no slip holds them.
#[test]
fn slip_holds_no_rim_of_a_robot_that_turns() {
    let off = |open: &mut OpenLoop, degrees: f64| {
        open.heading = Some(-degrees.to_radians());
        let rims = rims(&open.run(2).commands);
        0.25 * rims.iter().sum::<f64>() < 0.9 * SPEED_M_PER_S
    };
    let mut settings = direct();
    settings.integral_gain = 0.0;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.9), Some(0.05)));
    open.step();
    assert!(off(&mut open, 0.0) && off(&mut open, 19.0));
    for sign in [1.0, -1.0] {
        // far off its course it travels at a fifth of its speed, as its rims show
        open.heading = Some(sign * 90_f64.to_radians());
        let rims = rims(&open.run(2).commands);
        assert!(rims.iter().any(|rim| *rim > 0.5 * SPEED_M_PER_S));
        assert!(!off(&mut open, sign * 19.0) && !off(&mut open, sign * 7.0));
        assert!(off(&mut open, sign * 5.0) && off(&mut open, sign * 19.0));
    }
    // nor is it a turn that takes longer than twelve seconds
    off(&mut open, 90.0);
    assert!(!off(&mut open, 15.0));
    open.run(1185);
    assert!(!off(&mut open, 15.0));
    open.run(20);
    assert!(off(&mut open, 15.0));
}

/// Wheels at (x, y) with a heading, which steer by up to an angle.
fn steering(wheels: &[(f64, f64, f64, f64)]) -> Controller {
    let described = wheels
        .iter()
        .enumerate()
        .map(|(index, (x, y, heading, _))| {
            Wheel::powered(["a", "b", "c", "d"][index])
                .at(*x, *y)
                .heading(grouser_terra::Angle::from_rad(*heading))
                .radius(0.1)
                .ticks_per_turn(1000)
                .load(50.0)
        });
    let robot = Robot::new("steered".into(), described.collect()).unwrap();
    let angles: Vec<f64> = wheels.iter().map(|wheel| wheel.3).collect();
    Controller::new(&robot, direct())
        .unwrap()
        .with_steering(&angles)
}

#[test]
fn steered_wheels_stand_along_the_motion_of_their_centres() {
    // front wheels steer, rear wheels do not, one stands across
    let wheels = [
        (0.3, 0.2, 0.0, 1.0),
        (0.3, -0.2, 0.1, 1.0),
        (-0.3, 0.2, 0.0, 0.0),
        (-0.3, -0.2, -0.1, 0.5),
    ];
    for (speed, yaw_rate) in [
        (0.2, 0.2),
        (0.2, -0.2),
        (-0.2, 0.2),
        (0.2, 0.0),
        (-0.2, -0.1),
    ] {
        let mut open = OpenLoop::with(steering(&wheels));
        open.request = Request {
            speed,
            heading: 0.0,
            yaw_rate: Some(yaw_rate),
        };
        open.each(|wheel| wheel.forward_speed = Some(1.0_f64.copysign(speed)));
        open.step();
        let commands = open.step().commands;
        for (command, (x, y, heading, most)) in commands.iter().zip(wheels) {
            let (forward, left) = (speed - yaw_rate * y, yaw_rate * x);
            // the line along which the centre moves, in the robot's frame, within a quarter turn of ahead
            let along = (left / forward).atan() - heading;
            let angle = if most == 0.0 {
                0.0
            } else {
                along.clamp(-most, most)
            };
            let direction = heading + angle;
            let rim = forward * direction.cos() + left * direction.sin();
            assert!(
                close(command.steering_angle, angle),
                "{speed} {yaw_rate}: {command:?}, not {angle}"
            );
            assert!(
                close(command.rim_speed, rim),
                "{speed} {yaw_rate}: {command:?}, not {rim}"
            );
        }
    }
    // at rest the wheels stand straight
    let mut open = OpenLoop::with(steering(&wheels));
    open.request.speed = 0.0;
    open.step();
    assert!(
        open.step()
            .commands
            .iter()
            .all(|command| command.steering_angle == 0.0)
    );
}

#[test]
fn a_robot_that_steers_turns_no_sharper_than_its_wheels_allow() {
    // tan(angle) over the arm |x| + |y|: the least of the wheels that steer
    for (wheels, curvature) in [
        (
            [
                (0.3, 0.2, 0.0, 0.5),
                (0.3, -0.2, 0.0, 0.4),
                (-0.3, 0.2, 0.0, 0.0),
                (-0.3, -0.2, 0.0, 0.0),
            ],
            0.4_f64.tan() / 0.5,
        ),
        (
            [
                (0.3, 0.2, 0.0, 0.2),
                (0.6, -0.2, 0.0, 0.2),
                (-0.3, 0.2, 0.0, 0.0),
                (-0.3, -0.2, 0.0, 0.0),
            ],
            0.2_f64.tan() / 0.8,
        ),
    ] {
        let mut open = OpenLoop::with(steering(&wheels));
        open.heading = Some(-1.5);
        open.each(|wheel| wheel.forward_speed = Some(1.0));
        open.step();
        let rim = open.step().commands[2].rim_speed;
        // it keeps its speed; the unsteered wheel at y = 0.2 shows the yaw rate
        let yaw_rate = (SPEED_M_PER_S - rim) / 0.2;
        let expected = (SPEED_M_PER_S * curvature).min(0.4);
        assert!(close(yaw_rate, expected), "{yaw_rate}, not {expected}");
    }
    // angles that are none are none; beyond a quarter turn it is a quarter turn
    let wheels = [
        (0.3, 0.2, 0.0, f64::NAN),
        (0.3, -0.2, 0.0, -0.3),
        (-0.3, 0.2, 0.0, 0.0),
        (-0.3, -0.2, 0.0, 0.0),
    ];
    let mut open = OpenLoop::with(steering(&wheels));
    open.heading = Some(-0.5);
    open.each(|wheel| wheel.forward_speed = Some(1.0));
    open.step();
    let commands = open.step().commands;
    // it does not steer: it slows down to turn
    assert!(close(
        0.5 * (commands[0].rim_speed + commands[1].rim_speed),
        (0.5_f64.cos() - 0.5) * SPEED_M_PER_S
    ));
    assert!(commands.iter().all(|command| command.steering_angle == 0.0));
}

#[test]
fn free_wheels_get_no_torque() {
    let wheels = vec![
        Wheel::powered("a")
            .at(0.3, 0.0)
            .radius(0.1)
            .ticks_per_turn(1000)
            .load(50.0),
        Wheel::free("b")
            .at(-0.3, 0.2)
            .radius(0.1)
            .ticks_per_turn(1000)
            .load(50.0),
    ];
    let robot = Robot::new("free".into(), wheels).unwrap();
    let controller = Controller::new(&robot, direct())
        .unwrap()
        .with_steering(&[0.0, 0.5]);
    let mut input = OpenLoop::with(controller);
    input.request.yaw_rate = Some(0.1);
    // its slip is none of the robot's
    input.wheels[1].slip = Some(0.9);
    let time = |step: i64| step * 10_000_000;
    for step in 0..3 {
        let output = input.controller.step(&ControlInput {
            time_ns: time(step),
            wheels: &input.wheels,
            speed: Some(SPEED_M_PER_S),
            heading: Some(0.0),
            pitch: None,
            roll: None,
            slip_demand: None,
            request: input.request,
        });
        assert_eq!(
            (output.commands[1].rim_speed, output.commands[1].traction),
            (0.0, 0.0)
        );
        let angle = (-0.03_f64 / (SPEED_M_PER_S - 0.02)).atan();
        assert!(close(output.commands[1].steering_angle, angle));
        assert!(close(
            output.slip,
            smoothed(0.1, 1.0, usize::try_from(step).unwrap())
        ));
    }
}

// --- The robot as a whole ---

#[test]
fn the_robots_slip_is_the_mean_of_powered_wheels_by_load_smoothed_over_a_second() {
    let mean = |change: fn(&mut [WheelObservation; 4])| {
        let mut open = OpenLoop::new(&direct());
        for (index, wheel) in open.wheels.iter_mut().enumerate() {
            wheel.slip = Some(0.1 * (index + 1) as f64);
            wheel.load = 10.0 * (index + 1) as f64;
        }
        change(&mut open.wheels);
        open.step();
        // the first step has no length
        open.run(60).slip / smoothed(1.0, 1.0, 60)
    };
    assert!(close(mean(|_| ()), 0.3));
    let without_last = (0.1 + 0.4 + 0.9) / 6.0;
    assert!(close(
        mean(|wheels| wheels[3].motion = Some(Motion::LiftOff)),
        without_last
    ));
    assert!(close(mean(|wheels| wheels[3].slip = None), without_last));
    assert!(close(
        mean(|wheels| wheels[3].health = Health::Uninitialised),
        without_last
    ));
    assert!(close(
        mean(|wheels| wheels[3].health = Health::Invalid(Invalid::Dropout)),
        without_last
    ));
    assert!(close(
        mean(|wheels| wheels[3].slip = Some(7.0)),
        (1.4 + 4.0) / 10.0
    ));
    assert!(close(
        mean(|wheels| wheels[3].slip = Some(-7.0)),
        (1.4 - 4.0) / 10.0
    ));
    // a load that is none hardly counts
    for load in [f64::NAN, -5.0, 0.0] {
        let mut open = OpenLoop::new(&direct());
        open.wheels[0] = WheelObservation {
            load,
            slip: Some(0.9),
            ..rolling()
        };
        open.step();
        let slip = open.run(60).slip / smoothed(1.0, 1.0, 60);
        assert!(
            close(slip, (0.9e-3 + 0.1 * 150.0) / 150.001),
            "{load}: {slip}"
        );
    }
}

#[test]
fn absurd_requests_are_limited_or_stop_the_robot() {
    let mut settings = direct();
    settings.limits_slip = false;
    settings.max_acceleration = 100.0;
    settings.max_rim_speed = 1e3;
    let rim = |request: Request| {
        let mut open = OpenLoop::new(&settings);
        open.request = request;
        open.run(2000).commands[0].rim_speed
    };
    assert_eq!(
        rim(Request {
            speed: f64::NAN,
            ..Request::default()
        }),
        0.0
    );
    assert_eq!(
        rim(Request {
            speed: f64::NEG_INFINITY,
            ..Request::default()
        }),
        0.0
    );
    assert_eq!(
        rim(Request {
            speed: -1e300,
            ..Request::default()
        }),
        -1e3
    );
    // a robot does not drive by a heading beyond 10⁶ rad, a smaller one is one
    assert_eq!(
        rim(Request {
            speed: SPEED_M_PER_S,
            heading: 1.1e6,
            yaw_rate: None
        }),
        0.0
    );
    for heading in [0.9e6, -1e6] {
        let turned = rim(Request {
            speed: SPEED_M_PER_S,
            heading,
            yaw_rate: None,
        });
        assert!((turned - SPEED_M_PER_S).abs() > 1e-3, "{heading}");
    }
}

#[test]
fn a_motors_limits_of_time_are_inclusive() {
    // steps whose sums are exact: 0.01 + 0.02, 8/16 and 2 · 0.1 s
    for (rim, torque, forward, steps_ns, reason) in [
        (
            0.0,
            Some(0.9),
            0.2,
            &[10_000_000, 20_000_000][..],
            Reason::Stall,
        ),
        (0.0, None, 0.2, &[62_500_000; 8], Reason::Stall),
        (
            -0.1,
            Some(0.3),
            0.2,
            &[100_000_000; 2],
            Reason::EncoderReversed,
        ),
    ] {
        let mut settings = direct();
        settings.limits_slip = false;
        let mut open = OpenLoop::new(&settings);
        open.run(10);
        open.wheels[1].rim_speed = Some(rim);
        open.wheels[1].torque_share = torque;
        open.wheels[1].forward_speed = Some(forward);
        let (last, before) = steps_ns.split_last().unwrap();
        for passed_ns in before {
            assert_eq!(open.after(*passed_ns).decision, None);
        }
        assert_eq!(open.after(*last).decision.unwrap().reason, reason);
    }
}

#[test]
fn another_optimum_is_the_setpoint_from_then_on() {
    let mut settings = direct();
    settings.integral_gain = 0.0;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.5), Some(0.05)));
    open.step();
    open.controller.set_optimum(0.5).unwrap();
    assert!(all_close(rims(&open.step().commands), 0.1));
    for optimum in [0.0, 1.0, f64::NAN] {
        assert!(open.controller.set_optimum(optimum).is_err());
    }
    assert_eq!(open.controller.settings().optimum, 0.5);
}

#[test]
fn limits_of_a_wheels_loop_are_passed_and_not_only_reached() {
    // half a second in steps of 1/64 s is not more than half a second
    let mut open = OpenLoop::new(&direct());
    open.period_ns = 15_625_000;
    open.step();
    open.wheels[1].slip = Some(0.8);
    open.wheels[1].forward_speed = Some(0.05);
    assert_eq!(open.until(Action::ReduceTorque, Reason::SlipHigh).0, 33);
    open.wheels[1].slip = Some(0.25);
    assert_eq!(open.until(Action::RaiseTorque, Reason::SlipRegained).0, 33);
    // nor is a second more than a second
    let mut settings = direct();
    (settings.crawl, settings.creep) = (0.2, 0.6);
    let mut open = OpenLoop::new(&settings);
    open.period_ns = 15_625_000;
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (None, Some(0.0)));
    open.step();
    let share = |open: &mut OpenLoop, steps| open.run(steps).commands[0].rim_speed / SPEED_M_PER_S;
    assert!(close(share(&mut open, 64), 0.2) && close(share(&mut open, 1), 0.6));
    // a limit that is the requested speed limits nothing: 0.1/(1 − 0.5) m/s
    let mut settings = direct();
    (settings.optimum, settings.gain, settings.integral_gain) = (0.5, 0.0, 0.5);
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.7), Some(0.1)));
    open.step();
    assert!(all_close(rims(&open.quiet(200).commands), SPEED_M_PER_S));
}
