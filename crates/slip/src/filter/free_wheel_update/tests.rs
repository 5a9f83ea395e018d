use super::*;
use crate::filter::kalman::ScalarMeasurement;
use crate::filter::motion_model::along;
use crate::filter::settings::{FilterSettings, SlipPrior};
use crate::robot::{Robot, Wheel};
use crate::sample::Measurement;
use crate::speed::Measured;

pub(in crate::filter) const MS: i64 = 1_000_000;
pub(in crate::filter) const NOW_NS: i64 = 5_000 * MS;
pub(in crate::filter) const POWERED: usize = 0;
pub(in crate::filter) const FREE: usize = 1;
const PRIOR: SlipPrior = SlipPrior {
    mean: -0.2,
    sigma: 0.01,
};
const LOW_SPEED: f64 = 0.02;

/// A robot of one powered and one free wheel, whose reference measured its speed just now; both wheels turn.
pub(in crate::filter) fn core() -> Core {
    let wheels = vec![
        Wheel::powered("drive").at(0.3, 0.1).radius(0.1),
        Wheel::free("fifth").at(-0.3, 0.2).radius(0.1),
    ];
    let settings = FilterSettings {
        free_slip: PRIOR,
        low_speed: LOW_SPEED,
        ..FilterSettings::default()
    };
    let mut core = Core::new(&Robot::new("bicycle".into(), wheels).unwrap(), settings);
    core.now_ns = Some(NOW_NS);
    core.speed_known_ns = Some(NOW_NS);
    for (wheel, rim) in [(POWERED, 0.8), (FREE, 0.5)] {
        let channel = &mut core.wheels.channels[wheel];
        let read = Measurement::WheelRate { wheel, rate: 5.0 };
        channel.track.take(NOW_NS, &read).unwrap();
        turn(&mut core, wheel, rim);
    }
    core
}

/// The rim of a wheel turns at `rim`, m/s, or stands.
pub(in crate::filter) fn turn(core: &mut Core, wheel: usize, rim: f64) {
    let channel = &mut core.wheels.channels[wheel];
    let rim = Measured {
        value: rim,
        variance: 1e-4,
    };
    channel.rim = Some((rim, NOW_NS));
    channel.still_since_ns = (rim.value == 0.0).then_some(NOW_NS);
}

/// A window within the gate, 3 σ off.
const WINDOW: WheelWindow = WheelWindow {
    index: FREE,
    to_ns: NOW_NS,
    rim: 0.5,
    forward: 0.44,
    faster: 0.5,
    innovation: 0.06,
    variance: 4e-4,
    is_off: false,
    has_slip: true,
};
const OFF: WheelWindow = WheelWindow {
    is_off: true,
    ..WINDOW
};

/// A skid of this standard deviation is known.
const KNOWN_SKID_SIGMA: f64 = 0.99 * MAX_SKID_SIGMA;

pub(in crate::filter) fn near(value: f64, expected: f64) -> bool {
    (value - expected).abs() <= 1e-12 * expected.abs()
}

fn variance(core: &Core, i: usize) -> f64 {
    core.state.covariance(i, i)
}

#[test]
fn a_skid_is_estimated_beside_another_reference_and_soon_after_a_jump() {
    /// Far beyond the prior of a skid.
    const SKID_SLIP: f64 = 0.3;
    let after = |accepted: Option<i64>, jumped: Option<i64>| {
        let mut core = core();
        core.state.reset(own_slip(FREE), SKID_SLIP, 1e-6);
        core.reference.accepted_ns = accepted.map(|ago_ns| NOW_NS - ago_ns);
        core.wheels.channels[FREE].rolling.jumped_ns = jumped.map(|ago_ns| NOW_NS - ago_ns);
        core.consider_skid(FREE, NOW_NS);
        let (sigma, jumped) = (
            core.state.sigma(own_slip(FREE)),
            core.wheels.channels[FREE].rolling.jumped_ns,
        );
        core.state.update(&ScalarMeasurement {
            jacobian: &[(own_slip(FREE), 1.0)],
            residual: 1.0,
            variance: 1.0,
        });
        let is_estimated = (core.state.mean(own_slip(FREE)) - SKID_SLIP).abs() > 0.0;
        (is_estimated, jumped.is_some(), sigma)
    };
    // a skid of −0.2 by the robot's speed is −0.25 by the rim's
    let doubt = SKID_AFTER_JUMP_SHARE * (SKID_SLIP + 0.25);
    for (accepted, jumped, expected) in [
        (None, None, (false, false, 1e-3)),
        (Some(500 * MS), None, (true, false, 1e-3)),
        (Some(500 * MS + 1), None, (false, false, 1e-3)),
        (None, Some(299 * MS), (true, true, 1e-3)),
        (Some(100 * MS), Some(299 * MS), (true, true, 1e-3)),
        (None, Some(301 * MS), (false, false, doubt)),
        (Some(100 * MS), Some(301 * MS), (true, false, doubt)),
    ] {
        let (is_estimated, has_jumped, sigma) = after(accepted, jumped);
        assert_eq!(
            (is_estimated, has_jumped),
            (expected.0, expected.1),
            "{accepted:?} {jumped:?}"
        );
        assert!(near(sigma, expected.2), "{accepted:?} {jumped:?}: {sigma}");
    }
}

