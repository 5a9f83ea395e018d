//! One hypothesis about how fast slip changes: a Kalman filter over place, heading, speed and slip.

use grouser_real::{Real, wrap_angle};

use super::course::Course;
use super::covariance::is_covariance;
use super::step::{Rim, Step, TurnError};

/// Number of states.
pub(super) const STATES: usize = 8;
/// Place in the reference's frame, m.
pub(super) const X: usize = 0;
/// Its second coordinate, m.
pub(super) const Y: usize = 1;
/// Heading in the reference's frame, rad.
pub(super) const HEADING: usize = 2;
/// Speed along the direction in which the rims run, m/s.
pub(super) const SPEED: usize = 3;
/// Common slip of the powered wheels.
pub(super) const SLIP: usize = 4;
/// Sideways speed over forward speed.
pub(super) const DRIFT: usize = 5;
/// Bias of the accelerometer along the direction of travel, m/s².
const BIAS: usize = 6;
/// Error of the turn rate, rad/s: what is left of the gyro's bias, or the wheels' slip where they alone tell the turn.
pub(super) const TURN_ERROR: usize = 7;

/// Prior share of outliers among the readings of a reference; the cells of `known_truth` draw half of it.
const OUTLIER_SHARE: f64 = 0.02;
/// Above this probability of being no outlier the other case is left out.
const NO_OUTLIER: f64 = 0.9999;
/// Standard deviation of an outlier over that of a good reading.
const OUTLIER_FACTOR: f64 = 30.0;
/// Process noise of the sideways motion beside the modelled drift, as a share of the speed, √s: a rover's wander on level sand.
const SIDE_NOISE: f64 = 0.03;
/// Process noise density of the drift, 1/√s, and its time constant, s: slopes are crossed for seconds.
const DRIFT_NOISE: f64 = 0.03;
const DRIFT_MEMORY_S: f64 = 5.0;
/// Process noise density of the heading beside the error of the turn rate, rad/√s.
const HEADING_NOISE: f64 = 1e-3;
/// Least share of the robot's speed in that of its rims by which a change of it, or its turn, is one of theirs.
pub(crate) const MIN_RIM_SHARE: f64 = 0.1;
/// Below the first process noise slip hardly changes within a window of the rims, above the second it may change at once, 1/√s. Set
/// by logs of starts and stops, of jumps of slip (`known_truth`), and by a skid-steered robot's starts on a slope of sand.
const STEADY_SLIP_NOISE: f64 = 0.025;
const SUDDEN_SLIP_NOISE: f64 = 0.05;
/// Slip changes with the ground under the rims: the process noise is in full from this rim speed on, m/s, and none at rest. Twice
/// that makes errors on random logs 0.4 % smaller, and those at 0.1 m/s depend on it then (`known_truth`).
const FULL_NOISE_RIM_M_PER_S: f64 = 0.05;
/// Slip lies within ±1, but for rims that run apart.
pub(super) const MAX_SLIP: f64 = 1.0;
/// Slip hardly changes by more than this at once.
const MAX_PASSED_SLIP: f64 = 0.5;

/// What has passed since a reading was taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Since {
    /// s.
    pub(super) time_s: f64,
    /// Way of the rims, in the reference's frame, m.
    pub(super) way: [f64; 2],
}

impl Since {
    /// A reading of the present.
    pub(super) const NOW: Self = Self {
        time_s: 0.0,
        way: [0.0; 2],
    };
}

/// One hypothesis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    pub(super) mean: [f64; STATES],
    pub(super) covariance: [[f64; STATES]; STATES],
    /// Process noise density of slip, 1/√s.
    slip_noise: f64,
    /// Process noise density of the accelerometer's bias, m/s² per √s.
    bias_noise: f64,
    /// The greatest slip of the rims together.
    max_slip: f64,
}

