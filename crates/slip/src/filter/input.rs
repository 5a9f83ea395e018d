//! The input of the filter: samples checked by their sensors' clocks and put in the order of their time.

use alloc::{boxed::Box, vec};

use super::reorder_buffer::{Offered, ReorderBuffer};
use super::sensor_clocks::{ClockOutcome, SensorClocks};
use super::settings::FilterSettings;
use crate::fault::{Fault, Rejected};
use crate::history::{nanoseconds, whole};
use crate::sample::{Measurement, Sample};

/// Least and greatest number of samples that can wait for earlier ones: a burst of each sensor of a small robot, and a
/// horizon of 20 ms at 12 kHz.
const REORDER_CAPACITY: (usize, usize) = (32, 256);
/// Samples that an inertial unit makes of a reading beside one for each wheel's carrier, and those of two references.
const OTHER_SAMPLES: f64 = 4.0;

/// Clocks, reorder buffer and the count of refused samples.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    pub(crate) clocks: SensorClocks,
    buffer: ReorderBuffer,
    /// Number of each wheel's readings that wait in the buffer.
    waiting: Box<[u16]>,
    pub(crate) rejected: Rejected,
}

impl Input {
    pub(crate) fn new(wheels: usize, settings: &FilterSettings) -> Self {
        let horizon_s = settings.horizon;
        let sensors = 2.0 * wheels as f64 + OTHER_SAMPLES;
        let capacity = whole(horizon_s * settings.max_rate * sensors);
        let capacity = usize::try_from(capacity).unwrap_or(0);
        Self {
            clocks: SensorClocks::new(wheels),
            buffer: ReorderBuffer::new(
                capacity.clamp(REORDER_CAPACITY.0, REORDER_CAPACITY.1),
                nanoseconds(horizon_s),
            ),
            waiting: vec![0; wheels].into_boxed_slice(),
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
        self.waiting.fill(0);
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
        if self.buffer.offer(sample) == Offered::TooLate {
            return false;
        }
        if let Some(wheel) = rotation_of(&sample.measurement) {
            self.waiting[wheel] += 1;
        }
        true
    }

    /// The oldest sample, if the horizon has passed it or `force` is set.
    pub(crate) fn release(&mut self, force: bool) -> Option<Sample> {
        let sample = self.buffer.release(force)?;
        if let Some(wheel) = rotation_of(&sample.measurement) {
            let waiting = &mut self.waiting[wheel];
            *waiting = waiting.saturating_sub(1);
        }
        Some(sample)
    }

    pub(crate) const fn newest_ns(&self) -> Option<i64> {
        self.buffer.newest_ns()
    }

    /// The time up to which a wheel's silence is known: where none of its readings waits, the newest time of any sensor.
    pub(crate) fn received_until(&self, wheel: usize, now_ns: i64) -> i64 {
        match self.buffer.newest_ns() {
            Some(newest) if self.waiting[wheel] == 0 => newest.max(now_ns),
            _ => now_ns,
        }
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

/// The wheel whose rotation a measurement is.
pub(crate) const fn rotation_of(measurement: &Measurement) -> Option<usize> {
    match *measurement {
        Measurement::WheelCount { wheel, .. }
        | Measurement::WheelEdge { wheel, .. }
        | Measurement::WheelAngle { wheel, .. }
        | Measurement::WheelRate { wheel, .. } => Some(wheel),
        _ => None,
    }
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
        for (wheels, max_rate, horizon, room) in [
            (3, 100.0, 0.5, 256),
            (3, 100.0, 0.1, 100),
            (5, 500.0, 0.02, 140),
            (1, 50.0, 0.02, 32),
        ] {
            let settings = FilterSettings {
                horizon,
                max_rate,
                ..FilterSettings::default()
            };
            let mut input = Input::new(wheels, &settings);
            let mut offered = 0;
            while !input.is_full() {
                assert!(input.offer(gyro(0)));
                offered += 1;
            }
            assert_eq!(offered, room, "{wheels} {max_rate} {horizon}");
            // the horizon has passed a sample where the newest is as much later
            let horizon_ms = nanoseconds(horizon) / MS;
            input.clear();
            assert!(input.offer(gyro(0)) && input.offer(gyro(horizon_ms - 1)));
            assert!(input.release(false).is_none());
            assert!(input.offer(gyro(horizon_ms)) && input.release(false).is_some());
        }
    }

    #[test]
    fn a_wheel_is_silent_until_the_newest_time_where_none_of_its_readings_waits() {
        let mut input = Input::new(2, &FilterSettings::default());
        assert_eq!(input.received_until(0, 3 * MS), 3 * MS);
        assert!(input.offer(gyro(8)) && input.offer(count(1, 9)) && input.offer(count(1, 10)));
        assert!(input.offer(gyro(12)));
        assert_eq!(input.newest_ns(), Some(12 * MS));
        let received = |input: &Input| [0, 1].map(|wheel| input.received_until(wheel, 3 * MS) / MS);
        assert_eq!(
            (received(&input), input.received_until(0, 20 * MS)),
            ([12, 3], 20 * MS)
        );
        // both of its readings have to be used
        for expected in [3, 3, 12] {
            assert!(input.release(true).is_some());
            assert_eq!(received(&input), [12, expected]);
        }
        assert!(input.offer(count(0, 14)));
        assert_eq!(received(&input)[0], 3);
        input.clear();
        assert_eq!(received(&input), [3, 3]);
    }

    #[test]
    fn a_reading_behind_those_that_were_used_is_late_where_it_is_a_reference_s() {
        let mut input = Input::new(1, &FilterSettings::default());
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
        assert_eq!(input.received_until(0, 0), 10 * MS);
    }
}
