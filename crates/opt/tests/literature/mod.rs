//! The published minimax problems, each from its published start.

pub(crate) mod further;
mod luksan_vlcek_linear;
mod luksan_vlcek_unconstrained;
mod other;
pub(crate) mod suite;

use std::fmt::Write as _;

use grouser_opt::{Method, Problem, Settings, Solution, Status, solve};

use crate::lagrangian::stationarity;
use suite::{Case, all};

fn solved(case: &Case) -> (Problem<'static>, Solution) {
    let problem = Problem::new((case.params)()).unwrap();
    let solution = solve(&problem, &Method::Minimax, &Settings::default()).unwrap();
    (problem, solution)
}

#[test]
fn every_problem_reaches_its_published_optimum() {
    let mut failures = Vec::new();
    for case in all() {
        let (_, solution) = solved(&case);
        let error = solution.maximum - case.optimum;
        println!(
            "{:<15} {:?} max {:.10} (published {:.8}, off {:.1e}), {:?}, {:?}",
            case.name,
            solution.status,
            solution.maximum,
            case.optimum,
            error,
            solution.counts,
            solution.kkt
        );
        // The published figures are rounded to 8 digits; below them nothing can be better than that.
        if !(error.abs() <= 1e-6 * (1.0 + case.optimum.abs())) || !solution.status.is_solved() {
            failures.push(case.name);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn multipliers_prove_each_optimum() {
    for case in all() {
        let (problem, solution) = solved(&case);
        let sum: f64 = solution.multipliers.objectives.iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{}: sum {sum}", case.name);
        let parts = &solution.multipliers;
        assert!(parts.objectives.iter().all(|&l| l >= 0.0), "{}", case.name);
        assert!(parts.lower.iter().chain(&parts.upper).all(|&l| l >= 0.0));
        let (residual, scale) = stationarity(&problem, &solution);
        assert!(
            residual <= 1e-6 * scale.max(1.0),
            "{}: residual {residual:e}, scale {scale:e}",
            case.name
        );
        // Only objectives at the maximum carry weight.
        for (i, (&f, &l)) in solution
            .objectives
            .iter()
            .zip(&parts.objectives)
            .enumerate()
        {
            let f = if i < problem.absolute() { f.abs() } else { f };
            let gap = l * (solution.maximum - f);
            assert!(
                gap <= 1e-6 * (1.0 + solution.maximum.abs()),
                "{}: objective {i}, gap {gap:e}",
                case.name
            );
        }
    }
}

#[test]
fn every_problem_converges_rather_than_stalls() {
    for case in all() {
        let (_, solution) = solved(&case);
        assert_eq!(solution.status, Status::Converged, "{}", case.name);
    }
}

/// Jacobians per problem: a change of the algorithm shows here as a reviewed difference.
#[test]
fn effort() {
    let mut table = String::new();
    let mut total = 0;
    for case in all() {
        let (_, solution) = solved(&case);
        let counts = solution.counts;
        let _ = writeln!(
            table,
            "{:<15} jacobians {:>3}  values {:>3}",
            case.name, counts.jacobians, counts.values
        );
        total += solution.counts.jacobians;
    }
    let _ = write!(table, "together        jacobians {total}");
    insta::assert_snapshot!(table);
}
