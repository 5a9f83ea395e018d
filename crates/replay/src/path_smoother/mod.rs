//! Slip by all positions of a log at once: fixed-interval smoothing of a linear model.
//!
//! The robot's way is the way of its rims times the ratio g = v/u, so that positions are linear in g. g changes by
//! Student-t increments: it is constant for long and jumps at times. Expectation-maximisation turns these into normal
//! increments whose variances are found from all data, which leaves no lag at a jump. Positions have Student-t errors too,
//! so that outliers lose their weight. The accelerometer measures changes of u g beside a bias.

mod linear;
mod logged_path;

pub(crate) use logged_path::LoggedPath;

use linear::{GRID_STATES, LinearSmoother, Measurement};

/// Length of an interval in which slip is constant, s.
pub(crate) const INTERVAL_S: f64 = 0.05;
/// Degrees of freedom of the increments and of the positions' errors.
const INCREMENT_FREEDOM: f64 = 1.0;
const POSITION_FREEDOM: f64 = 4.0;
/// Largest number of rounds of expectation-maximisation, and the change of a ratio v/u below which they end. Ended at five times
/// that change, steady slip still wanders: half as much again of the error at 1 and 3 m/s (`path_smoothing`).
const MAX_ROUNDS: usize = 200;
const SETTLED_CHANGE: f64 = 1e-4;
/// Scale of the increments at the start and the smallest that is learnt, 1/√s.
const START_INCREMENT: f64 = 0.05;
const MIN_INCREMENT: f64 = 0.002;
/// Smallest learnt standard deviations of a position, m, and of a change of speed, m/s.
const MIN_POSITION_SIGMA_M: f64 = 1e-4;
const MIN_GAIN_SIGMA_M_PER_S: f64 = 1e-4;
/// Sideways motion beside the course, as a share of the way, √s; a rover's wander on level sand.
const SIDE_NOISE: f64 = 0.03;
/// Standard deviation of the accelerometer's bias at the start, m/s², and its process noise density, m/s² per √s.
const BIAS_SIGMA: f64 = 0.3;
const BIAS_NOISE: f64 = 0.03;
/// Standard deviation of the ratio v/u at the start.
const RATIO_SIGMA: f64 = 0.3;

/// Indices of the states: place, ratio v/u of the interval at hand and of the one before, bias.
const X: usize = 0;
const Y: usize = 1;
const RATIO: usize = 2;
const BEFORE: usize = 3;
const BIAS: usize = 4;

/// One interval of time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interval {
    /// Length, s.
    pub(crate) dt: f64,
    /// Way of the rims, m.
    pub(crate) way: f64,
    /// Direction of the way in the reference's frame: cosine and sine.
    pub(crate) course: [f64; 2],
    /// Change of speed since the interval before by the accelerometer, m/s, from middle to middle.
    pub(crate) gain: Option<f64>,
}

/// A position, m, and the share of its interval that had passed; by displacements it is the one since the position before, whose
/// errors are no part of it. Of those an interval has one at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub(crate) interval: usize,
    pub(crate) share: f64,
    pub(crate) place: [f64; 2],
    pub(crate) is_displacement: bool,
}

/// The ratio v/u of an interval with its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) value: f64,
    pub(crate) variance: f64,
}

/// Scales and weights that the rounds learn.
struct Learnt {
    /// Variance of an increment, and of each its weight.
    increment: f64,
    weights: Vec<f64>,
    position: f64,
    position_weights: Vec<f64>,
    gain: f64,
    least_gain: f64,
}

/// The variance that errors of the rims' way alone give to the change of a rim speed, m²/s²: what one change has too much the
/// next one has too little. A slip that jumps shows in one change only.
fn rim_roughness(intervals: &[Interval]) -> f64 {
    let speed = |interval: &Interval| interval.way / interval.dt;
    let excess = |pair: &[Interval]| Some(speed(&pair[1]) - speed(&pair[0]) - pair[1].gain?);
    let (mut sum, mut count) = (0.0, 0.0);
    for three in intervals.windows(3) {
        if three.iter().all(|interval| interval.way != 0.0)
            && let (Some(before), Some(after)) = (excess(&three[..2]), excess(&three[1..]))
        {
            sum -= before * after;
            count += 1.0;
        }
    }
    if count > 0.0 {
        (2.0 * sum / count).max(0.0)
    } else {
        0.0
    }
}