impl Model {
    pub(super) const fn new(slip_noise: f64, bias_noise: f64) -> Self {
        Self {
            mean: [0.0; STATES],
            covariance: [[0.0; STATES]; STATES],
            slip_noise,
            bias_noise,
            max_slip: MAX_SLIP,
        }
    }

    /// Starts at a place, with the rims running at `rim` (m/s).
    pub(super) fn start(
        &mut self,
        place: [f64; 2],
        heading: f64,
        [position_sigma, heading_sigma, turn_sigma]: [f64; 3],
        rim: f64,
        slip: [f64; 2],
    ) {
        self.mean = [
            place[0],
            place[1],
            heading,
            rim * (1.0 - slip[0]),
            slip[0],
            0.0,
            0.0,
            0.0,
        ];
        self.covariance = [[0.0; STATES]; STATES];
        let speed = rim.abs() * slip[1] + 0.01;
        let place = position_sigma;
        let sigmas = [
            place,
            place,
            heading_sigma,
            speed,
            slip[1],
            0.05,
            0.3,
            turn_sigma,
        ];
        for (i, sigma) in sigmas.into_iter().enumerate() {
            self.covariance[i][i] = sigma * sigma;
        }
    }

    /// Propagates the covariance by x_i ← x_i + slope x_j.
    fn propagate(&mut self, i: usize, j: usize, slope: f64) {
        let row = self.covariance[j];
        for (slot, value) in self.covariance[i].iter_mut().zip(row) {
            *slot += slope * value;
        }
        for row in &mut self.covariance {
            row[i] += slope * row[j];
        }
    }

    /// Predicts over one step.
    pub(super) fn predict(&mut self, step: &Step) {
        let dt = step.dt;
        self.max_slip = step.max_slip;
        self.clamp_slip();
        let [.., slip, drift, bias, _] = self.mean;
        let turn = self.predict_turn_error(step);
        let turn = match step.curvature {
            Some(curvature) => turn - step.turn + self.predict_curve(step, curvature),
            None => turn,
        };
        let (sin, cos) = Real::sin_cos(self.mean[HEADING] + step.direction + 0.5 * turn);
        self.mean[HEADING] += turn;
        self.propagate(HEADING, TURN_ERROR, -dt);
        self.covariance[HEADING][HEADING] += HEADING_NOISE * HEADING_NOISE * dt;
        let way;
        if let Some((force, noise)) = step.acceleration {
            let speed = self.mean[SPEED];
            way = (speed + 0.5 * (force - bias) * dt) * dt;
            self.mean[SPEED] += (force - bias) * dt;
            self.propagate(X, SPEED, cos * dt);
            self.propagate(Y, SPEED, sin * dt);
            self.propagate(SPEED, BIAS, -dt);
            self.covariance[SPEED][SPEED] += noise * noise * dt;
        } else {
            // The way by rim and slip is an exact sum of ticks; no speed is in between.
            let (share, slope) = rim_share(slip);
            way = step.rim_way * share;
            let slope = step.rim_way * slope;
            self.propagate(X, SLIP, cos * slope);
            self.propagate(Y, SLIP, sin * slope);
        }
        let across = drift * way;
        let (east, north) = (cos * way - sin * across, sin * way + cos * across);
        self.mean[X] += east;
        self.mean[Y] += north;
        self.propagate(X, HEADING, -north);
        self.propagate(Y, HEADING, east);
        self.propagate(X, DRIFT, -sin * way);
        self.propagate(Y, DRIFT, cos * way);
        let side = if dt > 0.0 {
            SIDE_NOISE * SIDE_NOISE * way * way / dt
        } else {
            0.0
        };
        self.covariance[X][X] += side * sin * sin;
        self.covariance[Y][Y] += side * cos * cos;
        self.covariance[X][Y] -= side * sin * cos;
        self.covariance[Y][X] -= side * sin * cos;
        let kept = 1.0 - dt / DRIFT_MEMORY_S;
        self.mean[DRIFT] *= kept;
        for i in 0..STATES {
            self.covariance[i][DRIFT] *= kept;
            self.covariance[DRIFT][i] *= kept;
        }
        self.covariance[DRIFT][DRIFT] += DRIFT_NOISE * DRIFT_NOISE * dt;
        self.covariance[BIAS][BIAS] += self.bias_noise * self.bias_noise * dt;
        // rims at rest do not meet other ground
        let rolls = (step.rim_way.abs() / FULL_NOISE_RIM_M_PER_S).min(dt);
        self.covariance[SLIP][SLIP] += self.slip_noise * self.slip_noise * rolls;
    }

