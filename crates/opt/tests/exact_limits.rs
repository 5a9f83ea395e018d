//! Limits and tolerances that numbers meet exactly, most of them on models whose derivatives belong to another function than
//! their values, so that each step and each refusal can be foreseen by hand.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_opt::{
    Exact, Functions, Jacobian, Limit, LinearConstraint, Method, Model, Problem, ProblemParams,
    Settings, Solution, Status, Variable, solve, solve_with,
};
use grouser_real::Scalar;

/// Values and slopes of functions of one variable.
struct Formula<const M: usize> {
    values: fn(f64) -> [f64; M],
    slopes: fn(f64) -> [f64; M],
}

impl<const M: usize> Model for Formula<M> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        values.copy_from_slice(&(self.values)(x[0]));
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        for (row, slope) in (self.slopes)(x[0]).into_iter().enumerate() {
            jacobian.set(row, 0, slope);
        }
    }
}

/// Settings without probes.
fn settings(change: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = Settings::default();
    settings.probes = 0;
    change(&mut settings);
    settings
}

/// The least of the first function where the others, if any, are at most zero.
fn least<const M: usize>(
    variable: Variable,
    settings: &Settings,
    values: fn(f64) -> [f64; M],
    slopes: fn(f64) -> [f64; M],
) -> Solution {
    let params = ProblemParams::new(&[variable.start], 1, Formula { values, slopes })
        .variables([variable])
        .inequalities((1..M).map(|row| format!("g{row}")));
    solve(&Problem::new(params).unwrap(), &Method::Minimax, settings).unwrap()
}

/// A constant over variables that rows hold at most at their limits, from a start; with or without iterations.
fn constant(start: &[f64], limits: &[f64], settings: &Settings) -> Solution {
    struct Constant;
    impl Functions for Constant {
        fn evaluate<R: Scalar>(&self, _: &[R], f: &mut [R]) {
            f.fill(R::ONE);
        }
    }
    let rows = limits.iter().enumerate().map(|(k, limit)| {
        let coefficients = (0..start.len()).map(|i| f64::from(u8::from(i == k)));
        LinearConstraint::at_most(format!("row{k}"), coefficients.collect(), *limit)
    });
    let params = ProblemParams::new(start, 1, Exact(Constant)).linear(rows);
    solve(&Problem::new(params).unwrap(), &Method::Minimax, settings).unwrap()
}

/// 2⁻³⁰: a last place that all starts below have, so that sums of them are exact.
const UNIT_OF_STARTS: f64 = 1.0 / (1u64 << 30) as f64;

/// What misses a row by a thousandth of its tolerance is left where it is. The passes over the rows pay 10³, 10⁶, 10⁹ and 10¹²
/// for a unit of violation, and each moves a start by as much.
#[test]
fn a_start_is_moved_onto_rows_that_it_breaks() {
    let of = |tolerance: f64, start: &[f64], limit: f64| {
        let settings = settings(|settings| {
            settings.constraint_tolerance = tolerance;
            settings.max_iterations = 0;
        });
        constant(start, &vec![limit; start.len()], &settings)
    };
    let moved = |tolerance, start, limit| {
        let found = of(tolerance, &[start], limit);
        assert!(!matches!(found.status, Status::NoFeasiblePoint(_)));
        found.x[0]
    };
    assert_eq!(
        moved(1e3 * UNIT_OF_STARTS, UNIT_OF_STARTS, 0.0),
        UNIT_OF_STARTS
    );
    assert_eq!(moved(1e3 * UNIT_OF_STARTS, 2.0 * UNIT_OF_STARTS, 0.0), 0.0);
    // of a row's tolerance its limit is the unit
    assert_eq!(
        moved(1e3 * UNIT_OF_STARTS, 4.0 + 3.0 * UNIT_OF_STARTS, 4.0),
        4.0 + 3.0 * UNIT_OF_STARTS
    );
    assert_eq!(
        moved(1e3 * UNIT_OF_STARTS, 4.0 + 5.0 * UNIT_OF_STARTS, 4.0),
        4.0
    );
    // the first pass
    assert_eq!(
        moved(1e3 * UNIT_OF_STARTS, 1e3 + UNIT_OF_STARTS, 0.0),
        UNIT_OF_STARTS
    );
    assert_eq!(
        moved(1e3 * UNIT_OF_STARTS, 1e3 + 2.0 * UNIT_OF_STARTS, 0.0),
        0.0
    );
    // all passes, and what they leave is the tolerance
    let (passes, left) = (1_001_001_001_000.0, 1.0 / 1024.0);
    assert_eq!(moved(left, passes + left, 0.0), left);
    let violated = of(left, &[passes + left, passes + 2.0 * left], 0.0);
    let Status::NoFeasiblePoint(violations) = &violated.status else {
        panic!("{:?}", violated.status);
    };
    assert_eq!(violated.x, [left, 2.0 * left]);
    assert_eq!(violations.len(), 1);
    assert_eq!(
        (&violations[0].name[..], violations[0].amount),
        ("row1", 2.0 * left)
    );
}

