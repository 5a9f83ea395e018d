//! A free wheel as a reference that may jam, skid or be lifted.
//!
//! Its speed changes as the accelerometer measures it; without one, by no more than wheels can accelerate a robot. A change beyond that is
//! the wheel's own until it has its usual share of the powered wheels' speed again, or all are stationary. A wheel that does not turn
//! while powered ones do is jammed, or the robot is stuck: what measurements add to the speed by the accelerometer has the mean zero and a
//! known variance while it is the robot, and its sum is far from zero where the robot starts and its free wheel does not. A slow start is no
//! more than a slope to the accelerometer: a wheel that has not turned since the robot was stationary shows nothing.

use grouser_real::Real;

use crate::motion::{
    Belief, FORCE_BIAS, MAX_ACCELERATION, MIN_SPEED, Row, SIZE, SPEED, Step, WheelStep,
};

/// The sum, and the usual share, fade over this time, s. A prior: a robot starts or stops within a second or two.
const MEMORY_S: f64 = 2.0;
/// A contradiction is beyond this many sigma, and the sum beyond this speed, m/s.
const SIGMAS: f64 = 5.0;
const MIN_GAP: f64 = 0.02;
/// A changed speed that lasts longer is the robot's, s. A choice, not measured: shorter accepts longer skids as slip, longer delays real
/// changes of slip next to an accelerometer that does not measure them.
const SKID_S: f64 = 3.0;
/// What measurements add to the speed has at least this variance, (m/s)²: against a division by zero.
const MIN_ADDED: f64 = 1e-8;
/// The noise of the accelerometer next to a free wheel follows its squares over about a hundred steps, a choice; an outlier counts as three
/// sigma. It is at most thirty times the prior's sigma: then the accelerometer shows nothing.
const SCALE_RATE: f64 = 0.01;
const MAX_SQUARE: f64 = 9.0;
const MAX_SCALE: f64 = 1e3;
/// Wheels whose heading has this cosine at least show the robot's speed.
const MIN_AHEAD: f64 = 0.98;
/// Wheels that start shear the soil before the robot moves, s.
const START_S: f64 = 0.5;
/// The accelerometer is off by this between two steps, m/s². A prior: gravity where the slope changes by six degrees, and shaking.
const FORCE_ERROR: f64 = 1.0;
/// A wheel is as fast as usual again where it is off by less than this share of the jump.
const RETURN_SHARE: f64 = 0.5;

/// What is known of the robot's free wheels.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeWheelMonitor {
    /// Its speed in the last step, m/s, and the usual share of the powered wheels' speed that it has, over how long, s.
    last: Option<f64>,
    share: f64,
    rolled: f64,
    /// The size of a change of speed that is its own, m/s, and how long ago it was, s.
    jump: Option<[f64; 2]>,
    /// The sum of what measurements add to the speed by the accelerometer, m/s, and its variance.
    gap: f64,
    variance: f64,
    /// The variance of the accelerometer's noise over that of its prior: shaking, slopes that change.
    force_scale: f64,
    /// Has the free wheel turned since the robot was stationary, and for how long have the powered ones without it, s?
    has_rolled: bool,
    starting: f64,
    is_jammed: bool,
}

impl Default for FreeWheelMonitor {
    fn default() -> Self {
        Self {
            last: None,
            share: 0.0,
            rolled: 0.0,
            jump: None,
            gap: 0.0,
            variance: 0.0,
            force_scale: 1.0,
            has_rolled: false,
            starting: 0.0,
            is_jammed: false,
        }
    }
}

