//! A reference that stops while the robot drives on: tracking is lost, and a driver repeats the last pose.

use grouser_real::Real;
use grouser_slip::{Measurement, Sample};

/// A place within this distance is the same, m: noise of a tracker.
const SAME_PLACE_M: f64 = 0.05;
/// The wheels run this far meanwhile, m, and the reference then jumps by this, m, and by this multiple of what they ran since its last
/// reading: a robot that digs in drives on from where it was.
const MIN_RUN_M: f64 = 1.0;
const MIN_JUMP_M: f64 = 0.3;
const JUMP_RUNS: f64 = 3.0;

/// Watches for a reference that is constant while the wheels drive, and then jumps.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrozenWatch {
    start_ns: Option<i64>,
    /// Distance by the wheels so far, m.
    ran: f64,
    stepped_ns: Option<i64>,
    /// Where the reference has been since when, and how far the wheels had run then.
    anchor: Option<([f64; 2], i64, f64)>,
    last: Option<([f64; 2], f64)>,
    found_s: Option<[f64; 2]>,
}

impl FrozenWatch {
    /// Takes the mean speed of the powered wheels, m/s.
    pub(crate) fn step(&mut self, now_ns: i64, speed: f64) {
        let last_ns = self.stepped_ns.replace(now_ns).unwrap_or(now_ns);
        let passed_s = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        if speed.is_finite() {
            self.ran += speed.abs() * passed_s.min(1.0);
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        let now_ns = sample.time_ns;
        let start_ns = *self.start_ns.get_or_insert(now_ns);
        let (Measurement::Pose { x, y, .. } | Measurement::Position { x, y }) = sample.measurement
        else {
            return;
        };
        let here = [x, y];
        let distance = |from: [f64; 2]| Real::hypot(x - from[0], y - from[1]);
        let (last, last_ran) = self
            .last
            .replace((here, self.ran))
            .unwrap_or((here, self.ran));
        let (place, since_ns, ran) = *self.anchor.get_or_insert((here, now_ns, self.ran));
        if distance(place) < SAME_PLACE_M {
            return;
        }
        let jump = distance(last);
        let is_jump = jump > MIN_JUMP_M + JUMP_RUNS * (self.ran - last_ran);
        if is_jump && self.ran - ran > MIN_RUN_M {
            let seconds = |time_ns: i64| time_ns.saturating_sub(start_ns) as f64 * 1e-9;
            self.found_s
                .get_or_insert([seconds(since_ns), seconds(now_ns)]);
        }
        self.anchor = Some((here, now_ns, self.ran));
    }

    /// The first span in which it stood, s from the start of the log.
    pub(crate) const fn found_s(&self) -> Option<[f64; 2]> {
        self.found_s
    }
}
