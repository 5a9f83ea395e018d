//! Is a speed over ground only the size of the speed, as satellite receivers state it?

use grouser_slip::window::WindowBody;
use grouser_slip::{Measurement, Sample};

/// The wheels must have run this far backwards, m, before a speed that is never negative counts as a mere size.
const MIN_WAY_M: f64 = 1.0;

/// Notices that a speed over ground has no sign: it is never negative, and the wheels ran backwards.
#[derive(Clone, Debug, Default)]
pub(crate) struct SignWatch {
    has_sign: bool,
    /// The way of the wheels backwards while the speed was positive, m.
    backwards: f64,
    /// Do wheels turn backwards too? Distances of the reference forwards and backwards while they turn forwards, m.
    have_wheels_sign: bool,
    by_reference: [f64; 2],
    until_ns: Option<i64>,
}

impl SignWatch {
    pub(crate) fn take(&mut self, sample: &Sample) {
        if let Measurement::Speed { forward, .. } = sample.measurement {
            self.has_sign |= forward < 0.0;
        }
    }

    /// Takes the window that ended at `body.until_ns`, once, and the speeds of the wheels over it, m/s.
    pub(crate) fn step(&mut self, body: &WindowBody, wheels: &[Option<f64>], low_speed: f64) {
        self.have_wheels_sign |= wheels.iter().flatten().any(|speed| *speed < -low_speed);
        let last_ns = std::mem::replace(&mut self.until_ns, body.until_ns);
        let (Some(last_ns), Some(until_ns)) = (last_ns, body.until_ns) else {
            return;
        };
        let (Some(motion), Some(wheels)) = (&body.motion, &body.wheels_motion) else {
            return;
        };
        let [speed, rims] = [motion, wheels].map(|motion| motion.velocity[0]);
        let passed_s = (until_ns.saturating_sub(last_ns) as f64 * 1e-9).min(1.0);
        if rims < -low_speed && speed > low_speed {
            self.backwards -= rims * passed_s;
        } else if rims > low_speed && speed.abs() > low_speed {
            self.by_reference[usize::from(speed < 0.0)] += speed.abs() * passed_s;
        }
    }

    /// Distance of the robot backwards, m, while wheels that never turn backwards turn forwards.
    pub(crate) fn wheels_without_sign(&self) -> Option<f64> {
        let [forwards, backwards] = self.by_reference;
        let both = forwards > MIN_WAY_M && backwards > MIN_WAY_M;
        (both && !self.have_wheels_sign).then_some(backwards)
    }

    /// The way of the wheels backwards, m, beside a speed without a sign.
    pub(crate) fn backwards(&self) -> Option<f64> {
        (!self.has_sign && self.backwards > MIN_WAY_M).then_some(self.backwards)
    }
}
