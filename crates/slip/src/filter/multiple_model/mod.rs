//! The robot's motion from an absolute reference, the wheels and the accelerometer: several models of the slip at once.
//!
//! Slip, not speed, is the random walk: the robot's way is the rims' way times v/u, so that the uncertainty of the speed
//! scales with the rim speed. How fast slip changes is not known beforehand, so that groups of models run side by side, from
//! firm ground (constant slip) to ground that breaks away. Some use the accelerometer and some do not, since its bias holds
//! the tilt of the ground. Each reading of the reference weighs the groups by how well they predicted it. Positions enter as
//! positions, never as differences, and their noise is learnt. Outliers are part of the likelihood: there is no gate that
//! could refuse a steady reference for ever.

mod course;
mod covariance;
mod group;
mod model;
mod motion;
mod position_noise;
pub(super) mod reference_noise;
mod rim_pattern;
mod step;

use grouser_real::{Real, wrap_angle};

use course::Course;
use group::Group;
pub(super) use model::MIN_RIM_SHARE;
use model::{DRIFT, HEADING, MAX_SLIP, Model, SLIP, STATES, Since, TURN_ERROR, X, Y};
pub(crate) use motion::ModelMotion;
use position_noise::PositionNoise;
use reference_noise::Errors;
use rim_pattern::RimPattern;
pub(super) use rim_pattern::TURNING_SPEED_M_PER_S;
use step::Step;
pub(super) use step::{Rim, TurnError};

use crate::speed::Measured;

/// Process noise densities of slip of the lone models, 1/√s: from firm ground to a wheel that breaks away; set by the profiles
/// of `known_truth` in the generator's crate. Without the most restless ones errors are the same and sigmas at low speed too small.
const LONE_SLIP_NOISE: [f64; 5] = [0.002, 0.01, 0.04, 0.12, 0.4];
/// Process noise density of slip while it jumps, 1/√s: 0.23 within 0.15 s.
const JUMP_SLIP_NOISE: f64 = 0.6;
/// How often slip begins to jump or to change on even and on rolling ground, 1/s. Rarer jumps on even ground leave them to
/// the restless groups; ten times as many cost 15 % of RMSE at 3 m/s (`every_cell` of the generator's crate).
const LEVEL_CHANGES_PER_S: f64 = 0.005;
const ROLLING_CHANGES_PER_S: f64 = 0.3;
/// Process noise densities of the accelerometer's bias, m/s² per √s: on even ground, and on rolling ground.
const LEVEL_BIAS_NOISE: f64 = 3e-3;
const ROLLING_BIAS_NOISE: f64 = 0.1;
/// How often slip jumps from one steady value to another, 1/s: once in 100 s. Twice as often finds the jumps of `known_truth` earlier
/// by 3 % of RMSE, and takes an outlier for one so often that steady slip has more error than a trailing mean.
const JUMPS_PER_S: f64 = 0.01;
/// Rims that part, or turn the robot on the spot, change their slip as ground does within this time, s. Three times as long costs 3 %
/// of RMSE on random logs, where slip stays the same in a turn; without it robots on slopes were wrong for as long as a turn lasted.
const RENEWAL_S: f64 = 10.0;
const GROUPS: usize = LONE_SLIP_NOISE.len() + 4;
/// Rims slower than this stand, m/s.
pub(super) const STANDING_RIM_M_PER_S: f64 = 0.02;
/// Smallest share of a group in the variance: the ground may have changed since the last reading.
const MIN_SHARE_IN_VARIANCE: f64 = 0.015;
/// The same for a group without the accelerometer while there is one.
const UNAIDED_SHARE_IN_VARIANCE: f64 = 0.001;
/// Change of slip between two readings of the reference that ground makes, 1. An accelerometer whose noise makes less of it in that
/// time has the prior odds of the squared ratio: on steady ground positions do not tell groups with and without it apart, and a
/// jump of the slip must count at once. Half and twice as much change the errors on random logs by less than 1 %.
const CHANGE_OF_SLIP: f64 = 0.03;
/// Limits of the logarithm of these odds.
const INERTIAL_LOG_ODDS: (f64, f64) = (0.0, 6.0);
/// Readings of the reference whose period, s, enters these odds, and the weight of the last one in its mean.
const MAX_PERIOD_S: f64 = 2.0;
const PERIOD_WEIGHT: f64 = 0.2;
/// A learnt noise is at least this, m.
const MIN_POSITION_SIGMA_M: f64 = 1e-4;
/// A measured heading is at least this uncertain, rad.
const MIN_HEADING_SIGMA_RAD: f64 = 1e-3;