/// The ratio v/u of each interval. `sigma` is the standard deviation of a position (m) at the start; positions are in the
/// order of time.
pub(crate) fn smooth_ratio(
    intervals: &[Interval],
    positions: &[Position],
    start: f64,
    sigma: f64,
) -> Vec<Ratio> {
    let least_gain = rim_roughness(intervals).max(MIN_GAIN_SIGMA_M_PER_S * MIN_GAIN_SIGMA_M_PER_S);
    let mut learnt = Learnt {
        increment: START_INCREMENT * START_INCREMENT * INTERVAL_S,
        weights: vec![1.0; intervals.len()],
        position: (sigma * sigma).max(MIN_POSITION_SIGMA_M * MIN_POSITION_SIGMA_M),
        position_weights: vec![1.0; positions.len()],
        gain: least_gain.max(1e-4),
        least_gain,
    };
    let mut ratios = round(intervals, positions, start, &mut learnt);
    for _ in 1..MAX_ROUNDS {
        let next = round(intervals, positions, start, &mut learnt);
        let pairs = next.iter().zip(&ratios);
        let change = pairs.fold(0.0, |most: f64, (a, b)| most.max((a.value - b.value).abs()));
        ratios = next;
        if change < SETTLED_CHANGE {
            break;
        }
    }
    learnt.spread(positions);
    round(intervals, positions, start, &mut learnt)
}

impl Learnt {
    /// Spreads the increments over the time between two positions, either way: where in there a jump lies they hardly show, and the
    /// likeliest place alone is as early or as late as they are apart.
    fn spread(&mut self, positions: &[Position]) {
        let (Some(first), Some(last)) = (positions.first(), positions.last()) else {
            return;
        };
        let apart = (last.interval - first.interval) / (positions.len() - 1).max(1);
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        sums.extend(self.weights.iter().map(|weight| {
            sum += 1.0 / weight;
            sum
        }));
        for (k, weight) in self.weights.iter_mut().enumerate() {
            let (from, to) = (k.saturating_sub(apart), (k + apart + 1).min(sums.len() - 1));
            *weight = (to - from) as f64 / (sums[to] - sums[from]);
        }
    }
}

/// One round: smooths by the present scales and weights, and learns the next.
fn round(
    intervals: &[Interval],
    positions: &[Position],
    start: f64,
    learnt: &mut Learnt,
) -> Vec<Ratio> {
    let first = positions
        .first()
        .filter(|first| !first.is_displacement)
        .map_or([0.0; 2], |first| first.place);
    let mut mean = [first[0], first[1], start, start, 0.0];
    let known = [1.0, 1.0, RATIO_SIGMA, RATIO_SIGMA, BIAS_SIGMA];
    let mut covariance = [[0.0; GRID_STATES]; GRID_STATES];
    for (i, sigma) in known.into_iter().enumerate() {
        covariance[i][i] = sigma * sigma;
    }
    covariance[RATIO][BEFORE] = RATIO_SIGMA * RATIO_SIGMA;
    covariance[BEFORE][RATIO] = RATIO_SIGMA * RATIO_SIGMA;
    let mut smoother = LinearSmoother::with_capacity(intervals.len());
    let mut next = 0;
    let mut last: Option<&Interval> = None;
    // the share of the last interval behind its displacement, from which places count
    let mut begun = None;
    for (k, interval) in intervals.iter().enumerate() {
        if let Some(last) = last {
            let [cos, sin] = last.course;
            let way = last.way * begun.unwrap_or(1.0);
            let side = SIDE_NOISE * SIDE_NOISE * last.way * last.way / last.dt;
            smoother.predict(
                begun.take().map_or(&[][..], |_| &[X, Y]),
                &[(X, RATIO, cos * way), (Y, RATIO, sin * way)],
                (BEFORE, RATIO),
                &[
                    (X, X, side * sin * sin),
                    (Y, Y, side * cos * cos),
                    (X, Y, -side * sin * cos),
                    (RATIO, RATIO, learnt.increment / learnt.weights[k]),
                    (BIAS, BIAS, BIAS_NOISE * BIAS_NOISE * last.dt),
                ],
                (&mut mean, &mut covariance),
            );
        }
        let mut rows = Vec::new();
        if let (Some(gain), Some(last)) = (interval.gain, last) {
            let middle = 0.5 * (interval.dt + last.dt);
            rows.push(Measurement {
                jacobian: [
                    (RATIO, interval.way / interval.dt),
                    (BEFORE, -last.way / last.dt),
                    (BIAS, middle),
                ],
                value: gain,
                variance: learnt.gain,
            });
        }
        while let Some(position) = positions.get(next).filter(|one| one.interval == k) {
            for (axis, course) in interval.course.into_iter().enumerate() {
                let passed = position.share * interval.way * course;
                rows.push(Measurement {
                    jacobian: [(axis, 1.0), (RATIO, passed), (BIAS, 0.0)],
                    value: position.place[axis],
                    variance: learnt.position / learnt.position_weights[next],
                });
            }
            begun = position.is_displacement.then_some(1.0 - position.share);
            next += 1;
        }
        smoother.update(rows, (&mut mean, &mut covariance));
        last = Some(interval);
    }
    let smoothed = smoother.smoothed();
    learn(intervals, positions, &smoothed, learnt);
    smoothed
        .iter()
        .map(|(mean, covariance)| Ratio {
            value: mean[RATIO],
            variance: covariance[RATIO][RATIO].max(0.0),
        })
        .collect()
}

