//! The controller's decisions: when each comes, with which value and limit, and what the robot does then, against closed
//! forms of the rules. Slips and tilts are constant inputs of first-order filters.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of steps"
)]

use grouser_slip::control::{
    Action, ControlSettings, Decides, Ending, Mode, Reason, Request, WheelObservation,
};
use grouser_slip::filter::SlipPrior;

use crate::four_wheels::yaw_rate;
use crate::open_loop::{OpenLoop, SPEED_M_PER_S, STEP_S, at, close, smoothed};

/// Rims follow at once, slip limits nothing, and the feedforward is off: commands show the supervisor's motion.
fn settings() -> ControlSettings {
    let mut settings = ControlSettings::default();
    settings.max_acceleration = 100.0;
    settings.max_feedforward = 0.0;
    settings.limits_slip = false;
    settings
}

fn with_slip(slip: f64) -> OpenLoop {
    let mut open = OpenLoop::new(&settings());
    open.each(|wheel| wheel.slip = Some(slip));
    open.step();
    open
}

/// The first step after which `holds` of the number of steps is true.
fn first(holds: impl Fn(usize) -> bool) -> usize {
    (1..100_000).find(|steps| holds(*steps)).unwrap()
}

/// Mean rim speed (m/s) and yaw rate (rad/s) of a command.
fn motion(open: &OpenLoop) -> (f64, f64) {
    let commands = open.controller.commands();
    let rims = [0, 1, 2, 3].map(|index| commands[index].rim_speed);
    (0.25 * rims.iter().sum::<f64>(), yaw_rate(rims))
}

/// Rims keep to the supervisor's slip alone: what `rim_slip` shows.
fn limiting() -> ControlSettings {
    let mut settings = settings();
    settings.limits_slip = true;
    (settings.gain, settings.integral_gain, settings.crawl) = (0.0, 0.0, 0.0);
    settings
}

/// The slip of the first rim's command where its wheel moves at `forward_speed`, m/s.
fn rim_slip(open: &mut OpenLoop, forward_speed: f64) -> f64 {
    open.each(|wheel| wheel.forward_speed = Some(forward_speed));
    1.0 - forward_speed / open.step().commands[0].rim_speed
}

/// A robot that has just begun to back out, with the settings of [`limiting`].
fn backing_out() -> OpenLoop {
    let mut open = OpenLoop::new(&limiting());
    open.each(|wheel| wheel.forward_speed = Some(1.0));
    open.step();
    dig(&mut open);
    open
}

// --- Safety stops ---

#[test]
fn a_lean_that_lasts_a_fifth_of_a_second_ends_the_drive() {
    // cos tilt = cos pitch cos roll; the limit is 0.61 rad
    for (pitch, roll) in [(0.62, 0.0), (0.0, -0.62), (-0.5, 0.4)] {
        let tilt = (f64::cos(pitch) * f64::cos(roll)).acos();
        assert!(tilt > 0.61);
        let mut open = with_slip(0.1);
        (open.pitch, open.roll) = (Some(pitch), Some(roll));
        let (steps, decision) = open.until(Action::End(Ending::Tipping), Reason::TiltHigh);
        assert!(at(steps, 20), "{steps}");
        assert!(close(decision.value, tilt) && close(decision.limit, 0.61));
        assert_eq!(open.controller.mode(), Mode::Stopped);
        open.quiet(500);
    }
    for (pitch, roll) in [
        (0.6, 0.0),
        (0.4, 0.4),
        (f64::NAN, 0.9),
        (0.9, f64::INFINITY),
    ] {
        let mut open = with_slip(0.1);
        (open.pitch, open.roll) = (Some(pitch), Some(roll));
        open.quiet(300);
    }
    // at the limit of time and at that of the tilt, here 0, it has not leant too far
    let mut open = with_slip(0.1);
    open.roll = Some(0.7);
    open.period_ns = 100_000_000;
    open.quiet(2);
    open.until(Action::End(Ending::Tipping), Reason::TiltHigh);
    let mut upright = settings();
    upright.max_tilt = 0.0;
    let mut open = OpenLoop::new(&upright);
    open.quiet(100);
    // shorter ones are bumps, and the time begins anew
    let mut open = with_slip(0.1);
    for _ in 0..5 {
        open.pitch = Some(0.7);
        open.quiet(19);
        open.pitch = Some(0.1);
        open.quiet(1);
    }
}

#[test]
fn silence_ends_the_drive_after_its_time_and_is_forgotten_four_times_as_fast() {
    let mut open = with_slip(0.1);
    open.speed = None;
    let (steps, decision) = open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout);
    assert!(at(steps, 100), "{steps}");
    assert!((decision.value - 1.0).abs() < 0.011 && close(decision.limit, 1.0));
    // 0.8 s of silence less four times 0.1 s: 0.6 s are left
    let mut open = with_slip(0.1);
    open.speed = None;
    open.quiet(80);
    open.speed = Some(SPEED_M_PER_S);
    open.quiet(10);
    open.speed = None;
    let (steps, _) = open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout);
    assert!(at(steps, 60), "{steps}");
    // no silence is forgotten in advance
    let mut open = with_slip(0.1);
    open.quiet(500);
    open.speed = None;
    assert!(at(
        open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout)
            .0,
        100
    ));
    // wheels that are all invalid are silent too; one that is not is enough
    let mut open = with_slip(0.1);
    open.each(|wheel| wheel.health = grouser_slip::Health::Uninitialised);
    assert!(at(
        open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout)
            .0,
        100
    ));
    let mut open = with_slip(0.1);
    open.each(|wheel| wheel.health = grouser_slip::Health::Uninitialised);
    open.wheels[3].health = grouser_slip::Health::Ok;
    open.quiet(300);
}

#[test]
fn a_gap_of_the_clock_counts_as_silence_beyond_a_tenth_of_a_second() {
    // 1.45 s: 1.35 s of silence less 4 · 0.1 s of this measured step
    let mut open = with_slip(0.1);
    open.quiet(50);
    assert_eq!(open.after(1_450_000_000).decision, None);
    open.speed = None;
    assert!(at(
        open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout)
            .0,
        5
    ));
    // 1.55 s: 1.45 − 0.4 > 1
    let mut open = with_slip(0.1);
    open.quiet(50);
    let decision = open.after(1_550_000_000).decision.unwrap();
    assert_eq!(decision.action, Action::End(Ending::SensorsLost));
    assert!(close(decision.value, 1.05));
    // a step of a tenth brings no silence, and filters step by a tenth at most
    let mut open = with_slip(0.1);
    let before = open.step().slip;
    let after = open.after(300_000_000).slip;
    assert!(close(after, before + 0.1 / 1.1 * (0.1 - before)));
}

#[test]
fn a_clock_that_stands_counts_by_steps_and_the_rims_come_to_rest() {
    let mut settings = settings();
    settings.max_acceleration = 0.5;
    let mut open = OpenLoop::new(&settings);
    open.run(100);
    // 40 steps of 0.025 s are one second; more is needed
    let mut steps = 0;
    let decision = loop {
        steps += 1;
        if let Some(decision) = open.after(0).decision {
            break decision;
        }
    };
    assert!(at(steps, 40), "{steps}");
    assert_eq!(decision.action, Action::End(Ending::SensorsLost));
    assert!((decision.value - 1.0).abs() < 0.026 && close(decision.limit, 1.0));
    // twice 0.5 m/s² over 0.025 s each
    assert!(close(motion(&open).0, SPEED_M_PER_S - 0.025));
    open.after(0);
    assert!(close(motion(&open).0, SPEED_M_PER_S - 0.05));
    // a clock that goes on steps by its own time again
    open.after(10_000_000);
    assert!(close(motion(&open).0, SPEED_M_PER_S - 0.06));
    // time that passes forgets the steps without time
    let mut open = OpenLoop::new(&settings);
    open.run(100);
    for _ in 0..5 {
        for _ in 0..35 {
            assert_eq!(open.after(0).decision, None);
        }
        open.quiet(1);
    }
}

// --- Digging, standing still, backing out, detours ---

/// Steps until slip that is smoothed over a second has been above `limit` for a second, from a start with this slip: the mode
/// must have lasted a second as well.
fn digging_steps(slip: f64, limit: f64) -> usize {
    first(|steps| smoothed(slip, 1.0, steps) > limit && steps >= 100) + 99
}

