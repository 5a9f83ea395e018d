//! What a measure makes of worlds and a weighted sum of objectives, number by number, at random points.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use grouser_opt::{
    Algorithm, Differences, Error, Exact, Functions, Jacobian, LinearConstraint, Measure, Method,
    Model, ParetoSettings, Problem, ProblemParams, Settings, Sobol, Status, Uncertainty, Variable,
    World, check_derivatives, evaluate, multi_start, pareto, robust, sample, solve,
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
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn measures_are_their_formulas(
        x in prop::array::uniform2(-3.0..3.0_f64),
        places in prop::collection::vec(-2.0..2.0_f64, 1..5),
        absolute in 0..=2_usize,
        (kappa, alpha) in (0.0..3.0_f64, 0.0..0.95_f64),
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
        prop_assert!(near(&values(&worst, &x), &functions));
        prop_assert_eq!(worst.absolute(), absolute * count);

        let spread = joint(Measure::MeanPlusDeviations { kappa });
        let moments = |i: usize| {
            let f = sized(i);
            let mean = f.iter().sum::<f64>() / k;
            (mean, (f.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / k).sqrt())
        };
        let expected: Vec<f64> = (0..2).map(|i| moments(i).0 + kappa * moments(i).1).chain(constraints.iter().copied()).collect();
        if (0..2).all(|i| moments(i).1 > 1e-2) || count == 1 {
            prop_assert!(near(&values(&spread, &x), &expected));
        }

        // η + Σ max(0, f − η)/((1 − α) K) at its best η, which is one of the values
        let risk = joint(Measure::ConditionalValueAtRisk { alpha });
        let tail = |i: usize| {
            let f = sized(i);
            let beyond = |eta: f64| f.iter().map(|f| (f - eta).max(0.0)).sum::<f64>();
            f.iter().map(|eta| eta + beyond(*eta) / ((1.0 - alpha) * k)).fold(f64::INFINITY, f64::min)
        };
        let expected: Vec<f64> = (0..2).map(tail).chain(constraints.iter().copied()).collect();
        prop_assert!(near(&values(&risk, &x), &expected));
        prop_assert_eq!(risk.variables().len(), x.len());
    }

    /// What a method minimises and what is violated, at points inside and outside all limits.
    #[test]
    fn the_merit_of_a_point_is_its_formula(
        x in prop::array::uniform2(-7.0..7.0_f64),
        goals in prop::array::uniform2(-2.0..2.0_f64),
        weights in prop::array::uniform2(0.1..3.0_f64),
        absolute in 0..=2_usize,
    ) {
        let line = LinearConstraint::equal("twice", vec![2.0, -1.0], 1.0);
        let mut params = of(0.5, absolute);
        params.linear.push(line);
        let problem = Problem::new(params).unwrap();
        let f = Two(0.5).at(&x);
        let sized = [0, 1].map(|i| if i < absolute { f[i].abs() } else { f[i] });
        // |f| below a goal: both signs of f
        let [g, w] = [goals, weights];
        let signed = |i: usize| if i < absolute { f[i].abs() - g[i] } else { f[i] - g[i] };
        let others = [f[2], f[3].abs(), x[0] - 2.0 * x[1] - 30.0, (2.0 * x[0] - x[1] - 1.0).abs(), x[0] - 5.0, x[1] - 5.0, -5.0 - x[0], -5.0 - x[1]];
        let violation = others.into_iter().fold(0.0, f64::max);
        let merit = |method: Method| evaluate(&problem, &method, &x).unwrap();
        let minimax = merit(Method::Minimax);
        prop_assert!(near(&[minimax.utility, minimax.violation], &[sized[0].max(sized[1]), violation]));
        let attain = merit(Method::Attain { goals: goals.to_vec(), weights: weights.to_vec() });
        prop_assert!(near(&[attain.utility, attain.violation], &[(signed(0) / w[0]).max(signed(1) / w[1]), violation]));
        let hard = merit(Method::Attain { goals: goals.to_vec(), weights: vec![0.0, w[1]] });
        prop_assert!(near(&[hard.utility, hard.violation], &[signed(1) / w[1], violation.max(signed(0))]));
        let chebyshev = merit(Method::Chebyshev { ideal: goals.to_vec(), weights: weights.to_vec() });
        prop_assert!(near(&[chebyshev.utility, chebyshev.violation], &[(w[0] * signed(0)).max(w[1] * signed(1)), violation]));
        let sum = merit(Method::Weighted { weights: weights.to_vec() });
        prop_assert!(near(&[sum.utility, sum.violation], &[w[0] * sized[0] + w[1] * sized[1], violation]));
        prop_assert!(evaluate(&problem, &Method::Minimax, &x[..1]).is_err());
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
    ) {
        let lower = [x[0] - room[0], x[1] - room[1]];
        let upper = [x[0] + room[2], x[1] + room[3]];
        let calls = AtomicUsize::new(0);
        let outside = AtomicBool::new(false);
        let model = Differences::new(|p: &[f64], f: &mut [f64]| {
            calls.fetch_add(1, Ordering::Relaxed);
            if (0..2).any(|i| p[i] < lower[i] || p[i] > upper[i]) {
                outside.store(true, Ordering::Relaxed);
            }
            f[0] = a * p[0] * p[0] + b * p[0] * p[1] + c * p[1];
        })
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
            expected += 2;
            // rounding of values of up to 30 over the step
            let allowed = 3e-14 / widest.min(6e-6);
            prop_assert!((found - slope).abs() < allowed, "{found} {slope} {allowed}");
        }
        prop_assert!(!outside.into_inner());
        prop_assert_eq!(calls.into_inner(), expected);
    }
}

