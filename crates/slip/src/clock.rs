//! The times of one sensor: what follows what.

use crate::fault::Fault;
use crate::history::seconds_between;

/// The clock of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    last_ns: Option<i64>,
    /// A refused time: a second one after it is a clock that was set back.
    refused_ns: Option<i64>,
}

/// What a sample's time means for its sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// The first sample, or the first after a gap or a clock step: nothing before it counts.
    Start,
    /// This many seconds after the last one.
    After(f64),
}

impl Clock {
    /// Takes a sample's time. A gap longer than `gap` seconds starts anew, at the cost of one sample.
    pub(crate) fn accept(&mut self, time_ns: i64, gap: f64) -> Result<Step, Fault> {
        let Some(last_ns) = self.last_ns else {
            self.last_ns = Some(time_ns);
            return Ok(Step::Start);
        };
        if time_ns > last_ns {
            self.last_ns = Some(time_ns);
            self.refused_ns = None;
            let elapsed = seconds_between(last_ns, time_ns);
            return Ok(if elapsed <= gap {
                Step::After(elapsed)
            } else {
                Step::Start
            });
        }
        if self.refused_ns.is_some_and(|refused| time_ns > refused) {
            *self = Self {
                last_ns: Some(time_ns),
                refused_ns: None,
            };
            return Ok(Step::Start);
        }
        self.refused_ns = Some(time_ns);
        Err(Fault::NotLater { time_ns, last_ns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_begins_where_it_is_longer_than_its_limit() {
        let mut clock = Clock::default();
        assert_eq!(clock.accept(0, 1.0), Ok(Step::Start));
        assert_eq!(clock.accept(1_000_000_000, 1.0), Ok(Step::After(1.0)));
        assert_eq!(clock.accept(2_000_000_001, 1.0), Ok(Step::Start));
    }

    #[test]
    fn two_refused_times_that_follow_each_other_are_a_clock_that_was_set_back() {
        let mut clock = Clock::default();
        clock.accept(10, 1.0).unwrap();
        let refused = |time_ns| {
            Err(Fault::NotLater {
                time_ns,
                last_ns: 10,
            })
        };
        // the last time again was not set back, and one time twice does not follow itself
        for time_ns in [10, 5, 5] {
            assert_eq!(clock.accept(time_ns, 1.0), refused(time_ns));
        }
        assert_eq!(clock.accept(7, 1.0), Ok(Step::Start));
        assert_eq!(clock.accept(8, 1.0), Ok(Step::After(1e-9)));
    }
}
