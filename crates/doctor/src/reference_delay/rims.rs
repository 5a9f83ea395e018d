//! The way of the rims along the robot.

use grouser_files::robot::RobotFile;
use grouser_real::Real;
use grouser_slip::{Measurement, Sample, Wheel, WheelRole};

use super::track::Track;
use crate::motion::{common_heading, wheel_travel};

/// A wheel that is read less often is not known in between, s.
const MAX_GAP_S: f64 = 0.5;
/// A forgotten gear makes wheels faster than a robot; this many times its speed is a counter that was reset.
const MAX_GEAR: f64 = 50.0;
/// Wheels whose headings differ by less (cosine) drive one way.
const PARALLEL_COSINE: f64 = 0.98;

/// The mean way of the powered wheels along their heading. Steered ones count by the cosine of their angle.
#[derive(Clone, Debug)]
pub(crate) struct Rims {
    pub(crate) track: Track,
    /// Cosine and sine of the heading; `None` of a robot whose wheels point apart.
    pub(crate) along: Option<[f64; 2]>,
    wheels: Vec<Rim>,
    /// Of a wheel in the mean.
    share: f64,
    max_speed: f64,
}

#[derive(Clone, Debug)]
struct Rim {
    wheel: Wheel,
    cosine: f64,
    last: Option<(f64, Measurement)>,
}

impl Rims {
    pub(super) fn new(file: &RobotFile) -> Self {
        let of = |wheel: &Wheel| Rim {
            wheel: wheel.clone(),
            cosine: 1.0,
            last: None,
        };
        let wheels: Vec<Rim> = file.robot.wheels().iter().map(of).collect();
        let powered = wheels
            .iter()
            .filter(|rim| rim.wheel.role == WheelRole::Powered);
        Self {
            track: Track::default(),
            along: common_heading(&file.robot, PARALLEL_COSINE),
            share: 1.0 / (powered.count().max(1) as f64),
            wheels,
            max_speed: MAX_GEAR * file.settings.max_speed,
        }
    }

    /// Takes a reading of a wheel or of its steering; others have no effect.
    pub(super) fn take(&mut self, time_s: f64, sample: &Sample) {
        if let Measurement::SteeringAngle { wheel, angle } = sample.measurement
            && let Some(rim) = self.wheels.get_mut(wheel)
        {
            rim.cosine = Real::cos(angle);
        }
        let Some(rim) = (sample.measurement.wheel()).and_then(|wheel| self.wheels.get_mut(wheel))
        else {
            return;
        };
        if rim.wheel.role != WheelRole::Powered
            || !sample.measurement.is_rotation()
            || self.along.is_none()
        {
            return;
        }
        let Some((last_s, last)) = rim.last.replace((time_s, sample.measurement)) else {
            return;
        };
        let passed_s = time_s - last_s;
        let way = wheel_travel(&rim.wheel, &last, &sample.measurement, passed_s) * rim.cosine;
        if passed_s <= MAX_GAP_S && way.abs() <= self.max_speed * passed_s {
            self.track.add(time_s, self.share * way);
        } else {
            self.track.interrupt(time_s);
        }
    }
}
