//! No point that is called a solution is refuted by random probes around it, from random starts of the published
//! problems. `GROUSER_STARTS=600 cargo test --release -p grouser-opt --test all refuted::` makes 10 800 solves.

use crate::literature::suite;
use crate::random_starts::{Stream, starts};

#[allow(dead_code, reason = "shared with the literature's tests")]
use std::collections::BTreeMap;

use grouser_opt::{
    Exact, Functions, LinearConstraint, Measure, Method, Problem, ProblemParams, Settings, Status,
    Variable, World, evaluate, robust, solve,
};
use grouser_real::Scalar;

/// The best of 200 probes of up to 1e-4 (1 + |x|) in each variable; `None` where none lowers the utility by
/// 1e-6 (1 + |utility|).
fn refuted(problem: &Problem<'_>, x: &[f64], stream: &mut Stream) -> Option<f64> {
    let here = evaluate(problem, &Method::Minimax, x).unwrap();
    let allowed = here.violation.max(0.0);
    let best = (0..200)
        .filter_map(|_| {
            let probe: Vec<f64> = x
                .iter()
                .zip(problem.variables())
                .map(|(x, v)| {
                    let step = 1e-4 * (1.0 + x.abs()) * (2.0 * stream.next() - 1.0);
                    (x + step).clamp(v.lower, v.upper)
                })
                .collect();
            let merit = evaluate(problem, &Method::Minimax, &probe).unwrap();
            (merit.violation <= allowed).then_some(merit.utility)
        })
        .fold(f64::INFINITY, f64::min);
    let decrease = here.utility - best;
    (decrease > 1e-6 * (1.0 + here.utility.abs())).then_some(decrease)
}

#[test]
fn no_solution_of_a_published_problem_is_refuted() {
    let mut stream = Stream(7);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut bad = Vec::new();
    for case in suite::all() {
        let problem = Problem::new((case.params)()).unwrap();
        for start in 0..starts(20) {
            let x: Vec<f64> = problem
                .variables()
                .iter()
                .map(|v| (v.start + 5.0 * (2.0 * stream.next() - 1.0)).clamp(v.lower, v.upper))
                .collect();
            let from = problem.from_start(&x).unwrap();
            let solution = solve(&from, &Method::Minimax, &Settings::default()).unwrap();
            *counts.entry(solution.status.name()).or_default() += 1;
            if solution.status.is_solved()
                && let Some(decrease) = refuted(&problem, &solution.x, &mut stream)
            {
                bad.push((case.name, start, solution.utility, decrease));
            }
        }
    }
    println!("{counts:?}; refuted: {bad:?}");
    assert!(bad.is_empty(), "{bad:?}");
}

/// The derivative that a function reports at a kink may be that of the flat side.
struct Step;

impl Functions for Step {
    /// x² + y left of x = 1; flat from there on, with the value and the derivative of the flat side at the kink.
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = if x[0].value() < 1.0 {
            x[0].square()
        } else {
            R::ONE
        } + x[1].square();
    }
}

/// At (1, 0) the reported gradient is 0, and the optimality conditions hold.
#[test]
fn a_flat_side_of_a_kink_is_not_called_a_solution() {
    let problem = Problem::new(
        ProblemParams::new(&[1.0, 0.5], 1, Exact(Step)).variables(vec![
            Variable::bounded("x", 1.0, -2.0, 2.0),
            Variable::bounded("y", 0.5, -2.0, 2.0),
        ]),
    )
    .unwrap();
    let settings = Settings::default();
    let solution = solve(&problem, &Method::Minimax, &settings).unwrap();
    assert!(
        solution.status.is_solved() && solution.utility < 1e-9,
        "{solution:?}"
    );
    let mut blind = settings;
    blind.probes = 0;
    let solution = solve(&problem, &Method::Minimax, &blind).unwrap();
    assert_eq!(solution.status, Status::Converged);
    assert!((solution.utility - 1.0).abs() < 1e-9);
}

/// As [`Step`] for x − y about `0`, with both variables on the line x + y = 2 or in the half-plane above it.
struct Slanted;