/// The measurements of wheels and inertial sensors over one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelStep {
    /// Length, s.
    pub(crate) dt: f64,
    /// Way of the rims, m.
    pub(crate) rim_way: f64,
    /// Direction in which the rims run, beside the robot's heading, rad.
    pub(crate) direction: f64,
    /// Turn of the robot, rad, and what is known of its error.
    pub(crate) turn: f64,
    pub(crate) turn_error: TurnError,
    /// Turn per way, rad/m, of a robot that turns as it is steered.
    pub(crate) curvature: Option<f64>,
    /// Specific force along that direction, m/s², and its noise density, m/s/√s.
    pub(crate) acceleration: Option<(f64, f64)>,
    pub(crate) rim: Rim,
    /// The greatest slip of the rims together.
    pub(crate) max_slip: f64,
}

/// How a reading of the reference agrees with the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Agreement {
    /// Probability that it was no outlier.
    pub(crate) inlier: f64,
    /// Squared innovation over its variance, along and across together (2 degrees of freedom) or of a speed (1).
    pub(crate) nis: f64,
}

/// Groups of models with their shares.
#[derive(Clone, Debug)]
pub(crate) struct MultipleModel {
    groups: [Group; GROUPS],
    /// Shares of the groups by their evidence.
    shares: [f64; GROUPS],
    /// Means over all groups, as of the last step.
    mean: [f64; STATES],
    noise: PositionNoise,
    /// Direction in which the rims run, beside the robot's heading, rad, as of the last step.
    direction: f64,
    turn_error: TurnError,
    has_started: bool,
    was_inertial: bool,
    /// Noise density of the accelerometer, m/s per √s.
    force_density: f64,
    /// Period of the reference's readings, and the time since the last one, s.
    period_s: f64,
    since_reading_s: f64,
    /// As of the last step.
    rim: Rim,
    pattern: RimPattern,
    /// Way by the estimate and by the rims since the start, in the reference's frame, m; corrections left out.
    path: [f64; 2],
    rim_path: [f64; 2],
    turned: f64,
    rim_way: f64,
    slip_prior: [f64; 2],
}

impl MultipleModel {
    /// Waits for the first position. `slip` is the prior's mean and standard deviation.
    pub(crate) fn new(slip: [f64; 2]) -> Self {
        let rates = |rare: f64| [[0.0, rare, rare], [0.3, 0.0, rare], [2.0, 2.0, 0.0]];
        let [a, b, c, d, e] = LONE_SLIP_NOISE;
        let (level, rolling) = (Some(LEVEL_BIAS_NOISE), Some(ROLLING_BIAS_NOISE));
        let quiet = [0.002, 0.03, JUMP_SLIP_NOISE];
        let restless = [0.01, 0.1, JUMP_SLIP_NOISE];
        Self {
            groups: [
                Group::lone(a, None),
                Group::lone(b, None),
                Group::lone(c, level),
                Group::lone(d, None),
                Group::lone(e, rolling),
                Group::interacting(quiet, level, rates(LEVEL_CHANGES_PER_S)),
                Group::interacting(restless, rolling, rates(ROLLING_CHANGES_PER_S)),
                Group::interacting(restless, None, rates(ROLLING_CHANGES_PER_S)),
                Group::jumps(a, JUMP_SLIP_NOISE, JUMPS_PER_S),
            ],
            shares: [1.0 / GROUPS as f64; GROUPS],
            mean: [0.0; STATES],
            noise: PositionNoise::new(),
            direction: 0.0,
            turn_error: TurnError::default(),
            has_started: false,
            was_inertial: false,
            force_density: 0.0,
            period_s: MAX_PERIOD_S,
            since_reading_s: 0.0,
            rim: Rim::default(),
            pattern: RimPattern::default(),
            path: [0.0; 2],
            rim_path: [0.0; 2],
            turned: 0.0,
            rim_way: 0.0,
            slip_prior: slip,
        }
    }

