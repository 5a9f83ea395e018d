//! Ground that is softer than the known soil: found by its slip and by the torque that it takes.

use grouser_real::Real;

use super::super::observation::RobotObservation;
use super::super::settings::ControlSettings;
use crate::filter::SlipPrior;

/// Slip is smoothed over this time before it is compared with the demand, s: a fifth of the time that decisions about
/// digging take.
const TIME_CONSTANT_S: f64 = 0.2;
/// Slip counts as higher than the demand from this many standard deviations of both.
const CERTAINTY_SIGMA: f64 = 2.0;
/// Soft ground has been entered from this share of the margin to a detection. Tuned on `soft-patch.toml`.
const ENTERED_SHARE: f64 = 0.4;
/// No ground that takes less slip than this share of the optimum is soft.
const MIN_OPTIMUM_SHARE: f64 = 0.5;
/// The robot is no further in soft ground than this, m: longer ways are ground that changes slowly.
const MAX_DEPTH_M: f64 = 3.0;
/// A robot slower than this stands, m/s.
pub(super) const STANDSTILL_SPEED_M_PER_S: f64 = 0.02;
/// Soil under a wheel that starts is sheared once it has rolled this far, m: ten times the shear modulus of the shipped
/// soils.
const SHEARED_DISTANCE_M: f64 = 0.25;

/// Compares slip and torque with what the known soil would take.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SoftGroundMonitor {
    slip: f64,
    side_difference: f64,
    /// Slip above the demand, and for how long, s.
    excess: f64,
    excess_time: f64,
    /// Firmness, and how long it has been low, s.
    firmness: f64,
    soft_time: f64,
    /// How far the robot has travelled since the slip was last what is demanded, m.
    depth: f64,
    /// How far it has rolled since it stood or changed its mode, m.
    rolled: f64,
}

impl SoftGroundMonitor {
    /// One step. `is_ahead` says whether the robot drives on level ground; while it backs out nothing counts.
    pub(super) fn update(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        (drives_level, is_backing_out): (bool, bool),
        step: f64,
    ) {
        let speed = robot.speed.unwrap_or(0.0).abs();
        self.rolled = if speed < STANDSTILL_SPEED_M_PER_S {
            0.0
        } else {
            self.rolled + step * speed
        };
        let counts = drives_level && self.rolled > SHEARED_DISTANCE_M && !is_backing_out;
        let share = step / (TIME_CONSTANT_S + step);
        if let Some(slip) = robot.slip {
            self.slip += share * (slip - self.slip);
            self.side_difference += share * (robot.side_difference - self.side_difference);
        }
        let beyond = |demand: SlipPrior, share: f64| {
            let sigma = Real::hypot(demand.sigma, robot.slip_sigma);
            let margin = (CERTAINTY_SIGMA * sigma).max(settings.soft_slip);
            let least = MIN_OPTIMUM_SHARE * settings.optimum;
            self.slip - (demand.mean + share * margin).max(least)
        };
        self.excess = robot.slip_demand.map_or(0.0, |demand| beyond(demand, 1.0));
        let entered = robot
            .slip_demand
            .is_some_and(|demand| beyond(demand, ENTERED_SHARE) > 0.0);
        if counts {
            self.depth = if entered {
                self.depth + step * speed
            } else {
                0.0
            };
        }
        self.soft_time = if counts && robot.firmness < settings.soft_firmness {
            self.soft_time + step
        } else {
            (self.soft_time - step).max(0.0)
        };
        self.firmness = robot.firmness;
        self.excess_time = if counts && self.excess > 0.0 {
            self.excess_time + step
        } else {
            0.0
        };
    }

    pub(super) const fn reset_rolling(&mut self) {
        self.rolled = 0.0;
    }

    pub(super) const fn reset_timers(&mut self) {
        self.excess_time = 0.0;
        self.soft_time = 0.0;
    }

    pub(super) fn is_soft(&self, settings: &ControlSettings) -> bool {
        self.excess_time >= settings.soft_time || self.soft_time >= settings.soft_time
    }

    /// How much softer the ground is on the left than on the right.
    pub(super) const fn side_difference(&self) -> f64 {
        self.side_difference
    }

    /// How far to back out until all wheels stand on known ground, m.
    pub(super) fn take_back_length(&mut self, settings: &ControlSettings) -> f64 {
        let depth = core::mem::take(&mut self.depth);
        settings.soft_back + depth.min(MAX_DEPTH_M)
    }

    /// The slip and what it exceeds, or the firmness and what it falls below.
    pub(super) fn values(&self, settings: &ControlSettings) -> (f64, f64) {
        if self.soft_time >= settings.soft_time {
            (self.firmness, settings.soft_firmness)
        } else {
            (self.slip, self.slip - self.excess)
        }
    }
}