#[test]
fn wheels_that_dig_for_a_second_make_the_robot_back_out() {
    for slip in [0.82, 0.95, 1.0] {
        let mut open = with_slip(slip);
        let (steps, decision) = open.until(Action::BackOut, Reason::DiggingIn);
        assert!(at(steps, digging_steps(slip, 0.8)), "{slip}: {steps}");
        assert!(close(decision.value, smoothed(slip, 1.0, steps)) && close(decision.limit, 0.8));
        assert_eq!(
            (open.controller.mode(), decision.wheel),
            (Mode::BackOut, None)
        );
        // back at 0.7 of the requested speed
        assert!(close(motion(&open).0, -0.7 * SPEED_M_PER_S));
    }
    // below the limit nothing digs; a slip of 0.7 that is steady is accepted instead
    let mut open = with_slip(0.7);
    open.until(Action::AcceptSlip, Reason::Demanded);
    // an interruption begins anew: the smoothed slip falls below 0.8
    let mut open = with_slip(0.95);
    open.quiet(digging_steps(0.95, 0.8) - 5);
    open.each(|wheel| wheel.slip = Some(-1.0));
    open.quiet(30);
    open.each(|wheel| wheel.slip = Some(0.95));
    assert!(open.until(Action::BackOut, Reason::DiggingIn).0 > 100);
}

/// A robot that turns by its rims slips for it.
#[test]
fn a_robot_that_turns_does_not_dig() {
    let mut open = with_slip(0.95);
    open.heading = Some(-0.5);
    open.quiet(400);
    open.heading = Some(0.3);
    open.quiet(400);
    open.heading = Some(0.05);
    let (steps, _) = open.until(Action::BackOut, Reason::DiggingIn);
    assert!(at(steps, 100), "{steps}");
    // what keeps it off its course for more than twelve seconds is no turn
    let mut open = with_slip(0.95);
    open.heading = Some(-0.5);
    open.quiet(100);
    open.heading = Some(-0.3);
    open.quiet(1250);
    let (steps, _) = open.until(Action::BackOut, Reason::DiggingIn);
    assert!(at(steps, 50), "{steps}");
}

#[test]
fn a_steady_slip_digs_only_from_nine_tenths_on() {
    // after a minute the slow mean is the slip: it no longer rises
    let mut open = with_slip(0.1);
    open.request.speed = 0.0;
    open.each(|wheel| wheel.slip = Some(0.88));
    open.quiet(6000);
    open.request.speed = SPEED_M_PER_S;
    let (_, decision) = open.until(Action::AcceptSlip, Reason::Demanded);
    assert!((decision.value - 0.88).abs() < 1e-6);
    let mut open = OpenLoop::new(&limiting());
    open.request.speed = 0.0;
    open.each(|wheel| wheel.slip = Some(0.88));
    open.quiet(6000);
    open.request.speed = SPEED_M_PER_S;
    open.each(|wheel| wheel.forward_speed = Some(1.0));
    open.until(Action::AcceptSlip, Reason::Demanded);
    assert!((rim_slip(&mut open, 0.001) - 0.94).abs() < 1e-5);
    // a robot that does not advance at all has no slip to accept
    let mut settings = settings();
    settings.stuck_share = 0.0;
    let mut open = OpenLoop::new(&settings);
    open.speed = Some(0.0);
    open.each(|wheel| wheel.slip = Some(0.5));
    open.quiet(3000);
    let mut open = with_slip(0.1);
    open.request.speed = 0.0;
    open.each(|wheel| wheel.slip = Some(0.91));
    open.quiet(6000);
    open.request.speed = SPEED_M_PER_S;
    let (steps, decision) = open.until(Action::BackOut, Reason::DiggingIn);
    assert!(at(steps, 100), "{steps}");
    assert!((decision.value - 0.91).abs() < 1e-6);
}

#[test]
fn a_robot_that_does_not_advance_for_two_seconds_backs_out() {
    // slower than a tenth of the rims: 0.02 m/s. Time counts from the first second on
    for (speed, rim, stuck) in [
        (0.019, 0.2, true),
        (-0.019, 0.2, true),
        (0.021, 0.2, false),
        (0.1 * 0.2, 0.2, false),
        (-0.021, 0.2, false),
        // rims that stand count as `creep` of the request: 0.12 m/s
        (0.0119, 0.0, true),
        (0.0121, 0.0, false),
    ] {
        let mut open = with_slip(0.1);
        open.speed = Some(speed);
        open.each(|wheel| wheel.rim_speed = Some(rim));
        if stuck {
            let (steps, decision) = open.until(Action::BackOut, Reason::NoProgress);
            assert!(at(steps, 299), "{speed}: {steps}");
            assert!((decision.value - 2.0).abs() < 1e-9 && close(decision.limit, 2.0));
        } else {
            open.quiet(600);
        }
    }
    // a speed that is not measured is no standstill; a moment of travel begins anew
    let mut open = with_slip(0.1);
    for _ in 0..6 {
        open.speed = None;
        open.quiet(50);
        open.speed = Some(SPEED_M_PER_S);
        open.quiet(50);
    }
    let mut open = with_slip(0.1);
    for _ in 0..4 {
        open.speed = Some(0.0);
        open.quiet(190);
        open.speed = Some(SPEED_M_PER_S);
        open.quiet(1);
    }
}

/// Drives until the robot backs out; the level ground's slip is then harmless again.
fn dig(open: &mut OpenLoop) {
    open.each(|wheel| wheel.slip = Some(1.0));
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.0);
    open.until(Action::BackOut, Reason::DiggingIn);
    open.each(|wheel| wheel.slip = Some(0.1));
}

/// Backs out at `speed` until the robot decides.
fn back_out(open: &mut OpenLoop, speed: f64, reason: (Action, Reason)) -> (usize, f64, f64) {
    open.speed = Some(-speed);
    let (steps, decision) = open.until(reason.0, reason.1);
    (steps, decision.value, decision.limit)
}

#[test]
fn on_the_level_it_drives_round_what_it_dug_into_and_further_with_every_try() {
    let mut settings = settings();
    settings.progress = 1e3;
    let mut open = OpenLoop::new(&settings);
    open.step();
    for detour in 0..5_u32 {
        dig(&mut open);
        // back by 1 m, at 0.1 m/s and 0.01 s a step
        let (steps, angle, width) = back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
        assert!(at(steps, 1000), "{steps}");
        // 1.2 rad, 0.3 rad more each time, at most 2.1 rad; 2.2 m, half of it more each time
        let expected = (1.2 + 0.3 * f64::from(detour)).min(2.1);
        let across = 2.2 * (1.0 + 0.5 * f64::from(detour));
        assert!(
            close(angle, expected) && close(width, across),
            "{detour}: {angle}, {width}"
        );
        assert_eq!(open.controller.mode(), Mode::Detour);
        assert!(close(open.step().heading, expected));
        // aside by sin(heading) of the way
        open.heading = Some(expected);
        open.speed = Some(SPEED_M_PER_S);
        let (steps, decision) = open.until(Action::Resume, Reason::ClearedSoftGround);
        let needed = (across / (expected.sin() * SPEED_M_PER_S * STEP_S)).ceil();
        assert!(
            (steps as f64 + 1.0 - needed).abs() <= 1.0,
            "{detour}: {steps}, not {needed}"
        );
        assert!(
            (decision.value - across).abs() < SPEED_M_PER_S * STEP_S
                && close(decision.limit, across)
        );
        assert_eq!(open.controller.mode(), Mode::Forward);
        open.heading = Some(0.0);
        assert!(close(open.step().heading, 0.0));
    }
    // the attempts are used
    open.each(|wheel| wheel.slip = Some(1.0));
    let (_, decision) = open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
    assert!(close(decision.value, 5.0) && close(decision.limit, 5.0));
}

#[test]
fn what_backs_out_alone_then_goes_on_as_requested_as_often_as_it_takes() {
    let mut settings = settings();
    (settings.decides, settings.progress) = (Decides::BacksOut, 1e3);
    let mut open = OpenLoop::new(&settings);
    open.step();
    for _ in 0..2 * settings.max_attempts {
        dig(&mut open);
        let end = (Action::Resume, Reason::BackedOut);
        let (steps, way, length) = back_out(&mut open, 0.1, end);
        assert!(at(steps, 1000), "{steps}");
        assert!((way - 1.0).abs() < 2e-3 && close(length, 1.0), "{way}");
        assert_eq!(open.controller.mode(), Mode::Forward);
        assert!(close(open.step().heading, 0.0));
    }
    // a robot that cannot back out has ended its drive
    dig(&mut open);
    let stuck = (Action::End(Ending::Immobilised), Reason::NoProgress);
    back_out(&mut open, 0.0, stuck);
    // on a slope it does not turn aside
    let mut open = OpenLoop::new(&settings);
    open.pitch = Some(-0.2);
    open.step();
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
}

