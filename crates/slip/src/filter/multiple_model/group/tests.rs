use super::super::model::tests::{assert_near, correlated, matrix, mixture};
use super::super::model::{SLIP, SPEED, X, Y};
use super::*;

const ROUNDING: f64 = 1e-12;

/// Models that differ in all states, of a group.
fn spread_out(mut group: Group) -> Group {
    for (i, model) in group.models.iter_mut().enumerate() {
        let of = correlated(0.1, 0.1);
        model.adopt(&of);
        for (j, slot) in model.mean.iter_mut().enumerate() {
            *slot += 0.1 * i as f64 * (1.0 + j as f64);
        }
        model.covariance = matrix(|j, k| of.covariance[j][k] * (1.0 + i as f64));
    }
    group
}

fn near(found: &[f64], expected: &[f64]) -> bool {
    let pairs = found.iter().zip(expected);
    found.len() >= expected.len() && pairs.clone().all(|(a, b)| (a - b).abs() < ROUNDING)
}

#[test]
fn models_are_weighed_by_their_likelihoods() {
    let mut group = Group::interacting([0.1, 0.2, 0.3], None, [[0.0; 3]; 3]);
    assert!(!group.is_inertial && Group::lone(0.1, Some(0.2)).is_inertial);
    for (model, speed) in group.models.iter_mut().zip([0.5, 0.2, 0.0]) {
        model.mean[SPEED] = speed;
    }
    group.weights[..3].copy_from_slice(&[0.2, 0.7, 0.1]);
    let likelihood = |model: &mut Model| model.mean[SPEED];
    group.log_evidence = 0.5;
    group.weigh_and_score(false, likelihood);
    let total: f64 = 0.2 * 0.5 + 0.7 * 0.2;
    assert!((group.log_evidence - 0.5 - total.ln()).abs() < ROUNDING);
    // none is ruled out
    let sum = 1.0 + 1e-6;
    let expected = [0.1 / total, 0.14 / total, 1e-6].map(|weight| weight / sum);
    assert!(near(&group.weights, &expected), "{:?}", group.weights);
    // rims that stand do not judge the group
    let (before, weights) = (group.log_evidence, group.weights);
    group.weigh_and_score(true, likelihood);
    assert!(group.log_evidence == before && group.weights != weights);
    // what cannot be at all has a logarithm
    let mut none = Group::lone(0.1, None);
    none.weigh_and_score(false, |_| 0.0);
    assert!((none.log_evidence - f64::ln(1e-200)).abs() < ROUNDING);
    assert_eq!(none.models().map(|(_, weight)| weight).sum::<f64>(), 1.0);
}

#[test]
fn models_change_into_one_another_at_their_rates() {
    let rates = [[0.0, 0.5, 0.25], [1.0, 0.0, 0.75], [1.5, 3.0, 0.0]];
    // no more than 0.2 s at once, and no more than 0.4 of a model
    for (steps, over_s) in [
        (&[0.0125, 0.0125][..], 0.025),
        (&[0.02], 0.02),
        (&[0.7], 0.2),
    ] {
        let mut group = spread_out(Group::interacting([0.1, 0.2, 0.3], None, rates));
        group.weights[..3].copy_from_slice(&[0.2, 0.7, 0.1]);
        let before = group.clone();
        let (last, first) = steps.split_last().unwrap();
        for step in first {
            group.mix(*step);
            assert_eq!(group.weights, before.weights);
        }
        group.mix(*last);
        let goes = |i: usize, j: usize| f64::min(rates[i][j] * over_s, 0.4);
        let from = |i: usize, j: usize| {
            let stays = 1.0 - (0..3).map(|k| goes(i, k)).sum::<f64>();
            before.weights[i] * if i == j { stays } else { goes(i, j) }
        };
        for j in 0..3 {
            let parts = [from(0, j), from(1, j), from(2, j)];
            let weight: f64 = parts.iter().sum();
            assert!((group.weights[j] - weight).abs() < ROUNDING);
            let (mean, covariance) = mixture(&before.models, &parts.map(|part| part / weight));
            assert_near(&group.models[j], mean, &covariance);
        }
        // and begins anew
        let after = group.clone();
        group.mix(0.0125);
        assert_eq!(group.weights, after.weights);
    }
}

