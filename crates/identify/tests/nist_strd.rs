//! Statistical Reference Datasets of the National Institute of Standards and Technology, nonlinear
//! regression: certified parameters, standard errors and sums of squares, from both published starts.

use std::sync::atomic::{AtomicU32, Ordering};

use grouser_identify::least_squares::{
    Bounded, Fit, Loss, Settings, StartSettings, Uncertainty, fit, multi_start, profile,
};
use grouser_opt::{Exact, Functions, Jacobian, Model};
use grouser_real::Scalar;

#[derive(Clone, Copy)]
enum Formula {
    Misra1a,
    BoxBod,
    Mgh09,
    Thurber,
}

struct Set {
    formula: Formula,
    data: &'static [(f64, f64)],
}

impl Functions for Set {
    fn evaluate<R: Scalar>(&self, b: &[R], out: &mut [R]) {
        for (slot, &(y, x)) in out.iter_mut().zip(self.data) {
            let x = R::from_f64(x);
            let value = match self.formula {
                Formula::Misra1a | Formula::BoxBod => b[0] * (R::ONE - (-b[1] * x).exp()),
                Formula::Mgh09 => b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]),
                Formula::Thurber => {
                    let above = b[0] + x * (b[1] + x * (b[2] + x * b[3]));
                    let below = R::ONE + x * (b[4] + x * (b[5] + x * b[6]));
                    above / below
                }
            };
            *slot = value - R::from_f64(y);
        }
    }
}

/// (certified value, certified standard error)
type Certified = &'static [(f64, f64)];

/// `starts` have the most evaluations that a search from there takes: its effort, a tenth above what it was.
fn check(
    formula: Formula,
    data: &'static [(f64, f64)],
    starts: [(&[f64], u32); 2],
    certified: Certified,
    squares: f64,
) {
    for (start, most) in starts {
        let bounded: Vec<Bounded> = start.iter().map(|s| Bounded::free(*s)).collect();
        let found = fit(
            &Exact(Set { formula, data }),
            data.len(),
            &bounded,
            &Settings {
                steps: 2000,
                ..Settings::default()
            },
        )
        .unwrap();
        assert!(found.status.is_solved(), "{:?}", found.status);
        assert!(found.evaluations <= most, "{}", found.evaluations);
        // certified to 11 digits; a double-precision sum of squares fixes parameters to about half its digits
        assert!(
            (sum_of_squares(&found) / squares - 1.0).abs() < 1e-9,
            "{}",
            sum_of_squares(&found)
        );
        let uncertainty = Uncertainty::from_fit(&found, Loss::Squares);
        for (k, (value, error)) in certified.iter().enumerate() {
            assert!(
                (found.x[k] / value - 1.0).abs() < 2e-7,
                "b{}: {}",
                k + 1,
                found.x[k]
            );
            let ours = uncertainty.standard_errors[k];
            assert!((ours / error - 1.0).abs() < 1e-6, "b{}: {ours}", k + 1);
        }
    }
}

const MISRA1A: &[(f64, f64)] = &[
    (10.07, 77.6),
    (14.73, 114.9),
    (17.94, 141.1),
    (23.93, 190.8),
    (29.61, 239.9),
    (35.18, 289.0),
    (40.02, 332.8),
    (44.82, 378.4),
    (50.76, 434.8),
    (55.05, 477.3),
    (61.01, 536.8),
    (66.40, 593.1),
    (75.47, 689.1),
    (81.78, 760.0),
];

/// Σ r².
fn sum_of_squares(fit: &Fit) -> f64 {
    fit.residuals.iter().map(|r| r * r).sum()
}

#[test]
fn misra1a() {
    check(
        Formula::Misra1a,
        MISRA1A,
        [(&[500.0, 0.0001], 36), (&[250.0, 0.0005], 14)],
        &[
            (2.389_421_291_8e2, 2.707_007_524_1),
            (5.501_564_318_1e-4, 7.266_868_843_6e-6),
        ],
        1.245_513_889_4e-1,
    );
}

/// From its first start this one is known to run away (b2 grows, the curve becomes a step): that is what
/// bounds and many starts are for.
#[test]
fn box_bod_from_many_starts() {
    const DATA: &[(f64, f64)] = &[
        (109.0, 1.0),
        (149.0, 2.0),
        (149.0, 3.0),
        (191.0, 5.0),
        (213.0, 7.0),
        (224.0, 10.0),
    ];
    let model = Exact(Set {
        formula: Formula::BoxBod,
        data: DATA,
    });
    let bounded = |start, upper| Bounded {
        start,
        lower: 0.0,
        upper,
    };
    let start = [bounded(1.0, 1000.0), bounded(1.0, 10.0)];
    let settings = Settings::default();
    let (found, reached) = multi_start(
        &model,
        DATA.len(),
        &start,
        &settings,
        &StartSettings::default(),
    )
    .unwrap();
    assert!(reached > 1, "{reached}");
    assert!((sum_of_squares(&found) / 1.168_008_876_6e3 - 1.0).abs() < 1e-9);
    // effort, a tenth above what it was
    for (k, most) in [(0, 160), (1, 76)] {
        let counted = Counted(&model, AtomicU32::new(0));
        profile(&counted, &found, k, 0.95, &settings).unwrap();
        let evaluations = counted.1.into_inner();
        assert!(evaluations <= most, "{evaluations}");
    }
    let errors = Uncertainty::from_fit(&found, Loss::Squares).standard_errors;
    for (k, (value, error)) in [
        (2.138_094_088_9e2, 1.235_451_517_6e1),
        (5.472_374_854_2e-1, 1.045_599_323_7e-1),
    ]
    .into_iter()
    .enumerate()
    {
        assert!((found.x[k] / value - 1.0).abs() < 2e-7);
        assert!((errors[k] / error - 1.0).abs() < 1e-6);
    }
}

