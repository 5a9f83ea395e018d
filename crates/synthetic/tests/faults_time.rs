//! Faults of time (B1 to B11), put into the five-wheeled robot's run.
#![allow(
    clippy::cast_possible_wrap,
    reason = "a test fails by panicking and may say what it measured"
)]

use grouser_slip::{Counter, CounterWidth, Health, Measurement, Sample};
use grouser_synthetic::{Camera, Fault};

use crate::trial::{END_S, FREE, Outcome, PHASES, Trial, honest};

const SECOND: i64 = 1_000_000_000;
const YEAR: i64 = 31_557_600 * SECOND;

fn is_good(out: &Outcome, from: f64, to: f64) -> bool {
    let mut some = false;
    out.between(from, to).all(|moment| {
        some = true;
        (0..FREE).all(|wheel| moment.wheels[wheel].health == Health::Ok)
    }) && some
}

#[test]
fn samples_that_come_twice_change_little() {
    let nominal = Trial::new(1).run();
    for differs in [false, true] {
        for (phase, from) in PHASES {
            let out = Trial::new(1)
                .fault(Fault::Repeated(differs), from, from + 2.0)
                .run();
            honest(&out, phase);
            assert!(out.refused > 0, "{phase}: counted");
            let ratio = out.rms(5.0, 23.0) / nominal.rms(5.0, 23.0);
            println!("twice, differs {differs}, {phase}: rms {ratio:.2} of nominal");
            assert!(ratio < 1.2, "{phase}");
        }
    }
}

#[test]
fn a_clock_that_goes_back_once_costs_its_row() {
    let nominal = Trial::new(2).run();
    for off in [-1_000, -SECOND, -YEAR] {
        for (phase, from) in PHASES {
            let trial = Trial::new(2).fault(Fault::ClockOnce(off), from, END_S);
            let out = trial.run();
            honest(&out, phase);
            let ratio = out.rms(5.0, 23.0) / nominal.rms(5.0, 23.0);
            assert!(ratio < 1.2, "{phase} {off} ns: {ratio}");
        }
    }
}

#[test]
fn a_clock_that_was_set_is_followed_within_a_second() {
    for off in [-SECOND, -YEAR, 10 * SECOND, 50 * YEAR] {
        for (phase, from) in PHASES {
            let trial = Trial::new(2).fault(Fault::Clock(off), from, END_S);
            let out = trial.run_by_true_time();
            honest(&out, phase);
            // one sample of each of the eleven sensors
            assert!(
                out.refused >= 1 && out.refused <= 11,
                "{phase} {off} ns: {} refused",
                out.refused
            );
            let back = (from + 1.0).max(3.5);
            assert!(
                out.between(back, back + 0.1).count() > 1,
                "{phase} {off} ns: nothing is known a second after"
            );
            if back < 18.0 {
                assert!(is_good(&out, back, back + 1.0), "{phase} {off} ns");
                assert!(
                    out.rms(back, 19.0) < 0.05,
                    "{phase} {off} ns: {}",
                    out.rms(back, 19.0)
                );
            }
        }
    }
}

#[test]
fn one_row_from_the_future_costs_that_row() {
    let nominal = Trial::new(3).run();
    for off in [10 * SECOND, 50 * YEAR] {
        for (phase, from) in PHASES {
            let trial = Trial::new(3).fault(Fault::ClockOnce(off), from, END_S);
            let out = trial.run();
            honest(&out, phase);
            // the row's samples and no other: the clock was not set
            assert!(
                out.refused >= 1 && out.refused <= 11,
                "{phase} {off} ns: {} refused",
                out.refused
            );
            let ratio = out.rms(5.0, 23.0) / nominal.rms(5.0, 23.0);
            assert!(ratio < 1.2, "{phase} {off} ns: {ratio}");
        }
    }
}

#[test]
fn late_samples_cost_little() {
    let nominal = Trial::new(4).run();
    // by nearly two rows: samples overtake each other
    let late = Fault::Shuffled(18_000_000);
    for (phase, from) in PHASES {
        let out = Trial::new(4).fault(late, from, from + 10.0).run();
        honest(&out, phase);
        let ratio = out.rms(5.0, 23.0) / nominal.rms(5.0, 23.0);
        println!(
            "late, {phase}: rms {ratio:.3} of nominal, {} refused",
            out.refused
        );
        assert!(ratio <= 1.2, "{phase}");
        // the filter waits for what is late
        assert_eq!(out.refused, 0, "{phase}");
    }
}

#[test]
fn a_clock_of_32_bits_goes_round_seamlessly_and_one_of_64_ends_in_a_fault() {
    // microseconds of 32 bits, unwrapped as every counter is
    let mut clock = Counter::new(CounterWidth::new(32).unwrap());
    let start = u64::from(u32::MAX) - 5_000_000;
    let unwrapped: Vec<i64> = (0..2600_u64)
        .map(|row| {
            clock.advance((start + row * 10_000) % (1 << 32));
            i64::try_from(clock.total()).unwrap() * 1000
        })
        .collect();
    let trial = Trial::new(5);
    let (course, samples) = trial.samples();
    let wrapped: Vec<Sample> = samples
        .iter()
        .map(|sample| Sample {
            time_ns: unwrapped[usize::try_from(sample.time_ns / 10_000_000).unwrap()],
            ..*sample
        })
        .collect();
    assert_eq!(wrapped, samples);
    // nanoseconds that run over the end of 64 bits: refused, then followed
    let mut trial = Trial::new(5);
    trial.sensors.start_ns = i64::MAX - 12 * SECOND;
    let out = {
        let (_, samples) = trial.samples();
        let true_ns: Vec<i64> = samples
            .iter()
            .map(|s| s.time_ns.wrapping_sub(trial.sensors.start_ns))
            .collect();
        trial.sensors.start_ns = 0;
        trial.follow_by(&course, &samples, Some(&true_ns))
    };
    honest(&out, "end of time");
    assert!(out.refused >= 1 && out.refused <= 11);
    assert!(is_good(&out, 13.5, 16.0));
}

