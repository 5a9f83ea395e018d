use super::*;
use crate::fault::Fault;
use crate::sample::Measurement;
use crate::state::Invalid;

/// A sixteenth of a second, which is exact in seconds.
const STEP_NS: i64 = 62_500_000;
const STEP_S: f64 = 0.0625;
/// So that half a radian is a sixteenth of a metre.
const RADIUS_M: f64 = 0.125;
const ROUNDING: f64 = 1e-12;

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

fn channel(wheel: &Wheel, beside_free: bool) -> WheelChannel {
    let mut wheels = vec![wheel.clone()];
    if beside_free {
        wheels.push(Wheel::free("free"));
    }
    let robot = Robot::new("cart".into(), wheels).unwrap();
    let settings = FilterSettings::default();
    WheelChannel::all(&robot, &settings).next().unwrap()
}

fn wheel() -> Wheel {
    Wheel::powered("wheel").at(0.5, 0.4).radius(RADIUS_M)
}

/// Reads an angle (rad) after this many steps; returns the window that ends: rim speed and first step.
fn read(channel: &mut WheelChannel, step: i64, angle: f64) -> Option<(f64, i64)> {
    let now_ns = step * STEP_NS;
    let angle = Measurement::WheelAngle { wheel: 0, angle };
    channel.track.take(now_ns, &angle).unwrap();
    let (rim, from_ns) = channel.window(now_ns, STEP_S)?;
    Some((rim.value, from_ns / STEP_NS))
}

/// All windows of an angle that grows by this much a step.
fn windows(channel: &mut WheelChannel, steps: i64, angle: f64) -> Vec<(f64, i64)> {
    (0..=steps)
        .filter_map(|step| read(channel, step, angle * step as f64))
        .collect()
}

#[test]
fn a_window_is_as_long_as_its_ticks_need() {
    const TICK_M: f64 = 0.015_625;
    for sign in [1.0, -1.0] {
        for (angle, rim, from) in [
            // four ticks at once, six after two steps, and fewer after four of them
            (0.5, 1.0, &[0, 1, 2, 3, 4, 5, 6, 7][..]),
            (0.375, 0.75, &[0, 2, 4, 6]),
            (0.0625, 0.125, &[0, 4]),
        ] {
            let mut channel = channel(&wheel(), true);
            channel.tick = TICK_M;
            let found = windows(&mut channel, 8, sign * angle);
            let expected: Vec<_> = from.iter().map(|from| (sign * rim, *from)).collect();
            assert_eq!(found, expected);
        }
    }
    // shorter than a window
    let mut short = channel(&wheel(), true);
    for (step_ns, ends) in [(0, false), (STEP_NS - 1, false), (STEP_NS, true)] {
        let angle = Measurement::WheelAngle {
            wheel: 0,
            angle: 0.5,
        };
        short.track.take(step_ns, &angle).unwrap();
        assert_eq!(short.window(step_ns, STEP_S).is_some(), ends);
    }
    // one that began later begins anew, as one that the sensor does not cover
    let mut early = channel(&wheel(), true);
    read(&mut early, 9, 0.0);
    early.remainder = Some(true);
    assert!(early.window(8 * STEP_NS, STEP_S).is_none());
    assert_eq!((early.from_ns, early.remainder), (Some(8 * STEP_NS), None));
    let mut gap = channel(&wheel(), true);
    read(&mut gap, 0, 0.0);
    gap.remainder = Some(true);
    assert_eq!(read(&mut gap, 100, 5.0), None);
    assert_eq!((gap.from_ns, gap.remainder), (Some(100 * STEP_NS), None));
    assert_eq!(read(&mut gap, 101, 5.5), Some((1.0, 100)));
}