#[test]
fn a_stop_is_expected_within_two_sigma_of_the_speed_by_the_accelerometer() {
    const BIAS_VARIANCE_M2_PER_S4: f64 = 0.04;
    const PASSED_S: f64 = 0.25;
    const BEFORE: KnownSpeed = KnownSpeed {
        time_ns: NOW_NS - 250 * MS,
        speed: 0.0,
        variance: 9e-4,
        accel_integral: 0.7,
    };
    let stop_expected = |expected: f64, rim: f64| {
        let mut core = core();
        core.state.reset(FORWARD_BIAS, 0.0, BIAS_VARIANCE_M2_PER_S4);
        core.path.advance(PASSED_S, [0.4, 0.0]);
        let speed = expected - (0.4 - BEFORE.accel_integral);
        let rolling = &mut core.wheels.channels[FREE].rolling;
        rolling.turns(KnownSpeed { speed, ..BEFORE });
        turn(&mut core, FREE, rim);
        core.watch_stop(&WINDOW);
        core.wheels.channels[FREE].rolling.stop_expected
    };
    let density = core().process_noise_density();
    let variance =
        9e-4 + density * density * PASSED_S + BIAS_VARIANCE_M2_PER_S4 * PASSED_S * PASSED_S;
    let limit = 2.0 * f64::sqrt(variance) + LOW_SPEED;
    for sign in [-1.0, 1.0] {
        assert!(stop_expected(sign * limit * (1.0 - 1e-9), 0.0));
        assert!(!stop_expected(sign * limit * (1.0 + 1e-9), 0.0));
        assert!(stop_expected(sign * limit * 2.0, 0.5));
    }
    // at the limit to the bit, where nothing has passed since the speed was known
    let mut core = core();
    let rolling = &mut core.wheels.channels[FREE].rolling;
    rolling.turns(KnownSpeed {
        time_ns: NOW_NS,
        speed: 2.0 * f64::sqrt(BEFORE.variance) + LOW_SPEED,
        accel_integral: 0.0,
        ..BEFORE
    });
    turn(&mut core, FREE, 0.0);
    core.watch_stop(&WINDOW);
    assert!(core.wheels.channels[FREE].rolling.stop_expected);
}

#[test]
fn a_turning_wheel_remembers_its_speed_and_a_standing_one_that_it_stands() {
    for (rim, speed) in [(0.5, WINDOW.forward), (0.0, 0.0)] {
        let mut core = core();
        core.state.set_covariance(FORWARD, motion_model::YAW, 0.03);
        core.path.advance(0.1, [0.4, 0.0]);
        turn(&mut core, FREE, rim);
        core.watch_stop(&WINDOW);
        let row = along(core.wheels.channels[FREE].row);
        let known = core.wheels.channels[FREE].rolling.known_before().unwrap();
        assert_eq!(
            (
                known.time_ns,
                known.speed,
                known.variance,
                known.accel_integral
            ),
            (NOW_NS, speed, core.state.variance_of(&row), 0.4)
        );
        // once it has stood, a stop that was not expected stays so
        core.wheels.channels[FREE].rolling.stop_expected = false;
        core.watch_stop(&WINDOW);
        assert_eq!(core.wheels.channels[FREE].rolling.stop_expected, rim > 0.0);
    }
}

