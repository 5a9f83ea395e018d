//! The sign of a speed over ground of which only the size is measured, as satellite receivers state it.

use grouser_real::Real;
use grouser_slip::window::WindowBody;
use grouser_slip::{Measurement, Robot, Sample, Wheel, WheelRole};

use crate::motion::wheel_travel;

/// Time constant with which the ways of the rims decay, s: longer than the time between two ticks of a slow wheel, shorter than that
/// in which a robot reverses.
const FADE_S: f64 = 0.2;
/// The wheels must have run this far backwards, m, before a speed that is never negative counts as a mere size.
const MIN_WAY_M: f64 = 1.0;

/// Gives a size of the speed over ground the sign of the powered wheels.
///
/// ```
/// use grouser_doctor::WheelSign;
/// use grouser_slip::{Measurement, Robot, Sample, Wheel};
///
/// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").radius(0.1)])?;
/// let mut sign = WheelSign::new(&robot);
/// let of = |time_ns, measurement| Sample { time_ns, measurement };
/// for time_ns in [0, 100_000_000] {
///     sign.apply(&mut of(time_ns, Measurement::WheelRate { wheel: 0, rate: -2.0 }));
/// }
/// let mut speed = of(100_000_000, Measurement::Speed { forward: 0.2, left: None });
/// sign.apply(&mut speed);
/// assert!(matches!(speed.measurement, Measurement::Speed { forward, .. } if forward == -0.2));
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct WheelSign {
    /// The powered wheels with their last reading; `None` of the others.
    wheels: Vec<Option<(Wheel, Option<Sample>)>>,
    /// The way of the rims forwards, m, faded.
    way: f64,
    until_ns: Option<i64>,
}

impl WheelSign {
    /// For the wheels of `robot`.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
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
    pub fn apply(&mut self, sample: &mut Sample) {
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

/// Notices that a speed over ground has no sign: it is never negative, and the wheels ran backwards.
#[derive(Clone, Debug, Default)]
pub(crate) struct SignWatch {
    has_sign: bool,
    /// The way of the wheels backwards while the speed was positive, m.
    backwards: f64,
    until_ns: Option<i64>,
}

impl SignWatch {
    pub(crate) fn take(&mut self, sample: &Sample) {
        if let Measurement::Speed { forward, .. } = sample.measurement {
            self.has_sign |= forward < 0.0;
        }
    }

    /// Takes the window that ended at `body.until_ns`, once.
    pub(crate) fn step(&mut self, body: &WindowBody, low_speed: f64) {
        let last_ns = std::mem::replace(&mut self.until_ns, body.until_ns);
        let (Some(last_ns), Some(until_ns)) = (last_ns, body.until_ns) else {
            return;
        };
        let (Some(motion), Some(wheels)) = (&body.motion, &body.wheels_motion) else {
            return;
        };
        let [speed, rims] = [motion, wheels].map(|motion| motion.velocity[0]);
        if rims < -low_speed && speed > low_speed {
            let passed_s = (until_ns.saturating_sub(last_ns) as f64 * 1e-9).min(1.0);
            self.backwards -= rims * passed_s;
        }
    }

    /// The way of the wheels backwards, m, beside a speed without a sign.
    pub(crate) fn backwards(&self) -> Option<f64> {
        (!self.has_sign && self.backwards > MIN_WAY_M).then_some(self.backwards)
    }
}
