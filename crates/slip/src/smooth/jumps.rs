//! Jumps of the slip: where a shock of its own is worth its place and its size.
//!
//! The gain in log-likelihood of a free shock at a step is r²/(2 N) (de Jong and Penzer 1998). A jump costs its size (½ ln n) and
//! its place (ln n), where n is the number of readings.

use alloc::vec;
use alloc::vec::Vec;

use grouser_real::Real;

/// The logarithmic slip changes by about this where the ground changes: from a slip of 0.1 to one of 0.4.
const JUMP: f64 = 0.4;
/// An edge of the ground passes under the axles one by one: the slip changes within this time before and after its middle, s.
const SPREAD_S: f64 = 0.3;
/// So many steps of the spread carry a change.
const STEPS_OF_A_JUMP: f64 = 5.0;
/// Two jumps are at least this far from each other, s; and those that one search finds, which does not know yet what the first
/// of them explains.
const MIN_DISTANCE_S: f64 = 1.0;
const MIN_DISTANCE_OF_A_SEARCH_S: f64 = 5.0;

/// Jumps over the steps of a log.
#[derive(Clone, Debug)]
pub(super) struct Jumps {
    /// The steps at which they are likeliest.
    pub(super) at: Vec<usize>,
    /// Variance of the logarithmic slip that each step has by them.
    pub(super) extra: Vec<f64>,
    /// What a jump must gain in log-likelihood.
    worth: f64,
}

impl Jumps {
    /// No jumps over so many steps, which so many readings can show.
    pub(super) fn none(steps: usize, readings: usize) -> Self {
        Self {
            at: Vec::new(),
            extra: vec![0.0; steps],
            worth: 1.5 * Real::ln(readings.max(2) as f64),
        }
    }

    /// Adds the likeliest jumps that are worth it; true where there is a new one.
    pub(super) fn find(&mut self, shocks: &[[f64; 2]], times: &[f64]) -> bool {
        let gain = |step: usize| {
            let [r, n] = shocks[step];
            if n > 0.0 { 0.5 * r * r / n } else { 0.0 }
        };
        let before = self.at.len();
        let mut order: Vec<usize> = (0..shocks.len())
            .filter(|&step| gain(step) > self.worth)
            .collect();
        order.sort_by(|&a, &b| gain(b).total_cmp(&gain(a)));
        for step in order {
            let distance = |other: usize| (times[other] - times[step]).abs();
            let (known, new) = self.at.split_at(before);
            if known.iter().any(|&other| distance(other) < MIN_DISTANCE_S)
                || new
                    .iter()
                    .any(|&other| distance(other) < MIN_DISTANCE_OF_A_SEARCH_S)
            {
                continue;
            }
            self.at.push(step);
            for near in (0..times.len()).filter(|&near| distance(near) < SPREAD_S) {
                self.extra[near] = JUMP * JUMP / STEPS_OF_A_JUMP;
            }
        }
        self.at.len() > before
    }

    /// The log-likelihood less what the jumps cost.
    pub(super) fn evidence(&self, likelihood: f64) -> f64 {
        likelihood - self.worth * self.at.len() as f64
    }
}
