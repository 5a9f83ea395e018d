//! The fit and what it says of its parameters, against the formulas that a straight line, a box and a distribution have.

use std::sync::atomic::{AtomicU32, Ordering};

use grouser_identify::Error;
use grouser_identify::least_squares::{
    Bounded, Interval, Loss, Settings, StartSettings, Status, Uncertainty, Verdict, fit,
    multi_start, profile, student_quantile,
};
use grouser_opt::{Exact, Functions, Jacobian, Model};
use grouser_real::Scalar;
use proptest::prelude::*;

/// A x − b.
struct Linear {
    rows: Vec<Vec<f64>>,
    right: Vec<f64>,
    evaluations: AtomicU32,
    jacobians: AtomicU32,
}

impl Linear {
    fn new(rows: Vec<Vec<f64>>, right: Vec<f64>) -> Self {
        Self {
            rows,
            right,
            evaluations: AtomicU32::new(0),
            jacobians: AtomicU32::new(0),
        }
    }

    /// y = a + b x.
    fn line(points: &[(f64, f64)]) -> Self {
        let rows = points.iter().map(|(x, _)| vec![1.0, *x]).collect();
        Self::new(rows, points.iter().map(|(_, y)| *y).collect())
    }

    fn fit(&self, start: &[Bounded], loss: Loss) -> grouser_identify::least_squares::Fit {
        let settings = Settings {
            loss,
            ..Settings::default()
        };
        fit(self, self.right.len(), start, &settings).unwrap()
    }
}

impl Model for Linear {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        for ((slot, row), b) in values.iter_mut().zip(&self.rows).zip(&self.right) {
            *slot = row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b;
        }
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        self.jacobians.fetch_add(1, Ordering::Relaxed);
        for (index, row) in self.rows.iter().enumerate() {
            jacobian.row_mut(index).copy_from_slice(row);
        }
    }
}

fn close(found: f64, wanted: f64, relative: f64) -> bool {
    (found - wanted).abs() <= relative * wanted.abs()
}