/// The monitor of a wheel that failed at `failed_ns`; `agreements` readings before its trust returns, the last of them now.
fn failed(patience_s: f64, agreements: usize) -> crate::filter::monitor::Monitor {
    let mut monitor = crate::filter::monitor::Monitor::default();
    let mut time_ns = NOW_NS - 3_000 * MS;
    while monitor.record(time_ns, false, patience_s) {
        time_ns += 100 * MS;
    }
    let mut history = vec![monitor];
    while !monitor.record(time_ns, true, patience_s) {
        history.push(monitor);
        time_ns += 100 * MS;
    }
    history[history.len() - agreements]
}

#[test]
fn a_wheel_that_showed_a_blocked_robot_restarts_the_motion() {
    let restarts = |is_off: bool, is_blocked: bool, has_slip: bool, rim: f64| {
        let mut core = core();
        core.recovery.is_blocked = is_blocked;
        let accepted = core.accepts_free_window(&WheelWindow {
            rim,
            is_off,
            has_slip,
            ..WINDOW
        });
        let is_restarted = core.state.mean(FORWARD) == rim;
        assert!(!(is_restarted && accepted));
        is_restarted
    };
    // a slip of 0.2 beside powered rims of 0.8 m/s is likely, one of 0.95 is not
    assert!(restarts(true, true, true, 0.64));
    assert!(!restarts(false, true, true, 0.64));
    assert!(!restarts(true, false, true, 0.64));
    assert!(!restarts(true, true, false, 0.64));
    assert!(!restarts(true, true, true, 0.04));
}

#[test]
fn a_window_is_used_where_the_wheel_is_trusted_and_it_agrees() {
    let used = |change: fn(&mut Core), window: &WheelWindow| {
        let mut core = core();
        change(&mut core);
        core.accepts_free_window(window)
    };
    assert!(used(|_| (), &WINDOW) && !used(|_| (), &OFF));
    // a counter that misses pulses is no reference beside a sensor
    assert!(used(
        |core| core.output.checks[FREE].misses_pulses = true,
        &WINDOW
    ));
    assert!(!used(
        |core| {
            core.output.checks[FREE].misses_pulses = true;
            core.reference.accepted_ns = Some(NOW_NS);
        },
        &WINDOW
    ));
    // a wheel that stands counts where its stop was expected
    assert!(used(|core| turn(core, FREE, 0.0), &WINDOW));
    assert!(!used(
        |core| {
            turn(core, FREE, 0.0);
            core.wheels.channels[FREE].rolling.stop_expected = false;
        },
        &WINDOW
    ));
}

#[test]
fn a_failed_wheel_is_readmitted_near_the_others_or_at_any_likely_speed_where_they_are_lost() {
    // the last reading of agreement that was missing; near: within 15 % of 0.5 m/s and the low speed
    let gap = READMIT_SPEED_SHARE * 0.5 + LOW_SPEED;
    let after = |forward: f64, speed_known_ns: Option<i64>, sensor: Option<f64>| {
        let mut core = core();
        core.wheels.channels[FREE].monitor = failed(core.settings.failure, 1);
        core.speed_known_ns = speed_known_ns;
        core.reference.speed = sensor.map(|speed| (speed, NOW_NS));
        core.state.reset(FORWARD, forward, 0.04);
        let window = WheelWindow { forward, ..WINDOW };
        let is_used = core.accepts_free_window(&window);
        let is_trusted = !core.wheels.channels[FREE].monitor.has_failed();
        (
            is_used,
            is_trusted,
            core.state.mean(FORWARD),
            variance(&core, own_slip(FREE)),
        )
    };
    let prior = core();
    let prior = variance(&prior, own_slip(FREE));
    for sign in [-1.0, 1.0] {
        let [near, far] = [1.0 - 1e-9, 1.0 + 1e-9].map(|share| 0.5 + sign * gap * share);
        assert_eq!(after(near, Some(NOW_NS), None), (true, true, near, prior));
        // not near, and the robot's speed is known
        assert_eq!(after(far, Some(NOW_NS), None), (false, false, far, prior));
        // the powered rims allow it
        let (is_used, is_trusted, speed, skid) = after(far, None, None);
        assert!(!is_used && is_trusted && speed == 0.5);
        assert!((skid - 1.5 * 0.01).abs() < 1e-12, "{skid}");
        // and a sensor confirms it
        let skid = after(far, None, Some(0.5)).3;
        assert_eq!(skid, prior);
    }
    // exactly at the limit where nothing moves but the rim; and powered rims of 0.8 m/s do not slip by 0.95
    let at = |rim: f64, speed_known_ns: Option<i64>| {
        let mut core = core();
        core.wheels.channels[FREE].monitor = failed(core.settings.failure, 1);
        core.speed_known_ns = speed_known_ns;
        core.accepts_free_window(&WheelWindow {
            rim,
            forward: 0.0,
            faster: 0.0,
            ..WINDOW
        });
        !core.wheels.channels[FREE].monitor.has_failed()
    };
    assert!(at(LOW_SPEED, Some(NOW_NS)) && !at(2.0 * LOW_SPEED, None));
}