    /// The turn of a robot that turns as it is steered: by the way that this model has it on.
    fn predict_curve(&mut self, step: &Step, curvature: f64) -> f64 {
        if step.acceleration.is_some() {
            self.propagate(HEADING, SPEED, curvature * step.dt);
            curvature * self.mean[SPEED] * step.dt
        } else {
            let (share, slope) = rim_share(self.mean[SLIP]);
            self.propagate(HEADING, SLIP, curvature * step.rim_way * slope);
            curvature * step.rim_way * share
        }
    }

    /// Another sensor measures the turn rate now, with an error of its own.
    pub(super) fn restart_turn_error(&mut self, sigma: f64) {
        self.reset(TURN_ERROR, 0.0, sigma);
    }

    /// The heading is another than was believed, and the error of the turn rate may be.
    pub(super) fn restart_heading(&mut self, heading: f64, sigma: f64, turn_sigma: f64) {
        let turned = wrap_angle(heading - self.mean[HEADING]);
        self.reset(HEADING, self.mean[HEADING] + turned, sigma);
        self.reset(TURN_ERROR, self.mean[TURN_ERROR], turn_sigma);
    }

    /// Slip and speed are others than were believed.
    pub(super) fn restart_slip(&mut self, slip: [f64; 2], speed: [f64; 2]) {
        self.reset(SLIP, slip[0], slip[1]);
        self.reset(SPEED, speed[0], speed[1]);
    }

    /// Forgets a state.
    fn reset(&mut self, state: usize, mean: f64, sigma: f64) {
        self.mean[state] = mean;
        for i in 0..STATES {
            self.covariance[i][state] = 0.0;
            self.covariance[state][i] = 0.0;
        }
        self.covariance[state][state] = sigma * sigma;
    }

    /// Predicts the error of the turn rate; returns the turn without it.
    fn predict_turn_error(&mut self, step: &Step) -> f64 {
        let TurnError { sigma, memory, .. } = step.turn_error;
        self.mean[TURN_ERROR] -= step.removed;
        let kept = 1.0 - (step.dt / memory).min(1.0);
        let variance = sigma * sigma;
        let own = self.covariance[TURN_ERROR][TURN_ERROR];
        // who reduces the turn rate may have learnt more of it than the positions tell: that nothing is left of the error
        let known = if own > variance {
            Real::sqrt(variance / own)
        } else {
            1.0
        };
        self.mean[TURN_ERROR] *= kept * known * known;
        for i in 0..STATES {
            self.covariance[i][TURN_ERROR] *= kept * known;
            self.covariance[TURN_ERROR][i] *= kept * known;
        }
        self.covariance[TURN_ERROR][TURN_ERROR] += (1.0 - kept * kept) * variance;
        step.turn - self.mean[TURN_ERROR] * step.dt
    }

    /// Without an accelerometer the speed follows from rim and slip.
    pub(super) fn follow_rim(&mut self, rim: Rim) {
        let (share, slope) = rim_share(self.mean[SLIP]);
        let slope = rim.speed * slope;
        self.mean[SPEED] = rim.speed * share;
        let slips = self.covariance[SLIP].map(|c| slope * c);
        self.covariance[SPEED] = slips;
        for (row, c) in self.covariance.iter_mut().zip(slips) {
            row[SPEED] = c;
        }
        self.covariance[SPEED][SPEED] = slope * slips[SLIP] + rim.variance;
    }

