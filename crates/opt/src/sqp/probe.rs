//! A second look at a point whose optimality conditions hold: does a small step in any direction help?
//!
//! The conditions speak of the derivatives that the functions report. At a kink (the edge of a domain, a
//! clamp, a maximum) the derivative belongs to one side, and a step to the other side may still lower the
//! level. The directions are each variable up and down, the steepest descent of each objective that holds
//! the level, and random ones from a fixed seed.

use super::point::{Evaluator, Point};
use super::subspace::dot;
use crate::program::Program;
use crate::random::Random;
use crate::settings::Settings;
use crate::solution::Counts;

/// Length of a probe, as a share of a variable's range; without finite bounds of 1 + |x|.
const PROBE_LENGTH: f64 = 1e-4;
/// A decrease of the level beyond this · (1 + |level|) refutes a point. The optimality conditions themselves
/// leave 1e-8 of the level open (`Settings::optimality_tolerance`).
const REFUTING_DECREASE: f64 = 1e-7;
/// Passes over the linear constraints that a probe violates.
const LINEAR_SWEEPS: usize = 4;
/// Objectives within this · (1 + |level|) of the level hold it.
const HOLDING_SLACK: f64 = 1e-6;

/// The best probe around `point` that meets all constraints as well as it does and lowers the level.
pub(super) fn improvement(
    evaluator: &mut Evaluator<'_>,
    settings: &Settings,
    point: &Point,
) -> Option<Vec<f64>> {
    let program = evaluator.program;
    let level = point.level(program);
    let violation = point.worst_violation(program);
    let mut best = level - REFUTING_DECREASE * (1.0 + level.abs());
    let mut found = None;
    for direction in directions(evaluator, settings.probes, point) {
        let mut x: Vec<f64> = direction.iter().zip(&point.x).map(|(d, x)| x + d).collect();
        into_bounds(program, &mut x);
        for _ in 0..LINEAR_SWEEPS {
            onto_linear(program, &mut x);
            into_bounds(program, &mut x);
        }
        let linear = program.linear.iter().all(|row| {
            let off = |x: &[f64]| dot(&row.coefficients, x) - row.bound;
            let rounding = 1e-14 * (1.0 + row.bound.abs());
            if row.equal {
                off(&x).abs() <= off(&point.x).abs() + rounding
            } else {
                off(&x) <= off(&point.x).max(0.0) + rounding
            }
        });
        if !linear || x == point.x {
            continue;
        }
        let probe = evaluator.probe(&x);
        let fits =
            probe.not_finite(program).is_none() && probe.worst_violation(program) <= violation;
        let level = probe.level(program);
        if fits && level < best {
            best = level;
            found = Some(x);
        }
    }
    found
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

fn directions(evaluator: &mut Evaluator<'_>, random: usize, point: &Point) -> Vec<Vec<f64>> {
    if random == 0 {
        return Vec::new();
    }
    let program = evaluator.program;
    let n = point.x.len();
    let lengths: Vec<f64> = (0..n)
        .map(|i| {
            let range = program.upper[i] - program.lower[i];
            let size = 1.0 + point.x[i].abs();
            PROBE_LENGTH * if range.is_finite() { range } else { size }
        })
        .collect();
    let mut list = Vec::new();
    for i in 0..n {
        for sign in [1.0, -1.0] {
            let mut direction = vec![0.0; n];
            direction[i] = sign * lengths[i];
            list.push(direction);
        }
    }
    let counts = evaluator.counts;
    let jacobian = evaluator.derivatives(&mut point.clone());
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
            .zip(&lengths)
            .map(|(g, length)| -row.slope() * g * length)
            .collect();
        let largest = scaled.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        if largest > 0.0 && largest.is_finite() {
            let unit: Vec<f64> = scaled.iter().map(|d| d / largest).collect();
            for (sum, d) in sum.iter_mut().zip(&unit) {
                *sum += d;
            }
            list.push(unit.iter().zip(&lengths).map(|(d, l)| d * l).collect());
        }
    }
    list.push(sum.iter().zip(&lengths).map(|(d, l)| d * l).collect());
    let mut stream = Random::new(1);
    for _ in 0..random {
        let lengths = lengths.iter();
        let direction: Vec<f64> = lengths
            .map(|l| l * (2.0 * stream.uniform() - 1.0))
            .collect();
        list.push(direction.iter().map(|d| -d).collect());
        list.push(direction);
    }
    list
}