#[test]
fn progress_forgets_attempts_and_detours() {
    // attempts are forgotten after 1.5 m ahead, sides and widths after 4 m
    for (metres, detour) in [(1.0, Some(1)), (2.0, Some(1)), (4.2, Some(0))] {
        let mut settings = settings();
        settings.max_attempts = 1;
        let mut open = OpenLoop::new(&settings);
        open.step();
        dig(&mut open);
        back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
        // straight aside: no progress
        open.heading = Some(std::f64::consts::FRAC_PI_2);
        open.speed = Some(SPEED_M_PER_S);
        open.until(Action::Resume, Reason::ClearedSoftGround);
        open.heading = Some(0.0);
        // digging itself takes 2.6 s or so, 0.5 m of progress in that time
        let digging = first(|n| smoothed(1.0, 1.0, n) > 0.8) as f64 * STEP_S * SPEED_M_PER_S;
        open.quiet(((metres - digging) / (SPEED_M_PER_S * STEP_S)).max(1.0) as usize);
        open.each(|wheel| wheel.slip = Some(1.0));
        if metres < 1.5 {
            open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
            continue;
        }
        open.until(Action::BackOut, Reason::DiggingIn);
        open.each(|wheel| wheel.slip = Some(0.1));
        let (_, angle, _) = back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
        assert!(
            close(angle, 1.2 + 0.3 * f64::from(detour.unwrap())),
            "{metres} m: {angle}"
        );
    }
    // a robot that drives aside makes no progress: after 10 m across the second attempt is one too many
    let mut settings = settings();
    settings.max_attempts = 1;
    let mut open = OpenLoop::new(&settings);
    open.step();
    dig(&mut open);
    back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
    open.heading = Some(std::f64::consts::FRAC_PI_2);
    open.speed = Some(SPEED_M_PER_S);
    open.until(Action::Resume, Reason::ClearedSoftGround);
    open.request.yaw_rate = None;
    open.request.heading = 0.0;
    open.quiet(5000);
    open.heading = Some(0.0);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
}

#[test]
fn a_robot_that_cannot_back_out_ends_its_drive() {
    let end = (Action::End(Ending::Immobilised), Reason::NoProgress);
    // slower than a quarter of 0.02 m/s for ten seconds
    for speed in [0.0, 0.0049, -0.1] {
        let mut open = with_slip(0.1);
        dig(&mut open);
        let (steps, value, limit) = back_out(&mut open, speed, end);
        assert!(at(steps, 1000), "{speed}: {steps}");
        assert!((value - 10.0).abs() < 0.011 && close(limit, 10.0));
    }
    // slow but moving: eight times 1 m over 0.14 m/s
    let mut open = with_slip(0.1);
    dig(&mut open);
    let (steps, value, limit) = back_out(&mut open, 0.0051, end);
    let max_time = 8.0 / (0.7 * SPEED_M_PER_S);
    assert!(at(steps, (max_time / STEP_S).ceil() as usize), "{steps}");
    assert!((value - max_time).abs() < 0.011 && close(limit, max_time));
    // a moment of movement begins the time of standing anew
    let mut open = with_slip(0.1);
    dig(&mut open);
    for _ in 0..3 {
        open.speed = Some(0.0);
        open.quiet(990);
        open.speed = Some(-0.1);
        open.quiet(1);
    }
}

#[test]
fn backing_out_holds_the_last_heading_and_runs_the_other_way_for_a_reversing_robot() {
    let mut open = with_slip(0.1);
    open.heading = Some(0.2);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
    // 0.1 rad off that heading: 0.08 rad/s
    open.heading = Some(0.1);
    let last = open.step();
    assert!(close(last.heading, 0.2));
    let (speed, yaw_rate) = motion(&open);
    assert!(close(speed, -0.7 * SPEED_M_PER_S) && close(yaw_rate, 0.8 * 0.1));
    // far off it, it still backs out at its full speed
    open.heading = Some(-0.8);
    open.step();
    assert!(close(motion(&open).0, -0.7 * SPEED_M_PER_S) && close(motion(&open).1, 0.4));
    // reversing: ahead is back
    let mut open = with_slip(0.1);
    open.request.speed = -SPEED_M_PER_S;
    open.speed = Some(-SPEED_M_PER_S);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
    assert!(close(motion(&open).0, 0.7 * SPEED_M_PER_S));
    open.each(|wheel| wheel.slip = Some(0.1));
    open.speed = Some(0.1);
    assert!(at(open.until(Action::Detour, Reason::BackedOut).0, 1000));
}

#[test]
fn a_robot_that_backs_out_slowly_may_slip_more() {
    // slower than half of 0.14 m/s: 0.1/s more slip, up to 0.92; the wheels' setpoint shows it
    let mut open = backing_out();
    let setpoint = |open: &mut OpenLoop| rim_slip(open, -0.01);
    open.speed = Some(-0.071);
    open.quiet(50);
    assert!(close(setpoint(&mut open), 0.3));
    open.speed = Some(-0.069);
    let mut slow = open.clone();
    assert!(close(setpoint(&mut slow), 0.301));
    for step in 2..=100 {
        assert!(
            close(setpoint(&mut slow), 0.3 + 0.001 * f64::from(step)),
            "{step}"
        );
    }
    for _ in 0..600 {
        setpoint(&mut slow);
    }
    assert!(close(setpoint(&mut slow), 0.92));
}

// --- Slopes ---

/// On a slope of 0.3 rad.
fn on_slope(mut open: OpenLoop, slip: f64, speed: f64) -> OpenLoop {
    open.pitch = Some(-0.3);
    open.speed = Some(speed);
    open.each(|wheel| wheel.slip = Some(slip));
    open
}

/// A robot on a slope of 0.3 rad, long enough for the tilt to be known, that has begun to dig and to traverse.
fn traverse(settings: &ControlSettings) -> (OpenLoop, f64) {
    let mut open = OpenLoop::new(settings);
    open.pitch = Some(-0.3);
    open.request.speed = 0.0;
    open.quiet(6000);
    open.request.speed = SPEED_M_PER_S;
    open.speed = Some(0.01);
    open.each(|wheel| wheel.slip = Some(0.7));
    let (steps, decision) = open.until(Action::Traverse, Reason::DiggingIn);
    // stuck for `dig_time`; the smoothed slip of 0.1 must have risen above 0.5
    let slip = 0.1 + smoothed(0.6, 1.0, steps);
    assert!(slip > 0.5);
    assert!(close(decision.value, slip) && close(decision.limit, settings.dig_slip));
    assert_eq!(open.controller.mode(), Mode::Traverse);
    (open, slip)
}

#[test]
fn a_robot_that_fails_on_a_slope_crosses_it() {
    let (mut open, _) = traverse(&settings());
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.8);
    open.each(|wheel| wheel.slip = Some(0.2));
    // to the left at 0.8 rad for 3 m, then to the other side
    assert!(close(open.step().heading, 0.8));
    let (steps, decision) = open.until(Action::SwitchSide, Reason::LegCompleted);
    assert!(at(steps, 1499), "{steps}");
    assert!((decision.value - 3.0).abs() < 0.0021 && close(decision.limit, 3.0));
    open.heading = Some(-0.8);
    assert!(close(open.step().heading, -0.8));
    let (steps, _) = open.until(Action::SwitchSide, Reason::LegCompleted);
    assert!(at(steps, 1499), "{steps}");
    open.heading = Some(0.8);
    assert!(close(open.step().heading, 0.8));
    // a leg at whose end the slope is less steep than 0.09 rad is the last one
    open.pitch = Some(0.07);
    let (steps, decision) = open.until(Action::Resume, Reason::SlopeGentle);
    assert!(at(steps, 1499), "{steps}");
    assert!((decision.value - 0.07).abs() < 1e-6 && close(decision.limit, 0.05));
    assert_eq!(open.controller.mode(), Mode::Forward);
}

/// At rest it stands on the slope already, however slowly the tilt is smoothed.
#[test]
fn a_robot_that_begins_on_a_slope_crosses_it() {
    let mut open = OpenLoop::new(&settings());
    // above 0.09 rad by less than what a tilt that is smoothed from 0 lacks after 2.6 s of digging
    open.pitch = Some(-0.095);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::Traverse, Reason::DiggingIn);
}

