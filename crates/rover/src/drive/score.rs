//! The true slip over the estimator's window, to which its estimate is compared.

use grouser_slip::Health;
use grouser_slip::control::WheelObservation;

use super::outcome::SlipScore;

/// Below this speed no slip is compared, m/s: two and a half times the filter's own limit.
const MIN_SPEED_M_PER_S: f64 = 0.05;

/// The first seconds of motion after a stop, s: unsheared soil makes true slips of up to 0.9 there.
const START_TIME_S: f64 = 1.0;
/// An error beyond this many sigma is wrong: by chance one in 16 000.
const WRONG_SIGMA: f64 = 4.0;

/// Ways of rim and centre over the estimator's window, as long ago as its estimate.
#[derive(Clone, Debug)]
pub(super) struct TrueSlip {
    /// Ring of the ways at each tick: rim and centre.
    ring: Vec<[f64; 2]>,
    window: usize,
    at: usize,
    filled: usize,
    way: [f64; 2],
}

impl TrueSlip {
    /// Over `window` ticks that end `lag` ticks ago.
    pub(super) fn new(window: usize, lag: usize) -> Self {
        let window = window.max(1);
        Self {
            ring: vec![[0.0; 2]; window + lag + 1],
            window,
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

    /// A tick of the control loop: the slip over the window, with the faster speed (m/s).
    pub(super) fn tick(&mut self, period: f64) -> Option<(f64, f64)> {
        let length = self.ring.len();
        self.ring[self.at] = self.way;
        // the oldest entry is the window's beginning
        let before = self.ring[(self.at + 1) % length];
        let after = self.ring[(self.at + 1 + self.window) % length];
        self.at = (self.at + 1) % length;
        self.filled = (self.filled + 1).min(length);
        if self.filled < length {
            return None;
        }
        let time = self.window as f64 * period;
        let (rim, centre) = ((after[0] - before[0]) / time, (after[1] - before[1]) / time);
        let slip = grouser_terra::Slip::from_speeds(centre, rim).ok()?;
        Some((slip.value(), rim.abs().max(centre.abs())))
    }
}

/// Sums for a [`SlipScore`].
#[derive(Clone, Debug, Default)]
pub(super) struct Scoring {
    count: u64,
    sum: f64,
    square: f64,
    scaled: f64,
    /// How long each wheel has been moving, s; count and squares once that is a second.
    moving: Vec<f64>,
    settled: (f64, f64),
    /// How long each wheel has been wrong with health `Ok`, s, and the longest of all.
    wrong: Vec<f64>,
    longest: f64,
}

impl Scoring {
    /// For that many wheels.
    pub(super) fn new(wheels: usize) -> Self {
        Self {
            moving: vec![0.0; wheels],
            wrong: vec![0.0; wheels],
            ..Self::default()
        }
    }

    /// A tick of `period` s: what is estimated of a wheel beside its true slip and faster speed (m/s).
    pub(super) fn add(
        &mut self,
        wheel: usize,
        observation: &WheelObservation,
        truth: Option<(f64, f64)>,
        period: f64,
    ) {
        let moving = &mut self.moving[wheel];
        *moving = match truth {
            Some((_, speed)) if speed >= MIN_SPEED_M_PER_S => *moving + period,
            _ => 0.0,
        };
        let settled = *moving >= START_TIME_S;
        let wrong = &mut self.wrong[wheel];
        let (Some(slip), Some(sigma), Some((truth, speed))) =
            (observation.slip, observation.sigma, truth)
        else {
            *wrong = 0.0;
            return;
        };
        let off = slip - truth;
        if observation.health == Health::Ok && off.abs() > WRONG_SIGMA * sigma {
            *wrong += period;
            self.longest = self.longest.max(*wrong);
        } else {
            *wrong = 0.0;
        }
        if speed >= MIN_SPEED_M_PER_S && observation.health == Health::Ok {
            self.count += 1;
            self.sum += off;
            self.square += off * off;
            self.scaled += (off / sigma) * (off / sigma);
            if settled {
                self.settled.0 += 1.0;
                self.settled.1 += off * off;
            }
        }
    }

    pub(super) fn score(&self) -> SlipScore {
        let count = self.count as f64;
        let mean = |sum: f64| (self.count > 0).then(|| sum / count);
        SlipScore {
            count: self.count,
            rmse: mean(self.square).map(f64::sqrt),
            settled: (self.settled.0 > 0.0).then(|| (self.settled.1 / self.settled.0).sqrt()),
            bias: mean(self.sum),
            nees: mean(self.scaled),
            longest_wrong: self.longest,
        }
    }
}
