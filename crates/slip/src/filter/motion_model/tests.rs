use super::*;
use crate::filter::kalman::tests::{assert_near, dense, filled, identity, sandwich};

const DT_S: f64 = 0.13;
const WHEELS: usize = 2;
/// Process noise density of the speeds.
const DENSITY_M_PER_S_SQRT_S: f64 = 0.21;

fn settings() -> FilterSettings {
    FilterSettings {
        max_speed: 3.0,
        // a limit above all variances of the test's state
        gyro_bias: 7.0,
        accelerometer_bias: 8.0,
        gyro_drift: 0.4,
        accelerometer_drift: 0.6,
        yaw_walk: 0.9,
        slip: SlipPrior {
            mean: 0.15,
            sigma: 0.3,
        },
        free_slip: SlipPrior {
            mean: -0.2,
            sigma: 1.2,
        },
        slip_memory: 2.5,
        wheel_slip_memory: 0.7,
        wheel_slip_sigma: 0.4,
        free_slip_memory: 30.0,
        ..FilterSettings::default()
    }
}

#[test]
fn numbers_have_their_places() {
    let places = [
        own_slip(1),
        radius(1),
        remainder(1, false),
        remainder(1, true),
        size(2),
    ];
    assert_eq!(places, [14, 15, 16, 17, 18]);
}

/// The covariance by the matrix of the linearised motion, F P Fᵀ + Q.
#[test]
fn a_prediction_is_that_of_the_linearised_motion() {
    const FORCE_M_PER_S2: [f64; 2] = [0.8, -1.1];
    for has_force in [false, true] {
        let mut state = filled(size(WHEELS));
        let mean = |state: &Kalman, i| state.mean(i);
        let [v_x, v_y, yaw, heading] = [FORWARD, LEFT, YAW, HEADING].map(|i| mean(&state, i));
        let (sin, cos) = f64::sin_cos(heading + yaw * DT_S / 2.0);
        let step = [
            (cos * v_x - sin * v_y) * DT_S,
            (sin * v_x + cos * v_y) * DT_S,
        ];
        let mut matrix = identity(size(WHEELS));
        let [x, y] = PLACE;
        for (to, from, coefficient) in [
            (x, HEADING, -step[1]),
            (y, HEADING, step[0]),
            (x, FORWARD, cos * DT_S),
            (x, LEFT, -sin * DT_S),
            (y, FORWARD, sin * DT_S),
            (y, LEFT, cos * DT_S),
            (HEADING, YAW, DT_S),
        ] {
            matrix[to][from] = coefficient;
        }
        let mut gained = [0.0; 2];
        if has_force {
            (matrix[FORWARD][FORWARD_BIAS], matrix[LEFT][LEFT_BIAS]) = (-DT_S, -DT_S);
            gained = [
                (FORCE_M_PER_S2[0] - state.mean(FORWARD_BIAS) + yaw * v_y) * DT_S,
                (FORCE_M_PER_S2[1] - state.mean(LEFT_BIAS) - yaw * v_x) * DT_S,
            ];
        }
        let settings = settings();
        let mut expected = sandwich(&matrix, &dense(&state));
        for (i, density) in [
            (FORWARD, DENSITY_M_PER_S_SQRT_S),
            (LEFT, DENSITY_M_PER_S_SQRT_S),
            (YAW, settings.yaw_walk),
            (GYRO_BIAS, settings.gyro_drift),
            (FORWARD_BIAS, settings.accelerometer_drift),
            (LEFT_BIAS, settings.accelerometer_drift),
        ] {
            expected[i][i] += density * density * DT_S;
        }
        let means = [
            (x, state.mean(x) + step[0]),
            (y, state.mean(y) + step[1]),
            (HEADING, heading + yaw * DT_S),
            (FORWARD, v_x + gained[0]),
            (LEFT, v_y + gained[1]),
            (YAW, yaw),
            (COMMON_SLIP, state.mean(COMMON_SLIP)),
        ];
        let force = has_force.then_some(SpecificForce {
            time_ns: 0,
            force: FORCE_M_PER_S2,
        });
        let is = predict(&mut state, &settings, DT_S, force, DENSITY_M_PER_S_SQRT_S);
        assert!((0..2).all(|i| (is[i] - gained[i]).abs() < 1e-14));
        assert_near(&state, &expected, "motion");
        for (i, mean) in means {
            assert!((state.mean(i) - mean).abs() < 1e-14, "{i}");
        }
    }
}