/// f = 10⁴ x + z and a constant, with a slope in x that is claimed as 10⁴ + `off`; y is fixed.
struct Steep {
    off: f64,
}

impl Model for Steep {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        (values[0], values[1]) = (1e4 * x[0] + x[2], 3.0);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        (0..2).for_each(|row| jacobian.row_mut(row).fill(0.0));
        jacobian.set(0, 0, 1e4 + self.off);
        jacobian.set(0, 2, 1.0);
    }
}

#[test]
fn a_check_is_relative_and_leaves_out_fixed_variables() {
    let check = |off: f64, tolerance: f64| {
        let variables = [
            Variable::bounded("x", 0.5, -1.0, 2.0),
            Variable::bounded("y", 1.0, 1.0, 1.0),
            Variable::free("z", 0.25),
        ];
        let params = ProblemParams::new(&[0.5, 1.0, 0.25], 2, Steep { off }).variables(variables);
        check_derivatives(&Problem::new(params).unwrap(), &[0.5, 1.0, 0.25], tolerance).unwrap()
    };
    let found = check(1.0, 2e-4);
    assert!(
        found.entries == 4 && found.wrong.is_empty() && (found.worst - 1e-4).abs() < 1e-8,
        "{found:?}"
    );
    let found = check(1.0, 5e-5);
    assert!(
        found.wrong.len() == 1 && found.wrong[0].function == "f1" && found.wrong[0].variable == "x"
    );
    assert!(
        (found.wrong[0].claimed - 10_001.0).abs() < 1e-9
            && (found.wrong[0].difference - 1e4).abs() < 1e-4
    );
    // the constant is met exactly
    assert!(
        check(0.0, 0.0)
            .wrong
            .iter()
            .all(|wrong| wrong.function == "f1")
    );
    // NaN is wrong, and the worst
    let nan = check(f64::NAN, 1.0);
    assert!(nan.wrong.len() == 1 && nan.worst.is_nan());
}