    /// Forgets place and motion; keeps the learnt noise and the totals.
    pub(crate) fn restart(&mut self) {
        let mut noise = core::mem::replace(&mut self.noise, PositionNoise::new());
        noise.interrupt();
        *self = Self {
            noise,
            direction: self.direction,
            turn_error: self.turn_error,
            period_s: self.period_s,
            rim_path: self.rim_path,
            turned: self.turned,
            rim_way: self.rim_way,
            ..Self::new(self.slip_prior)
        };
    }

    /// Totals for a history: the rims' way in the reference's frame, m, the turn, rad, and the rims' way along their own
    /// direction, m.
    pub(crate) const fn totals(&self) -> [f64; 4] {
        [
            self.rim_path[0],
            self.rim_path[1],
            self.turned,
            self.rim_way,
        ]
    }

    /// Predicts over one step.
    pub(crate) fn advance(&mut self, wheels: &WheelStep) {
        let rim = wheels.rim;
        self.rim = rim;
        self.direction = wheels.direction;
        let before = core::mem::replace(&mut self.turn_error, wheels.turn_error);
        let same_sensor = wheels.turn_error.by_gyro == before.by_gyro;
        let removed = if same_sensor {
            wheels.turn_error.removed - before.removed
        } else {
            0.0
        };
        if !self.has_started {
            return;
        }
        self.since_reading_s += wheels.dt;
        let is_inertial = wheels.acceleration.is_some();
        self.force_density = wheels.acceleration.map_or(0.0, |(_, density)| density);
        let begins = is_inertial && !self.was_inertial;
        self.was_inertial = is_inertial;
        let before = self.mean;
        let change = self.pattern.update(rim.speed, wheels.max_slip, wheels.dt);
        for group in &mut self.groups {
            if change.parts {
                group.each(|model| model.pass_time(RENEWAL_S));
            }
            if change.turns {
                group.pass_time(RENEWAL_S);
            }
            if begins {
                group.each(|model| model.follow_rim(rim));
            }
            if !same_sensor {
                group.each(|model| model.restart_turn_error(wheels.turn_error.sigma));
            }
            let uses = is_inertial && group.is_inertial;
            let step = Step {
                dt: wheels.dt,
                rim_way: wheels.rim_way,
                direction: wheels.direction,
                turn: wheels.turn,
                curvature: wheels.curvature,
                turn_error: wheels.turn_error,
                removed,
                acceleration: wheels.acceleration.filter(|_| uses),
                max_slip: wheels.max_slip,
            };
            group.mix(wheels.dt);
            group.each(|model| model.predict(&step));
            if uses {
                group.weigh(|model| model.tie(rim));
            }
        }
        self.average();
        for (axis, path) in [X, Y].into_iter().zip(&mut self.path) {
            *path += self.mean[axis] - before[axis];
        }
        let (sin, cos) = Real::sin_cos(before[HEADING] + wheels.direction + 0.5 * wheels.turn);
        self.rim_path[0] += cos * wheels.rim_way;
        self.rim_path[1] += sin * wheels.rim_way;
        self.turned += wheels.turn;
        self.rim_way += wheels.rim_way;
        if self.mean.iter().any(|x| !x.is_finite()) {
            self.restart();
        }
    }

    /// Starts at a place (m) with a heading (rad), known to `position_sigma` and `heading_sigma`.
    pub(crate) fn start(
        &mut self,
        place: [f64; 2],
        heading: f64,
        position_sigma: f64,
        heading_sigma: f64,
    ) {
        let (rim, slip) = (self.rim.speed, self.slip_prior);
        let sigma = [position_sigma, heading_sigma, self.turn_error.sigma];
        for group in &mut self.groups {
            group.each(|model| model.start(place, heading, sigma, rim, slip));
        }
        self.has_started = true;
        self.average();
    }

