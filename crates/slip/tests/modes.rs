//! The online filter over modes of the slip, against closed forms, known worlds and bad input.

use grouser_slip::modes::{Exceeds, JUMPING, ModeFilter, Refused, normal_tail};
use grouser_slip::motion::{
    Belief, Motion, OUTLIER_SIGMA, OUTLIERS, Row, SIZE, SLIP, Step, Value, WheelStep, X,
    slip_of_log, start,
};

use crate::motion_model::{drive, prior};
use crate::noise::Noise as Random;

fn filter(place_sigma: f64) -> ModeFilter {
    ModeFilter::new(start([0.0; 2], 0.0, true), prior(place_sigma).0, 2)
}

/// The filter after each step of a drive.
fn run(steps: &[Step], mut filter: ModeFilter, mut look: impl FnMut(&Step, &ModeFilter)) {
    for step in steps {
        filter.advance(step).unwrap();
        look(step, &filter);
    }
}

#[test]
fn a_reading_that_may_be_an_outlier_leaves_the_moments_of_both_updates() {
    let mut random = Random::new(3);
    for _ in 0..20 {
        let mut before = Belief::independent([0.2; SIZE], [0.7; SIZE]);
        for _ in 0..5 {
            let row: Row = core::array::from_fn(|_| random.normal());
            before.update(&row, random.normal(), 0.5);
        }
        let rows: [Row; 2] = core::array::from_fn(|_| core::array::from_fn(|_| random.normal()));
        let innovation = [4.0 * random.normal(), random.normal()];
        let (variance, share) = (0.3, OUTLIERS);
        let values: [f64; 2] = core::array::from_fn(|k| before.mean_of(&rows[k]) + innovation[k]);
        // numbers with independent noise, one after the other
        let after = |variance: f64| {
            let (mut belief, mut density) = (before, 1.0);
            for (row, value) in rows.iter().zip(values) {
                let innovation = value - belief.mean_of(row);
                let total = belief.update(row, innovation, variance).variance;
                density *= (-0.5 * innovation * innovation / total).exp() / total.sqrt();
            }
            (belief, density)
        };
        let (good, a) = after(variance);
        let (outlier, b) = after(variance * OUTLIER_SIGMA * OUTLIER_SIGMA);
        let (a, b) = ((1.0 - share) * a, share * b);
        let weight = a / (a + b);
        let mut found = before;
        let judgement = found.update_mixed(&rows, &values, variance);
        assert!((judgement.good - weight).abs() < 1e-12);
        assert!((judgement.likelihood - (a + b).ln()).abs() < 1e-9);
        // the noise of a good reading: what is left of the innovation, and how well that is known
        let square: f64 = (rows.iter().zip(values))
            .map(|(row, value)| (value - good.mean_of(row)).powi(2) + good.variance_of(row))
            .sum();
        assert!(
            (judgement.square - square).abs() < 1e-9,
            "{} {square}",
            judgement.square
        );
        for i in 0..SIZE {
            let mean = weight * good.mean[i] + (1.0 - weight) * outlier.mean[i];
            assert!((found.mean[i] - mean).abs() < 1e-12);
            for j in 0..SIZE {
                let of = |belief: &Belief| {
                    belief.covariance[i][j]
                        + (belief.mean[i] - found.mean[i]) * (belief.mean[j] - found.mean[j])
                };
                let expected = weight * of(&good) + (1.0 - weight) * of(&outlier);
                assert!((found.covariance[i][j] - expected).abs() < 1e-12);
            }
        }
    }
}

/// While the robot is stationary no slip wanders: all modes are one Kalman filter.
#[test]
fn modes_that_agree_are_one_kalman_filter() {
    let mut random = Random::new(5);
    let (levels, _) = prior(0.02);
    let mut plain = Motion::new(start([0.0; 2], 0.0, true));
    let mut modes = filter(0.02);
    for k in 1..400 {
        let wheels = [0.2, -0.2].map(|lever| WheelStep {
            distance: Some(0.0),
            variance: 1e-8,
            row: [1.0, 0.0, lever],
            across: [0.0, 1.0, 0.0],
            ..WheelStep::default()
        });
        let step = Step {
            frame: None,
            time: 0.05 * f64::from(k),
            dt: 0.05,
            wheels: wheels.to_vec(),
            turn: Some(0.01 * 0.05 + 1e-4 * random.normal()),
            force: Some([0.05 + 0.02 * random.normal(), 0.0]),
            readings: Vec::new(),
        };
        plain.advance(&step, &levels, 0.0, &mut [0.0; 2], None);
        modes.advance(&step).unwrap();
        let found = modes.belief();
        for i in 0..SIZE {
            assert!((found.mean[i] - plain.belief.mean[i]).abs() < 1e-9);
            for j in 0..SIZE {
                let (a, b) = (found.covariance[i][j], plain.belief.covariance[i][j]);
                assert!(
                    (a - b).abs() < 1e-9 * (1.0 + b.abs()),
                    "{k} {i} {j}: {a} {b}"
                );
            }
        }
    }
}

