//! Do accelerometer and reference point in the direction in which the wheels drive?
//!
//! A sensor whose axes are described wrongly is refused by the filter or makes it wrong; here the angle itself is measured,
//! so that the output can name the cause.

use std::ops::RangeInclusive;

use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample};

use crate::motion::{common_heading, displacement};

/// Changes of speed are compared over windows of this length, s: long against a sample, short against a manoeuvre.
const WINDOW_S: f64 = 0.5;
/// Windows with a longer break are left out, s.
const MAX_WINDOW_S: f64 = 0.8;
/// An angle beyond this is a wrong description, rad (35°): robots on side slopes drift by less.
const MAX_ANGLE_RAD: f64 = 0.61;
/// Windows that must have been compared, and their significance in standard deviations, before an angle is reported.
const MIN_WINDOWS: f64 = 12.0;
const MIN_SIGNIFICANCE: f64 = 5.0;
/// The changes of speed must have this standard deviation, m/s, or the accelerations show the ground alone; a larger change
/// than the second number is an outlier of the reference.
const MIN_CHANGE_M_PER_S: f64 = 0.03;
const MAX_CHANGE_M_PER_S: f64 = 2.0;
/// What accelerations are as multiples of the changes of the rims' speed, which slip changes too.
const SCALES: RangeInclusive<f64> = 0.2..=5.0;
/// Way of the reference that must have been compared, m, and the share of it that must point one way.
const MIN_WAY_M: f64 = 1.0;
const MIN_SHARE: f64 = 0.6;
/// Displacements turn by less than this, rad: a sensor far from the robot's origin moves sideways in turns.
const MAX_TURN_RAD: f64 = 0.05;

/// How far the axes of sensors are turned against the direction in which the wheels drive, rad, positive to the left; `None`
/// where the axes agree or the log cannot show it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisCheck {
    /// Of the accelerometer.
    pub acceleration: Option<f64>,
    /// Of the displacement, pose or velocity that measures the robot's motion.
    pub reference: Option<f64>,
}

/// Compares the directions over a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisWatch {
    /// The direction in which all powered wheels drive, as cosine and sine; `None` of a robot whose wheels point apart.
    along: Option<[f64; 2]>,
    low_speed: f64,
    rim: f64,
    /// Beginning of the window, ns, and the rims' speed then, m/s.
    begun: Option<(i64, f64)>,
    /// Sums of the accelerations of the window, and their number.
    force: ([f64; 2], f64),
    /// Mean acceleration of the window before: the rims' speed is a mean that lags.
    before: Option<[f64; 2]>,
    by_rims: Changes,
    /// Way forwards by the reference in the window, m, and the time that it took, s: not the window's, since a reference is
    /// slow. Its mean speed forwards in the window before, m/s.
    forward: (f64, f64),
    forward_before: Option<f64>,
    reference_ns: Option<i64>,
    by_reference: Changes,
    pose: Option<[f64; 3]>,
    /// Sum of the displacements, each with the sign of the wheels' speed, and of their lengths, m.
    passed: [f64; 2],
    way: f64,
}

impl AxisWatch {
    pub(crate) fn new(robot: &Robot, low_speed: f64) -> Self {
        Self {
            along: common_heading(robot, Real::cos(MAX_ANGLE_RAD)),
            low_speed,
            ..Self::default()
        }
    }

    /// Takes a sample of an accelerometer or of a measured motion; others have no effect.
    pub(crate) fn take(&mut self, sample: &Sample) {
        match sample.measurement {
            Measurement::Acceleration { forward, left } if (forward + left).is_finite() => {
                let (sum, count) = &mut self.force;
                *sum = [sum[0] + forward, sum[1] + left];
                *count += 1.0;
            }
            Measurement::Pose { x, y, yaw } => {
                let passed_s = self.since_last(sample.time_ns);
                let Some(last) = self.pose.replace([x, y, yaw]) else {
                    return;
                };
                let (passed, turn) = displacement(last, [x, y, yaw]);
                self.add_displacement(passed, turn, passed_s);
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                let passed_s = self.since_last(sample.time_ns);
                self.add_displacement([forward, left], turn.unwrap_or(0.0), passed_s);
            }
            _ => {}
        }
    }

    /// Time since the last reading of the reference, s; 0 at the first.
    fn since_last(&mut self, now_ns: i64) -> f64 {
        let last = self.reference_ns.replace(now_ns).unwrap_or(now_ns);
        now_ns.saturating_sub(last) as f64 * 1e-9
    }

    fn add_displacement(&mut self, passed: [f64; 2], turn: f64, passed_s: f64) {
        if let Some([cos, sin]) = self.along
            && passed_s > 0.0
        {
            self.forward.0 += cos * passed[0] + sin * passed[1];
            self.forward.1 += passed_s;
        }
        let length = Real::hypot(passed[0], passed[1]);
        if turn.abs() < MAX_TURN_RAD && self.rim.abs() > self.low_speed && length.is_finite() {
            let sign = self.rim.signum();
            self.passed = [
                self.passed[0] + sign * passed[0],
                self.passed[1] + sign * passed[1],
            ];
            self.way += length;
        }
    }