#[test]
fn a_central_difference_at_a_kink_is_the_mean_of_its_sides() {
    let slope = |lower: f64| {
        let model =
            Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0].abs()).within(&[lower], &[1.0]);
        let (mut value, mut jacobian) = ([0.0], Jacobian::zeros(1, 1));
        model.derivatives(&[0.0], &mut value, &mut jacobian);
        jacobian.row(0)[0]
    };
    assert!(slope(-1.0).abs() < 1e-9);
    assert!((slope(0.0) - 1.0).abs() < 1e-9);
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
    // an asymmetry is measured by the diagonal
    assert!(normal(&[0.0, 0.0], &[&[2e8, 1.0], &[1.1, 1e8]]).is_ok());
    assert!(normal(&[0.0, 0.0], &[&[2e-8, 0.0], &[1e-9, 1e-8]]).is_err());
    let second = normal(&[0.0, f64::NAN], &[&[1.0, 0.0], &[0.0, 1.0]]).unwrap_err();
    assert!(second.to_string().contains("parameter 2"), "{second}");
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
        let solution = solve(&joint, &Method::Minimax, &Settings::default()).unwrap();
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

/// A model that has no value and says why.
struct Silent;

impl Model for Silent {
    fn values(&self, _: &[f64], values: &mut [f64]) {
        values.fill(f64::NAN);
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], _: &mut Jacobian) {
        self.values(x, values);
    }
    fn failure(&self, x: &[f64]) -> Option<String> {
        Some(format!("{} variables are mute", x.len()))
    }
}

/// Where all worlds agree the spread has no slope, whatever the rounding of their mean.
#[test]
fn equal_worlds_have_the_slope_of_one() {
    for i in 0..60 {
        let x = [30.0 + 0.37 * f64::from(i), 0.1 * f64::from(i)];
        let worlds = (0..7)
            .map(|k| World::new(k.to_string(), Exact(Two(0.3))))
            .collect();
        let joint = robust(
            params(0),
            worlds,
            Measure::MeanPlusDeviations { kappa: 3.0 },
        )
        .unwrap();
        let (mut values, mut slopes) = ([0.0; 16], Jacobian::zeros(16, 2));
        joint.model().derivatives(&x, &mut values, &mut slopes);
        let (mut own, mut alone) = ([0.0; 4], Jacobian::zeros(4, 2));
        Exact(Two(0.3)).derivatives(&x, &mut own, &mut alone);
        assert!(
            near(slopes.row(0), alone.row(0)) && near(slopes.row(1), alone.row(1)),
            "{i}"
        );
    }
}

