//! The delay at which what the reference measured agrees best with wheels and gyro.
//!
//! In a block of a few seconds the reference's ways are y = a f(δ) + e, where f is the way of the rims between the same
//! stamps less the delay δ, and 1 − a the slip, constant in the block; its turns are y = a f(δ) + b t + e of the turn by the
//! gyro, with the gyro's bias −b. a and b have priors, and the variance of e is each block's own (inverse gamma): a block in
//! which slip jumps says little. Where the robot keeps its speed and its turn rate, every δ fits alike.
//!
//! A wheel pulls by its slip: a robot that speeds up by u̇ slips by c |u| u̇ / u more, on the ground's own c, which delays the
//! robot against its rims by c |u|. A delay is the same at every speed. c is unknown and the same in the whole log.

use grouser_real::{Real, median};

use super::steps::HALF_SPEED_S;
use super::track::Track;
use super::tracks::Passed;

/// Delays are looked for in the steps of [`Delays`], and then about the likeliest in smaller ones.
const FINE_STEP_S: f64 = 0.005;
/// A multiple of the larger steps, so that both meet.
const FINE_RANGE_S: f64 = 0.05;
/// Slip is constant over this time, s, or this number of readings if that takes longer.
const BLOCK_S: f64 = 4.0;
const MIN_BLOCK: usize = 6;
/// A log of fewer blocks is too short.
const MIN_BLOCKS: usize = 4;
/// The variance of a block is that of the log's median block, as if from this number of readings more.
const VARIANCE_PRIOR_COUNT: f64 = 4.0;
/// Smallest variance of a reading, m² or rad²: 0.3 mm or mrad.
const MIN_VARIANCE: f64 = 1e-7;
/// Standard deviation of c, and the step and the number of its trial values from 0, s²/m. c = 1/(g κ), where κ, the gain of pull over weight by slip, is 10 and
/// more for rubber on asphalt and 1 to 2 on loose sand.
const LAG_SIGMA_S2_PER_M: f64 = 0.05;
const LAG_STEP_S2_PER_M: f64 = 0.01;
const LAGS: usize = 15;
/// Standard deviation of a gyro's bias, rad/s.
const BIAS_SIGMA_RAD_PER_S: f64 = 0.02;
/// Mean and standard deviation of a: of the share of their way that the rims drive the robot on, and of a gyro's scale.
const WAY_SCALE: (f64, f64) = (0.9, 0.3);
const TURN_SCALE: (f64, f64) = (1.0, 0.02);
/// By how much the log-likelihood of a delay may be less than the greatest, nats: of a possible delay, of a likely one, and in
/// a part of the log that does not contradict it. Half of the square of four, two and three standard deviations (Wilks).
const POSSIBLE_NATS: f64 = 8.0;
const LIKELY_NATS: f64 = 2.0;
const CONTRADICTED_NATS: f64 = 4.5;
/// Delays that are farther apart are not those of one minimum, s.
const MIN_APART_S: f64 = 0.25;
/// Step for derivatives by the delay, s.
const DERIVATIVE_STEP_S: f64 = 0.004;

/// Delays that are looked for, beside what is stated, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delays {
    pub(crate) min_s: f64,
    pub(crate) max_s: f64,
    pub(crate) step_s: f64,
    /// Of a log with more readings some blocks are used.
    pub(crate) max_readings: usize,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Ways of the rims.
    Way,
    /// Turns by the gyro.
    Turn,
}

/// Readings of a few seconds.
#[derive(Clone, Debug)]
pub(crate) struct Block<'a> {
    kind: Kind,
    track: &'a Track,
    passed: Vec<Passed>,
    variance: f64,
}

/// Σ of products of f, y, and of the second regressor h: the gained ½ u |u|, or the time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) ff: f64,
    fh: f64,
    hh: f64,
    pub(crate) fy: f64,
    hy: f64,
    pub(crate) yy: f64,
}

