//! A second look at a point whose optimality conditions hold: does a small step in any direction help?
//!
//! The conditions speak of the derivatives that the functions report. At a kink (the edge of a domain, a
//! clamp, a maximum) the derivative belongs to one side, and a step to the other side may still lower the
//! level. At a maximum or a saddle the derivatives vanish, and what is lower is seen from some way off only.
//! The directions are each variable up and down, the steepest descent of each objective that holds
//! the level, and random ones from a fixed seed.

use super::point::{Evaluator, Point};
use super::subspace::dot;
use crate::jacobian::Jacobian;
use crate::program::Program;
use crate::random::Random;
use crate::solution::Counts;

/// Length of a probe, as a share of a variable's range; without finite bounds of 1 + |x|.
const PROBE_LENGTH: f64 = 1e-4;
/// Length of a far probe (each second random one, and two along each variable) over that of a near one: 1 % of the range, where
/// a curvature lowers the level by 1e-4 that lowers it by 1e-8 over 1e-4 of the range.
const FAR_PROBE_FACTOR: f64 = 100.0;
/// Length of the last probes along each variable over that of a near one: 10 % of the range, across a maximum.
const LAST_PROBE_FACTOR: f64 = 1000.0;
/// Passes over the linear constraints that a probe violates.
const LINEAR_SWEEPS: usize = 4;
/// Objectives within this · (1 + |level|) of the level hold it.
const HOLDING_SLACK: f64 = 1e-6;

/// Evaluates the probes around `point`; ends early where the callback ends the search.
pub(super) fn around(evaluator: &mut Evaluator<'_, '_, '_>, random: usize, point: &Point) {
    let lengths = lengths(evaluator.program, point);
    for direction in directions(evaluator, &lengths, random, point) {
        if evaluator.is_stopped() {
            return;
        }
        probe(evaluator, point, &direction);
    }
}

/// Evaluates the point a direction further on, unless it is the same point or meets the linear constraints less well.
fn probe(evaluator: &mut Evaluator<'_, '_, '_>, point: &Point, direction: &[f64]) {
    if let Some(x) = moved(evaluator.program, point, direction) {
        evaluator.probe(&x);
    }
}

/// Values and derivatives as far off as the last probes, along all variables at once; `None` where no such point meets bounds and
/// linear constraints.
pub(super) fn some_distance_off(
    evaluator: &mut Evaluator<'_, '_, '_>,
    point: &Point,
) -> Option<(Point, Jacobian)> {
    let program = evaluator.program;
    let direction: Vec<f64> = lengths(program, point)
        .into_iter()
        .enumerate()
        .map(|(i, length)| {
            let is_low = program.upper[i] - point.x[i] >= point.x[i] - program.lower[i];
            LAST_PROBE_FACTOR * if is_low { length } else { -length }
        })
        .collect();
    let x = moved(program, point, &direction)?;
    let counts = evaluator.counts;
    let mut off = evaluator.values(&x);
    let (jacobian, _) = evaluator.derivatives(&mut off);
    evaluator.counts = Counts {
        probes: counts.probes + 1,
        ..counts
    };
    Some((off, jacobian))
}

/// The point a direction further on; `None` where it is the same point or meets the linear constraints less well.
fn moved(program: &Program<'_>, point: &Point, direction: &[f64]) -> Option<Vec<f64>> {
    let mut x: Vec<f64> = direction.iter().zip(&point.x).map(|(d, x)| x + d).collect();
    into_bounds(program, &mut x);
    for _ in 0..LINEAR_SWEEPS {
        onto_linear(program, &mut x);
        into_bounds(program, &mut x);
    }
    let is_linear = program.linear.iter().all(|row| {
        let off = |x: &[f64]| dot(&row.coefficients, x) - row.bound;
        let rounding = 1e-14 * (1.0 + row.bound.abs());
        if row.equal {
            off(&x).abs() <= off(&point.x).abs() + rounding
        } else {
            off(&x) <= off(&point.x).max(0.0) + rounding
        }
    });
    (is_linear && x != point.x).then_some(x)
}

fn into_bounds(program: &Program<'_>, x: &mut [f64]) {
    for (x, (low, high)) in x.iter_mut().zip(program.lower.iter().zip(&program.upper)) {
        *x = x.clamp(*low, *high);
    }
}

/// Puts a point back onto each linear constraint that it violates.
fn onto_linear(program: &Program<'_>, x: &mut [f64]) {
    for row in &program.linear {
        let off = dot(&row.coefficients, x) - row.bound;
        let size = dot(&row.coefficients, &row.coefficients);
        if (off > 0.0 || row.equal) && size > 0.0 {
            for (x, a) in x.iter_mut().zip(&row.coefficients) {
                *x -= off / size * a;
            }
        }
    }
}

/// Of a probe along each variable.
fn lengths(program: &Program<'_>, point: &Point) -> Vec<f64> {
    let variables = point.x.iter().zip(program.lower.iter().zip(&program.upper));
    variables
        .map(|(x, (low, high))| {
            let range = high - low;
            PROBE_LENGTH
                * if range.is_finite() {
                    range
                } else {
                    1.0 + x.abs()
                }
        })
        .collect()
}

/// A step along variable `i` of `times` its length.
fn along(lengths: &[f64], i: usize, times: f64) -> Vec<f64> {
    let mut direction = vec![0.0; lengths.len()];
    direction[i] = times * lengths[i];
    direction
}

fn directions(
    evaluator: &mut Evaluator<'_, '_, '_>,
    lengths: &[f64],
    random: usize,
    point: &Point,
) -> Vec<Vec<f64>> {
    let program = evaluator.program;
    let n = point.x.len();
    let mut list = Vec::new();
    for i in 0..n {
        list.extend(
            [1.0, -1.0, FAR_PROBE_FACTOR, -FAR_PROBE_FACTOR].map(|times| along(lengths, i, times)),
        );
    }
    let counts = evaluator.counts;
    let (jacobian, _) = evaluator.derivatives(&mut point.clone());
    evaluator.counts = Counts {
        probes: counts.probes + 1,
        ..counts
    };
    let level = point.level(program);
    let mut sum = vec![0.0; n];
    for (row, value) in program.rows.iter().zip(&point.rows) {
        if !row.kind.is_objective() || level - value > HOLDING_SLACK * (1.0 + level.abs()) {
            continue;
        }
        // steepest where each variable is measured by its own length
        let scaled: Vec<f64> = jacobian
            .row(row.function)
            .iter()
            .zip(lengths)
            .map(|(g, length)| -row.slope() * g * length)
            .collect();
        let largest = scaled.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        if largest > 0.0 && largest.is_finite() {
            let unit: Vec<f64> = scaled.iter().map(|d| d / largest).collect();
            for (sum, d) in sum.iter_mut().zip(&unit) {
                *sum += d;
            }
            list.push(unit.iter().zip(lengths).map(|(d, l)| d * l).collect());
        }
    }
    list.push(sum.iter().zip(lengths).map(|(d, l)| d * l).collect());
    let mut stream = Random::new(1);
    for pair in 0..random {
        let times = if pair % 2 == 0 { 1.0 } else { FAR_PROBE_FACTOR };
        let lengths = lengths.iter().map(|l| times * l);
        let direction: Vec<f64> = lengths
            .map(|l| l * (2.0 * stream.uniform() - 1.0))
            .collect();
        list.push(direction.iter().map(|d| -d).collect());
        list.push(direction);
    }
    for i in 0..n {
        list.extend([LAST_PROBE_FACTOR, -LAST_PROBE_FACTOR].map(|times| along(lengths, i, times)));
    }
    list
}
