//! Random convex problems: each has one optimum, so a solve must converge and prove it.

use grouser_opt::{
    Differences, Exact, Functions, LinearConstraint, Method, Problem, ProblemParams, Settings,
    Status, Variable, solve,
};
use grouser_real::Scalar;
use proptest::prelude::*;

use crate::lagrangian::stationarity;

/// Rows f_i = Σ_k w_ik (x_k − c_ik)² + s_i, the last `constraints` of them meant as ≤ 0.
#[derive(Clone, Debug)]
struct Bowls {
    n: usize,
    weights: Vec<f64>,
    centres: Vec<f64>,
    shifts: Vec<f64>,
}

impl Functions for Bowls {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        for (i, out) in out.iter_mut().enumerate() {
            let mut sum = R::from_f64(self.shifts[i]);
            for (k, &x) in x.iter().enumerate() {
                let at = i * self.n + k;
                sum += R::from_f64(self.weights[at]) * (x - R::from_f64(self.centres[at])).square();
            }
            *out = sum;
        }
    }
}

#[derive(Clone, Debug)]
struct Case {
    bowls: Bowls,
    objectives: usize,
    linear: Vec<(Vec<f64>, f64)>,
    bounded: bool,
    start: Vec<f64>,
}

prop_compose! {
    fn case()(n in 1_usize..7, objectives in 1_usize..9, constraints in 0_usize..4, rows in 0_usize..4)(
        weights in prop::collection::vec(0.1_f64..10.0, n * (objectives + constraints)),
        centres in prop::collection::vec(-3.0_f64..3.0, n * (objectives + constraints)),
        shifts in prop::collection::vec(-5.0_f64..5.0, objectives + constraints),
        linear in prop::collection::vec((prop::collection::vec(-1.0_f64..1.0, n), 0.1_f64..3.0), rows),
        start in prop::collection::vec(-20.0_f64..20.0, n),
        bounded in any::<bool>(),
        n in Just(n), objectives in Just(objectives), constraints in Just(constraints),
    ) -> Case {
        let mut shifts = shifts;
        // The origin meets every constraint with room to spare.
        for j in objectives..objectives + constraints {
            let at_origin: f64 = (0..n).map(|k| weights[j * n + k] * centres[j * n + k].powi(2)).sum();
            shifts[j] = -at_origin - 0.5;
        }
        Case { bowls: Bowls { n, weights, centres, shifts }, objectives, linear, bounded, start }
    }
}

fn problem(case: &Case) -> Problem<'_> {
    let count = case.bowls.shifts.len();
    let reach = if case.bounded { 2.0 } else { f64::INFINITY };
    let params = ProblemParams::new(&case.start, case.objectives, Exact(case.bowls.clone()));
    let variables: Vec<_> = params
        .variables
        .iter()
        .map(|v| Variable::bounded(v.name.clone(), v.start, -reach, reach))
        .collect();
    let rows = case
        .linear
        .iter()
        .enumerate()
        .map(|(l, (coefficients, bound))| {
            LinearConstraint::at_most(format!("row{l}"), coefficients.clone(), *bound)
        });
    let params = params
        .variables(variables)
        .inequalities((case.objectives..count).map(|j| format!("g{j}")))
        .linear(rows);
    Problem::new(params).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn convex_problems_converge_and_prove_it(case in case()) {
        let problem = problem(&case);
        let solution = solve(&problem, &Method::Minimax, &Settings::default()).unwrap();
        prop_assert_eq!(&solution.status, &Status::Converged, "{:?}", solution);
        prop_assert!(solution.kkt.violation <= 1e-8);
        let prices = &solution.multipliers;
        let mut all = prices.objectives.iter().chain(&prices.inequalities).chain(&prices.linear);
        prop_assert!(all.all(|price| *price >= 0.0));
        let (off, _) = stationarity(&problem, &solution);
        prop_assert!(off <= 1e-6 * solution.kkt.gradient_scale.max(1.0), "{}", off);
    }

    /// The optimum of a convex problem does not depend on the start, nor on how derivatives are had.
    #[test]
    fn the_optimum_is_one(case in case()) {
        let exact = problem(&case);
        let one = solve(&exact, &Method::Minimax, &Settings::default()).unwrap();
        let other_start: Vec<f64> = case.start.iter().map(|x| 1.0 - 0.5 * x).collect();
        let moved = exact.from_start(&other_start).unwrap();
        let two = solve(&moved, &Method::Minimax, &Settings::default()).unwrap();
        let size = 1.0 + one.maximum.abs();
        prop_assert!((one.maximum - two.maximum).abs() < 1e-6 * size);
        let closure = |x: &[f64], out: &mut [f64]| case.bowls.evaluate(x, out);
        let differences = Problem::new(ProblemParams::new(&case.start, case.objectives, Differences::new(closure)).variables(exact.variables().to_vec()).inequalities(exact.inequalities().to_vec()).linear(exact.linear().to_vec()))
        .unwrap();
        let three = solve(&differences, &Method::Minimax, &Settings::default()).unwrap();
        prop_assert!(three.status.is_solved(), "{:?}", three.status);
        prop_assert!((one.maximum - three.maximum).abs() < 1e-6 * size);
    }
}
