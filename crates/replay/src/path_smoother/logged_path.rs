//! The way of the rims and the positions of a log, as intervals for [`smooth_ratio`].

use std::collections::VecDeque;

use grouser_real::Real;
use grouser_slip::filter::{FilterSettings, RimPath};
use grouser_slip::{BodyMotion, Measured, Measurement, Sample, Slip};

use super::{INTERVAL_S, Interval, Position, Ratio, smooth_ratio};
use crate::moment::{Moment, seconds};

/// Positions are used at most this often, s: errors of faster ones are correlated.
const POSITION_PERIOD_S: f64 = 0.1;
/// Fewer positions than this are not smoothed.
const MIN_POSITIONS: usize = 10;
/// The course in the reference's frame is fitted over this many standard deviations of a position, m, and at least this
/// time, s: its error is then below 0.02 rad.
const COURSE_SIGMAS: f64 = 100.0;
const COURSE_TIME_S: f64 = 4.0;
/// The ratio of a wheel's slip to that of the rims is scaled where the filter's own is above this.
const MIN_RATIO: f64 = 0.2;
/// Smoothed and filtered slips that are further apart than this many of the filter's sigmas are doubted.
const MAX_APART_SIGMA: f64 = 3.0;

/// Way of the rims and positions over the log at hand.
#[derive(Debug)]
pub(crate) struct LoggedPath {
    /// Times, ns, and the rims' way up to then.
    times: Vec<i64>,
    paths: Vec<RimPath>,
    /// Positions with the time at which they were taken, ns.
    positions: Vec<(i64, [f64; 2])>,
    /// Are they sums of displacements?
    is_summed: bool,
    forces: Vec<(i64, f64)>,
}

impl LoggedPath {
    /// The path of a log; `None` without enough positions. `latency_ns` is the delay of a position behind the motion.
    pub(crate) fn of(
        moments: &VecDeque<Moment>,
        samples: &[Sample],
        latency_ns: i64,
    ) -> Option<Self> {
        // between two readings of the rims their way is led on in steps
        let known = || {
            let read = moments.iter().filter(|moment| moment.read != 0);
            read.filter_map(|moment| Some((moment.time_ns, moment.rim_path?)))
        };
        let mut path = Self {
            times: known().map(|(time, _)| time).collect(),
            paths: known().map(|(_, path)| path).collect(),
            positions: Vec::new(),
            is_summed: false,
            forces: Vec::new(),
        };
        path.times.first()?;
        path.take_positions(samples, latency_ns);
        let forces = samples.iter().filter_map(|sample| {
            let Measurement::Acceleration { forward, .. } = sample.measurement else {
                return None;
            };
            Some((sample.time_ns, forward))
        });
        path.forces = forces.collect();
        (path.positions.len() >= MIN_POSITIONS).then_some(path)
    }

    /// The rims' way at a time.
    fn at(&self, time_ns: i64) -> RimPath {
        let next = self.times.partition_point(|time| *time <= time_ns);
        let (Some(before), Some(after)) = (next.checked_sub(1), self.paths.get(next)) else {
            return self.paths[next.min(self.paths.len() - 1)];
        };
        let first = self.paths[before];
        let share =
            seconds(self.times[before], time_ns) / seconds(self.times[before], self.times[next]);
        let between = |from: f64, to: f64| from + share * (to - from);
        RimPath {
            x: between(first.x, after.x),
            y: between(first.y, after.y),
            turned: between(first.turned, after.turned),
            way: between(first.way, after.way),
        }
    }

    fn take_positions(&mut self, samples: &[Sample], latency_ns: i64) {
        let mut summed = [0.0; 3];
        let mut last_turned = None;
        let first_ns = self.times[0];
        let is_place = |sample: &Sample| matches!(sample.measurement, Measurement::Position { .. });
        // the displacements beside places are made of them, and the errors of each two in a row are opposite
        let has_places = samples.iter().any(is_place);
        for sample in samples {
            let time_ns = sample.time_ns.saturating_sub(latency_ns);
            let place = match sample.measurement {
                Measurement::Pose { x, y, .. } | Measurement::Position { x, y } => [x, y],
                Measurement::Displacement {
                    forward,
                    left,
                    turn,
                } if !has_places => {
                    self.is_summed = true;
                    let turned = self.at(time_ns).turned;
                    let before = last_turned.replace(turned).unwrap_or(turned);
                    let turn = turn.unwrap_or(turned - before);
                    let (sin, cos) = Real::sin_cos(summed[2] + 0.5 * turn);
                    summed[0] += cos * forward - sin * left;
                    summed[1] += sin * forward + cos * left;
                    summed[2] += turn;
                    [summed[0], summed[1]]
                }
                _ => continue,
            };
            let is_due = self.positions.last().is_none_or(|(last, before)| {
                let repeats = place[0].to_bits() == before[0].to_bits()
                    && place[1].to_bits() == before[1].to_bits();
                !repeats && seconds(*last, time_ns) >= POSITION_PERIOD_S - 1e-3
            });
            if is_due && time_ns >= first_ns && place.iter().all(|part| part.is_finite()) {
                self.positions.push((time_ns, place));
            }
        }
    }

