//! How far the robot leans.

use grouser_real::Real;

use super::super::observation::RobotObservation;
use super::super::settings::ControlSettings;
use super::slip_monitor::{SLIP_TIME_CONSTANT_S, SLOW_TIME_CONSTANT_S};

/// The robot has leant too far once it lasts this long, s: bumps are shorter.
const TILT_TIME_S: f64 = 0.2;

/// The tilt of the chassis, smoothed like the slip, so that both are of the same moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TiltMonitor {
    now: f64,
    tilt: f64,
    slow: f64,
    exceeded_time: f64,
    /// Has a tilt been measured?
    is_known: bool,
}

impl TiltMonitor {
    pub(super) fn update(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        step: f64,
    ) {
        let (Some(pitch), Some(roll)) = (robot.pitch, robot.roll) else {
            return;
        };
        let level = (Real::cos(pitch) * Real::cos(roll)).clamp(-1.0, 1.0);
        let tilt = Real::acos(level);
        self.now = tilt;
        if !self.is_known {
            // a robot that begins on a slope stands on it
            (self.tilt, self.slow, self.is_known) = (tilt, tilt, true);
        }
        self.tilt += step / (SLIP_TIME_CONSTANT_S + step) * (tilt - self.tilt);
        self.slow += step / (SLOW_TIME_CONSTANT_S + step) * (tilt - self.slow);
        self.exceeded_time = if tilt > settings.max_tilt {
            self.exceeded_time + step
        } else {
            0.0
        };
    }

    /// The last tilt, which is the one that may not exceed the limit, rad.
    pub(super) const fn now(&self) -> f64 {
        self.now
    }

    /// Smoothed tilt, rad.
    pub(super) const fn tilt(&self) -> f64 {
        self.tilt
    }

    /// The greater of the tilt smoothed over one and over four seconds, rad.
    pub(super) fn greatest(&self) -> f64 {
        self.tilt.max(self.slow)
    }

    pub(super) fn is_exceeded(&self) -> bool {
        self.exceeded_time > TILT_TIME_S
    }
}