#[test]
fn a_gentle_slope_ends_a_leg_early() {
    // below 0.05 rad from 0.3 of the length on: 0.9 m
    let (mut open, _) = traverse(&settings());
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.8);
    open.each(|wheel| wheel.slip = Some(0.2));
    open.pitch = Some(0.0);
    let (steps, _) = open.until(Action::Resume, Reason::SlopeGentle);
    assert!(at(steps, 450), "{steps}");
    // later than 0.9 m: as soon as the smoothed tilt of 0.3 rad is below 0.05
    let (mut open, _) = traverse(&settings());
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.8);
    open.each(|wheel| wheel.slip = Some(0.2));
    open.quiet(600);
    open.pitch = Some(0.0);
    let (steps, decision) = open.until(Action::Resume, Reason::SlopeGentle);
    let expected = first(|n| 0.3 - smoothed(0.3, 1.0, n) < 0.05);
    assert_eq!(steps, expected);
    assert!((decision.value - (0.3 - smoothed(0.3, 1.0, steps))).abs() < 1e-6);
}

#[test]
fn on_the_level_nothing_is_crossed_and_after_an_attempt_neither() {
    // level: it backs out after twice the time
    let mut open = with_slip(0.7);
    open.speed = Some(0.01);
    assert!(at(open.until(Action::BackOut, Reason::NoProgress).0, 299));
    // a slope, but a slip that is not high: the same
    let mut open = on_slope(OpenLoop::new(&settings()), 0.49, 0.01);
    open.step();
    assert!(at(open.until(Action::BackOut, Reason::NoProgress).0, 299));
    // and then, on a slope, back by 0.8 m and across it; the first try at three quarters of the angle
    open.each(|wheel| wheel.slip = Some(0.2));
    open.speed = Some(-0.1);
    let (steps, decision) = open.until(Action::Traverse, Reason::BackedOut);
    assert!(at(steps, 800), "{steps}");
    assert!((decision.value - 0.8).abs() < 0.0011 && close(decision.limit, 0.8));
    assert!(close(open.step().heading, 0.6));
    // a turn that takes more than 12 s is given up: back, and then the other way, a quarter wider
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.0);
    let (steps, decision) = open.until(Action::BackOut, Reason::NoProgress);
    assert!(at(steps, 1199), "{steps}");
    assert!((decision.value - 12.0).abs() < 0.011 && close(decision.limit, 12.0));
    open.speed = Some(-0.1);
    assert!(at(open.until(Action::Traverse, Reason::BackedOut).0, 800));
    assert!(close(open.step().heading, -0.8));
    // turning is counted anew once it is on its course, 0.35 rad
    open.speed = Some(0.05);
    open.heading = Some(0.0);
    open.quiet(1000);
    open.heading = Some(-0.46);
    open.quiet(1);
    open.heading = Some(-0.44);
    open.quiet(1190);
}

#[test]
fn a_turn_that_is_given_up_with_the_last_attempt_ends_the_drive() {
    let mut settings = settings();
    settings.max_attempts = 1;
    let (mut open, _) = traverse(&settings);
    open.speed = Some(SPEED_M_PER_S);
    open.each(|wheel| wheel.slip = Some(0.2));
    let (steps, decision) = open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
    assert!(at(steps, 1200), "{steps}");
    assert!(close(decision.limit, 12.0));
}

#[test]
fn a_traverse_whose_slip_stays_high_widens() {
    let mut settings = settings();
    settings.traverse_angle = 0.6;
    let (mut open, slip) = traverse(&settings);
    open.speed = Some(SPEED_M_PER_S);
    open.each(|wheel| wheel.slip = Some(0.75));
    open.heading = Some(0.6);
    // high for 2 s, counted after the mode's first second; above the middle of 0.5 and 0.8
    let (steps, decision) = open.until(Action::Traverse, Reason::SlipHigh);
    assert!(at(steps, 299), "{steps}");
    assert!(close(
        decision.value,
        slip + smoothed(0.75 - slip, 1.0, steps)
    ));
    assert!(close(decision.limit, 0.65));
    assert!(close(open.step().heading, 0.75));
    // again after another 2 s, to 0.8 rad at most, and then no more
    let mut accepted = 0;
    for _ in 0..1000 {
        if let Some(decision) = open.step().decision {
            match decision.action {
                Action::AcceptSlip => accepted += 1,
                Action::Traverse => break,
                _ => panic!("{decision}"),
            }
        }
    }
    assert!(accepted <= 1);
    assert!(close(open.step().heading, 0.8));
    for _ in 0..600 {
        assert!(
            open.step()
                .decision
                .is_none_or(|d| d.action == Action::AcceptSlip)
        );
    }
    // a slip between the limits does not widen
    let (mut open, _) = traverse(&settings);
    open.speed = Some(SPEED_M_PER_S);
    open.heading = Some(0.6);
    open.each(|wheel| wheel.slip = Some(0.6));
    for _ in 0..1000 {
        assert!(
            open.step()
                .decision
                .is_none_or(|d| d.action == Action::AcceptSlip)
        );
    }
}

// --- Slip that is accepted ---

#[test]
fn a_steady_slip_is_accepted_and_later_no_longer_needed() {
    for slip in [0.4, 0.7] {
        let mut open = with_slip(slip);
        let (steps, decision) = open.until(Action::AcceptSlip, Reason::Demanded);
        // smoothed over one and over four seconds it differs by less than 0.03, for 2.5 s
        let still = |n: usize| smoothed(slip, 1.0, n) - smoothed(slip, 4.0, n) < 0.03;
        let rising = first(|n| !still(n) && smoothed(slip, 1.0, n) > 0.32);
        let expected = rising + first(|n| still(rising + n)) + 250;
        assert!(at(steps, expected), "{slip}: {steps}, not {expected}");
        assert!(close(decision.value, smoothed(slip, 1.0, steps)) && close(decision.limit, 0.3));
        assert_eq!(open.controller.mode(), Mode::Forward);
        // it is at its new setpoint, which leaves 0.06 more
        open.quiet(1000);
        // a slip below the optimum for 2.5 s
        open.each(|wheel| wheel.slip = Some(0.1));
        let from = open.clone().run(1).slip;
        assert!((from - slip).abs() < 0.02);
        let (steps, decision) = open.until(Action::Resume, Reason::SlipRegained);
        let below = first(|n| slip - smoothed(slip - 0.1, 1.0, n) < 0.3);
        assert!(
            (steps as f64 - (below + 250) as f64).abs() <= 3.0,
            "{slip}: {steps}, not {below} + 250"
        );
        assert!(close(decision.limit, 0.3) && decision.value < 0.3);
        // once
        open.quiet(600);
    }
    // within 0.02 of the optimum there is nothing to accept; above 0.92 nothing is
    let mut open = with_slip(0.319);
    open.quiet(3000);
}

#[test]
fn an_accepted_or_demanded_slip_is_the_wheels_setpoint() {
    let settings = limiting();
    let setpoint = |open: &mut OpenLoop| rim_slip(open, 0.01);
    // what soil and slope demand, with 0.06 of room, at most 0.92
    for (mean, expected) in [
        (0.5, 0.56),
        (0.2, 0.3),
        (0.9, 0.92),
        (-0.5, 0.3),
        (f64::NAN, 0.3),
    ] {
        let mut open = OpenLoop::new(&settings);
        open.step();
        open.slip_demand = Some(SlipPrior { mean, sigma: 0.02 });
        assert!(close(setpoint(&mut open), expected), "{mean}");
    }
    // accepted: 0.06 more than the slip
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.5), Some(1.0)));
    open.step();
    let (_, decision) = open.until(Action::AcceptSlip, Reason::Demanded);
    assert!(close(setpoint(&mut open), decision.value + 0.06));
}

// --- Soft ground ---

/// Level ground that is known to take a slip of 0.1 ± `sigma`, driven over for ten seconds.
fn known(sigma: f64) -> OpenLoop {
    on_known(OpenLoop::new(&settings()), 0.1, sigma)
}

fn on_known(mut open: OpenLoop, mean: f64, sigma: f64) -> OpenLoop {
    open.slip_demand = Some(SlipPrior { mean, sigma });
    open.step();
    open.quiet(1000);
    open
}

