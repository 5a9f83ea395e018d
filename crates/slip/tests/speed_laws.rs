//! The speed laws against pulses of a known rotation.

use std::f64::consts::TAU;

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
