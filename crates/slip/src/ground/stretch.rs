//! Readings at one operating point, gathered into their mean.

use super::entry::Uncertain;
use super::reading::WheelReading;

/// Readings further than this many sigma from a stretch's mean begin another.
const SAME_STRETCH_SIGMA: f64 = 3.0;

/// The mean of readings that differ by their noise alone.
///
/// A filter that took them one by one would take their noise for a change of load or sinkage, and learn from it what one
/// operating point cannot tell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    begun_ns: i64,
    last: WheelReading,
    count: f64,
    /// Means of slip, load, sinkage and torque, and of their variances.
    mean: [f64; 4],
    variance: [f64; 4],
}

impl Stretch {
    pub(crate) fn new(reading: &WheelReading) -> Self {
        let parts = parts(reading);
        Self {
            begun_ns: reading.time_ns,
            last: *reading,
            count: 1.0,
            mean: parts.map(|part| part.value),
            variance: parts.map(|part| part.sigma * part.sigma),
        }
    }

    pub(crate) const fn begun_ns(&self) -> i64 {
        self.begun_ns
    }

    /// Could this reading be one more of the same operating point?
    pub(crate) fn holds(&self, reading: &WheelReading) -> bool {
        let spread = 1.0 + 1.0 / self.count;
        parts(reading)
            .iter()
            .zip(self.mean.iter().zip(self.variance))
            .all(|(part, (mean, variance))| {
                let off = part.value - mean;
                off * off
                    <= SAME_STRETCH_SIGMA
                        * SAME_STRETCH_SIGMA
                        * spread
                        * variance.max(part.sigma * part.sigma)
            })
    }

    pub(crate) fn add(&mut self, reading: &WheelReading) {
        self.count += 1.0;
        self.last = *reading;
        let rows = self.mean.iter_mut().zip(self.variance.iter_mut());
        for (part, (mean, variance)) in parts(reading).iter().zip(rows) {
            *mean += (part.value - *mean) / self.count;
            *variance += (part.sigma * part.sigma - *variance) / self.count;
        }
    }

    /// The readings as one, at the time of the last.
    pub(crate) fn reading(&self) -> WheelReading {
        let part = |i: usize| Uncertain {
            value: self.mean[i],
            sigma: grouser_real::Real::sqrt(self.variance[i] / self.count),
        };
        WheelReading {
            slip: part(0),
            load: part(1),
            sinkage: part(2),
            torque: part(3),
            ..self.last
        }
    }
}

const fn parts(reading: &WheelReading) -> [Uncertain; 4] {
    [reading.slip, reading.load, reading.sinkage, reading.torque]
}
