//! The speed laws against pulses of a known rotation.

use std::f64::consts::{PI, TAU};

use grouser_slip::{Fault, MixedSpeed, PeriodSpeed};
use proptest::prelude::*;

const N: f64 = 100.0;

/// Times (ns) of the edges of a shaft whose angle is `angle(t)`, by bisection.
fn edges(angle: impl Fn(f64) -> f64, until: f64) -> Vec<i64> {
    let mut out = Vec::new();
    for edge in 1_u32.. {
        let target = TAU / N * f64::from(edge);
        if angle(until) < target {
            break;
        }
        let (mut low, mut high) = (0.0, until);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if angle(middle) < target {
                low = middle;
            } else {
                high = middle;
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "seconds in nanoseconds")]
        out.push((high * 1e9).round() as i64);
    }
    out
}

#[test]
fn period_law_follows_a_constant_acceleration() {
    // ω = 1 + 2 t: extrapolation from the last two pulses is exact for it to second order.
    let acceleration = 2.0;
    let edges = edges(|t| t + 0.5 * acceleration * t * t, 3.0);
    let mut law = PeriodSpeed::new(N, 0.0).unwrap();
    let mut worst: f64 = 0.0;
    for pair in edges.windows(2) {
        law.edge(pair[0], true).unwrap();
        let now = i64::midpoint(pair[0], pair[1]);
        if pair[0] > 1_000_000_000 {
            let truth = 1.0 + acceleration * now as f64 * 1e-9;
            worst = worst.max((law.speed_at(now).unwrap().value - truth).abs());
        }
    }
    // Third derivative of the edges' times: about (a/ω)² Δt² ω/4 < 1e-3 here; 1 ns in Δt adds 1e-7.
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn period_law_decays_to_zero_at_standstill_and_never_below() {
    let mut law = PeriodSpeed::new(N, 0.0).unwrap();
    for time in [0, 10_000_000, 20_000_000, 35_000_000] {
        law.edge(time, true).unwrap();
    }
    let mut last = f64::INFINITY;
    for ms in (35..20_000).step_by(5) {
        let speed = law.speed_at(ms * 1_000_000).unwrap();
        assert!(speed.value >= 0.0 && speed.value <= last + 1e-12);
        assert!(speed.variance.is_finite());
        last = speed.value;
    }
    assert!(last < TAU / N / 19.9);
}

#[test]
fn period_law_starts_restarts_and_refuses() {
    let mut law = PeriodSpeed::new(N, 0.0).unwrap();
    assert!(law.speed_at(0).is_none());
    law.edge(100, true).unwrap();
    assert!(law.speed_at(200).is_none());
    law.edge(10_000_100, true).unwrap();
    // One pulse: held.
    assert!((law.speed_at(10_000_100).unwrap().value - TAU).abs() < 1e-9);
    // Δt = 0 and a step back are refused and change nothing.
    for time_ns in [10_000_100, 5, i64::MIN] {
        assert!(matches!(
            law.edge(time_ns, true),
            Err(Fault::NotLater { .. })
        ));
    }
    assert!((law.speed_at(10_000_100).unwrap().value - TAU).abs() < 1e-9);
    // A reversal restarts.
    law.edge(20_000_100, false).unwrap();
    assert!(law.speed_at(20_000_100).is_none());
    law.edge(30_000_100, false).unwrap();
    assert!((law.speed_at(30_000_100).unwrap().value + TAU).abs() < 1e-9);
}

#[test]
fn mixed_law_is_exact_between_edges() {
    let edges = edges(|t| 5.0 * t, 1.0);
    let law = MixedSpeed::new(N, 1e-9).unwrap();
    let last = edges.len() - 1;
    let pulses = i64::try_from(last).unwrap();
    let speed = law.speed(pulses, edges[0], edges[last]).unwrap();
    assert!((speed.value - 5.0).abs() < 1e-7);
    assert!(law.speed(0, 0, 1_000).is_err());
    assert!(law.speed(1, 1_000, 1_000).is_err());
    assert!(law.speed(1, i64::MAX, i64::MIN).is_err());
}

/// Numbers by hand: 100 edges a turn, so that a pulse in 0.1 s is 0.2π rad/s.
#[test]
fn period_law_extrapolates_is_bounded_and_knows_its_noise() {
    let law = |edges: &[i64]| {
        let mut law = PeriodSpeed::new(N, 1e-3).unwrap();
        for ms in edges {
            law.edge(ms * 1_000_000, true).unwrap();
        }
        law
    };
    let near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-9;
    let held = law(&[0, 100]);
    // the clock's millisecond at both ends of 100 ms
    let clock = 0.04 * PI * PI * 1e-4 / 6.0;
    for ms in [100, 150] {
        let speed = held.speed_at(ms * 1_000_000).unwrap();
        assert!(near(speed.value, 0.2 * PI) && near(speed.variance, clock));
    }
    // no pulse for as long as the last took, and for twice as long: anything up to the bound
    for (ms, bound) in [(200, 0.2 * PI), (300, 0.1 * PI)] {
        let speed = held.speed_at(ms * 1_000_000).unwrap();
        assert!(near(speed.value, bound) && near(speed.variance, bound * bound / 12.0));
    }
    // from 0.2π to 0.4π rad/s between middles 75 ms apart, for the 25 ms from the last middle on
    let speed = law(&[0, 100, 150]).speed_at(150_000_000).unwrap();
    let change = 0.2 * PI / 3.0;
    let clock = 0.16 * PI * PI * 4e-4 / 6.0;
    assert!(near(speed.value, 0.4 * PI + change));
    assert!(near(speed.variance, clock + change * change / 3.0));
    // from 0.25π to 0.2π rad/s in 90 ms, for no more than two periods
    let slowing = law(&[0, 80, 180]);
    for ms in [345, 360] {
        let speed = slowing.speed_at(ms * 1_000_000).unwrap();
        assert!(near(speed.value, 0.2 * PI - 0.05 * PI * 0.2 / 0.09), "{ms}");
    }
}

/// 25 of 100 ticks in half a second are π rad/s; 10 ms at both ends.
#[test]
fn mixed_law_knows_its_noise() {
    let law = MixedSpeed::new(N, 0.01).unwrap();
    for (pulses, expected) in [(25, PI), (-25, -PI)] {
        let speed = law.speed(pulses, 0, 500_000_000).unwrap();
        assert!((speed.value - expected).abs() < 1e-12);
        assert!((speed.variance - PI * PI * 4e-4 / 6.0).abs() < 1e-12);
    }
}

#[test]
fn laws_refuse_what_is_no_encoder() {
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert!(PeriodSpeed::new(bad, 0.0).is_err());
        assert!(MixedSpeed::new(bad, 0.0).is_err());
    }
}

proptest! {
    #[test]
    fn period_law_is_total_and_finite(
        times in prop::collection::vec(any::<i64>(), 1..20),
        directions in prop::collection::vec(any::<bool>(), 20),
        command in any::<i64>(),
    ) {
        let mut law = PeriodSpeed::new(N, 1e-6).unwrap();
        for (time, forward) in times.iter().zip(&directions) {
            let _ = law.edge(*time, *forward);
            if let Some(speed) = law.speed_at(command) {
                prop_assert!(speed.value.is_finite() && speed.variance.is_finite());
                prop_assert!(speed.variance >= 0.0);
            }
        }
    }
}
