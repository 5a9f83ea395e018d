//! The output of the filter.

use grouser_real::Real;

use super::checks::WheelCheck;
use super::input::Input;
use super::steps::Core;
use crate::fault::Rejected;
use crate::history::seconds_between;
use crate::motion::{HEADING, SLIP, X, Y, slip_of_log};
use crate::speed::Measured;
use crate::wheel_estimate::WheelEstimate;

/// A side slip angle with a larger standard deviation is not reported, rad.
const MAX_SIDE_SLIP_SIGMA_RAD: f64 = 0.5;
/// A wheel slower than this has no side slip angle, m/s.
const MIN_SPEED: f64 = 0.02;

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
    /// Its place.
    pub odometry: Odometry,
    /// Travel since the start along the robot's own forward direction, m.
    pub distance: f64,
    /// The same by the powered wheels without compensation of slip, m.
    pub distance_of_wheels: f64,
}

/// The output of the filter after a sample.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FilterOutput<'a> {
    /// The time up to which the motion is known, ns: the end of the last step.
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
    /// Scalars that a displacement, pose or speed has read so far.
    pub reference_readings: u64,
    /// Those of them that were probably outliers.
    pub reference_refused: u64,
    pub(super) core: &'a Core,
}

impl FilterOutput<'_> {
    /// A wheel's side slip angle β = atan2(v_across, v_along) of its centre over the ground, rad, positive to the left of its
    /// heading; `None` below 0.02 m/s, where it is not known to half a radian, and for a wheel that the robot does not have.
    #[must_use]
    pub fn side_slip_angle(&self, wheel: usize) -> Option<Measured> {
        let wheel = self.core.last.wheels.get(wheel)?;
        let motion = self.core.filter().motion();
        let (speed, drift) = (
            motion.along(wheel.row).value,
            motion.along(wheel.across).value,
        );
        let square = speed * speed + drift * drift;
        if !(square > MIN_SPEED * MIN_SPEED) {
            return None;
        }
        let row =
            core::array::from_fn(|i| (speed * wheel.across[i] - drift * wheel.row[i]) / square);
        let variance = motion.along(row).variance;
        let limit = MAX_SIDE_SLIP_SIGMA_RAD * MAX_SIDE_SLIP_SIGMA_RAD;
        (variance < limit).then(|| Measured {
            value: Real::atan2(drift, speed),
            variance,
        })
    }

    /// The probability that a wheel's slip exceeds a limit in [−1, 1]; `None` where it has no slip.
    #[must_use]
    pub fn exceeds(&self, wheel: usize, limit: f64) -> Option<f64> {
        self.core.exceeds(wheel, limit)
    }
}

impl Core {
    /// The output at the present state.
    pub(super) fn output<'a>(&'a self, input: &Input) -> FilterOutput<'a> {
        let filter = self.filter();
        let (belief, motion) = (filter.belief(), filter.motion());
        let time_ns = self.now_ns.unwrap_or(0);
        let speed = |i: usize| Measured {
            value: motion.velocity[i],
            variance: motion.covariance[i][i].max(0.0),
        };
        let (slip, share) = slip_of_log(belief.mean[SLIP]);
        let place = [X, Y, HEADING];
        FilterOutput {
            time_ns,
            time_slip: match (self.now_ns, input.newest_ns()) {
                (Some(now_ns), Some(newest_ns)) => seconds_between(now_ns, newest_ns).max(0.0),
                _ => 0.0,
            },
            wheels: &self.estimates,
            checks: self.gather.checks.found(),
            body: BodyEstimate {
                forward: speed(0),
                left: speed(1),
                yaw_rate: speed(2),
                velocity_covariance: motion.covariance,
                common_slip: Measured {
                    value: slip,
                    variance: share * share * belief.covariance[SLIP][SLIP].max(0.0),
                },
                odometry: Odometry {
                    x: belief.mean[X],
                    y: belief.mean[Y],
                    yaw: belief.mean[HEADING],
                    covariance: place.map(|i| place.map(|j| belief.covariance[i][j])),
                },
                distance: self.distance,
                distance_of_wheels: self.distance_of_wheels,
            },
            rejected: input.rejected,
            dropped: input.clocks.dropped,
            clock_steps: input.clocks.steps,
            reference_readings: count(self.readings[0]).saturating_add(self.references.lost),
            reference_refused: count(self.readings[1]).saturating_add(self.references.lost),
            reference_age: self.speed_age(time_ns),
            core: self,
        }
    }
}

fn count(of: f64) -> u64 {
    crate::history::whole(of + 0.5).unsigned_abs()
}
