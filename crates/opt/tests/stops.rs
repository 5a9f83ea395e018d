//! Callers hear of every solver's progress and may stop it; models say why they fail.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use grouser_opt::{
    Differences, Front, Jacobian, Measure, Method, Model, MultiStart, ParetoSettings, Problem,
    ProblemParams, Progress, Settings, Stage, Status, Variable, World, evaluate, multi_start,
    multi_start_with, pareto, pareto_with, robust, solve, solve_with,
};

/// Two valleys in each of two variables.
fn valleys() -> Problem<'static> {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        f[0] = x
            .iter()
            .map(|x| (x * x - 1.0).powi(2) + 0.1 * x)
            .sum::<f64>();
    });
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.9, -2.0, 2.0));
    Problem::new(ProblemParams::new(&[0.9, 0.9], 1, model).variables(variables)).unwrap()
}

/// Does the model below take its time?
static SLOW: AtomicBool = AtomicBool::new(false);

/// Two objectives whose front is √f_1 + √f_2 = 2.
fn two_ends() -> Problem<'static> {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        if SLOW.load(Ordering::Relaxed) {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        f[0] = x[0] * x[0] + x[1] * x[1];
        f[1] = (x[0] - 2.0).powi(2) + x[1] * x[1];
    });
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 1.0, -1.0, 3.0));
    Problem::new(ProblemParams::new(&[1.0, 1.0], 2, model).variables(variables)).unwrap()
}