/// Speeds of 0.3 m/s noise at 1 m/s and 20 Hz: 0.3/√n of a steady slip.
#[test]
fn the_interval_of_a_steady_slip_shrinks_with_the_root_of_the_readings() {
    let mut random = Random::new(1);
    let mut steps = drive(|_| 0.1, 20.0, 1.0, 0.02, 1, None);
    for step in &mut steps {
        step.readings = vec![grouser_slip::motion::Reading {
            value: Value::Speed(1.0 + 0.3 * random.normal()),
            since: 0.0,
            scale: 100.0,
        }];
    }
    let mut sigmas = Vec::new();
    run(&steps, filter(0.02), |_, filter| {
        sigmas.push(filter.belief().covariance[SLIP][SLIP].sqrt());
    });
    let [early, late] = [sigmas[74], sigmas[299]];
    let ratio = early / late;
    println!("{early:.4} after 75 readings, {late:.4} after 300");
    assert!((1.4..3.0).contains(&ratio), "{ratio}");
    // the other modes are not ruled out, and widen it
    let known = 0.3 / 300_f64.sqrt();
    assert!(late > known && late < 3.0 * known, "{late} {known}");
}

fn jumping(time: f64) -> f64 {
    if time < 20.0 { 0.1 } else { 0.4 }
}

/// An accelerometer shows at once that the wheels, and not the robot, became faster; places show it with the second reading.
#[test]
fn the_jumping_mode_is_likely_after_a_jump_and_not_before() {
    for (force, within) in [(Some(0.05), 0.15), (None, 0.6)] {
        let steps = drive(jumping, 40.0, 0.5, 0.005, 2, force);
        let (mut first, mut before) = (None, 0.0_f64);
        run(&steps, filter(0.005), |step, filter| {
            let weight = filter.weights()[JUMPING];
            if step.time < 20.0 && step.time > 5.0 {
                before = before.max(weight);
            } else if weight > 0.5 && first.is_none() {
                first = Some(step.time);
            }
        });
        println!("{force:?}: {before:.3} before, {first:?}");
        assert!(before < 0.5, "{before}");
        let first = first.expect("the jump is found");
        assert!(first >= 20.0 && first < 20.0 + within + 0.05, "{first}");
    }
}

#[test]
fn an_outlier_does_not_move_the_estimate() {
    let clean = drive(|_| 0.2, 30.0, 1.0, 0.02, 3, None);
    let mut steps = clean.clone();
    let step = steps
        .iter_mut()
        .filter(|step| !step.readings.is_empty())
        .nth(100);
    let step = step.unwrap();
    step.readings[0].value = Value::Place([step.time + 1.0, -1.0]);
    let mut expected = Vec::new();
    run(&clean, filter(0.02), |_, filter| {
        expected.push(*filter.belief());
    });
    let mut expected = expected.iter();
    run(&steps, filter(0.02), |step, filter| {
        let (found, expected) = (filter.belief(), expected.next().unwrap());
        let off = (found.mean[SLIP] - expected.mean[SLIP]).abs();
        assert!(off < 0.02, "{}: {off}", step.time);
        assert!((found.mean[X] - expected.mean[X]).abs() < 0.02);
    });
}