/// A start that is a solution but for a row that it breaks by up to a thousandth of its tolerance, 2¹² times that of others.
#[test]
fn a_solution_breaks_no_row_by_more_than_the_tolerance() {
    let (tolerance, limit) = (1.0 / (1u64 << 18) as f64, 4096.0);
    let settings = settings(|settings| {
        settings.constraint_tolerance = tolerance;
        settings.optimality_tolerance = 1e-3;
    });
    let of = |off: f64| constant(&[limit + off], &[limit], &settings).status;
    assert_eq!(of(tolerance), Status::Converged);
    assert_eq!(of(2.0 * tolerance), Status::Stalled);
}

#[test]
fn tolerances_may_be_zero() {
    let exact = settings(|settings| {
        settings.constraint_tolerance = 0.0;
        settings.optimality_tolerance = 0.0;
    });
    assert_eq!(constant(&[3.0], &[], &exact).status, Status::Converged);
    // −2 + x + 1.05 x² ≤ 0: at the price 10 the full step from 0 to 1 is worth 0.05 of violation, at a greater one it is not
    let once = settings(|settings| {
        settings.constraint_tolerance = 0.0;
        settings.max_iterations = 1;
    });
    let curved = |x: f64| [-x, -2.0 + x + 1.05 * x * x];
    let found = least(Variable::free("x", 0.0), &once, curved, |x| {
        [-1.0, 1.0 + 2.1 * x]
    });
    // the step breaks the row: the start is the best feasible point
    assert_eq!((found.x[0], found.counts.values), (0.0, 3));
}

/// |x| but for points around 0, which are worse than any: the slope given at 0 is a ten-thousandth, and no step is found.
#[test]
fn the_last_point_is_a_solution_to_a_ten_thousandth() {
    fn values(x: f64) -> [f64; 1] {
        [if x == 0.0 || x == 1.0 { x } else { 9.0 }]
    }
    let variable = || Variable::free("x", 1.0);
    let near = |x: f64| [if x == 0.0 { 1e-4 } else { 1.0 }];
    let far = |x: f64| [if x == 0.0 { 1.01e-4 } else { 1.0 }];
    let near = least(variable(), &settings(|_| ()), values, near);
    assert_eq!((near.status, near.x[0]), (Status::SmallStep, 0.0));
    let far = least(variable(), &settings(|_| ()), values, far);
    assert_eq!((far.status, far.x[0]), (Status::Stalled, 0.0));
    // a step of half of 1 + |x|, where that is what a step may not fall below
    let coarse = settings(|settings| settings.step_tolerance = 0.5);
    let found = least(variable(), &coarse, |x| [0.5 * x * x], |x| [x]);
    assert_eq!(
        (found.status, found.counts.iterations),
        (Status::Stalled, 1)
    );
}

