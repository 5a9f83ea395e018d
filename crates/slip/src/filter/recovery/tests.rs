use super::*;
use crate::filter::motion_model::{GYRO_BIAS, YAW};
use crate::filter::settings::FilterSettings;
use crate::robot::{Robot, Wheel};
use crate::sample::Measurement;
use crate::speed::Measured;

pub(in super::super) const NOW_NS: i64 = 10_000_000_000;
pub(in super::super) const MS: i64 = 1_000_000;
pub(in super::super) const RADIUS_M: f64 = 0.1;
const ROUNDING: f64 = 1e-12;

type Change<'a> = &'a dyn Fn(&mut Core);

/// The gyro was read now, and agrees.
pub(in super::super) fn with_gyro(core: &mut Core) {
    let (settings, wheels) = (core.settings, &core.wheels);
    let mut state = core.state.clone();
    let reading = (NOW_NS, state.mean(YAW) + state.mean(GYRO_BIAS));
    core.gyro
        .update(
            reading,
            &settings,
            (wheels, false),
            &mut state,
            &mut core.path,
        )
        .unwrap();
}

pub(in super::super) fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

/// A robot with two powered wheels in front, beside one another, and a free one behind, or without that.
pub(in super::super) fn core(has_free: bool) -> Core {
    let wheel = |wheel: Wheel, x: f64, y: f64| wheel.at(x, y).radius(RADIUS_M);
    let mut wheels = vec![
        wheel(Wheel::powered("left"), 0.3, 0.4),
        wheel(Wheel::powered("right"), 0.3, -0.3),
    ];
    if has_free {
        wheels.push(wheel(Wheel::free("free"), -0.5, 0.1));
    }
    core_of(wheels)
}

pub(in super::super) fn core_of(wheels: Vec<Wheel>) -> Core {
    let settings = FilterSettings {
        slip: SlipPrior {
            mean: 0.1,
            sigma: 0.2,
        },
        ..FilterSettings::default()
    };
    let mut core = Core::new(&Robot::new("cart".into(), wheels).unwrap(), settings);
    core.now_ns = Some(NOW_NS);
    core
}

/// Readings of a wheel's rim speed (m/s), 0.1 s apart until `to_ns`.
pub(in super::super) fn roll(core: &mut Core, wheel: usize, to_ns: i64, rims: &[f64]) {
    let channel = &mut core.wheels.channels[wheel];
    for (before, rim) in (0..)
        .zip(rims.iter().rev())
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
    {
        let time_ns = to_ns - 100 * MS * before;
        let rate = rim / RADIUS_M;
        channel
            .track
            .take(time_ns, &Measurement::WheelRate { wheel, rate })
            .unwrap();
        channel.window(time_ns, 0.05);
    }
}

/// All of them roll at these speeds (m/s).
pub(in super::super) fn rolling(rims: &[f64]) -> Core {
    let mut core = core(rims.len() == 3);
    for (wheel, rim) in rims.iter().enumerate() {
        roll(&mut core, wheel, NOW_NS, &[*rim; 3]);
    }
    core
}

/// A sensor whose readings have been refused until a tenth of a second ago, beyond a patience of 0.25 s.
pub(in super::super) fn failed() -> Monitor {
    failed_until(NOW_NS - 100 * MS)
}

pub(in super::super) fn failed_until(to_ns: i64) -> Monitor {
    let mut monitor = Monitor::default();
    for i in (0..4).rev() {
        monitor.record(to_ns - i * 100 * MS, false, 0.25);
    }
    monitor
}

#[test]
fn a_speed_is_as_surprising_as_its_slip() {
    let core = rolling(&[0.5, 0.5]);
    for (speed, slip) in [
        (0.4, 0.2),
        (0.8, -0.375),
        (-0.25, 1.5),
        // as fast the other way
        (-0.5, 2.0),
        (0.5, 0.0),
    ] {
        near(core.surprise(speed).unwrap(), f64::abs(slip - 0.1) / 0.2);
    }
    // beyond twice the low speed
    let core = rolling(&[0.03, 0.03]);
    assert_eq!(core.surprise(0.02), None);
    assert_eq!(core.surprise(0.04), None);
    assert!(core.surprise(-0.041).is_some());
    assert!(!core.is_plausible(0.02));
    let mut core = rolling(&[1.0, 1.0]);
    core.settings.slip = SlipPrior {
        mean: 0.0,
        sigma: 0.25,
    };
    assert!(core.is_plausible(0.375) && !core.is_plausible(0.37));
    core.now_ns = None;
    assert!(core.surprise(0.4).is_some());
    core.now_ns = Some(NOW_NS + 1000 * MS);
    assert_eq!(core.surprise(0.4), None);
}

