//! Corners, cuts and listed points by hand, of a problem whose objectives are its variables.

use std::time::Duration;

use grouser_real::Scalar;

use super::*;
use crate::Exact;
use crate::Functions;
use crate::problem::{ProblemParams, Variable};

/// x and y, where x + y ≤ 9.
struct Plane;
impl Functions for Plane {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        (f[0], f[1]) = (x[0], x[1]);
        f[2] = x[0] + x[1] - R::from_f64(9.0);
    }
}

/// A search that lists these points.
fn searched<T>(
    points: &[[f64; 2]],
    gap: f64,
    log: &mut Vec<String>,
    test: impl FnOnce(&mut FrontSearch<'_, '_>) -> T,
) -> T {
    let variables = ["x", "y"].map(|name| Variable::bounded(name, 0.0, -9.0, 9.0));
    let params = ProblemParams::new(&[0.0, 0.0], 2, Exact(Plane))
        .variables(variables)
        .inequalities(["sum".to_owned()]);
    let problem = Problem::new(params).unwrap();
    let mut settings = CertifySettings::default();
    (settings.gap, settings.starts) = (gap, 1);
    let rows = |group| Rows::new(&problem, &least_of(&[0, 1], group, None)).unwrap();
    let mut boxes = 0;
    let mut search = FrontSearch {
        problem: &problem,
        groups: &[0, 1],
        settings: &settings,
        rows: [rows(0), rows(1)],
        points: Vec::new(),
        range: [1.0; 2],
        proofs: 0,
        boxes: 0,
        logged: 0,
        began: Instant::now(),
        watch: FrontWatch {
            callback: &mut |progress| {
                // over all proofs
                assert!(progress.boxes >= boxes);
                boxes = progress.boxes;
                ControlFlow::Continue(())
            },
            suggest: &mut |_| Vec::new(),
            proof: Some(&mut |line: &str| {
                log.push(line.to_owned());
                ControlFlow::Continue(())
            }),
        },
    };
    for point in points {
        search.list(point);
    }
    test(&mut search)
}

fn listed(search: &FrontSearch<'_, '_>) -> Vec<[f64; 2]> {
    search.points.iter().map(|p| p.objectives).collect()
}

#[test]
fn points_that_none_beats_are_listed_in_order() {
    let points = [[2.0, 1.0], [1.0, 2.0], [1.0, 2.0], [2.0, 2.0], [0.5, 3.0]];
    searched(&points, 0.1, &mut Vec::new(), |search| {
        assert_eq!(listed(search), [[0.5, 3.0], [1.0, 2.0], [2.0, 1.0]]);
        // what is no point of the problem
        search.list(&[-9.5, 0.0]);
        search.list(&[5.0, 4.5]);
        assert_eq!(search.points.len(), 3);
        search.list(&[0.5, 2.0]);
        assert_eq!(listed(search), [[0.5, 2.0], [2.0, 1.0]]);
        search.list(&[0.25, 1.0]);
        assert_eq!(listed(search), [[0.25, 1.0]]);
    });
}

#[test]
fn ranges_are_those_of_the_listed_points() {
    let range = |points: &[[f64; 2]]| {
        searched(points, 0.1, &mut Vec::new(), |search| {
            search.set_range();
            search.range
        })
    };
    assert_eq!(range(&[]), [1.0, 1.0]);
    assert_eq!(range(&[[1.0, 5.0], [3.0, 2.0]]), [2.0, 3.0]);
    assert_eq!(range(&[[-3.0, -5.0], [-1.0, -7.0]]), [2.0, 2.0]);
    // at least a share of 1 and the size
    assert_eq!(range(&[[-3.0, 7.0]]), [1e-4 * 4.0, 1e-4 * 8.0]);
    let close = range(&[[-9.0, 1.0], [-8.9999, 0.9999]]);
    assert_eq!(close, [1e-4 * 10.0, 1e-4 * 2.0]);
}

#[test]
fn what_a_corner_leaves_open() {
    searched(&[[1.0, 5.0], [3.0, 2.0]], 0.1, &mut Vec::new(), |search| {
        search.range = [2.0, 4.0];
        assert_eq!(search.open_share([0.0, 0.0]), 1.25);
        assert_eq!(search.open_share([2.0, 0.0]), 0.5);
        assert_eq!(search.open_share([5.0, 6.0]), 0.0);
        let corner = |at| Corner {
            at,
            is_stuck: false,
        };
        let corners = [[2.0, 1.0], [1.0, 3.0], [1.0, 1.0], [0.0, 2.0]].map(corner);
        let found = search.certificate(CertifyStatus::BoxLimit, &corners);
        // the most is left by (1, 1), and what lies above another corner is no corner
        assert_eq!(found.share, 1.0);
        assert_eq!(found.tolerance, [2.0, 4.0]);
        assert_eq!(found.corners, [[0.0, 2.0], [1.0, 1.0]]);
    });
}

