//! Readings of sensors whose stamps are early.

use std::collections::VecDeque;

use grouser_slip::{Measurement, Sample};

/// Puts readings later by a constant of their sensor, in the order of time: each belongs next to readings of other sensors that
/// are stamped later.
#[derive(Debug)]
pub(crate) struct Postponed {
    /// Of the reference, of the gyro, and of all else, ns.
    by_ns: [i64; 3],
    waiting: VecDeque<Sample>,
}

impl Postponed {
    /// By how much later the reference is put than the wheels, and by how much the gyro's stamps are later than theirs, s.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "they are at most some seconds"
    )]
    pub(crate) fn by(reference_s: f64, late_gyro_s: f64) -> Self {
        let ns = |seconds: f64| (seconds * 1e9).round() as i64;
        let wheels = ns(late_gyro_s.max(0.0));
        Self {
            by_ns: [
                wheels + ns(reference_s),
                ns((-late_gyro_s).max(0.0)),
                wheels,
            ],
            waiting: VecDeque::new(),
        }
    }

    /// Takes the next sample of a log; hands on what comes not later than it.
    pub(crate) fn take(&mut self, mut sample: Sample) -> impl Iterator<Item = Sample> {
        let [reference, gyro, wheels] = self.by_ns;
        let by_ns = match sample.measurement {
            Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Position { .. }
            | Measurement::Speed { .. } => reference,
            Measurement::YawRate { .. } | Measurement::Acceleration { .. } => gyro,
            _ => wheels,
        };
        let now_ns = sample.time_ns;
        sample.time_ns = now_ns.saturating_add(by_ns);
        let mut present = Some(sample);
        if by_ns != 0 {
            let next = self
                .waiting
                .partition_point(|of| of.time_ns <= sample.time_ns);
            self.waiting.insert(next, sample);
            present = None;
        }
        let due = self
            .waiting
            .partition_point(|waiting| waiting.time_ns <= now_ns);
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
        let put = |by_ns: f64| {
            let mut postponed = Postponed::by(1e-9 * by_ns, 0.0);
            let mut out = Vec::new();
            for sample in log {
                out.extend(postponed.take(sample));
            }
            out.extend(postponed.finish());
            out
        };
        assert_eq!(put(0.0), log);
        let expected = [rate(0), rate(10), rate(20), speed(25), rate(30), speed(35)];
        assert_eq!(put(20.0), expected);
    }
}
