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
        if time_ns < last_ns {
            self.refused_ns = Some(time_ns);
        }
        Err(Fault::NotLater { time_ns, last_ns })
    }
}