    /// Ties speed and slip by the rims' speed: u = v + s m, m the faster of u and v. Returns the likelihood. The rims' speed is that
    /// of the middle of their window: where slip hardly changes, the robot's speed is taken back to then by the accelerometer;
    /// where it may change at once, the rims' speed is taken on to now.
    pub(super) fn tie(&mut self, rim: Rim) -> f64 {
        let slip = self.mean[SLIP];
        let gained = rim.gained - rim.lag * self.mean[BIAS];
        let (rim_speed, speed, by_bias) = if self.slip_noise < STEADY_SLIP_NOISE {
            (rim.speed, self.mean[SPEED] - gained, rim.lag)
        } else if self.slip_noise > SUDDEN_SLIP_NOISE {
            (rim.speed + self.rise(rim, gained), self.mean[SPEED], 0.0)
        } else {
            (rim.speed, self.mean[SPEED], 0.0)
        };
        let (faster, by_speed) = if slip >= 0.0 {
            (rim_speed, 1.0)
        } else {
            (speed, 1.0 + slip)
        };
        let residual = rim_speed - speed - faster * slip;
        let likelihood = self.update(
            &[
                (SPEED, by_speed),
                (BIAS, by_speed * by_bias),
                (SLIP, faster),
            ],
            residual,
            rim.variance,
            false,
        );
        self.clamp_slip();
        likelihood
    }

    /// How much faster the rims are than in the mean of their window, m/s, where the robot has `gained` speed (m/s) since: the smaller
    /// of what that says at a constant slip and of what the rims show. A change of slip alone is in one of the two.
    fn rise(&self, rim: Rim, gained: f64) -> f64 {
        let (share, _) = rim_share(self.mean[SLIP]);
        let by_force = gained / share.max(MIN_RIM_SHARE);
        if by_force * rim.rise > 0.0 {
            by_force.abs().min(rim.rise.abs()).copysign(rim.rise)
        } else {
            0.0
        }
    }

    fn clamp_slip(&mut self) {
        self.mean[SLIP] = self.mean[SLIP].clamp(-MAX_SLIP, self.max_slip);
    }

    /// Inflates the variance of the heading (rad²).
    pub(super) fn inflate_heading(&mut self, variance: f64) {
        self.covariance[HEADING][HEADING] += variance;
    }

    /// Inflates the variance of the position (m²).
    pub(super) fn inflate_position(&mut self, variance: f64) {
        for i in [X, Y] {
            self.covariance[i][i] += variance;
        }
    }

    /// Updates by a position of the past. An outlier is
    /// one on both axes: a change of slip moves the robot along its course alone.
    pub(super) fn update_position(
        &mut self,
        place: [f64; 2],
        since: &Since,
        course: &Course,
    ) -> f64 {
        let since = &self.since_within(since);
        let (mut good, mut bad) = (*self, *self);
        let as_good = (1.0 - OUTLIER_SHARE) * good.update_axes(place, since, course);
        let wide = course.wider(OUTLIER_FACTOR * OUTLIER_FACTOR);
        let as_bad = OUTLIER_SHARE * bad.update_axes(place, since, &wide);
        let likelihood = as_good + as_bad;
        let share = if likelihood > 0.0 {
            as_good / likelihood
        } else {
            0.0
        };
        if share > NO_OUTLIER {
            *self = good;
        } else {
            self.blend(&[good, bad], &[share, 1.0 - share]);
        }
        self.clamp_slip();
        likelihood
    }

