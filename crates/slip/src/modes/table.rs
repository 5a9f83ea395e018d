//! The modes of the slip, and how often one follows another.

use core::array;

use grouser_real::Real;

/// How many modes there are.
pub const MODES: usize = 4;
/// Random walk of the logarithmic slip in motion, 1/√s: steady (wear and load), creeping, wandering (rough ground), jumping (an edge
/// of the ground passes under the wheels). A prior: factors of five cover what measured ground does. Walks 1.5 times as large move
/// no figure of `bench/estimators` by 4 %.
pub const WALKS: [f64; MODES] = [3e-3, 0.02, 0.1, 0.6];
/// The jumping mode.
pub const JUMPING: usize = MODES - 1;
/// How often a mode (row) changes to another (column), 1/s. A prior: slip jumps once in 50 s, and a jump with its return to a steady
/// slip takes a second or two.
const RATES: [[f64; MODES]; MODES] = [
    [0.0, 0.02, 0.02, 0.02],
    [0.05, 0.0, 0.03, 0.02],
    [0.05, 0.3, 0.0, 0.02],
    [0.2, 0.2, 0.2, 0.0],
];
/// Longer steps than this mix as this one does, s: the table holds to first order.
const MAX_MIX_TIME: f64 = 0.2;
/// No mode is less likely than this, so that it comes back.
const MIN_WEIGHT: f64 = 1e-6;

/// The weights after a step without a measurement, and from which modes (second index) each of them comes.
pub(super) fn mixed(weights: &[f64; MODES], dt: f64) -> ([f64; MODES], [[f64; MODES]; MODES]) {
    let dt = dt.min(MAX_MIX_TIME);
    let joint: [[f64; MODES]; MODES] = array::from_fn(|to| {
        array::from_fn(|from| {
            let leaves: f64 = RATES[from].iter().sum();
            let rate = if from == to { -leaves } else { RATES[from][to] };
            weights[from] * (f64::from(u8::from(from == to)) + dt * rate)
        })
    });
    let after = joint.map(|of| of.iter().sum());
    let shares = array::from_fn(|to| joint[to].map(|of| of / after[to]));
    (after, shares)
}

/// The weights by Bayes' rule, from the logarithms of the likelihoods.
pub(super) fn weighed(weights: &[f64; MODES], likelihoods: &[f64; MODES]) -> [f64; MODES] {
    let best = likelihoods.iter().copied().fold(f64::MIN, f64::max);
    let out: [f64; MODES] =
        array::from_fn(|mode| weights[mode] * Real::exp(likelihoods[mode] - best) + MIN_WEIGHT);
    let all: f64 = out.iter().sum();
    out.map(|weight| weight / all)
}
