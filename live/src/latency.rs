//! From a message in to its slip out.

use std::time::Instant;

use grouser_replay::Quantiles;

/// Longer ones count as this, s; the longest is kept beside the quantiles.
const MAX_LATENCY_S: f64 = 0.1;

/// Quantiles of the time from the arrival of a message to the end of what it causes.
#[derive(Debug)]
pub(crate) struct Latency {
    quantiles: Quantiles,
    longest_s: f64,
}

impl Latency {
    pub(crate) fn new() -> Self {
        Self {
            quantiles: Quantiles::new(0.0, MAX_LATENCY_S),
            longest_s: 0.0,
        }
    }

    /// A message that arrived at `received` has had its slips published.
    pub(crate) fn add(&mut self, received: Instant) {
        let passed_s = received.elapsed().as_secs_f64();
        self.quantiles.add(passed_s);
        self.longest_s = self.longest_s.max(passed_s);
    }

    /// Median, 99.9 % and longest, µs; `None` before the first.
    pub(crate) fn microseconds(&self) -> Option<[f64; 3]> {
        let at = |share| Some(1e6 * self.quantiles.at(share)?);
        Some([at(0.5)?, at(0.999)?, 1e6 * self.longest_s])
    }
}
