//! What the filter knows, for others to read.

use super::SlipFilter;
use super::body::{COMMON_SLIP, FORWARD, HEADING, LEFT, PLACE, YAW};
use crate::body::Observations;
use crate::fault::Rejected;
use crate::history::seconds_between;
use crate::speed::Measured;
use crate::wheel_estimate::WheelEstimate;

/// What a wheel's rim says of the robot's speed where slip is not compensated, m/s; and how far that robot may drift
/// sideways and turn where its wheels say nothing of it, m/s and rad/s.
const UNCOMPENSATED: (f64, f64, f64) = (0.01, 0.1, 10.0);

/// Where the robot is, from where it began, slip taken out: x forwards and y to the left of how it stood then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Odometry {
    /// m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// Heading, rad, to the left; it goes on past a whole turn.
    pub yaw: f64,
    /// Covariance of the three. It grows with the doubt about slip, and with what else is not known of the motion: it is
    /// carried together with all of that.
    pub covariance: [[f64; 3]; 3],
}

/// What the filter knows of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyEstimate {
    /// Speed forwards, m/s.
    pub forward: Measured,
    /// Speed to the left, m/s.
    pub left: Measured,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: Measured,
    /// The powered wheels' common slip, 1.
    pub common_slip: Measured,
    /// Where it is.
    pub odometry: Odometry,
    /// Way since the start along the robot's own forward direction, m, and what the powered wheels alone would say.
    pub distance: f64,
    /// The same without compensation of slip, m.
    pub distance_of_wheels: f64,
    /// Squared residual of the last measurement over its variance, 1 (NIS): 1 in the mean where sigmas are honest.
    pub nis: f64,
}

/// What a wheel's own readings say of its sensor and its description.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelCheck {
    /// The share of pulses that its counter misses at random, 1, as its unevenness tells (a little below 0 by chance); `None`
    /// where the wheel has hardly turned, too slowly or too fast for its ticks, or gives no counts.
    pub pulses_missed: Option<f64>,
    /// It misses more than .022 beyond what rough ground makes all wheels seem to miss: its slip is too low by that share,
    /// and its health `Degraded(Suspect)`.
    pub misses_pulses: bool,
    /// It lacks a tick at the same place of each turn: a slot or a magnet is broken.
    pub broken_slot: bool,
    /// By what share its radius was told too large, 1, as its slip at no torque tells: so much of its slip is none. `None`
    /// without torques, and until they have changed enough, driving and braking.
    pub radius_excess: Option<Measured>,
}

/// What is known after a sample.
#[derive(Clone, Copy, Debug)]
pub struct FilterOutput<'a> {
    /// Up to when the readings have been used, ns: the horizon behind the newest.
    pub time_ns: i64,
    /// How far that is behind the newest time that was told, s.
    pub time_slip: f64,
    /// Each wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// Each wheel's side slip angle β = atan2(v_across, v_along) of its centre over the ground, rad, positive to the left of
    /// its heading; `None` below `low_speed`, and where it is not known to half a radian.
    pub side_slip_angles: &'a [Option<Measured>],
    /// Each wheel's sensor and description, as far as its readings contradict them.
    pub checks: &'a [WheelCheck],
    /// The robot.
    pub body: BodyEstimate,
    /// Samples refused so far.
    pub rejected: Rejected,
    /// Samples that should have come so far and did not, by the usual time between two of the same sensor.
    pub dropped: u64,
    /// How often a clock that was set has been followed.
    pub clock_steps: u64,
    /// Seconds since a reference for the robot's speed was last believed; `None` before the first.
    pub reference_age: Option<f64>,
}

impl SlipFilter {
    /// What is known now.
    #[must_use]
    pub fn latest(&self) -> FilterOutput<'_> {
        let known = |i: usize| Measured {
            value: self.state.mean(i),
            variance: self.state.covariance(i, i),
        };
        let time_ns = self.now_ns.unwrap_or(0);
        let place = [PLACE[0], PLACE[1], HEADING];
        FilterOutput {
            time_ns,
            time_slip: match (self.now_ns, self.order.newest_ns()) {
                (Some(now_ns), Some(newest_ns)) => seconds_between(now_ns, newest_ns).max(0.0),
                _ => 0.0,
            },
            wheels: &self.estimates,
            side_slip_angles: &self.side_slip_angles,
            checks: &self.checks,
            body: BodyEstimate {
                forward: known(FORWARD),
                left: known(LEFT),
                yaw_rate: known(YAW),
                common_slip: known(COMMON_SLIP),
                odometry: Odometry {
                    x: self.state.mean(PLACE[0]),
                    y: self.state.mean(PLACE[1]),
                    yaw: self.state.mean(HEADING),
                    covariance: place.map(|i| place.map(|j| self.state.covariance(i, j))),
                },
                distance: self.distances[0],
                distance_of_wheels: self.distances[1],
                nis: self.nis,
            },
            rejected: self.rejected,
            dropped: self.clocks.dropped,
            clock_steps: self.clocks.steps,
            reference_age: self.reference_ns.map(|then| seconds_between(then, time_ns)),
        }
    }

    /// The robot's speed forwards if its powered wheels did not slip, m/s: least squares over those that are heard.
    pub(super) fn speed_of_wheels(&self, now_ns: i64) -> f64 {
        let (sigma, drift, turn) = UNCOMPENSATED;
        let of = |value: f64, sigma: f64| Measured {
            value,
            variance: sigma * sigma,
        };
        let mut seen = Observations::default();
        seen.add([0.0, 1.0, 0.0], of(0.0, drift));
        seen.add([0.0, 0.0, 1.0], of(0.0, turn));
        for wheel in self.wheels.iter().filter(|wheel| !wheel.free) {
            let heard = wheel
                .silence(now_ns)
                .is_some_and(|silence| silence <= self.settings.dropout);
            if let Some((rim, _)) = wheel.rim.filter(|_| heard) {
                seen.add(wheel.row, of(rim.value, sigma));
            }
        }
        seen.solve().map_or(0.0, |motion| motion.velocity[0])
    }
}