#[test]
fn the_world_without_a_value_says_why() {
    let reason =
        |problem: &Problem<'_>, method: &Method| match solve(problem, method, &Settings::default())
            .unwrap()
            .status
        {
            Status::NotFinite { reason, .. } => reason.unwrap(),
            other => panic!("{other:?}"),
        };
    for measure in [
        Measure::WorstCase,
        Measure::MeanPlusDeviations { kappa: 1.0 },
        Measure::ConditionalValueAtRisk { alpha: 0.5 },
    ] {
        let worlds = vec![
            World::new("sound", Exact(Two(0.5))),
            World::new("dumb", Silent),
        ];
        let joint = robust(params(1), worlds, measure).unwrap();
        assert_eq!(
            reason(&joint, &Method::Minimax),
            "in dumb, 2 variables are mute"
        );
    }
    let problem = Problem::new(ProblemParams::new(&[0.5, 0.5], 2, Silent).absolute(1)).unwrap();
    assert_eq!(
        reason(
            &problem,
            &Method::Weighted {
                weights: vec![1.0, 1.0]
            }
        ),
        "2 variables are mute"
    );
    // a model behind a reference or in a box is that model
    let models: [Box<dyn Model>; 2] = [Box::new(&Silent), Box::new(Box::new(Silent))];
    for model in models {
        let problem = Problem::new(ProblemParams::new(&[0.5, 0.5], 1, model)).unwrap();
        assert_eq!(reason(&problem, &Method::Minimax), "2 variables are mute");
    }
    let two = Exact(Two(0.5));
    let boxed: Box<dyn Model> = Box::new(&two);
    let tape = boxed.taped(2, 4).unwrap();
    assert!(
        tape.taped(2, 4).is_some() && boxed.taped(2, 4).is_some() && Silent.taped(2, 4).is_none()
    );
    assert!(tape.failure(&[0.0; 2]).is_none());
    // all worlds on one tape, in the order of the problem's functions
    let worlds = [0.5, 2.0].map(|a| World::new(a.to_string(), Exact(Two(a))));
    let joint = robust(params(1), worlds.into(), Measure::WorstCase).unwrap();
    let tape = joint.model().taped(2, 8).unwrap();
    let mut taped = vec![0.0; 8];
    tape.values(&[0.3, 0.7], &mut taped);
    let direct = values(&joint, &[0.3, 0.7]);
    assert!(near(&taped, &direct), "{taped:?} {direct:?}");
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

/// Every operation that functions may use, with constants among its operands, and a count of the evaluations.
struct Everything(AtomicUsize);

impl Functions for Everything {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        self.0.fetch_add(1, Ordering::Relaxed);
        let (a, b) = (x[0], x[1]);
        let c = R::from_f64;
        let mut sum = a;
        sum += b * c(3.0);
        sum -= a * b;
        sum *= a + b;
        f[0] = sum / (c(2.0) - b);
        f[1] = a.mul_add(b, c(0.5)) + a.hypot(b) - (-a).abs();
        f[2] = a.powf(c(3.0))
            + b.powf(c(-2.0))
            + a.powf(c(0.5))
            + a.powf(b)
            + a.powi(-1)
            + b.powf(c(65.0));
        f[3] = a.sqrt() + b.exp() + a.exp_m1() + b.ln() + a.ln_1p() + b.square();
        f[4] = a.sin() + b.cos() + a.tan() + (c(0.3) * b).asin() + (c(0.3) * a).acos() + b.atan();
        f[5] = a.atan2(b) + b.sinh() + a.cosh() + b.tanh() + a.max(b) * a.min(c(1.0));
        // constants may be compared
        let (low, high) = (c(1.0), c(2.0));
        f[6] = R::select(low.lt(high), a, b) + R::select(high.lt(low), a, b * c(10.0));
        f[6] += R::select(low.le(low), a * c(100.0), b) + R::select(high.le(low), a, b * c(1e3));
        f[6] += if low < high && low != high { a } else { b };
        f[6] += c(7.0) * if low == c(1.0) { b } else { a };
        // whole powers of negative numbers
        f[6] += (a - c(3.0)).powf(c(3.0)) + (b - c(3.0)).powf(c(64.0)) * c(1e-20);
        f[6] += c(low.value()) + R::select(low.lt(low), a, b * c(1e4));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A function's tape has the function's values and derivatives.
    #[test]
    fn a_tape_is_the_function(x in prop::collection::vec(0.2..1.4_f64, 2..20)) {
        prop_assume!((x[0] - x[1]).abs() > 1e-6 && (x[0] - 1.0).abs() > 1e-6);
        let model = Exact(Everything(AtomicUsize::new(0)));
        let tape = model.taped(x.len(), 7).unwrap();
        let (mut values, mut exact, mut taped) = ([0.0; 7], [0.0; 7], [0.0; 7]);
        model.values(&x, &mut values);
        let (mut slopes, mut of_tape) = (Jacobian::zeros(7, x.len()), Jacobian::zeros(7, x.len()));
        prop_assert_eq!((slopes.rows(), slopes.columns()), (7, x.len()));
        let before = model.0.0.load(Ordering::Relaxed);
        model.derivatives(&x, &mut exact, &mut slopes);
        // two, four or eight directions at a time
        let directions = match x.len() { 2 => 2, 3 | 4 => 4, _ => 8 };
        prop_assert_eq!(model.0.0.load(Ordering::Relaxed) - before, x.len().div_ceil(directions));
        tape.derivatives(&x, &mut taped, &mut of_tape);
        // each row has some thirty roundings, and one counts as much as its relative change of an operand
        let close = |a: f64, b: f64, by_operands: f64| (a - b).abs() <= 32.0 * f64::EPSILON * (1.0 + a.abs() + by_operands);
        let by_operands = |row: usize| (0..2).map(|i| (slopes.row(row)[i] * x[i]).abs()).sum::<f64>();
        // the same of the slopes, by differences
        let share = 2.0_f64.powi(-26);
        let moved = [0, 1].map(|i| {
            let (mut at, mut slopes) = (x.clone(), Jacobian::zeros(7, x.len()));
            at[i] *= 1.0 + share;
            model.derivatives(&at, &mut [0.0; 7], &mut slopes);
            slopes
        });
        for row in 0..7 {
            let all_close = close(values[row], exact[row], by_operands(row)) && close(values[row], taped[row], by_operands(row));
            prop_assert!(all_close, "{row}: {} {} {}", values[row], exact[row], taped[row]);
            for (i, (a, b)) in slopes.row(row).iter().zip(of_tape.row(row)).enumerate() {
                let by_operands = moved.iter().map(|moved| (moved.row(row)[i] - a).abs() / share).sum();
                prop_assert!(close(*a, *b, by_operands), "{row} {i}: {a} {b}");
            }
        }
        let (a, b) = (x[0], x[1]);
        prop_assert!(close(values[0], (a + 3.0 * b - a * b) * (a + b) / (2.0 - b), by_operands(0)));
        prop_assert!(close(values[1], a * b + 0.5 + (a * a + b * b).sqrt() - a, by_operands(1)));
        prop_assert!(close(values[2], a.powi(3) + 1.0 / (b * b) + a.sqrt() + (b * a.ln()).exp() + 1.0 / a + b.powi(65), by_operands(2)));
        prop_assert!(close(values[6], a + 10.0 * b + 100.0 * a + 1e3 * b + a + 7.0 * b + (a - 3.0).powi(3) + (b - 3.0).powi(64) * 1e-20 + 1.0 + 1e4 * b, by_operands(6)));
    }

    /// Two valleys at ±1, one `tilt` higher than the other, `height` up.
    #[test]
    fn optima_are_ambiguous_where_their_utilities_agree(height in prop_oneof![Just(0.0), 10.0..1e3_f64], share in prop_oneof![0.1..0.8_f64, 1.3..10.0_f64], narrow in any::<bool>()) {
        // equal is what differs by less than a millionth
        let tilt = share * 1e-6 * (1.0 + height);
        let size = if narrow { 0.01 } else { 1.0 };
        let model = Differences::new(move |x: &[f64], f: &mut [f64]| {
            let u = x[0] / size;
            f[0] = height + 10.0 * (u * u - 1.0).powi(2) + 0.5 * tilt * (u + 1.0);
        });
        let variable = Variable::bounded("x", 0.9 * size, -2.0 * size, 2.0 * size);
        let problem = Problem::new(ProblemParams::new(&[0.9 * size], 1, model).variables([variable])).unwrap();
        let found = multi_start(&problem, &Method::Minimax, &Settings::default(), 12, 1).unwrap();
        prop_assert_eq!(found.optima.len(), 2);
        prop_assert!((found.best().x[0] / size + 1.0).abs() < 0.02);
        prop_assert_eq!(found.is_ambiguous(), share < 1.0);
        let reached: usize = found.optima.iter().map(|optimum| optimum.reached_by.len()).sum();
        prop_assert_eq!(reached, found.runs.iter().filter(|run| run.status.is_solved()).count());
        prop_assert_eq!(found.counts.values, found.runs.iter().map(|run| run.counts.values).sum::<usize>());
    }
}

/// f1 = (x − 1)² + y², f2 = 10 ((x + 1)² + y²) with x ≥ −0.5 as a function.
struct Uneven;

impl Functions for Uneven {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = (x[0] - R::ONE).square() + x[1].square();
        f[1] = R::from_f64(10.0) * ((x[0] + R::ONE).square() + x[1].square());
        f[2] = -x[0] - R::from_f64(0.5);
    }
}

