//! Which of some runs is the best, by hand.

use super::*;
use crate::solution::{Kkt, Multipliers};
use crate::status::Limit;

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

/// Of a search that was stopped the runs count that were stopped at a feasible point, or solved.
#[test]
fn the_best_of_a_stopped_search_is_feasible() {
    let limit = Status::Limit(Limit::Iterations);
    let of = |stopped| {
        let runs = vec![
            run(limit.clone(), 0.0, 0.0, 0.0),
            run(Status::Stopped, 1.0, 2.0 * MAX_STOPPED_VIOLATION, 1.0),
            run(Status::Stopped, 3.0, MAX_STOPPED_VIOLATION, 2.0),
            run(Status::Converged, 4.0, 0.0, 3.0),
        ];
        let found = MultiStart {
            starts: vec![Vec::new(); runs.len()],
            optima: distinct(&runs, &[0.0], &[1.0]),
            runs,
            counts: Counts::default(),
            stopped,
        };
        found.best().utility
    };
    assert_eq!((of(true), of(false)), (3.0, 4.0));
    let solved = run(Status::Converged, 2.0, 0.0, 0.0);
    let found = MultiStart {
        starts: Vec::new(),
        runs: vec![run(limit, 1.0, 0.5, 0.0), solved],
        optima: Vec::new(),
        counts: Counts::default(),
        stopped: true,
    };
    assert_eq!(found.best().utility, 2.0);
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
