//! On after a condition has held for a time, off after its opposite has.

use crate::history::seconds_between;

/// A condition with persistence and hysteresis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Switch {
    on: bool,
    since_ns: Option<i64>,
}

impl Switch {
    pub(super) const fn is_on(&self) -> bool {
        self.on
    }

    /// Is it off, and its condition holds?
    pub(super) const fn is_rising(&self) -> bool {
        !self.on && self.since_ns.is_some()
    }

    /// `on` and `off` are the conditions at `time_ns`; neither leaves it as it is. Gives the new state when it changes, and
    /// the time since when its condition has held.
    pub(super) fn take(
        &mut self,
        time_ns: i64,
        (on, off): (bool, bool),
        (after_on, after_off): (f64, f64),
    ) -> Option<(bool, i64)> {
        let (holds, patience) = if self.on {
            (off, after_off)
        } else {
            (on, after_on)
        };
        if !holds {
            self.since_ns = None;
            return None;
        }
        let since = *self.since_ns.get_or_insert(time_ns);
        let held = seconds_between(since, time_ns);
        if held < 0.0 {
            // the clock was set
            self.since_ns = Some(time_ns);
            return None;
        }
        if held < patience {
            return None;
        }
        self.on = !self.on;
        self.since_ns = None;
        Some((self.on, since))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_for_nothing_without_a_time_and_anew_when_the_clock_is_set() {
        let mut switch = Switch::default();
        assert_eq!(switch.take(5, (true, false), (0.0, 0.0)), Some((true, 5)));
        assert_eq!(switch.take(5, (false, true), (0.0, 0.0)), Some((false, 5)));
        let mut at = |ms: i64, on| {
            let found = switch.take(ms * 1_000_000, (on, !on), (0.1, 0.1));
            (found, switch.is_rising(), switch.is_on())
        };
        assert_eq!(at(500, false), (None, false, false));
        assert_eq!(at(500, true), (None, true, false));
        // set back: not before 0.1 s of the new clock
        assert_eq!(at(300, true), (None, true, false));
        assert_eq!(at(399, true), (None, true, false));
        assert_eq!(at(400, true), (Some((true, 300_000_000)), false, true));
        assert_eq!(at(450, false), (None, false, true));
    }

    #[test]
    fn changes_after_its_time_and_not_for_a_flicker() {
        let mut switch = Switch::default();
        let patience = (0.3, 0.5);
        let mut at = |ms: i64, on: bool| switch.take(ms * 1_000_000, (on, !on), patience);
        for ms in (0..300).step_by(100) {
            assert_eq!(at(ms, true), None);
        }
        assert_eq!(at(290, false), None);
        assert_eq!(at(300, true), None);
        assert_eq!(at(599, true), None);
        assert_eq!(at(600, true), Some((true, 300_000_000)));
        assert_eq!(at(700, false), None);
        assert_eq!(at(1200, false), Some((false, 700_000_000)));
    }
}
