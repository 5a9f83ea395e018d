//! The functions of a sum and their slopes, by hand.

use super::{Sum, divided};

fn utility(problem: &Problem<'_>, weights: &[f64], x: &[f64]) -> f64 {
    let mut values = vec![f64::NAN; problem.function_count()];
    problem.model().values(x, &mut values);
    super::utility(problem, weights, &values)
}

use crate::derivative::{Exact, Functions};
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::parts::Parts;
use crate::problem::{Problem, ProblemParams};
use crate::robust::{Measure, World, robust};
use grouser_real::Scalar;

/// x − 2 y, x², y, and x + y − 3.
struct Plain;
impl Functions for Plain {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0] - x[1] - x[1];
        f[1] = x[0].square();
        f[2] = x[1];
        f[3] = x[0] + x[1] - R::from_f64(3.0);
    }
}

/// Of two worlds x − 2 y and x + y, and x² and y².
struct Worlds;
impl Functions for Worlds {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0] - x[1] - x[1];
        f[1] = x[0] + x[1];
        f[2] = x[0].square();
        f[3] = x[1].square();
    }
}

fn sum<'a>(problem: &'a Problem<'a>, weights: &[f64]) -> Sum<'a> {
    let (lifted, plain) = divided(problem, weights);
    Sum {
        problem,
        lifted,
        plain,
    }
}

fn assert_functions(sum: &Sum<'_>, x: &[f64], values: &[f64], slopes: &[&[f64]]) {
    let mut found = vec![f64::NAN; values.len()];
    sum.values(x, &mut found);
    assert_eq!(found, values);
    let mut jacobian = Jacobian::zeros(values.len(), x.len());
    for row in 0..values.len() {
        jacobian.row_mut(row).fill(9.0);
    }
    sum.derivatives(x, &mut found, &mut jacobian);
    assert_eq!(found, values);
    for (row, slopes) in slopes.iter().enumerate() {
        assert_eq!(jacobian.row(row), *slopes, "{row}");
    }
}

#[test]
fn a_sum_with_one_magnitude() {
    let params = ProblemParams::new(&[5.0, -4.0], 3, Exact(Plain))
        .absolute(1)
        .inequalities(["limit".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let weights = [2.0, 0.5, 3.0];
    // 2 |1 − 4| + 0.5 + 3 · 2
    assert_eq!(utility(&problem, &weights, &[1.0, 2.0]), 12.5);
    assert_eq!(utility(&problem, &[0.0, 0.5, 0.0], &[1.0, 2.0]), 0.5);
    let sum = sum(&problem, &weights);
    assert_eq!(sum.lifted.len(), 1);
    assert_eq!(sum.plain, [(1, 0.5), (2, 3.0)]);
    // with t = 7: 2 · 7 + 6.5, ±f − t, and the limit
    assert_functions(
        &sum,
        &[1.0, 2.0, 7.0],
        &[20.5, -10.0, -4.0, 0.0],
        &[
            &[1.0, 3.0, 2.0],
            &[1.0, -2.0, -1.0],
            &[-1.0, 2.0, -1.0],
            &[1.0, 1.0, 0.0],
        ],
    );
}

#[test]
fn a_sum_of_the_worst_of_two_worlds() {
    let params = ProblemParams::new(&[5.0, -4.0], 4, Exact(Worlds))
        .absolute(2)
        .worlds(2);
    let problem = Problem::new(params).unwrap();
    let weights = [2.0, 1.0, 0.5, 3.0];
    // 2 |−3| is more than 1 · 3, and 3 · 4 than 0.5
    assert_eq!(utility(&problem, &weights, &[1.0, 2.0]), 18.0);
    // 2 |−2| is less than 5, and 3 · 1 than 0.5 · 16
    assert_eq!(utility(&problem, &weights, &[4.0, 1.0]), 13.0);
    assert!(utility(&problem, &weights, &[f64::NAN, 1.0]).is_nan());
    let sum = sum(&problem, &weights);
    let lifted = |at: usize| (sum.lifted[at].weight, &sum.lifted[at].rows[..]);
    let magnitudes = [(0, 1.0), (0, -1.0), (1, 0.5), (1, -0.5)];
    assert_eq!(lifted(0), (2.0, &magnitudes[..]));
    assert_eq!(lifted(1), (3.0, &[(2, 0.5 / 3.0), (3, 1.0)][..]));
    assert!(sum.plain.is_empty() && sum.lifted.len() == 2);
    let sixth = 0.5 / 3.0;
    assert_functions(
        &sum,
        &[1.0, 2.0, 7.0, 10.0],
        &[44.0, -10.0, -4.0, -5.5, -8.5, sixth - 10.0, -6.0],
        &[
            &[0.0, 0.0, 2.0, 3.0],
            &[1.0, -2.0, -1.0, 0.0],
            &[-1.0, 2.0, -1.0, 0.0],
            &[0.5, 0.5, -1.0, 0.0],
            &[-0.5, -0.5, -1.0, 0.0],
            &[2.0 * sixth, 0.0, 0.0, -1.0],
            &[0.0, 4.0, 0.0, -1.0],
        ],
    );
}

/// x², x y, and two limits; each with a number of its world added.
struct Shifted(f64);
impl Functions for Shifted {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let shift = R::from_f64(self.0);
        (f[0], f[1]) = (x[0].square() + shift, x[0] * x[1] - shift * x[0]);
        (f[2], f[3]) = (x[0] - shift, x[1].square() - shift);
    }
}

/// The functions of a sum of tails, as combinations of their parts and as they are.
#[test]
fn a_sum_of_tails_is_a_combination_of_parts() {
    let limits = || ["first".to_owned(), "second".to_owned()];
    let params = ProblemParams::new(&[0.5, 0.5], 2, Exact(Shifted(0.0))).inequalities(limits());
    let worlds = [-1.0, 0.5, 2.0].map(|shift| World::new(shift.to_string(), Exact(Shifted(shift))));
    let measure = Measure::ConditionalValueAtRisk { alpha: 0.5 };
    let problem = robust(params, worlds.into(), measure).unwrap();
    let sum = sum(&problem, &[2.0, 3.0]);
    let source = sum.parts().unwrap();
    let count = problem.function_count() - 1;
    for x in [[0.5, -2.0], [-1.5, 0.25], [3.0, 1.0]] {
        let mut expected = vec![0.0; count];
        sum.values(&x, &mut expected);
        let mut parts = vec![0.0; Parts::count(&sum)];
        Parts::evaluate(&sum, &x, &mut parts, None, &mut || false);
        let mut found = vec![0.0; count];
        crate::parts::functions(source, &parts, &mut found);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
