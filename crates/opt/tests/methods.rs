//! Goal attainment, weighted sums and Chebyshev distances against closed forms.

use grouser_opt::{
    Exact, Functions, Limit, Method, Problem, ProblemParams, Settings, Solution, Status, Variable,
    check_derivatives, evaluate, solve,
};
use grouser_real::Scalar;

/// f1 = (x − 1)² + y², f2 = (x + 1)² + y²: the front lies on y = 0, −1 ≤ x ≤ 1.
struct Pair;
impl Functions for Pair {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = (x[0] - R::ONE).square() + x[1].square();
        f[1] = (x[0] + R::ONE).square() + x[1].square();
    }
}

fn pair(method: &Method) -> Solution {
    let problem = Problem::new(ProblemParams::new(&[0.3, 2.0], 2, Exact(Pair))).unwrap();
    let solution = solve(&problem, method, &Settings::default()).unwrap();
    assert_eq!(solution.status, Status::Converged);
    solution
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
}

#[test]
fn minimax_weighs_both_alike() {
    let solution = pair(&Method::Minimax);
    near(solution.x[0], 0.0);
    near(solution.maximum, 1.0);
    near(solution.multipliers.objectives[0], 0.5);
}

#[test]
fn goals_are_attained_along_the_weights() {
    // (x − 1)² = γ, (x + 1)² = 3 γ + 0: x = −2 + √3 … the root inside [−1, 1] of (x + 1)² = 3 (x − 1)².
    let solution = pair(&Method::Attain {
        goals: vec![0.0, 0.0],
        weights: vec![1.0, 3.0],
    });
    let x = 2.0 - 3.0_f64.sqrt();
    near(solution.x[0], x);
    near(solution.utility, (x - 1.0).powi(2));
    near(solution.multipliers.objectives.iter().sum::<f64>(), 1.0);
}

#[test]
fn a_goal_of_weight_zero_is_a_limit() {
    // (x − 1)² ≤ 0.25 holds; then (x + 1)² is least at x = 0.5.
    let solution = pair(&Method::Attain {
        goals: vec![0.25, 0.0],
        weights: vec![0.0, 1.0],
    });
    near(solution.x[0], 0.5);
    near(solution.utility, 2.25);
    near(solution.multipliers.objectives[1], 1.0);
    // 2 (x + 1) + λ 2 (x − 1) = 0 at x = 1/2: λ = 3.
    near(solution.multipliers.hard_goals[0], 3.0);
    assert!(solution.active.contains(&"f1".to_owned()));
}

#[test]
fn a_weighted_sum_ends_at_the_weighted_mean() {
    let solution = pair(&Method::Weighted {
        weights: vec![3.0, 1.0],
    });
    near(solution.x[0], 0.5);
    near(solution.utility, 3.0 * 0.25 + 2.25);
    near(solution.multipliers.objectives[0], 0.75);
    near(solution.objectives[1], 2.25);
}

#[test]
fn chebyshev_balances_the_weighted_distances() {
    // 4 (f1 − 0) = 1 (f2 − 0): (x + 1) = 2 (1 − x), x = 1/3.
    let solution = pair(&Method::Chebyshev {
        ideal: vec![0.0, 0.0],
        weights: vec![4.0, 1.0],
    });
    near(solution.x[0], 1.0 / 3.0);
    let alone = pair(&Method::Chebyshev {
        ideal: vec![0.0, 0.0],
        weights: vec![1.0, 0.0],
    });
    near(alone.x[0], 1.0);
}

/// |x − 1| + 2 |x + 1| + |y|, and the same with a constraint.
struct Kinks;
impl Functions for Kinks {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0] - R::ONE;
        f[1] = x[0] + R::ONE;
        f[2] = x[1];
        if let Some(g) = f.get_mut(3) {
            *g = -x[0] - x[1];
        }
    }
}

