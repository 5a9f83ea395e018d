//! Has the ground changed? By what the motors draw and how their wheels run, together.

use std::collections::VecDeque;

use grouser_real::solve;

/// Readings are averaged over this time, s: motors hunt, and the noise of a row is that of the rows beside it.
const BLOCK_TIME_S: f64 = 0.25;
/// The new mean is that of this long, s; it is compared with this long before it, s.
const RECENT_BLOCKS: usize = 6;
const BASELINE_BLOCKS: usize = 16;
/// Minimum length of the baseline, blocks.
const MIN_BASELINE_BLOCKS: usize = 4;
/// Standard deviation of a reading that never moved: three per cent of a current or a speed.
const MIN_SCATTER: f64 = 0.03;
/// The ground has changed from this statistic on. On one ground each, six runs of a Robotino (90 s) come to 20; the four of its
/// runs over two surfaces in which the current changes for long enough come to 37 at least
/// (`a_change_of_ground_is_called_on_two_surfaces`).
const CHANGE_THRESHOLD: f64 = 28.0;

/// Watches the motors, one row a time, with Hotelling's T² for two means:
///
/// ```text
/// T² = dᵀ S⁻¹ d / (1/n + 1/m),   d = mean of the last 1.5 s − mean of the 4 s before, S the covariance within both
/// ```
///
/// over means of 0.25 s. The readings are to be the logarithms of the sum of the currents (or torques) and of the rims' speed:
/// currents alone do not distinguish two soft grounds, and neither do speeds. Off the line on which a loaded motor runs slower
/// they move only if the ground is another one, or the command is: announce that by [`GroundChange::begin`]. A change between
/// grounds that draw the same current at the same speed is not observable. Memory: 22 rows of means.
#[derive(Clone, Debug)]
pub struct GroundChange<const N: usize> {
    blocks: VecDeque<[f64; N]>,
    /// When the first block began, s.
    begun_s: f64,
    /// The open block: its number, the sums of its readings and how many there are.
    open: Option<(f64, [f64; N], f64)>,
}

impl<const N: usize> Default for GroundChange<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> GroundChange<N> {
    /// Nothing is known yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            blocks: VecDeque::new(),
            begun_s: 0.0,
            open: None,
        }
    }

    /// All begins anew: another command was given.
    pub fn begin(&mut self) {
        self.blocks.clear();
        self.open = None;
    }

    /// Takes the readings at `time_s` (s), in the same order each time; is the ground another one now?
    pub fn take(&mut self, time_s: f64, readings: &[f64; N]) -> bool {
        if readings.iter().any(|reading| !reading.is_finite()) {
            return false;
        }
        if time_s < self.begun_s {
            self.begin();
        }
        if self.open.is_none() && self.blocks.is_empty() {
            self.begun_s = time_s;
        }
        let number = ((time_s - self.begun_s) / BLOCK_TIME_S).floor();
        let full = self.open.take_if(|open| open.0 != number);
        let (_, sums, count) = self.open.get_or_insert((number, [0.0; N], 0.0));
        for (sum, reading) in sums.iter_mut().zip(readings) {
            *sum += reading;
        }
        *count += 1.0;
        let Some((_, sums, count)) = full else {
            return false;
        };
        self.blocks.push_back(sums.map(|sum| sum / count));
        if self.blocks.len() > RECENT_BLOCKS + BASELINE_BLOCKS {
            self.blocks.pop_front();
        }
        let Some(before) = self.blocks.len().checked_sub(RECENT_BLOCKS) else {
            return false;
        };
        if before < MIN_BASELINE_BLOCKS {
            return false;
        }
        if self.statistic(before) <= CHANGE_THRESHOLD {
            return false;
        }
        // What was usual is over.
        self.blocks.drain(..before);
        true
    }

    fn statistic(&self, before: usize) -> f64 {
        let mean = |from: usize, to: usize| {
            let mut sum = [0.0; N];
            for block in self.blocks.range(from..to) {
                for (slot, value) in sum.iter_mut().zip(block) {
                    *slot += value / (to - from) as f64;
                }
            }
            sum
        };
        let (usual, now) = (mean(0, before), mean(before, self.blocks.len()));
        let step: [f64; N] = std::array::from_fn(|i| now[i] - usual[i]);
        let mut covariance = [[0.0; N]; N];
        for (index, block) in self.blocks.iter().enumerate() {
            let mean = if index < before { &usual } else { &now };
            for i in 0..N {
                for j in 0..N {
                    covariance[i][j] += (block[i] - mean[i]) * (block[j] - mean[j])
                        / (self.blocks.len() - 2) as f64;
                }
            }
        }
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] += MIN_SCATTER * MIN_SCATTER;
        }
        let counts = 1.0 / before as f64 + 1.0 / (self.blocks.len() - before) as f64;
        solve(covariance, step).map_or(0.0, |solved| {
            solved.iter().zip(&step).map(|(a, b)| a * b).sum::<f64>() / counts
        })
    }
}

#[cfg(test)]
mod tests {
    use super::GroundChange;

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
            if change.take(time, &[2.0 + step + 0.3 * noise(), 20.0 + 0.3 * noise()]) {
                called.push(time);
            }
        }
        assert!(
            called.len() == 1 && called[0] > 15.0 && called[0] < 17.0,
            "{called:?}"
        );
    }
}