#[test]
fn a_window_is_as_long_as_its_stamps_need() {
    // rates without ticks: the scatter of stamps, 10 ms, by three windows
    let scatter = |speed: f64| {
        let mut stamps = StampScatter::default();
        for speed in [speed, 1.5 * speed, 1.25 * speed] {
            stamps.push(speed, STEP_S, 0.0);
        }
        stamps
    };
    let mut lone = channel(&wheel(), false);
    assert!(lone.stamps.is_some() && channel(&wheel(), true).stamps.is_none());
    lone.stamps = Some(scatter(1.0));
    let sigma = lone.stamps.unwrap().variance().sqrt();
    let length_s = 10.4 * sigma;
    let steps = crate::history::whole((length_s / STEP_S).ceil());
    assert!(
        (2..4).contains(&steps) && length_s < STEP_S * (steps as f64 - 0.1),
        "{length_s}"
    );
    let found = windows(&mut lone, steps, 0.5);
    assert_eq!(found, [(1.0, 0)]);
    let speed = 1.0;
    near(
        lone.remainder_variance(),
        speed * speed * lone.stamps.unwrap().variance(),
    );
    // each window shows it, with the tick of a way
    for (is_way, tick) in [(true, 0.003), (false, 0.0)] {
        let mut lone = channel(&wheel(), false);
        lone.tick = 0.003;
        let mut expected = StampScatter::default();
        let mut angle = 0.0;
        for (step, rim) in (0..).zip([0.0, 1.0, 1.5, 1.25, 1.75, 1.5]) {
            let now_ns = step * STEP_NS;
            angle += rim / RADIUS_M * STEP_S;
            let reading = if is_way {
                Measurement::WheelAngle { wheel: 0, angle }
            } else {
                Measurement::WheelRate {
                    wheel: 0,
                    rate: rim / RADIUS_M,
                }
            };
            lone.track.take(now_ns, &reading).unwrap();
            // long enough, however much the stamps scatter
            let ended = lone.window(now_ns, STEP_S / 4.0);
            if let Some((rim, _)) = ended {
                expected.push(rim.value, STEP_S, tick);
            }
        }
        assert!(expected.variance() > 0.0);
        near(
            lone.stamps.unwrap().variance() * 1e6,
            expected.variance() * 1e6,
        );
        // what does not continue the last
        let mut once = expected;
        lone.restart_window(99);
        once.interrupt();
        for stamps in [&mut once, lone.stamps.as_mut().unwrap()] {
            stamps.push(1.0, STEP_S, 0.0);
        }
        near(lone.stamps.unwrap().variance() * 1e6, once.variance() * 1e6);
    }
    // edges have stamps of their own
    let mut edges = channel(&wheel().ticks_per_turn(100), false);
    for step in 0..6 {
        // unevenly
        let now_ns = step * STEP_NS + [0, 20_000_000][usize::from(step % 2 == 0)];
        let edge = Measurement::WheelEdge {
            wheel: 0,
            forward: true,
        };
        edges.track.take(now_ns, &edge).unwrap();
        edges.window(now_ns, STEP_S / 8.0);
    }
    assert!(edges.rim.is_some() && edges.stamps.unwrap().variance() == 0.0);
}

#[test]
fn a_carrier_and_steering_turn_the_wheel_beside_its_sensor() {
    let steered = wheel().steered_about(0.0, 0.0);
    for (angle, turns) in [(0.5, true), (0.0, false)] {
        let mut channel = channel(&steered, true);
        read(&mut channel, 0, 0.0);
        for (step, turn) in [(0, 0.4), (1, 0.8)] {
            channel
                .carrier
                .update(step * STEP_NS, [turn, 0.0, 0.0])
                .unwrap();
        }
        assert!(channel.steer(0.0) && channel.steer(0.02) && !channel.steer(0.02));
        assert_eq!(channel.row, channel.steering.along());
        let (rim, _) = read(&mut channel, 1, angle).unwrap();
        // a mean of 0.6 rad/s by the carrier, and 0.4 m to the left of the joint, back by 0.02 rad
        let beside = RADIUS_M * 0.6 + 0.4 * 0.02 / STEP_S;
        near(
            rim,
            angle * RADIUS_M / STEP_S + if turns { beside } else { 0.0 },
        );
        // once
        let (rim, _) = read(&mut channel, 2, 2.0 * angle).unwrap();
        near(rim, angle * RADIUS_M / STEP_S);
    }
}