#[test]
fn a_weighted_sum_of_magnitudes_ends_at_its_kink() {
    let params = ProblemParams::new(&[5.0, -4.0], 3, Exact(Kinks)).absolute(3);
    let problem = Problem::new(params).unwrap();
    let method = Method::Weighted {
        weights: vec![1.0, 2.0, 1.0],
    };
    let solution = solve(&problem, &method, &Settings::default()).unwrap();
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    near(solution.x[0], -1.0);
    near(solution.x[1], 0.0);
    near(solution.utility, 2.0);
    near(solution.maximum, 2.0);
    assert_eq!(solution.x.len(), 2);
}

#[test]
fn a_weighted_sum_keeps_its_constraints() {
    // x + y ≥ 0 moves the kink: along x + y = 0 the sum is |x − 1| + 2 |x + 1| + |x|, least at −1 … 0.
    let params = ProblemParams::new(&[5.0, -4.0], 3, Exact(Kinks))
        .absolute(3)
        .inequalities(vec!["half-plane".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let method = Method::Weighted {
        weights: vec![1.0, 2.0, 1.0],
    };
    let solution = solve(&problem, &method, &Settings::default()).unwrap();
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    near(solution.utility, 3.0);
    assert_eq!(solution.multipliers.inequalities.len(), 1);
    assert_eq!(solution.inequalities.len(), 1);
    assert!(solution.inequalities[0] <= 1e-8);
}

#[test]
fn a_wrong_derivative_is_named() {
    struct Wrong;
    impl grouser_opt::Model for Wrong {
        fn values(&self, x: &[f64], values: &mut [f64]) {
            Exact(Pair).values(x, values);
        }
        fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut grouser_opt::Jacobian) {
            Exact(Pair).derivatives(x, values, jacobian);
            jacobian.set(1, 0, 7.0);
        }
    }
    let right = Problem::new(ProblemParams::new(&[0.3, 2.0], 2, Exact(Pair))).unwrap();
    let check = check_derivatives(&right, &[0.3, 2.0], 1e-6).unwrap();
    assert_eq!((check.wrong.len(), check.entries), (0, 4));
    assert!(check.worst < 1e-8);
    let wrong = Problem::new(ProblemParams::new(&[0.3, 2.0], 2, Wrong)).unwrap();
    let check = check_derivatives(&wrong, &[0.3, 2.0], 1e-6).unwrap();
    assert_eq!(check.wrong.len(), 1);
    assert_eq!(check.wrong[0].function, "f2");
    assert_eq!(check.wrong[0].variable, "x1");
    near(check.wrong[0].difference, 2.6);
}

/// Two limits and two equalities, each with its own value: the violation is that of the worst, and a solution lists all in order.
#[test]
fn each_constraint_has_its_own_value() {
    struct Plain;
    impl Functions for Plain {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            let c = R::from_f64;
            (f[0], f[1]) = (x[0] + x[1], x[2]);
            (f[2], f[3]) = (x[0] - c(7.0), x[1] - c(8.0));
            (f[4], f[5]) = (x[2] - c(1.0), x[0] - x[1] - c(2.0));
        }
    }
    let variables = ["x", "y", "z"].map(|name| Variable::bounded(name, 0.0, -20.0, 20.0));
    let params = ProblemParams::new(&[0.0; 3], 2, Exact(Plain))
        .variables(variables)
        .inequalities(["x".to_owned(), "y".to_owned()])
        .equalities(["z".to_owned(), "apart".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let violation = |x: [f64; 3]| {
        let merit = evaluate(&problem, &Method::Minimax, &x).unwrap();
        merit.violation
    };
    assert_eq!(violation([2.0, 0.0, 1.0]), 0.0);
    assert_eq!(violation([9.0, 7.0, 1.0]), 2.0);
    assert_eq!(violation([12.0, 10.0, 1.0]), 5.0);
    assert_eq!(violation([2.0, 0.0, -3.0]), 4.0);
    assert_eq!(violation([2.0, 3.0, 1.0]), 3.0);
    let found = solve(&problem, &Method::Minimax, &Settings::default()).unwrap();
    let x = &found.x;
    near(x[2], 1.0);
    near(x[0] - x[1], 2.0);
    assert_eq!(found.inequalities, [x[0] - 7.0, x[1] - 8.0]);
    assert_eq!(found.equalities, [x[2] - 1.0, x[0] - x[1] - 2.0]);
    assert!(found.status.is_solved());
}

/// Of an objective in two worlds one with the weight 0 does not count, though its 0 would be greater.
#[test]
fn a_world_without_weight_does_not_count() {
    struct Below;
    impl Functions for Below {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            (f[0], f[1]) = (x[0], x[0]);
        }
    }
    let params = ProblemParams::new(&[-3.0], 2, Exact(Below)).worlds(2);
    let problem = Problem::new(params).unwrap();
    let method = Method::Weighted {
        weights: vec![1.0, 0.0],
    };
    assert_eq!(evaluate(&problem, &method, &[-3.0]).unwrap().utility, -3.0);
}

#[test]
fn each_status_has_its_name() {
    let names = [
        Status::Converged,
        Status::SmallStep,
        Status::SmallDirectionalDerivative,
        Status::Stalled,
        Status::Limit(Limit::Values),
        Status::Stopped,
        Status::NoFeasiblePoint(Vec::new()),
        Status::Unbounded,
    ]
    .map(|status| status.name());
    let expected = "converged small_step small_directional_derivative stalled limit stopped no_feasible_point unbounded";
    assert_eq!(names.join(" "), expected);
}

#[test]
fn counts_add_up() {
    let mut sum = solve(
        &Problem::new(ProblemParams::new(&[0.3, 2.0], 2, Exact(Pair))).unwrap(),
        &Method::Minimax,
        &Settings::default(),
    )
    .unwrap()
    .counts;
    let one = sum;
    assert!(one.iterations > 1 && one.values > 1 && one.jacobians > 1 && one.probes > 1);
    sum += one;
    let found = [sum.iterations, sum.values, sum.jacobians, sum.probes];
    let half = [one.iterations, one.values, one.jacobians, one.probes];
    assert_eq!(found, half.map(|count| 2 * count));
}

/// A limit is named by what holds a weighted sum, whatever it is called; added rows and variables are not.
#[test]
fn what_holds_a_weighted_sum_has_its_own_name() {
    struct Line;
    impl Functions for Line {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            (f[0], f[1]) = (x[0] + x[1], x[1]);
            (f[2], f[3]) = (R::ONE - x[0], R::ONE - x[1]);
        }
    }
    let variables = ["+ x", "y"].map(|name| Variable::bounded(name, 3.0, 1.0, 20.0));
    let params = ProblemParams::new(&[3.0; 2], 2, Exact(Line))
        .variables(variables)
        .inequalities(["- slope".to_owned(), "+ width".to_owned()])
        .absolute(1);
    let method = Method::Weighted {
        weights: vec![1.0, 2.0],
    };
    let problem = Problem::new(params).unwrap();
    let found = solve(&problem, &method, &Settings::default()).unwrap();
    let named = |name: &str| found.active.iter().any(|active| active == name);
    for name in ["- slope", "+ width", "+ x >= lower", "y >= lower"] {
        assert!(named(name), "{:?}", found.active);
    }
    let own = found
        .active
        .iter()
        .filter(|name| !name.contains('\u{2502}'));
    assert_eq!(own.count(), found.active.len());
    // the weighted sum is the one objective
    assert_eq!(found.active.len(), 5);
}

/// Of two equal objectives one has no price; both hold the point, and a third that is lower does not.
#[test]
fn equal_objectives_hold_a_point_together() {
    struct Equal;
    impl Functions for Equal {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            let square = x[0].square() + R::ONE;
            (f[0], f[1], f[2]) = (square, square, square - R::from_f64(0.01));
        }
    }
    let params = ProblemParams::new(&[0.5], 3, Exact(Equal));
    let problem = Problem::new(params).unwrap();
    let found = solve(&problem, &Method::Minimax, &Settings::default()).unwrap();
    assert_eq!(found.active, ["f1", "f2"]);
}