impl Block<'_> {
    /// Readings.
    pub(crate) fn count(&self) -> f64 {
        self.passed.len() as f64
    }

    pub(crate) fn sums(&self, delay_s: f64) -> Sums {
        let mut sums = Sums::default();
        // most readings begin where the one before ended
        let mut near = [0; 3];
        let mut last = (f64::NAN, [f64::NAN; 2]);
        for one in &self.passed {
            let (from_s, to_s) = (one.from_s - delay_s, one.to_s - delay_s);
            let from = if last.0 == from_s {
                last.1
            } else {
                self.regressors(from_s, &mut near)
            };
            let to = self.regressors(to_s, &mut near);
            last = (to_s, to);
            let [f, h] = [to[0] - from[0], to[1] - from[1]];
            let y = one.amount;
            sums.ff += f * f;
            sums.fh += f * h;
            sums.hh += h * h;
            sums.fy += f * y;
            sums.hy += h * y;
            sums.yy += y * y;
        }
        sums
    }

    /// The sum up to a time, and the second regressor: ½ u |u| of the wheels' speed, or the time.
    fn regressors(&self, time_s: f64, near: &mut [usize; 3]) -> [f64; 2] {
        let [here, before, after] = near;
        let second = match self.kind {
            Kind::Way => {
                let way = self.track.at(time_s + HALF_SPEED_S, after)
                    - self.track.at(time_s - HALF_SPEED_S, before);
                let speed = way / (2.0 * HALF_SPEED_S);
                0.5 * speed * speed.abs()
            }
            Kind::Turn => time_s,
        };
        [self.track.at(time_s, here), second]
    }

    /// Sum of squared residuals, with what the priors of a and b add.
    fn squares(&self, sums: &Sums, lag: f64) -> f64 {
        let Sums {
            ff,
            fh,
            hh,
            fy,
            hy,
            yy,
        } = *sums;
        let (ff, fy, yy, (scale, sigma)) = match self.kind {
            Kind::Way => {
                let ff = ff - 2.0 * lag * fh + lag * lag * hh;
                (ff, fy - lag * hy, yy, WAY_SCALE)
            }
            Kind::Turn => {
                let hh = hh + self.variance / (BIAS_SIGMA_RAD_PER_S * BIAS_SIGMA_RAD_PER_S);
                let without = |a: f64, b: f64| a * b / hh;
                let (ff, fy) = (ff - without(fh, fh), fy - without(fh, hy));
                (ff, fy, yy - without(hy, hy), TURN_SCALE)
            }
        };
        let weight = self.variance / (sigma * sigma);
        let (ff, fy) = (ff + weight, fy + weight * scale);
        (yy + weight * scale * scale - fy * fy / ff).max(0.0)
    }

    /// − log-likelihood.
    fn cost(&self, sums: &Sums, lag: f64) -> f64 {
        let count = self.passed.len() as f64 + VARIANCE_PRIOR_COUNT;
        let share = self.squares(sums, lag) / (VARIANCE_PRIOR_COUNT * self.variance);
        0.5 * count * Real::ln(1.0 + share)
    }
}

/// What a log says of the delay, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fitted {
    /// The likeliest.
    pub(super) delay_s: f64,
    /// How far the likely ones are from it.
    pub(super) half_width_s: f64,
    /// The least and the greatest that are possible.
    pub(super) possible_s: [f64; 2],
    /// Do halves of the log, or wheels and gyro, contradict it?
    pub(super) is_contradicted: bool,
    /// Does one that is far from it fit as well, as of a drive that repeats itself?
    pub(super) is_ambiguous: bool,
    /// Is it the first or the last that was looked for? Then a better one may lie beyond.
    pub(super) is_at_end: bool,
}

