//! Which of some runs is the best, by hand.

use super::*;
use crate::solution::{Kkt, Multipliers};
use crate::status::{Limit, Status};

fn run(status: Status, utility: f64, violation: f64, x: f64) -> Solution {
    Solution {
        status,
        x: vec![x],
        objectives: vec![utility],
        inequalities: Vec::new(),
        equalities: Vec::new(),
        maximum: utility,
        utility,
        multipliers: Multipliers::default(),
        active: Vec::new(),
        kkt: Kkt {
            violation,
            ..Kkt::default()
        },
        counts: Counts::default(),
    }
}

/// The best feasible run counts, solved or not, and a solved one among equally good ones; without any the least violation.
#[test]
fn the_best_run_is_feasible() {
    let of = |runs: Vec<Solution>| {
        let found = MultiStart {
            starts: vec![Vec::new(); runs.len()],
            optima: distinct(&runs, &[0.0], &[1.0]),
            runs,
            counts: Counts::default(),
            stopped: false,
        };
        found.best().x[0]
    };
    let limit = || Status::Limit(Limit::Iterations);
    let infeasible = || {
        let off = 2.0 * MAX_SOLVED_VIOLATION;
        [
            run(Status::Stopped, 1.0, 2.0 * off, 1.0),
            run(limit(), 2.0, off, 2.0),
        ]
    };
    let with = |others: &[Solution]| of([&infeasible()[..], others].concat());
    assert_eq!(with(&[]), 2.0);
    let stalled = run(Status::Stalled, 3.0, MAX_SOLVED_VIOLATION, 3.0);
    let solved = |utility: f64| run(Status::Converged, utility, 0.0, 4.0);
    assert_eq!(with(&[stalled.clone(), solved(3.1)]), 3.0);
    assert_eq!(with(&[stalled.clone(), solved(3.0 + SAME_UTILITY)]), 4.0);
    assert_eq!(with(&[run(limit(), f64::NAN, 0.0, 5.0), solved(9.0)]), 4.0);
}

/// Points are the same to a share of the box.
#[test]
fn optima_are_apart_by_a_share_of_the_box() {
    /// Not 1, so that a share is no distance.
    const BOX_WIDTH: f64 = 100.0;
    let of = |apart: f64| {
        let runs = [0.0, apart * SAME_POINT * BOX_WIDTH].map(|x| run(Status::Converged, x, 0.0, x));
        distinct(&runs, &[0.0], &[BOX_WIDTH]).len()
    };
    assert_eq!((of(0.5), of(1.5)), (1, 2));
}
