//! What a measure makes of worlds and a weighted sum of objectives, number by number, at random points.

use grouser_opt::{
    Differences, Error, Exact, Functions, Jacobian, LinearConstraint, Measure, Method, Model,
    Problem, ProblemParams, Scheme, Settings, Sobol, Uncertainty, Variable, World,
    check_derivatives, robust, sample, solve,
};
use grouser_real::Scalar;
use proptest::prelude::*;

/// f1 = x² − a y (may be negative), f2 = sin(x + a) y, x + y ≤ a, x y = a.
#[derive(Clone, Copy)]
struct Two(f64);

impl Functions for Two {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let a = R::from_f64(self.0);
        f[0] = x[0].square() - a * x[1];
        f[1] = (x[0] + a).sin() * x[1];
        f[2] = x[0] + x[1] - a;
        f[3] = x[0] * x[1] - a;
    }
}

impl Two {
    fn at(self, x: &[f64]) -> [f64; 4] {
        let a = self.0;
        [
            x[0] * x[0] - a * x[1],
            (x[0] + a).sin() * x[1],
            x[0] + x[1] - a,
            x[0] * x[1] - a,
        ]
    }
}

/// The first objective counts with its absolute value.
fn params(absolute: usize) -> ProblemParams<'static> {
    of(0.0, absolute)
}

fn of(a: f64, absolute: usize) -> ProblemParams<'static> {
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.5, -5.0, 5.0));
    ProblemParams::new(&[0.5, 0.5], 2, Exact(Two(a)))
        .variables(variables)
        .inequalities(vec!["sum".to_owned()])
        .equalities(vec!["product".to_owned()])
        .linear(vec![LinearConstraint::at_most(
            "line",
            vec![1.0, -2.0],
            30.0,
        )])
        .absolute(absolute)
}

fn values(problem: &Problem<'_>, x: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; problem.function_count()];
    problem.model().values(x, &mut values);
    let (mut again, mut jacobian) = (values.clone(), Jacobian::zeros(values.len(), x.len()));
    problem.model().derivatives(x, &mut again, &mut jacobian);
    assert_eq!(values, again);
    let check = check_derivatives(problem, x, 1e-6).unwrap();
    assert!(
        check.wrong.is_empty() && check.entries > 0,
        "{:?}",
        check.wrong
    );
    values
}