#[test]
fn two_windows_beyond_the_gate_doubt_the_speed_and_a_wheel_that_stays_behind() {
    // the first is none, nor one without slip or of a rim that stands
    let speed_variance = |was_off: bool, window: &WheelWindow| {
        let mut core = core();
        core.state.reset(FORWARD, 0.44, 0.01);
        core.wheels.channels[FREE].was_off = was_off;
        core.accepts_free_window(window);
        assert_eq!(core.wheels.channels[FREE].was_off, window.is_off);
        variance(&core, FORWARD)
    };
    let doubted = 0.01 + WINDOW.innovation * WINDOW.innovation;
    assert!(near(speed_variance(true, &OFF), doubted));
    let slow = WheelWindow {
        has_slip: false,
        ..OFF
    };
    let stands = WheelWindow { rim: 0.0, ..OFF };
    for (was_off, window) in [
        (false, &OFF),
        (true, &WINDOW),
        (true, &slow),
        (true, &stands),
    ] {
        assert_eq!(speed_variance(was_off, window), 0.01);
    }
}

#[test]
fn a_jump_widens_a_skid_by_its_share_of_the_speed() {
    let doubted = 2.1 * 0.015_625 * 0.015_625;
    // innovation, rim and the skid's variance before; the variance after it, and whether it jumped
    for (innovation, rim, before, after, jumps) in [
        (0.06, 0.5, 1e-4, 1e-4, false),
        (0.0, 0.5, 1e-4, 1e-4, false),
        (-0.06, -0.5, 1e-4, 1e-4, false),
        (-0.06, 0.5, 1e-4, 0.12 * 0.12, true),
        (0.06, -0.5, 1e-4, 0.12 * 0.12, true),
        (-0.3, 0.5, 1e-4, MAX_SKID_STEP * MAX_SKID_STEP, true),
        (0.3, 0.5, doubted, MAX_SKID_STEP * MAX_SKID_STEP, true),
        (-0.001, 0.5, doubted, doubted, true),
    ] {
        for was_calm in [false, true] {
            let mut core = core();
            let skid = own_slip(FREE);
            core.state.reset(skid, 0.2, before);
            core.state.reset(FORWARD, 0.44, 0.01);
            let rolling = &mut core.wheels.channels[FREE].rolling;
            rolling.was_calm = was_calm;
            core.watch_stop(&WINDOW);
            let mut window = WheelWindow {
                rim,
                innovation,
                ..OFF
            };
            core.doubt_after_jump(&window);
            assert!(near(variance(&core, skid), after), "{innovation} {rim}");
            let speed = 0.01 + innovation * innovation;
            assert!(near(variance(&core, FORWARD), speed));
            let jumped_ns = core.wheels.channels[FREE].rolling.jumped_ns;
            assert_eq!(jumped_ns, (jumps && was_calm).then_some(NOW_NS));
            // a wheel that is as fast as before soon after has crossed a bump: its skid is what it was
            for to_ns in [NOW_NS + 50 * MS, NOW_NS + 150 * MS] {
                window.to_ns = to_ns;
                window.rim = WINDOW.forward / (1.0 - 0.2);
                core.end_jump(&window);
            }
            let ends = jumps && before < doubted;
            let expected = if ends { before } else { after };
            assert!(near(variance(&core, skid), expected), "{innovation} {rim}");
        }
    }
    let mut core = core();
    core.state.reset(FORWARD, 0.44, 0.99 * MAX_SPEED_VARIANCE);
    core.doubt_after_jump(&WheelWindow {
        innovation: 20.0,
        ..OFF
    });
    assert_eq!(variance(&core, FORWARD), MAX_SPEED_VARIANCE);
}