#[test]
fn ground_that_takes_much_more_slip_than_the_known_soil_is_left() {
    // above 0.1 by 0.12 or by two sigma of demand and slip; smoothed over 0.2 s; for 0.3 s
    for (sigma, slip_sigma, slip, limit) in [
        (0.02, 0.0, 0.3, 0.22),
        (0.1, 0.0, 0.4, 0.3),
        (0.03, 0.04, 0.3, 0.22),
        (0.06, 0.08, 0.4, 0.3),
        (0.0, 0.1, 0.4, 0.3),
        (0.1, 0.0, 0.29, f64::INFINITY),
        (0.06, 0.08, 0.29, f64::INFINITY),
        (0.02, 0.0, 0.219, f64::INFINITY),
    ] {
        let mut open = known(sigma);
        open.each(|wheel| (wheel.slip, wheel.sigma) = (Some(slip), Some(slip_sigma)));
        if limit.is_infinite() {
            open.quiet(500);
            continue;
        }
        let (steps, decision) = open.until(Action::BackOut, Reason::SoftGround);
        let expected = first(|n| 0.1 + smoothed(slip - 0.1, 0.2, n) > limit) + 29;
        assert!(at(steps, expected), "{slip}: {steps}, not {expected}");
        assert!((decision.value - (0.1 + smoothed(slip - 0.1, 0.2, steps))).abs() < 1e-6);
        assert!(close(decision.limit, limit));
    }
    // no slip below half of the optimum is soft
    let mut open = OpenLoop::new(&settings());
    open.slip_demand = Some(SlipPrior {
        mean: 0.0,
        sigma: 0.01,
    });
    open.each(|wheel| wheel.slip = Some(0.0));
    open.step();
    open.quiet(1000);
    open.each(|wheel| wheel.slip = Some(0.149));
    open.quiet(500);
    open.each(|wheel| wheel.slip = Some(0.2));
    let (_, decision) = open.until(Action::BackOut, Reason::SoftGround);
    assert!(close(decision.limit, 0.15));
    // a demand that is none demands nothing
    let mut open = known(f64::NAN);
    open.each(|wheel| wheel.slip = Some(0.3));
    open.quiet(300);
}

#[test]
fn it_backs_out_by_how_far_it_is_in_soft_ground_and_drives_round_the_softer_side() {
    // entered from 0.4 of the margin on: 0.148. Left wheels slip more: the right side is firmer
    for (softer_left, side) in [(true, -1.0), (false, 1.0)] {
        let mut open = known(0.02);
        let slips = if softer_left {
            [0.4, 0.2, 0.4, 0.2]
        } else {
            [0.2, 0.4, 0.2, 0.4]
        };
        for (wheel, slip) in open.wheels.iter_mut().zip(slips) {
            wheel.slip = Some(slip);
        }
        let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
        let entered = first(|n| 0.1 + smoothed(0.2, 0.2, n) > 0.148);
        let depth = (steps + 1 - entered) as f64 * STEP_S * SPEED_M_PER_S;
        open.each(|wheel| wheel.slip = Some(0.1));
        let (steps, angle, _) = back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
        let length = 1.0 + depth;
        assert!(
            at(steps, (length / 0.001).round() as usize),
            "{steps} for {length} m"
        );
        assert!(close(angle, side * 1.2), "{angle}");
        // aside to that side
        open.heading = Some(side * 1.2);
        open.speed = Some(SPEED_M_PER_S);
        let (steps, _) = open.until(Action::Resume, Reason::ClearedSoftGround);
        assert!((steps as f64 - 2.2 / (1.2_f64.sin() * SPEED_M_PER_S * STEP_S)).abs() <= 1.0);
    }
    // sides that differ by less than 0.015 do not tell: to the left
    for (difference, side) in [(0.014, 1.0), (0.02, -1.0)] {
        let mut open = known(0.02);
        for (wheel, left) in open.wheels.iter_mut().zip([0.5, -0.5, 0.5, -0.5]) {
            wheel.slip = Some(0.4 + left * difference);
        }
        open.until(Action::BackOut, Reason::SoftGround);
        open.each(|wheel| wheel.slip = Some(0.1));
        assert!(close(
            back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut)).1,
            side * 1.2
        ));
    }
}

#[test]
fn ground_that_takes_little_torque_is_soft_if_two_wheels_say_so() {
    // (firmness of the wheels): what the ground's is, 1 where it is not soft
    for (firmness, expected) in [
        ([0.5, 0.5, 1.0, 1.0], Some(0.5)),
        // one wheel counts only as far as the next one is 0.15 firmer
        ([0.3, 0.7, 1.0, 1.0], Some(0.55)),
        ([0.3, 0.9, 1.0, 1.0], None),
        ([1.0, 0.7, 0.3, 0.9], Some(0.55)),
        ([0.66, 0.66, 0.66, 0.66], None),
        ([0.65, 0.65, 0.65, 0.65], None),
    ] {
        let mut open = known(0.02);
        for (wheel, firmness) in open.wheels.iter_mut().zip(firmness) {
            wheel.firmness = Some(firmness);
        }
        if let Some(expected) = expected {
            let (steps, decision) = open.until(Action::BackOut, Reason::SoftGround);
            assert!(at(steps, 30), "{firmness:?}: {steps}");
            assert!(
                close(decision.value, expected) && close(decision.limit, 0.65),
                "{decision}"
            );
        } else {
            open.quiet(300);
        }
    }
    // time in soft ground is counted back, not forgotten: 20 of 30 steps, 10 back, then 20 more
    let mut open = known(0.02);
    open.each(|wheel| wheel.firmness = Some(0.5));
    open.quiet(20);
    open.each(|wheel| wheel.firmness = Some(1.0));
    open.quiet(10);
    open.each(|wheel| wheel.firmness = Some(0.5));
    assert!(at(open.until(Action::BackOut, Reason::SoftGround).0, 20));
    // the softer side is passed on the firmer one
    let mut open = known(0.02);
    for (wheel, firmness) in open.wheels.iter_mut().zip([0.5, 0.55, 0.5, 0.55]) {
        wheel.firmness = Some(firmness);
    }
    open.until(Action::BackOut, Reason::SoftGround);
    open.each(|wheel| wheel.firmness = Some(1.0));
    assert!(close(
        back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut)).1,
        -1.2
    ));
}

#[test]
fn nothing_is_said_of_the_ground_while_a_powered_wheel_stands_or_has_lost_its_torque() {
    let soft = |change: fn(&mut [WheelObservation; 4])| {
        let mut open = known(0.02);
        open.each(|wheel| wheel.firmness = Some(0.3));
        change(&mut open.wheels);
        let last = (0..60).find_map(|_| open.step().decision);
        last.is_some_and(|decision| decision.reason == Reason::SoftGround)
    };
    assert!(soft(|_| ()));
    // slower than a fifth of the mean: 0.03 of (0.03 + 3 · 0.2)/4
    assert!(!soft(|wheels| wheels[2].rim_speed = Some(0.03)));
    assert!(soft(|wheels| wheels[2].rim_speed = Some(0.033)));
    // at the share itself, here of nothing, it turns
    assert!(soft(|wheels| wheels
        .iter_mut()
        .for_each(|wheel| wheel.rim_speed = Some(0.0))));
    // one that runs and pushes backwards turns too
    assert!(soft(|wheels| (
        wheels[2].rim_speed,
        wheels[2].torque_share
    ) = (Some(-0.2), Some(-0.3))));
    assert!(!soft(|wheels| wheels[2].rim_speed = None));
}

#[test]
fn a_wheel_whose_torque_returns_says_nothing_of_the_ground() {
    let mut open = known(0.02);
    open.wheels[2].rim_speed = Some(0.0);
    open.wheels[2].torque_share = Some(0.9);
    open.until(Action::ShedTorque, Reason::Stall);
    open.wheels[2].rim_speed = Some(SPEED_M_PER_S);
    open.wheels[2].torque_share = Some(0.3);
    // within 1.8 s its share of the torque is whole again
    open.each(|wheel| wheel.firmness = Some(0.3));
    let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
    assert!(at(steps, 180 + 30), "{steps}");
    // and then its firmness counts: it is one of two
    for returning in [false, true] {
        let mut open = known(0.02);
        if returning {
            open.wheels[2].motion = Some(grouser_slip::Motion::Stall);
            open.until(Action::ShedTorque, Reason::Stall);
            open.wheels[2].motion = Some(grouser_slip::Motion::Driving);
        }
        open.wheels[2].firmness = Some(0.3);
        open.wheels[3].firmness = Some(0.3);
        let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
        assert!(at(steps, if returning { 210 } else { 30 }), "{steps}");
    }
}

