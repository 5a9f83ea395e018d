//! How a search for a proof begins, goes on and ends.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_opt::{
    Certificate, CertifyProgress, CertifySettings, CertifyStatus, Exact, Functions, Method,
    Problem, ProblemParams, Variable, certify, certify_with,
};
use grouser_real::Scalar;

/// Two valleys, of which the right one is deeper, and how often they were evaluated.
#[derive(Clone, Default)]
struct Valleys(Arc<AtomicUsize>);
impl Functions for Valleys {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        self.0.fetch_add(1, Ordering::Relaxed);
        f[0] = (x[0].square() - R::ONE).square() - R::from_f64(0.1) * x[0];
    }
}

/// The least value in each valley, 1: at the outer roots of 4 x³ − 4 x = 0.1, by bisection.
const LEAST_ON_THE_LEFT: f64 = 0.099_367_6;
const LEAST_ON_THE_RIGHT: f64 = -0.100_616_9;

fn valleys(model: &Valleys) -> Problem<'static> {
    let params = ProblemParams::new(&[-1.0], 1, Exact(model.clone()))
        .variables([Variable::bounded("x", -1.0, -2.0, 2.0)]);
    Problem::new(params).unwrap()
}

fn searched(
    problem: &Problem<'_>,
    settings: &CertifySettings,
    mut watch: impl FnMut(&CertifyProgress) -> ControlFlow<()>,
) -> (Certificate, Vec<String>) {
    let mut log = Vec::new();
    let mut sink = |line: &str| {
        log.push(line.to_owned());
        ControlFlow::Continue(())
    };
    let method = Method::Minimax;
    let c = certify_with(problem, &method, settings, &mut watch, Some(&mut sink)).unwrap();
    (c, log)
}

/// The claimed bounds of the leaves of a log; ∞ for those without a feasible point.
fn claims(log: &[String]) -> Vec<f64> {
    let claim = |line: &String| {
        let text = &line[line.find("\"bound\":")? + 8..];
        match &text[..text.find(',')?] {
            "null" => Some(f64::INFINITY),
            "\"none\"" => Some(f64::NEG_INFINITY),
            number => Some(number.parse().unwrap()),
        }
    };
    log.iter().filter_map(claim).collect()
}

#[test]
fn without_starts_there_are_no_local_solves() {
    let mut settings = CertifySettings::default();
    settings.starts = 0;
    let model = Valleys::default();
    let problem = valleys(&model);
    model.0.store(0, Ordering::Relaxed);
    let (c, log) = searched(&problem, &settings, |_| ControlFlow::Continue(()));
    // once for the formula
    assert_eq!(model.0.load(Ordering::Relaxed), 1);
    assert!(c.status == CertifyStatus::Proved && c.boxes > 10);
    assert!((c.upper - LEAST_ON_THE_RIGHT).abs() < 2e-6 && c.lower <= LEAST_ON_THE_RIGHT);
    let lowest = claims(&log).into_iter().fold(f64::INFINITY, f64::min);
    assert_eq!(c.lower, lowest);
}

/// From the one start the search finds the left valley; the first box's middle leads it to the right one.
#[test]
fn a_local_solve_from_the_first_box_improves_the_best_point() {
    let mut settings = CertifySettings::default();
    settings.starts = 1;
    let mut uppers = Vec::new();
    let problem = valleys(&Valleys::default());
    let (c, log) = searched(&problem, &settings, |progress| {
        uppers.push(progress.upper);
        ControlFlow::Continue(())
    });
    assert_eq!(c.status, CertifyStatus::Proved);
    assert!((uppers[0] - LEAST_ON_THE_LEFT).abs() < 1e-6, "{uppers:?}");
    assert!((uppers[1] - LEAST_ON_THE_RIGHT).abs() < 1e-6, "{uppers:?}");
    // no leaf claims more than the gap needs
    let cap = c.upper - 0.96 * 1e-6 * (1.0 + c.upper.abs());
    let claims = claims(&log);
    assert!(claims.len() > 1 && claims.iter().all(|claim| *claim <= cap));
}

#[test]
fn the_first_of_equal_candidates_is_the_best_point() {
    struct Size;
    impl Functions for Size {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = x[0].abs();
        }
    }
    let params = ProblemParams::new(&[1.0], 1, Exact(Size))
        .variables([Variable::bounded("x", 1.0, -2.0, 2.0)]);
    let problem = Problem::new(params).unwrap();
    let mut settings = CertifySettings::default();
    (settings.starts, settings.max_boxes) = (0, 0);
    settings.candidates = [1.5, -1.0, 1.0].map(|x| vec![x]).into();
    let c = certify(&problem, &Method::Minimax, &settings).unwrap();
    assert_eq!((c.x, c.upper), (Some(vec![-1.0]), 1.0));
}

