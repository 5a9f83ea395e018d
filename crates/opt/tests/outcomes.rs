//! Every way a solve can end, each on a problem whose answer is known in closed form.

use std::ops::ControlFlow;

use grouser_opt::{
    Differences, Error, Exact, Functions, Limit, LinearConstraint, Method, Problem, ProblemParams,
    Settings, Solution, Status, Variable, solve, solve_with,
};
use grouser_real::Scalar;

/// Objective x² + y²; inequality 1 − x ≤ 0; equality x + 2y = 3.
struct Disc;
impl Functions for Disc {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        out[0] = x[0].square() + x[1].square();
        if let Some(slot) = out.get_mut(1) {
            *slot = R::ONE - x[0];
        }
        if let Some(slot) = out.get_mut(2) {
            *slot = x[0] + x[1] + x[1] - R::from_f64(3.0);
        }
    }
}

fn disc(inequalities: usize, equalities: usize) -> ProblemParams<'static> {
    ProblemParams::new(&[4.0, -3.0], 1, Exact(Disc))
        .inequalities((0..inequalities).map(|_| "reach".to_owned()))
        .equalities((0..equalities).map(|_| "line".to_owned()))
}

fn minimax(params: ProblemParams<'_>) -> Solution {
    let problem = Problem::new(params).unwrap();
    solve(&problem, &Method::Minimax, &Settings::default()).unwrap()
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-7, "{a} instead of {b}");
}

#[test]
fn inequality_and_its_price() {
    let solution = minimax(disc(1, 0));
    assert_eq!(solution.status, Status::Converged);
    near(solution.x[0], 1.0);
    near(solution.x[1], 0.0);
    // d(x²)/dx = 2 at x = 1.
    near(solution.multipliers.inequalities[0], 2.0);
    assert_eq!(solution.active, ["f1", "reach"]);
}

#[test]
fn equality_and_its_price() {
    // Nearest point of x + 2y = 3 to the origin: (0.6, 1.2), but x ≥ 1 moves it to (1, 1).
    let solution = minimax(disc(1, 1));
    assert_eq!(solution.status, Status::Converged);
    near(solution.x[0], 1.0);
    near(solution.x[1], 1.0);
    // ∇f + ν (1, 2) + μ (−1, 0) = 0: ν = −1, μ = 1.
    near(solution.multipliers.equalities[0], -1.0);
    near(solution.multipliers.inequalities[0], 1.0);
}

#[test]
fn linear_constraints_and_bounds_hold_from_the_first_iterate_on() {
    let params = disc(0, 0)
        .variables(vec![
            Variable::bounded("x", 9.0, 0.0, 2.0),
            Variable::free("y", 9.0),
        ])
        .linear(vec![LinearConstraint::at_most(
            "sum",
            vec![-1.0, -1.0],
            -3.0,
        )]);
    let problem = Problem::new(params).unwrap();
    let mut seen = 0;
    let solution = solve_with(
        &problem,
        &Method::Minimax,
        &Settings::default(),
        &mut |progress| {
            seen += 1;
            assert!(progress.x[0] + progress.x[1] >= 3.0 - 1e-9);
            assert!((0.0..=2.0).contains(&progress.x[0]));
            ControlFlow::Continue(())
        },
    )
    .unwrap();
    assert!(seen > 1);
    near(solution.x[0], 1.5);
    near(solution.x[1], 1.5);
    near(solution.multipliers.linear[0], 3.0);
}

#[test]
fn contradicting_linear_constraints_are_named() {
    let row =
        |name: &str, sign: f64, bound: f64| LinearConstraint::at_most(name, vec![sign, 0.0], bound);
    let solution = minimax(disc(0, 0).linear(vec![
        row("low enough", 1.0, 1.0),
        row("high enough", -1.0, -2.0),
        row("easy", 1.0, 50.0),
    ]));
    let Status::NoFeasiblePoint(violations) = &solution.status else {
        panic!("{:?}", solution.status)
    };
    // Anywhere between 1 and 2 the two are off by 1 together.
    let sum: f64 = violations.iter().map(|v| v.amount).sum();
    near(sum, 1.0);
    assert!(violations.iter().all(|v| v.name != "easy"));
    assert!((1.0 - 1e-9..=2.0 + 1e-9).contains(&solution.x[0]));
}