/// Tracks with what the reference measured beside each; `stated_s` is the delay that is counted from. `None` of a log that is
/// too short.
pub(super) fn fit<'a>(
    pairs: impl Iterator<Item = (Kind, &'a Track, &'a [Passed])>,
    stated_s: f64,
    delays: Delays,
) -> Option<Fitted> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    for (kind, track, passed) in pairs {
        blocks.extend(blocks_of(kind, track, passed, stated_s, delays));
    }
    let readings: usize = blocks.iter().map(|block| block.passed.len()).sum();
    let every = readings.div_ceil(delays.max_readings).max(1);
    let mut blocks: Vec<Block<'_>> = blocks.into_iter().step_by(every).collect();
    if blocks.len() < MIN_BLOCKS {
        return None;
    }
    let everywhere = range(delays.min_s, delays.max_s, delays.step_s);
    set_variances(&mut blocks, stated_s);
    let sums = sums_of(&blocks, &everywhere, stated_s);
    let first = Costs::new(&blocks, &sums, &everywhere).least(|_| true);
    set_variances(&mut blocks, stated_s + first.delay_s);
    let mut costs = Costs::new(&blocks, &sums, &everywhere);
    let coarse = costs.least(|_| true).delay_s;
    let near = range(
        (coarse - FINE_RANGE_S).max(delays.min_s),
        (coarse + FINE_RANGE_S).min(delays.max_s),
        FINE_STEP_S,
    );
    costs.add(Costs::new(
        &blocks,
        &sums_of(&blocks, &near, stated_s),
        &near,
    ));
    let least = costs.least(|_| true);
    let dispersion = dispersion(&blocks, stated_s + least.delay_s, least.lag);
    let within = |limit: f64| {
        let limit = least.cost + limit * dispersion;
        let all = (0..costs.delays_s.len()).map(|delay| costs.at(delay, |_| true));
        let possible = all.filter(|trial| trial.cost <= limit);
        possible.fold([least.delay_s; 2], |[low, high], trial| {
            [low.min(trial.delay_s), high.max(trial.delay_s)]
        })
    };
    let mut begun: Vec<f64> = blocks.iter().map(|block| block.passed[0].from_s).collect();
    let middle = median(&mut begun).unwrap_or(f64::NAN);
    let parts: [&dyn Fn(&Block<'_>) -> bool; 4] = [
        &|block| block.passed[0].from_s < middle,
        &|block| block.passed[0].from_s >= middle,
        &|block| block.kind == Kind::Way,
        &|block| block.kind == Kind::Turn,
    ];
    let is_contradicted = parts.iter().any(|part| {
        let of = |block: usize| part(&blocks[block]);
        let here = costs.at(least.index, of).cost;
        here > costs.least(of).cost + CONTRADICTED_NATS * dispersion
    });
    let [low, high] = within(LIKELY_NATS);
    Some(Fitted {
        delay_s: least.delay_s,
        half_width_s: (least.delay_s - low).max(high - least.delay_s) + 0.5 * FINE_STEP_S,
        possible_s: within(POSSIBLE_NATS),
        is_contradicted,
        is_ambiguous: costs.is_ambiguous(everywhere.len(), &least, POSSIBLE_NATS * dispersion),
        is_at_end: least.delay_s < delays.min_s + delays.step_s
            || least.delay_s > delays.max_s - delays.step_s,
    })
}

/// From one number to another in steps.
pub(crate) fn range(from: f64, to: f64, step: f64) -> Vec<f64> {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some tens of steps"
    )]
    let count = ((to - from) / step).round() as usize;
    (0..=count).map(|k| from + k as f64 * step).collect()
}

/// The blocks of a track: of the readings that it covers at every delay.
pub(crate) fn blocks_of<'a>(
    kind: Kind,
    track: &'a Track,
    passed: &[Passed],
    stated_s: f64,
    delays: Delays,
) -> Vec<Block<'a>> {
    let margin_s = delays.step_s + HALF_SPEED_S;
    let is_covered = |one: &&Passed| {
        let from_s = one.from_s - stated_s - delays.max_s - margin_s;
        let to_s = one.to_s - stated_s - delays.min_s + margin_s;
        track.is_known(from_s, to_s) && one.amount.is_finite()
    };
    let covered: Vec<Passed> = passed.iter().filter(is_covered).copied().collect();
    let mut rest = covered.as_slice();
    let mut blocks = Vec::new();
    while let Some(first) = rest.first() {
        let in_time = rest.partition_point(|one| one.to_s < first.from_s + BLOCK_S);
        let count = in_time.max(MIN_BLOCK);
        if count > rest.len() {
            break;
        }
        let (block, next) = rest.split_at(count);
        blocks.push(Block {
            kind,
            track,
            passed: block.to_vec(),
            variance: MIN_VARIANCE,
        });
        rest = next;
    }
    blocks
}

/// Every block's variance: the median block's of its kind.
fn set_variances(blocks: &mut [Block<'_>], delay_s: f64) {
    for kind in [Kind::Way, Kind::Turn] {
        let of = |block: &Block<'_>| {
            block.squares(&block.sums(delay_s), 0.0) / block.passed.len() as f64
        };
        let same = blocks.iter().filter(|block| block.kind == kind);
        let mut all: Vec<f64> = same.map(of).collect();
        let variance = median(&mut all).unwrap_or(0.0).max(MIN_VARIANCE);
        for block in blocks.iter_mut().filter(|block| block.kind == kind) {
            block.variance = variance;
        }
    }
}