    /// Sets the prior of the slip for the next start: mean and standard deviation.
    pub(crate) fn set_slip_prior(&mut self, slip: [f64; 2]) {
        self.slip_prior = slip;
    }

    /// Has it started?
    pub(crate) const fn has_started(&self) -> bool {
        self.has_started
    }

    /// A position, m, whose errors depend on those before as stated; `since` are [`totals`](Self::totals) now less those when it was
    /// taken. `prior_sigma` (m) holds until the noise is learnt, `way_sigma` (m) is that of the rims' way since then.
    pub(crate) fn update_position(
        &mut self,
        place: [f64; 2],
        (since, since_s): ([f64; 4], f64),
        (errors, prior_sigma, way_sigma): (Errors, f64, f64),
    ) -> Agreement {
        let share = self.mean_share();
        let position = core::array::from_fn(|i| place[i] - (self.path[i] - since[i] * share));
        let (sin, cos) = Real::sin_cos(self.mean[HEADING] - since[2] + self.direction);
        let at_rest = self.stands().then_some(prior_sigma);
        self.noise.push(position, (sin, cos), at_rest);
        let [along, across] = self.noise.noise(errors, prior_sigma, self.period_s);
        let wander = along.wander.max(across.wander);
        if wander > 0.0 {
            self.inflate(|model| model.inflate_position(wander * wander));
        }
        let course = Course {
            sin,
            cos,
            variances: [along, across].map(|noise| {
                let sigma = noise.reading.max(MIN_POSITION_SIGMA_M);
                sigma * sigma + way_sigma * way_sigma
            }),
        };
        let agreement = self.agreement(place, since, &course);
        self.begin_reading();
        self.weigh_position(place, (since, since_s), &course);
        agreement
    }

    fn weigh_position(
        &mut self,
        place: [f64; 2],
        (since, since_s): ([f64; 4], f64),
        course: &Course,
    ) {
        let stands = self.stands();
        for group in &mut self.groups {
            // a measured speed holds no noise of the slip
            let has_speed = self.was_inertial && group.is_inertial;
            let late = Since {
                time_s: if has_speed { 0.0 } else { since_s },
                way: [since[0], since[1]],
            };
            group.weigh_and_score(stands, |model| model.update_position(place, &late, course));
            group.pass_jump(&late);
        }
        self.reweigh();
    }

    /// The probability that a position of standard deviation `sigma` (m) is no outlier.
    pub(crate) fn position_agreement(&self, place: [f64; 2], since: [f64; 4], sigma: f64) -> f64 {
        let course = Course {
            sin: 0.0,
            cos: 1.0,
            variances: [sigma * sigma; 2],
        };
        self.agreement(place, since, &course).inlier
    }

    /// A heading in the reference's frame (rad), `turned` (rad) ago.
    pub(crate) fn update_heading(&mut self, heading: f64, turned: f64, sigma: f64) {
        let variance = sigma.max(MIN_HEADING_SIGMA_RAD) * sigma.max(MIN_HEADING_SIGMA_RAD);
        let stands = self.stands();
        for group in &mut self.groups {
            group.weigh_and_score(stands, |model| {
                model.update_heading(heading, turned, variance)
            });
        }
        self.reweigh();
    }

    /// The probability that such a heading is no outlier.
    pub(crate) fn heading_agreement(&self, heading: f64, turned: f64, sigma: f64) -> f64 {
        let off = wrap_angle(heading + turned - self.mean[HEADING]);
        model::inlier_probability(off * off / (self.variance(HEADING) + sigma * sigma))
    }

    /// Takes such a heading for the true one, and the error of the turn rate for unknown.
    pub(crate) fn restart_heading(
        &mut self,
        heading: f64,
        turned: f64,
        sigma: f64,
        turn_sigma: f64,
    ) {
        self.turn_error.sigma = turn_sigma;
        for group in &mut self.groups {
            group.each(|model| model.restart_heading(heading + turned, sigma, turn_sigma));
        }
        self.average();
    }