fn near(found: &[f64], wanted: &[f64]) -> bool {
    found.len() == wanted.len()
        && found
            .iter()
            .zip(wanted)
            .all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + b.abs()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn measures_are_their_formulas(
        x in prop::array::uniform2(-3.0..3.0_f64),
        places in prop::collection::vec(-2.0..2.0_f64, 1..5),
        absolute in 0..=2_usize,
        (kappa, alpha) in (0.0..3.0_f64, 0.0..0.95_f64),
        helpers in prop::collection::vec(0.0..3.0_f64, 12),
    ) {
        let count = places.len();
        let k = count as f64;
        let all: Vec<[f64; 4]> = places.iter().map(|a| Two(*a).at(&x)).collect();
        let sized = |i: usize| -> Vec<f64> { all.iter().map(|f| if i < absolute { f[i].abs() } else { f[i] }).collect() };
        // a kink where |f| = 0 or where all worlds agree has no derivative to check
        prop_assume!((0..2).all(|i| all.iter().all(|f| f[i].abs() > 1e-2)));
        let joint = |measure| {
            let worlds = places.iter().map(|a| World::new(a.to_string(), Exact(Two(*a)))).collect();
            robust(params(absolute), worlds, measure).unwrap()
        };
        let constraints: Vec<f64> = (2..4).flat_map(|i| all.iter().map(move |f| f[i])).collect();

        let worst = joint(Measure::WorstCase);
        let functions: Vec<f64> = (0..4).flat_map(|i| all.iter().map(move |f| f[i])).collect();
        prop_assert!(near(&values(worst.problem(), &x), &functions));
        prop_assert_eq!(worst.problem().absolute(), absolute * count);

        let spread = joint(Measure::MeanPlusDeviations { kappa });
        let moments = |i: usize| {
            let f = sized(i);
            let mean = f.iter().sum::<f64>() / k;
            (mean, (f.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / k).sqrt())
        };
        let expected: Vec<f64> = (0..2).map(|i| moments(i).0 + kappa * moments(i).1).chain(constraints.iter().copied()).collect();
        if (0..2).all(|i| moments(i).1 > 1e-2) || count == 1 {
            prop_assert!(near(&values(spread.problem(), &x), &expected));
        }

        // x, then of each objective η and one excess per world
        let risk = joint(Measure::ConditionalValueAtRisk { alpha });
        let mut point = x.to_vec();
        point.extend(&helpers[..2 * (1 + count)]);
        let own = |i: usize| &helpers[i * (1 + count)..(i + 1) * (1 + count)];
        let mut expected: Vec<f64> = (0..2).map(|i| own(i)[0] + own(i)[1..].iter().sum::<f64>() / ((1.0 - alpha) * k)).collect();
        for i in 0..2 {
            for (f, excess) in all.iter().zip(&own(i)[1..]) {
                expected.push(f[i] - own(i)[0] - excess);
                if i < absolute {
                    expected.push(-f[i] - own(i)[0] - excess);
                }
            }
        }
        expected.extend(&constraints);
        prop_assert!(near(&values(risk.problem(), &point), &expected));
        // the start is feasible for the excesses: η is the worst value there
        let begun: Vec<[f64; 4]> = places.iter().map(|a| Two(*a).at(&[0.5, 0.5])).collect();
        for i in 0..2 {
            let worst = begun.iter().map(|f| if i < absolute { f[i].abs() } else { f[i] }).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!((risk.problem().variables()[2 + i * (1 + count)].start - worst).abs() < 1e-12);
        }
        prop_assert_eq!(risk.problem().linear()[0].coefficients.len(), point.len());
        prop_assert_eq!(risk.own(&point), &x[..]);
    }

    /// A covariance of any size is met by its samples, and ranges are kept.
    #[test]
    fn samples_have_their_covariance(root in prop::array::uniform9(-1.0..1.0_f64), mean in prop::array::uniform3(-5.0..5.0_f64), seed in any::<u64>()) {
        let covariance: Vec<Vec<f64>> = (0..3)
            .map(|i| (0..3).map(|j| (0..3).map(|k| root[3 * i + k] * root[3 * j + k]).sum::<f64>() + if i == j { 0.2 } else { 0.0 }).collect())
            .collect();
        let n = 512;
        let samples = sample(&Uncertainty::Normal { mean: mean.to_vec(), covariance: covariance.clone() }, n, seed).unwrap();
        let average = |of: &dyn Fn(&Vec<f64>) -> f64| samples.iter().map(of).sum::<f64>() / n as f64;
        for i in 0..3 {
            // 512 points of a net: within a hundredth of the spread
            prop_assert!((average(&|s| s[i]) - mean[i]).abs() < 0.02 * covariance[i][i].sqrt() + 1e-12);
            for j in 0..3 {
                let size = (covariance[i][i] * covariance[j][j]).sqrt();
                let found = average(&|s| (s[i] - mean[i]) * (s[j] - mean[j]));
                prop_assert!((found - covariance[i][j]).abs() < 0.08 * size, "{found} {}", covariance[i][j]);
            }
        }
        let (low, high) = (vec![-1.0, 2.0, 5.0], vec![1.0, 2.0, 25.0]);
        let points = sample(&Uncertainty::Ranges { low, high }, 64, seed).unwrap();
        // sixty-four points of a net: one in each sixty-fourth
        for (d, low, width) in [(0, -1.0, 2.0), (2, 5.0, 20.0)] {
            let mut cells: Vec<f64> = points.iter().map(|p| (64.0 * (p[d] - low) / width).floor()).collect();
            cells.sort_by(f64::total_cmp);
            prop_assert!(cells.iter().zip(0..64).all(|(cell, i)| *cell == f64::from(i)));
        }
        prop_assert!(points.iter().all(|p| p[1] == 2.0));
    }

    /// Differences of quadratics are exact but for rounding, beside a bound too, and no point beyond a bound is evaluated.
    #[test]
    fn differences_keep_to_the_bounds(
        x in prop::array::uniform2(-3.0..3.0_f64),
        room in prop::array::uniform4(prop_oneof![Just(0.0), 1e-9..1e-4_f64, 0.1..1.0_f64]),
        (a, b, c) in (-2.0..2.0_f64, -2.0..2.0_f64, -2.0..2.0_f64),
        central in any::<bool>(),
    ) {
        let lower = [x[0] - room[0], x[1] - room[1]];
        let upper = [x[0] + room[2], x[1] + room[3]];
        let scheme = if central { Scheme::Central } else { Scheme::Forward };
        let calls = std::sync::atomic::AtomicUsize::new(0);
        let outside = std::sync::atomic::AtomicBool::new(false);
        let model = Differences::new(|p: &[f64], f: &mut [f64]| {
            calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if (0..2).any(|i| p[i] < lower[i] || p[i] > upper[i]) {
                outside.store(true, std::sync::atomic::Ordering::Relaxed);
            }
            f[0] = a * p[0] * p[0] + b * p[0] * p[1] + c * p[1];
        })
        .scheme(scheme)
        .within(&lower, &upper);
        let (mut value, mut jacobian) = ([0.0], Jacobian::zeros(1, 2));
        model.derivatives(&x, &mut value, &mut jacobian);
        let slopes = [2.0 * a * x[0] + b * x[1], b * x[0] + c];
        let mut expected = 1;
        for (i, slope) in slopes.into_iter().enumerate() {
            let widest = (x[i] - lower[i]).max(upper[i] - x[i]);
            let found = jacobian.row(0)[i];
            if widest == 0.0 {
                prop_assert!(found == 0.0);
                continue;
            }
            expected += if central { 2 } else { 1 };
            // rounding of values of up to 30 over the step, and of one-sided steps their curvature
            let step = widest.min(if central { 6e-6 } else { 1.5e-8 });
            let allowed = 3e-14 / step + if central { 0.0 } else { 4.0 * 4.0 * 1.5e-8 };
            prop_assert!((found - slope).abs() < allowed, "{found} {slope} {allowed}");
        }
        prop_assert!(!outside.into_inner());
        prop_assert_eq!(calls.into_inner(), expected);
    }
}