/// Points about a line, with abscissas that differ.
fn points() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let noise = prop::collection::vec((0.1..1.0_f64, -1.0..1.0_f64), 4..12);
    (noise, -5.0..5.0_f64, -3.0..3.0_f64, -2.0..2.0_f64).prop_map(|(steps, from, a, b)| {
        let mut x = from;
        let mut point = |(step, noise): (f64, f64)| {
            x += step;
            (x, a + b * x + noise)
        };
        steps.into_iter().map(&mut point).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The textbook's formulas of a straight line with weights w: slope S_xy/S_xx about the weighted means, errors from
    /// S_xx. Huber's answer is that of its own weights.
    #[test]
    fn a_straight_line_has_its_closed_form(
        points in points(),
        threshold in prop::option::of(0.4..1.0_f64),
        start in (-9.0..9.0_f64, -9.0..9.0_f64),
    ) {
        let loss = threshold.map_or(Loss::Squares, |threshold| Loss::Huber { threshold });
        let line = Linear::line(&points);
        let fit = line.fit(&[Bounded::free(start.0), Bounded::free(start.1)], loss);
        prop_assert!(fit.status.is_solved());
        let weight = |r: f64| threshold.map_or(1.0, |t| (t / r.abs()).min(1.0));
        let rho = |r: f64| threshold.map_or(0.5 * r * r, |t| if r.abs() < t { 0.5 * r * r } else { t * r.abs() - 0.5 * t * t });
        let (a, b) = (fit.x[0], fit.x[1]);
        let residual = |(x, y): &(f64, f64)| a + b * x - y;
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            points.iter().map(|(x, y)| of(weight(residual(&(*x, *y))), *x, *y)).sum()
        };
        let total = sum(&|w, _, _| w);
        let (x_mean, y_mean) = (sum(&|w, x, _| w * x) / total, sum(&|w, _, y| w * y) / total);
        let s_xx = sum(&|w, x, _| w * (x - x_mean).powi(2));
        let slope = sum(&|w, x, y| w * (x - x_mean) * (y - y_mean)) / s_xx;
        prop_assert!(close(fit.cost, points.iter().map(|p| rho(residual(p))).sum(), 1e-12));

        let uncertainty = Uncertainty::from_fit(&fit, loss);
        let freedom = points.len() - 2;
        let squares: f64 = points.iter().map(|p| weight(residual(p)) * residual(p).powi(2)).sum();
        let s = (squares / freedom as f64).sqrt();
        prop_assume!(s > 1e-3);
        // effort: a quadratic is met in a few steps of λ, and every evaluation is counted
        prop_assert_eq!(fit.evaluations, line.evaluations.load(Ordering::Relaxed));
        prop_assert!(fit.jacobians == line.jacobians.load(Ordering::Relaxed) && (threshold.is_some() || fit.evaluations <= 20), "{}", fit.evaluations);
        prop_assert_eq!(uncertainty.freedom, freedom);
        prop_assert!(close(uncertainty.residual_deviation, s, 1e-12));
        let errors = [s * (1.0 / total + x_mean.powi(2) / s_xx).sqrt(), s / s_xx.sqrt()];
        // a cosine of 1e-8 between residuals and columns leaves this share of the standard errors
        let off = [(a - (y_mean - slope * x_mean)) / errors[0], (b - slope) / errors[1]];
        let cosine = sum(&|w, x, _| w * x) / (total * sum(&|w, x, _| w * x * x)).sqrt();
        let condition = ((1.0 + cosine.abs()) / (1.0 - cosine.abs())).sqrt();
        prop_assert!(off.iter().all(|off| off.abs() < 1e-7 * condition.powi(2)), "{off:?} {condition}");
        prop_assert!(close(uncertainty.condition, condition, 1e-9 * condition.powi(2)));
        for (k, error) in errors.into_iter().enumerate() {
            prop_assert!(close(uncertainty.standard_errors[k], error, 1e-9), "{k}: {error}");
            let t = student_quantile(0.95, freedom);
            prop_assert!(close(uncertainty.half_width(k, 0.9), t * error, 1e-9));
            prop_assert!((uncertainty.correlation[k][1 - k] + cosine).abs() < 1e-9);
            prop_assert!((uncertainty.correlation[k][k] - 1.0).abs() < 1e-12);
            // no bounds: loose is what its error exceeds a third of
            let loose = error > fit.x[k].abs() / 3.0;
            prop_assert_eq!(uncertainty.verdicts[k], if loose { Verdict::Loose } else { Verdict::Identified });
        }
        // the likelihood of a line is a parabola: its profile ends at ± t times the standard error
        if threshold.is_none() {
            for (k, error) in errors.into_iter().enumerate() {
                let before = line.evaluations.load(Ordering::Relaxed);
                let found = profile(&line, &fit, k, 0.95, &Settings::default()).unwrap();
                let half = student_quantile(0.975, freedom) * error;
                prop_assert!(close(found.low.unwrap() - fit.x[k], -half, 6e-4));
                prop_assert!(close(found.high.unwrap() - fit.x[k], half, 6e-4));
                prop_assert!(line.evaluations.load(Ordering::Relaxed) - before <= 80); // effort: some six fits for an end
            }
        }
    }

    /// At the answer in a box the cost falls in no direction that the box leaves open.
    #[test]
    fn an_answer_in_a_box_meets_the_conditions_of_optimality(
        rows in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 3), 3..9),
        right in prop::collection::vec(-3.0..3.0_f64, 9),
        bounds in prop::collection::vec((-1.0..0.0_f64, 0.0..1.0_f64, 0.0..=1.0_f64), 3),
    ) {
        let count = rows.len();
        let model = Linear::new(rows, right[..count].to_vec());
        let start: Vec<Bounded> = bounds
            .iter()
            .map(|(lower, upper, share)| Bounded { start: (lower + share * (upper - lower)).clamp(*lower, *upper), lower: *lower, upper: *upper })
            .collect();
        let fit = model.fit(&start, Loss::Squares);
        prop_assert!(fit.status.is_solved(), "{:?}", fit.status);
        for (k, bound) in start.iter().enumerate() {
            prop_assert!(fit.x[k] >= bound.lower && fit.x[k] <= bound.upper);
            let slope: f64 = model.rows.iter().zip(&fit.residuals).map(|(row, r)| row[k] * r).sum();
            prop_assert!(fit.x[k] < bound.upper || slope < 1e-6, "{slope}");
            prop_assert!(fit.x[k] > bound.lower || slope > -1e-6, "{slope}");
            prop_assert_eq!(fit.on_bound(k), fit.x[k] == bound.lower || fit.x[k] == bound.upper);
            prop_assert!(fit.on_bound(k) || slope.abs() < 1e-5, "{slope}");
        }
    }

    /// Student's distribution has an elementary quantile for 1, 2 and 4 degrees of freedom (Shaw, J. Computational
    /// Finance 9 (2006)), and the normal's with Fisher's and Cornish's terms for many.
    #[test]
    fn quantiles_have_their_closed_forms(p in 0.5..0.999_f64) {
        let alpha = 4.0 * p * (1.0 - p);
        let exact = [
            (1, (std::f64::consts::PI * (p - 0.5)).tan()),
            (2, 2.0 * (p - 0.5) * (2.0 / alpha).sqrt()),
            (4, 2.0 * ((alpha.sqrt().acos() / 3.0).cos() / alpha.sqrt() - 1.0).max(0.0).sqrt()),
        ];
        for (freedom, t) in exact {
            let found = student_quantile(p, freedom);
            prop_assert!((found - t).abs() <= 1e-9 * t + 1e-10, "{freedom}: {found} {t}");
            prop_assert_eq!(student_quantile(1.0 - p, freedom), -student_quantile(1.0 - (1.0 - p), freedom));
        }
    }
}