    /// A speed along the direction of the rims (m/s) for the groups that have a speed of their own; the others wait for
    /// [`update_share`](Self::update_share).
    pub(crate) fn update_speed(&mut self, speed: f64, sigma: f64) {
        self.begin_reading();
        let has_speed = |group: &&mut Group| self.was_inertial && group.is_inertial;
        let stands = self.stands();
        for group in self.groups.iter_mut().filter(has_speed) {
            group.weigh_and_score(stands, |model| model.update_speed(speed, sigma * sigma));
        }
        self.average();
    }

    /// The same speed beside that of the rims at its time, m/s, for the groups that know the speed by rims and slip.
    pub(crate) fn update_share(&mut self, speed: f64, rim_speed: f64, sigma: f64) {
        let has_none = |group: &&mut Group| !(self.was_inertial && group.is_inertial);
        let stands = self.stands();
        for group in self.groups.iter_mut().filter(has_none) {
            group.weigh_and_score(stands, |model| {
                model.update_share(speed, rim_speed, sigma * sigma)
            });
            group.pass_jump(&Since::NOW);
        }
        self.reweigh();
    }

    /// The probability that such a speed is no outlier.
    pub(crate) fn speed_agreement(&self, speed: f64, rim_speed: f64, sigma: f64) -> f64 {
        let slope = model::rim_share(self.mean[SLIP]).1 * rim_speed;
        let off = speed - rim_speed * self.mean_share();
        model::inlier_probability(off * off / (slope * slope * self.variance(SLIP) + sigma * sigma))
    }

    /// Takes a slip and a speed (m/s) for the true ones.
    pub(crate) fn restart_slip(&mut self, slip: f64, sigma: f64, speed: f64, speed_sigma: f64) {
        for group in &mut self.groups {
            group.each(|model| model.restart_slip([slip, sigma], [speed, speed_sigma]));
        }
        self.average();
    }

    /// The robot may have moved by `distance` (m) without a measurement.
    pub(crate) fn inflate_position(&mut self, distance: f64) {
        self.noise.interrupt();
        self.inflate(|model| model.inflate_position(distance * distance));
    }

    /// The reference's frame may have turned by `angle` (rad).
    pub(crate) fn inflate_heading(&mut self, angle: f64) {
        self.inflate(|model| model.inflate_heading(angle * angle));
    }

    fn inflate(&mut self, change: impl Fn(&mut Model)) {
        for group in &mut self.groups {
            group.each(&change);
        }
    }

    /// The place in the reference's frame (m) before the rims went the way of `since`.
    pub(crate) fn place(&self, since: [f64; 4]) -> [f64; 2] {
        let share = self.mean_share();
        [
            self.mean[X] - since[0] * share,
            self.mean[Y] - since[1] * share,
        ]
    }

    /// Standard deviation of a position, m, once it is learnt.
    pub(crate) fn position_sigma(&self) -> Option<f64> {
        self.noise.learnt()
    }

    /// Standard deviation of the heading, rad.
    pub(crate) fn heading_sigma(&self) -> f64 {
        Real::sqrt(self.variance(HEADING))
    }

    /// The estimate; `None` before the first position.
    pub(crate) fn motion(&self) -> Option<ModelMotion> {
        let [slip, drift] = [SLIP, DRIFT].map(|i| (self.mean[i], Real::sqrt(self.variance(i))));
        self.has_started.then_some(ModelMotion {
            speed: self.rim.speed * self.mean_share(),
            rim_share: self.mean_share(),
            slip: slip.0.clamp(-1.0, 1.0),
            slip_sigma: slip.1.min(MAX_SLIP),
            drift: drift.0,
            drift_sigma: drift.1,
            turn_error: Measured {
                value: self.mean[TURN_ERROR],
                variance: self.variance(TURN_ERROR),
            },
            place: [self.mean[X], self.mean[Y]],
            heading: self.mean[HEADING],
        })
    }

