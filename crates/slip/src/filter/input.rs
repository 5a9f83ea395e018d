//! The input of the filter: samples checked by their sensors' clocks and put in the order of their time.

use super::reorder_buffer::{Offered, ReorderBuffer};
use super::sensor_clocks::{ClockOutcome, SensorClocks};
use crate::fault::{Fault, Rejected};
use crate::history::{nanoseconds, whole};
use crate::sample::{Measurement, Sample};

/// Minimum and maximum number of samples that can wait for earlier ones: a burst of each sensor of a small robot, and a horizon of
/// 20 ms at 12 kHz.
const REORDER_CAPACITY: (usize, usize) = (32, 256);
/// Rate of sensors for which there is room, Hz: faster ones shorten the horizon.
const MAX_RATE_HZ: f64 = 200.0;
/// Number of samples that an inertial unit yields in addition to one for each wheel's carrier, and those of two references.
const OTHER_SAMPLES: f64 = 4.0;

/// Clocks, reorder buffer and the count of refused samples.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    pub(crate) clocks: SensorClocks,
    buffer: ReorderBuffer,
    pub(crate) rejected: Rejected,
}

impl Input {
    /// For a robot of so many wheels; samples are put in order within `horizon_s` (s).
    pub(crate) fn new(wheels: usize, horizon_s: f64) -> Self {
        let sensors = 2.0 * wheels as f64 + OTHER_SAMPLES;
        let capacity = whole(horizon_s * MAX_RATE_HZ * sensors);
        let capacity = usize::try_from(capacity).unwrap_or(0);
        Self {
            clocks: SensorClocks::new(wheels),
            buffer: ReorderBuffer::new(
                capacity.clamp(REORDER_CAPACITY.0, REORDER_CAPACITY.1),
                nanoseconds(horizon_s),
            ),
            rejected: Rejected::default(),
        }
    }

    /// Checks a sample's time against its sensor's clock.
    pub(crate) fn check_clock(&mut self, sample: &Sample) -> Result<ClockOutcome, Fault> {
        let (newest, used) = (self.buffer.newest_ns(), self.buffer.released_ns());
        self.clocks.check(sample, newest, used)
    }

    /// Forgets what waits: the clock was set.
    pub(crate) fn clear(&mut self) {
        self.buffer.clear();
    }

    /// Is it a reading of the reference behind the samples that have been used?
    pub(crate) fn is_late(&self, sample: &Sample) -> bool {
        let used = self.buffer.released_ns();
        is_reference(&sample.measurement) && used.is_some_and(|used| sample.time_ns < used)
    }

    pub(crate) fn is_full(&self) -> bool {
        self.buffer.is_full()
    }

    /// Puts a sample in its place; `false` where later ones have been used already.
    pub(crate) fn offer(&mut self, sample: Sample) -> bool {
        self.buffer.offer(sample) != Offered::TooLate
    }

    /// The oldest sample, if the horizon has passed it or `force` is set.
    pub(crate) fn release(&mut self, force: bool) -> Option<Sample> {
        self.buffer.release(force)
    }

    pub(crate) const fn newest_ns(&self) -> Option<i64> {
        self.buffer.newest_ns()
    }
}

/// Is it a measured motion of the robot?
pub(crate) const fn is_reference(measurement: &Measurement) -> bool {
    matches!(
        measurement,
        Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Position { .. }
            | Measurement::Speed { .. }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn count(wheel: usize, time_ms: i64) -> Sample {
        let time_ns = time_ms * MS;
        let measurement = Measurement::WheelCount { wheel, raw: 7 };
        Sample {
            time_ns,
            measurement,
        }
    }

    fn gyro(time_ms: i64) -> Sample {
        Sample {
            measurement: Measurement::YawRate { rate: 0.1 },
            ..count(0, time_ms)
        }
    }

    #[test]
    fn room_is_for_two_samples_of_each_wheel_and_four_others_within_the_horizon() {
        for (wheels, horizon, room) in [
            (3, 0.5, 256),
            (3, 0.05, 100),
            (5, 0.05, 140),
            (1, 0.005, 32),
        ] {
            let mut input = Input::new(wheels, horizon);
            let mut offered = 0;
            while !input.is_full() {
                assert!(input.offer(gyro(0)));
                offered += 1;
            }
            assert_eq!(offered, room, "{wheels} {horizon}");
            // the horizon has passed a sample where the newest is as much later
            let horizon_ms = nanoseconds(horizon) / MS;
            input.clear();
            assert!(input.offer(gyro(0)) && input.offer(gyro(horizon_ms - 1)));
            assert!(input.release(false).is_none());
            assert!(input.offer(gyro(horizon_ms)) && input.release(false).is_some());
        }
    }

    #[test]
    fn a_reading_behind_those_that_were_used_is_late_where_it_is_a_reference_s() {
        let mut input = Input::new(1, 0.02);
        let speed = |time_ms| Sample {
            measurement: Measurement::Speed {
                forward: 0.2,
                left: None,
            },
            ..gyro(time_ms)
        };
        assert!(!input.is_late(&speed(1)));
        assert!(input.offer(gyro(10)) && input.release(true).is_some());
        assert!(input.is_late(&speed(9)) && !input.is_late(&speed(10)) && !input.is_late(&gyro(9)));
        // one that cannot be put in order does not wait
        assert!(!input.offer(count(0, 9)));
        assert_eq!(input.newest_ns(), Some(10 * MS));
    }
}