#[test]
fn quantiles_of_many_degrees_of_freedom_are_those_of_the_normal() {
    // z(0.975) and z(0.995) of the normal; Abramowitz & Stegun 26.7.5
    for z in [1.959_963_984_540_054_f64, 2.575_829_303_548_901] {
        let p = if z < 2.0 { 0.975 } else { 0.995 };
        for freedom in [100_u32, 101, 1000, 100_001] {
            let v = f64::from(freedom);
            let first = (z.powi(3) + z) / (4.0 * v);
            let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * v * v);
            let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z)
                / (384.0 * v.powi(3));
            let found = student_quantile(p, usize::try_from(freedom).unwrap());
            assert!(
                (found - (z + first + second + third)).abs() < 1e-6 * 100.0 / v,
                "{v}: {found}"
            );
        }
    }
    for (p, freedom) in [(0.0, 1), (1.0, 1), (0.5, 0), (f64::NAN, 1)] {
        assert!(student_quantile(p, freedom).is_nan());
    }
    assert!(student_quantile(0.5, 3).abs() < 1e-15);
}

/// What the data say: a parameter without effect, two of which only the sum matters, one on its bound, one whose
/// error is as wide as its bounds, and an offset about 0.
#[test]
fn every_verdict_has_its_reason() {
    let within = |start, lower, upper| Bounded {
        start,
        lower,
        upper,
    };
    // y = 2 with a known scatter of ±0.1 in six readings; s = 0.1 √(6/5) about the mean
    let noise = [0.1, -0.1, 0.1, -0.1, 0.1, -0.1];
    let column = |row: Vec<f64>, y: f64| Linear::new(vec![row; 6], noise.map(|n| y + n).to_vec());
    let verdicts = |model: &Linear, start: &[Bounded]| {
        let found = model.fit(start, Loss::Squares);
        (Uncertainty::from_fit(&found, Loss::Squares), found)
    };
    let error = |freedom: f64| 0.1 * (6.0 / freedom).sqrt() / 6_f64.sqrt();

    let (all, _) = verdicts(
        &column(vec![1.0, 0.0], 2.0),
        &[within(0.0, -9.0, 7.0), within(0.5, 0.0, 1.0)],
    );
    assert_eq!(
        all.verdicts,
        [Verdict::Identified, Verdict::NotIdentifiable]
    );
    assert!(close(all.standard_errors[0], error(4.0), 1e-12) && all.standard_errors[1].is_nan());
    assert!(
        all.correlation[1][0].is_nan()
            && all.correlation[0][1].is_nan()
            && close(all.condition, 1.0, 1e-12)
    );

    let (all, found) = verdicts(
        &column(vec![1.0, 1.0], 2.0),
        &[within(0.0, -9.0, 7.0), within(0.5, -9.0, 7.0)],
    );
    assert_eq!(all.verdicts, [Verdict::NotIdentifiable; 2]);
    assert!(close(found.x[0] + found.x[1], 2.0, 1e-9) && all.condition > 1e8);

    let (all, found) = verdicts(&column(vec![1.0], 2.0), &[within(0.0, -9.0, 1.5)]);
    assert_eq!(
        (all.verdicts[0], found.x[0], all.freedom),
        (Verdict::OnBound, 1.5, 6)
    );
    assert!(all.standard_errors[0].is_nan());

    // 95 % of 5 degrees of freedom: ± 2.5706 · 0.0447 = ± 0.115 about 2
    for (upper, verdict) in [(2.115, Verdict::Identified), (2.114, Verdict::Loose)] {
        let (all, _) = verdicts(&column(vec![1.0], 2.0), &[within(2.0, 1.885, upper)]);
        assert_eq!(all.verdicts[0], verdict, "{}", all.half_width(0, 0.95));
    }
    // an error of 0.0447 is a third of 0.134
    for (value, upper, verdict) in [
        (0.135, 7.0, Verdict::Identified),
        (0.133, 7.0, Verdict::Loose),
        (-0.135, 7.0, Verdict::Identified),
        (-0.133, 7.0, Verdict::Loose),
        (0.0, 9.0, Verdict::Identified), // an offset
        (0.133, f64::INFINITY, Verdict::Loose),
        (0.135, f64::INFINITY, Verdict::Identified),
    ] {
        let lower = if upper == 7.0 { -9.0 } else { -upper };
        let (all, _) = verdicts(&column(vec![1.0], value), &[within(0.0, lower, upper)]);
        assert_eq!(all.verdicts[0], verdict, "{value} {upper}");
    }
    // columns that differ by 1e-5 are apart, if only just; one that is 1e-10 off is not seen
    for (apart, verdict) in [(1e-5, Verdict::Loose), (1e-10, Verdict::NotIdentifiable)] {
        let even = [0.1, -0.1, 0.05, 0.05, -0.1, 0.1].into_iter().enumerate();
        let points: Vec<(f64, f64)> = even.map(|(i, y)| (1.0 + apart * i as f64, y)).collect();
        let (all, _) = verdicts(&Linear::line(&points), &[within(0.0, -9.0, 7.0); 2]);
        assert_eq!(all.verdicts, [verdict; 2], "{}", all.condition);
    }
    // as many readings as numbers leave no error to judge by
    let line = Linear::line(&[(0.1, 0.3), (0.7, 1.0 / 3.0)]);
    let unfinished = Settings {
        steps: 0,
        ..Settings::default()
    };
    let fit = fit(&line, 2, &[Bounded::free(0.0); 2], &unfinished).unwrap();
    let all = Uncertainty::from_fit(&fit, Loss::Squares);
    assert!(fit.cost > 0.0 && all.freedom == 0 && all.residual_deviation.is_nan());
}

