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
/// A wheel is as fast as before a jump where it is off by less than this share of the jump.
const RETURN_SHARE: f64 = 0.5;
/// And a jump is over after this long of it, s: two windows of 0.05 s with their jitter.
const RETURN_TIME_S: f64 = 0.09;
/// A longer jump is a change of the skid, s: a robot at 0.1 m/s crosses the rut of a wheel of 0.1 m.
const MAX_JUMP_S: f64 = 1.0;

/// A speed along the wheel (m/s) at a time, its variance, and the change of speed by the accelerometer until then.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownSpeed {
    pub(super) time_ns: i64,
    pub(super) speed: f64,
    pub(super) variance: f64,
    pub(super) accel_integral: f64,
}

/// A jump that may be over soon: a bump or a rut that the wheel crosses.
#[derive(Clone, Copy, Debug)]
struct Jump {
    began_ns: i64,
    /// The motion before.
    before: KnownSpeed,
    /// The skid before, and its variance.
    skid: (f64, f64),
    /// By how much the wheel jumped, m/s.
    size: f64,
    /// Since when the wheel has been as fast as before.
    back_since_ns: Option<i64>,
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
    /// A jump that is not over and not older than [`MAX_JUMP_S`].
    jump: Option<Jump>,
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
            jump: None,
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
        self.jump = None;
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

    /// The wheel jumps; its skid was `skid` (mean, variance).
    pub(super) fn jumps(&mut self, w: &WheelWindow, skid: (f64, f64)) {
        self.jump = self.known_before().map(|before| Jump {
            began_ns: w.to_ns,
            before,
            skid,
            size: w.innovation.abs(),
            back_since_ns: None,
        });
    }

    /// Is the jump over, since the wheel is as fast as the robot by its speed before and the accelerometer since? Returns the
    /// skid before, with its variance.
    pub(super) fn returns(&mut self, w: &WheelWindow, accel_integral: f64) -> Option<(f64, f64)> {
        let jump = self.jump.as_mut()?;
        let expected = jump.before.speed + accel_integral - jump.before.accel_integral;
        let off = w.rim * (1.0 - jump.skid.0) - expected;
        let is_back = off.abs() < RETURN_SHARE * jump.size;
        jump.back_since_ns = is_back.then(|| jump.back_since_ns.unwrap_or(w.to_ns));
        let lasts = |since_ns, time_s| seconds_between(since_ns, w.to_ns) >= time_s;
        let skid = jump.skid;
        let is_over = jump
            .back_since_ns
            .is_some_and(|since| lasts(since, RETURN_TIME_S));
        if is_over || lasts(jump.began_ns, MAX_JUMP_S) {
            self.jump = None;
        }
        if is_over {
            self.jumped_ns = None;
        }
        is_over.then_some(skid)
    }
}

#[cfg(test)]
mod tests;