#[test]
fn sensors_agree_within_a_share_and_the_low_speed() {
    let mut core = rolling(&[0.5, 0.5, 0.25]);
    core.settings.low_speed = 0.25;
    for (speed, measured, is_near) in [
        (0.0, 0.25, true),
        (0.0, -0.26, false),
        (-2.0, -2.54, true),
        (-2.0, -1.46, true),
        (-2.0, -2.56, false),
        (-2.0, -1.44, false),
    ] {
        core.reference.speed = Some((measured, NOW_NS - 500 * MS));
        assert_eq!(
            core.agrees_with_sensor(speed, NOW_NS),
            is_near,
            "{speed} {measured}"
        );
        assert!(!core.agrees_with_sensor(speed, NOW_NS + 1));
        let mut core = rolling(&[0.5, 0.5, measured]);
        core.settings.low_speed = 0.25;
        let turns = core.wheels.channels[2].turns();
        assert_eq!(core.agrees_with_free_wheel(speed, NOW_NS), is_near && turns);
        assert!(!core.agrees_with_free_wheel(speed, NOW_NS + 101 * MS));
    }
    core.reference.speed = None;
    assert!(!core.agrees_with_sensor(0.25, NOW_NS));
    // a wheel that stands, and one that has no window
    let mut standing = rolling(&[0.5, 0.5, 0.0]);
    assert!(!standing.agrees_with_free_wheel(0.01, NOW_NS));
    standing.wheels.channels[2].still_since_ns = None;
    assert!(standing.agrees_with_free_wheel(0.01, NOW_NS));
}

#[test]
fn a_dispute_is_of_a_refused_reference_that_is_more_plausible() {
    let set_up = |own: f64, rims: f64, free: f64| {
        let mut core = rolling(&[rims, rims, free]);
        core.state.reset(FORWARD, own, 0.01);
        core
    };
    let suspect = |core: &mut Core| {
        core.wheels.channels[2].monitor.record(NOW_NS, false, 0.3);
    };
    let cases: [(Change, bool); 8] = [
        (&|_| (), false),
        (&suspect, true),
        (
            // failed, and it agrees by now
            &|core| {
                core.wheels.channels[2].monitor = failed();
                core.wheels.channels[2].monitor.record(NOW_NS, true, 0.3);
            },
            true,
        ),
        (
            &|core| {
                suspect(core);
                core.is_led = true;
            },
            false,
        ),
        (
            &|core| {
                suspect(core);
                core.wheels.channels[2].still_since_ns = Some(NOW_NS);
            },
            false,
        ),
        (
            &|core| {
                core.reference.monitor.record(NOW_NS, false, 0.3);
                core.reference.monitor.record(NOW_NS + MS, false, 0.3);
                core.reference.speed = Some((0.45, NOW_NS - 500 * MS));
            },
            true,
        ),
        (
            &|core| {
                core.reference.monitor.record(NOW_NS, false, 0.3);
                core.reference.monitor.record(NOW_NS + MS, false, 0.3);
                core.reference.speed = Some((0.45, NOW_NS - 501 * MS));
            },
            false,
        ),
        (&|core| core.reference.speed = Some((0.45, NOW_NS)), false),
    ];
    for (i, (change, expected)) in cases.into_iter().enumerate() {
        // a slip of 0.8 by the state, of 0.1 by the reference
        let mut core = set_up(0.1, 0.5, 0.45);
        change(&mut core);
        assert_eq!(core.is_disputed(NOW_NS), expected, "{i}");
    }
    for (own, rims, free, expected) in [
        (0.45, 0.5, 0.1, false),
        // within 0.15 of the faster one
        (0.4, 0.5, 0.45, false),
        (0.37, 0.5, 0.45, true),
        // without a slip, and one that is as surprising: 0.5 ± 0.4 about a prior of 0.1
        (0.01, 0.02, 0.018, false),
        (0.2, 0.5, 0.9, false),
        (-0.45, -0.5, -0.1, false),
        (-0.1, -0.5, -0.45, true),
    ] {
        let mut core = set_up(own, rims, free);
        suspect(&mut core);
        assert_eq!(core.is_disputed(NOW_NS), expected, "{own} {rims} {free}");
    }
    // as surprising on either side of the prior
    let mut core = set_up(0.25, 1.0, 0.0);
    core.settings.slip.mean = 0.5;
    for wheel in &mut core.wheels.channels[..2] {
        wheel.rim = wheel
            .rim
            .map(|(rim, to_ns)| (Measured { value: 1.0, ..rim }, to_ns));
    }
    core.reference.monitor = failed();
    for (speed, expected) in [(0.75, false), (0.74, true)] {
        core.reference.speed = Some((speed, NOW_NS));
        assert_eq!(core.is_disputed(NOW_NS), expected);
    }
    // 0.06 m/s are 0.15 of 0.4 m/s
    for (own, expected) in [(0.34, false), (0.339, true)] {
        let mut core = set_up(own, 0.5, 0.0);
        core.reference.monitor = failed();
        core.reference.speed = Some((0.4, NOW_NS));
        assert_eq!(core.is_disputed(NOW_NS), expected);
    }
    let mut silent = set_up(0.1, 0.5, 0.45);
    suspect(&mut silent);
    for wheel in 0..2 {
        roll(&mut silent, wheel, NOW_NS + 100 * MS, &[0.5]);
    }
    assert!(silent.is_disputed(NOW_NS + 100 * MS));
    assert!(!silent.is_disputed(NOW_NS + 101 * MS));
}