/// Rosenbrock's valley as residuals: 10 (y − x²), 1 − x.
struct Valley;

impl Functions for Valley {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        out[0] = R::from_f64(10.0) * (x[1] - x[0] * x[0]);
        out[1] = R::ONE - x[0];
    }
}

#[test]
fn a_fit_ends_for_a_reason() {
    let start = [Bounded::free(-1.2), Bounded::free(1.0)];
    let run = |settings: Settings| fit(&Exact(Valley), 2, &start, &settings).unwrap();
    let usual = Settings::default();
    let found = run(usual);
    assert!(
        found.status.is_solved() && close(found.x[0], 1.0, 1e-9) && close(found.x[1], 1.0, 1e-9)
    );
    // MINPACK's lmder takes 21 evaluations and 16 Jacobians from here (Moré, Garbow & Hillstrom, ANL-80-74, 1980)
    assert!(
        found.evaluations <= 42 && found.jacobians <= 32,
        "{} {}",
        found.evaluations,
        found.jacobians
    );
    let short = run(Settings { steps: 3, ..usual });
    assert!(short.status == Status::StepLimit && !short.status.is_solved());
    assert_eq!(
        run(Settings {
            change: 10.0,
            ..usual
        })
        .status,
        Status::Stalled
    );
    assert_eq!(
        run(Settings {
            cosine: 1.0,
            ..usual
        })
        .status,
        Status::Converged
    );
    assert!(short.cost < 12.1 && short.cost > 1e-3); // 24.2/2 at the start

    let keys = [
        Status::Converged,
        Status::Stalled,
        Status::StepLimit,
        Status::NoValue,
    ]
    .map(Status::key);
    assert_eq!(keys, ["converged", "stalled", "step-limit", "no-value"]);
    let keys = [
        Verdict::Identified,
        Verdict::OnBound,
        Verdict::NotIdentifiable,
        Verdict::Loose,
    ]
    .map(Verdict::key);
    assert_eq!(
        keys,
        ["identified", "on-bound", "not-identifiable", "loose"]
    );
}

