//! Sensors that a logger repeats in the rows between their updates.
//!
//! Many loggers write one row per cycle, and in it the last known value of each sensor. Each repetition taken for a reading would
//! mean that the robot moves evenly or not at all from one update to the next, and then jumps.

use std::fmt;

use grouser_real::median;
use grouser_slip::{Measurement, Reference, Sample};

/// Of this number of updates the decision is made, and not of fewer than the second number.
const UPDATES: usize = 400;
const MIN_UPDATES: usize = 12;
/// An update repeats for this number of rows at least, in the median.
const MIN_ROWS: u64 = 2;
/// Rows from one update to the next differ from the median by one, or by this share of it, in this share of all cases: updates
/// are steady. Readings that are equal by chance, since they have few digits, are not.
const ROWS_TOLERANCE: f64 = 0.25;
const STEADY_SHARE: f64 = 0.9;
/// A value that repeats for longer than this number of intervals is a reading: the robot stands, or the sensor is frozen. One
/// update may be missing.
const MAX_INTERVALS: f64 = 2.2;
/// A speed is silent after this number of periods: 1.1 to 3 keep as many rows `Ok`, readings scatter.
const SILENT_PERIODS: f64 = 1.5;
/// A speed that is read more seldom is silent in between, s. Sigmas held for random drives up to this; at 10 s the whole way did
/// not.
const MAX_PERIOD_S: f64 = 3.0;
/// Only so much of a log is read for it, s.
const MAX_LOG_S: f64 = 1800.0;

/// A reference whose value most rows repeat from its last update.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HeldReference {
    /// Rows with a value of the reference.
    pub rows: u64,
    /// Those whose value was another than in the row before, which are its readings.
    pub updates: u64,
    /// Median time from one update to the next, s.
    pub interval_s: f64,
}

impl fmt::Display for HeldReference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the reference is held between its updates: {} of {} rows are readings",
            self.updates, self.rows
        )
    }
}

/// Who is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sensor {
    Reference,
    WheelRate(usize),
    /// Its angle or count.
    Wheel(usize),
    Gyro,
    Accelerometer,
}

/// Who is read, and the bits that repeat; `None` of other samples. Of a pose, its place: the yaw may be another sensor's.
fn bits(measurement: &Measurement, reference: Reference) -> Option<(Sensor, [u64; 2])> {
    let of = |sensor, a: f64, b: f64| Some((sensor, [a.to_bits(), b.to_bits()]));
    match (*measurement, reference) {
        (Measurement::WheelRate { wheel, rate }, _) => of(Sensor::WheelRate(wheel), rate, 0.0),
        (Measurement::WheelAngle { wheel, angle }, _) => of(Sensor::Wheel(wheel), angle, 0.0),
        (Measurement::WheelCount { wheel, raw }, _) => of(Sensor::Wheel(wheel), raw as f64, 0.0),
        (Measurement::YawRate { rate }, _) => of(Sensor::Gyro, rate, 0.0),
        (Measurement::Acceleration { forward, left }, _) => {
            of(Sensor::Accelerometer, forward, left)
        }
        (Measurement::Pose { x, y, .. }, Reference::Pose) => of(Sensor::Reference, x, y),
        (Measurement::Displacement { forward, left, .. }, Reference::Displacement) => {
            of(Sensor::Reference, forward, left)
        }
        (Measurement::Speed { forward, left }, Reference::Speed) => {
            of(Sensor::Reference, forward, left.unwrap_or(0.0))
        }
        _ => None,
    }
}

/// Leaves out the rows that repeat a sensor's last update: of the reference, the wheels, gyro and accelerometer.
///
/// ```
/// use grouser_doctor::Held;
/// use grouser_slip::{Measurement, Reference, Sample};
///
/// // rows of 20 ms, an update each half second
/// let row = |row: i64| Sample {
///     time_ns: 20_000_000 * row,
///     measurement: Measurement::Pose { x: (row / 25) as f64, y: 0.0, yaw: 0.0 },
/// };
/// let mut held = Held::find(Reference::Pose, (0..1000).map(|i| Ok::<_, ()>(row(i)))).unwrap();
/// let kept = (0..1000).filter(|i| held.keeps(&row(*i))).count();
/// assert_eq!((kept, held.counts().unwrap().updates), (40, 40));
/// ```
#[derive(Clone, Debug)]
pub struct Held {
    reference: Reference,
    /// Sensors whose rows repeat.
    repeating: Vec<(Sensor, Repeating)>,
    /// Median time between two readings of the reference, s.
    period_s: Option<f64>,
}

/// A sensor whose rows repeat.
#[derive(Clone, Debug)]
struct Repeating {
    counts: HeldReference,
    last: Option<[u64; 2]>,
    /// When a sample was kept last, and whether it was a repetition.
    kept_ns: i64,
    repeats: bool,
}