#[test]
fn a_jump_becomes_a_hypothesis_in_the_place_of_the_least_probable() {
    let since = Since {
        time_s: 0.5,
        way: [0.3, -0.4],
    };
    let start = || {
        let mut group = spread_out(Group::jumps(0.1, 0.6, 0.5));
        group.weights = [0.25, 0.3, 0.1, 0.2, 0.15];
        group
    };
    // a jump so soon after the last reading is not another one
    let mut group = start();
    group.mix(0.0625);
    group.pass_jump(&since);
    assert_eq!(group.weights, start().weights);
    for (weights, passed_s, probability, adopts) in [
        (start().weights, 0.1, 0.05, true),
        (start().weights, 0.3, 0.15, true),
        // at most 0.3, and not less probable than each of them
        ([0.08, 0.37, 0.15, 0.2, 0.2], 0.9, 0.3, false),
        ([0.125, 0.25, 0.125, 0.25, 0.25], 0.3, 0.15, false),
    ] {
        let mut group = start();
        group.weights = weights;
        let before = group.clone();
        group.mix(passed_s);
        group.pass_jump(&since);
        let mut expected = before.weights;
        if adopts {
            assert_near(
                &group.models[2],
                before.models[0].mean,
                &before.models[0].covariance,
            );
            expected[2] = expected[0];
        } else {
            assert_near(
                &group.models[2],
                before.models[2].mean,
                &before.models[2].covariance,
            );
        }
        let total: f64 = expected[1..].iter().sum();
        let shares = [1, 2, 3, 4].map(|i| expected[i] / total);
        let mut steady: Vec<Model> = before.models[1..].to_vec();
        if adopts {
            steady[1].adopt(&before.models[0]);
        }
        let mut jump = before.models[0];
        (jump.mean, jump.covariance) = mixture(&steady, &shares);
        jump.change_since(&since);
        assert_near(&group.models[0], jump.mean, &jump.covariance);
        assert!(jump.covariance[SLIP][SLIP] > 0.0 && jump.covariance[X][Y] != 0.0);
        assert!((group.weights[0] - probability).abs() < ROUNDING);
        assert!(near(
            &group.weights[1..],
            &shares.map(|share| (1.0 - probability) * share)
        ));
        // the next one after as long again
        let after = group.clone();
        group.pass_jump(&since);
        assert_eq!(group.weights, after.weights);
    }
    // a group of others has no jumps
    let mut lone = spread_out(Group::lone(0.1, None));
    let before = lone.clone();
    lone.mix(9.0);
    lone.pass_jump(&since);
    assert_near(
        &lone.models[0],
        before.models[0].mean,
        &before.models[0].covariance,
    );
}

#[test]
fn time_that_passes_changes_slips_weights_and_evidence() {
    const PASSED_S: f64 = 0.25;
    let rates = [[0.0, 0.5, 0.25], [1.0, 0.0, 0.75], [1.5, 0.5, 0.0]];
    let mut group = spread_out(Group::interacting([0.1, 0.2, 0.3], None, rates));
    group.log_evidence = 0.7;
    let mut expected = group.clone();
    for (model, noise) in expected.models.iter_mut().zip([0.1, 0.2, 0.3]) {
        model.covariance[SLIP][SLIP] += noise * noise * PASSED_S;
    }
    expected.interact(&rates, PASSED_S);
    group.pass_time(PASSED_S);
    assert!(near(&group.weights, &expected.weights));
    for (model, expected) in group.models.iter().zip(&expected.models) {
        assert_near(model, expected.mean, &expected.covariance);
    }
    assert!((group.log_evidence - 0.7 * f64::exp(-PASSED_S / 13.0)).abs() < ROUNDING);
    // a jump becomes as probable as in that time beside the time of the readings
    let mut jumps = Group::jumps(0.1, 0.6, 0.2);
    jumps.mix(0.5);
    jumps.pass_time(PASSED_S);
    jumps.pass_jump(&Since::NOW);
    assert!((jumps.weights[0] - 0.2 * (0.5 + PASSED_S)).abs() < ROUNDING);
    // slip is never renewed beyond a half
    let mut lone = spread_out(Group::lone(0.4, None));
    let before = lone.models[0].covariance[SLIP][SLIP];
    lone.pass_time(10.0);
    assert!((lone.models[0].covariance[SLIP][SLIP] - before - 0.25).abs() < ROUNDING);
}