/// ln x − 2: without a value at and below 0.
struct Logarithm;

impl Functions for Logarithm {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        out[0] = x[0].ln() - R::from_f64(2.0);
    }
}

#[test]
fn steps_to_where_there_is_no_value_are_refused() {
    let run = |start: f64| {
        fit(
            &Exact(Logarithm),
            1,
            &[Bounded::free(start)],
            &Settings::default(),
        )
        .unwrap()
    };
    // Newton's first step from 40 ends at 40 (1 − ln 40 + 2) < 0
    assert!(close(run(40.0).x[0], 2_f64.exp(), 1e-9));
    assert_eq!(run(-1.0).status, Status::NoValue);
}

#[test]
fn a_start_out_of_its_bounds_and_too_few_readings_are_refused() {
    let model = Linear::line(&[(0.0, 1.0), (1.0, 3.0)]);
    let run = |start: &[Bounded]| fit(&model, 2, start, &Settings::default());
    let free = Bounded::free(0.0);
    for start in [-1.1, 1.1, f64::NAN] {
        let bounded = Bounded {
            start,
            lower: -1.0,
            upper: 1.0,
        };
        assert!(matches!(
            run(&[free, bounded]),
            Err(Error::Start { index: 1, .. })
        ));
    }
    assert!(matches!(
        run(&[Bounded::free(f64::INFINITY), free]),
        Err(Error::Start { index: 0, .. })
    ));
    for start in [-1.0, 1.0] {
        let on_bound = run(&[
            free,
            Bounded {
                start,
                lower: -1.0,
                upper: 1.0,
            },
        ])
        .unwrap();
        assert_eq!(on_bound.x[1], 1.0);
    }
    assert!(matches!(
        run(&[free; 3]),
        Err(Error::TooFew {
            residuals: 2,
            parameters: 3
        })
    ));
}

/// cos-like valleys at every whole number, the one at 0 the deepest: 0.1 x, and 1 − cos 2πx as sin πx.
struct Valleys;

impl Functions for Valleys {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        out[0] = R::from_f64(0.1) * x[0];
        out[1] = (R::from_f64(std::f64::consts::PI) * x[0]).sin();
    }
}

#[test]
fn many_starts_find_the_deepest_valley() {
    let start = [Bounded {
        start: 3.9,
        lower: -4.5,
        upper: 4.5,
    }];
    let run = |starts: usize, seed| {
        multi_start(
            &Exact(Valleys),
            2,
            &start,
            &Settings::default(),
            &StartSettings { starts, seed },
        )
        .unwrap()
    };
    // the given start comes first, and alone where no other is wanted
    for starts in [0, 1] {
        let (alone, reached) = run(starts, 1);
        assert!(
            (alone.x[0] - 3.9).abs() < 0.3 && reached == 1,
            "{}",
            alone.x[0]
        );
    }
    let (found, reached) = run(32, 1);
    assert!(
        found.x[0].abs() < 1e-6 && (1..16).contains(&reached),
        "{} {reached}",
        found.x[0]
    );
    // one valley alone: all starts reach it, and the given one is kept
    let line = Linear::line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.5)]);
    let bounds = [
        Bounded {
            start: 0.5,
            lower: -9.0,
            upper: 9.0,
        },
        Bounded::free(0.0),
    ];
    let (_, reached) = multi_start(
        &line,
        3,
        &bounds,
        &Settings::default(),
        &StartSettings { starts: 7, seed: 2 },
    )
    .unwrap();
    assert_eq!(reached, 7);
    let many = vec![Bounded::free(0.0); 65];
    let refused = multi_start(
        &line,
        99,
        &many,
        &Settings::default(),
        &StartSettings::default(),
    );
    assert!(matches!(refused, Err(Error::TooMany { parameters: 65 })));
}

