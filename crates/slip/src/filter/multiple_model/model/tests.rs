use super::*;

mod changes;

type Matrix = [[f64; STATES]; STATES];

const STEP_S: f64 = 0.4;
/// A slip, the robot's share of the rims' way, and its derivative: driving, and braking.
const SLIP_SHARE_SLOPES: [(f64, f64, f64); 2] = [(0.2, 0.8, -1.0), (-0.2, 1.25, -1.5625)];
/// Exact in all their parts: differences are rounding.
const ROUNDING: f64 = 1e-9;

pub(in super::super) fn matrix(entry: impl Fn(usize, usize) -> f64) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)))
}

/// A B Aᵀ.
fn congruent(a: &Matrix, b: &Matrix) -> Matrix {
    let states = 0..STATES;
    matrix(|i, j| {
        let of = |k: usize| {
            states
                .clone()
                .map(|l| a[i][k] * b[k][l] * a[j][l])
                .sum::<f64>()
        };
        states.clone().map(of).sum()
    })
}

/// A hypothesis with correlations between all its states.
pub(in super::super) fn correlated(slip_noise: f64, bias_noise: f64) -> Model {
    let mut model = Model::new(slip_noise, bias_noise);
    model.mean = [1.5, -2.5, 0.7, 0.3, 0.2, 0.13, 0.05, 0.03];
    let root = matrix(|i, j| {
        let part = 0.2 / (2.0 + i as f64 + 3.0 * j as f64);
        if i == j { 0.3 + part } else { part }
    });
    model.covariance = congruent(&root, &matrix(|i, j| f64::from(u8::from(i == j))));
    model
}

pub(in super::super) fn assert_near(model: &Model, mean: [f64; STATES], covariance: &Matrix) {
    let near = |found: &[f64; STATES], is: &[f64; STATES]| {
        let mut pairs = found.iter().zip(is);
        assert!(
            pairs.all(|(found, is)| (found - is).abs() < ROUNDING),
            "{found:?} {is:?}"
        );
    };
    near(&model.mean, &mean);
    for (found, is) in model.covariance.iter().zip(covariance) {
        near(found, is);
    }
}

/// The moments of a mixture: E[x], E[x xᵀ] − E[x] E[x]ᵀ.
pub(in super::super) fn mixture(models: &[Model], shares: &[f64]) -> ([f64; STATES], Matrix) {
    let over = |of: &dyn Fn(&Model) -> f64| -> f64 {
        models
            .iter()
            .zip(shares)
            .map(|(model, share)| share * of(model))
            .sum()
    };
    let mean = core::array::from_fn(|i| over(&|model| model.mean[i]));
    let square = |i: usize, j: usize| {
        over(&|model| model.covariance[i][j] + model.mean[i] * model.mean[j]) - mean[i] * mean[j]
    };
    (mean, matrix(square))
}

/// Kalman's update by h x = measured.
fn updated(model: &Model, h: [f64; STATES], residual: f64, variance: f64) -> (Model, f64) {
    let p = &model.covariance;
    let spread: [f64; STATES] = core::array::from_fn(|i| (0..STATES).map(|j| p[i][j] * h[j]).sum());
    let total = variance + (0..STATES).map(|i| h[i] * spread[i]).sum::<f64>();
    let mut after = *model;
    after.mean = core::array::from_fn(|i| model.mean[i] + spread[i] / total * residual);
    after.covariance = matrix(|i, j| p[i][j] - spread[i] * spread[j] / total);
    (
        after,
        f64::exp(-0.5 * residual * residual / total) / f64::sqrt(total),
    )
}

/// The same where one reading in fifty is an outlier of thirty times the standard deviation.
fn robust(model: &Model, h: [f64; STATES], residual: f64, variance: f64) -> (Model, f64) {
    let (good, as_good) = updated(model, h, residual, variance);
    let (bad, as_bad) = updated(model, h, residual, 900.0 * variance);
    let (as_good, as_bad) = (0.98 * as_good, 0.02 * as_bad);
    let likelihood = as_good + as_bad;
    let mut after = *model;
    let shares = [as_good / likelihood, as_bad / likelihood];
    (after.mean, after.covariance) = mixture(&[good, bad], &shares);
    (after, likelihood)
}

fn unit(state: usize, slope: f64) -> [f64; STATES] {
    core::array::from_fn(|i| if i == state { slope } else { 0.0 })
}

