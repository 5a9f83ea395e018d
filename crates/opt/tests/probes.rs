//! Where a solution is looked at a second time, by a model that notes each point: every probe against its place by hand.

use std::sync::Mutex;

use grouser_opt::{
    Jacobian, LinearConstraint, Method, Model, Problem, ProblemParams, Settings, Solution,
    Variable, solve,
};

/// Of a near probe, as a share of a variable's range, or of 1 + |x|.
const NEAR_SHARE: f64 = 1e-4;
/// Over those of a near probe: the far ones, and the pair along each variable.
const FAR_FACTOR: f64 = 100.0;
const PAIR_FACTOR: f64 = 1000.0;
const RANDOM_PAIRS: usize = 6;
/// By how much rounding may move a point, or its sum in a row: a thousand times the last digit of numbers up to 4.
const ROUNDING_DISTANCE: f64 = 1e-12;

/// Two bowls that hold the level together at (0.5, 2), with other curvatures, and one that is far below.
#[derive(Default)]
struct Noted {
    points: Mutex<Vec<Vec<f64>>>,
}

/// w (x − a)² + v (y − b)² + s.
const BOWLS: [[f64; 5]; 3] = [
    [1.0, 0.0, 3.0, 2.0, 0.0],
    [2.0, 1.0, 3.0, 2.0, -0.25],
    [0.1, 0.0, 0.2, 1.0, -50.0],
];

impl Model for &Noted {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.points.lock().unwrap().push(x.to_vec());
        for (value, [w, a, v, b, s]) in values.iter_mut().zip(BOWLS) {
            *value = w * (x[0] - a).powi(2) + v * (x[1] - b).powi(2) + s;
        }
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        self.points.lock().unwrap().clear();
        for (row, [w, a, v, b, _]) in BOWLS.into_iter().enumerate() {
            jacobian.set(row, 0, 2.0 * w * (x[0] - a));
            jacobian.set(row, 1, 2.0 * v * (x[1] - b));
        }
    }
}

/// A solution, and the points that were evaluated after the last derivatives.
fn probed(bounds: [(f64, f64); 2], rows: Vec<LinearConstraint>) -> (Solution, Vec<Vec<f64>>) {
    let noted = Noted::default();
    let variables = bounds
        .into_iter()
        .enumerate()
        .map(|(k, (low, high))| Variable::bounded(format!("x{k}"), 0.25, low, high));
    let params = ProblemParams::new(&[0.25, 0.25], BOWLS.len(), &noted)
        .variables(variables)
        .linear(rows);
    let mut settings = Settings::default();
    settings.probes = RANDOM_PAIRS;
    let problem = Problem::new(params).unwrap();
    let solution = solve(&problem, &Method::Minimax, &settings).unwrap();
    assert_eq!(solution.status.name(), "converged");
    drop(problem);
    let points = noted.points.into_inner().unwrap();
    // one of them is the place of the derivatives
    assert_eq!(solution.counts.probes, points.len() + 1);
    (solution, points)
}

fn near(found: &[f64], expected: [f64; 2]) {
    for (a, b) in found.iter().zip(expected) {
        assert!(
            (a - b).abs() < ROUNDING_DISTANCE,
            "{found:?} instead of {expected:?}"
        );
    }
}