/// From 20 s on all places are 0.5 m ahead: 25 sigma, by a map that jumped.
#[test]
fn a_reference_that_stays_after_a_jump_is_followed_again() {
    let mut steps = drive(|_| 0.2, 40.0, 0.5, 0.02, 4, None);
    for step in steps.iter_mut().filter(|step| step.time >= 20.0) {
        for reading in &mut step.readings {
            if let Value::Place(place) = &mut reading.value {
                place[0] += 0.5;
            }
        }
    }
    run(&steps, filter(0.02), |step, filter| {
        let place = filter.belief().mean[X] - (0.5 * step.time + 0.5);
        let (slip, _) = slip_of_log(filter.belief().mean[SLIP]);
        if step.time > 23.0 {
            assert!(place.abs() < 0.1, "{}: place {place}", step.time);
        }
        if step.time > 26.0 {
            assert!((slip - 0.2).abs() < 0.1, "{}: slip {slip}", step.time);
        }
    });
}

#[test]
fn intervals_hold_where_slip_wanders() {
    let (mut inside, mut count) = (0, 0);
    for seed in 0..8 {
        let slip = |time: f64| 0.2 + 0.1 * (0.7 * time).sin() + 0.05 * (1.9 * time).cos();
        let steps = drive(slip, 60.0, 0.5, 0.01, seed, None);
        run(&steps, filter(0.01), |step, filter| {
            if step.time < 5.0 {
                return;
            }
            let found = filter.wheel_slip(0).unwrap();
            let error = found.slip - slip(step.time);
            count += 1;
            inside += usize::from(error.abs() <= 1.645 * found.variance.sqrt());
        });
    }
    println!("{inside} of {count}");
    assert!(inside * 100 > 80 * count && inside * 100 < 99 * count);
}

#[test]
fn high_slip_is_called_by_its_probability_and_a_lower_slip_is_not() {
    for (high, within) in [(0.8, Some(1.5)), (0.45, None)] {
        let slip = |time: f64| if time < 20.0 { 0.1 } else { high };
        let steps = drive(slip, 40.0, 0.1, 0.005, 6, None);
        let mut detector = Exceeds::HIGH_SLIP;
        let mut called = None;
        run(&steps, filter(0.005), |step, filter| {
            let probability = filter.exceeds(1, 0.6);
            assert!(probability.is_some_and(|of| (0.0..=1.0).contains(&of)));
            assert_eq!(filter.exceeds(1, f64::NAN), None);
            if detector.advance(probability, step.dt) && called.is_none() {
                called = Some(step.time - 20.0);
            }
        });
        println!("{high}: {called:?}");
        match within {
            Some(within) => assert!(
                called.is_some_and(|of| of > 0.0 && of < within),
                "{called:?}"
            ),
            None => assert_eq!(called, None),
        }
    }
    assert_eq!(
        filter(0.1).exceeds(7, 0.6),
        None,
        "a wheel that there is not"
    );
}

#[test]
fn a_probability_must_last_before_it_is_called() {
    let mut detector = Exceeds::new(0.9, 0.2);
    let mut called = Vec::new();
    for probability in [0.95, 0.95, 0.5, 0.95, 0.95, 0.95, 0.95] {
        called.push(detector.advance(Some(probability), 0.0625));
    }
    assert_eq!(called, [false, false, false, false, false, false, true]);
    assert!(!detector.advance(None, 0.0625), "a slip that is not known");
    // erfc by its continued fraction, far out
    assert!((normal_tail(4.0) - 3.167e-5).abs() < 1e-7);
}

/// A wheel that alone breaks loose has a slip of its own.
#[test]
fn a_wheel_that_slips_alone_has_its_own_slip() {
    let mut steps = drive(|_| 0.1, 30.0, 0.5, 0.01, 8, None);
    for step in steps.iter_mut().filter(|step| step.time > 15.0) {
        // the left wheel turns twice as fast
        step.wheels[1].distance = step.wheels[1].distance.map(|of| 2.0 * of);
    }
    let (mut squares, mut count) = ([0.0; 2], 0.0);
    run(&steps, filter(0.01), |step, filter| {
        if step.time < 17.0 {
            return;
        }
        count += 1.0;
        for (wheel, true_slip) in [0.1, 0.55].into_iter().enumerate() {
            squares[wheel] += (filter.wheel_slip(wheel).unwrap().slip - true_slip).powi(2);
        }
    });
    let rmse = squares.map(|of: f64| (of / count).sqrt());
    println!("{rmse:?}");
    // a mean over a second of places of 1 cm: 0.01 √2/0.5 = 0.03
    assert!(rmse.iter().all(|&of| of < 0.03), "{rmse:?}");
}

