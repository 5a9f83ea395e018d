//! Robust measures against closed forms, and the samples they stand on.

use grouser_opt::{
    Binary, CertifySettings, Differences, Error, Exact, Functions, Measure, Method, Problem,
    ProblemParams, Settings, Sobol, Solution, Tape, TapedFunctions, Uncertainty, Variable, World,
    certify, check_derivatives, evaluate, robust, sample, solve,
};
use grouser_real::Scalar;

/// (x − a)², with x ≤ limit as an inequality if `limit` is given.
struct Bowl {
    a: f64,
    limit: Option<f64>,
}
impl Functions for Bowl {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = (x[0] - R::from_f64(self.a)).square();
        if let Some(limit) = self.limit {
            f[1] = x[0] - R::from_f64(limit);
        }
    }
}

fn best(places: &[f64], measure: Measure) -> (f64, Solution) {
    let worlds: Vec<World<'_>> = places
        .iter()
        .map(|&a| World::new(a.to_string(), Exact(Bowl { a, limit: None })))
        .collect();
    let params = ProblemParams::new(
        &[0.3],
        1,
        Exact(Bowl {
            a: 0.0,
            limit: None,
        }),
    );
    let joint = robust(params, worlds, measure).unwrap();
    let mut at: Vec<f64> = joint.variables().iter().map(|v| v.start).collect();
    at[0] = 0.7;
    let check = check_derivatives(&joint, &at, 1e-6).unwrap();
    assert_eq!(check.wrong, []);
    let solution = solve(&joint, &Method::Minimax, &Settings::default()).unwrap();
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    (solution.x[0], solution)
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
}

const PLACES: [f64; 4] = [0.0, 1.0, 2.0, 7.0];

#[test]
fn worst_case_is_the_middle_of_the_extremes() {
    let (x, solution) = best(&PLACES, Measure::WorstCase);
    near(x, 3.5);
    assert_eq!(solution.objectives.len(), 4);
}

/// (x − a)² and (x − b)² as operations.
fn bowls(a: f64, b: f64) -> TapedFunctions {
    let mut tape = Tape::new();
    let x = tape.variable(0);
    let functions = [a, b].map(|place| {
        let place = tape.constant(place);
        let away = tape.binary(Binary::Sub, x, place);
        tape.binary(Binary::Mul, away, away)
    });
    TapedFunctions {
        functions: functions.to_vec(),
        tape,
    }
}

/// w max(x², (x − 1)²) + max((x − 4)², (x − 6)²): for 0.5 < x < 5 that is w x² + (x − 6)², least at 6/(1 + w); with a great
/// w at the kink. The sum over both worlds would be least at 11/4 for w = 1.
#[test]
fn a_weighted_sum_counts_each_objective_in_its_worst_world() {
    for (w, place) in [(1.0, 3.0), (3.0, 1.5), (100.0, 0.5)] {
        let params = ProblemParams::new(&[2.0], 2, bowls(0.0, 0.0))
            .variables([Variable::bounded("x", 2.0, -10.0, 10.0)]);
        let worlds =
            [(0.0, 4.0), (1.0, 6.0)].map(|(a, b)| World::new(format!("{a} {b}"), bowls(a, b)));
        let joint = robust(params, worlds.into(), Measure::WorstCase).unwrap();
        let weights = vec![w, w, 1.0, 1.0];
        let method = Method::Weighted { weights };
        let solution = solve(&joint, &method, &Settings::default()).unwrap();
        assert!(solution.status.is_solved(), "{:?}", solution.status);
        near(solution.x[0], place);
        let least = w * place * place + (place - 6.0_f64).powi(2);
        near(solution.utility, least);
        let merit = evaluate(&joint, &method, &solution.x).unwrap();
        near(merit.utility, least);
        // where one world is the worst it has the whole price
        let prices = &solution.multipliers.objectives;
        near(prices.iter().sum(), 1.0);
        near(prices[0] + prices[1], w / (1.0 + w));
        near(prices[3], 1.0 / (1.0 + w));
        if place > 0.5 {
            near(prices[1], 0.0);
        }
        let proved = certify(&joint, &method, &CertifySettings::default()).unwrap();
        assert!(proved.status.is_proved());
        assert!(
            proved.lower <= least + 1e-9 && least <= proved.upper + 1e-6,
            "{proved:?}"
        );
        assert!(
            proved.lower > least - 0.01 * least,
            "{} {least}",
            proved.lower
        );
    }
}