    /// Takes the mean rim speed of the powered wheels, m/s, after all samples of one time.
    pub(crate) fn step(&mut self, now_ns: i64, rim: f64) {
        self.rim = rim;
        let Some((begun_ns, rim_then)) = self.begun else {
            self.begun = Some((now_ns, rim));
            return;
        };
        let passed = now_ns.saturating_sub(begun_ns) as f64 * 1e-9;
        if passed < WINDOW_S {
            return;
        }
        self.begun = Some((now_ns, rim));
        let (sum, count) = std::mem::take(&mut self.force);
        let now = (count > 0.0 && passed < MAX_WINDOW_S).then(|| sum.map(|sum| sum / count));
        let (way, time) = std::mem::take(&mut self.forward);
        let forward = (time > 0.0 && time < MAX_WINDOW_S).then(|| way / time);
        let before = std::mem::replace(&mut self.forward_before, forward);
        if let Some((older, newer)) = self.before.zip(now) {
            let gained = [0, 1].map(|i| 0.5 * (older[i] + newer[i]) * passed);
            self.by_rims.add(rim - rim_then, gained);
            if let Some((before, forward)) = before.zip(forward) {
                self.by_reference.add(forward - before, gained);
            }
        }
        self.before = now;
    }

    /// The angles that a description of the sensors would have to be turned by.
    pub(crate) fn summary(&self) -> AxisCheck {
        let Some([cos, sin]) = self.along else {
            return AxisCheck::default();
        };
        let angle = |[x, y]: [f64; 2]| {
            let angle = Real::atan2(cos * y - sin * x, cos * x + sin * y);
            (angle.abs() > MAX_ANGLE_RAD).then_some(angle)
        };
        let moved = Real::hypot(self.passed[0], self.passed[1]);
        let is_known = self.way > MIN_WAY_M && moved > MIN_SHARE * self.way;
        let reference = is_known.then(|| angle(self.passed)).flatten();
        // Where slip changes, the reference shows the robot's speeding up and the rims do not.
        let by_rims = self.by_rims.direction();
        let by_reference = self
            .by_reference
            .direction()
            .filter(|_| reference.is_none());
        let significance =
            |of: Option<([f64; 2], f64)>| of.map_or(0.0, |(_, significance)| significance);
        let surer = if significance(by_reference) > significance(by_rims) {
            by_reference
        } else {
            by_rims
        };
        AxisCheck {
            acceleration: surer.and_then(|(direction, _)| angle(direction)),
            reference,
        }
    }

    /// Do the accelerations of the whole log show another scale or sign along the robot than that of metres per second
    /// squared? `None` of a log that is too short for it.
    pub(crate) fn has_other_scale(&self) -> Option<bool> {
        let [cos, sin] = self.along?;
        let changes = &self.by_rims;
        let speed_variance = changes.speed_variance()?;
        let is_other = changes
            .direction()
            .is_some_and(|([x, y], _)| !SCALES.contains(&((cos * x + sin * y) / speed_variance)));
        Some(is_other)
    }
}

/// Sums of the changes of speed by rims or reference and by the accelerometer, m/s.
#[derive(Clone, Copy, Debug, Default)]
struct Changes {
    count: f64,
    speed: f64,
    speed_square: f64,
    gained: [f64; 2],
    gained_square: f64,
    product: [f64; 2],
}

impl Changes {
    fn add(&mut self, speed: f64, gained: [f64; 2]) {
        if !(speed.abs() < MAX_CHANGE_M_PER_S) {
            return;
        }
        self.count += 1.0;
        self.speed += speed;
        self.speed_square += speed * speed;
        for (i, gained) in gained.into_iter().enumerate() {
            self.gained[i] += gained;
            self.gained_square += gained * gained;
            self.product[i] += speed * gained;
        }
    }

    /// The variance of the changes of speed, m²/s², where it suffices.
    fn speed_variance(&self) -> Option<f64> {
        let n = self.count;
        let variance = self.speed_square / n - Real::powi(self.speed / n, 2);
        (n >= MIN_WINDOWS && variance > Real::powi(MIN_CHANGE_M_PER_S, 2)).then_some(variance)
    }

    /// The direction of the acceleration that goes with speeding up, and its significance, where that suffices. Biases and
    /// the slope of the ground are constants of it.
    fn direction(&self) -> Option<([f64; 2], f64)> {
        let n = self.count;
        let speed_variance = self.speed_variance()?;
        let covariance =
            [0, 1].map(|i| self.product[i] / n - self.speed * self.gained[i] / (n * n));
        let means = self.gained.map(|sum| sum / n);
        let variance = self.gained_square / n - Real::powi(means[0], 2) - Real::powi(means[1], 2);
        let square: f64 = (Real::powi(covariance[0], 2) + Real::powi(covariance[1], 2))
            / (speed_variance * variance);
        let significance = (square / (1.0 - square).max(1e-9) * n).sqrt();
        (significance > MIN_SIGNIFICANCE).then_some((covariance, significance))
    }
}
