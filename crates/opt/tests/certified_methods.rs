//! What a certificate is about: the merit of a point under each method, by the program that scores points.

use std::ops::ControlFlow;

use grouser_opt::{
    Certificate, CertifySettings, CertifyStatus, Exact, Functions, LinearConstraint, Method,
    Problem, ProblemParams, Variable, certify, certify_with, evaluate,
};
use grouser_real::Scalar;

use crate::random_starts::Stream;

/// Four objectives of both signs, an inequality, and an equality where `has_equality`.
struct Mixed {
    a: [f64; 4],
    has_equality: bool,
}

impl Functions for Mixed {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let [a, b, c, d] = self.a.map(R::from_f64);
        f[0] = a * x[0].square() - b * x[1] + c;
        f[1] = (b * x[0]).sin() + d * x[1].square();
        f[2] = c * x[0] * x[1] - a;
        f[3] = (x[0] - d).square() - (c * x[1]).exp();
        f[4] = x[0].square() + a * x[1] - R::ONE;
        if self.has_equality {
            f[5] = x[0] * x[1] - b;
        }
    }
}

fn between(stream: &mut Stream, low: f64, high: f64) -> f64 {
    low + (high - low) * stream.next()
}

fn pick(stream: &mut Stream, count: u32) -> u32 {
    (0..count)
        .find(|i| stream.next() < 1.0 / f64::from(count - i))
        .unwrap()
}

/// The box of both variables reaches as far to either side of 0, 1.
const HALF_SIDE: f64 = 2.0;

fn problem(stream: &mut Stream) -> (Problem<'static>, bool) {
    let a = [0; 4].map(|_| between(stream, -1.5, 1.5));
    let has_equality = pick(stream, 3) == 0;
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.1, -HALF_SIDE, HALF_SIDE));
    let mut params = ProblemParams::new(&[0.1, 0.2], 4, Exact(Mixed { a, has_equality }))
        .variables(variables)
        .inequalities(["curve".to_owned()])
        .linear([LinearConstraint::at_most("line", vec![1.0, -0.5], 1.5)]);
    if has_equality {
        params = params
            .equalities(["product".to_owned()])
            .linear([LinearConstraint::equal("slant", vec![0.0, 2.0], a[0])]);
    }
    let worlds = [1, 2, 4][pick(stream, 3) as usize];
    let absolute = [0, 1, 2, 4][pick(stream, 4) as usize];
    let absolute = absolute / worlds * worlds;
    (
        Problem::new(params.absolute(absolute).worlds(worlds)).unwrap(),
        has_equality,
    )
}

/// Each method, with weights of which some are 0.
fn method(stream: &mut Stream) -> Method {
    let numbers = |stream: &mut Stream| (0..4).map(|_| between(stream, -1.0, 1.0)).collect();
    let mut weights: Vec<f64> = (0..4)
        .map(|_| between(stream, -0.5, 2.0).max(0.0))
        .collect();
    weights[pick(stream, 4) as usize] = 0.75;
    match pick(stream, 4) {
        0 => Method::Minimax,
        1 => Method::Attain {
            goals: numbers(stream),
            weights,
        },
        2 => Method::Weighted { weights },
        _ => Method::Chebyshev {
            ideal: numbers(stream),
            weights,
        },
    }
}

fn settings() -> CertifySettings {
    let mut settings = CertifySettings::default();
    settings.starts = 0;
    settings
}

/// The certificate of a point, without a look at any box.
fn of_point(problem: &Problem<'_>, method: &Method, x: &[f64], tolerance: f64) -> Certificate {
    let mut settings = settings();
    settings.max_boxes = 0;
    settings.candidates = vec![x.to_vec()];
    settings.solve.constraint_tolerance = tolerance;
    certify(problem, method, &settings).unwrap()
}

#[test]
fn the_certificate_of_a_point_is_its_merit() {
    let mut stream = Stream(2012);
    let (mut known, mut refused, mut outside) = (0, 0, 0);
    for _ in 0..1500 {
        let (problem, _) = problem(&mut stream);
        let method = method(&mut stream);
        let x = [0; 2].map(|_| between(&mut stream, -1.1 * HALF_SIDE, 1.1 * HALF_SIDE));
        let tolerance = [0.0, 0.1, 1.0][pick(&mut stream, 3) as usize];
        let merit = evaluate(&problem, &method, &x).unwrap();
        let c = of_point(&problem, &method, &x, tolerance);
        assert!(c.boxes == 0 && c.status == CertifyStatus::BoxLimit && !c.status.is_proved());
        let is_inside = x.iter().all(|x| x.abs() <= HALF_SIDE);
        if is_inside && merit.violation <= tolerance {
            known += 1;
            let near = |found: f64, expected: f64| {
                assert!(
                    found >= expected - 1e-15 && found <= expected + 1e-12,
                    "{found} {expected} {method:?}"
                );
            };
            assert_eq!(c.x.as_deref(), Some(&x[..]));
            near(c.upper, merit.utility);
            near(c.violation, merit.violation);
        } else {
            refused += usize::from(is_inside);
            outside += usize::from(!is_inside);
            assert!(c.x.is_none() && c.upper == f64::INFINITY && c.violation == 0.0);
            assert_eq!(c.gap(), f64::INFINITY);
        }
    }
    println!("{known} known, {refused} refused, {outside} outside");
    assert!(known > 300 && refused > 300 && outside > 200);
}