#[test]
fn the_mean_alone_is_least_at_the_mean() {
    let (x, solution) = best(&PLACES, Measure::MeanPlusDeviations { kappa: 0.0 });
    near(x, 2.5);
    // The variance of 0, 1, 2, 7 with 1/K.
    near(solution.objectives[0], 7.25);
}

#[test]
fn mean_plus_deviations_has_a_flat_slope_at_its_best() {
    let kappa = 1.5;
    let (x, solution) = best(&PLACES, Measure::MeanPlusDeviations { kappa });
    let measure = |x: f64| {
        let f: Vec<f64> = PLACES.iter().map(|a| (x - a).powi(2)).collect();
        let mean = f.iter().sum::<f64>() / 4.0;
        let variance = f.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / 4.0;
        mean + kappa * variance.sqrt()
    };
    near(solution.objectives[0], measure(x));
    assert!(measure(x) <= measure(x - 1e-3) && measure(x) <= measure(x + 1e-3));
}

#[test]
fn conditional_value_at_risk_is_the_mean_of_the_worst() {
    // The worst half of four worlds: two of them. At x both 0 and 7 are worst while
    // x > 1 … : minimise ((x)² + (x − 7)²)/2, at 3.5, where 1 and 2 are indeed nearer.
    let (x, solution) = best(&PLACES, Measure::ConditionalValueAtRisk { alpha: 0.5 });
    near(x, 3.5);
    near(solution.objectives[0], 3.5_f64.powi(2));
    // α = 0 is the mean.
    let (x, solution) = best(&PLACES, Measure::ConditionalValueAtRisk { alpha: 0.0 });
    near(x, 2.5);
    near(solution.objectives[0], 7.25);
    // Worst three quarters, at a point where the order is 7 > 0 > 1 > 2: ((x−7)² + x² + (x−1)²)/3 at 8/3.
    let (x, _) = best(&PLACES, Measure::ConditionalValueAtRisk { alpha: 0.25 });
    near(x, 8.0 / 3.0);
}

/// f_1 = (x − a)² + y, f_2 = (x − b)² − b y, |y| at most 2.
struct Pair(f64, f64);
impl Functions for Pair {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let (a, b) = (R::from_f64(self.0), R::from_f64(self.1));
        f[0] = (x[0] - a).square() + x[1];
        f[1] = (x[0] - b).square() - b * x[1];
    }
}

/// The same with the helpers of Rockafellar and Uryasev: x, y, then η and the excesses s_k of each objective; the rows
/// f_k − η − s_k ≤ 0.
struct Epigraph {
    places: Vec<(f64, f64)>,
    share: f64,
}
impl Functions for Epigraph {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let count = self.places.len();
        for i in 0..2 {
            let helpers = &x[2 + i * (1 + count)..];
            let mut excess = R::ZERO;
            for (k, (a, b)) in self.places.iter().enumerate() {
                let mut own = [R::ZERO; 2];
                Pair(*a, *b).evaluate(&x[..2], &mut own);
                f[2 + i * count + k] = own[i] - helpers[0] - helpers[1 + k];
                excess += helpers[1 + k];
            }
            f[i] = helpers[0] + R::from_f64(self.share) * excess;
        }
    }
}

fn places(count: usize) -> Vec<(f64, f64)> {
    let (low, high) = (vec![-1.0, 0.5], vec![1.0, 3.0]);
    let points = sample(&Uncertainty::Ranges { low, high }, count, 5).unwrap();
    points.into_iter().map(|p| (p[0], p[1])).collect()
}

/// The problem of [`Pair`] in many worlds.
fn pairs(places: &[(f64, f64)], alpha: f64) -> Problem<'static> {
    let variables = [("x", 5.0), ("y", 2.0)]
        .map(|(name, size): (&str, f64)| Variable::bounded(name, 0.3 * size, -size, size));
    let params = ProblemParams::new(&[0.0, 0.0], 2, Exact(Pair(0.0, 0.0))).variables(variables);
    let worlds = places.iter().enumerate();
    let worlds = worlds.map(|(k, (a, b))| World::new(k.to_string(), Exact(Pair(*a, *b))));
    let measure = Measure::ConditionalValueAtRisk { alpha };
    robust(params, worlds.collect(), measure).unwrap()
}