#[test]
fn a_solution_is_probed_along_variables_descents_and_at_random() {
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let (solution, points) = probed([(-1.0, 3.0), free], Vec::new());
    // where both are as high: x² = 2 (x − 1)² − 1/4
    let x = 2.0 - f64::sqrt(2.25);
    near(&solution.x, [x, 2.0]);
    let [x, y] = [solution.x[0], solution.x[1]];
    let lengths = [4.0 * NEAR_SHARE, (1.0 + y) * NEAR_SHARE];
    let mut expected = Vec::new();
    for k in 0..2 {
        for times in [1.0, -1.0, FAR_FACTOR, -FAR_FACTOR] {
            let mut place = [x, y];
            place[k] += times * lengths[k];
            expected.push(place);
        }
    }
    // the descents of those that hold the level, the greatest component one length long, and their sum
    let mut sum = [0.0; 2];
    for [w, a, v, b, _] in &BOWLS[..2] {
        let slopes = [
            -2.0 * w * (x - a) * lengths[0],
            -2.0 * v * (y - b) * lengths[1],
        ];
        let greatest = slopes[0].abs().max(slopes[1].abs());
        let unit = slopes.map(|slope| slope / greatest);
        expected.push([x + unit[0] * lengths[0], y + unit[1] * lengths[1]]);
        sum = [sum[0] + unit[0], sum[1] + unit[1]];
    }
    // the sum of two that oppose each other vanishes but for rounding, and with it its probe
    let is_same = sum.iter().all(|d| d.abs() < 1e-3);
    assert!(is_same, "{sum:?}");
    let (of_directions, rest) = points.split_at(expected.len());
    for (found, expected) in of_directions.iter().zip(expected) {
        near(found, expected);
    }
    let rest = &rest[rest.len() - 2 * RANDOM_PAIRS - 4..];
    let (random, pairs) = rest.split_at(2 * RANDOM_PAIRS);
    let mut greatest = [0.0_f64; 2];
    for (at, two) in random.chunks(2).enumerate() {
        // both sides, and each second one a hundred times as far
        let reach = if at % 2 == 0 { 1.0 } else { FAR_FACTOR };
        for k in 0..2 {
            let step = two[1][k] - solution.x[k];
            near(&[two[0][k] + two[1][k]; 2], [2.0 * solution.x[k]; 2]);
            assert!(step.abs() <= reach * lengths[k], "{at}: {step:e}");
            let share = step.abs() / (reach * lengths[k]);
            assert!(share > 1e-3, "{at}: {share:e}");
            greatest[k] = greatest[k].max(share);
        }
        assert!((two[1][0] - x) / lengths[0] != (two[1][1] - y) / lengths[1]);
    }
    assert!(greatest.iter().all(|share| *share > 0.5), "{greatest:?}");
    for (k, two) in pairs.chunks(2).enumerate() {
        for (found, sign) in two.iter().zip([1.0, -1.0]) {
            let mut place = [x, y];
            place[k] += sign * PAIR_FACTOR * lengths[k];
            near(found, place);
        }
    }
}

/// A row that the solution lies on, one that it does not, and an equality: probes go along the rows that they would break.
#[test]
fn probes_stay_within_bounds_and_on_rows() {
    let at_most = |a: [f64; 2], b| LinearConstraint::at_most(format!("{a:?}"), a.to_vec(), b);
    let holds = |rows: &[([f64; 2], f64)], bounds: [(f64, f64); 2], points: &[Vec<f64>]| {
        for point in points {
            for (a, b) in rows {
                let sum = a[0] * point[0] + a[1] * point[1];
                assert!(sum <= b + ROUNDING_DISTANCE, "{point:?} breaks {a:?}");
            }
            for (x, (low, high)) in point.iter().zip(bounds) {
                assert!((low..=high).contains(x), "{point:?}");
            }
        }
    };
    let bounds = [(-1.0, 3.0), (-2.0, 1.75)];
    let rows = [([3.0, 1.0], 2.0), ([-1.0, 2.0], 40.0)];
    let (solution, points) = probed(bounds, rows.map(|(a, b)| at_most(a, b)).to_vec());
    near(&solution.x, [1.0 / 12.0, 1.75]);
    holds(&rows, bounds, &points);
    // of a step up x what breaks the row is taken back across it, by nine parts of ten; a step down keeps it
    let step = 4.0 * NEAR_SHARE;
    let [x, y] = [solution.x[0], solution.x[1]];
    near(&points[0], [x + 0.1 * step, y - 0.3 * step]);
    near(&points[1], [x - step, y]);
    near(&points[3], [x - FAR_FACTOR * step, y]);
    // an equality keeps all of them on its line
    let line = LinearConstraint::equal("line", vec![1.0, -2.0], -2.5);
    let (solution, points) = probed(bounds, vec![line]);
    for point in &points {
        assert!(
            (point[0] - 2.0 * point[1] + 2.5).abs() < ROUNDING_DISTANCE,
            "{point:?}"
        );
    }
    // of a near step up x four parts of five are along the line
    let [x, y] = [solution.x[0], solution.x[1]];
    assert!(y < 1.7);
    near(&points[0], [x + 0.8 * step, y + 0.4 * step]);
    // what rounding moves off a line through the origin counts as on it: no probe is lost
    let line = LinearConstraint::equal("line", vec![0.3, 0.7], 0.0);
    let (_, points) = probed(bounds, vec![line]);
    assert!(points.len() >= 8 + 2 * RANDOM_PAIRS + 4, "{}", points.len());
}