/// A search that is ended early claims what it has: no more than the optimum, no less than it reported.
#[test]
fn an_ended_search_claims_what_it_has() {
    let problem = valleys(&Valleys::default());
    let settings = |boxes: u64| {
        let mut settings = CertifySettings::default();
        (settings.starts, settings.max_boxes) = (0, boxes);
        settings
    };
    let mut lowest_before = f64::NEG_INFINITY;
    for boxes in [0, 1, 3, 7] {
        let mut last = f64::NEG_INFINITY;
        let (c, log) = searched(&problem, &settings(boxes), |progress| {
            last = progress.lower;
            ControlFlow::Continue(())
        });
        assert_eq!(c.status, CertifyStatus::BoxLimit);
        assert!(
            c.boxes >= boxes && c.lower >= last - 1e-12 && c.lower <= LEAST_ON_THE_RIGHT,
            "{last} {c:?}"
        );
        assert!(last > lowest_before || boxes == 0, "{boxes} {last} {c:?}");
        lowest_before = last;
        // boxes are numbered as they are divided
        let number = |line: &String| {
            let text = &line[line.find("\"into\":[")? + 8..];
            Some(text[..text.find(']')?].to_owned())
        };
        for (at, into) in log.iter().filter_map(number).enumerate() {
            assert_eq!(into, format!("{},{}", 2 * at + 1, 2 * at + 2));
        }
        let lowest = claims(&log).into_iter().fold(f64::INFINITY, f64::min);
        assert_eq!(c.lower, lowest);
    }
    // by the caller, or by one who takes the proof
    let (c, _) = searched(&problem, &settings(1000), |progress| {
        if progress.boxes < 3 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    assert!(c.status == CertifyStatus::Stopped && (3..100).contains(&c.boxes));
    let mut lines = 0;
    let mut sink = |_: &str| {
        lines += 1;
        if lines < 5 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let c = certify_with(
        &problem,
        &Method::Minimax,
        &settings(1000),
        &mut |_| ControlFlow::Continue(()),
        Some(&mut sink),
    )
    .unwrap();
    assert!(c.status == CertifyStatus::Stopped && lines == 5);
}

/// A number and its opposite are above 0, however early the search ends.
#[test]
fn the_size_of_a_number_is_not_negative() {
    struct Wave;
    impl Functions for Wave {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = (x[0] * R::from_f64(3.0)).sin() - x[0].square() + R::from_f64(0.2);
        }
    }
    let params = ProblemParams::new(&[1.0], 1, Exact(Wave))
        .variables([Variable::bounded("x", 1.0, -2.0, 2.0)])
        .absolute(1);
    let problem = Problem::new(params).unwrap();
    let mut settings = CertifySettings::default();
    (settings.starts, settings.max_boxes) = (0, 0);
    let (c, log) = searched(&problem, &settings, |progress| {
        assert!(progress.lower <= 0.0 && progress.lower >= -1e-9);
        ControlFlow::Continue(())
    });
    assert!(c.lower <= 0.0 && c.lower >= -1e-9);
    assert!(log[1].contains("\"weights\":[[0,0.5],[1,0.5]]"), "{log:?}");
    // 0 is reached, and the first box proves it
    settings.starts = 4;
    settings.max_boxes = 100;
    let c = certify(&problem, &Method::Minimax, &settings).unwrap();
    assert!(c.status == CertifyStatus::Proved && c.boxes == 1 && c.upper < 1e-7);
}

/// No number of 53 bits has the square 2: nothing is found, and that is no proof that there is nothing.
#[test]
fn boxes_as_small_as_numbers_are_no_proof() {
    struct Root;
    impl Functions for Root {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = x[0];
            f[1] = x[0].square() - R::from_f64(2.0);
        }
    }
    let problem = |has_limit: bool| {
        let mut params = ProblemParams::new(&[1.5], 1, Exact(Root))
            .variables([Variable::bounded("x", 1.5, 0.5, 3.0)]);
        params = if has_limit {
            params.equalities(["square".to_owned()])
        } else {
            params.inequalities(["square".to_owned()])
        };
        Problem::new(params).unwrap()
    };
    let mut settings = CertifySettings::default();
    settings.solve.constraint_tolerance = 0.0;
    let c = certify(&problem(true), &Method::Minimax, &settings).unwrap();
    let root = std::f64::consts::SQRT_2;
    assert_eq!(c.status, CertifyStatus::Precision);
    assert!(
        c.x.is_none() && c.lower <= root && c.lower > root - 1e-6,
        "{c:?}"
    );
}

/// Forty-eight boxes at a time.
#[test]
fn batches_of_boxes_are_of_one_size() {
    struct Waves;
    impl Functions for Waves {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            let forty = R::from_f64(40.0);
            f[0] = (forty * x[0]).sin() * (forty * x[1]).cos() + (x[0] - x[1].square()).abs();
        }
    }
    let params = ProblemParams::new(&[0.1; 2], 1, Exact(Waves))
        .variables(["x", "y"].map(|name| Variable::bounded(name, 0.1, -2.0, 2.0)));
    let problem = Problem::new(params).unwrap();
    let mut settings = CertifySettings::default();
    (settings.gap, settings.max_boxes, settings.starts) = (0.01, 2000, 0);
    let (mut last, mut sizes) = (0, Vec::new());
    let (c, _) = searched(&problem, &settings, |progress| {
        sizes.push(progress.boxes - last);
        last = progress.boxes;
        ControlFlow::Continue(())
    });
    assert!(c.status.is_proved(), "{c:?}");
    assert_eq!(sizes.into_iter().max(), Some(48));
}
