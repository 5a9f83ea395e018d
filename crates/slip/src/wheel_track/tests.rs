use super::*;
use crate::robot::Encoder;

const SETTINGS: TrackSettings = TrackSettings {
    window: 0.1,
    max_speed: 10.0,
    dropout: 0.5,
};
const MS: i64 = 1_000_000;

/// A wheel whose rim moves by `per_tick` metres for each of 50 ticks a turn.
fn wheel(per_tick: f64, bits: u32) -> Wheel {
    let encoder = Encoder::counting(50).counter(CounterWidth::new(bits).unwrap());
    let encoder = if per_tick < 0.0 {
        encoder.reversed()
    } else {
        encoder
    };
    let radius = 50.0 * per_tick.abs() / TAU;
    Wheel::powered("wheel").radius(radius).encoder(encoder)
}

/// A wheel of 0.5 m radius without ticks.
fn smooth(settings: TrackSettings, rate_step: f64) -> WheelTrack {
    let encoder = Encoder::default().rate_step(rate_step);
    let wheel = Wheel::powered("wheel").radius(0.5).encoder(encoder);
    WheelTrack::new(0, &wheel, settings, History::new(64, 0))
}

fn by_counts(per_tick: f64, settings: TrackSettings) -> WheelTrack {
    let history = History::new(64, 0);
    WheelTrack::new(0, &wheel(per_tick, 8), settings, history)
}

const fn count(ticks: i64) -> Measurement {
    Measurement::WheelCount {
        wheel: 0,
        raw: ticks.cast_unsigned(),
    }
}

const fn angle(angle: f64) -> Measurement {
    Measurement::WheelAngle { wheel: 0, angle }
}

const fn rate(rate: f64) -> Measurement {
    Measurement::WheelRate { wheel: 0, rate }
}

const fn edge(forward: bool) -> Measurement {
    Measurement::WheelEdge { wheel: 0, forward }
}

fn near(value: f64, expected: f64) -> bool {
    (value - expected).abs() <= 1e-9 * expected.abs()
}

#[test]
fn a_silence_of_more_than_two_windows_starts_anew() {
    let settings = TrackSettings {
        window: 0.4,
        dropout: 0.3,
        ..SETTINGS
    };
    assert_eq!((settings.gap(), SETTINGS.gap()), (0.8, 1.0));
    let mut track = smooth(settings, 0.0);
    assert_eq!(track.gap, 0.8);
    for (ms, at) in [(0, 1.0), (800, 2.0)] {
        track.take(ms * MS, &angle(at)).unwrap();
    }
    assert!(track.speed(0, 800 * MS).is_some());
    // what was before a longer one is forgotten
    for (ms, at) in [(1601, 3.0), (1701, 3.4)] {
        track.take(ms * MS, &angle(at)).unwrap();
    }
    assert!(track.speed(800 * MS, 1701 * MS).is_none());
    assert!(near(
        track.speed(1601 * MS, 1701 * MS).unwrap().value,
        0.2 / 0.1
    ));
}

/// 8 bits and ticks of 1 cm: from 0.128 s on a rim of 10 m/s may pass half the counter's range between two readings.
#[test]
fn a_counter_that_may_wrap_unseen_is_foreseen_by_the_last_speed() {
    for (sign, per_tick) in [(1, 0.01), (-1, 0.01), (1, -0.01)] {
        let mut track = by_counts(per_tick, SETTINGS);
        // 7 m/s for 0.1 s, then 7.5 m/s for 0.2 s: 150 ticks are shown as -106
        for (ms, ticks) in [(0, 30), (100, 100), (300, 250)] {
            track.take(ms * MS, &count(sign * ticks)).unwrap();
        }
        assert!(near(track.totals[0], 220.0 * sign as f64 * per_tick));
        // in 0.1 s it cannot: -95 ticks after 9 m/s forwards are no 161
        let mut track = by_counts(per_tick, SETTINGS);
        for (ms, ticks) in [(0, 30), (100, 120), (200, 25)] {
            track.take(ms * MS, &count(sign * ticks)).unwrap();
        }
        assert!(near(track.totals[0], -5.0 * sign as f64 * per_tick));
    }
    // exactly half the range, which is shown alike in both directions
    for sign in [1, -1] {
        let mut track = by_counts(0.01, SETTINGS);
        track.max_speed = 128.0 * track.per_tick.unwrap();
        for (seconds, ticks) in [(0, 0), (1, 120), (2, 248)] {
            let measurement = count(sign * ticks);
            track.take(seconds * 1000 * MS, &measurement).unwrap();
        }
        assert!(near(track.totals[0], 2.48 * sign as f64));
    }
}

#[test]
fn a_jump_is_refused_until_the_next_reading_follows_it() {
    let settings = TrackSettings {
        max_speed: 2.0,
        ..SETTINGS
    };
    let mut track = smooth(settings, 0.0);
    // readings of 0.5 m/rad: 4 rad in a second are exactly the greatest speed
    track.take(0, &angle(1.0)).unwrap();
    track.take(1000 * MS, &angle(5.0)).unwrap();
    assert_eq!(track.totals[0], 2.0);
    let fault = track.take(1500 * MS, &angle(8.0)).unwrap_err();
    let Fault::Jump { value, limit, .. } = fault else {
        panic!("{fault}");
    };
    assert_eq!((value, limit), (3.0, 2.0));
    // 4 m/s away from the outlier as well
    assert!(track.take(2000 * MS, &angle(12.0)).is_err());
    // exactly 2 m/s away from it: the sensor was reset
    track.take(2500 * MS, &angle(14.0)).unwrap();
    assert_eq!(track.totals[0], 2.0);
    track.take(3000 * MS, &angle(13.0)).unwrap();
    assert_eq!(track.totals[0], 1.5);
    // counts and angles have nothing to do with each other
    let mut track = by_counts(0.01, SETTINGS);
    track.take(0, &count(1)).unwrap();
    assert!(track.take(100 * MS, &angle(1.0)).is_err());
    for bad in [-1.1e9, 1.1e9, f64::NAN] {
        assert!(matches!(
            track.take(200 * MS, &angle(bad)),
            Err(Fault::OutOfRange(_) | Fault::NotFinite { .. })
        ));
    }
}

