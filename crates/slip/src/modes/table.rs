//! The modes of the slip, and how often one follows another.

use core::array;

/// How many modes there are.
pub const MODES: usize = 4;
/// Random walk of the logarithmic slip in motion, 1/√s: steady (wear and load), creeping, wandering (rough ground), jumping (an edge
/// of the ground passes under the wheels within a few steps). A prior: a factor of ten from one to the next covers all ground.
pub const WALKS: [f64; MODES] = [8e-4, 8e-3, 0.06, 0.6];
/// The jumping mode.
pub const JUMPING: usize = MODES - 1;
/// How often a mode (row) changes to another (column), 1/s. A prior: ground changes each half a minute, and a jump lasts a second.
const RATES: [[f64; MODES]; MODES] = [
    [0.0, 0.02, 0.02, 0.03],
    [0.05, 0.0, 0.03, 0.03],
    [0.05, 0.3, 0.0, 0.03],
    [1.0, 1.0, 1.0, 0.0],
];
/// Longer steps than this mix as this one does, s: the table holds to first order.
const MAX_MIX_TIME: f64 = 0.2;
/// No mode is less likely than this, so that it comes back.
const MIN_WEIGHT: f64 = 1e-6;

/// Probability that a mode (row) is another (column) after a step.
fn changes(dt: f64) -> [[f64; MODES]; MODES] {
    let dt = dt.min(MAX_MIX_TIME);
    array::from_fn(|from| {
        let all: f64 = RATES[from].iter().sum();
        array::from_fn(|to| {
            if from == to {
                1.0 - dt * all
            } else {
                dt * RATES[from][to]
            }
        })
    })
}

/// The weights after a step without a measurement, and from which modes (second index) each of them comes.
pub(super) fn mixed(weights: &[f64; MODES], dt: f64) -> ([f64; MODES], [[f64; MODES]; MODES]) {
    let changes = changes(dt);
    let after: [f64; MODES] = array::from_fn(|to| {
        (0..MODES)
            .map(|from| weights[from] * changes[from][to])
            .sum()
    });
    let shares =
        array::from_fn(|to| array::from_fn(|from| weights[from] * changes[from][to] / after[to]));
    (after, shares)
}

/// Bayes' rule.
pub(super) fn weighed(weights: &[f64; MODES], likelihoods: &[f64; MODES]) -> [f64; MODES] {
    let best = likelihoods.iter().copied().fold(f64::MIN, f64::max);
    let mut out: [f64; MODES] = array::from_fn(|mode| {
        weights[mode] * grouser_real::Real::exp(likelihoods[mode] - best) + MIN_WEIGHT
    });
    let all: f64 = out.iter().sum();
    for weight in &mut out {
        *weight /= all;
    }
    out
}