/// The slope promises the whole step, 0.001 up to the bound, where the function falls by half of a ten-thousandth of that.
#[test]
fn a_step_must_deliver_a_ten_thousandth_of_what_it_promises() {
    let of = |values: fn(f64) -> [f64; 1]| {
        let variable = Variable::bounded("x", 0.0, 0.0, 0.001);
        let found = least(variable, &settings(|_| ()), values, |_| [-1.0]);
        found.x[0]
    };
    assert_eq!(of(|x| [-0.5e-4 * x]), 0.0);
    assert_eq!(of(|x| [-2e-4 * x]), 0.001);
    assert_eq!(
        of(|x| [if x == 0.001 { -(1e-4 * 0.001) } else { 0.0 }]),
        0.001
    );
}

/// Beside a million a promise of 1e-10 squared over the least curvature is rounding: four such steps are taken, the fifth is not,
/// nor the next one without what was learned.
#[test]
fn four_steps_may_promise_nothing() {
    let found = least(
        Variable::free("x", 0.0),
        &settings(|_| ()),
        |_| [1e6],
        |_| [1e-10],
    );
    assert_eq!(found.status, Status::Stalled);
    assert_eq!((found.counts.iterations, found.counts.values), (6, 5));
}

/// No fraction of the first step helps: a search ends where the values do.
#[test]
fn a_search_along_a_step_keeps_the_limit_of_values() {
    let few = settings(|settings| settings.max_values = 5);
    let found = least(Variable::free("x", 0.0), &few, |_| [0.0], |_| [1.0]);
    assert_eq!(
        (found.status, found.counts.values),
        (Status::Limit(Limit::Values), 5)
    );
}

/// −K x for x ≤ 0 within ±1: an objective that pays K for a unit of violation leads away from what is feasible until the price
/// is K. It rises a hundredfold at each return from there, and ten-thousandfold in a subproblem; after three returns the best feasible
/// point is the answer.
#[test]
fn a_price_rises_a_hundredfold_at_each_return() {
    let variable = || Variable::bounded("x", 0.5, -1.0, 1.0);
    let found = least(
        variable(),
        &settings(|_| ()),
        |x| [-5e6 * x, x],
        |_| [-5e6, 1.0],
    );
    assert_eq!((found.status, found.x[0]), (Status::Converged, 0.0));
    let found = least(
        variable(),
        &settings(|_| ()),
        |x| [-1e14 * x, x],
        |_| [-1e14, 1.0],
    );
    assert_eq!((found.status, found.x[0]), (Status::Stalled, 0.0));
}

/// The first curvature is the slope of the row, over a weight of 4: of 2 x it makes a step of 1. Where no objective has a slope
/// it is 1, and a step costs its square.
#[test]
fn the_first_curvature_is_that_of_the_slope() {
    let formula = Formula {
        values: |x| [2.0 * x],
        slopes: |_| [2.0],
    };
    let method = Method::Attain {
        goals: vec![0.0],
        weights: vec![4.0],
    };
    let once = settings(|settings| settings.max_iterations = 1);
    let problem = Problem::new(ProblemParams::new(&[0.0], 1, formula)).unwrap();
    let found = solve(&problem, &method, &once).unwrap();
    assert!((found.x[0] + 1.0).abs() < 1e-12);
    let found = least(
        Variable::free("x", 0.0),
        &once,
        |x| [0.0, 1e6 - x],
        |_| [0.0, -1.0],
    );
    assert_eq!(found.x, [10.0]);
}

/// A constant but for the first probe: its value is the best, and a search from there does not find it again.
#[test]
fn a_value_that_does_not_repeat_makes_no_solution() {
    // after the start, and its derivatives, for the search and for the probes
    const FIRST_PROBE: usize = 3;
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let values = |_| {
        let is_probe = CALLS.fetch_add(1, Ordering::Relaxed) == FIRST_PROBE;
        [if is_probe { 0.5 } else { 1.0 }]
    };
    let found = least(
        Variable::free("x", 0.0),
        &Settings::default(),
        values,
        |_| [0.0],
    );
    assert_eq!((found.status, found.utility), (Status::Stalled, 0.5));
}

