use super::*;

/// More states than a measurement depends on.
const STATE_COUNT: usize = 5;

/// A matrix, row after row.
pub(in crate::filter) type Dense = Vec<Vec<f64>>;

/// A filter whose means and covariances all differ, with a covariance that is positive definite: A Aᵀ.
pub(in crate::filter) fn filled(n: usize) -> Kalman {
    let factor = |i: usize, j: usize| {
        let uneven = ((7 * i + 3 * j + i * j) % 11) as f64 / 11.0 - 0.4;
        if i == j { 1.5 + uneven } else { 0.3 * uneven }
    };
    let mut state = Kalman::new(n);
    for i in 0..n {
        state.set_mean(i, 0.1 * (i as f64) - 0.23);
        for j in 0..=i {
            let sum = (0..n).map(|k| factor(i, k) * factor(j, k)).sum();
            state.set_covariance(i, j, sum);
        }
    }
    state
}

/// The covariance as a matrix.
pub(in crate::filter) fn dense(state: &Kalman) -> Dense {
    (0..state.n)
        .map(|i| (0..state.n).map(|j| state.covariance(i, j)).collect())
        .collect()
}

/// A B Aᵀ
pub(in crate::filter) fn sandwich(a: &Dense, b: &Dense) -> Dense {
    let n = b.len();
    let entry = |i: usize, j: usize| -> f64 {
        let terms = (0..n).flat_map(|k| (0..n).map(move |l| (k, l)));
        terms.map(|(k, l)| a[i][k] * b[k][l] * a[j][l]).sum()
    };
    (0..n)
        .map(|i| (0..n).map(|j| entry(i, j)).collect())
        .collect()
}

pub(in crate::filter) fn identity(n: usize) -> Dense {
    (0..n)
        .map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect())
        .collect()
}

pub(in crate::filter) fn assert_near(state: &Kalman, expected: &Dense, what: &str) {
    for (i, row) in dense(state).iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let off = entry - expected[i][j];
            assert!(
                off.abs() < 1e-12,
                "{what}: {i} {j} {entry} {}",
                expected[i][j]
            );
        }
    }
}

#[test]
fn a_propagation_is_that_by_its_matrix() {
    const COEFFICIENT: f64 = -0.37;
    for (i, j) in (0..STATE_COUNT).flat_map(|i| (0..STATE_COUNT).map(move |j| (i, j))) {
        if i == j {
            continue;
        }
        let mut state = filled(STATE_COUNT);
        let mut matrix = identity(STATE_COUNT);
        matrix[i][j] = COEFFICIENT;
        let expected = sandwich(&matrix, &dense(&state));
        state.propagate(i, j, COEFFICIENT);
        assert_near(&state, &expected, &format!("{i} {j}"));
    }
}

/// Joseph's form with a gain of 0 for considered numbers: (CHANGED_STATE − K h) P (CHANGED_STATE − K h)ᵀ + K R Kᵀ.
#[test]
fn an_update_is_that_of_joseph_and_considers_without_estimating() {
    const NOISE_VARIANCE: f64 = 0.7;
    const RESIDUAL: f64 = 0.9;
    let jacobian = [(3, 0.8), (0, -1.3), (4, 0.0), (2, 0.45)];
    assert_eq!(
        filled(STATE_COUNT).covariance.len(),
        STATE_COUNT * (STATE_COUNT + 1) / 2
    );
    for considered in [None, Some(0), Some(1), Some(3)] {
        let mut state = filled(STATE_COUNT);
        if let Some(i) = considered {
            state.set_considered(i, true);
        }
        let before = dense(&state);
        let mut h = [0.0; STATE_COUNT];
        for (i, coefficient) in jacobian {
            h[i] = coefficient;
        }
        let spread = |i: usize| -> f64 { (0..STATE_COUNT).map(|j| before[i][j] * h[j]).sum() };
        let known: f64 = (0..STATE_COUNT).map(|i| h[i] * spread(i)).sum();
        let total = known + NOISE_VARIANCE;
        let gain = |i: usize| {
            if considered == Some(i) {
                0.0
            } else {
                spread(i) / total
            }
        };
        let mut matrix = identity(STATE_COUNT);
        for (i, row) in matrix.iter_mut().enumerate() {
            for (slot, coefficient) in row.iter_mut().zip(h) {
                *slot -= gain(i) * coefficient;
            }
        }
        let mut expected = sandwich(&matrix, &before);
        let means: Vec<_> = (0..STATE_COUNT)
            .map(|i| state.mean(i) + gain(i) * RESIDUAL)
            .collect();
        for (i, row) in expected.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += gain(i) * gain(j) * NOISE_VARIANCE;
            }
        }
        let measured = ScalarMeasurement {
            jacobian: &jacobian,
            residual: RESIDUAL,
            variance: NOISE_VARIANCE,
        };
        let near = |value: f64, expected: f64| (value - expected).abs() < 1e-12;
        assert!(near(state.variance_of(&jacobian), known));
        let (innovation, variance) = state.innovation(&measured);
        assert!(near(innovation, RESIDUAL) && near(variance, total));
        let nis = state.update(&measured);
        assert!(near(nis, RESIDUAL * RESIDUAL / total));
        assert_near(&state, &expected, &format!("{considered:?}"));
        assert!((0..STATE_COUNT).all(|i| near(state.mean(i), means[i])));
    }
}