    /// Times at which the intervals begin, ns, with the end of the last.
    fn grid(&self) -> Vec<i64> {
        let mut grid = vec![self.times[0]];
        for &time in &self.times {
            if seconds(grid[grid.len() - 1], time) >= INTERVAL_S - 1e-4 {
                grid.push(time);
            }
        }
        grid
    }

    /// The rotation from the frame of the rims' way to that of the positions about a time, cosine and sine, by the positions
    /// around it: heading errors and sideways drift change slowly.
    fn rotations(&self, sigma: f64) -> Vec<(i64, [f64; 2])> {
        let mut sums = vec![[0.0; 3]];
        for pair in self.positions.windows(2) {
            let (from, to) = (self.at(pair[0].0), self.at(pair[1].0));
            let (a, b) = (
                [to.x - from.x, to.y - from.y],
                [pair[1].1[0] - pair[0].1[0], pair[1].1[1] - pair[0].1[1]],
            );
            let [dot, cross, way] = sums[sums.len() - 1];
            let moved = (to.way - from.way).abs();
            sums.push([
                dot + a[0] * b[0] + a[1] * b[1],
                cross + a[0] * b[1] - a[1] * b[0],
                way + moved,
            ]);
        }
        let last = self.positions.len() - 1;
        let mut rotations = Vec::with_capacity(self.positions.len());
        for (index, &(time, _)) in self.positions.iter().enumerate() {
            let (mut low, mut high) = (index, index);
            let enough = |low: usize, high: usize| {
                sums[high][2] - sums[low][2] >= COURSE_SIGMAS * sigma
                    && seconds(self.positions[low].0, self.positions[high].0) >= COURSE_TIME_S
            };
            while !enough(low, high) && (low > 0 || high < last) {
                low = low.saturating_sub(1);
                high = (high + 1).min(last);
            }
            let [dot, cross] = [0, 1].map(|i| sums[high][i] - sums[low][i]);
            let length = Real::hypot(dot, cross);
            if length > 0.0 {
                rotations.push((time, [dot / length, cross / length]));
            }
        }
        rotations
    }

