//! The clocks of all sensors: late samples, clocks that were set, and missing samples.

use alloc::{boxed::Box, vec};

use super::input::is_reference;
use super::references::MAX_DELAY_S;
use crate::fault::Fault;
use crate::history::{seconds_between, whole};
use crate::sample::{Measurement, Sample};

/// A clock that goes further than this at once has been set, s.
const CLOCK_STEP_S: f64 = 1.0;
/// A sensor whose own time goes back by more than this has had its clock set, s; by less its samples are out of order.
const SET_BACK_S: f64 = 0.1;
/// Sensors that are not a wheel's.
const ROBOT_SENSORS: usize = 6;
/// Sensors of a wheel: rotation, torque, carrier.
const WHEEL_SENSORS: usize = 3;
/// A gap longer than this many periods of the sensor lacks samples.
const GAP_PERIODS: f64 = 1.5;
/// Weight of a new period in the sensor's usual one.
const PERIOD_WEIGHT: f64 = 0.05;
/// No gap counts for more samples than this.
const MAX_MISSING: f64 = 1e6;

/// The meaning of a sample's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClockOutcome {
    /// It continues the samples before.
    Continues,
    /// The clock has been set: time restarts with this sample.
    Set,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sensor {
    last_ns: Option<i64>,
    /// A refused time: the clock was set if this sensor's next time follows it.
    refused_ns: Option<i64>,
    /// The usual period, s; 0 before two samples.
    period: f64,
}

/// The clock of each sensor.
#[derive(Clone, Debug)]
pub(crate) struct SensorClocks {
    wheels: usize,
    sensors: Box<[Sensor]>,
    /// Has any sensor a refused time?
    has_refused: bool,
    /// Number of missing samples.
    pub(crate) dropped: u64,
    /// Number of clock steps followed.
    pub(crate) steps: u64,
}

impl SensorClocks {
    pub(crate) fn new(wheels: usize) -> Self {
        Self {
            wheels,
            sensors: vec![Sensor::default(); ROBOT_SENSORS + WHEEL_SENSORS * wheels]
                .into_boxed_slice(),
            has_refused: false,
            dropped: 0,
            steps: 0,
        }
    }

    /// The sensor of a measurement, and whether it has a regular period.
    fn sensor(&mut self, measurement: &Measurement) -> Result<(&mut Sensor, bool), Fault> {
        let wheels = self.wheels;
        let of = |wheel: usize, part: usize| {
            if wheel < wheels {
                Ok(ROBOT_SENSORS + WHEEL_SENSORS * wheel + part)
            } else {
                Err(Fault::UnknownWheel {
                    index: wheel,
                    wheels,
                })
            }
        };
        let (index, regular) = match *measurement {
            Measurement::Command { .. }
            | Measurement::Inertial { .. }
            | Measurement::JointAngle { .. }
            | Measurement::Steering { .. }
            | Measurement::SteeringAngle { .. }
            | Measurement::Sinkage { .. }
            | Measurement::EntryAngle { .. }
            | Measurement::MotorCurrent { .. } => (0, false),
            Measurement::Acceleration { .. } => (1, true),
            Measurement::YawRate { .. } => (2, true),
            Measurement::Displacement { .. } | Measurement::Pose { .. } => (3, true),
            Measurement::Speed { .. } => (4, true),
            Measurement::Position { .. } => (5, true),
            Measurement::WheelTorque { wheel, .. } => (of(wheel, 1)?, true),
            Measurement::Carrier { wheel, .. } => (of(wheel, 2)?, true),
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => (of(wheel, 0)?, true),
            Measurement::WheelEdge { wheel, .. } => (of(wheel, 0)?, false),
        };
        Ok((&mut self.sensors[index], regular))
    }

    /// Checks a sample's time against the newest of all sensors and the time up to which samples have been used.
    ///
    /// A time that does not fit is refused. A second one of the same sensor that follows it is a clock that was set, if
    /// no sample that fits came in between.
    pub(crate) fn check(
        &mut self,
        sample: &Sample,
        newest_ns: Option<i64>,
        used_ns: Option<i64>,
    ) -> Result<ClockOutcome, Fault> {
        let time_ns = sample.time_ns;
        let (sensor, regular) = self.sensor(&sample.measurement)?;
        let Some(newest) = newest_ns else {
            *sensor = Sensor {
                last_ns: Some(time_ns),
                refused_ns: None,
                period: sensor.period,
            };
            return Ok(ClockOutcome::Continues);
        };
        let far = seconds_between(newest, time_ns).abs() > CLOCK_STEP_S;
        // A reading of the reference may be late: it is applied through the history.
        let after_own = sensor.last_ns.is_none_or(|last| time_ns > last);
        let may_be_late = is_reference(&sample.measurement)
            && after_own
            && seconds_between(time_ns, newest) <= MAX_DELAY_S;
        let late = !may_be_late && used_ns.is_some_and(|used| time_ns < used);
        if !far && !late {
            let passed = sensor
                .last_ns
                .map_or(0.0, |last| seconds_between(last, time_ns));
            sensor.last_ns = Some(time_ns);
            let mut missing = 0.0;
            if regular && passed > 0.0 {
                if sensor.period > 0.0 {
                    if passed > GAP_PERIODS * sensor.period {
                        missing = (passed / sensor.period - 0.5).min(MAX_MISSING);
                    }
                    sensor.period += PERIOD_WEIGHT * (passed - sensor.period);
                } else {
                    sensor.period = passed;
                }
            }
            self.dropped = self.dropped.saturating_add(whole(missing).unsigned_abs());
            // all sensors share one clock: a sample that fits shows that it was not set
            if core::mem::take(&mut self.has_refused) {
                for sensor in &mut self.sensors {
                    sensor.refused_ns = None;
                }
            }
            return Ok(ClockOutcome::Continues);
        }
        let back = sensor
            .last_ns
            .is_some_and(|last| seconds_between(time_ns, last) > SET_BACK_S);
        if far || back {
            let follows = sensor.refused_ns.is_some_and(|refused| {
                let step = seconds_between(refused, time_ns);
                step > 0.0 && step <= CLOCK_STEP_S
            });
            if follows {
                self.restart(time_ns, &sample.measurement);
                return Ok(ClockOutcome::Set);
            }
            sensor.refused_ns = Some(time_ns);
            self.has_refused = true;
        }
        Err(if far {
            Fault::ClockStep {
                time_ns,
                last_ns: newest,
            }
        } else {
            Fault::NotLater {
                time_ns,
                last_ns: used_ns.unwrap_or(newest),
            }
        })
    }

    fn restart(&mut self, time_ns: i64, measurement: &Measurement) {
        self.steps = self.steps.saturating_add(1);
        for sensor in &mut self.sensors {
            sensor.last_ns = None;
            sensor.refused_ns = None;
        }
        if let Ok((sensor, _)) = self.sensor(measurement) {
            sensor.last_ns = Some(time_ns);
        }
    }
}

#[cfg(test)]
mod tests;