/// Inside the unit circle around the origin and beyond x = 3: the least sum of violations
/// x² + y² − 1 + 3 − x lies at x = 1/2.
struct Apart;
impl Functions for Apart {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        out[0] = x[1];
        out[1] = x[0].square() + x[1].square() - R::ONE;
        out[2] = R::from_f64(3.0) - x[0];
    }
}

#[test]
fn least_infeasible_point_where_nothing_is_feasible() {
    let solution = minimax(
        ProblemParams::new(&[5.0, 5.0], 1, Exact(Apart))
            .inequalities(vec!["circle".to_owned(), "beyond".to_owned()]),
    );
    let Status::NoFeasiblePoint(violations) = &solution.status else {
        panic!("{:?}", solution.status)
    };
    let total: f64 = violations.iter().map(|v| v.amount).sum();
    // The circle is met at x = 1 with 2 missing; every point between gives no less than that.
    assert!(
        (total - 2.0).abs() < 1e-6,
        "{violations:?} at {:?}",
        solution.x
    );
    assert_eq!(violations.len(), 1);
    assert_eq!(violations[0].name, "beyond");
}

#[test]
fn a_stop_is_obeyed_at_once() {
    let problem = Problem::new(disc(0, 0)).unwrap();
    let stop = &mut |_: &grouser_opt::Progress<'_>| ControlFlow::Break(());
    let solution = solve_with(&problem, &Method::Minimax, &Settings::default(), stop).unwrap();
    assert_eq!(solution.status, Status::Stopped);
    assert_eq!(solution.counts.values, 1);
}

/// Objectives x_i² + x_i, one of each variable: all rows of a subproblem hold at its solution.
struct Many;
impl Functions for Many {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        for (out, x) in out.iter_mut().zip(x) {
            *out = x.square() + *x;
        }
    }
}

/// The first subproblem of 400 rows takes many rounds. A caller that stops it is not made to wait for its end.
#[test]
fn a_stop_is_obeyed_within_a_large_subproblem() {
    let problem = Problem::new(ProblemParams::new(&[1.0; 400], 400, Exact(Many))).unwrap();
    let mut within = 0;
    let stop = &mut |progress: &grouser_opt::Progress<'_>| {
        within += usize::from(progress.stationarity.is_none());
        ControlFlow::Break(())
    };
    let solution = solve_with(&problem, &Method::Minimax, &Settings::default(), stop).unwrap();
    assert_eq!(solution.status, Status::Stopped);
    assert_eq!((within, solution.counts.values), (1, 1));
}

/// At a solution only the probes around it are left, which may take long.
#[test]
fn a_stop_is_obeyed_between_probes() {
    let problem =
        Problem::new(disc(0, 0).variables([Variable::free("x", 0.0), Variable::free("y", 0.0)]))
            .unwrap();
    let mut heard = 0;
    let stop = &mut |_: &grouser_opt::Progress<'_>| {
        heard += 1;
        if heard == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let solution = solve_with(&problem, &Method::Minimax, &Settings::default(), stop).unwrap();
    assert_eq!((solution.status, heard), (Status::Stopped, 3));
    assert!(solution.counts.probes < 5, "{:?}", solution.counts);
}

#[test]
fn limits_are_kept() {
    let problem = Problem::new(disc(0, 0)).unwrap();
    let limit = |max_iterations, max_values| {
        let mut settings = Settings::default();
        settings.max_iterations = max_iterations;
        settings.max_values = max_values;
        settings
    };
    let one = solve(&problem, &Method::Minimax, &limit(0, 100)).unwrap();
    assert_eq!(one.status, Status::Limit(Limit::Iterations));
    let two = solve(&problem, &Method::Minimax, &limit(100, 1)).unwrap();
    assert_eq!(two.status, Status::Limit(Limit::Values));
}