impl Held {
    /// For samples in the order of time, whose motion is measured by `reference`.
    ///
    /// # Errors
    /// The first of the samples.
    pub fn find<E>(
        reference: Reference,
        samples: impl IntoIterator<Item = Result<Sample, E>>,
    ) -> Result<Self, E> {
        let mut all: Vec<(Sensor, Updates)> = Vec::new();
        for sample in samples {
            let sample = sample?;
            let Some((sensor, bits)) = bits(&sample.measurement, reference) else {
                continue;
            };
            let at = all.iter().position(|(known, _)| *known == sensor);
            let at = at.unwrap_or_else(|| {
                all.push((sensor, Updates::default()));
                all.len() - 1
            });
            all[at].1.take(sample.time_ns, bits);
            // counts of a robot that rests repeat without end, and a log that is still written is not waited for
            let is_done = |(sensor, updates): &(Sensor, Updates)| {
                let has_rows = updates.periods_s.len() >= UPDATES;
                updates.is_done || matches!(sensor, Sensor::Wheel(_)) && has_rows
            };
            if is_done(&all[at]) && all.iter().all(is_done) {
                break;
            }
        }
        let mut found = Self {
            reference,
            repeating: Vec::new(),
            period_s: None,
        };
        for (sensor, mut updates) in all {
            let period_s = updates.period_s();
            let interval_s = updates.interval_s();
            if sensor == Sensor::Reference {
                found.period_s = interval_s.or(period_s);
            }
            let of = |interval_s| Repeating {
                counts: HeldReference {
                    rows: 0,
                    updates: 0,
                    interval_s,
                },
                last: None,
                kept_ns: 0,
                repeats: false,
            };
            found
                .repeating
                .extend(interval_s.map(|interval_s| (sensor, of(interval_s))));
        }
        Ok(found)
    }

    /// The time after which the reference is silent, s, where it is read more seldom than others. Of a speed nothing else
    /// bridges the time between two readings.
    #[must_use]
    pub fn dropout_s(&self) -> Option<f64> {
        let period_s = (self.period_s).filter(|_| self.reference == Reference::Speed)?;
        Some(SILENT_PERIODS * period_s.min(MAX_PERIOD_S))
    }

    /// Is a sample a reading?
    pub fn keeps(&mut self, sample: &Sample) -> bool {
        let Some((sensor, bits)) = bits(&sample.measurement, self.reference) else {
            return true;
        };
        let mut repeating = self.repeating.iter_mut();
        match repeating.find(|(known, _)| *known == sensor) {
            Some((_, own)) => own.keeps(sample.time_ns, bits),
            None => true,
        }
    }

    /// What was left out of the reference's rows; `None` where each of them is a reading.
    #[must_use]
    pub fn counts(&self) -> Option<HeldReference> {
        let mut repeating = self.repeating.iter();
        let own = repeating.find(|(sensor, _)| *sensor == Sensor::Reference);
        own.map(|(_, own)| own.counts)
    }
}

impl Repeating {
    fn keeps(&mut self, time_ns: i64, bits: [u64; 2]) -> bool {
        let is_update = self.last.replace(bits) != Some(bits);
        self.counts.rows += 1;
        self.counts.updates += u64::from(is_update);
        let since_s = time_ns.saturating_sub(self.kept_ns) as f64 * 1e-9;
        let intervals = if self.repeats { 1.0 } else { MAX_INTERVALS };
        let keeps = is_update || since_s >= intervals * self.counts.interval_s;
        if keeps {
            self.kept_ns = time_ns;
            self.repeats = !is_update;
        }
        keeps
    }
}

/// The rows and the time from one update to the next.
#[derive(Clone, Debug, Default)]
struct Updates {
    start_ns: Option<i64>,
    last: Option<([u64; 2], i64)>,
    rows: u64,
    intervals: Vec<(u64, f64)>,
    /// The time of the last row, and those between the first rows, s.
    row_ns: Option<i64>,
    periods_s: Vec<f64>,
    /// Are there enough of them?
    is_done: bool,
}

impl Updates {
    fn take(&mut self, time_ns: i64, bits: [u64; 2]) {
        let seconds = |from: i64| time_ns.saturating_sub(from) as f64 * 1e-9;
        if let Some(last) = self.row_ns.replace(time_ns)
            && self.periods_s.len() < UPDATES
        {
            self.periods_s.push(seconds(last));
        }
        let is_over = seconds(*self.start_ns.get_or_insert(time_ns)) > MAX_LOG_S;
        self.rows += 1;
        match self.last {
            Some((same, _)) if same == bits => {}
            last => {
                if let Some((_, since_ns)) = last {
                    self.intervals.push((self.rows, seconds(since_ns)));
                }
                self.rows = 0;
                self.last = Some((bits, time_ns));
            }
        }
        self.is_done |= is_over || self.intervals.len() >= UPDATES;
    }

    /// The median time between rows, s.
    fn period_s(&mut self) -> Option<f64> {
        median(&mut self.periods_s)
    }

    /// The median interval of updates, s; `None` where rows are readings.
    fn interval_s(mut self) -> Option<f64> {
        if self.intervals.len() < MIN_UPDATES {
            return None;
        }
        self.intervals.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (_, interval_s) = self.intervals[self.intervals.len() / 2];
        self.intervals.sort_by_key(|(rows, _)| *rows);
        let (rows, _) = self.intervals[self.intervals.len() / 2];
        let tolerance = (ROWS_TOLERANCE * rows as f64).max(1.0);
        let is_near = |(other, _): &&(u64, f64)| other.abs_diff(rows) as f64 <= tolerance;
        let near = self.intervals.iter().filter(is_near).count() as f64;
        let is_steady = near >= STEADY_SHARE * self.intervals.len() as f64;
        (rows >= MIN_ROWS && is_steady).then_some(interval_s)
    }
}