fn step(acceleration: Option<(f64, f64)>, curvature: Option<f64>) -> Step {
    Step {
        dt: STEP_S,
        rim_way: -0.17,
        direction: 0.25,
        turn: 0.09,
        curvature,
        turn_error: TurnError {
            by_gyro: true,
            removed: 0.0,
            sigma: 0.9,
            memory: 1.7,
        },
        removed: 0.011,
        acceleration,
        max_slip: MAX_SLIP,
    }
}

/// Prediction as x ← f(x), P ← F (D P D + noise of the turn rate) Fᵀ + noise, in matrices.
fn predicted(model: &Model, step: &Step) -> ([f64; STATES], Matrix) {
    let dt = step.dt;
    let [x, y, heading, speed, slip, drift, bias, error] = model.mean;
    let TurnError { sigma, memory, .. } = step.turn_error;
    let kept = 1.0 - f64::min(dt / memory, 1.0);
    // what is better known by the sensor itself
    let known = f64::min(
        1.0,
        sigma * sigma / model.covariance[TURN_ERROR][TURN_ERROR],
    );
    let error = (error - step.removed) * kept * known;
    let (share, slope) = if slip < 0.0 {
        (1.0 / (1.0 + slip), -1.0 / (1.0 + slip).powi(2))
    } else {
        (1.0 - slip, -1.0)
    };
    // way and speed, and what they depend on
    let (way, by_way, faster, noise) = match step.acceleration {
        Some((force, noise)) => {
            let gain = (force - bias) * dt;
            (speed * dt + 0.5 * gain * dt, (SPEED, dt), gain, noise)
        }
        None => (step.rim_way * share, (SLIP, step.rim_way * slope), 0.0, 0.0),
    };
    let turn = match step.curvature {
        // by the speed before
        Some(curvature) if step.acceleration.is_some() => curvature * speed * dt,
        Some(curvature) => curvature * way,
        None => step.turn,
    } - error * dt;
    let course = heading + step.direction + turn / 2.0;
    let (sin, cos) = course.sin_cos();
    let (east, north) = (cos * way - sin * drift * way, sin * way + cos * drift * way);
    let fades = 1.0 - dt / 5.0;
    let mean = [
        x + east,
        y + north,
        heading + turn,
        speed + faster,
        slip,
        drift * fades,
        bias,
        error,
    ];

    let mut f = matrix(|i, j| f64::from(u8::from(i == j)));
    f[HEADING][TURN_ERROR] = -dt;
    f[HEADING][by_way.0] += step.curvature.unwrap_or(0.0) * by_way.1;
    let of_heading = f[HEADING];
    for (axis, ahead, aside) in [(X, cos, -north), (Y, sin, east)] {
        for (slot, part) in f[axis].iter_mut().zip(of_heading) {
            *slot += aside * part;
        }
        f[axis][by_way.0] += ahead * by_way.1;
    }
    f[X][DRIFT] = -sin * way;
    f[Y][DRIFT] = cos * way;
    f[DRIFT][DRIFT] = fades;
    if step.acceleration.is_some() {
        f[SPEED][BIAS] = -dt;
    }
    let scale = |i: usize| {
        if i == TURN_ERROR {
            kept * known.sqrt()
        } else {
            1.0
        }
    };
    let mut before = matrix(|i, j| scale(i) * model.covariance[i][j] * scale(j));
    before[TURN_ERROR][TURN_ERROR] += (1.0 - kept * kept) * sigma * sigma;
    before[HEADING][HEADING] += 1e-6 * dt;
    let mut after = congruent(&f, &before);
    let side = if dt > 0.0 {
        0.03_f64.powi(2) * way * way / dt
    } else {
        0.0
    };
    let across = [-sin, cos];
    for (i, j) in [(X, X), (X, Y), (Y, X), (Y, Y)] {
        after[i][j] += side * across[i] * across[j];
    }
    after[SPEED][SPEED] += noise * noise * dt;
    after[DRIFT][DRIFT] += 0.03_f64.powi(2) * dt;
    after[BIAS][BIAS] += model.bias_noise.powi(2) * dt;
    // in full from 0.05 m/s on
    let rolls = f64::min(dt, step.rim_way.abs() / 0.05);
    after[SLIP][SLIP] += model.slip_noise.powi(2) * rolls;
    (mean, after)
}