/// A model that calls back before its derivatives.
struct Calling;

impl Model for Calling {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        values[0] = x.iter().map(|x| x * x).sum();
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        (0..x.len()).for_each(|k| jacobian.set(0, k, 2.0 * x[k]));
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn grouser_opt::Watch,
    ) {
        match jacobian {
            Some(_) if watch.stop() => values.fill(f64::NAN),
            Some(jacobian) => self.derivatives(x, values, jacobian),
            None => self.values(x, values),
        }
    }
}

/// Within derivatives, and within the first subproblem, that of a start which breaks a hundred rows.
#[test]
fn what_is_stopped_has_values() {
    /// Enough products for a call within the first subproblem.
    const ROWS: usize = 120;
    const VARIABLES: usize = 300;
    let stopped = |params: ProblemParams<'_>| {
        let problem = Problem::new(params).unwrap();
        let stop = &mut |_: &grouser_opt::Progress<'_>| ControlFlow::Break(());
        let found = solve_with(&problem, &Method::Minimax, &Settings::default(), stop).unwrap();
        assert_eq!(found.status, Status::Stopped);
        let square: f64 = found.x.iter().map(|x| x * x).sum();
        assert_eq!((found.objectives[0], found.utility), (square, square));
        assert_eq!(found.counts.values, 1);
        found.x
    };
    assert_eq!(
        stopped(ProblemParams::new(&[3.0, 1.0], 1, Calling)),
        [3.0, 1.0]
    );
    let rows = (0..ROWS).map(|row| {
        let coefficient = |k: usize| ((row * VARIABLES + k).pow(2) as f64).sin();
        let coefficients: Vec<f64> = (0..VARIABLES).map(coefficient).collect();
        LinearConstraint::at_most(format!("row{row}"), coefficients, -1.0)
    });
    let x = stopped(ProblemParams::new(&[0.0; VARIABLES], 1, Calling).linear(rows));
    assert_eq!(x.len(), VARIABLES);
}

/// A level of −1e30 may be one; below it there is no end. Beside 1 a promise of sixteen units in its last place is rounding.
#[test]
fn a_level_may_be_large_and_a_promise_small() {
    const SIXTEEN_UNITS: f64 = 16.0 * f64::EPSILON;
    let of = |values| {
        least(Variable::free("x", 0.0), &settings(|_| ()), values, |_| {
            [1.0]
        })
        .status
    };
    assert_eq!(of(|_| [-1e30]), Status::Stalled);
    assert_eq!(of(|_| [-1.000_000_000_000_001e30]), Status::Unbounded);
    let exact = settings(|settings| settings.optimality_tolerance = 0.0);
    let of = |room: f64| {
        let variable = Variable::bounded("x", 0.0, 0.0, room);
        least(
            variable,
            &exact,
            |x| [if x == 0.0 { 1.0 } else { 2.0 }],
            |_| [-1.0],
        )
        .status
    };
    assert_eq!(of(SIXTEEN_UNITS), Status::SmallDirectionalDerivative);
    assert_eq!(of(2.0 * SIXTEEN_UNITS), Status::SmallStep);
}

/// Around the least point of a line through it each probe is put back onto the line, and what rounding leaves does not refuse it:
/// four along each variable, two of each random pair, and a pair along each variable; one more is where the slopes are.
#[test]
fn rounding_refuses_no_probe() {
    let line = LinearConstraint::equal("line", vec![0.3, 0.7], 0.0);
    let params = ProblemParams::new(&[0.0; 2], 1, Calling).linear([line]);
    let settings = Settings::default();
    let found = solve(&Problem::new(params).unwrap(), &Method::Minimax, &settings).unwrap();
    assert_eq!(found.counts.probes, 4 * 2 + 2 * settings.probes + 2 * 2 + 1);
}