/// x y = 1 and x = 1: a profile of y follows 1/x, which no interval about the answer does.
#[test]
fn a_profile_ends_at_bounds() {
    let noise = [0.1, -0.1, 0.1, -0.1, 0.1, -0.1];
    let model = Linear::new(vec![vec![1.0]; 6], noise.map(|n| 2.0 + n).to_vec());
    let interval = |lower: f64, upper: f64| {
        let fit = model.fit(
            &[Bounded {
                start: 2.0,
                lower,
                upper,
            }],
            Loss::Squares,
        );
        profile(&model, &fit, 0, 0.95, &Settings::default()).unwrap()
    };
    // t(0.975, 5) = 2.570582; s/√6 = 0.1/√5
    let half = 2.570_582 * 0.1 / 5_f64.sqrt();
    for (lower, upper) in [
        (1.9, 9.0),
        (-9.0, 2.1),
        (1.9, 2.1),
        (-9.0, 9.0),
        (2.0 - 1.01 * half, 2.0 + 1.01 * half),
    ] {
        let Interval { low, high } = interval(lower, upper);
        for (end, bound, wanted) in [(low, lower, 2.0 - half), (high, upper, 2.0 + half)] {
            if (bound - 2.0).abs() < half {
                assert_eq!(end, None, "{lower} {upper}");
            } else {
                assert!(
                    (end.unwrap() - wanted).abs() < 6e-4 * half,
                    "{lower} {upper}: {end:?}"
                );
            }
        }
    }
}

/// A slope that the values do not follow.
struct Plateau;
impl Model for Plateau {
    fn values(&self, _: &[f64], values: &mut [f64]) {
        values[0] = 1.0;
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        jacobian.set(0, 0, 1.0);
    }
}

/// What ends a search, on functions where it can be foreseen.
#[test]
fn ends_that_can_be_foreseen() {
    let usual = Settings::default();
    let free = |x: &[f64]| -> Vec<Bounded> { x.iter().copied().map(Bounded::free).collect() };
    // begun at its answer, without a residual
    let exact = Linear::line(&[(0.0, 1.0), (1.0, 3.0)]);
    let found = fit(&exact, 2, &free(&[1.0, 2.0]), &usual).unwrap();
    assert_eq!((found.status, found.evaluations), (Status::Converged, 1));
    // a first step from (10, 10) to (1, 1), in columns of norms 1 and 1000: 0.9 of the parameters, each by its scale
    let scaled = Linear::new(vec![vec![1.0, 0.0], vec![0.0, 1000.0]], vec![1.0, 1000.0]);
    for (change, moves) in [(0.8, true), (0.95, false)] {
        let found = fit(
            &scaled,
            2,
            &free(&[10.0, 10.0]),
            &Settings { change, ..usual },
        )
        .unwrap();
        assert!(
            found.status == Status::Stalled && (found.x[0] < 9.0) == moves,
            "{change}"
        );
    }
    // without limits to precision the search ends where the step is lost in rounding
    let mean = Linear::new(vec![vec![1.0]; 3], vec![2.9, 3.0, 3.1]);
    let to_the_end = Settings {
        change: 0.0,
        cosine: 0.0,
        ..usual
    };
    let found = fit(&mean, 3, &free(&[0.0]), &to_the_end).unwrap();
    assert!(
        found.status.is_solved() && found.evaluations <= 16,
        "{:?} {}",
        found.status,
        found.evaluations
    );
    // a slope that the values do not follow: 2 · 4 · 8 … carries λ to its limit in 15 steps
    let found = fit(
        &Plateau,
        1,
        &free(&[5.0]),
        &Settings {
            change: 0.0,
            ..usual
        },
    )
    .unwrap();
    assert_eq!((found.status, found.x[0]), (Status::Stalled, 5.0));
    assert!(found.evaluations <= 17, "{}", found.evaluations);
}

/// Begun anywhere, a fit without a slope ends where it begins.
struct Flat(std::sync::Mutex<Vec<f64>>);

impl Model for Flat {
    fn values(&self, _: &[f64], values: &mut [f64]) {
        values[0] = 1.0;
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], _: &mut Jacobian) {
        self.values(x, values);
        self.0.lock().unwrap().push(x[0]);
    }
}

