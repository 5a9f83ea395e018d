//! Random problems whose numbers are small whole ones, so that ties are exact: flat, unbounded, contradictory and degenerate ones
//! among them. What each solution claims is recomputed, and the work that it took is compared with what it was.

use std::fmt::Write as _;

use grouser_opt::{
    Exact, Functions, LinearConstraint, Method, Problem, ProblemParams, Settings, Status, Variable,
    solve,
};
use grouser_real::Scalar;

use crate::lagrangian::stationarity;
use crate::random_starts::Stream;

const PROBLEMS: u64 = 500;
/// By how much sums of a solution's prices and slopes may miss zero, as a share of the slopes.
const STATIONARITY_SHARE: f64 = 1e-6;

/// Σ_k w_k (x_k − c_k)² + a x_first x_last + b Σ_k x_k + s, times a power of ten; some with √x_first, which has no value below zero.
struct Function {
    weights: Vec<f64>,
    centres: Vec<f64>,
    product: f64,
    slope: f64,
    shift: f64,
    scale: f64,
    has_root: bool,
}

struct Drawn {
    functions: Vec<Function>,
}

impl Functions for Function {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let mut sum = R::from_f64(self.shift);
        for (k, &x) in x.iter().enumerate() {
            let off = x - R::from_f64(self.centres[k]);
            sum += R::from_f64(self.weights[k]) * off.square() + R::from_f64(self.slope) * x;
        }
        sum += R::from_f64(self.product) * x[0] * x[x.len() - 1];
        out[0] = R::from_f64(self.scale)
            * if self.has_root {
                sum + x[0].sqrt()
            } else {
                sum
            };
    }
}

impl Functions for Drawn {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        for (function, out) in self.functions.iter().zip(out.chunks_mut(1)) {
            function.evaluate(x, out);
        }
    }
}

fn problem(stream: &mut Stream) -> Problem<'static> {
    let mut whole = |low: f64, high: f64| (low + (high - low + 1.0) * stream.next()).floor();
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small whole numbers that are not negative"
    )]
    let size = |value: f64| value as usize;
    let n = size(whole(1.0, 5.0));
    let objectives = size(whole(1.0, 6.0));
    let inequalities = size(whole(-2.0, 2.0).max(0.0));
    let equalities = size(whole(-4.0, 1.0).max(0.0));
    let functions = (0..objectives + inequalities + equalities).map(|_| {
        let is_flat = whole(0.0, 5.0) == 0.0;
        let least = if whole(0.0, 3.0) == 0.0 { -2.0 } else { 0.0 };
        Function {
            weights: (0..n)
                .map(|_| if is_flat { 0.0 } else { whole(least, 3.0) })
                .collect(),
            centres: (0..n).map(|_| whole(-2.0, 2.0)).collect(),
            product: whole(-6.0, 2.0).max(0.0),
            slope: whole(-1.0, 1.0),
            shift: whole(-3.0, 3.0),
            scale: [1.0, 10.0, 100.0][size(whole(-6.0, 2.0).max(0.0))],
            has_root: whole(0.0, 39.0) == 0.0,
        }
    });
    let mut functions: Vec<_> = functions.collect();
    let variables: Vec<_> = (0..n)
        .map(|k| {
            let start = whole(-4.0, 4.0);
            let (below, above) = (whole(0.0, 3.0), whole(0.0, 3.0));
            match size(whole(0.0, 2.0)) {
                0 => Variable::free(format!("x{k}"), start),
                _ => Variable::bounded(format!("x{k}"), start, start - below, start + above),
            }
        })
        .collect();
    let start: Vec<f64> = variables.iter().map(|variable| variable.start).collect();
    // what the start breaks by 1 at most, or keeps, with or without room
    let rows: Vec<_> = (0..size(whole(-2.0, 4.0).max(0.0)))
        .map(|row| {
            let coefficients: Vec<_> = (0..n).map(|_| whole(-1.0, 1.0)).collect();
            let at_start: f64 = coefficients.iter().zip(&start).map(|(a, x)| a * x).sum();
            let name = format!("row{row}");
            match size(whole(0.0, 5.0)) {
                0 => LinearConstraint::equal(name, coefficients, at_start),
                _ => LinearConstraint::at_most(name, coefficients, at_start + whole(-1.0, 3.0)),
            }
        })
        .collect();
    for function in functions.iter_mut().skip(objectives) {
        let mut value = [0.0];
        function.shift = 0.0;
        function.evaluate(&start, &mut value);
        if value[0].is_finite() {
            function.shift = whole(-4.0, 3.0) - (value[0] / function.scale).floor();
        }
    }
    let absolute = size(whole(-8.0, objectives as f64).max(0.0));
    let params = ProblemParams::new(&start, objectives, Exact(Drawn { functions }))
        .variables(variables)
        .inequalities((0..inequalities).map(|i| format!("g{i}")))
        .equalities((0..equalities).map(|i| format!("h{i}")))
        .linear(rows)
        .absolute(absolute);
    Problem::new(params).expect("a problem")
}

#[test]
fn what_converged_is_stationary_and_takes_as_long_as_it_did() {
    let mut table = String::new();
    for seed in 0..PROBLEMS {
        let problem = problem(&mut Stream(seed));
        let solution = solve(&problem, &Method::Minimax, &Settings::default()).expect("a result");
        let counts = &solution.counts;
        let status = solution.status.name();
        writeln!(
            table,
            "{seed:3} {status}: {} iterations, {} jacobians, {} values, {} probes",
            counts.iterations, counts.jacobians, counts.values, counts.probes
        )
        .unwrap();
        if solution.status != Status::Converged {
            continue;
        }
        assert!(solution.kkt.violation <= 1e-8, "{seed}: {solution:?}");
        // at zero a magnitude has two slopes, whose prices are one number
        let absolute = &solution.objectives[..problem.absolute()];
        if absolute.iter().any(|f| f.abs() < 1e-8) {
            continue;
        }
        let (off, slope) = stationarity(&problem, &solution);
        let at_most = STATIONARITY_SHARE * slope.max(1.0);
        assert!(off <= at_most, "{seed}: {off:e} of {slope:e}: {solution:?}");
        let sum: f64 = solution.multipliers.objectives.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6, "{seed}: {solution:?}");
    }
    insta::assert_snapshot!(table);
}