#[test]
fn a_robot_is_blocked_while_no_free_wheel_has_turned() {
    for (has_free, has_turned, turns, stop_expected, accepted_ns, is_blocked) in [
        (true, false, true, true, None, true),
        (true, true, true, false, None, false),
        (true, true, false, false, None, true),
        (true, true, false, true, None, false),
        (true, false, true, true, Some(NOW_NS - 501 * MS), true),
        (true, false, true, true, Some(NOW_NS - 500 * MS), false),
        (false, false, true, true, None, false),
    ] {
        let mut core = rolling(&[0.5; 3][..if has_free { 3 } else { 2 }]);
        core.reference.accepted_ns = accepted_ns;
        if let Some(free) = core.wheels.channels.get_mut(2) {
            free.rolling.has_turned = has_turned;
            free.rolling.stop_expected = stop_expected;
            free.still_since_ns = (!turns).then_some(NOW_NS);
        }
        assert_eq!(core.is_blocked(NOW_NS), is_blocked);
    }
}

#[test]
fn pulses_that_are_missed_matter_where_nothing_else_measures() {
    let mut core = rolling(&[0.5, 0.5, 0.4]);
    assert!(!core.only_reference_misses_pulses(NOW_NS));
    for check in &mut core.output.checks {
        check.misses_pulses = true;
    }
    assert!(core.only_reference_misses_pulses(NOW_NS) && core.is_alone(NOW_NS));
    core.is_led = true;
    assert!(!core.only_reference_misses_pulses(NOW_NS) && !core.is_alone(NOW_NS));
    core.is_led = false;
    for (ms, is_alone) in [(500, false), (501, true)] {
        core.reference.accepted_ns = Some(NOW_NS - ms * MS);
        assert_eq!(core.is_alone(NOW_NS), is_alone);
        assert_eq!(core.only_reference_misses_pulses(NOW_NS), is_alone);
    }
    // those of powered wheels, and of a wheel that has failed
    let mut only_powered = core.clone();
    only_powered.output.checks[2].misses_pulses = false;
    assert!(!only_powered.only_reference_misses_pulses(NOW_NS));
    core.wheels.channels[2].monitor = failed();
    assert!(!core.only_reference_misses_pulses(NOW_NS));
}

#[test]
fn a_state_that_runs_away_restarts_from_the_fastest_wheel() {
    // 1.5 times 0.5 m/s, and 0.05 m/s
    for (speed, is_led, restarts) in [
        (0.8, false, false),
        (0.81, false, true),
        (-0.81, false, true),
        (-0.81, true, false),
    ] {
        let mut core = rolling(&[0.3, -0.5, 0.2]);
        core.is_led = is_led;
        core.state.reset(FORWARD, speed, 0.01);
        core.state.set_mean(COMMON_SLIP, 0.7);
        for (index, wheel) in core.wheels.channels.iter_mut().enumerate() {
            wheel.mean_innovation = 0.9;
            wheel.was_off = true;
            wheel.monitor = failed();
            core.state.reset(own_slip(index), 0.6, 0.5);
        }
        let before = core.state.clone();
        // by a tenth of a second at a time: 0.3 s after the first
        for ms in [0, 100, 200] {
            core.recover_from_runaway(NOW_NS + ms * MS);
            assert_eq!(core.state.mean(FORWARD), before.mean(FORWARD));
        }
        core.recover_from_runaway(NOW_NS + 300 * MS);
        if !restarts {
            assert_eq!(core.state.mean(FORWARD), before.mean(FORWARD));
            continue;
        }
        near(core.state.mean(FORWARD), -0.5);
        near(core.state.sigma(FORWARD), 0.5 * 0.5 + 0.05);
        near(core.state.mean(COMMON_SLIP), 0.1);
        near(core.state.sigma(COMMON_SLIP), 0.2);
        near(core.accelerometer.noise_scale, 40.0);
        for (index, wheel) in core.wheels.iter().enumerate() {
            assert!(!wheel.monitor.has_failed() && !wheel.was_off);
            assert_eq!(wheel.mean_innovation, 0.0);
            let prior = core.settings.own_slip_prior(wheel.free);
            near(core.state.mean(own_slip(index)), prior.mean);
            near(core.state.sigma(own_slip(index)), prior.sigma);
        }
        assert!(core.recovery.runaway.is_clean());
    }
    // without a rim nothing is faster
    let mut none = core(true);
    none.state.reset(FORWARD, 9.0, 0.01);
    for ms in [0, 100, 200, 300] {
        none.recover_from_runaway(NOW_NS + ms * MS);
    }
    near(none.state.mean(FORWARD), 9.0);
    none.restart_from(-0.6);
    near(none.state.mean(FORWARD), -0.6);
    near(none.state.sigma(FORWARD), 0.05 * 0.6 + 0.02);
}
