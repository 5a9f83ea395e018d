//! Covariances beside the whole precision that they are the inverse of, and verdicts at their limits.

use proptest::prelude::*;

use super::super::fit::Status;
use super::super::{Bounded, Interval};
use super::*;

type Matrix = Vec<Vec<f64>>;

/// A fit that ended at `x` with these residuals and derivatives; bounds are pairs of ends.
fn fit_at(x: &[f64], bounds: &[(f64, f64)], residuals: &[f64], jacobian: Matrix) -> Fit {
    let bounds = bounds.iter().zip(x);
    Fit {
        status: Status::Converged,
        x: x.to_vec(),
        residuals: residuals.to_vec(),
        jacobian,
        cost: 0.0,
        evaluations: 1,
        jacobians: 1,
        bounds: bounds
            .map(|(&(lower, upper), &start)| Bounded {
                start,
                lower,
                upper,
            })
            .collect(),
    }
}

/// The covariance of parameters from the mixtures that scatter them.
fn covariance(mixtures: &[Vec<f64>]) -> Matrix {
    let n = mixtures.first().map_or(0, Vec::len);
    let entry = |k: usize, j: usize| mixtures.iter().map(|m| m[k] * m[j]).sum();
    (0..n)
        .map(|k| (0..n).map(|j| entry(k, j)).collect())
        .collect()
}

/// Free, on a lower bound of 0, free, on an upper bound.
const PLACES: [f64; 4] = [1.5, 0.0, -0.7, 2.0];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Where numbers on bounds may move by the width of their bounds, and no further than the data let them, the covariance
    /// of all numbers is the inverse of JᵀWJ/s² with 1/width² added for each of them: that of Bayes with normal priors.
    #[test]
    fn numbers_on_bounds_and_beside_them_scatter_as_the_whole_precision_lets_them(
        rows in prop::collection::vec(prop::array::uniform4(-1.0..1.0_f64), 9),
        residuals in prop::collection::vec(-3.0..3.0_f64, 9),
        widths in prop::array::uniform2(-1.5..1.5_f64),
        threshold in prop::option::of(0.4..2.0_f64),
    ) {
        let loss = threshold.map_or(Loss::Squares, |threshold| Loss::Huber { threshold });
        let weight = |r: f64| threshold.map_or(1.0, |t| (t / r.abs()).min(1.0));
        let [width, other] = widths.map(|decades| 10.0_f64.powf(decades));
        let free = (-20.0, 30.0);
        let bounds = [free, (0.0, width), free, (2.0 - other, 2.0)];
        let jacobian: Matrix = rows.iter().map(|row| row.to_vec()).collect();
        let fit = fit_at(&PLACES, &bounds, &residuals, jacobian);
        let uncertainty = Uncertainty::from_fit(&fit, loss);
        // two numbers are free
        let squares: f64 = residuals.iter().map(|r| weight(*r) * r * r).sum();
        let s = (squares / 7.0).sqrt();
        prop_assume!(s > 1e-3);
        prop_assume!(uncertainty.condition < 1e3);
        prop_assert_eq!(uncertainty.freedom, 7);
        let precision = |k: usize, j: usize| {
            let products = rows.iter().zip(&residuals).map(|(row, r)| weight(*r) * row[k] * row[j]);
            let width = [None, Some(bounds[1].1), None, Some(2.0 - bounds[3].0)][k];
            let prior = width.filter(|_| k == j).map_or(0.0, |width| 1.0 / (width * width));
            products.sum::<f64>() / (s * s) + prior
        };
        let mixtures = uncertainty.scatter(&[0, 1, 2, 3]).expect("all are determined");
        let covariance = covariance(&mixtures);
        for (k, j) in (0..16).map(|place| (place / 4, place % 4)) {
            let products = (0..4).map(|i| precision(k, i) * covariance[i][j]);
            let size: f64 = products.clone().map(f64::abs).sum();
            let unit = f64::from(u8::from(k == j));
            let product: f64 = products.sum();
            prop_assert!((product - unit).abs() < 1e-9 * (1.0 + size), "{k} {j}: {product}");
        }
        for k in [0, 2] {
            let error = uncertainty.standard_errors[k];
            prop_assert!((error * error / covariance[k][k] - 1.0).abs() < 1e-9);
        }
        prop_assert!([1, 3].iter().all(|k| uncertainty.standard_errors[*k].is_nan()));
    }
}