/// η + Σ max(0, f_k − η)/((1 − α) K) at the best η, which is one of the f_k.
fn tail_mean(values: &[f64], alpha: f64) -> f64 {
    let share = 1.0 / ((1.0 - alpha) * values.len() as f64);
    let beyond = |eta: f64| values.iter().map(|f| (f - eta).max(0.0)).sum::<f64>();
    let at = |eta: &f64| eta + share * beyond(*eta);
    values.iter().map(at).fold(f64::INFINITY, f64::min)
}

#[test]
fn conditional_values_at_risk_have_the_optimum_of_their_epigraph() {
    let methods = [
        Method::Minimax,
        Method::Weighted {
            weights: vec![1.0, 0.4],
        },
        Method::Attain {
            goals: vec![1.0, 0.5],
            weights: vec![1.0, 2.0],
        },
        Method::Attain {
            goals: vec![2.5, 0.0],
            weights: vec![0.0, 1.0],
        },
    ];
    for (count, alpha) in [(7, 0.3), (40, 0.9), (40, 0.99)] {
        let places = places(count);
        let joint = pairs(&places, alpha);
        let share = 1.0 / ((1.0 - alpha) * count as f64);
        let mut variables = joint.variables().to_vec();
        for i in 0..2 {
            variables.push(Variable::free(format!("eta {i}"), 100.0));
            let excess = |k| Variable::bounded(format!("s {i} {k}"), 0.0, 0.0, f64::INFINITY);
            variables.extend((0..count).map(excess));
        }
        let epigraph = Epigraph {
            places: places.clone(),
            share,
        };
        let start: Vec<f64> = variables.iter().map(|v| v.start).collect();
        let rows = (0..2 * count).map(|k| format!("row {k}"));
        let params = ProblemParams::new(&start, 2, Exact(epigraph))
            .variables(variables)
            .inequalities(rows);
        let epigraph = Problem::new(params).unwrap();
        for method in &methods {
            let mut settings = Settings::default();
            let solution = solve(&joint, method, &settings).unwrap();
            assert!(solution.status.is_solved(), "{method:?} {solution:?}");
            // (its probes move one variable without the helpers)
            settings.probes = 0;
            let expected = solve(&epigraph, method, &settings).unwrap();
            assert!(expected.status.is_solved(), "{method:?} {expected:?}");
            near(solution.utility, expected.utility);
            for (a, b) in solution.x.iter().zip(&expected.x) {
                assert!((a - b).abs() < 1e-5, "{method:?} {solution:?} {expected:?}");
            }
            let prices = [&solution, &expected].map(|s| &s.multipliers.objectives);
            for (a, b) in prices[0].iter().zip(prices[1]) {
                assert!((a - b).abs() < 1e-4, "{method:?} {solution:?} {expected:?}");
            }
            assert!(solution.kkt.stationarity < 1e-6, "{:?}", solution.kkt);
            for (i, found) in solution.objectives.iter().enumerate() {
                let values = places.iter().map(|(a, b)| {
                    let mut f = [0.0; 2];
                    Pair(*a, *b).evaluate(&solution.x, &mut f);
                    f[i]
                });
                near(*found, tail_mean(&values.collect::<Vec<_>>(), alpha));
            }
        }
    }
}

/// Thousands of worlds take as many iterations as some do. No small change of the point is better.
#[test]
fn thousands_of_worlds_are_solved_in_few_iterations() {
    let joint = pairs(&places(5000), 0.9);
    for method in [
        Method::Minimax,
        Method::Weighted {
            weights: vec![1.0, 0.4],
        },
    ] {
        let solution = solve(&joint, &method, &Settings::default()).unwrap();
        assert!(solution.status.is_solved(), "{solution:?}");
        assert!(solution.counts.iterations < 40, "{:?}", solution.counts);
        for (dx, dy) in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -1.0)] {
            for size in [1e-3, -1e-3] {
                let beside = [solution.x[0] + size * dx, solution.x[1] + size * dy];
                let merit = evaluate(&joint, &method, &beside).unwrap();
                let worse = merit.utility >= solution.utility - 1e-9;
                assert!(worse || merit.violation > 0.0, "{beside:?} {solution:?}");
            }
        }
    }
}