/// A count is off by up to a tick at each end, as uniformly: tick²/6 of the travel.
#[test]
fn ticks_are_the_noise_of_counts_and_of_angles_by_ticks() {
    let at_rest = |measurement: &dyn Fn(i64) -> Measurement| {
        let mut track = by_counts(0.03, SETTINGS);
        assert!(track.edges.is_none());
        track.take(0, &measurement(10)).unwrap();
        track.take(400 * MS, &measurement(20)).unwrap();
        assert!(track.edges.is_none());
        track.speed(0, 400 * MS).unwrap()
    };
    let counted = at_rest(&count);
    let turned = at_rest(&|ticks| angle(ticks as f64 * TAU / 50.0));
    // 0.3 m in 0.4 s; 0.0009/6 m² in 0.16 s²
    for speed in [counted, turned] {
        assert!(near(speed.value, 0.75) && near(speed.variance, 0.000_937_5));
    }
}

/// A rate in steps is off by up to half a step, uniformly, at each reading anew.
#[test]
fn rates_add_up_to_a_way_and_so_does_what_their_steps_leave_open() {
    let mut track = smooth(SETTINGS, 0.12);
    // 0.5 m/rad: exactly 10 m/s is no jump
    track.take(0, &rate(20.0)).unwrap();
    assert_eq!(track.known_until(7), Some(0));
    track.take(250 * MS, &rate(20.0)).unwrap();
    track.take(500 * MS, &rate(-4.0)).unwrap();
    let speed = track.speed(0, 500 * MS).unwrap();
    // 2.5 m forwards, 0.5 m back; twice (0.015 m)²/12
    assert!(near(speed.value, 4.0) && near(speed.variance, 2.0 * 0.000_225 / 12.0 / 0.25));
    let fault = track.take(600 * MS, &rate(-20.1)).unwrap_err();
    assert!(matches!(fault, Fault::Jump { value, .. } if near(value, -10.05)));
}

#[test]
fn a_clock_that_was_set_begins_anew() {
    let mut track = by_counts(0.01, SETTINGS);
    track.take(5_000 * MS, &count(0)).unwrap();
    track.take(5_100 * MS, &count(10)).unwrap();
    track.take(5_110 * MS, &edge(true)).unwrap();
    assert!(track.edges.is_some() && track.known_until(9_000 * MS) == Some(9_000 * MS));
    track.restart_clock();
    assert!(track.edges.is_none() && track.newest_time().is_none());
    track.take(100 * MS, &count(50)).unwrap();
    track.take(200 * MS, &count(60)).unwrap();
    assert!(near(track.speed(100 * MS, 200 * MS).unwrap().value, 1.0));
    // 11 ticks before, 10 after, none in between
    assert!(near(track.totals[0], 0.21));
}

/// As a float of few bits, so that four pulses are exactly four.
const TICK_M: f64 = 0.031_25;

/// Edges every 20 ms and, from 100 ms on, every 10 ms: a speed that the two laws know differently.
fn edges(until_ms: i64, forward: bool) -> WheelTrack {
    let mut track = by_counts(TICK_M, SETTINGS);
    track.per_tick = Some(TICK_M);
    for ms in (0..100).step_by(20).chain((100..=until_ms).step_by(10)) {
        track.take(ms * MS, &edge(forward)).unwrap();
    }
    track
}

#[test]
fn many_pulses_are_a_mean_and_few_are_a_period() {
    for (forward, sign) in [(true, 1.0), (false, -1.0)] {
        // 120 ms: five pulses of 20 ms and two of 10 ms
        let track = edges(120, forward);
        let speed = |from: i64, to: i64| track.speed(from * MS, to * MS).unwrap();
        // four and five pulses: their way over their time, known to the clock's nanosecond
        for (from, pulses, seconds) in [(60, 4.0, 0.06), (40, 5.0, 0.08)] {
            let mean = speed(from, 120);
            let expected = sign * pulses * TICK_M / seconds;
            assert!(near(mean.value, expected), "{} {expected}", mean.value);
            let relative = 1e-9 / seconds;
            assert!(near(
                mean.variance,
                expected * expected * relative * relative / 6.0
            ));
        }
        // three: the last period
        assert!(near(speed(80, 120).value, sign * TICK_M / 0.01));
        // half a window of silence is one still of the mean, any longer one is none
        assert!(near(speed(20, 220).value, sign * 6.0 * TICK_M / 0.1));
        assert!(near(speed(20, 221).value, sign * TICK_M / 0.101));
        // the window may begin between two edges
        assert!(near(speed(30, 120).value, sign * 5.5 * TICK_M / 0.09));
        // no window before the first edge
        assert!(track.speed(-10 * MS, 120 * MS).is_none());
    }
    // a single period, and nothing since: the clock's nanosecond at both ends of 20 ms
    let mut track = by_counts(TICK_M, SETTINGS);
    track.take(0, &edge(true)).unwrap();
    track.take(20 * MS, &edge(true)).unwrap();
    let speed = track.speed(0, 20 * MS).unwrap();
    let relative = 1e-9 / 0.02;
    assert!(near(speed.value, TICK_M / 0.02));
    assert!(near(speed.sigma(), speed.value * relative / 6.0_f64.sqrt()));
}