#[test]
fn a_rim_changes_beyond_its_noise() {
    // ticks of 2π/100 of the radius: each window has their variance, a sixth of a tick's square
    let ticks = wheel().ticks_per_turn(100);
    let tick = RADIUS_M * core::f64::consts::TAU / 100.0;
    let noise = 3.0 * f64::sqrt(2.0 * tick * tick / 6.0) / STEP_S;
    for (change, counts) in [(0.99, false), (-0.99, false), (1.01, true), (-1.01, true)] {
        let change = change * noise;
        let mut channel = channel(&ticks, true);
        near(channel.tick, tick);
        windows(&mut channel, 2, 0.5);
        near(channel.pace(), 0.0);
        let angle = (1.0 + change) * STEP_S / RADIUS_M;
        read(&mut channel, 3, 1.0 + angle);
        near(
            channel.pace(),
            if counts {
                change / f64::sqrt(STEP_S)
            } else {
                0.0
            },
        );
    }
    // not between windows that do not follow each other
    let mut apart = channel(&wheel(), true);
    windows(&mut apart, 2, 0.5);
    let angle = Measurement::WheelAngle {
        wheel: 0,
        angle: 1.5,
    };
    apart.track.take(3 * STEP_NS, &angle).unwrap();
    apart.restart_window(3 * STEP_NS);
    assert_eq!(read(&mut apart, 4, 3.0), Some((3.0, 3)));
    near(apart.pace(), 0.0);
    near(channel(&wheel(), true).pace(), 0.0);
    // one without ticks has no noise, and a tick has no sign
    near(channel(&wheel(), true).tick, 0.0);
    let mut reversed = ticks.clone();
    reversed.encoder = reversed.encoder.reversed();
    near(channel(&reversed, true).tick, tick);
}

#[test]
fn the_last_window_and_what_went_before_are_kept() {
    let mut channel = channel(&wheel(), true);
    assert_eq!((channel.rim_span(), channel.silence(0)), (None, None));
    near(channel.rim_lag(0), 0.0);
    near(channel.remainder_variance(), 0.0);
    assert!(!channel.turns() && !channel.is_received(0, 1.0));
    windows(&mut channel, 4, 0.5);
    let now_ns = 4 * STEP_NS;
    assert_eq!(channel.rim_span(), Some((now_ns - STEP_NS, now_ns)));
    near(channel.rim_lag(now_ns), STEP_S / 2.0);
    near(channel.rim_lag(now_ns + STEP_NS), 1.5 * STEP_S);
    near(channel.rim_lag(now_ns - STEP_NS), STEP_S / 2.0);
    near(channel.top_rim(), 1.0);
    assert!(channel.turns() && channel.rolling.has_turned);
    // a minute's memory
    read(&mut channel, 5, 2.25);
    near(channel.top_rim(), 1.0 - STEP_S / 60.0);
    near(channel.remainder_variance(), 0.0);
    // it stands since the window began in which it has not moved
    for step in [6, 7] {
        read(&mut channel, step, 2.25);
        assert_eq!(channel.still_since_ns, Some(5 * STEP_NS));
        near(
            channel.stillness(step * STEP_NS),
            STEP_S * (step - 5) as f64,
        );
    }
    assert!(!channel.turns());
    near(channel.stillness(4 * STEP_NS), 0.0);
    // silence is not standing, and as long as the dropout time of 0.1 s none
    near(
        channel.stillness(7 * STEP_NS + 100_000_000),
        2.0 * STEP_S + 0.1,
    );
    near(channel.stillness(7 * STEP_NS + 100_000_001), 0.0);
    near(channel.silence(8 * STEP_NS).unwrap(), STEP_S);
    assert!(
        channel.is_received(8 * STEP_NS, STEP_S) && !channel.is_received(8 * STEP_NS + 1, STEP_S)
    );
    // led on until the gap that begins it anew: twice four windows
    let gap_ns = nanoseconds(channel.track.gap());
    assert_eq!(gap_ns, 400_000_000);
    assert!(
        channel.is_led_on(7 * STEP_NS + gap_ns) && !channel.is_led_on(7 * STEP_NS + gap_ns + 1)
    );
    read(&mut channel, 8, 3.0);
    assert_eq!(channel.still_since_ns, None);
    // the last speed but one, by 0.3
    channel.smooth(2.0);
    near(channel.smoothed_rim(), 0.0);
    channel.smooth(5.0);
    near(channel.smoothed_rim(), 0.6);
    channel.smooth(7.0);
    near(channel.smoothed_rim(), 0.6 + 0.3 * 4.4);
    // a counted wheel's remainder is uniform within a tick
    channel.tick = 0.006;
    near(channel.remainder_variance(), 0.0);
    let mut counted = self::channel(&wheel().ticks_per_turn(100), true);
    let count = Measurement::WheelCount { wheel: 0, raw: 1 };
    counted.track.take(0, &count).unwrap();
    near(
        counted.remainder_variance(),
        counted.tick * counted.tick / 12.0,
    );
}