/// Writes a number into a step.
type Spoil = fn(&mut Step, f64);

#[test]
fn what_is_no_number_is_refused_and_changes_nothing() {
    let steps = drive(|_| 0.1, 5.0, 0.5, 0.02, 9, Some(0.05));
    let mut filter = filter(0.02);
    let good = steps.iter().find(|step| !step.readings.is_empty()).unwrap();
    filter.advance(good).unwrap();
    let before = *filter.belief();
    let fields: [(&str, Spoil); 10] = [
        ("time", |step, bad| step.time = bad),
        ("length of the step", |step, bad| step.dt = bad),
        ("wheel distance", |step, bad| {
            step.wheels[1].distance = Some(bad);
        }),
        ("wheel distance variance", |step, bad| {
            step.wheels[0].variance = bad;
        }),
        ("wheel row", |step, bad| step.wheels[0].across[2] = bad),
        ("turn", |step, bad| step.turn = Some(bad)),
        ("specific force", |step, bad| step.force = Some([0.0, bad])),
        ("place", |step, bad| {
            step.readings[0].value = Value::Place([0.0, bad]);
        }),
        ("age of a reading", |step, bad| step.readings[0].since = bad),
        ("scale of a reading", |step, bad| {
            step.readings[0].scale = bad;
        }),
    ];
    for (name, spoil) in fields {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut step = good.clone();
            spoil(&mut step, bad);
            match filter.advance(&step) {
                Err(Refused::OutOfRange(of)) => assert_eq!(of.field, name),
                other => panic!("{name} {bad}: {other:?}"),
            }
            assert_eq!(*filter.belief(), before);
        }
    }
    let mut step = good.clone();
    step.wheels.pop();
    let refused = filter.advance(&step).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the step has 1 wheels, but the robot has 2"
    );
    assert_eq!(*filter.belief(), before);
}

/// Any numbers within the limits: nothing becomes NaN.
#[test]
fn wild_numbers_leave_numbers() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut steps = drive(|_| 0.1, 5.0, 0.5, 0.02, seed, Some(0.05));
        let wild = |random: &mut Random| {
            let size = 10_f64.powf(12.0 * random.uniform() - 9.0);
            if random.bits().is_multiple_of(2) {
                size
            } else {
                -size
            }
        };
        for step in &mut steps {
            match random.below(8) {
                0 => step.wheels[0].distance = Some(wild(&mut random)),
                1 => step.wheels[1].variance = wild(&mut random).abs().max(1e-12),
                2 => step.turn = Some(wild(&mut random)),
                3 => step.force = Some([wild(&mut random), 0.0]),
                4 => step.dt = wild(&mut random).abs().clamp(1e-4, 1e2),
                5 => step.wheels[0].distance = None,
                6 => {
                    for reading in &mut step.readings {
                        reading.value = Value::Place([1e6 * wild(&mut random), wild(&mut random)]);
                    }
                }
                _ => {}
            }
        }
        run(&steps, filter(0.02), |step, filter| {
            let belief = filter.belief();
            let numbers = belief.mean.iter().chain(belief.covariance.as_flattened());
            for number in numbers.chain(filter.weights()) {
                assert!(number.is_finite(), "{seed} {}: {belief:?}", step.time);
            }
            for (i, row) in belief.covariance.iter().enumerate() {
                assert!(row[i] >= 0.0, "{seed} {} {i}: {}", step.time, row[i]);
            }
            if let Some(slip) = filter.wheel_slip(0) {
                assert!(slip.slip.abs() <= 1.0 && slip.variance >= 0.0, "{slip:?}");
            }
        });
    }
}

#[test]
fn a_step_allocates_nothing_and_is_the_same_each_time() {
    let steps = drive(jumping, 30.0, 0.5, 0.02, 10, Some(0.05));
    let mut first = filter(0.02);
    let mut second = first.clone();
    let mut results = [Ok(()); 2];
    let counts = allocation_counter::measure(|| {
        for step in &steps {
            results[0] = results[0].and(first.advance(step));
        }
    });
    assert_eq!(counts.count_total, 0);
    for step in &steps {
        results[1] = results[1].and(second.advance(step));
    }
    assert_eq!(results, [Ok(()); 2]);
    assert_eq!(first.belief(), second.belief());
    assert_eq!(first.weights(), second.weights());
}