#[test]
fn samples_of_what_is_no_distribution_are_refused() {
    let normal = |mean: &[f64], covariance: &[&[f64]]| {
        let covariance = covariance.iter().map(|row| row.to_vec()).collect();
        sample(
            &Uncertainty::Normal {
                mean: mean.to_vec(),
                covariance,
            },
            4,
            1,
        )
    };
    assert!(normal(&[0.0, 0.0], &[&[4.0, 1.0], &[1.0 + 1e-9, 1.0]]).is_ok());
    assert!(matches!(
        normal(&[0.0, 0.0], &[&[4.0, 1.0], &[1.0 + 1e-8, 1.0]]),
        Err(Error::OutOfRange(_))
    ));
    assert!(matches!(
        normal(&[0.0], &[&[0.0]]),
        Err(Error::NotPositiveDefinite { pivot: 1, .. })
    ));
    assert!(matches!(
        normal(&[0.0, 1.0], &[&[1.0, 1.0], &[1.0, 1.0]]),
        Err(Error::NotPositiveDefinite { pivot: 2, .. })
    ));
    assert!(
        normal(&[f64::NAN], &[&[1.0]]).is_err() && normal(&[0.0], &[&[f64::INFINITY]]).is_err()
    );
    assert!(normal(&[0.0], &[]).is_err() && normal(&[0.0, 1.0], &[&[1.0], &[1.0]]).is_err());
    let ranges = |low: f64, high: f64| {
        sample(
            &Uncertainty::Ranges {
                low: vec![low],
                high: vec![high],
            },
            4,
            1,
        )
    };
    assert!(
        ranges(1.0, 1.0).is_ok()
            && ranges(f64::NAN, 1.0).is_err()
            && ranges(0.0, f64::INFINITY).is_err()
    );
    assert!(matches!(
        ranges(1.0, 0.5),
        Err(Error::InconsistentBounds { .. })
    ));
}