#[test]
fn an_estimate_changes_with_a_window_or_while_there_is_none() {
    let mut channel = channel(&wheel(), true);
    windows(&mut channel, 2, 0.5);
    let now_ns = 2 * STEP_NS;
    for (health, has_none) in [
        (Health::Uninitialised, true),
        (Health::Invalid(Invalid::Dropout), true),
        (Health::Ok, false),
    ] {
        channel.estimate.health = health;
        assert!(channel.has_news(now_ns));
        assert_eq!(channel.has_news(now_ns + 1), has_none);
    }
}

#[test]
fn slip_is_shared_but_by_free_wheels() {
    let mut powered = channel(&wheel(), true);
    assert_eq!(
        powered.slip_row(3),
        [(COMMON_SLIP, 1.0), (own_slip(3), 1.0)]
    );
    powered.free = true;
    assert_eq!(
        powered.slip_row(3),
        [(COMMON_SLIP, 0.0), (own_slip(3), 1.0)]
    );
}

#[test]
fn a_clock_that_was_set_forgets_the_windows() {
    let mut channel = channel(&wheel(), true);
    windows(&mut channel, 4, 0.5);
    channel.remainder = Some(true);
    channel.has_ended = true;
    channel.read_before_ns = 7;
    channel.still_since_ns = Some(7);
    channel.against_since_ns = Some(7);
    channel.mean_innovation = 0.5;
    channel.noise_scale = 3.0;
    channel.monitor.record(0, false, 0.0);
    channel.estimate.health = Health::Ok;
    channel.restart_clock();
    assert_eq!(
        (channel.from_ns, channel.remainder, channel.rim),
        (None, None, None)
    );
    assert_eq!(
        (channel.still_since_ns, channel.against_since_ns),
        (None, None)
    );
    assert_eq!(
        (channel.has_ended, channel.read_before_ns),
        (false, i64::MIN)
    );
    assert_eq!(channel.estimate.health, WheelEstimate::NOTHING.health);
    assert!(channel.monitor.is_clean() && !channel.rolling.has_turned);
    near(channel.mean_innovation, 0.0);
    // what was learnt is not forgotten, and its readings begin anew at an earlier time
    near(channel.noise_scale, 3.0);
    near(channel.top_rim(), 1.0);
    let unknown: Result<(), Fault> = channel.track.take(
        -5,
        &Measurement::WheelRate {
            wheel: 0,
            rate: 1.0,
        },
    );
    assert_eq!(unknown, Ok(()));
    assert_eq!(channel.track.newest_time(), Some(-5));
}
