//! Means of the worst of few worlds: the best points by a scan, and what they cost.

use std::fmt::Write as _;

use grouser_opt::{
    Exact, Functions, Measure, Method, Problem, ProblemParams, Settings, Variable, World, evaluate,
    robust, solve,
};
use grouser_real::Scalar;

use crate::random_starts::Stream;

/// A bowl about a world's own place, a wave of e against another direction, and a limit.
struct Bowls([f64; 4]);

impl Functions for Bowls {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let [a, b, c, d] = self.0.map(R::from_f64);
        let square = (x[0] - a).square() + (R::ONE + c.square()) * (x[1] - b).square();
        f[0] = square;
        f[1] = (c * x[0] + d * x[1]).exp() + R::from_f64(0.5) * x[1].square() - x[0];
        f[2] = x[0] + c * x[1] - R::ONE;
    }
}

fn drawn(stream: &mut Stream, alpha: f64) -> Problem<'static> {
    let mut between = |low: f64, high: f64| low + (high - low) * stream.next();
    let worlds: Vec<World<'_>> = (0..7)
        .map(|i| {
            let place = [between(-2.0, 2.0), between(-2.0, 2.0)];
            let slopes = [between(-0.9, 0.9), between(-1.2, 1.2)];
            let world = Bowls([place[0], place[1], slopes[0], slopes[1]]);
            World::new(format!("world {i}"), Exact(world))
        })
        .collect();
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.5, -3.0, 3.0));
    let params = ProblemParams::new(&[0.5; 2], 2, Exact(Bowls([0.0; 4])))
        .variables(variables)
        .inequalities(["limit".to_owned()]);
    robust(params, worlds, Measure::ConditionalValueAtRisk { alpha }).unwrap()
}

/// All is convex: no point of a scan is better than the solution.
#[test]
fn no_point_has_a_better_tail_and_few_steps_find_it() {
    let mut stream = Stream(2012);
    let mut table = String::new();
    let weighted = Method::Weighted {
        weights: vec![1.0, 2.0],
    };
    let attained = Method::Attain {
        goals: vec![1.0, 0.5],
        weights: vec![2.0, 0.5],
    };
    // the second objective is a limit, which counts before the first
    let limited = Method::Attain {
        goals: vec![0.0, 4.0],
        weights: vec![1.0, 0.0],
    };
    let methods = [Method::Minimax, weighted, attained, limited];
    for (name, method) in ["minimax", "weighted", "attained", "limited"]
        .iter()
        .zip(&methods)
    {
        let (mut iterations, mut values) = (0, 0);
        for alpha in [0.0, 0.35, 0.6, 0.9].into_iter().cycle().take(12) {
            let problem = drawn(&mut stream, alpha);
            let found = solve(&problem, method, &Settings::default()).unwrap();
            iterations += found.counts.iterations;
            values += found.counts.values;
            let own = evaluate(&problem, method, &found.x).unwrap();
            assert!((own.utility - found.utility).abs() < 1e-12);
            assert!(
                found.status.is_solved() && own.violation < 1e-7,
                "{found:?}"
            );
            for i in 0..=12 {
                for j in 0..=12 {
                    // over the box, and near the solution
                    let far = [i, j].map(|i| -3.0 + 0.5 * f64::from(i));
                    let near = [0, 1].map(|k| found.x[k] + 1e-3 * (far[k] - found.x[k]));
                    for x in [far, near] {
                        let merit = evaluate(&problem, method, &x).unwrap();
                        assert!(
                            merit.violation > 0.0 || merit.utility >= found.utility - 1e-7,
                            "{name} {alpha}: {merit:?} at {x:?}, {found:?}"
                        );
                    }
                }
            }
        }
        let _ = writeln!(
            table,
            "{name:<9} iterations {iterations:>4} values {values:>4}"
        );
    }
    insta::assert_snapshot!(table);
}