#[test]
fn mgh09() {
    check(
        Formula::Mgh09,
        &[
            (1.957e-1, 4.0),
            (1.947e-1, 2.0),
            (1.735e-1, 1.0),
            (1.6e-1, 0.5),
            (8.44e-2, 0.25),
            (6.27e-2, 0.167),
            (4.56e-2, 0.125),
            (3.42e-2, 0.1),
            (3.23e-2, 0.0833),
            (2.35e-2, 0.0714),
            (2.46e-2, 0.0625),
        ],
        [
            (&[25.0, 39.0, 41.5, 39.0], 200),
            (&[0.25, 0.39, 0.415, 0.39], 32),
        ],
        &[
            (1.928_069_345_8e-1, 1.143_531_222_7e-2),
            (1.912_823_287_3e-1, 1.963_322_091_1e-1),
            (1.230_565_069_3e-1, 8.084_203_123_2e-2),
            (1.360_623_306_8e-1, 9.002_554_230_8e-2),
        ],
        3.075_056_038_5e-4,
    );
}

#[test]
fn thurber() {
    check(
        Formula::Thurber,
        &[
            (80.574, -3.067),
            (84.248, -2.981),
            (87.264, -2.921),
            (87.195, -2.912),
            (89.076, -2.84),
            (89.608, -2.797),
            (89.868, -2.702),
            (90.101, -2.699),
            (92.405, -2.633),
            (95.854, -2.481),
            (100.696, -2.363),
            (101.06, -2.322),
            (401.672, -1.501),
            (390.724, -1.46),
            (567.534, -1.274),
            (635.316, -1.212),
            (733.054, -1.1),
            (759.087, -1.046),
            (894.206, -0.915),
            (990.785, -0.714),
            (1090.109, -0.566),
            (1080.914, -0.545),
            (1122.643, -0.4),
            (1178.351, -0.309),
            (1260.531, -0.109),
            (1273.514, -0.103),
            (1288.339, 0.01),
            (1327.543, 0.119),
            (1353.863, 0.377),
            (1414.509, 0.79),
            (1425.208, 0.963),
            (1421.384, 1.006),
            (1442.962, 1.115),
            (1464.35, 1.572),
            (1468.705, 1.841),
            (1447.894, 2.047),
            (1457.628, 2.2),
        ],
        [
            (&[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03], 75),
            (&[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05], 56),
        ],
        &[
            (1.288_139_680_0e3, 4.664_796_334_4),
            (1.491_079_253_5e3, 3.957_115_608_6e1),
            (5.832_383_687_7e2, 2.869_869_610_2e1),
            (7.541_664_429_1e1, 5.567_537_027),
            (9.662_950_286_4e-1, 3.133_334_068_7e-2),
            (3.979_728_579_7e-1, 1.498_492_819_8e-2),
            (4.972_729_734_9e-2, 6.584_234_462_3e-3),
        ],
        5.642_708_239_7e3,
    );
}

/// A model that counts its evaluations.
struct Counted<M>(M, AtomicU32);

impl<M: Model> Model for Counted<M> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.values(x, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.derivatives(x, values, jacobian);
    }
}

/// A profile interval crosses the limit of likelihood where a scan by hand, with the other parameter in
/// closed form, crosses it too.
#[test]
fn a_profile_interval_ends_where_the_likelihood_does() {
    let model = Exact(Set {
        formula: Formula::Misra1a,
        data: MISRA1A,
    });
    let best = fit(
        &model,
        MISRA1A.len(),
        &[Bounded::free(250.0), Bounded::free(0.0005)],
        &Settings::default(),
    )
    .unwrap();
    let interval = profile(&model, &best, 1, 0.95, &Settings::default()).unwrap();
    // b1 is linear: for a given b2 its best value is Σ y g/Σ g²
    let least = |b2: f64| -> f64 {
        let g = |x: f64| 1.0 - (-b2 * x).exp();
        let (top, bottom) = MISRA1A.iter().fold((0.0, 0.0), |(t, b), (y, x)| {
            (t + y * g(*x), b + g(*x) * g(*x))
        });
        MISRA1A
            .iter()
            .map(|(y, x)| (top / bottom * g(*x) - y).powi(2))
            .sum()
    };
    // t(0.975, 12) = 2.178813 from a table
    let limit = sum_of_squares(&best) * (1.0 + 2.178_813_f64.powi(2) / 12.0);
    for end in [interval.low.unwrap(), interval.high.unwrap()] {
        let off = (least(end) - limit) / (limit - sum_of_squares(&best));
        assert!(off.abs() < 2e-3, "{off}");
    }
}
