//! What a model becomes with time and with late readings.

use super::*;

#[test]
fn a_rise_of_the_rims_is_the_smaller_of_both() {
    let mut model = correlated(0.1, 0.1);
    model.mean[SLIP] = 0.5;
    for (slip, rise, gained, expected) in [
        (0.5, 0.03, 0.02, 0.03),
        (0.5, 0.05, 0.02, 0.04),
        (0.5, -0.05, -0.02, -0.04),
        (0.5, -0.03, -0.02, -0.03),
        (0.5, -0.03, 0.02, 0.0),
        (0.5, 0.03, -0.02, 0.0),
        // rims that spin show no more than ten times as much
        (0.97, 0.3, 0.02, 0.2),
    ] {
        model.mean[SLIP] = slip;
        let rim = Rim {
            rise,
            ..Rim::default()
        };
        assert!((model.rise(rim, gained) - expected).abs() < ROUNDING);
    }
}

#[test]
fn slip_that_may_have_changed_since_moves_the_place() {
    for (slip, _, slope) in SLIP_SHARE_SLOPES {
        let mut before = correlated(0.6, 0.1);
        before.mean[SLIP] = slip;
        let since = Since {
            time_s: 0.5,
            way: [0.3, -0.4],
        };
        let mut model = before;
        model.change_since(&since);
        let expected = matrix(|i, j| before.covariance[i][j] + noise_since(&since, slope, i, j));
        assert_near(&model, before.mean, &expected);
    }
}

/// Covariances of a random walk (0.6/√s) and of the way by its mean.
fn noise_since(since: &Since, slope: f64, i: usize, j: usize) -> f64 {
    let of = |k: usize| slope * since.way.get(k).copied().unwrap_or(0.0);
    let variance = 0.36 * since.time_s;
    match (i, j) {
        (SLIP, SLIP) => variance,
        (SLIP, k) | (k, SLIP) => of(k) * variance / 2.0,
        _ => of(i) * of(j) * variance / 3.0,
    }
}

/// A late position updates the state of its time, which then goes on to now.
#[test]
fn a_late_position_is_one_of_its_own_time() {
    let course = |factor: f64| Course {
        sin: -0.8,
        cos: 0.6,
        variances: [0.2, 0.5].map(|variance| factor * variance),
    };
    let far = [2.4, -3.9];
    for ((slip, share, slope), time_s, place, is_sure) in [
        (SLIP_SHARE_SLOPES[0], 0.0, far, false),
        (SLIP_SHARE_SLOPES[0], 0.05, far, false),
        (SLIP_SHARE_SLOPES[1], 0.05, far, false),
        (SLIP_SHARE_SLOPES[0], 0.05, [1.27, -2.2], true),
    ] {
        let mut now = correlated(0.6, 0.1);
        now.mean[SLIP] = slip;
        // along the way, so that both axes are independent
        let since = Since {
            time_s,
            way: [0.3, -0.4],
        };
        let mut back = matrix(|i, j| f64::from(u8::from(i == j)));
        let mut on = back;
        for axis in [X, Y] {
            back[axis][SLIP] = -since.way[axis] * slope;
            on[axis][SLIP] = since.way[axis] * slope;
        }
        let less = matrix(|i, j| now.covariance[i][j] - noise_since(&since, slope, i, j));
        let mut then = now;
        then.covariance = congruent(&back, &less);
        for axis in [X, Y] {
            then.mean[axis] -= since.way[axis] * share;
        }
        let at = |factor: f64| {
            let (mut model, mut likelihood) = (then, 1.0);
            for (row, variance) in course(factor).axes() {
                let h = core::array::from_fn(|i| row.get(i).copied().unwrap_or(0.0));
                let off = row[0] * (place[0] - model.mean[X]) + row[1] * (place[1] - model.mean[Y]);
                let (next, one) = updated(&model, h, off, variance);
                (model, likelihood) = (next, likelihood * one);
            }
            let shares = share + slope * (model.mean[SLIP] - slip);
            for axis in [X, Y] {
                model.mean[axis] += since.way[axis] * shares;
            }
            let later = congruent(&on, &model.covariance);
            model.covariance = matrix(|i, j| later[i][j] + noise_since(&since, slope, i, j));
            (model, likelihood)
        };
        let ((good, as_good), (bad, as_bad)) = (at(1.0), at(900.0));
        let likelihood = 0.98 * as_good + 0.02 * as_bad;
        let good_share = 0.98 * as_good / likelihood;
        assert_eq!(good_share > NO_OUTLIER, is_sure, "{good_share}");
        let shares = if is_sure {
            [1.0, 0.0]
        } else {
            [good_share, 1.0 - good_share]
        };
        let (mean, covariance) = mixture(&[good, bad], &shares);
        let mut found = now;
        let by_code = found.update_position(place, &since, &course(1.0));
        assert_near(&found, mean, &covariance);
        assert!((by_code - likelihood).abs() < ROUNDING);
    }
    // a slip that is known better than the noise since cannot hold it
    let (mut known, since) = (
        correlated(0.6, 0.1),
        Since {
            time_s: 40.0,
            way: [0.3, -0.4],
        },
    );
    let mut at_once = known;
    let place = [1.2, -2.2];
    known.update_position(place, &since, &course(1.0));
    at_once.update_position(
        place,
        &Since {
            time_s: 0.0,
            ..since
        },
        &course(1.0),
    );
    assert_near(&known, at_once.mean, &at_once.covariance);
}

#[test]
fn variances_grow_on_their_own_axes() {
    let before = correlated(0.1, 0.1);
    let mut model = before;
    model.inflate_heading(0.3);
    model.inflate_position(0.7);
    let more = [0.7, 0.7, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0];
    let expected = matrix(|i, j| before.covariance[i][j] + if i == j { more[i] } else { 0.0 });
    assert_near(&model, before.mean, &expected);
    let mut other = Model::new(0.3, 0.2);
    other.adopt(&model);
    assert_near(&other, model.mean, &model.covariance);
    assert_eq!((other.slip_noise, other.bias_noise), (0.3, 0.2));
}

#[test]
fn the_share_of_the_rims_has_its_derivative_up_to_its_limit() {
    for slip in [0.6, 0.2, -0.2, -0.6] {
        let (share, slope) = rim_share(slip);
        // v = u (1 − s) driving, u = v (1 + s) braking
        let expected = if slip > 0.0 {
            1.0 - slip
        } else {
            1.0 / (1.0 + slip)
        };
        assert!((share - expected).abs() < ROUNDING);
        let by = 1e-5;
        let rises = (rim_share(slip + by).0 - rim_share(slip - by).0) / (2.0 * by);
        assert!((slope - rises).abs() < 1e-7, "{slip}");
    }
    assert_eq!(rim_share(0.0), (1.0, -1.0));
    let limit = rim_share(-0.99).0;
    assert!((limit - 20.0).abs() < 1e-6 && limit == rim_share(-1.0).0);
}

#[test]
fn an_outlier_is_thirty_times_as_wide_on_both_axes() {
    // densities of two axes: exp(−nis/2σ²)/σ²
    for nis in [0.3, 9.0, 15.0, 200.0] {
        let good = 0.98 * f64::exp(-nis / 2.0);
        let bad = 0.02 / 900.0 * f64::exp(-nis / 1800.0);
        let expected = good / (good + bad);
        assert!((inlier_probability(nis) - expected).abs() < 1e-12);
    }
    assert_eq!(inlier_probability(1e9), 0.0);
}