#[test]
fn a_function_without_a_value_at_the_start_is_named() {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        f[0] = x[0];
        f[1] = x[0].ln();
    });
    let solution = minimax(ProblemParams::new(&[-1.0], 2, model));
    let function = "f2".to_owned();
    assert_eq!(
        solution.status,
        Status::NotFinite {
            function,
            reason: None,
        }
    );
}

#[test]
fn a_search_steps_around_points_without_values() {
    // √(x − 1) has no value left of 1, where the first steps from 30 would go.
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        f[0] = (x[0] - 1.0).sqrt() + 4.0 / x[0];
    });
    let solution = minimax(ProblemParams::new(&[30.0], 1, model));
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    // The slope f′ = 1/(2 √(x − 1)) − 4/x² must vanish there.
    let slope = 0.5 / (solution.x[0] - 1.0).sqrt() - 4.0 / solution.x[0].powi(2);
    assert!(slope.abs() < 1e-6, "{slope} at {:?}", solution.x);
}

#[test]
fn a_fall_without_limit_is_said() {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = -x[0].powi(3));
    let solution = minimax(ProblemParams::new(&[1.0], 1, model));
    assert_eq!(solution.status, Status::Unbounded);
}

#[test]
fn bad_problems_are_errors_with_names() {
    let build = |change: fn(&mut ProblemParams<'static>)| {
        let mut params = disc(1, 0);
        change(&mut params);
        Problem::new(params).err().unwrap()
    };
    assert_eq!(
        build(|p| p.variables.clear()),
        Error::Empty { what: "variables" }
    );
    assert_eq!(
        build(|p| p.objectives.clear()),
        Error::Empty { what: "objectives" }
    );
    assert!(matches!(
        build(|p| p.variables[1].start = f64::NAN),
        Error::NotFinite { field: "start", name, .. } if name == "x2"
    ));
    assert!(matches!(
        build(|p| p.variables[0].lower = f64::NAN),
        Error::NotFinite { field: "lower", .. }
    ));
    assert!(matches!(
        build(|p| (p.variables[0].lower, p.variables[0].upper) = (2.0, 1.0)),
        Error::InconsistentBounds { name, .. } if name == "x1"
    ));
    assert!(matches!(
        build(|p| p.inequalities[0] = "f1".to_owned()),
        Error::DuplicateName { name } if name == "f1"
    ));
    assert!(matches!(
        build(|p| p.absolute = 2),
        Error::TooLarge {
            given: 2,
            limit: 1,
            ..
        }
    ));
    let problem = Problem::new(disc(0, 0)).unwrap();
    let weights = Method::Weighted {
        weights: vec![f64::NAN],
    };
    assert!(solve(&problem, &weights, &Settings::default()).is_err());
    let mut settings = Settings::default();
    settings.optimality_tolerance = f64::NAN;
    assert!(solve(&problem, &Method::Minimax, &settings).is_err());
}

#[test]
fn an_objective_that_is_nan_everywhere_is_not_finite() {
    let model = Differences::new(|_: &[f64], f: &mut [f64]| f[0] = f64::NAN);
    let solution = minimax(ProblemParams::new(&[1.0], 1, model));
    assert!(matches!(solution.status, Status::NotFinite { .. }));
    assert!(solution.maximum.is_nan());
}

#[test]
fn a_fixed_variable_stays() {
    let mut params = disc(0, 0);
    (params.variables[0].lower, params.variables[0].upper) = (2.0, 2.0);
    let solution = minimax(params);
    assert_eq!(solution.status, Status::Converged);
    assert_eq!(solution.x[0], 2.0);
    near(solution.x[1], 0.0);
    near(
        solution.multipliers.lower[0] - solution.multipliers.upper[0],
        4.0,
    );
}