/// One free number and one on a bound that the data cannot tell apart: each goes as far as its own bounds, or a million
/// errors where they are open, and takes the other along the other way.
#[test]
fn what_is_exchanged_for_a_free_number_goes_to_its_other_bound() {
    let jacobian = vec![vec![1.0, 1.0]; 4];
    let residuals = [1.0, -1.0, 1.0, -1.0];
    // s² of three degrees of freedom; both columns have the norm 2
    let s = (4.0_f64 / 3.0).sqrt();
    for (upper, moved) in [(6.0, 6.0), (f64::INFINITY, 1e6 * s / 2.0)] {
        let bounds = [(-9.0, 9.0), (-1.0, upper - 1.0)];
        let fit = fit_at(&[1.0, -1.0], &bounds, &residuals, jacobian.clone());
        let uncertainty = Uncertainty::from_fit(&fit, Loss::Squares);
        let covariance = covariance(&uncertainty.scatter(&[0, 1]).expect("determined"));
        let close = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 1e-9;
        assert!(close(covariance[1][1], moved * moved), "{covariance:?}");
        assert!(close(covariance[0][1], -moved * moved), "{covariance:?}");
        assert!(close(covariance[0][0], moved * moved + s * s / 4.0));
        assert_eq!(uncertainty.verdicts, [Verdict::Loose, Verdict::OnBound]);
    }
}

/// A number on a bound that changes nothing scatters nothing and is no doubt of the others.
#[test]
fn a_number_without_effect_on_a_bound_stays() {
    let jacobian = vec![vec![1.0, 0.0]; 4];
    let fit = fit_at(
        &[10.0, 2.0],
        &[(0.0, 90.0), (0.0, 2.0)],
        &[0.5, -0.5, 0.5, -0.5],
        jacobian,
    );
    let uncertainty = Uncertainty::from_fit(&fit, Loss::Squares);
    assert_eq!(
        uncertainty.verdicts,
        [Verdict::Identified, Verdict::OnBound]
    );
    assert_eq!(uncertainty.scatter(&[1]), Some(vec![]));
    let covariance = covariance(&uncertainty.scatter(&[0, 1]).expect("determined"));
    // s²/Σ of three degrees of freedom
    assert!((covariance[0][0] - 1.0 / 12.0).abs() < 1e-15);
    assert_eq!([covariance[0][1], covariance[1][1]], [0.0; 2]);
}

/// A bound of 0 is one of nature; beside any other one nothing is identified that it has an effect beside.
#[test]
fn a_number_that_is_stopped_by_its_bound_makes_others_loose() {
    let beside = |x: f64, effect: f64| {
        let jacobian = [effect, -effect, effect, -effect].map(|effect| vec![1.0, effect]);
        let fit = fit_at(
            &[10.0, x],
            &[(0.0, 90.0), (x, x + 1.0)],
            &[0.5, -0.5, 0.5, -0.5],
            jacobian.to_vec(),
        );
        let uncertainty = Uncertainty::from_fit(&fit, Loss::Squares);
        assert_eq!(uncertainty.verdicts[1], Verdict::OnBound);
        uncertainty.verdicts[0]
    };
    assert_eq!(
        [beside(0.0, 0.1), beside(2.0, 0.0)],
        [Verdict::Identified; 2]
    );
    assert_eq!([beside(2.0, 0.1), beside(-2.0, 0.1)], [Verdict::Loose; 2]);
}

/// Residuals of 0 leave errors of 0, and those that no degree of freedom is left for have none.
#[test]
fn without_scatter_of_residuals_nothing_moves_on_a_bound() {
    let bounds = [(-9.0, 9.0), (0.0, 2.0)];
    let jacobian = vec![vec![1.0, 0.5], vec![1.0, 0.25]];
    let fit = fit_at(&[3.0, 2.0], &bounds, &[0.0; 2], jacobian.clone());
    let exact = Uncertainty::from_fit(&fit, Loss::Squares);
    assert_eq!(exact.standard_errors[0], 0.0);
    let none: [Vec<f64>; 0] = [];
    assert_eq!(exact.bound_mixtures, none);
    let fit = fit_at(&[3.0, 2.0], &bounds, &[0.5], jacobian[..1].to_vec());
    let unknown = Uncertainty::from_fit(&fit, Loss::Squares);
    assert_eq!(unknown.freedom, 0);
    assert!(unknown.standard_errors[0].is_nan());
    assert_eq!(unknown.bound_mixtures, none);
    assert_eq!(unknown.scatter(&[0]), None);
}