impl Functions for Slanted {
    /// −(x − y) where that is above 0 and at most 1, else flat; at the kink with the value and slope of the flat side.
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let apart = x[0] - x[1];
        f[0] = if apart.value() > 0.0 { -apart } else { R::ZERO };
    }
}

/// A probe of one variable leaves a linear constraint; put back onto it, it finds the way down along it.
#[test]
fn probes_go_along_linear_constraints() {
    let equal = || LinearConstraint::equal("line", vec![3.0, 1.0], 4.0);
    let above = || LinearConstraint::at_most("half-plane", vec![-3.0, -1.0], -4.0);
    for row in [equal(), above()] {
        let variables = ["x", "y"].map(|name| Variable::bounded(name, 1.0, 0.5, 1.5));
        let params = ProblemParams::new(&[1.0, 1.0], 1, Exact(Slanted))
            .variables(variables)
            .linear([row]);
        let problem = Problem::new(params).unwrap();
        let mut settings = Settings::default();
        let solution = solve(&problem, &Method::Minimax, &settings).unwrap();
        let merit = evaluate(&problem, &Method::Minimax, &solution.x).unwrap();
        // the line reaches x − y = 2/3 at y = 0.5; above it x − y = 1
        assert!(
            solution.status.is_solved() && merit.violation < 1e-9 && solution.utility < -0.66,
            "{solution:?}"
        );
        settings.probes = 0;
        let blind = solve(&problem, &Method::Minimax, &settings).unwrap();
        assert!(blind.status == Status::Converged && blind.utility == 0.0);
    }
}

/// Starts at which all derivatives vanish although they are no minimum: a maximum, small beside the level too, and two saddles, one
/// of which no variable alone leaves downwards.
struct Flat(usize);

impl Functions for Flat {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let half = R::from_f64(0.5);
        let (x, y) = (x[0] - half, x[1] - half);
        f[0] = match self.0 {
            0 => R::ONE - x.square(),
            1 => R::from_f64(1000.0) - x.square(),
            2 => x.square() - y.square(),
            _ => x * y,
        };
    }
}

/// The same maximum as an objective that counts with its absolute value, and as the worst of three worlds: a weighted sum lifts
/// both by variables of its own.
#[test]
fn a_maximum_is_not_called_a_solution_of_a_weighted_sum() {
    let variables = || ["x", "y"].map(|name| Variable::bounded(name, 0.5, 0.0, 1.0));
    let method = Method::Weighted { weights: vec![2.0] };
    let settings = Settings::default();
    for (case, least) in [(0, 0.75), (1, 999.75)] {
        let params = ProblemParams::new(&[0.5, 0.5], 1, Exact(Flat(case))).variables(variables());
        let problem = Problem::new(params.absolute(1)).unwrap();
        let solution = solve(&problem, &method, &settings).unwrap();
        assert!(
            solution.status.is_solved() && (solution.utility - 2.0 * least).abs() < 2e-6,
            "{case}: {solution:?}"
        );
        assert_eq!(solution.x.len(), 2);
    }
    let worlds = ["one", "two", "three"].map(|name| World::new(name, Exact(Flat(0))));
    let params = ProblemParams::new(&[0.5, 0.5], 1, Exact(Flat(0))).variables(variables());
    let problem = robust(params, worlds.into(), Measure::WorstCase).unwrap();
    let method = Method::Weighted {
        weights: vec![2.0; 3],
    };
    let solution = solve(&problem, &method, &settings).unwrap();
    assert!(
        solution.status.is_solved() && (solution.utility - 1.5).abs() < 2e-6,
        "{solution:?}"
    );
}

#[test]
fn a_maximum_or_a_saddle_is_not_called_a_solution() {
    // the least values on the square: at its sides, at the ends of y, at two corners
    for (case, least) in [(0, 0.75), (1, 999.75), (2, -0.25), (3, -0.25)] {
        let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.5, 0.0, 1.0));
        let params = ProblemParams::new(&[0.5, 0.5], 1, Exact(Flat(case))).variables(variables);
        let problem = Problem::new(params).unwrap();
        let solution = solve(&problem, &Method::Minimax, &Settings::default()).unwrap();
        assert!(
            solution.status.is_solved() && (solution.utility - least).abs() < 1e-6,
            "{case}: {solution:?}"
        );
    }
}