#[test]
fn starts_are_spread_over_the_bounds_and_the_first_of_equals_wins() {
    let flat = Flat(std::sync::Mutex::default());
    let start = [Bounded {
        start: 6.0,
        lower: 5.0,
        upper: 25.0,
    }];
    let starts = StartSettings {
        starts: 17,
        seed: 3,
    };
    let (found, reached) = multi_start(&flat, 1, &start, &Settings::default(), &starts).unwrap();
    assert_eq!((found.x[0], found.cost, reached), (6.0, 0.5, 17));
    let mut begun = flat.0.into_inner().unwrap();
    begun.retain(|x| *x != 6.0);
    begun.sort_by(f64::total_cmp);
    // sixteen Sobol points, one of them perhaps in each sixteenth; none in the outer 2 %
    assert!(
        begun.len() == 16 && begun[0] >= 5.4 && begun[15] <= 24.6,
        "{begun:?}"
    );
    for (index, x) in begun.iter().enumerate() {
        assert!(
            (x - (5.0 + 20.0 * (index as f64 + 0.5) / 16.0)).abs() < 1.5,
            "{begun:?}"
        );
    }
}

/// A profile's effort, and what it makes of fits without an error or without an end.
#[test]
fn a_profile_ends_soon() {
    let of = |model: &Linear, start: &[Bounded]| {
        let fit = model.fit(start, Loss::Squares);
        let before = model.evaluations.load(Ordering::Relaxed);
        let found = profile(model, &fit, 0, 0.95, &Settings::default()).unwrap();
        (found, model.evaluations.load(Ordering::Relaxed) - before)
    };
    let open = Interval {
        low: None,
        high: None,
    };
    let noisy = Linear::line(&[(0.0, 1.1), (1.0, 2.9), (2.0, 5.1), (3.0, 6.9)]);
    // both bounds are reached at the first step
    let near = [
        Bounded {
            start: 1.0,
            lower: 0.99,
            upper: 1.2,
        },
        Bounded::free(2.0),
    ];
    let (found, evaluations) = of(&noisy, &near);
    assert!(
        found == open && evaluations <= 15,
        "{found:?} {evaluations}"
    );
    // of two numbers of which the data show the sum each may go anywhere
    let sum = Linear::new(vec![vec![1.0, 1.0]; 4], vec![1.1, 2.9, 5.1, 6.9]);
    for (start, most) in [
        (Bounded::free(2.0), 240),
        (
            Bounded {
                start: 2.0,
                lower: -50.0,
                upper: 50.0,
            },
            55,
        ),
    ] {
        let (found, evaluations) = of(&sum, &[start, Bounded::free(2.0)]);
        assert!(
            found == open && evaluations <= most,
            "{found:?} {evaluations}"
        );
    }
    // a fit without an error has no width, whether the search ends near its answer or begins there
    for start in [0.0, 3.0] {
        for bounded in [
            Bounded::free(start),
            Bounded {
                start,
                lower: -9.0,
                upper: 9.0,
            },
        ] {
            let exact = Linear::new(vec![vec![1.0]; 3], vec![3.0; 3]);
            let (found, _) = of(&exact, &[bounded]);
            let ends = [found.low.unwrap(), found.high.unwrap()];
            assert!(ends.iter().all(|end| (end - 3.0).abs() < 1e-6), "{found:?}");
        }
    }
    // from a bound the cost (m/2) (x − 2)² + … has its end where a parabola through 2 has it: a width of 10.5 is no guess
    let noise = [0.1, -0.1, 0.1, -0.1, 0.1, -0.1];
    let held = Linear::new(vec![vec![1.0]; 6], noise.map(|n| 2.0 + n).to_vec());
    let (found, evaluations) = of(
        &held,
        &[Bounded {
            start: 0.0,
            lower: -9.0,
            upper: 1.5,
        }],
    );
    // s² = Σr²/6, since nothing is free: 6 (2 − x)² = 6 · 0.5² + t² s², t(0.975, 6) = 2.446912
    let end = 2.0 - (0.25 + 2.446_912_f64.powi(2) * (0.25 + 0.01) / 6.0).sqrt();
    assert!(
        found.high.is_none() && (found.low.unwrap() - end).abs() < 1e-3,
        "{found:?} {end}"
    );
    assert!(evaluations <= 8, "{evaluations}");
}