#[test]
fn a_prediction_stays_within_its_limits() {
    let settings = settings();
    let mut state = filled(size(WHEELS));
    let limits = [
        (FORWARD, settings.max_speed * settings.max_speed),
        (LEFT, settings.max_speed * settings.max_speed),
        (YAW, MAX_YAW_RATE_VARIANCE),
        (GYRO_BIAS, settings.gyro_bias * settings.gyro_bias),
        (
            FORWARD_BIAS,
            settings.accelerometer_bias * settings.accelerometer_bias,
        ),
        (
            LEFT_BIAS,
            settings.accelerometer_bias * settings.accelerometer_bias,
        ),
    ];
    for (i, limit) in limits {
        state.reset(i, 0.0, limit * (1.0 - 1e-12));
    }
    for i in [PLACE[0], PLACE[1], HEADING] {
        state.reset(i, MAX_PLACE, 2.0 * MAX_PLACE * MAX_PLACE);
    }
    state.set_mean(YAW, 0.2);
    state.set_mean(HEADING, 0.5 - 0.1 * DT_S);
    for (i, speed) in [(FORWARD, 2.9), (LEFT, -2.9)] {
        state.set_mean(i, speed);
    }
    let force = Some(SpecificForce {
        time_ns: 0,
        force: [15.0, -15.0],
    });
    predict(&mut state, &settings, DT_S, force, 100.0);
    // forces would lead beyond the highest speed; both places grow at a heading of 0.5 rad but the second
    assert_eq!((state.mean(FORWARD), state.mean(LEFT)), (3.0, -3.0));
    assert_eq!(state.mean(PLACE[0]), MAX_PLACE);
    for i in [PLACE[0], PLACE[1], HEADING] {
        assert_eq!(state.covariance(i, i), MAX_PLACE * MAX_PLACE, "{i}");
    }
    for i in [YAW, GYRO_BIAS] {
        let limit = limits.iter().find(|(j, _)| *j == i).unwrap().1;
        assert_eq!(state.covariance(i, i), limit, "{i}");
    }
    // the motion starts from rest, as certain as a robot that may move at up to its highest speed
    reset(&mut state, &settings);
    let slow = FilterSettings {
        max_speed: 0.3,
        ..settings
    };
    let mut slower = state.clone();
    reset(&mut slower, &slow);
    for (state, speed_sigma) in [(&state, 1.0), (&slower, 0.3)] {
        for (i, sigma) in [
            (FORWARD, speed_sigma),
            (LEFT, speed_sigma),
            (YAW, 1.0),
            (GYRO_BIAS, settings.gyro_bias),
            (FORWARD_BIAS, settings.accelerometer_bias),
            (LEFT_BIAS, settings.accelerometer_bias),
        ] {
            assert_eq!(
                (state.mean(i), state.covariance(i, i)),
                (0.0, sigma * sigma),
                "{i}"
            );
        }
    }
    // 0.6 of a speed of 0.2 ± 1 m/s is 0.5 ± 0.8 m/s
    state.set_mean(FORWARD, 0.2);
    hold(&mut state, [0.6, 0.0, 0.0], 0.5, 0.8);
    let gain = 0.6 / (0.36 + 0.64);
    assert!((state.mean(FORWARD) - 0.2 - gain * (0.5 - 0.12)).abs() < 1e-15);
    // the place is considered: a measurement of it moves nothing
    let place = [PLACE[0], PLACE[1], HEADING].map(|i| state.mean(i));
    for i in [PLACE[0], PLACE[1], HEADING] {
        state.update(&ScalarMeasurement {
            jacobian: &[(i, 1.0)],
            residual: 1e8,
            variance: 1.0,
        });
    }
    assert_eq!(place, [PLACE[0], PLACE[1], HEADING].map(|i| state.mean(i)));
}

