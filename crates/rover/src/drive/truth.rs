//! The true slip over the estimator's window, to which its estimate is compared.

use super::outcome::SlipScore;

/// Speed below which no slip is compared, m/s.
const LEAST_SPEED: f64 = 0.05;

/// Ways of rim and centre over a window.
#[derive(Clone, Debug)]
pub(super) struct TrueSlip {
    /// Ring of the ways at each tick: rim and centre.
    ring: Vec<[f64; 2]>,
    at: usize,
    filled: usize,
    way: [f64; 2],
}

impl TrueSlip {
    /// Over `ticks` ticks.
    pub(super) fn new(ticks: usize) -> Self {
        Self {
            ring: vec![[0.0; 2]; ticks.max(1)],
            at: 0,
            filled: 0,
            way: [0.0; 2],
        }
    }

    /// One step's way of rim and centre, m.
    pub(super) fn add(&mut self, rim: f64, centre: f64) {
        self.way[0] += rim;
        self.way[1] += centre;
    }

    /// A tick of the control loop: the slip over the window that ends here, with the faster speed (m/s).
    pub(super) fn tick(&mut self, period: f64) -> Option<(f64, f64)> {
        let before = self.ring[self.at];
        self.ring[self.at] = self.way;
        self.at = (self.at + 1) % self.ring.len();
        self.filled = (self.filled + 1).min(self.ring.len());
        if self.filled < self.ring.len() {
            return None;
        }
        let time = self.ring.len() as f64 * period;
        let (rim, centre) = (
            (self.way[0] - before[0]) / time,
            (self.way[1] - before[1]) / time,
        );
        let slip = grouser_terra::Slip::from_speeds(centre, rim).ok()?;
        Some((slip.value(), rim.abs().max(centre.abs())))
    }
}

/// Sums for a [`SlipScore`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Scoring {
    count: u64,
    sum: f64,
    square: f64,
}

impl Scoring {
    pub(super) fn add(&mut self, estimate: f64, (truth, speed): (f64, f64)) {
        if speed >= LEAST_SPEED {
            let off = estimate - truth;
            self.count += 1;
            self.sum += off;
            self.square += off * off;
        }
    }

    pub(super) fn score(&self) -> SlipScore {
        let some = self.count > 0;
        let count = self.count as f64;
        SlipScore {
            count: self.count,
            rmse: some.then(|| (self.square / count).sqrt()),
            bias: some.then(|| self.sum / count),
        }
    }
}
