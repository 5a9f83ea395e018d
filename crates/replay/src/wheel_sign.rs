//! The sign of a speed over ground of which only the size is measured, as satellite receivers state it.

use grouser_doctor::wheel_travel;
use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample, Wheel, WheelRole};

/// Time constant with which the ways of the rims decay, s: longer than the time between two ticks of a slow wheel, shorter than that
/// in which a robot reverses.
const FADE_S: f64 = 0.2;

/// Gives a size of the speed over ground the sign of the powered wheels.
#[derive(Clone, Debug)]
pub(crate) struct WheelSign {
    /// The powered wheels with their last reading; `None` of the others.
    wheels: Vec<Option<(Wheel, Option<Sample>)>>,
    /// The way of the rims forwards, m, faded.
    way: f64,
    until_ns: Option<i64>,
}

impl WheelSign {
    /// For the wheels of `robot`.
    pub(crate) fn new(robot: &Robot) -> Self {
        let of = |wheel: &Wheel| {
            let is_powered = wheel.role == WheelRole::Powered;
            is_powered.then(|| (wheel.clone(), None))
        };
        Self {
            wheels: robot.wheels().iter().map(of).collect(),
            way: 0.0,
            until_ns: None,
        }
    }

    /// Takes a reading of a wheel, or changes one of the speed.
    pub(crate) fn apply(&mut self, sample: &mut Sample) {
        if let Measurement::Speed { forward, .. } = &mut sample.measurement {
            if self.way < 0.0 {
                *forward = -*forward;
            }
            return;
        }
        let index = sample.measurement.wheel();
        let wheel = index.and_then(|index| self.wheels.get_mut(index)?.as_mut());
        let Some((wheel, last)) = wheel.filter(|_| sample.measurement.is_rotation()) else {
            return;
        };
        let Some(before) = last.replace(*sample) else {
            return;
        };
        let passed_s = sample.time_ns.saturating_sub(before.time_ns) as f64 * 1e-9;
        let way = wheel_travel(wheel, &before.measurement, &sample.measurement, passed_s);
        if !way.is_finite() {
            // another sensor of the same wheel: the first counts
            *last = Some(before);
            return;
        }
        let until_ns = self.until_ns.replace(sample.time_ns);
        let since_ns = until_ns.map_or(0, |until_ns| sample.time_ns.saturating_sub(until_ns));
        self.way *= Real::exp(-(since_ns as f64) * 1e-9 / FADE_S);
        self.way += way * wheel.heading.cos();
    }
}