/// Learns weights and scales from the smoothed states: expectations of squares include the states' variances.
fn learn(
    intervals: &[Interval],
    positions: &[Position],
    smoothed: &[linear::State],
    learnt: &mut Learnt,
) {
    let expect = |(mean, covariance): &linear::State, row: [(usize, f64); 3], value: f64| {
        let mut residual = value;
        let mut variance = 0.0;
        for (i, a) in row {
            residual -= a * mean[i];
            for (j, b) in row {
                variance += a * b * covariance[i][j];
            }
        }
        residual * residual + variance.max(0.0)
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    let (mut gains, mut gain_count) = (0.0, 0.0);
    for (k, state) in smoothed.iter().enumerate().skip(1) {
        let change = expect(state, [(RATIO, 1.0), (BEFORE, -1.0), (BIAS, 0.0)], 0.0);
        learnt.weights[k] =
            (INCREMENT_FREEDOM + 1.0) / (INCREMENT_FREEDOM + change / learnt.increment);
        sum += learnt.weights[k] * change;
        weights += learnt.weights[k];
        let (interval, last) = (&intervals[k], &intervals[k - 1]);
        // rims that stand have no errors
        if let Some(gain) = interval.gain
            && (interval.way != 0.0 || last.way != 0.0)
        {
            let row = [
                (RATIO, interval.way / interval.dt),
                (BEFORE, -last.way / last.dt),
                (BIAS, 0.5 * (interval.dt + last.dt)),
            ];
            gains += expect(state, row, gain);
            gain_count += 1.0;
        }
    }
    let floor = MIN_INCREMENT * MIN_INCREMENT * INTERVAL_S;
    // over the sum of the weights, not the number: the same limit in far fewer rounds (Kent, Tyler and Vardi 1994)
    if weights > 0.0 {
        learnt.increment = (sum / weights).max(floor);
    }
    if gain_count > 0.0 {
        learnt.gain = (gains / gain_count).max(learnt.least_gain);
    }
    let mut squares = 0.0;
    for (position, weight) in positions.iter().zip(&mut learnt.position_weights) {
        let interval = &intervals[position.interval];
        let state = &smoothed[position.interval];
        let mut square = 0.0;
        for (axis, course) in interval.course.into_iter().enumerate() {
            let row = [
                (axis, 1.0),
                (RATIO, position.share * interval.way * course),
                (BIAS, 0.0),
            ];
            square += expect(state, row, position.place[axis]);
        }
        *weight = (POSITION_FREEDOM + 2.0) / (POSITION_FREEDOM + square / learnt.position);
        squares += *weight * square;
    }
    if !positions.is_empty() {
        let variance = squares / (2.0 * positions.len() as f64);
        learnt.position = variance.max(MIN_POSITION_SIGMA_M * MIN_POSITION_SIGMA_M);
    }
}