/// The sums of each block at each delay.
fn sums_of(blocks: &[Block<'_>], delays_s: &[f64], stated_s: f64) -> Vec<Vec<Sums>> {
    let of = |block: &Block<'_>| {
        let delays = delays_s.iter();
        delays.map(|delay| block.sums(stated_s + delay)).collect()
    };
    blocks.iter().map(of).collect()
}

/// Costs of each block at each delay and each lag.
struct Costs {
    delays_s: Vec<f64>,
    of_blocks: Vec<Vec<[f64; LAGS]>>,
}

/// A delay with its likeliest lag.
#[derive(Clone, Copy, Debug)]
struct Trial {
    index: usize,
    delay_s: f64,
    lag: f64,
    cost: f64,
}

impl Costs {
    fn new(blocks: &[Block<'_>], sums: &[Vec<Sums>], delays_s: &[f64]) -> Self {
        let one = |(block, sums): (&Block<'_>, &Vec<Sums>)| {
            let at = |sums: &Sums| {
                std::array::from_fn(|lag| block.cost(sums, lag as f64 * LAG_STEP_S2_PER_M))
            };
            sums.iter().map(at).collect()
        };
        Self {
            delays_s: delays_s.to_vec(),
            of_blocks: blocks.iter().zip(sums).map(one).collect(),
        }
    }

    /// Adds other delays of the same blocks.
    fn add(&mut self, others: Self) {
        self.delays_s.extend(others.delays_s);
        for (costs, others) in self.of_blocks.iter_mut().zip(others.of_blocks) {
            costs.extend(others);
        }
    }

    /// Of some blocks at a delay.
    fn at(&self, index: usize, of: impl Fn(usize) -> bool) -> Trial {
        let mut totals: [f64; LAGS] = std::array::from_fn(|lag| {
            let lag = lag as f64 * LAG_STEP_S2_PER_M;
            0.5 * lag * lag / (LAG_SIGMA_S2_PER_M * LAG_SIGMA_S2_PER_M)
        });
        let blocks = self.of_blocks.iter().enumerate();
        for (_, costs) in blocks.filter(|(block, _)| of(*block)) {
            for (total, cost) in totals.iter_mut().zip(costs[index]) {
                *total += cost;
            }
        }
        let trials = totals.into_iter().enumerate();
        let (lag, cost) = trials.fold((0, f64::INFINITY), |least, trial| {
            if trial.1 < least.1 { trial } else { least }
        });
        Trial {
            index,
            delay_s: self.delays_s[index],
            lag: lag as f64 * LAG_STEP_S2_PER_M,
            cost,
        }
    }

    /// Does one of the first `count` delays, which are in equal steps, far from the likeliest cost as little, but for `nats`? Its own
    /// least is that of the parabola through its neighbours.
    fn is_ambiguous(&self, count: usize, least: &Trial, nats: f64) -> bool {
        let costs: Vec<f64> = (0..count)
            .map(|index| self.at(index, |_| true).cost)
            .collect();
        costs
            .windows(3)
            .zip(&self.delays_s[1..])
            .any(|(costs, delay_s)| {
                let (slope, curvature) =
                    (costs[2] - costs[0], costs[2] - 2.0 * costs[1] + costs[0]);
                let is_least = costs[1] <= costs[0].min(costs[2]);
                let is_far = (delay_s - least.delay_s).abs() > MIN_APART_S;
                is_least
                    && is_far
                    && costs[1] - slope * slope / (8.0 * curvature) < least.cost + nats
            })
    }

    /// The likeliest delay of some blocks.
    fn least(&self, of: impl Fn(usize) -> bool + Copy) -> Trial {
        (1..self.delays_s.len()).fold(self.at(0, of), |least, index| {
            let trial = self.at(index, of);
            if trial.cost < least.cost {
                trial
            } else {
                least
            }
        })
    }
}

/// How much more the blocks scatter than their likelihoods say: the variance of their derivatives over the curvature, at least 1.
fn dispersion(blocks: &[Block<'_>], delay_s: f64, lag: f64) -> f64 {
    let (mut scatter, mut curvature) = (0.0, 0.0);
    for block in blocks {
        let at = |step: f64| block.cost(&block.sums(delay_s + step * DERIVATIVE_STEP_S), lag);
        let (less, here, more) = (at(-1.0), at(0.0), at(1.0));
        let slope = 0.5 * (more - less);
        scatter += slope * slope;
        curvature += more - 2.0 * here + less;
    }
    if curvature > 0.0 {
        (scatter / curvature).max(1.0)
    } else {
        f64::INFINITY
    }
}