#[test]
fn soil_is_judged_once_it_is_sheared() {
    // from rest: a second of driving on course, a quarter of a metre at more than 0.02 m/s, then 0.3 s
    let rolls = |speed: f64| {
        let mut open = OpenLoop::new(&settings());
        open.slip_demand = Some(SlipPrior {
            mean: 0.1,
            sigma: 0.01,
        });
        open.each(|wheel| wheel.firmness = Some(0.3));
        open.speed = Some(speed);
        // so slow a robot is not stuck where its rims hardly turn
        open.request.speed = speed;
        open.each(|wheel| wheel.rim_speed = Some(speed));
        open.step();
        (0..3000_usize).find(|_| open.step().decision.is_some())
    };
    assert!(rolls(0.05).is_some_and(|step| step.abs_diff(500 + 29) <= 1));
    assert!(
        rolls(0.2).is_some_and(|step| step.abs_diff(125 + 29) <= 1),
        "{:?}",
        rolls(0.2)
    );
    assert!(
        rolls(0.5).is_some_and(|step| step.abs_diff(100 + 28) <= 1),
        "{:?}",
        rolls(0.5)
    );
    assert!(rolls(0.02).is_some());
    assert_eq!(rolls(0.0199), None);
    // on a slope the known soil is not compared
    let mut open = known(0.02);
    open.pitch = Some(0.1);
    open.quiet(600);
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.quiet(600);
    // nor soon after a slope: the tilt is also smoothed over four seconds
    let mut open = known(0.02);
    open.pitch = Some(0.3);
    open.quiet(6000);
    open.pitch = Some(0.0);
    open.each(|wheel| wheel.firmness = Some(0.3));
    let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
    let level = first(|n| 0.3 - smoothed(0.3, 4.0, n) < 0.09);
    assert!(at(steps, level + 29), "{steps}, not {level} + 29");
    // nor off the course or without a request
    let mut open = known(0.02);
    open.heading = Some(0.4);
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.quiet(300);
    let mut open = known(0.02);
    open.request.speed = 0.0;
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.quiet(300);
}

#[test]
fn soft_ground_everywhere_ends_the_drive_where_it_stands() {
    let mut settings = settings();
    settings.max_attempts = 2;
    let mut open = OpenLoop::new(&settings);
    open.step();
    for _ in 0..2 {
        open.heading = Some(0.0);
        open.speed = Some(SPEED_M_PER_S);
        open.each(|wheel| wheel.firmness = Some(0.3));
        open.until(Action::BackOut, Reason::SoftGround);
        open.each(|wheel| wheel.firmness = Some(1.0));
        let (_, angle, _) = back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
        open.speed = Some(SPEED_M_PER_S);
        open.heading = Some(angle);
        open.until(Action::Resume, Reason::ClearedSoftGround);
    }
    open.heading = Some(0.0);
    open.each(|wheel| wheel.firmness = Some(0.3));
    let (_, decision) = open.until(Action::End(Ending::NoWay), Reason::SoftGround);
    assert!(close(decision.value, 0.3) && close(decision.limit, 0.65));
    assert_eq!(open.controller.mode(), Mode::Stopped);
}

// --- Requests ---

#[test]
fn a_yaw_rate_holds_the_course_that_the_robot_had() {
    let mut settings = settings();
    settings.max_turn = 0.5;
    let mut open = OpenLoop::new(&settings);
    open.request = Request {
        speed: SPEED_M_PER_S,
        heading: 2.0,
        yaw_rate: Some(0.3),
    };
    open.heading = Some(0.7);
    open.step();
    let last = open.step();
    assert!(
        close(last.heading, 0.7)
            && close(motion(&open).1, 0.3)
            && close(motion(&open).0, SPEED_M_PER_S)
    );
    // a heading that is lost is the last one
    open.heading = None;
    assert!(close(open.step().heading, 0.7));
    // while it backs out it holds the course and does not turn by itself
    open.heading = Some(0.9);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
    let last = open.step();
    assert!(close(last.heading, 0.9) && close(motion(&open).1, 0.0));
    // a turn on the spot
    let mut open = OpenLoop::new(&settings);
    open.request = Request {
        speed: 0.0,
        heading: 0.0,
        yaw_rate: Some(-0.2),
    };
    open.step();
    open.step();
    assert!(close(motion(&open).0, 0.0) && close(motion(&open).1, -0.2));
}

#[test]
fn a_request_without_numbers_to_drive_by_stops_the_robot_and_says_so_once() {
    let of = |speed, heading, yaw_rate| Request {
        speed,
        heading,
        yaw_rate,
    };
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    for (request, count) in [
        (of(nan, 0.0, None), 1.0),
        (of(infinite, 0.0, None), 1.0),
        (of(0.2, nan, None), 1.0),
        (of(0.2, -infinite, None), 1.0),
        (of(0.2, 1.1e6, None), 1.0),
        (of(nan, nan, None), 2.0),
        (of(0.2, 0.0, Some(nan)), 1.0),
        (of(nan, nan, Some(infinite)), 2.0),
    ] {
        let mut open = with_slip(0.1);
        open.heading = Some(0.7);
        open.request = request;
        let (steps, decision) = open.until(Action::Stand, Reason::InvalidRequest);
        assert_eq!((steps, decision.value, decision.limit), (1, count, 0.0));
        open.quiet(300);
        assert_eq!(
            (motion(&open), open.controller.mode()),
            ((0.0, 0.0), Mode::Forward)
        );
        // it drives on by the next one that is valid, and says again where one is not
        open.request = of(SPEED_M_PER_S, 0.7, None);
        open.quiet(100);
        assert!(close(motion(&open).0, SPEED_M_PER_S));
        open.request = request;
        open.until(Action::Stand, Reason::InvalidRequest);
    }
    // a heading that does not count may be none
    let mut open = with_slip(0.1);
    open.request = of(SPEED_M_PER_S, nan, Some(0.0));
    open.quiet(100);
    assert!(close(motion(&open).0, SPEED_M_PER_S));
}

#[test]
fn fast_robots_have_the_time_in_which_their_rims_reverse_to_back_out() {
    // 20 m/s is the rims' limit: 8 · 1 m over it are 0.4 s, and reversing twice 40 m/s at 100 m/s² are 0.8 s
    for requested in [1e300, 100.0, 29.0] {
        let mut open = with_slip(0.1);
        open.request.speed = requested;
        dig(&mut open);
        let end = (Action::End(Ending::Immobilised), Reason::NoProgress);
        let (steps, value, limit) = back_out(&mut open, 0.0051, end);
        assert!(at(steps, 80), "{requested}: {steps}");
        assert!(value > limit && close(limit, 0.8), "{value}, limit {limit}");
    }
}

#[test]
fn what_decides_nothing_never_stops() {
    let mut settings = settings();
    settings.decides = Decides::Nothing;
    let mut open = OpenLoop::new(&settings);
    open.step();
    open.roll = Some(1.0);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.quiet(500);
    open.speed = None;
    open.quiet(500);
    assert_eq!(open.controller.mode(), Mode::Forward);
}

#[test]
fn decisions_of_one_moment_are_reported_one_a_step_in_their_order() {
    let mut settings = settings();
    settings.limits_slip = true;
    let mut open = OpenLoop::new(&settings);
    open.step();
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.8), Some(0.01)));
    open.quiet(49);
    for wheel in 0..4 {
        let decision = open.step().decision.unwrap();
        assert_eq!(
            (decision.wheel, decision.reason),
            (Some(wheel), Reason::SlipHigh)
        );
        assert_eq!(decision.time_ns, open.time_ns);
        assert_eq!(
            decision.to_string(),
            "reduce torque: slip is high (0.800, limit 0.300)"
        );
    }
    assert!(open.step().decision.is_none());
}

#[test]
fn every_mode_is_named_after_its_variant_and_in_python() {
    let python = include_str!("../../../python/python/grouser/slip.py");
    for mode in Mode::ALL {
        assert_eq!(mode.name(), format!("{mode:?}"));
        let is_listed = python.contains(&format!("`{}`", mode.name()));
        assert!(is_listed, "{mode:?} is not in slip.py");
    }
}

#[test]
fn names_are_distinct() {
    use std::collections::BTreeSet;
    let endings = [
        Ending::Immobilised,
        Ending::Tipping,
        Ending::SensorsLost,
        Ending::NoWay,
    ];
    let actions = [
        Action::ReduceTorque,
        Action::RaiseTorque,
        Action::AcceptSlip,
        Action::ShedTorque,
        Action::Traverse,
        Action::SwitchSide,
        Action::BackOut,
        Action::Detour,
        Action::Resume,
        Action::Stand,
    ];
    let reasons = [
        Reason::SlipHigh,
        Reason::SlipUnknown,
        Reason::SlipRegained,
        Reason::Demanded,
        Reason::SoftGround,
        Reason::ClearedSoftGround,
        Reason::DiggingIn,
        Reason::NoProgress,
        Reason::SlopeGentle,
        Reason::LegCompleted,
        Reason::BackedOut,
        Reason::AttemptsUsed,
        Reason::TiltHigh,
        Reason::SensorTimeout,
        Reason::Stall,
        Reason::EncoderReversed,
        Reason::InvalidRequest,
    ];
    let all = (actions.iter().map(|a| a.name()))
        .chain(endings.iter().map(|ending| Action::End(*ending).name()))
        .chain(reasons.iter().map(|r| r.name()));
    let names: Vec<&str> = all.collect();
    let distinct: BTreeSet<&&str> = names.iter().collect();
    assert_eq!(distinct.len(), names.len());
    assert!(names.iter().all(|name| name.len() > 4));
}