/// Along the front λ1 f1′ + λ2 f2′ − μ = 0 with λ1 + λ2 = 1, in the objectives' own units.
#[test]
fn prices_of_a_front_are_in_the_objectives_own_units() {
    for (algorithm, rotate) in [
        (Algorithm::NsgaII, false),
        (Algorithm::NsgaIII, false),
        (Algorithm::NsgaII, true),
    ] {
        let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.3, -2.0, 2.0));
        let params = ProblemParams::new(&[0.3, 0.3], 2, Exact(Uneven))
            .variables(variables)
            .inequalities(vec!["left".to_owned()]);
        let problem = Problem::new(params).unwrap();
        let mut settings = ParetoSettings::default();
        (
            settings.algorithm,
            settings.population,
            settings.generations,
            settings.seed,
        ) = (Some(algorithm), 24, 20, u64::from(rotate));
        let front = pareto(&problem, &settings).unwrap();
        assert!(
            front.points.len() > 12 && front.ideal[0] < 0.05 && front.ideal[1] < 3.0,
            "{:?}",
            front.ideal
        );
        let mut priced = 0;
        for point in &front.points {
            let x = point.x[0];
            assert!(
                point.x[1].abs() < 1e-3 && (-0.5 - 1e-6..=1.0 + 1e-3).contains(&x),
                "{:?}",
                point.x
            );
            let Some(prices) = &point.multipliers else {
                continue;
            };
            let (one, two, left) = (
                prices.objectives[0],
                prices.objectives[1],
                prices.inequalities[0],
            );
            let slope = 2.0 * one * (x - 1.0) + 20.0 * two * (x + 1.0) - left;
            assert!(
                (one + two - 1.0).abs() < 1e-9 && slope.abs() < 1e-4,
                "{x}: {one} {two} {left}"
            );
            priced += 1;
        }
        assert!(priced > 10, "{priced}");
    }
}

