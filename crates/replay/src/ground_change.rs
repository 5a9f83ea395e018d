//! Has the ground changed? Told by what the motors draw and how their wheels run, together.

use std::collections::VecDeque;

/// What is new is the mean of this long, s; it is held against this long before it, s.
const RECENT_TIME_S: f64 = 1.5;
const BASELINE_TIME_S: f64 = 4.0;
/// So much of the usual must be there, s.
const MIN_BASELINE_TIME_S: f64 = 2.0;
/// The ground has changed from this statistic on. For independent readings 40 would be rare; motors hunt and seams pass
/// under the wheels, and in 90 s on one ground each a Robotino comes to 186.
const CHANGE_THRESHOLD: f64 = 200.0;

/// Watches currents (or torques) and rates of all motors, one row a time, with Hotelling's T²:
///
/// ```text
/// T² = n dᵀ S⁻¹ d,   d = mean of the last 1.5 s − mean of the 4 s before, S the covariance in these 4 s
/// ```
///
/// Currents alone do not distinguish two soft grounds, and neither do rates: a motor that is pulled down runs slower. Off
/// that line together they move only if the ground is another one, or the command is: announce that by
/// [`GroundChange::begin`]. Memory: one row of each reading of 5.5 s.
#[derive(Clone, Debug)]
pub struct GroundChange {
    rows: VecDeque<(f64, Vec<f64>)>,
    max_statistic: f64,
}

impl Default for GroundChange {
    fn default() -> Self {
        Self::new()
    }
}

impl GroundChange {
    /// Nothing is known yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            rows: VecDeque::new(),
            max_statistic: 0.0,
        }
    }

    /// All begins anew: another command was given.
    pub fn begin(&mut self) {
        self.rows.clear();
    }

    /// The maximum statistic so far.
    #[must_use]
    pub const fn max_statistic(&self) -> f64 {
        self.max_statistic
    }

    /// Takes the readings at `time_s` (s), always as many in the same order; is the ground another one now?
    pub fn take(&mut self, time_s: f64, readings: &[f64]) -> bool {
        if readings.iter().any(|reading| !reading.is_finite()) {
            return false;
        }
        let fits = |row: &(f64, Vec<f64>)| row.1.len() == readings.len() && row.0 < time_s;
        if !self.rows.back().is_none_or(fits) {
            self.begin();
        }
        self.rows.push_back((time_s, readings.to_vec()));
        while self
            .rows
            .front()
            .is_some_and(|row| time_s - row.0 > RECENT_TIME_S + BASELINE_TIME_S)
        {
            self.rows.pop_front();
        }
        let usual = self
            .rows
            .partition_point(|row| time_s - row.0 > RECENT_TIME_S);
        let known = self
            .rows
            .front()
            .map_or(0.0, |row| time_s - row.0 - RECENT_TIME_S);
        if known < MIN_BASELINE_TIME_S || usual <= 2 * readings.len() {
            return false;
        }
        let statistic = self.statistic(usual, readings.len());
        self.max_statistic = self.max_statistic.max(statistic);
        if statistic <= CHANGE_THRESHOLD {
            return false;
        }
        // what was usual is over
        self.rows.drain(..usual);
        true
    }

    fn statistic(&self, usual: usize, size: usize) -> f64 {
        let mean = |from: usize, to: usize| {
            let mut sum = vec![0.0; size];
            for (_, row) in self.rows.range(from..to) {
                for (slot, value) in sum.iter_mut().zip(row) {
                    *slot += value / (to - from) as f64;
                }
            }
            sum
        };
        let before = mean(0, usual);
        let now = mean(usual, self.rows.len());
        let step: Vec<f64> = now.iter().zip(&before).map(|(a, b)| a - b).collect();
        let mut covariance = vec![vec![0.0; size]; size];
        for (_, row) in self.rows.range(..usual) {
            for i in 0..size {
                for j in 0..size {
                    covariance[i][j] +=
                        (row[i] - before[i]) * (row[j] - before[j]) / (usual - 1) as f64;
                }
            }
        }
        for (i, row) in covariance.iter_mut().enumerate() {
            // a reading that never moved still has its last digit
            row[i] += 1e-6;
        }
        let count = (self.rows.len() - usual) as f64;
        solve(covariance, step.clone()).map_or(0.0, |solved| {
            count * solved.iter().zip(&step).map(|(a, b)| a * b).sum::<f64>()
        })
    }
}

/// x of A x = b for a symmetric positive definite A, by elimination; `None` where it is not.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        if !(a[k][k] > 0.0) {
            return None;
        }
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let (above, below) = a.split_at_mut(i);
            for (slot, pivot) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                *slot -= factor * pivot;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::{GroundChange, solve};

    #[test]
    fn a_solved_system_gives_back_its_right_side() {
        let a = vec![vec![4.0, 1.0], vec![1.0, 3.0]];
        let x = solve(a, vec![1.0, 2.0]).unwrap();
        assert!((x[0] - 1.0 / 11.0).abs() < 1e-15 && (x[1] - 7.0 / 11.0).abs() < 1e-15);
    }

    #[test]
    fn a_step_is_called_and_noise_is_not() {
        let mut state = 1_u64;
        let mut noise = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 32) as f64 / f64::from(u32::MAX) - 0.5
        };
        let mut change = GroundChange::new();
        let mut called = Vec::new();
        for row in 0..1000 {
            let time = 0.03 * f64::from(row);
            let step = if row >= 500 { 1.0 } else { 0.0 };
            if change.take(time, &[2.0 + step + noise(), 20.0 + noise()]) {
                called.push(time);
            }
        }
        assert!(
            called.len() == 1 && called[0] > 15.0 && called[0] < 16.5,
            "{called:?}"
        );
    }
}
