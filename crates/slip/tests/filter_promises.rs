//! The promises R1 to R9, one test each, of the slip filter. R8 is in `filter_outputs.rs`; the long runs are in the generator's crate.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking and may say what it measured; counts are small"
)]

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Fault, Health, Measurement, Sample};
use proptest::prelude::*;

use crate::processor_time::ThreadTime;
use crate::sane::is_sane;
use crate::wild::measurement;
use crate::world::World;

fn filter() -> SlipFilter {
    SlipFilter::new(&World::default().robot(), FilterSettings::default()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn r1_r2_any_bits_are_survived_and_all_that_is_said_is_finite(
        samples in prop::collection::vec(
            (prop_oneof![any::<i64>(), 0..2_000_000_000_i64], measurement()), 1..100),
    ) {
        let mut filter = filter();
        for (time_ns, measurement) in samples {
            let before = filter.latest().rejected.total();
            let refused = filter.update(Sample { time_ns, measurement }).is_err();
            // R6: refused is counted
            let counted = filter.latest().rejected.total() - before;
            prop_assert!(!refused || counted >= 1);
            is_sane(&filter)?;
        }
    }

    #[test]
    fn r1_r2_r3_in_order_but_wild(
        steps in prop::collection::vec((1..40_000_000_i64, measurement()), 1..150),
    ) {
        let mut filter = filter();
        let mut time_ns = -1_000_000_000;
        for (step, measurement) in steps {
            time_ns += step;
            let _ = filter.update(Sample { time_ns, measurement });
            is_sane(&filter)?;
        }
    }
}

/// No gap in time is made up for step by step: after fifty years one sample costs what any does.
#[test]
fn r3_a_gap_of_any_length_costs_one_update() {
    let mut filter = filter();
    let say = |filter: &mut SlipFilter, time_ns| {
        let rate = Measurement::YawRate { rate: 0.01 };
        let _ = filter.update(Sample {
            time_ns,
            measurement: rate,
        });
    };
    for row in 0..1000 {
        say(&mut filter, row * 10_000_000);
    }
    let start = ThreadTime::now();
    for row in 0..100_i64 {
        // the second sample after a gap shows that the clock was set, and is followed
        for after_ns in [0, 10_000_000] {
            say(&mut filter, (row + 1) * 90_000_000_000_000_000 + after_ns);
        }
    }
    // a loop over the gaps would take 1e12 steps
    assert!(start.elapsed().as_secs_f64() < 1.0);
    assert_eq!(filter.latest().rejected.total(), 100);
    assert_eq!(filter.latest().clock_steps, 100);
}

#[test]
fn r4_nothing_is_allocated_after_construction() {
    let mut samples = Vec::new();
    World {
        camera: 25,
        ..World::default()
    }
    .run(|_, row| samples.extend_from_slice(row));
    let mut filter = filter();
    let counted = allocation_counter::measure(|| {
        for sample in &samples {
            let _ = filter.update(*sample);
            let _ = filter.latest();
        }
        let _ = filter.estimate_at(samples[samples.len() - 1].time_ns + 1_000_000_000);
    });
    assert_eq!(counted.count_total, 0);
}

#[test]
fn r5_the_same_samples_give_the_same_bits() {
    let said = || {
        let mut filter = filter();
        let mut all = Vec::new();
        World::default().run(|truth, row| {
            for sample in row {
                let _ = filter.update(*sample);
            }
            if (truth.time * 2.0).fract() < 0.01 {
                all.push(format!("{:?}", filter.latest()));
            }
        });
        all
    };
    assert_eq!(said(), said());
}

#[test]
fn r6_each_refusal_is_counted_under_its_reason() {
    let mut filter = filter();
    let mut say = |time_ns, measurement| {
        let _ = filter.update(Sample {
            time_ns,
            measurement,
        });
        filter.latest().rejected
    };
    let row = 10_000_000;
    for i in 0..20 {
        say(i * row, Measurement::YawRate { rate: 0.0 });
    }
    assert_eq!(
        say(20 * row, Measurement::WheelCount { wheel: 99, raw: 0 }).unknown,
        1
    );
    assert_eq!(
        say(5 * row, Measurement::YawRate { rate: 0.0 }).not_later,
        1
    );
    say(21 * row, Measurement::YawRate { rate: f64::NAN });
    for i in 22..26 {
        say(i * row, Measurement::YawRate { rate: 0.0 });
    }
    let rejected = say(26 * row, Measurement::YawRate { rate: 0.0 });
    assert_eq!((rejected.bad_value, rejected.total()), (1, 3));
}

/// A NaN is refused by the call that brings it, of whatever sensor, not when the sample's turn in the buffer comes.
#[test]
fn a_nan_is_refused_at_once() {
    let nan = f64::NAN;
    for measurement in [
        Measurement::WheelAngle {
            wheel: 0,
            angle: nan,
        },
        Measurement::WheelRate {
            wheel: 0,
            rate: nan,
        },
        Measurement::WheelTorque {
            wheel: 0,
            torque: nan,
        },
        Measurement::SteeringAngle {
            wheel: 0,
            angle: nan,
        },
        Measurement::YawRate { rate: nan },
        Measurement::Acceleration {
            forward: 0.0,
            left: nan,
        },
        Measurement::Displacement {
            forward: 0.0,
            left: 0.0,
            turn: Some(nan),
        },
        Measurement::Pose {
            x: 0.0,
            y: nan,
            yaw: 0.0,
        },
        Measurement::Speed {
            forward: 0.0,
            left: Some(nan),
        },
        Measurement::Carrier {
            wheel: 0,
            turn: 0.0,
            forward: 0.0,
            up: nan,
        },
        Measurement::Command {
            forward: nan,
            left: 0.0,
        },
    ] {
        let mut filter =
            SlipFilter::new(&World::default().robot(), FilterSettings::default()).unwrap();
        let sample = Sample {
            time_ns: 0,
            measurement,
        };
        assert!(
            matches!(filter.update(sample), Err(Fault::NotFinite { .. })),
            "{measurement:?}"
        );
        assert_eq!(filter.latest().rejected.bad_value, 1);
    }
}

/// The first displacement has no period over which its speed could be judged, but its way is added up.
#[test]
fn a_first_displacement_beyond_every_place_is_refused() {
    for value in [1e9, -1e15, 1e38, -1e160, 1e308] {
        for (forward, left) in [(value, 0.0), (0.0, value)] {
            let mut filter = filter();
            for (time_ns, measurement) in [
                (
                    0,
                    Measurement::Displacement {
                        forward,
                        left,
                        turn: None,
                    },
                ),
                // beyond the horizon, after which the first is used
                (1_000_000_000, Measurement::YawRate { rate: 0.0 }),
            ] {
                let _ = filter.update(Sample {
                    time_ns,
                    measurement,
                });
            }
            assert_eq!(filter.latest().rejected.bad_value, 1);
        }
    }
}

/// All sensors but the counters of the powered wheels fail for three seconds: sigma grows meanwhile (R9), and two seconds
/// later all is as it was (R7).
#[test]
fn r7_r9_sigma_grows_under_a_fault_and_all_is_well_two_seconds_after() {
    let world = World::default();
    let free = world.powered;
    let mut filter = filter();
    let (mut before, mut during, mut last) = (0.0, Vec::new(), None);
    let mut worst = 0.0_f64;
    world.run(|truth, samples| {
        let lost = truth.time > 6.0 && truth.time < 9.0;
        for sample in samples {
            let powered =
                matches!(sample.measurement, Measurement::WheelCount { wheel, .. } if wheel != free);
            if !lost || powered {
                let _ = filter.update(*sample);
            }
        }
        let known = filter.latest();
        let sigma = known.body.forward.sigma();
        if truth.time > 5.9 && truth.time <= 6.0 {
            before = sigma;
        }
        if truth.time > 6.3 && truth.time < 9.0 {
            during.push(sigma);
            assert!(known.wheels[0].health != Health::Ok || truth.time < 6.6, "{}", truth.time);
        }
        if truth.time > 11.0 && truth.time < 12.0 {
            for wheel in 0..free {
                let (slip, sigma) = (known.wheels[wheel].slip.unwrap(), known.wheels[wheel].sigma.unwrap());
                worst = worst.max((slip.value() - truth.slips[wheel].unwrap()).abs() / sigma);
                assert_eq!(known.wheels[wheel].health, Health::Ok);
            }
        }
        last = Some(known.time_ns);
    });
    assert!(during.iter().all(|sigma| *sigma > before));
    println!(
        "sigma of the speed {before:.4}, {:.4} after it; slips within {worst:.1} sigma",
        during[during.len() - 1]
    );
    assert!(during[during.len() - 1] > 3.0 * before && worst < 4.0);
}