/// a + x; a − x for a above 5.
struct Apart(f64);

impl Functions for Apart {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = R::from_f64(self.0) + if self.0 > 5.0 { -x[0] } else { x[0] };
    }
}

fn apart(values: &[f64], measure: Measure) -> Problem<'static> {
    let worlds = values
        .iter()
        .map(|value| World::new(value.to_string(), Exact(Apart(*value))));
    let params = ProblemParams::new(&[0.0], 1, Exact(Apart(0.0)));
    robust(params, worlds.collect(), measure).unwrap()
}

/// The greatest weight times value at the start, 2 · 3 or 1 · 10, is what a weighted sum of two worlds begins with.
#[test]
fn a_weighted_sum_begins_with_its_own_value() {
    let problem = apart(&[3.0, 10.0], Measure::WorstCase);
    let mut settings = Settings::default();
    settings.max_iterations = 0;
    let weights = vec![2.0, 1.0];
    let found = solve(&problem, &Method::Weighted { weights }, &settings).unwrap();
    assert_eq!((found.utility, found.x[0]), (10.0, 0.0));
}

/// Of two worlds the worse half is the worse one, however good the other one is.
#[test]
fn a_tail_is_without_the_worlds_that_do_not_count() {
    let measure = Measure::ConditionalValueAtRisk { alpha: 0.5 };
    let problem = apart(&[3.0, f64::NEG_INFINITY], measure);
    let merit = evaluate(&problem, &Method::Minimax, &[1.0]).unwrap();
    assert_eq!(merit.utility, 4.0);
}

/// A reference to a model and a model in a box are that model.
#[test]
fn a_model_may_be_borrowed_or_boxed() {
    let measure = Measure::ConditionalValueAtRisk { alpha: 0.5 };
    let problem = apart(&[3.0, 4.0], measure);
    let all: [&dyn Model; 2] = [&problem.model(), &Box::new(problem.model())];
    for model in all {
        assert!(model.parts().is_some());
        let (mut values, mut jacobian) = ([0.0], Jacobian::zeros(1, 1));
        model.derivatives(&[2.0], &mut values, &mut jacobian);
        assert_eq!((values, jacobian.row(0)), ([6.0], &[1.0][..]));
    }
}
