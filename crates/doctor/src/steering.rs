//! Angles by which wheels are steered, and what they are as sensors.

use grouser_files::steering::{Steering, SteeringKind};
use grouser_slip::{Measurement, Sample};

/// No steering turns the wheels of one angle as far, rad (86°), and no wheel that is steered by itself: such angles have another unit.
/// Limits.
const MAX_STEERING_RAD: f64 = 1.5;
const MAX_WHEEL_STEERING_RAD: f64 = 7.0;
/// One in as many readings is an outlier.
const READINGS_PER_OUTLIER: i64 = 50;

/// Watches the angles over a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Angles {
    /// Does one angle steer wheels of one body?
    is_ackermann: bool,
    /// Are wheels steered each by an angle?
    pub(crate) are_wheels_steered: bool,
    /// Readings that no steering has, each less those that may pass for outliers; `None` without readings.
    beyond: Option<i64>,
}

impl Angles {
    pub(crate) fn new(steering: Option<&Steering>) -> Self {
        Self {
            is_ackermann: steering.is_some_and(|steering| steering.kind == SteeringKind::Ackermann),
            ..Self::default()
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        match sample.measurement {
            Measurement::SteeringAngle { angle, .. } => {
                self.are_wheels_steered = true;
                self.count(angle.abs() > MAX_WHEEL_STEERING_RAD);
            }
            Measurement::Steering { angle } if self.is_ackermann => {
                self.count(angle.abs() > MAX_STEERING_RAD);
            }
            _ => {}
        }
    }

    fn count(&mut self, is_beyond: bool) {
        *self.beyond.get_or_insert(0) += if is_beyond { READINGS_PER_OUTLIER } else { -1 };
    }

    /// Does the robot turn as its wheels are steered?
    pub(crate) const fn is_steered(&self) -> bool {
        self.beyond.is_some()
    }

    /// Are the angles in another unit than described?
    pub(crate) fn have_other_unit(&self) -> bool {
        self.beyond.is_some_and(|beyond| beyond > 0)
    }
}
