//! The clocks of all sensors together: what is late, what was set, what is missing.

use alloc::{boxed::Box, vec};

use super::CLOCK_STEP;
use crate::fault::Fault;
use crate::history::{seconds_between, whole};
use crate::sample::{Measurement, Sample};

/// A sensor whose own time goes back by more than this has another clock; by less it is waited for, s.
const SET_BACK: f64 = 0.1;
/// Sensors that are not a wheel's.
const OTHERS: usize = 5;
/// A wheel's: its rotation, its torque, its carrier.
const PER_WHEEL: usize = 3;
/// A gap longer than this many usual periods lacks samples.
const GAP: f64 = 1.5;
/// How fast the usual period is learnt, a sample.
const USUAL: f64 = 0.05;
/// No gap counts for more samples than this.
const MOST: f64 = 1e6;

/// What a sample's time means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Told {
    /// It goes on from the samples before.
    GoesOn,
    /// The clock has been set: all begins anew with this sample.
    Set,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sensor {
    last_ns: Option<i64>,
    /// A time that did not fit: the clock was set if this sensor's next one follows it.
    refused_ns: Option<i64>,
    /// Between two samples, s; 0 where not known.
    period: f64,
}

/// One clock for each sensor.
#[derive(Clone, Debug)]
pub(super) struct Clocks {
    wheels: usize,
    sensors: Box<[Sensor]>,
    /// Samples that should have come between those that did.
    pub(super) dropped: u64,
    /// How often the clock was set.
    pub(super) steps: u64,
}

impl Clocks {
    pub(super) fn new(wheels: usize) -> Self {
        Self {
            wheels,
            sensors: vec![Sensor::default(); OTHERS + PER_WHEEL * wheels].into_boxed_slice(),
            dropped: 0,
            steps: 0,
        }
    }

    /// Which sensor gave it, and does it come at regular times?
    fn sensor(&mut self, measurement: &Measurement) -> Result<(&mut Sensor, bool), Fault> {
        let wheels = self.wheels;
        let of = |wheel: usize, part: usize| {
            if wheel < wheels {
                Ok(OTHERS + PER_WHEEL * wheel + part)
            } else {
                Err(Fault::UnknownWheel {
                    index: wheel,
                    wheels,
                })
            }
        };
        let (index, regular) = match *measurement {
            Measurement::Command { .. } => (0, false),
            Measurement::Acceleration { .. } => (1, true),
            Measurement::YawRate { .. } => (2, true),
            Measurement::Displacement { .. } | Measurement::Pose { .. } => (3, true),
            Measurement::Speed { .. } => (4, true),
            Measurement::WheelTorque { wheel, .. } => (of(wheel, 1)?, true),
            Measurement::Carrier { wheel, .. } => (of(wheel, 2)?, true),
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => (of(wheel, 0)?, true),
            Measurement::WheelEdge { wheel, .. } => (of(wheel, 0)?, false),
        };
        Ok((&mut self.sensors[index], regular))
    }

    /// Looks at a sample's time beside the newest of all sensors' and that up to which samples have been used.
    ///
    /// A time that does not fit is refused. The second one of the same sensor that follows it is a clock that was set, if
    /// nothing that fits came in between.
    pub(super) fn take(
        &mut self,
        sample: &Sample,
        newest_ns: Option<i64>,
        used_ns: Option<i64>,
    ) -> Result<Told, Fault> {
        let time_ns = sample.time_ns;
        let (sensor, regular) = self.sensor(&sample.measurement)?;
        let Some(newest) = newest_ns else {
            *sensor = Sensor {
                last_ns: Some(time_ns),
                refused_ns: None,
                period: sensor.period,
            };
            return Ok(Told::GoesOn);
        };
        let far = seconds_between(newest, time_ns).abs() > CLOCK_STEP;
        let late = used_ns.is_some_and(|used| time_ns < used);
        if !far && !late {
            let passed = sensor
                .last_ns
                .map_or(0.0, |last| seconds_between(last, time_ns));
            sensor.last_ns = Some(time_ns);
            let mut missing = 0.0;
            if regular && passed > 0.0 {
                if sensor.period > 0.0 {
                    if passed > GAP * sensor.period {
                        missing = (passed / sensor.period - 0.5).min(MOST);
                    }
                    sensor.period += USUAL * (passed - sensor.period);
                } else {
                    sensor.period = passed;
                }
            }
            self.dropped = self.dropped.saturating_add(whole(missing).unsigned_abs());
            // all sensors share one clock: what fits says that it was not set
            for sensor in &mut self.sensors {
                sensor.refused_ns = None;
            }
            return Ok(Told::GoesOn);
        }
        let back = sensor
            .last_ns
            .is_some_and(|last| seconds_between(time_ns, last) > SET_BACK);
        if far || back {
            let follows = sensor.refused_ns.is_some_and(|refused| {
                let step = seconds_between(refused, time_ns);
                step > 0.0 && step <= CLOCK_STEP
            });
            if follows {
                self.restart(time_ns, &sample.measurement);
                return Ok(Told::Set);
            }
            if sensor.refused_ns != Some(time_ns) {
                sensor.refused_ns = Some(time_ns);
            }
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