#[test]
fn a_camera_that_comes_late_is_put_where_it_belongs_if_it_says_so() {
    let run = |alone: bool, late: usize, declared: f64| {
        let mut trial = Trial::new(7);
        if alone {
            trial.faults.push((Fault::WheelSilent(FREE), (0.0, END_S)));
        }
        trial.sensors.camera = Some(Camera {
            every: 5,
            sigma: 0.001,
            late,
        });
        trial.settings.reference_latency = declared;
        trial.robot.legs[2].speed = 0.15;
        trial.run()
    };
    for alone in [false, true] {
        let nominal = run(alone, 0, 0.0);
        for late in [5, 10, 30] {
            let declared = run(alone, late, 0.01 * late as f64);
            honest(&declared, "declared");
            let ratio = declared.rms(4.0, 23.0) / nominal.rms(4.0, 23.0);
            println!("camera {late}0 ms late, alone {alone}: rms {ratio:.2} of nominal");
            // 0.3 s without a reading have to be predicted
            assert!(ratio <= 1.4);
            let (lasted, ..) = run(alone, late, 0.0).silence();
            assert!(lasted <= 1.5, "not declared: {lasted:.2} s");
        }
        let (lasted, ..) = run(alone, 0, 0.3).silence();
        assert!(lasted <= 1.5, "declared and not so: {lasted:.2} s");
    }
}

#[test]
fn the_order_within_the_horizon_does_not_matter() {
    let (course, ordered) = Trial::new(8).samples();
    let (_, shuffled) = Trial::new(8)
        .fault(Fault::Shuffled(9_000_000), 0.0, END_S)
        .samples();
    assert_ne!(ordered, shuffled);
    let last = |samples: &[Sample]| {
        let mut filter = Trial::new(8).filter();
        for sample in samples {
            filter.update(*sample).unwrap();
        }
        // let what waits come through
        for step in 1..=10 {
            let time_ns = (i64::try_from(course.steps.len()).unwrap() + step) * 10_000_000;
            let rate = Measurement::YawRate { rate: 0.0 };
            filter
                .update(Sample {
                    time_ns,
                    measurement: rate,
                })
                .unwrap();
        }
        format!("{:?}", filter.latest())
    };
    assert_eq!(last(&ordered), last(&shuffled));
    // what is older than the horizon is refused, and counted
    let mut filter = Trial::new(8).filter();
    for sample in &ordered[..5000] {
        filter.update(*sample).unwrap();
    }
    let old = Sample {
        time_ns: ordered[5000].time_ns - 50_000_000,
        measurement: Measurement::YawRate { rate: 0.0 },
    };
    assert!(filter.update(old).is_err());
    assert_eq!(filter.latest().rejected.total(), 1);
}

#[test]
fn steps_of_time_of_any_size_are_survived() {
    let mut filter = Trial::new(9).filter();
    let mut time_ns = 0_i64;
    let mut raw = 0_u64;
    for step in [
        1,
        100_000,
        10_000_000,
        100_000_000,
        1_000_000_000_000,
        0,
        -1,
        i64::MAX / 4,
        i64::MIN / 4,
    ] {
        for _ in 0..200 {
            time_ns = time_ns.wrapping_add(step);
            raw = raw.wrapping_add(3);
            for wheel in 0..5 {
                let _ = filter.update(Sample {
                    time_ns,
                    measurement: Measurement::WheelCount { wheel, raw },
                });
            }
            let known = filter.latest();
            assert!(
                known.body.forward.value.is_finite() && known.body.forward.variance.is_finite()
            );
        }
    }
}

#[test]
fn a_rate_ten_times_lower_is_followed() {
    for (phase, from) in [("converge", 2.5), ("steady", 7.0)] {
        let out = Trial::new(10).fault(Fault::RowsLost(10), from, 20.0).run();
        honest(&out, phase);
        let nees = out.nees(from + 2.0, 11.0);
        println!(
            "10 Hz, {phase}: rms {:.3}, nees {nees:.2}",
            out.rms(from + 2.0, 20.0)
        );
        assert!(nees < 2.0);
        assert!(out.rms(from + 2.0, 11.0) < 0.04);
    }
}

#[test]
fn a_pause_at_the_start_does_not_diverge() {
    for from in [0.0, 0.02, 0.1, 1.0] {
        let out = Trial::new(11)
            .fault(Fault::AllSilent, from, from + 1.5)
            .run();
        honest(&out, "pause");
        assert!(is_good(&out, 5.0, 10.0), "{from}");
        assert!(out.rms(5.0, 10.0) < 0.03);
    }
}
