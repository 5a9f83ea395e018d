//! How long the controller has been without usable slip or speed, and the time between its steps.

use crate::history::seconds_between;

/// A step counts as at most this long, s: the rest of a longer gap counts as silence.
const MAX_STEP_S: f64 = 0.1;
/// A step counts as this long where the clock does not advance, s: half of the slowest rate of the loop (20 Hz).
const STOPPED_CLOCK_STEP_S: f64 = 0.025;
/// Silence is forgotten this many times as fast as it grows: sensors that are silent for more than four fifths of the time
/// are as good as lost, single dropouts are not.
const FORGETTING_RATE: f64 = 4.0;

/// Times the controller's steps and the silence of its sensors and of its clock.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SensorWatchdog {
    last_ns: Option<i64>,
    silence: f64,
    /// How long the clock has not advanced, s, by the number of steps.
    clock_silence: f64,
}

impl SensorWatchdog {
    /// Seconds since the last step, in [0, `MAX_STEP_S`].
    pub(super) fn step(&mut self, now_ns: i64) -> f64 {
        let Some(last_ns) = self.last_ns.replace(now_ns) else {
            return 0.0;
        };
        let passed = seconds_between(last_ns, now_ns);
        if passed > 0.0 {
            self.clock_silence = 0.0;
            self.silence += (passed - MAX_STEP_S).max(0.0);
            return passed.min(MAX_STEP_S);
        }
        self.clock_silence += STOPPED_CLOCK_STEP_S;
        0.0
    }

    /// What the step brought; gives the seconds of silence of sensors or clock.
    pub(super) fn update(&mut self, is_measured: bool, step: f64) -> f64 {
        self.silence = if is_measured {
            (self.silence - FORGETTING_RATE * step).max(0.0)
        } else {
            self.silence + step
        };
        self.silence.max(self.clock_silence)
    }

    /// The step by which rims slow down: a robot that stops because its clock stands must still come to rest.
    pub(super) fn ramp_step(&self, step: f64) -> f64 {
        if self.clock_silence > 0.0 {
            STOPPED_CLOCK_STEP_S
        } else {
            step
        }
    }
}