#[test]
fn a_prediction_is_that_of_its_matrices() {
    for (slip, acceleration, curvature) in [
        (0.2, None, None),
        (-0.3, None, Some(0.35)),
        (0.2, Some((0.45, 0.6)), Some(0.35)),
        (-0.3, Some((-0.45, 0.6)), None),
    ] {
        let mut model = correlated(0.37, 0.21);
        model.mean[SLIP] = slip;
        let full = step(acceleration, curvature);
        // rims that hardly move, a turn rate that is known better, and one that is forgotten at once
        let slow = Step {
            rim_way: 0.013,
            ..full
        };
        let mut known = full;
        known.turn_error.sigma = 0.1;
        let mut short = full;
        short.turn_error.memory = 0.3;
        let none = Step {
            dt: 0.0,
            rim_way: 0.0,
            ..full
        };
        for step in [full, slow, known, short, none] {
            let (mean, covariance) = predicted(&model, &step);
            let mut found = model;
            found.predict(&step);
            assert_near(&found, mean, &covariance);
        }
    }
}

#[test]
fn slip_stays_within_its_limits() {
    let high = Step {
        max_slip: 1.25,
        ..step(None, None)
    };
    for (slip, expected) in [(1.5, 1.25), (-1.5, -1.0), (1.125, 1.125)] {
        let mut model = correlated(0.0, 0.0);
        model.mean[SLIP] = slip;
        model.predict(&high);
        assert_eq!(model.mean[SLIP], expected);
    }
    // by each update
    let rim = Rim {
        speed: 0.4,
        variance: 1e-6,
        ..Rim::default()
    };
    let updates: [fn(&mut Model, Rim) -> f64; 3] = [
        |model, rim| model.update_share(-3.0 * rim.speed, rim.speed, rim.variance),
        |model, rim| model.tie(Rim { speed: 30.0, ..rim }),
        |model, _| model.update_speed(-500.0, 1e-6),
    ];
    for update in updates {
        let mut model = correlated(0.0, 0.0);
        model.mean[SPEED] = -3.0;
        model.covariance[SLIP][SLIP] = 9.0;
        update(&mut model, rim);
        assert_eq!(model.mean[SLIP].abs(), 1.0, "{:?}", model.mean);
    }
    let mut model = correlated(0.0, 0.0);
    model.covariance[SLIP][SLIP] = 9.0;
    let course = Course {
        sin: 0.0,
        cos: 1.0,
        variances: [1e-4; 2],
    };
    let since = Since {
        time_s: 0.0,
        way: [1.0, 0.0],
    };
    model.update_position([-9.0, -2.5], &since, &course);
    assert_eq!(model.mean[SLIP], -1.0);
}

#[test]
fn a_start_knows_place_heading_and_the_prior_of_slip() {
    let mut model = correlated(0.1, 0.1);
    model.start([3.0, -4.0], 0.8, [0.3, 0.07, 0.02], -0.6, [0.25, 0.15]);
    let mean = [3.0, -4.0, 0.8, -0.45, 0.25, 0.0, 0.0, 0.0];
    let sigmas = [0.3, 0.3, 0.07, 0.6 * 0.15 + 0.01, 0.15, 0.05, 0.3, 0.02];
    let covariance = matrix(|i, j| if i == j { sigmas[i] * sigmas[i] } else { 0.0 });
    assert_near(&model, mean, &covariance);
}

#[test]
fn what_restarts_is_correlated_with_nothing() {
    let before = correlated(0.1, 0.1);
    let check = |after: &Model, changed: &[(usize, f64, f64)]| {
        let (mut mean, mut covariance) = (before.mean, before.covariance);
        for &(state, value, sigma) in changed {
            mean[state] = value;
            covariance[state] = [0.0; STATES];
            for row in &mut covariance {
                row[state] = 0.0;
            }
            covariance[state][state] = sigma * sigma;
        }
        assert_near(after, mean, &covariance);
    };
    let mut model = before;
    model.restart_turn_error(0.3);
    check(&model, &[(TURN_ERROR, 0.0, 0.3)]);
    // whole turns are kept
    let whole = core::f64::consts::TAU;
    let mut model = before;
    model.restart_heading(0.9 + 3.0 * whole, 0.4, 0.6);
    check(&model, &[(HEADING, 0.9, 0.4), (TURN_ERROR, 0.03, 0.6)]);
    let mut model = before;
    model.restart_slip([0.33, 0.11], [0.77, 0.22]);
    check(&model, &[(SLIP, 0.33, 0.11), (SPEED, 0.77, 0.22)]);
}