/// A precise fit of one number, 8, and another on a bound of nature.
fn precise(bounds: [(f64, f64); 2]) -> (Fit, Uncertainty) {
    let jacobian = vec![vec![1.0, 0.0]; 9];
    let fit = fit_at(
        &[8.0, bounds[1].0],
        &bounds,
        &[0.1, -0.1, 0.1, -0.1, 0.1, -0.1, 0.1, -0.1, 0.0],
        jacobian,
    );
    let uncertainty = Uncertainty::from_fit(&fit, Loss::Squares);
    assert_eq!(
        uncertainty.verdicts,
        [Verdict::Identified, Verdict::OnBound]
    );
    (fit, uncertainty)
}

#[test]
fn an_interval_wider_than_its_number_allows_makes_it_loose() {
    let (fit, uncertainty) = precise([(0.0, 90.0), (0.0, 1.0)]);
    let judged = |low, high| {
        let mut uncertainty = uncertainty.clone();
        let on_bound = Interval {
            low: None,
            high: Some(1e9),
        };
        uncertainty.judge_intervals(&fit, &[Interval { low, high }, on_bound]);
        assert_eq!(uncertainty.verdicts[1], Verdict::OnBound);
        uncertainty.verdicts[0]
    };
    // 8 minus it is exact, as the difference of numbers that are alike
    let reach = student_quantile(0.975, 8) * MAX_RELATIVE_ERROR * 8.0;
    let (low, high) = (8.0 - reach, 8.0 + reach);
    assert_eq!(
        [
            judged(Some(low), None),
            judged(Some(low), Some(9.0)),
            judged(None, Some(high - 1e-9)),
            judged(Some(7.9), Some(8.1)),
        ],
        [Verdict::Identified; 4]
    );
    assert_eq!(
        [
            judged(Some(8.0 - reach.next_up()), None),
            judged(Some(7.9), Some(high + 1e-9)),
            judged(None, None),
        ],
        [Verdict::Loose; 3]
    );
    // an offset is not judged by its size, but by an interval that is open
    let (fit, mut offset) = precise([(-90.0, 90.0), (0.0, 1.0)]);
    let wide = Interval {
        low: Some(-20.0),
        high: Some(20.0),
    };
    offset.judge_intervals(&fit, &[wide, wide]);
    assert_eq!(offset.verdicts[0], Verdict::Identified);
    let open = Interval {
        low: None,
        high: None,
    };
    offset.judge_intervals(&fit, &[open, wide]);
    assert_eq!(offset.verdicts[0], Verdict::Loose);
}

#[test]
fn what_nothing_bounds_makes_only_identified_numbers_loose() {
    let (fit, mut uncertainty) = precise([(0.0, 90.0), (0.0, 1.0)]);
    let added = uncertainty.widen(&fit, Loss::Squares, None);
    assert!(added.len() == 2 && added.iter().all(|added| added.is_nan()));
    assert_eq!(uncertainty.verdicts, [Verdict::Loose, Verdict::OnBound]);
    assert!(uncertainty.standard_errors[0].is_nan() && uncertainty.correlation[0][0].is_nan());
}

#[test]
fn an_identified_number_is_loose_beyond_a_third_of_it() {
    let of = |share| Verdict::Identified.of_share(share);
    assert_eq!([0.0, 1.0 / 3.0].map(of), [Verdict::Identified; 2]);
    assert_eq!(
        [(1.0_f64 / 3.0).next_up(), f64::NAN].map(of),
        [Verdict::Loose; 2]
    );
    for other in [Verdict::OnBound, Verdict::NotIdentifiable, Verdict::Loose] {
        assert_eq!(other.of_share(9.0), other);
    }
}