/// Measures without a spread and at their limits.
#[test]
fn a_measure_of_one_world_is_that_world() {
    for measure in [
        Measure::WorstCase,
        Measure::MeanPlusDeviations { kappa: 3.0 },
        Measure::ConditionalValueAtRisk { alpha: 0.9 },
    ] {
        let world = World::new("only", Exact(Two(4.5)));
        let joint = robust(params(1), vec![world], measure).unwrap();
        let solution = solve(joint.problem(), &Method::Minimax, &Settings::default()).unwrap();
        let alone = solve(
            &Problem::new(of(4.5, 1)).unwrap(),
            &Method::Minimax,
            &Settings::default(),
        )
        .unwrap();
        assert!(
            solution.status.is_solved() && (solution.utility - alone.utility).abs() < 1e-7,
            "{} {}",
            solution.utility,
            alone.utility
        );
    }
    for (kappa, alpha, fits) in [
        (0.0, 0.0, true),
        (1e6, 1.0 - 1e-9, true),
        (-1e-9, -1e-9, false),
        (1.1e6, 1.0, false),
        (f64::NAN, f64::NAN, false),
    ] {
        for measure in [
            Measure::MeanPlusDeviations { kappa },
            Measure::ConditionalValueAtRisk { alpha },
        ] {
            let joint = robust(
                params(1),
                vec![World::new("only", Exact(Two(4.5)))],
                measure,
            );
            assert_eq!(joint.is_ok(), fits, "{measure:?}");
        }
    }
}

/// Σ w |f| of a lifted objective and a plain one, with a constraint, is least where a scan finds it.
#[test]
fn a_weighted_sum_is_least_where_a_scan_finds_it() {
    let problem = Problem::new(of(4.5, 1)).unwrap();
    for weights in [[1.0, 0.5], [0.2, 3.0], [2.0, 0.0]] {
        let method = Method::Weighted {
            weights: weights.to_vec(),
        };
        let solution = solve(&problem, &method, &Settings::default()).unwrap();
        assert!(solution.status.is_solved(), "{:?}", solution.status);
        let f = Two(4.5).at(&solution.x);
        let sum = |f: [f64; 4]| weights[0] * f[0].abs() + weights[1] * f[1];
        assert!((solution.utility - sum(f)).abs() < 1e-7 && f[2] < 1e-7 && f[3].abs() < 1e-7);
        assert!(
            near(&solution.objectives, &f[..2])
                && near(&solution.inequalities, &f[2..3])
                && near(&solution.equalities, &f[3..])
        );
        assert!(
            (solution.multipliers.objectives[0] - weights[0] / (weights[0] + weights[1])).abs()
                < 1e-12
        );
        // along x y = 4.5, on the branch of the solution
        let scanned = (1..100_000)
            .map(|i| 5e-5 * f64::from(i) * solution.x[0].signum())
            .map(|x| [x, 4.5 / x]);
        let best = scanned
            .map(|x| Two(4.5).at(&x))
            .filter(|f| f[2] <= 0.0)
            .map(sum)
            .fold(f64::INFINITY, f64::min);
        assert!(
            solution.utility < best + 1e-3,
            "{} {best}",
            solution.utility
        );
    }
}

#[test]
fn sequences_of_one_seed_differ_from_those_of_another() {
    let points = |seed| {
        let mut sobol = Sobol::new(3, seed).unwrap();
        (0..8).map(|_| sobol.next_point()).collect::<Vec<_>>()
    };
    assert_eq!(points(Some(4)), points(Some(4)));
    assert!(points(Some(4)) != points(Some(5)) && points(None)[0] == [0.0; 3]);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "32 bits of a number in [0, 1)"
    )]
    // a shift by bits: differences by bits are those without it
    let bits = |x: f64| (x * 2_f64.powi(32)) as u64;
    for (shifted, plain) in points(Some(4)).iter().zip(points(None)) {
        for d in 0..3 {
            let shift = bits(points(Some(4))[0][d]);
            assert_eq!(bits(shifted[d]) ^ shift, bits(plain[d]));
        }
    }
}