#[test]
fn headings_and_speeds_may_be_outliers() {
    const NOISE_VARIANCE: f64 = 0.04;
    let before = correlated(0.1, 0.1);
    for off in [0.3, -2.5] {
        let mut model = before;
        let turned = 0.6;
        let likelihood =
            model.update_heading(before.mean[HEADING] - turned + off, turned, NOISE_VARIANCE);
        let (expected, is) = robust(&before, unit(HEADING, 1.0), off, NOISE_VARIANCE);
        assert_near(&model, expected.mean, &expected.covariance);
        assert!((likelihood - is).abs() < ROUNDING);
        let mut model = before;
        let likelihood = model.update_speed(before.mean[SPEED] + off, NOISE_VARIANCE);
        let (expected, is) = robust(&before, unit(SPEED, 1.0), off, NOISE_VARIANCE);
        assert_near(&model, expected.mean, &expected.covariance);
        assert!((likelihood - is).abs() < ROUNDING);
        // a share of the rims' speed: 1 − s, or 1/(1 + s)
        for (slip, share, slope) in SLIP_SHARE_SLOPES {
            let mut before = before;
            before.mean[SLIP] = slip;
            let mut model = before;
            let (rim, off) = (0.7, 0.1 * off);
            let likelihood = model.update_share(rim * share + off, rim, NOISE_VARIANCE);
            let (expected, is) = robust(&before, unit(SLIP, rim * slope), off, NOISE_VARIANCE);
            assert_near(&model, expected.mean, &expected.covariance);
            assert!((likelihood - is).abs() < ROUNDING);
        }
    }
    // beyond what a density can be
    let mut model = before;
    assert_eq!(model.update_speed(1e9, 1e-6), 0.0);
    assert!(model.mean[SPEED].is_finite() && model.covariance[SPEED][SPEED] > 0.0);
    let mut model = before;
    let course = Course {
        sin: 0.0,
        cos: 1.0,
        variances: [1e-6; 2],
    };
    assert_eq!(model.update_position([1e9, 1e9], &Since::NOW, &course), 0.0);
    assert!(model.mean[X].is_finite() && model.covariance[X][X] > 0.0);
}

#[test]
fn a_speed_by_wheel_and_slip_has_their_covariance() {
    for (slip, share, slope) in SLIP_SHARE_SLOPES {
        let mut model = correlated(0.1, 0.1);
        model.mean[SLIP] = slip;
        let rim = Rim {
            speed: 0.6,
            variance: 0.02,
            ..Rim::default()
        };
        let mut f = matrix(|i, j| f64::from(u8::from(i == j && i != SPEED)));
        f[SPEED][SLIP] = rim.speed * slope;
        let mut covariance = congruent(&f, &model.covariance);
        covariance[SPEED][SPEED] += rim.variance;
        let mut mean = model.mean;
        mean[SPEED] = rim.speed * share;
        model.follow_rim(rim);
        assert_near(&model, mean, &covariance);
    }
}

#[test]
fn rims_tie_speed_and_slip_at_one_time() {
    let rim = Rim {
        speed: 0.5,
        variance: 0.03,
        lag: 0.35,
        rise: 0.07,
        gained: 0.09,
    };
    // gained at the bias of 0.05 m/s²: 0.0725 m/s
    let (steady, sudden) = (STEADY_SLIP_NOISE, SUDDEN_SLIP_NOISE);
    for slip in [0.2, 0.0, -0.3] {
        for (slip_noise, back, on) in [
            (0.5 * steady, 1.0, 0.0),
            (steady, 0.0, 0.0),
            (sudden, 0.0, 0.0),
            // the rims have gained as much as the robot by its share of theirs, or as they show
            (
                2.0 * sudden,
                0.0,
                if slip < 0.0 {
                    0.0725 * (1.0 + slip)
                } else {
                    rim.rise
                },
            ),
        ] {
            let mut before = correlated(slip_noise, 0.1);
            before.mean[SLIP] = slip;
            // u − v − s m in the middle of the window, or now
            let residual = |x: [f64; STATES]| {
                let (u, v) = (
                    rim.speed + on,
                    x[SPEED] - back * (rim.gained - rim.lag * x[BIAS]),
                );
                u - v - x[SLIP] * if slip < 0.0 { v } else { u }
            };
            let off = |i: usize, by: f64| {
                let mut x = before.mean;
                x[i] += by;
                residual(x)
            };
            // of a product of two the difference is exact
            let h = core::array::from_fn(|i| off(i, -0.5) - off(i, 0.5));
            let (expected, is) = updated(&before, h, residual(before.mean), rim.variance);
            let mut model = before;
            let likelihood = model.tie(rim);
            assert_near(&model, expected.mean, &expected.covariance);
            assert!((likelihood - is).abs() < ROUNDING);
        }
    }
}