    /// Smooths the moments by the whole log.
    pub(crate) fn smooth<'a>(
        &self,
        moments: impl Iterator<Item = &'a mut Moment>,
        settings: &FilterSettings,
    ) {
        let grid = self.grid();
        let (intervals, positions) = self.intervals(&grid, settings.position_sigma);
        if intervals.is_empty() {
            return;
        }
        let start = 1.0 - settings.slip.mean;
        let ratios = smooth_ratio(&intervals, &positions, start, settings.position_sigma);
        for moment in moments {
            join(moment, ratio_at(&grid, &ratios, moment.time_ns));
        }
    }

    fn intervals(&self, grid: &[i64], sigma: f64) -> (Vec<Interval>, Vec<Position>) {
        let rotations = self.rotations(sigma);
        let mut intervals: Vec<Interval> = Vec::with_capacity(grid.len());
        let mut course = [1.0, 0.0];
        let mut next_force = 0;
        for (k, pair) in grid.windows(2).enumerate() {
            let (from, to) = (self.at(pair[0]), self.at(pair[1]));
            let nearest = rotations
                .partition_point(|(time, _)| *time <= pair[0])
                .min(rotations.len().saturating_sub(1));
            let [cos, sin] = rotations.get(nearest).map_or([1.0, 0.0], |found| found.1);
            let way = to.way - from.way;
            let (x, y) = (to.x - from.x, to.y - from.y);
            let length = Real::hypot(x, y);
            if length > 1e-9 {
                let sign = way.signum() / length;
                let (x, y) = (sign * x, sign * y);
                course = [cos * x - sin * y, sin * x + cos * y];
            }
            let mut gain = None;
            if k > 0 {
                let middle = |from: i64, to: i64| from + (to - from) / 2;
                let until = middle(pair[0], pair[1]);
                let since = middle(grid[k - 1], pair[0]);
                let (mut sum, mut count) = (0.0, 0.0);
                while let Some(&(time, force)) = self.forces.get(next_force)
                    && time <= until
                {
                    if time > since {
                        sum += force;
                        count += 1.0;
                    }
                    next_force += 1;
                }
                gain = (count > 0.0).then(|| sum / count * seconds(since, until));
            }
            intervals.push(Interval {
                dt: seconds(pair[0], pair[1]),
                way,
                course,
                gain,
            });
        }
        let mut positions = Vec::with_capacity(self.positions.len());
        let mut before = None;
        for &(time, place) in &self.positions {
            let since = before.replace(place).filter(|_| self.is_summed);
            let place = since.map_or(place, |[x, y]| [place[0] - x, place[1] - y]);
            if self.is_summed && since.is_none() {
                continue;
            }
            let interval = grid.partition_point(|begin| *begin <= time) - 1;
            if let Some(end) = grid.get(interval + 1) {
                let share = seconds(grid[interval], time) / seconds(grid[interval], *end);
                positions.push(Position {
                    interval,
                    share,
                    place,
                    is_displacement: self.is_summed,
                });
            }
        }
        (intervals, positions)
    }
}

/// The ratio at a time, linear between the middles of the intervals.
fn ratio_at(grid: &[i64], ratios: &[Ratio], time_ns: i64) -> Ratio {
    let last = ratios.len() - 1;
    let index = grid
        .partition_point(|begin| *begin <= time_ns)
        .saturating_sub(1)
        .min(last);
    let middle = |k: usize| grid[k] + (grid[k + 1] - grid[k]) / 2;
    let other = if time_ns < middle(index) {
        index.saturating_sub(1)
    } else {
        (index + 1).min(last)
    };
    let span = seconds(middle(index), middle(other));
    let share = if span == 0.0 {
        0.0
    } else {
        (seconds(middle(index), time_ns) / span).clamp(0.0, 1.0)
    };
    let (a, b) = (ratios[index], ratios[other]);
    Ratio {
        value: a.value + share * (b.value - a.value),
        variance: a.variance + share * (b.variance - a.variance),
    }
}

/// Puts the smoothed common slip in the place of the filter's: each wheel keeps its own difference from the common one.
fn join(moment: &mut Moment, ratio: Ratio) {
    let Some(common) = moment.common_slip else {
        return;
    };
    let (slip, slope) = if ratio.value <= 1.0 {
        (1.0 - ratio.value, 1.0)
    } else {
        (1.0 / ratio.value - 1.0, 1.0 / (ratio.value * ratio.value))
    };
    // the filter lags: near a jump both differ by more; where they do elsewhere, this model is wrong
    let apart = Real::powi((slip - common.value) / MAX_APART_SIGMA, 2) - common.variance;
    let variance = ratio.variance * slope * slope + apart.max(0.0);
    for wheel in &mut moment.wheels {
        let (Some(before), Some(sigma)) = (wheel.slip, wheel.sigma) else {
            continue;
        };
        let own = before.value() - common.value;
        let own_variance = (sigma * sigma - common.variance).max(0.0);
        wheel.slip = Slip::new((slip + own).clamp(-1.0, 1.0)).ok();
        wheel.sigma = Some((variance + own_variance).sqrt());
    }
    if let Some(motion) = &mut moment.motion {
        scale(motion, ratio, common);
    }
}

/// Scales the speeds to the smoothed slip.
fn scale(motion: &mut BodyMotion, ratio: Ratio, common: Measured) {
    let before = if common.value >= 0.0 {
        1.0 - common.value
    } else {
        1.0 / (1.0 + common.value.max(-0.95))
    };
    if before < MIN_RATIO {
        return;
    }
    for i in 0..2 {
        let rim = motion.velocity[i] / before;
        motion.velocity[i] = rim * ratio.value;
        motion.covariance[i][i] = if i == 0 {
            rim * rim * ratio.variance
        } else {
            motion.covariance[i][i]
        };
    }
}