// --- Limits themselves ---

/// Times and ways in steps of 1/64 s, whose sums are exact, with limits of time that are multiples of it.
fn exact_settings() -> ControlSettings {
    let mut settings = settings();
    (
        settings.dig_time,
        settings.high_slip_time,
        settings.soft_time,
    ) = (0.5, 0.5, 0.5);
    (settings.traverse_length, settings.back_length) = (2.0, 0.5);
    (settings.blind_time, settings.soft_across) = (0.5, 2.0);
    settings
}

/// An open loop of such steps.
fn exact_loop(settings: &ControlSettings) -> OpenLoop {
    let mut open = OpenLoop::new(settings);
    open.period_ns = 15_625_000;
    open
}

fn exact() -> OpenLoop {
    let mut open = exact_loop(&exact_settings());
    open.step();
    open
}

/// A robot that stands on the slope, spins its wheels and begins to traverse.
fn standing_traverse(mut open: OpenLoop) -> OpenLoop {
    open = on_slope(open, 0.7, 0.0);
    open.until(Action::Traverse, Reason::DiggingIn);
    open
}

#[test]
fn limits_of_time_and_way_are_inclusive_and_those_of_silence_and_turning_are_not() {
    // the mode's first second, then half a second of digging: 64 + 31 steps
    let mut open = exact();
    open.request.speed = 0.0;
    open.each(|wheel| wheel.slip = Some(1.0));
    open.quiet(400);
    open.request.speed = SPEED_M_PER_S;
    assert_eq!(open.until(Action::BackOut, Reason::DiggingIn).0, 32);
    // back by a metre, 1/1024 m a step
    open.each(|wheel| wheel.slip = Some(0.1));
    open.speed = Some(-0.0625);
    assert_eq!(open.until(Action::Detour, Reason::BackedOut).0, 1024);
    // and aside by 2 m: straight across, 1/32 m a step of exactly sin π/2
    open.heading = Some(std::f64::consts::FRAC_PI_2);
    open.speed = Some(2.0);
    let (steps, decision) = open.until(Action::Resume, Reason::ClearedSoftGround);
    assert_eq!((steps, decision.value), (64, 2.0));
    // a second after the start, not later
    let mut open = exact();
    open.speed = Some(0.0);
    assert_eq!(open.until(Action::BackOut, Reason::NoProgress).0, 64 + 63);
    // firmness
    let mut open = exact();
    open.quiet(200);
    open.each(|wheel| wheel.firmness = Some(0.3));
    let (steps, decision) = open.until(Action::BackOut, Reason::SoftGround);
    assert_eq!((steps, decision.limit), (32, 0.65));
    // soil is sheared by more than a quarter of a metre: 64 steps of 1/256 m are not enough, 32 more are counted
    let mut open = exact();
    open.speed = Some(0.25);
    open.each(|wheel| wheel.firmness = Some(0.3));
    assert_eq!(open.until(Action::BackOut, Reason::SoftGround).0, 64 + 32);
    // the same of a slip above what is demanded
    let mut open = exact();
    open.speed = Some(0.25);
    open.slip_demand = Some(SlipPrior {
        mean: 0.1,
        sigma: 0.02,
    });
    open.each(|wheel| wheel.slip = Some(0.3));
    assert_eq!(open.until(Action::BackOut, Reason::SoftGround).0, 64 + 32);
    // a slip that is steady for more than 2.5 s, and one that is low for more than that: the 161st step
    let mut open = exact();
    open.each(|wheel| wheel.slip = Some(0.5));
    let kept = |time_s: f64, n: usize| (1.0 + 1.0 / (64.0 * time_s)).powf(-(n as f64));
    let gap = |n: usize| 0.5 * (kept(4.0, n) - kept(1.0, n));
    let still = first(|n| gap(n) < 0.03 && n > 64 && 0.5 * (1.0 - kept(1.0, n)) > 0.32);
    assert_eq!(
        open.until(Action::AcceptSlip, Reason::Demanded).0,
        still + 160
    );
    open.quiet(2000);
    open.each(|wheel| wheel.slip = Some(0.1));
    let low = first(|n| 0.1 + 0.4 * kept(1.0, n) < 0.3);
    assert_eq!(
        open.until(Action::Resume, Reason::SlipRegained).0,
        low + 160
    );
    // half a second of silence is not more than half a second
    let mut open = exact();
    open.speed = None;
    let (steps, decision) = open.until(Action::End(Ending::SensorsLost), Reason::SensorTimeout);
    assert_eq!((steps, decision.value), (33, 33.0 / 64.0));
}

#[test]
fn limits_of_time_and_way_on_a_slope_and_while_backing_out_are_exact_too() {
    // a leg of 2 m on a slope, and a turn that takes more than 12 s
    let mut open = standing_traverse(exact());
    open.each(|wheel| wheel.slip = Some(0.2));
    let mut turning = open.clone();
    assert_eq!(
        turning.until(Action::BackOut, Reason::NoProgress).0,
        12 * 64 + 1
    );
    open.heading = Some(0.8);
    open.speed = Some(0.0625);
    assert_eq!(open.until(Action::SwitchSide, Reason::LegCompleted).0, 2048);
    // a gentle slope from more than 0.3 of 10 m on
    let mut long = exact_settings();
    (long.traverse_length, long.traverse_angle) = (10.0, 0.6);
    let mut open = standing_traverse(exact_loop(&long));
    open.heading = Some(0.6);
    open.speed = Some(0.0625);
    let mut high = open.clone();
    open.each(|wheel| wheel.slip = Some(0.2));
    open.pitch = Some(0.0);
    assert_eq!(open.until(Action::Resume, Reason::SlopeGentle).0, 3073);
    // a high slip for half a second after the mode's first one
    high.each(|wheel| wheel.slip = Some(0.85));
    assert_eq!(high.until(Action::Traverse, Reason::SlipHigh).0, 64 + 31);
    // on a slope, half a second of digging or of standing
    for (slip, speed) in [(0.95, SPEED_M_PER_S), (0.7, 0.0)] {
        let mut open = exact();
        open.pitch = Some(-0.3);
        open.request.speed = 0.0;
        open.each(|wheel| wheel.slip = Some(slip));
        open.quiet(400);
        (open.request.speed, open.speed) = (SPEED_M_PER_S, Some(speed));
        assert_eq!(open.until(Action::Traverse, Reason::DiggingIn).0, 32);
    }
    // standing for more than 10 s while it backs out; backing out for more than 8 · 1 m over 0.125 m/s
    let mut slow = exact_settings();
    slow.back_speed = 0.5;
    for (speed, steps) in [(0.0, 640), (-0.0051, 4096)] {
        let mut open = exact_loop(&slow);
        open.request.speed = 0.25;
        open.step();
        dig(&mut open);
        open.speed = Some(speed);
        let end = Action::End(Ending::Immobilised);
        assert_eq!(open.until(end, Reason::NoProgress).0, steps + 1);
    }
}

#[test]
fn speeds_at_their_limits_are_no_standstill() {
    // a quarter of 0.02 m/s backwards
    let mut open = with_slip(0.1);
    dig(&mut open);
    open.speed = Some(-0.25 * 0.02);
    open.quiet(1100);
    // half of the speed of backing out is not slow: no more slip is allowed
    let mut open = backing_out();
    open.speed = Some(-(0.5 * (0.7 * SPEED_M_PER_S)));
    open.quiet(100);
    assert!(close(rim_slip(&mut open, -0.01), 0.3));
    // while nothing is requested it has no direction: backwards is backwards
    let mut open = with_slip(0.1);
    dig(&mut open);
    open.request.speed = 0.0;
    open.speed = Some(-0.1);
    assert!(at(open.until(Action::Detour, Reason::BackedOut).0, 1000));
}