#[test]
fn an_innovation_is_the_accelerometer_s_or_that_of_powered_wheels_that_oppose_it() {
    let after = |powered: f64, own: f64, is_used: bool, window: &WheelWindow, rim: f64| {
        let mut core = core();
        turn(&mut core, POWERED, rim);
        core.accelerometer.noise_scale = 5.0;
        core.state.reset(COMMON_SLIP, 0.1, 0.04);
        core.wheels.channels[POWERED].mean_innovation = powered;
        core.wheels.channels[FREE].mean_innovation = own;
        core.attribute(window, is_used);
        let mean = core.wheels.channels[FREE].mean_innovation;
        (
            mean,
            core.accelerometer.noise_scale > 5.0,
            variance(&core, COMMON_SLIP),
        )
    };
    let weight = core().wheels.mean_weight;
    let (mean, learns, slip) = after(1.5, 0.5, true, &WINDOW, 0.8);
    assert!(near(mean, 0.5 + weight * 2.5) && learns && slip == 0.04);
    let slow = WheelWindow {
        has_slip: false,
        ..WINDOW
    };
    for (is_used, window) in [(false, &WINDOW), (true, &slow)] {
        assert_eq!(after(1.5, 0.5, is_used, window, 0.8), (0.0, true, 0.04));
    }
    // 0.06 m/s of 0.8 m/s; rims at the low speed show none
    let (_, learns, slip) = after(-3.0, 3.0, true, &WINDOW, 0.8);
    assert!(!learns && near(slip, 0.04 + 0.075 * 0.075), "{slip}");
    let (_, learns, slip) = after(-3.0, 3.0, true, &WINDOW, LOW_SPEED);
    assert!(learns && slip == 0.04);
}

/// A free wheel that stands while powered rims turn shows their slip, whatever they show; a jammed one does not.
#[test]
fn an_innovation_of_a_free_wheel_that_stands_is_the_powered_wheels() {
    let after = |is_used: bool, rim: f64| {
        let mut core = core();
        turn(&mut core, POWERED, rim);
        turn(&mut core, FREE, 0.0);
        core.accelerometer.noise_scale = 5.0;
        core.state.reset(COMMON_SLIP, 0.1, 0.04);
        core.attribute(&WINDOW, is_used);
        (
            core.accelerometer.noise_scale > 5.0,
            variance(&core, COMMON_SLIP),
        )
    };
    // 0.06 m/s of 0.3 m/s
    let (learns, slip) = after(true, 0.3);
    assert!(!learns && near(slip, 0.04 + 0.2 * 0.2), "{slip}");
    for (is_used, rim) in [(false, 0.3), (true, LOW_SPEED)] {
        assert_eq!(after(is_used, rim), (true, 0.04));
    }
}

#[test]
fn a_skid_that_is_known_makes_the_speed_known_and_a_later_stop_expected() {
    let after = |sigma: f64, is_lost: bool, rim: f64, is_off: bool| {
        let mut core = core();
        core.state.reset(own_slip(FREE), 0.1, sigma * sigma);
        let before_ns = NOW_NS - if is_lost { 501 * MS } else { 500 * MS };
        core.speed_known_ns = Some(before_ns);
        turn(&mut core, FREE, rim);
        let window = WheelWindow { is_off, ..WINDOW };
        core.wheels.channels[FREE].mean_innovation = 1.2;
        let is_used = core.accepts_free_window(&window);
        // one that is not used ends the mean of the innovations
        assert_eq!(core.wheels.channels[FREE].mean_innovation == 0.0, !is_used);
        let stop_expected = core.wheels.channels[FREE].rolling.stop_expected;
        (core.speed_known_ns == Some(NOW_NS), stop_expected)
    };
    for (sigma, is_lost, rim, is_off, expected) in [
        (KNOWN_SKID_SIGMA, false, 0.5, false, (true, true)),
        (MAX_SKID_SIGMA, false, 0.5, false, (false, true)),
        (KNOWN_SKID_SIGMA, false, 0.5, true, (false, true)),
        (KNOWN_SKID_SIGMA, true, 0.5, true, (false, true)),
        (KNOWN_SKID_SIGMA, false, 0.0, false, (true, true)),
        (MAX_SKID_SIGMA, false, 0.0, false, (false, false)),
        (KNOWN_SKID_SIGMA, true, 0.0, false, (true, false)),
        (KNOWN_SKID_SIGMA, false, 0.0, true, (false, false)),
    ] {
        let is = after(sigma, is_lost, rim, is_off);
        assert_eq!(is, expected, "{sigma} {is_lost} {rim} {is_off}");
    }
}