fn many(goes_on: impl FnMut(&Progress<'_>) -> bool) -> MultiStart {
    let mut goes_on = goes_on;
    let callback = &mut |progress: &Progress<'_>| {
        if goes_on(progress) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let (method, settings) = (Method::Minimax, Settings::default());
    multi_start_with(&valleys(), &method, &settings, (40, 3), callback).unwrap()
}

#[test]
fn a_watched_search_from_many_starts_finds_the_same() {
    let plain = multi_start(&valleys(), &Method::Minimax, &Settings::default(), 40, 3).unwrap();
    assert!(!plain.stopped && plain.optima.len() == 4);
    let (mut heard, mut last) = (0, 0);
    let watched = many(|progress| {
        let Stage::Starts { done, of } = progress.stage else {
            panic!("{progress:?}");
        };
        assert!(done >= last && of == 40 && progress.x.len() == 2);
        (heard, last) = (heard + 1, done);
        true
    });
    assert_eq!(watched, plain);
    assert!(
        heard >= plain.counts.iterations,
        "{heard} {:?}",
        plain.counts
    );
    // on a pool of one thread, which must do the work and listen
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    assert_eq!(pool.install(|| many(|_| true)), plain);
}

#[test]
fn a_stopped_search_has_the_best_so_far() {
    let mut heard = 0;
    let mut least = f64::INFINITY;
    let found = many(|progress| {
        heard += 1;
        least = least.min(progress.utility);
        heard < 30
    });
    assert!(found.stopped && heard == 30);
    assert!(!found.runs.is_empty() && found.runs.len() == found.starts.len());
    assert!(found.best().utility <= least, "{least} {:?}", found.best());
    // a first iteration that is stopped leaves its start
    let at_once = many(|_| false);
    assert!(at_once.stopped && at_once.best().utility.is_finite());
}

/// A thousand worlds, of which each counts when it is evaluated: the callback that stops is the last one, and of the worlds few are
/// evaluated after it.
#[test]
fn a_search_over_many_worlds_is_stopped_within_an_evaluation() {
    const WORLDS: usize = 1000;
    for measure in [
        Measure::WorstCase,
        Measure::MeanPlusDeviations { kappa: 1.0 },
        Measure::ConditionalValueAtRisk { alpha: 0.9 },
    ] {
        for last in [1, 2, 40, 400] {
            let evaluated = AtomicUsize::new(0);
            let world = |k: usize| {
                let evaluated = &evaluated;
                let model = Differences::new(move |x: &[f64], f: &mut [f64]| {
                    evaluated.fetch_add(1, Ordering::Relaxed);
                    f[0] = (x[0] - k as f64 / WORLDS as f64).powi(4);
                });
                World::new(k.to_string(), model)
            };
            let params =
                ProblemParams::new(&[3.0], 1, Differences::new(|_: &[f64], _: &mut [f64]| {}));
            let joint = robust(params, (0..WORLDS).map(world).collect(), measure).unwrap();
            let (mut calls, mut before, mut utility) = (0, 0, f64::NAN);
            let mut stop = |progress: &Progress<'_>| {
                calls += 1;
                before = evaluated.load(Ordering::Relaxed);
                utility = progress.utility;
                if calls == last {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            };
            let solution =
                solve_with(&joint, &Method::Minimax, &Settings::default(), &mut stop).unwrap();
            let after = evaluated.load(Ordering::Relaxed) - before;
            assert_eq!(
                (solution.status, calls),
                (Status::Stopped, last),
                "{measure:?}"
            );
            // a world of differences takes two or three values
            assert!(after <= 3 * 64, "{measure:?} {last}: {after}");
            if utility.is_finite() {
                let found = solution.utility;
                assert!(found <= utility, "{found}, and {utility} was reached");
            }
        }
    }
}

fn front(settings: &ParetoSettings, goes_on: impl FnMut(&Progress<'_>) -> bool) -> Front {
    let mut goes_on = goes_on;
    let callback = &mut |progress: &Progress<'_>| {
        if goes_on(progress) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    pareto_with(&two_ends(), settings, callback).unwrap()
}

#[test]
fn a_stopped_front_is_that_of_its_last_generation() {
    let mut settings = ParetoSettings::default();
    (settings.population, settings.generations) = (20, 12);
    let whole = pareto(&two_ends(), &settings).unwrap();
    let mut stages = [0, 0];
    let watched = front(&settings, |progress| {
        match progress.stage {
            Stage::Generations { done, of } => {
                stages[0] += 1;
                assert!(done == stages[0] && of == 12 && progress.stationarity.is_none());
            }
            Stage::Polishing { .. } => stages[1] += 1,
            other => panic!("{other:?}"),
        }
        true
    });
    assert_eq!(watched, whole);
    assert!(stages[0] == 12 && stages[1] > 20, "{stages:?}");

    let third =
        |progress: &Progress<'_>| !matches!(progress.stage, Stage::Generations { done: 3, .. });
    let stopped = front(&settings, third);
    let (mut short, mut unpolished) = (settings.clone(), stopped.clone());
    (short.generations, short.polish) = (3, false);
    assert!(stopped.stopped && stopped.counts.iterations == 3);
    unpolished.stopped = false;
    assert_eq!(unpolished, pareto(&two_ends(), &short).unwrap());

    // stopped while points are made exact, which takes a while: those that are not stay as the search left them
    let half = front(&settings, |progress| match progress.stage {
        Stage::Polishing { done, .. } => {
            SLOW.store(true, Ordering::Relaxed);
            done < 3
        }
        _ => true,
    });
    SLOW.store(false, Ordering::Relaxed);
    let exact = half.points.iter().filter(|p| p.multipliers.is_some());
    let exact = exact.count();
    assert!(
        half.stopped && exact < 20,
        "{exact} of {}",
        half.points.len()
    );
}

/// √x, which says why it has no value.
struct Root;

impl Model for Root {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        values[0] = x[0].sqrt();
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        jacobian.set(0, 0, 0.5 / x[0].sqrt());
    }
    fn failure(&self, x: &[f64]) -> Option<String> {
        (x[0] < 0.0).then(|| format!("the root of {} is not real", x[0]))
    }
}

#[test]
fn a_model_says_why_it_fails() {
    for method in [Method::Minimax, Method::Weighted { weights: vec![1.0] }] {
        let problem = Problem::new(ProblemParams::new(&[-4.0], 1, Root)).unwrap();
        let found = solve(&problem, &method, &Settings::default()).unwrap();
        let Status::NotFinite { reason, .. } = &found.status else {
            panic!("{:?}", found.status);
        };
        assert_eq!(reason.as_deref(), Some("the root of -4 is not real"));
    }
}

/// Each point that a callback hears of has the level and the violation that go with it; the last one is the solution.
#[test]
fn the_points_of_a_solve_are_reported() {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        f[0] = (x[0] - 2.0).powi(4) + x[1].powi(2);
        f[1] = 1.0 - x[0] * x[1];
    });
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.5, -3.0, 3.0));
    let params = ProblemParams::new(&[0.5, 0.5], 1, model)
        .variables(variables)
        .inequalities(["hyperbola".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let mut heard: Vec<(usize, Vec<f64>, Option<f64>)> = Vec::new();
    let found = solve_with(
        &problem,
        &Method::Minimax,
        &Settings::default(),
        &mut |progress| {
            assert_eq!(progress.stage, Stage::Solve);
            let merit = evaluate(&problem, &Method::Minimax, progress.x).unwrap();
            assert_eq!(progress.utility, merit.utility);
            assert_eq!(progress.violation, merit.violation);
            heard.push((
                progress.iteration,
                progress.x.to_vec(),
                progress.stationarity,
            ));
            ControlFlow::Continue(())
        },
    )
    .unwrap();
    assert!(found.status.is_solved() && found.counts.iterations > 5);
    let (first, last) = (&heard[0], heard.last().unwrap());
    assert_eq!((first.0, &first.1[..]), (0, &[0.5, 0.5][..]));
    assert!(first.2.is_some_and(|stationarity| stationarity > 0.1));
    assert_eq!(last.1, found.x);
    assert_eq!(last.2, Some(found.kkt.stationarity));
    assert!(heard.is_sorted_by_key(|(iteration, ..)| *iteration));
    let mut points: Vec<&Vec<f64>> = heard.iter().map(|(_, x, _)| x).collect();
    points.dedup();
    assert!(points.len() > 5, "{points:?}");
}

/// Of 128 worlds values and derivatives call twice each, and the iteration that is not allowed calls once; again at the best point that
/// the derivatives needed.
#[test]
fn many_worlds_call_once_in_sixty_four() {
    let world = |k: usize| {
        let model = Differences::new(move |x: &[f64], f: &mut [f64]| f[0] = x[0] + k as f64);
        World::new(k.to_string(), model)
    };
    let params = ProblemParams::new(&[3.0], 1, Differences::new(|_: &[f64], _: &mut [f64]| {}));
    let joint = robust(params, (0..128).map(world).collect(), Measure::WorstCase).unwrap();
    let mut settings = Settings::default();
    settings.max_iterations = 0;
    let mut calls = 0;
    let mut count = |_: &Progress<'_>| {
        calls += 1;
        ControlFlow::Continue(())
    };
    solve_with(&joint, &Method::Minimax, &settings, &mut count).unwrap();
    assert_eq!(calls, 2 * (2 + 2 + 1));
}
