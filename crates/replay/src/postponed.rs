//! Readings of a reference whose stamps are early.

use std::collections::VecDeque;

use grouser_slip::{Measurement, Sample};

/// Puts the readings of the reference later by a constant, in the order of time: each belongs beside wheel readings that are
/// stamped later.
#[derive(Debug)]
pub(crate) struct Postponed {
    by_ns: i64,
    waiting: VecDeque<Sample>,
}

impl Postponed {
    pub(crate) fn by(by_ns: i64) -> Self {
        Self {
            by_ns,
            waiting: VecDeque::new(),
        }
    }

    /// Takes the next sample of a log; hands on what comes not later than it.
    pub(crate) fn take(&mut self, mut sample: Sample) -> impl Iterator<Item = Sample> {
        let is_reference = matches!(
            sample.measurement,
            Measurement::Displacement { .. }
                | Measurement::Pose { .. }
                | Measurement::Position { .. }
                | Measurement::Speed { .. }
        );
        let time_ns = sample.time_ns;
        let mut present = Some(sample);
        if self.by_ns != 0 && is_reference {
            sample.time_ns = time_ns.saturating_add(self.by_ns);
            self.waiting.push_back(sample);
            present = None;
        }
        let due = (self.waiting.iter()).take_while(|waiting| waiting.time_ns <= time_ns);
        let due = due.count();
        self.waiting.drain(..due).chain(present)
    }

    /// What is left at the end of the log.
    pub(crate) fn finish(self) -> impl Iterator<Item = Sample> {
        self.waiting.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_of_the_reference_come_later_in_the_order_of_time() {
        let rate = |time_ns| Sample {
            time_ns,
            measurement: Measurement::YawRate { rate: 0.0 },
        };
        let speed = |time_ns| Sample {
            time_ns,
            measurement: Measurement::Speed {
                forward: 1.0,
                left: None,
            },
        };
        let log = [rate(0), speed(5), rate(10), speed(15), rate(20), rate(30)];
        let put = |by_ns| {
            let mut postponed = Postponed::by(by_ns);
            let mut out = Vec::new();
            for sample in log {
                out.extend(postponed.take(sample));
            }
            out.extend(postponed.finish());
            out
        };
        assert_eq!(put(0), log);
        let expected = [rate(0), rate(10), rate(20), speed(25), rate(30), speed(35)];
        assert_eq!(put(20), expected);
    }
}