    /// The same with this share of the slip kept, and its prior for the rest.
    pub(crate) fn fading_motion(&self, kept: f64) -> Option<ModelMotion> {
        Some(self.motion()?.faded(kept, self.slip_prior, self.rim.speed))
    }

    /// Counts the period of the readings, and lets the evidence fade, so that a change of ground changes the shares.
    fn begin_reading(&mut self) {
        let since_last_s = self.since_reading_s;
        if self.since_reading_s > 0.0 {
            let passed = self.since_reading_s.min(MAX_PERIOD_S);
            self.period_s += PERIOD_WEIGHT * (passed - self.period_s);
            self.since_reading_s = 0.0;
        }
        if self.stands() {
            return;
        }
        for group in &mut self.groups {
            group.fade(since_last_s);
        }
    }

    /// Recomputes shares and means after a measurement.
    fn reweigh(&mut self) {
        let best = self
            .groups
            .iter()
            .map(|group| group.log_evidence)
            .fold(f64::MIN, f64::max);
        let odds = self.inertial_log_odds();
        let mut total = 0.0;
        for (group, share) in self.groups.iter_mut().zip(&mut self.shares) {
            group.log_evidence -= best;
            let prior = if group.is_inertial { odds } else { 0.0 };
            *share = Real::exp(group.log_evidence + prior);
            total += *share;
        }
        for share in &mut self.shares {
            *share /= total;
        }
        self.average();
    }

    /// Logarithm of the prior odds of a group with the accelerometer over one without.
    fn inertial_log_odds(&self) -> f64 {
        let gained = self.force_density * Real::sqrt(self.period_s);
        if !(self.was_inertial && gained > 0.0) {
            return 0.0;
        }
        let (low, high) = INERTIAL_LOG_ODDS;
        let ratio = CHANGE_OF_SLIP * self.rim.speed.abs() / gained;
        (2.0 * Real::ln(ratio.max(f64::MIN_POSITIVE))).clamp(low, high)
    }

    /// Do the rims stand? A reading then says nothing of slip: by it, groups whose speed is that of the rims would win over those
    /// that measure it.
    fn stands(&self) -> bool {
        self.rim.speed.abs() <= STANDING_RIM_M_PER_S
    }

    fn average(&mut self) {
        self.mean = [0.0; STATES];
        for (group, share) in self.groups.iter().zip(self.shares) {
            for (model, weight) in group.models() {
                for (slot, value) in self.mean.iter_mut().zip(&model.mean) {
                    *slot += share * weight * value;
                }
            }
        }
    }

    /// Variance of a state over all groups, each with a least share.
    fn variance(&self, i: usize) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for (group, share) in self.groups.iter().zip(self.shares) {
            let unaided = self.was_inertial && !group.is_inertial;
            let least = if unaided {
                UNAIDED_SHARE_IN_VARIANCE
            } else {
                MIN_SHARE_IN_VARIANCE
            };
            let share = share.max(least);
            total += share;
            for (model, weight) in group.models() {
                let off = model.mean[i] - self.mean[i];
                sum += share * weight * (model.covariance[i][i] + off * off);
            }
        }
        sum / total
    }

    fn mean_share(&self) -> f64 {
        model::rim_share(self.mean[SLIP]).0
    }

    /// The agreement of a position with the prediction over all groups.
    fn agreement(&self, place: [f64; 2], since: [f64; 4], course: &Course) -> Agreement {
        let predicted = self.place(since);
        let [x, y] = [0, 1].map(|i| place[i] - predicted[i]);
        let mut nis = 0.0;
        for (row, variance) in course.axes() {
            let residual = row[0] * x + row[1] * y;
            let known = row[0] * row[0] * self.variance(X) + row[1] * row[1] * self.variance(Y);
            nis += residual * residual / (known + variance);
        }
        Agreement {
            inlier: model::inlier_probability(nis),
            nis,
        }
    }
}

#[cfg(test)]
mod tests;