#[test]
fn constraints_hold_in_every_world() {
    for measure in [
        Measure::WorstCase,
        Measure::MeanPlusDeviations { kappa: 2.0 },
        Measure::ConditionalValueAtRisk { alpha: 0.9 },
    ] {
        let params = ProblemParams::new(
            &[0.3],
            1,
            Exact(Bowl {
                a: 0.0,
                limit: Some(0.0),
            }),
        )
        .inequalities(vec!["limit".to_owned()]);
        let worlds = [2.0, 1.2, 5.0].map(|limit| {
            let limit = Some(limit);
            World::new(
                limit.map_or(String::new(), |l: f64| l.to_string()),
                Exact(Bowl { a: 4.0, limit }),
            )
        });
        let joint = robust(params, worlds.into(), measure).unwrap();
        let solution = solve(&joint, &Method::Minimax, &Settings::default()).unwrap();
        near(solution.x[0], 1.2);
        assert!(
            solution.active.iter().any(|name| name == "limit @ 1.2"),
            "{:?}",
            solution.active
        );
    }
}

#[test]
fn no_worlds_and_bad_measures_are_errors() {
    let params = || ProblemParams::new(&[0.3], 1, Differences::new(|_: &[f64], _: &mut [f64]| {}));
    let none = robust(params(), Vec::new(), Measure::WorstCase);
    assert!(matches!(none, Err(Error::Empty { what: "worlds" })));
    let one = vec![World::new(
        "one",
        Exact(Bowl {
            a: 0.0,
            limit: None,
        }),
    )];
    let bad = robust(
        params(),
        one,
        Measure::ConditionalValueAtRisk { alpha: 1.0 },
    );
    assert!(matches!(bad, Err(Error::OutOfRange(_))));
}

/// The first points as published with SciPy's implementation of the same direction numbers.
#[test]
fn sobol_matches_an_independent_implementation() {
    let mut sobol = Sobol::new(5, None).unwrap();
    let points: Vec<Vec<f64>> = (0..8).map(|_| sobol.next_point()).collect();
    assert_eq!(points[2], [0.75, 0.25, 0.25, 0.25, 0.75]);
    assert_eq!(points[4], [0.375, 0.375, 0.625, 0.875, 0.375]);
    assert_eq!(points[7], [0.125, 0.625, 0.375, 0.125, 0.125]);
    let mut sobol = Sobol::new(64, None).unwrap();
    let last = (0..=1000).map(|_| sobol.next_point()).last().unwrap();
    let picked: Vec<f64> = [0, 1, 10, 40, 63].iter().map(|&d| last[d]).collect();
    assert_eq!(
        picked,
        [
            0.219_726_562_5,
            0.096_679_687_5,
            0.084_960_937_5,
            0.913_085_937_5,
            0.446_289_062_5
        ]
    );
    assert!(Sobol::new(65, None).is_err());
}

#[test]
fn normal_samples_have_their_covariance() {
    let covariance = vec![vec![4.0, 1.2], vec![1.2, 1.0]];
    let normal = Uncertainty::Normal {
        mean: vec![10.0, -3.0],
        covariance: covariance.clone(),
    };
    let n = 4096;
    let samples = sample(&normal, n, 3).unwrap();
    assert_eq!(samples, sample(&normal, n, 3).unwrap());
    let mean = |i: usize| samples.iter().map(|s| s[i]).sum::<f64>() / n as f64;
    let means = [mean(0), mean(1)];
    // Quasi-random: the error falls like log²(n)/n, here below 1e-2.
    assert!((means[0] - 10.0).abs() < 1e-2 && (means[1] + 3.0).abs() < 1e-2);
    for i in 0..2 {
        for j in 0..2 {
            let product = |s: &Vec<f64>| (s[i] - means[i]) * (s[j] - means[j]);
            let got = samples.iter().map(product).sum::<f64>() / n as f64;
            assert!((got - covariance[i][j]).abs() < 2e-2, "{i}{j} {got}");
        }
    }
    let skew = Uncertainty::Normal {
        mean: vec![0.0, 0.0],
        covariance: vec![vec![1.0, 2.0], vec![2.0, 1.0]],
    };
    let error = sample(&skew, 2, 1).unwrap_err();
    assert!(
        matches!(error, Error::NotPositiveDefinite { pivot: 2, .. }),
        "{error}"
    );
}