/// Across the shorter side, at the listed point that is nearest to its middle.
#[test]
fn where_a_corner_is_cut() {
    let cut = |points: &[[f64; 2]], range: [f64; 2], corner: [f64; 2]| {
        searched(points, 0.25, &mut Vec::new(), |search| {
            search.range = range;
            search.cut_of(corner)
        })
    };
    let ends = [[0.25, 4.0], [4.0, 0.25]];
    let (unit, origin) = ([1.0, 1.0], [0.0, 0.0]);
    let with = |more: &[[f64; 2]]| cut(&[&ends[..], more].concat(), unit, origin);
    assert_eq!(with(&[]), Some((0, 2.0)));
    assert_eq!(with(&[[1.0, 1.0]]), Some((0, 1.0)));
    assert_eq!(with(&[[1.0, 1.0], [2.25, 0.75]]), Some((0, 2.25)));
    // a fifth of the side away from its ends
    assert_eq!(with(&[[0.8, 2.0]]), Some((0, 0.8)));
    assert_eq!(with(&[[0.75, 2.0]]), Some((0, 2.0)));
    // 3.5 against 4; 4 against 4; 6/2 against 4
    let points = [[0.25, 4.0], [4.0, 0.75]];
    assert_eq!(cut(&points, unit, [0.0, 0.5]), Some((1, 2.25)));
    let points = [[1.25, 6.0], [5.0, 2.25]];
    assert_eq!(cut(&points, unit, [1.0, 2.0]), Some((0, 3.0)));
    let points = [[0.25, 6.0], [4.0, 0.5]];
    assert_eq!(cut(&points, [1.0, 2.0], origin), Some((1, 3.0)));
    // nowhere, where no point ends the cell or nothing lies between its ends
    assert_eq!(cut(&[[1.0, 1.0]], unit, origin), None);
    let infinity = f64::INFINITY;
    assert_eq!(cut(&ends, unit, [-infinity, -infinity]), None);
    for corner in [1.0, 1.0_f64.next_up()] {
        let next = [corner.next_up(), 0.25];
        assert_eq!(cut(&[next], unit, [corner, 0.0]), None);
    }
    assert_eq!(cut(&[[1.0, 1.0]], unit, [1.0, 1.0]), None);
}

#[test]
fn the_time_that_is_left() {
    searched(&[], 0.1, &mut Vec::new(), |search| {
        assert_eq!(search.seconds_left(), None);
        let mut settings = search.settings.clone();
        settings.time_limit_s = Some(100.0);
        search.began = Instant::now().checked_sub(Duration::from_secs(40)).unwrap();
        search.settings = Box::leak(Box::new(settings));
        let left = search.seconds_left().unwrap();
        assert!((59.0..=60.0).contains(&left), "{left}");
        // a share of no time is none
        search.began = Instant::now()
            .checked_sub(Duration::from_secs(101))
            .unwrap();
        let found = search.prove(0, None, true).unwrap();
        assert!(found.status == CertifyStatus::TimeLimit && found.boxes == 0);
    });
}

/// A fifth of the tolerance, of the size of the listed points; a thousandth where they do not show the range.
#[test]
fn what_a_proof_may_leave_open() {
    let mut log = Vec::new();
    let points = [[-3.0, 1.0], [1.0, -2.0]];
    let found = searched(&points, 0.25, &mut log, |search| {
        search.range = [2.0, 3.0];
        let found = [(0, true), (1, true), (0, false)]
            .map(|(axis, is_known)| search.prove(axis, None, is_known).unwrap());
        assert_eq!(search.proofs, 3);
        assert_eq!(search.boxes, found.iter().map(|c| c.boxes).sum::<u64>());
        found
    });
    for c in &found {
        assert!(c.boxes > 0 && c.lower <= -9.0 && c.lower > -9.5);
    }
    let mut heads = log.iter().filter(|line| line.contains("\"gap\""));
    // 0.2 · 0.25 · 2/4, and by the points that were found since
    for gap in [0.2 * 0.25 * 2.0 / 4.0, 0.2 * 0.25 * 3.0 / 3.0, 1e-3] {
        let head = heads.next().unwrap();
        let found = &head[head.find("\"gap\":").unwrap() + 6..];
        let found: f64 = found[..found.find(',').unwrap()].parse().unwrap();
        assert!((found - gap).abs() < 1e-15, "{found} {gap}");
    }
}

/// A cut below which there is no point leaves no corner: x ≥ −9 has nothing at x ≤ −11.
#[test]
fn a_cut_without_points_leaves_no_corner() {
    searched(&[[8.0, -8.5]], 0.25, &mut Vec::new(), |search| {
        search.range = [40.0, 40.0];
        let at = [-30.0, -10.0];
        let mut corners = vec![Corner {
            at,
            is_stuck: false,
        }];
        assert_eq!(search.cut_of(at), Some((0, -11.0)));
        assert_eq!(search.cut_all(&mut corners).unwrap(), CertifyStatus::Proved);
        assert!(corners.iter().flat_map(|c| c.at).all(f64::is_finite));
        assert!(corners.iter().all(|c| c.at[0] >= -11.0 && c.at[1] >= -10.0));
        assert!(corners.iter().all(|c| search.open_share(c.at) <= 0.25));
    });
}

/// Each proof may take a quarter of the time that is left, and may leave open a fifth of the gap, of the range.
#[test]
fn a_proof_has_a_share_of_time_and_gap() {
    searched(&[[-3.0, 1.0]], 0.1, &mut Vec::new(), |search| {
        let method = least_of(search.groups, 0, None);
        let mut settings = search.settings.clone();
        settings.time_limit_s = Some(1e6);
        search.settings = Box::leak(Box::new(settings));
        search.range = [2.0, 1.0];
        let of = search.settings_of(&method, 0, true);
        let time_s = of.time_limit_s.unwrap();
        assert!(time_s > 2.4e5 && time_s <= 2.5e5, "{time_s}");
        assert!((of.gap - 0.2 * 0.1 * 2.0 / 4.0).abs() < 1e-15, "{}", of.gap);
        assert_eq!(of.candidates, [[-3.0, 1.0]]);
    });
}