/// x − y ≤ 0 where x − y is just the tolerance, a number more, and at the ends of the box.
#[test]
fn a_point_may_be_off_by_the_tolerance() {
    struct Apart;
    impl Functions for Apart {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = x[0] + x[1];
            f[1] = x[0] - x[1];
        }
    }
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.0, -1.0, 1.0));
    let params = ProblemParams::new(&[0.0, 0.0], 1, Exact(Apart))
        .variables(variables)
        .inequalities(["apart".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let at = |x: [f64; 2], tolerance: f64| {
        let c = of_point(&problem, &Method::Minimax, &x, tolerance);
        c.x.map(|_| (c.upper, c.violation))
    };
    assert_eq!(at([0.5, 0.25], 0.25), Some((0.75, 0.25)));
    assert_eq!(at([0.5, 0.25], 0.25_f64.next_down()), None);
    assert_eq!(at([0.5, 0.5], 0.0), Some((1.0, 0.0)));
    assert_eq!(at([1.0, 1.0], 0.0), Some((2.0, 0.0)));
    assert_eq!(at([-1.0, -1.0], 0.0), Some((-2.0, 0.0)));
    assert_eq!(at([-1.0, 1.0_f64.next_up()], 0.0), None);
    assert_eq!(at([(-1.0_f64).next_down(), 0.0], 0.0), None);
}

/// exp(1000 x) at 1 is beyond all numbers: that is no level of a point.
#[test]
fn a_level_that_overflows_is_none() {
    struct Steep;
    impl Functions for Steep {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = (R::from_f64(1000.0) * x[0]).exp();
        }
    }
    let params = ProblemParams::new(&[0.0], 1, Exact(Steep))
        .variables([Variable::bounded("x", 0.0, -1.0, 1.0)]);
    let problem = Problem::new(params).unwrap();
    let at = |x: f64| of_point(&problem, &Method::Minimax, &[x], 0.0).x;
    assert_eq!((at(0.5), at(1.0)), (Some(vec![0.5]), None));
}

#[test]
fn no_feasible_point_lies_below_the_bound_of_any_method() {
    let mut stream = Stream(5);
    let (mut tried, mut proved) = (0, 0);
    for _ in 0..40 {
        let (problem, has_equality) = problem(&mut stream);
        let method = method(&mut stream);
        let mut settings = settings();
        settings.gap = 0.02;
        settings.starts = 2;
        settings.max_boxes = 300;
        let mut last = f64::NEG_INFINITY;
        let mut boxes = 0;
        let watch = &mut |progress: &grouser_opt::CertifyProgress| {
            // closed boxes claim no more than the gap needs, of which open ones may have a little more
            let room = 0.1 * 0.02 * (1.0 + progress.upper.abs());
            assert!(progress.lower >= last - room);
            assert!(progress.boxes >= boxes && progress.open > 0);
            (last, boxes) = (progress.lower, progress.boxes);
            ControlFlow::Continue(())
        };
        let c = certify_with(&problem, &method, &settings, watch, None).unwrap();
        assert!(c.lower >= last - 0.1 * 0.02 * (1.0 + c.upper.abs()) && c.boxes >= boxes);
        proved += usize::from(c.status.is_proved());
        if c.status == CertifyStatus::Proved {
            assert!(c.gap() <= 0.02 * (1.0 + c.upper.abs()));
        }
        assert_eq!(
            c.status == CertifyStatus::Infeasible,
            c.lower == f64::INFINITY
        );
        if let Some(x) = &c.x {
            let merit = evaluate(&problem, &method, x).unwrap();
            assert!((merit.utility - c.upper).abs() < 1e-12 && merit.violation <= 1e-8);
        }
        for _ in 0..if has_equality { 0 } else { 500 } {
            let x = [0; 2].map(|_| between(&mut stream, -HALF_SIDE, HALF_SIDE));
            let merit = evaluate(&problem, &method, &x).unwrap();
            if merit.violation <= 0.0 {
                tried += 1;
                assert!(
                    merit.utility >= c.lower,
                    "{} < {} at {x:?}, {method:?}",
                    merit.utility,
                    c.lower
                );
            }
        }
    }
    println!("{proved} proved, {tried} points");
    assert!(proved > 30 && tried > 2000, "{proved} {tried}");
}

/// x ≤ 0 and −x ≤ 0 are no number and its opposite of which the greater counts: the objective may be negative.
#[test]
fn opposite_limits_are_no_opposite_objectives() {
    struct Pinned;
    impl Functions for Pinned {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = x[1] - R::from_f64(3.0);
            f[1] = x[0];
            f[2] = -x[0];
        }
    }
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.0, -1.0, 1.0));
    let params = ProblemParams::new(&[0.0, 0.0], 1, Exact(Pinned))
        .variables(variables)
        .inequalities(["at most".to_owned(), "at least".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let c = certify(&problem, &Method::Minimax, &CertifySettings::default()).unwrap();
    assert_eq!(c.status, CertifyStatus::Proved);
    assert!((c.upper + 4.0).abs() < 1e-9 && c.lower <= -4.0 && c.gap() <= 5e-6);
}