#[test]
fn backing_out_before_a_traverse_has_its_own_time() {
    // eight times 0.8 m over 0.14 m/s, on a slope
    let mut open = on_slope(OpenLoop::new(&settings()), 0.3, 0.01);
    open.step();
    open.until(Action::BackOut, Reason::NoProgress);
    open.speed = Some(-0.0051);
    let (steps, decision) = open.until(Action::End(Ending::Immobilised), Reason::NoProgress);
    let max_time = 8.0 * 0.8 / (0.7 * SPEED_M_PER_S);
    assert!(at(steps, (max_time / STEP_S).ceil() as usize), "{steps}");
    assert!(close(decision.limit, max_time));
}

#[test]
fn spinning_wheels_on_a_slope_turn_the_robot_aside_too() {
    let mut open = OpenLoop::new(&settings());
    open.pitch = Some(-0.3);
    open.request.speed = 0.0;
    open.each(|wheel| wheel.slip = Some(0.95));
    open.step();
    open.quiet(6000);
    open.request.speed = SPEED_M_PER_S;
    let (steps, _) = open.until(Action::Traverse, Reason::DiggingIn);
    assert!(at(steps, 100), "{steps}");
}

#[test]
fn a_detour_is_measured_across_the_requested_heading() {
    let mut open = with_slip(0.1);
    open.request.heading = 0.5;
    open.heading = Some(0.5);
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
    open.each(|wheel| wheel.slip = Some(0.1));
    back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
    assert!(close(open.step().heading, 1.7));
    open.heading = Some(1.7);
    open.speed = Some(SPEED_M_PER_S);
    let (steps, _) = open.until(Action::Resume, Reason::ClearedSoftGround);
    let needed = 2.2 / (1.2_f64.sin() * SPEED_M_PER_S * STEP_S);
    assert!(at(steps, needed.ceil() as usize), "{steps}, not {needed}");
}

#[test]
fn wheels_in_the_middle_are_on_no_side() {
    use grouser_slip::control::Controller;
    use grouser_slip::{Robot, Wheel};
    let wheels = [
        ("a", 0.3, 0.2),
        ("b", 0.3, -0.2),
        ("c", -0.3, 0.0),
        ("d", -0.4, 0.0),
    ];
    let wheels = wheels.map(|(name, x, y)| {
        Wheel::powered(name)
            .at(x, y)
            .radius(0.1)
            .ticks_per_turn(1000)
            .load(50.0)
    });
    let robot = Robot::new("with a middle".into(), wheels.to_vec()).unwrap();
    // the middle slips more than either side; the left side hardly more, or much more, than the right one
    for (left, right, side) in [(0.3, 0.3, 1.0), (0.33, 0.3, -1.0)] {
        let open = OpenLoop::with(Controller::new(&robot, settings()).unwrap());
        let mut open = on_known(open, 0.1, 0.02);
        for (wheel, slip) in open.wheels.iter_mut().zip([left, right, 0.5, 0.5]) {
            wheel.slip = Some(slip);
        }
        open.until(Action::BackOut, Reason::SoftGround);
        open.each(|wheel| wheel.slip = Some(0.1));
        open.slip_demand = None;
        assert!(close(
            back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut))
                .1
                .signum(),
            side
        ));
    }
}

#[test]
fn where_nothing_counts_as_level_every_ground_is_a_slope() {
    let mut settings = settings();
    (settings.steep, settings.level) = (0.0, 0.0);
    // the known soil is not compared
    let mut open = OpenLoop::new(&settings);
    open.step();
    open.quiet(1000);
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.quiet(300);
    // a slip that rises to 0.88 does not dig
    open.each(|wheel| wheel.slip = Some(0.88));
    open.until(Action::AcceptSlip, Reason::Demanded);
    // one above 0.9 does; the robot backs out by 0.8 m before a traverse
    open.each(|wheel| wheel.slip = Some(1.0));
    open.until(Action::BackOut, Reason::DiggingIn);
    open.each(|wheel| wheel.slip = Some(0.1));
    open.speed = Some(-0.1);
    assert!(at(open.until(Action::Traverse, Reason::BackedOut).0, 800));
    // no slope is ever gentle
    open.each(|wheel| wheel.slip = Some(0.4));
    open.heading = Some(0.6);
    open.speed = Some(SPEED_M_PER_S);
    assert!(at(
        open.until(Action::SwitchSide, Reason::LegCompleted).0,
        1500
    ));
    // and its rims keep `creep` of their speed
    settings.limits_slip = true;
    settings.decides = Decides::Nothing;
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| wheel.forward_speed = Some(0.0));
    open.step();
    assert!(
        close(motion(&open).0, 0.0)
            && close(open.step().commands[0].rim_speed, 0.6 * SPEED_M_PER_S)
    );
}

#[test]
fn backing_out_needs_no_more_slip_than_the_optimum() {
    let mut open = backing_out();
    open.slip_demand = Some(SlipPrior {
        mean: 0.5,
        sigma: 0.1,
    });
    open.speed = Some(-0.1);
    assert!(close(rim_slip(&mut open, -0.01), 0.3));
}

#[test]
fn progress_is_measured_along_the_requested_heading() {
    // 2 m at 1 rad beside it are 1.08 m of progress and forget no attempt; 3 m are 1.62 m and do
    for (metres, forgets) in [(2.0, false), (3.0, true)] {
        let mut settings = settings();
        settings.max_attempts = 1;
        let mut open = OpenLoop::new(&settings);
        open.request.heading = 0.8;
        open.pitch = Some(-0.3);
        open.heading = Some(0.8);
        open.step();
        open.speed = Some(0.01);
        open.each(|wheel| wheel.slip = Some(0.3));
        open.until(Action::BackOut, Reason::NoProgress);
        open.speed = Some(-0.1);
        open.until(Action::Traverse, Reason::BackedOut);
        // 0.6 rad beside the requested heading, and 0.3 rad further
        open.heading = Some(1.7);
        open.speed = Some(SPEED_M_PER_S);
        // the first second of the mode does not count
        open.quiet(
            99 + (metres / (SPEED_M_PER_S * STEP_S)) as usize - 99 * usize::from(metres > 2.5),
        );
        open.speed = Some(0.0);
        if forgets {
            open.until(Action::BackOut, Reason::NoProgress);
        } else {
            open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
        }
    }
    // exactly as much as is needed to forget an attempt does not forget it
    let mut settings = settings();
    settings.max_attempts = 1;
    (settings.dig_time, settings.traverse_angle) = (0.5, 0.3);
    (settings.traverse_length, settings.progress) = (10.0, 1.0);
    let mut open = standing_traverse(exact_loop(&settings));
    open.each(|wheel| wheel.slip = Some(0.2));
    open.quiet(64);
    open.speed = Some(0.0625);
    open.quiet(1024);
    open.speed = Some(0.0);
    open.until(Action::End(Ending::Immobilised), Reason::AttemptsUsed);
}

#[test]
fn a_steady_slip_is_counted_anew_after_a_turn_and_forgotten_where_the_ground_is_soft() {
    let mut open = with_slip(0.5);
    let (steps, _) = open.clone().until(Action::AcceptSlip, Reason::Demanded);
    open.quiet(steps - 10);
    // off its course for a moment, after which 2.5 s count again
    open.heading = Some(0.5);
    open.quiet(1);
    open.heading = Some(0.0);
    let (steps, _) = open.until(Action::AcceptSlip, Reason::Demanded);
    assert!(at(steps, 251), "{steps}");
    // an accepted slip is no setpoint for the way back out of soft ground
    let mut open = OpenLoop::new(&limiting());
    open.each(|wheel| (wheel.slip, wheel.forward_speed) = (Some(0.5), Some(1.0)));
    open.step();
    open.until(Action::AcceptSlip, Reason::Demanded);
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.until(Action::BackOut, Reason::SoftGround);
    open.speed = Some(-0.1);
    assert!(close(rim_slip(&mut open, -0.01), 0.3));
}

#[test]
fn soft_ground_is_judged_anew_after_each_change_of_mode() {
    let mut settings = settings();
    (settings.soft_time, settings.soft_back) = (5.0, 0.05);
    let mut open = OpenLoop::new(&settings);
    open.each(|wheel| wheel.firmness = Some(0.3));
    open.step();
    let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
    assert!(at(steps, 125 + 499), "{steps}");
    back_out(&mut open, 0.1, (Action::Detour, Reason::BackedOut));
    // a quarter of a metre on its new course, and then the whole time again
    open.heading = Some(1.2);
    open.speed = Some(SPEED_M_PER_S);
    let (steps, _) = open.until(Action::BackOut, Reason::SoftGround);
    assert!(at(steps, 125 + 499), "{steps}");
}
