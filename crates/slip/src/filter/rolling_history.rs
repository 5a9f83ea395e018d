//! How a free wheel has been rolling: whether it has turned, and whether the accelerometer explains its stops.

use super::wheel_update::WheelWindow;
use crate::history::seconds_between;

/// A free wheel faster than this turns for certain, m/s: twice the default low speed.
const TURNING_SPEED_M_PER_S: f64 = 0.04;
/// A jump of a free wheel counts as one only after this long of agreement, s.
const CALM_TIME_S: f64 = 1.0;
/// And only where the accelerometer's variance is below this multiple of the configured one.
const CALM_NOISE_SCALE: f64 = 2.0;
/// The speed of a free wheel is remembered from at least this long ago, s.
const REMEMBERED_TIME_S: f64 = 0.3;

/// A speed along the wheel (m/s) at a time, its variance, and the change of speed by the accelerometer until then.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownSpeed {
    pub(super) time_ns: i64,
    pub(super) speed: f64,
    pub(super) variance: f64,
    pub(super) accel_integral: f64,
}

/// The rolling of one free wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct RollingHistory {
    /// It has turned since the robot stood.
    pub(super) has_turned: bool,
    /// Its stop was expected: it is not a wheel that stopped of itself.
    pub(super) stop_expected: bool,
    /// The time of its last unexpected jump.
    pub(super) jumped_ns: Option<i64>,
    /// It has agreed since; and it had agreed for long before it did not.
    calm_since_ns: Option<i64>,
    pub(super) was_calm: bool,
    /// Its speed, the older first.
    known: [Option<KnownSpeed>; 2],
}

impl Default for RollingHistory {
    fn default() -> Self {
        Self {
            has_turned: false,
            stop_expected: true,
            jumped_ns: None,
            calm_since_ns: None,
            was_calm: false,
            known: [None; 2],
        }
    }
}

impl RollingHistory {
    /// Its rim runs at this speed, m/s.
    pub(super) fn runs(&mut self, rim: f64) {
        self.has_turned |= rim.abs() > TURNING_SPEED_M_PER_S;
    }

    /// The robot stands with all its wheels.
    pub(super) const fn stands(&mut self) {
        self.has_turned = false;
        self.stop_expected = true;
    }

    /// Records whether a window agreed.
    pub(super) fn record(&mut self, w: &WheelWindow, accel_noise_scale: f64) {
        if !w.is_off {
            self.calm_since_ns.get_or_insert(w.to_ns);
        } else if let Some(since) = self.calm_since_ns.take() {
            self.was_calm = seconds_between(since, w.to_ns) >= CALM_TIME_S
                && accel_noise_scale < CALM_NOISE_SCALE;
        }
    }

    /// The wheel turns at a known speed.
    pub(super) fn turns(&mut self, now: KnownSpeed) {
        self.stop_expected = true;
        self.remember(now);
    }

    /// The wheel does not turn, as on a robot that stands.
    pub(super) fn rests(&mut self, now: KnownSpeed) {
        self.remember(KnownSpeed { speed: 0.0, ..now });
    }

    fn remember(&mut self, now: KnownSpeed) {
        let aged = self.known[1]
            .is_none_or(|known| seconds_between(known.time_ns, now.time_ns) >= REMEMBERED_TIME_S);
        if aged {
            self.known = [self.known[1], Some(now)];
        }
    }

    /// A speed that was known up to twice the remembered time ago.
    pub(super) fn known_before(&self) -> Option<KnownSpeed> {
        let [older, newer] = self.known;
        older.or(newer)
    }
}