    /// Updates by both axes of a position; returns the likelihood.
    fn update_axes(&mut self, place: [f64; 2], since: &Since, course: &Course) -> f64 {
        let mut likelihood = 1.0;
        let (_, slope) = rim_share(self.mean[SLIP]);
        let dot = |row: [f64; 2], of: [f64; 2]| row[0] * of[0] + row[1] * of[1];
        for (row, variance) in course.axes() {
            let (share, _) = rim_share(self.mean[SLIP]);
            let way = dot(row, since.way);
            let predicted = dot(row, [self.mean[X], self.mean[Y]]) - way * share;
            let jacobian = [(X, row[0]), (Y, row[1]), (SLIP, -way * slope)];
            let mut spread = self.spread(&jacobian);
            // Slip has changed since, too: the reading says nothing of that, and the way back at the present slip holds it.
            let noise = self.slip_noise * self.slip_noise * since.time_s;
            let ways = since.way.map(|way| way * slope);
            spread[SLIP] += way * slope * noise / 2.0;
            for other in [X, Y] {
                spread[other] += way * slope * ways[other] * noise / 6.0;
            }
            likelihood *= self.update_by(
                &spread,
                &jacobian,
                (dot(row, place) - predicted, variance),
                false,
            );
        }
        likelihood
    }

    /// Without the noise since, where other readings since may have shown the slip better than that: the covariance less the
    /// noise must be one.
    fn since_within(&self, since: &Since) -> Since {
        let mut before = *self;
        before.add_noise(since, -1.0);
        let time_s = if is_covariance(&before.covariance) {
            since.time_s
        } else {
            0.0
        };
        Since { time_s, ..*since }
    }

    /// Adds the noise of a slip that may have changed since a time of the past.
    pub(super) fn change_since(&mut self, since: &Since) {
        self.add_noise(since, 1.0);
    }

    /// Lets the slip change as within `seconds`, where the robot does not move on.
    pub(super) fn pass_time(&mut self, seconds: f64) {
        let noise = self.slip_noise * self.slip_noise * seconds;
        self.covariance[SLIP][SLIP] += noise.min(MAX_PASSED_SLIP * MAX_PASSED_SLIP);
    }

    /// Adds this multiple of the noise of the slip since a time of the past: ∫ over that time, of the slip and of the way.
    fn add_noise(&mut self, since: &Since, multiple: f64) {
        let (_, slope) = rim_share(self.mean[SLIP]);
        let noise = multiple * self.slip_noise * self.slip_noise * since.time_s;
        let ways = since.way.map(|way| way * slope);
        self.covariance[SLIP][SLIP] += noise;
        for axis in [X, Y] {
            self.covariance[SLIP][axis] += ways[axis] * noise / 2.0;
            self.covariance[axis][SLIP] += ways[axis] * noise / 2.0;
            for other in [X, Y] {
                self.covariance[axis][other] += ways[axis] * ways[other] * noise / 3.0;
            }
        }
    }

    /// Updates by a heading in the reference's frame, as it was `turned` (rad) ago.
    pub(super) fn update_heading(&mut self, heading: f64, turned: f64, variance: f64) -> f64 {
        let residual = wrap_angle(heading + turned - self.mean[HEADING]);
        self.update(&[(HEADING, 1.0)], residual, variance, true)
    }

    /// Updates by a speed along the direction of the rims.
    pub(super) fn update_speed(&mut self, speed: f64, variance: f64) -> f64 {
        let residual = speed - self.mean[SPEED];
        let likelihood = self.update(&[(SPEED, 1.0)], residual, variance, true);
        self.clamp_slip();
        likelihood
    }

    /// Updates by a speed beside that of the rims, m/s.
    pub(super) fn update_share(&mut self, speed: f64, rim_speed: f64, variance: f64) -> f64 {
        let (share, slope) = rim_share(self.mean[SLIP]);
        let slips = [(SLIP, rim_speed * slope)];
        let likelihood = self.update(&slips, speed - rim_speed * share, variance, true);
        self.clamp_slip();
        likelihood
    }

    /// One scalar update; returns its likelihood. A share of the readings of a reference (`robust`) are outliers: both cases
    /// enter, each by its probability, so that no steady reference is refused for ever.
    fn update(
        &mut self,
        jacobian: &[(usize, f64)],
        residual: f64,
        variance: f64,
        robust: bool,
    ) -> f64 {
        let spread = self.spread(jacobian);
        self.update_by(&spread, jacobian, (residual, variance), robust)
    }