#[test]
fn a_place_is_decorrelated_by_what_the_robot_may_have_moved() {
    let mut state = filled(size(WHEELS));
    let before = dense(&state);
    reset_place(&mut state, 0.7, 0.3);
    for (i, off) in [(PLACE[0], 0.7), (PLACE[1], 0.7), (HEADING, 0.3)] {
        assert!((state.covariance(i, i) - before[i][i] - off * off).abs() < 1e-14);
        assert!((0..size(WHEELS)).all(|j| i == j || state.covariance(i, j) == 0.0));
        assert_eq!(state.mean(i), filled(size(WHEELS)).mean(i));
    }
    assert_eq!(state.covariance(FORWARD, YAW), before[FORWARD][YAW]);
}

#[test]
fn slips_decay_to_their_priors() {
    const NOISE_SCALE: f64 = 2.3;
    let settings = settings();
    // a skid of −0.2 by the robot's speed is −0.25 by the rim's, its sigma 1/0.8² times as large
    let (skid, skid_sigma) = (-0.25, 1.2 / 0.64);
    for doubt in [2.0 * (1.0 + 1e-9), 2.0 * (1.0 - 1e-9)] {
        let mut state = filled(size(WHEELS));
        let doubted = doubt * skid_sigma * skid_sigma;
        state.reset(own_slip(1), 0.4, doubted);
        state.set_covariance(own_slip(1), FORWARD, 0.1);
        assert_eq!(is_doubted(&state, &settings, 1), doubt > 2.0);
        let memory = if doubt > 2.0 { 10.0 } else { 30.0 };
        let before = state.clone();
        let mut matrix = identity(size(WHEELS));
        let own_sigma = 0.4 * f64::sqrt(NOISE_SCALE);
        let slips = [
            (COMMON_SLIP, 2.5, 0.15, 0.3),
            (own_slip(0), 0.7, 0.0, own_sigma),
            (own_slip(1), memory, skid, skid_sigma),
        ];
        for (i, memory, ..) in slips {
            matrix[i][i] = f64::exp(-DT_S / memory);
        }
        let mut expected = sandwich(&matrix, &dense(&state));
        let wheels = [(false, NOISE_SCALE), (true, 1.0)].into_iter();
        predict_slips(&mut state, &settings, DT_S, wheels);
        for (i, _, prior, sigma) in slips {
            let a = matrix[i][i];
            expected[i][i] += (1.0 - a * a) * sigma * sigma;
            let mean = prior + a * (before.mean(i) - prior);
            assert!((state.mean(i) - mean).abs() < 1e-14, "{i}");
        }
        assert_near(&state, &expected, "slips");
    }
    // twice the prior's variance is no doubt, to the bit
    let even = FilterSettings {
        free_slip: SlipPrior {
            mean: 0.1,
            sigma: 0.5,
        },
        ..settings
    };
    let mut state = filled(size(1));
    state.reset(own_slip(0), 0.4, 0.5);
    assert!(!is_doubted(&state, &even, 0));
    // a skid that decays faster than its doubt keeps its own time
    let brief = FilterSettings {
        free_slip_memory: 4.0,
        ..settings
    };
    let mut state = filled(size(1));
    state.reset(own_slip(0), 0.4, 99.0);
    predict_slips(&mut state, &brief, DT_S, [(true, 1.0)].into_iter());
    let mean = skid + f64::exp(-DT_S / 4.0) * (0.4 - skid);
    assert!((state.mean(own_slip(0)) - mean).abs() < 1e-14);
}