impl FreeWheelMonitor {
    /// Leaves an impossible specific force out of a step, by the belief before it, and judges the free wheels' speed; they are left
    /// out of the step while it is not the robot's and another reference shows that.
    pub(super) fn judge(&mut self, step: &mut Step, belief: &Belief, has_reference: bool) {
        let dt = step.dt;
        let wheels = step.wheels.iter().filter_map(|of| of.distance);
        let fastest = wheels.fold(0.0, |most: f64, of| most.max(of.abs())) / dt;
        let most = MAX_ACCELERATION * dt + fastest.max(belief.mean[SPEED].abs());
        // an impact takes all of the robot's speed at most, and a robot that comes free has its wheels' speed at most
        step.force = step.force.filter(|of| (of[0] * dt).abs() <= most);
        let (Some([free, variance]), Some([powered, _])) =
            (mean_speed(step, true), mean_speed(step, false))
        else {
            self.last = None;
            return;
        };
        let expected = match step.force {
            Some([force, _]) => [force - belief.mean[FORCE_BIAS], FORCE_ERROR],
            None => [0.0, MAX_ACCELERATION],
        };
        let turns = powered.abs() > MIN_SPEED;
        let usual = self.share * powered;
        if let Some([size, since]) = &mut self.jump {
            *since += dt;
            let is_stationary = free.abs() < MIN_SPEED && !turns;
            let is_back = (free - usual).abs() < RETURN_SHARE * *size;
            // a wheel that does not turn is locked, however long
            let lasts = *since > SKID_S && free.abs() > MIN_SPEED;
            if is_stationary || is_back || lasts {
                self.jump = None;
            }
        } else if let Some(last) = self.last {
            let size = (free - last - expected[0] * dt).abs();
            let limit = expected[1] * dt + SIGMAS * Real::sqrt(2.0 * variance);
            if size > limit && turns && self.rolled > 0.0 {
                self.jump = Some([size, 0.0]);
            }
        }
        if turns && free.abs() > MIN_SPEED && self.jump.is_none() {
            self.rolled = (self.rolled + dt).min(MEMORY_S.max(dt));
            self.share += dt / self.rolled * (free / powered - self.share);
        }
        self.last = Some(free);
        if has_reference && self.is_skidding() {
            let wheels = step.wheels.iter_mut().filter(|of| of.is_free);
            wheels.for_each(|of| of.distance = None);
        }
    }

    /// Follows a step by the beliefs before and after it; `drift` is the random walk of the speed by the accelerometer, m/s/√s.
    pub(super) fn watch(&mut self, before: &Belief, after: &Belief, step: &Step, drift: f64) {
        let Some([free, _]) = mean_speed(step, true) else {
            return;
        };
        let rolls = free.abs() > MIN_SPEED;
        let is_driven = mean_speed(step, false).is_some_and(|of| of[0].abs() > MIN_SPEED);
        let kept = Real::exp(-step.dt / MEMORY_S);
        (self.gap, self.variance) = (kept * self.gap, kept * kept * self.variance);
        if let Some([force, _]) = step.force {
            let mut row: Row = [0.0; SIZE];
            (row[SPEED], row[FORCE_BIAS]) = (1.0, -step.dt);
            let predicted = before.mean_of(&row) + force * step.dt;
            let added = after.mean[SPEED] - predicted;
            let known = before.variance_of(&row) + drift * drift * step.dt;
            let variance = (known - after.covariance[SPEED][SPEED]).max(MIN_ADDED);
            self.gap += added;
            self.variance += variance;
            let square = (added * added / variance).min(MAX_SQUARE);
            let scale = self.force_scale * (1.0 + SCALE_RATE * (square - 1.0));
            self.force_scale = scale.clamp(1.0, MAX_SCALE);
        }
        if self.jump.is_some() {
            return;
        }
        let limit = SIGMAS * Real::sqrt(self.variance) + MIN_GAP;
        if rolls || !is_driven {
            self.has_rolled = rolls;
            (self.starting, self.is_jammed) = (0.0, false);
        } else {
            self.starting += if self.has_rolled { 0.0 } else { step.dt };
            self.is_jammed |= self.gap.abs() > limit;
        }
    }

    /// Is its speed not that of the robot?
    pub(super) const fn is_skidding(&self) -> bool {
        self.jump.is_some() || self.is_jammed
    }

    /// Is its speed not that of the robot, or has it not turned although the robot may move?
    pub(super) const fn is_doubted(&self) -> bool {
        self.is_skidding() || self.starting > START_S
    }

    /// The variance of the accelerometer's noise over that of its prior.
    pub(super) const fn force_scale(&self) -> f64 {
        self.force_scale
    }

    /// The clock was set.
    pub(super) const fn restart_clock(&mut self) {
        self.last = None;
    }
}

/// Mean speed of the free or the powered wheels that roll straight ahead, without the robot's turn, m/s, and its variance; `None` where none is measured.
fn mean_speed(step: &Step, is_free: bool) -> Option<[f64; 2]> {
    let rolls_ahead = |of: &&WheelStep| of.is_free == is_free && of.row[0] > MIN_AHEAD;
    let of_role = step.wheels.iter().filter(rolls_ahead);
    let turned = step.turn.unwrap_or(0.0);
    let [mut count, mut sum, mut variance] = [0.0; 3];
    for (wheel, distance) in of_role.filter_map(|of| Some((of, of.distance?))) {
        count += 1.0;
        sum += (distance - wheel.row[2] * turned) / step.dt;
        variance += wheel.variance / (step.dt * step.dt);
    }
    (count > 0.0).then(|| [sum / count, variance / (count * count)])
}