    /// Covariance of the states with a measurement.
    fn spread(&self, jacobian: &[(usize, f64)]) -> [f64; STATES] {
        let mut spread = [0.0; STATES];
        for &(j, slope) in jacobian {
            for (slot, row) in spread.iter_mut().zip(&self.covariance) {
                *slot += slope * row[j];
            }
        }
        spread
    }

    /// An update by a measurement with this covariance with the states.
    fn update_by(
        &mut self,
        spread: &[f64; STATES],
        jacobian: &[(usize, f64)],
        (residual, variance): (f64, f64),
        robust: bool,
    ) -> f64 {
        let known: f64 = jacobian.iter().map(|&(j, slope)| slope * spread[j]).sum();
        let good = 1.0 / (known + variance);
        let density =
            |inverse: f64| Real::sqrt(inverse) * Real::exp(-0.5 * residual * residual * inverse);
        let (mut gain, mut square, mut likelihood) = (good, good * good, density(good));
        if robust {
            let bad = 1.0 / (known + variance * OUTLIER_FACTOR * OUTLIER_FACTOR);
            let (as_good, as_bad) = (
                (1.0 - OUTLIER_SHARE) * likelihood,
                OUTLIER_SHARE * density(bad),
            );
            likelihood = as_good + as_bad;
            let share = if likelihood > 0.0 {
                as_good / likelihood
            } else {
                0.0
            };
            gain = share * good + (1.0 - share) * bad;
            square = share * good * good + (1.0 - share) * bad * bad;
        }
        let doubt = (square - gain * gain) * residual * residual;
        for (i, row) in self.covariance.iter_mut().enumerate() {
            for (slot, other) in row.iter_mut().zip(spread) {
                *slot += (doubt - gain) * spread[i] * other;
            }
        }
        for (slot, spread) in self.mean.iter_mut().zip(spread) {
            *slot += gain * residual * spread;
        }
        likelihood
    }

    /// Adopts the mean and covariance of another; its process noise stays.
    pub(super) fn adopt(&mut self, other: &Self) {
        self.mean = other.mean;
        self.covariance = other.covariance;
    }

    /// Adopts the moments of a mixture; its process noise stays.
    pub(super) fn blend(&mut self, models: &[Self], shares: &[f64]) {
        let mut mean = [0.0; STATES];
        for (model, share) in models.iter().zip(shares) {
            for (slot, value) in mean.iter_mut().zip(&model.mean) {
                *slot += share * value;
            }
        }
        let mut covariance = [[0.0; STATES]; STATES];
        for (model, share) in models.iter().zip(shares) {
            let off: [f64; STATES] = core::array::from_fn(|i| model.mean[i] - mean[i]);
            for i in 0..STATES {
                for j in 0..STATES {
                    covariance[i][j] += share * (model.covariance[i][j] + off[i] * off[j]);
                }
            }
        }
        self.mean = mean;
        self.covariance = covariance;
    }
}

/// The robot's way over the rims' at slip s, v/u: 1 − s driving, 1/(1 + s) braking; and its derivative.
pub(super) fn rim_share(slip: f64) -> (f64, f64) {
    if slip >= 0.0 {
        (1.0 - slip, -1.0)
    } else {
        let ratio = 1.0 / (1.0 + slip.max(-0.95));
        (ratio, -ratio * ratio)
    }
}

/// The probability that a position with this normalised innovation squared is no outlier.
pub(super) fn inlier_probability(nis: f64) -> f64 {
    let square = OUTLIER_FACTOR * OUTLIER_FACTOR;
    let good = (1.0 - OUTLIER_SHARE) * Real::exp(-0.5 * nis);
    let bad = OUTLIER_SHARE / square * Real::exp(-0.5 * nis / square);
    good / (good + bad).max(1e-300)
}

#[cfg(test)]
pub(super) mod tests;
