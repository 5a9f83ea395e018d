//! How long the controller has been without usable slip or speed, and the time between its steps.

use crate::history::seconds_between;

/// A step counts as at most this long, s: what is beyond it the controller did not see.
const MAX_STEP_S: f64 = 0.1;

/// Times the controller's steps and the silence of its sensors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SensorWatchdog {
    last_ns: Option<i64>,
    silence: f64,
}

impl SensorWatchdog {
    /// Seconds since the last step, in [0, `MAX_STEP_S`]; the rest of a longer gap counts as silence.
    pub(super) fn step(&mut self, now_ns: i64) -> f64 {
        let passed = self
            .last_ns
            .replace(now_ns)
            .map_or(0.0, |last| seconds_between(last, now_ns));
        if !(passed >= 0.0) {
            return 0.0;
        }
        if passed > MAX_STEP_S {
            self.silence += passed - MAX_STEP_S;
        }
        passed.min(MAX_STEP_S)
    }

    /// What the step brought; gives the seconds of silence.
    pub(super) fn update(&mut self, is_measured: bool, step: f64) -> f64 {
        self.silence = if is_measured {
            0.0
        } else {
            self.silence + step
        };
        self.silence
    }
}