#[test]
fn one_number_is_reset_decays_or_becomes_less_certain() {
    const CHANGED_STATE: usize = 2;
    let start = filled(STATE_COUNT);
    let before = dense(&start);
    let variance = before[CHANGED_STATE][CHANGED_STATE];
    let mut state = start.clone();
    state.decay(CHANGED_STATE, 0.5, 0.7);
    let mut matrix = identity(STATE_COUNT);
    matrix[CHANGED_STATE][CHANGED_STATE] = 0.7;
    assert_near(&state, &sandwich(&matrix, &before), "decay");
    assert!(
        (state.mean(CHANGED_STATE) - (0.5 + 0.7 * (start.mean(CHANGED_STATE) - 0.5))).abs() < 1e-15
    );
    let mut state = start.clone();
    state.reset(CHANGED_STATE, 0.8, 0.6);
    matrix[CHANGED_STATE][CHANGED_STATE] = 0.0;
    let mut expected = sandwich(&matrix, &before);
    expected[CHANGED_STATE][CHANGED_STATE] = 0.6;
    assert_near(&state, &expected, "reset");
    assert_eq!(
        (state.mean(CHANGED_STATE), state.sigma(CHANGED_STATE)),
        (0.8, f64::sqrt(0.6))
    );
    // the mean of 0.4 x₂ − 0.3 x₁
    let mean = 0.4 * 0.8 - 0.3 * start.mean(1);
    assert!((state.mean_of(&[(CHANGED_STATE, 0.4), (1, -0.3)]) - mean).abs() < 1e-15);
    state.clamp_mean(CHANGED_STATE, -0.2, 0.3);
    assert_eq!(state.mean(CHANGED_STATE), 0.3);
    let change = |change: fn(&mut Kalman, f64), value: f64| {
        let mut state = start.clone();
        change(&mut state, value);
        state.covariance(CHANGED_STATE, CHANGED_STATE)
    };
    let inflated = |limit| {
        change(
            |state, limit| state.inflate(CHANGED_STATE, 0.25, limit),
            limit,
        )
    };
    assert_eq!(inflated(variance + 9.0), variance + 0.25);
    assert_eq!(inflated(variance + 0.1), variance + 0.1);
    assert_eq!(inflated(variance - 0.1), variance);
    for (other, raised, limited) in [
        (variance + 0.2, variance + 0.2, variance),
        (variance - 0.2, variance, variance - 0.2),
    ] {
        assert_eq!(
            change(
                |state, least| state.raise_variance(CHANGED_STATE, least),
                other
            ),
            raised
        );
        assert_eq!(
            change(
                |state, limit| state.limit_variance(CHANGED_STATE, limit),
                other
            ),
            limited
        );
    }
}

#[test]
fn correlations_stay_below_one_and_variances_above_their_floor() {
    let mut state = filled(3);
    state.set_covariance(0, 0, 4.0);
    state.set_covariance(1, 1, 9.0);
    state.set_covariance(2, 2, 0.0);
    state.set_covariance(0, 1, 6.5);
    state.set_covariance(1, 2, -0.5);
    state.set_covariance(0, 2, 1e-9);
    state.limit_correlations();
    let near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-12;
    assert!(near(state.covariance(0, 1), MAX_SQUARED_CORRELATION * 6.0));
    let least = MAX_SQUARED_CORRELATION * 3.0 * f64::sqrt(VARIANCE_FLOOR);
    assert!(near(state.covariance(1, 2), -least));
    assert_eq!(state.covariance(0, 2), 1e-9);
    // a perfect measurement leaves the floor, one of no variance of a known number nothing
    let mut measured = ScalarMeasurement {
        jacobian: &[(0, 1.0)],
        residual: 0.5,
        variance: 0.0,
    };
    let nis = state.update(&measured);
    assert!(near(nis, 0.25 / 4.0) && near(state.covariance(0, 0), VARIANCE_FLOOR));
    let mut none = Kalman::new(2);
    measured.residual = 0.7;
    assert_eq!((none.update(&measured), none.mean(0)), (0.0, 0.0));
}
