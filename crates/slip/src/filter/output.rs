//! The output of the filter.

use alloc::{boxed::Box, vec};

use super::estimator::Core;
use super::input::Input;
use super::motion_model::{COMMON_SLIP, FORWARD, HEADING, LEFT, PLACE, YAW};
use crate::fault::Rejected;
use crate::history::seconds_between;
use crate::speed::Measured;
use crate::wheel_estimate::WheelEstimate;

/// The place of the robot relative to its start, with slip compensated: x forwards and y to the left of its first heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Odometry {
    /// Forwards, m.
    pub x: f64,
    /// To the left, m.
    pub y: f64,
    /// Heading to the left, rad; it is not wrapped at a whole turn.
    pub yaw: f64,
    /// Covariance of the three. It grows with the uncertainty of slips, speeds and biases.
    pub covariance: [[f64; 3]; 3],
}

/// The way of the powered rims since the start, in the frame of the absolute reference: where the robot would be without
/// slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RimPath {
    /// Along the axes of the reference's frame, m.
    pub x: f64,
    /// Its second axis, m.
    pub y: f64,
    /// Turn of the robot, rad, positive to the left.
    pub turned: f64,
    /// Along the rims' own direction, m.
    pub way: f64,
}

/// The estimate of the robot as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BodyEstimate {
    /// Speed forwards, m/s.
    pub forward: Measured,
    /// Speed to the left, m/s.
    pub left: Measured,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: Measured,
    /// Covariance of the three.
    pub velocity_covariance: [[f64; 3]; 3],
    /// The powered wheels' common slip, 1.
    pub common_slip: Measured,
    /// The way of the powered rims since the start; `None` with a free wheel, and before the first absolute position.
    pub rim_path: Option<RimPath>,
    /// Its place.
    pub odometry: Odometry,
    /// Travel since the start along the robot's own forward direction, m.
    pub distance: f64,
    /// The same by the powered wheels without compensation of slip, m.
    pub distance_of_wheels: f64,
    /// Normalised innovation squared of the last measurement: 1 in the mean where sigmas are right.
    pub nis: f64,
}

/// The checks of a wheel's encoder and radius by its own readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WheelCheck {
    /// The share of pulses that its counter misses at random, by the unevenness of its ticks (a little below 0 by chance);
    /// `None` where the wheel has hardly turned, too slowly or too fast for its ticks, or has no counter.
    pub pulses_missed: Option<f64>,
    /// It misses more than 0.022 beyond the share that rough ground makes all wheels seem to miss: its slip is too low by that,
    /// and its health `Degraded(Suspect)`.
    pub misses_pulses: bool,
    /// A tick is missing at the same angle of each turn: a slot or a magnet is broken.
    pub broken_slot: bool,
    /// The share by which its described radius is too large, by its slip at no torque. `None` without torques, and until
    /// they have changed enough, driving and braking.
    pub radius_excess: Option<Measured>,
}

/// The output of the filter after a sample.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FilterOutput<'a> {
    /// The time up to which samples have been used, ns: the horizon behind the newest.
    pub time_ns: i64,
    /// The delay of that behind the newest sample, s.
    pub time_slip: f64,
    /// Each wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// The checks of each wheel's sensor and description.
    pub checks: &'a [WheelCheck],
    /// The robot as a whole.
    pub body: BodyEstimate,
    /// Samples refused so far.
    pub rejected: Rejected,
    /// Samples missing so far, by the usual period of each sensor.
    pub dropped: u64,
    /// Number of clock steps that the filter has followed.
    pub clock_steps: u64,
    /// Seconds since a trusted reference last measured the robot's speed; `None` before the first.
    pub reference_age: Option<f64>,
    /// Readings of a displacement, pose or speed so far, repeated ones left out.
    pub reference_readings: u64,
    /// Those of them that were refused: outliers, or contradicted by the other sensors.
    pub reference_refused: u64,
    pub(super) core: &'a Core,
}

impl FilterOutput<'_> {
    /// A wheel's side slip angle β = atan2(v_across, v_along) of its centre over the ground, rad, positive to the left of its
    /// heading; `None` below `low_speed`, where it is not known to half a radian, and for a wheel that the robot does not have.
    #[must_use]
    pub fn side_slip_angle(&self, wheel: usize) -> Option<Measured> {
        self.core.side_slip_angle(wheel)
    }
}

/// What the filter keeps for its output.
#[derive(Clone, Debug)]
pub(super) struct Outputs {
    pub(super) estimates: Box<[WheelEstimate]>,
    pub(super) checks: Box<[WheelCheck]>,
    pub(super) checked_ns: Option<i64>,
    /// Travel forwards by the state, and by the wheels without compensation of slip, m.
    pub(super) distance: f64,
    pub(super) distance_of_wheels: f64,
    /// Readings of the reference so far, and those of them that were refused.
    pub(super) reference_readings: u64,
    pub(super) reference_refused: u64,
}

impl Outputs {
    pub(super) fn new(wheels: usize) -> Self {
        Self {
            estimates: vec![WheelEstimate::NOTHING; wheels].into_boxed_slice(),
            checks: vec![WheelCheck::default(); wheels].into_boxed_slice(),
            checked_ns: None,
            distance: 0.0,
            distance_of_wheels: 0.0,
            reference_readings: 0,
            reference_refused: 0,
        }
    }
}

impl Core {
    /// The output at the present state.
    pub(super) fn output<'a>(&'a self, input: &Input) -> FilterOutput<'a> {
        let known = |i: usize| Measured {
            value: self.state.mean(i),
            variance: self.state.covariance(i, i),
        };
        let time_ns = self.now_ns.unwrap_or(0);
        let speeds = [FORWARD, LEFT, YAW];
        let place = [PLACE[0], PLACE[1], HEADING];
        FilterOutput {
            time_ns,
            time_slip: match (self.now_ns, input.newest_ns()) {
                (Some(now_ns), Some(newest_ns)) => seconds_between(now_ns, newest_ns).max(0.0),
                _ => 0.0,
            },
            wheels: &self.output.estimates,
            checks: &self.output.checks,
            body: BodyEstimate {
                forward: known(FORWARD),
                left: known(LEFT),
                yaw_rate: known(YAW),
                velocity_covariance: speeds.map(|i| speeds.map(|j| self.state.covariance(i, j))),
                common_slip: known(COMMON_SLIP),
                rim_path: self.ground.as_ref().and_then(|ground| ground.rim_path()),
                odometry: Odometry {
                    x: self.state.mean(PLACE[0]),
                    y: self.state.mean(PLACE[1]),
                    yaw: self.state.mean(HEADING),
                    covariance: place.map(|i| place.map(|j| self.state.covariance(i, j))),
                },
                distance: self.output.distance,
                distance_of_wheels: self.output.distance_of_wheels,
                nis: self.nis,
            },
            rejected: input.rejected,
            dropped: input.clocks.dropped,
            clock_steps: input.clocks.steps,
            reference_readings: self.output.reference_readings,
            reference_refused: self.output.reference_refused,
            reference_age: self
                .speed_known_ns
                .map(|then| seconds_between(then, time_ns)),
            core: self,
        }
    }
}

#[cfg(test)]
mod tests;
