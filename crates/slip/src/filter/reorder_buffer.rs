//! Samples in the order of their time, within a horizon.

use alloc::{boxed::Box, vec};

use crate::robot::MAX_WHEELS;
use crate::sample::{Measurement, Sample};

/// A sorted queue of bounded size.
#[derive(Clone, Debug)]
pub(crate) struct ReorderBuffer {
    /// A ring, the oldest first: a sample mostly is the newest, and moves no other.
    queue: Box<[Sample]>,
    /// Where the oldest is.
    first: usize,
    len: usize,
    horizon_ns: i64,
    newest_ns: Option<i64>,
    released_ns: Option<i64>,
}

/// The outcome of an offered sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Offered {
    /// It waits for its turn.
    Waits,
    /// Samples later than it have been used already.
    TooLate,
}

impl ReorderBuffer {
    pub(crate) fn new(capacity: usize, horizon_ns: i64) -> Self {
        let empty = Sample {
            time_ns: 0,
            measurement: Measurement::YawRate { rate: 0.0 },
        };
        Self {
            queue: vec![empty; capacity.max(1)].into_boxed_slice(),
            first: 0,
            len: 0,
            horizon_ns,
            newest_ns: None,
            released_ns: None,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.newest_ns = None;
        self.released_ns = None;
    }

    pub(crate) const fn newest_ns(&self) -> Option<i64> {
        self.newest_ns
    }

    /// The time up to which samples have been used.
    pub(crate) const fn released_ns(&self) -> Option<i64> {
        self.released_ns
    }

    pub(crate) fn is_full(&self) -> bool {
        self.len == self.queue.len()
    }

    /// Where the sample of a rank is, the oldest's being 0.
    fn place(&self, rank: usize) -> usize {
        let place = self.first + rank;
        if place < self.queue.len() {
            place
        } else {
            place - self.queue.len()
        }
    }

    /// Puts a sample in its place; the caller makes room first ([`ReorderBuffer::release`] while [`ReorderBuffer::is_full`]).
    pub(crate) fn offer(&mut self, sample: Sample) -> Offered {
        if self
            .released_ns
            .is_some_and(|released| sample.time_ns < released)
            || self.is_full()
        {
            return Offered::TooLate;
        }
        let mut place = self.place(self.len);
        let new = order(&sample);
        for _ in 0..self.len {
            let before = place.checked_sub(1).unwrap_or(self.queue.len() - 1);
            if order(&self.queue[before]) <= new {
                break;
            }
            self.queue[place] = self.queue[before];
            place = before;
        }
        self.queue[place] = sample;
        self.len += 1;
        let newest = self.newest_ns.unwrap_or(sample.time_ns);
        self.newest_ns = Some(newest.max(sample.time_ns));
        Offered::Waits
    }

    /// The oldest sample, if the horizon has passed it or `force` is set.
    pub(crate) fn release(&mut self, force: bool) -> Option<Sample> {
        let left = self.len.checked_sub(1)?;
        let sample = &self.queue[self.first];
        let ripe = self
            .newest_ns
            .is_some_and(|newest| newest.saturating_sub(sample.time_ns) >= self.horizon_ns);
        if !ripe && !force {
            return None;
        }
        let sample = *sample;
        self.first = self.place(1);
        self.len = left;
        self.released_ns = Some(sample.time_ns);
        Some(sample)
    }
}

/// By this samples come out: those of one moment by their kind and wheel, so that the order in which they arrived does not
/// matter.
fn order(sample: &Sample) -> (i64, (u8, usize)) {
    (sample.time_ns, rank(&sample.measurement))
}

fn rank(measurement: &Measurement) -> (u8, usize) {
    match *measurement {
        Measurement::Command { .. }
        | Measurement::Inertial { .. }
        | Measurement::JointAngle { .. }
        | Measurement::Steering { .. }
        | Measurement::Sinkage { .. }
        | Measurement::EntryAngle { .. }
        | Measurement::MotorCurrent { .. } => (0, 0),
        Measurement::SteeringAngle { wheel, .. } => (0, wheel),
        Measurement::Acceleration { .. } => (1, 0),
        Measurement::YawRate { .. } => (2, 0),
        Measurement::WheelTorque { wheel, .. } => (3, wheel),
        Measurement::Carrier { wheel, .. } => (3, wheel.saturating_add(MAX_WHEELS)),
        Measurement::WheelCount { wheel, .. } => (4, wheel),
        Measurement::WheelEdge { wheel, .. } => (5, wheel),
        Measurement::WheelAngle { wheel, .. } => (6, wheel),
        Measurement::WheelRate { wheel, .. } => (7, wheel),
        Measurement::Position { .. } => (8, 0),
        Measurement::Displacement { .. } => (8, 1),
        Measurement::Pose { .. } => (9, 0),
        Measurement::Speed { .. } => (10, 0),
    }
}

#[cfg(test)]
mod tests;
