//! Wheels of both sides that show one sensor, two sources of one reading, and a log that goes on elsewhere after a silence.

use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample, WheelRole};

use crate::mistake::Mistake;
use crate::motion::wheel_travel;
use crate::turning::parallel_arms;

/// Wheels differ in bends, so the robot must turn by this while it drives, rad.
const MIN_TURN_RAD: f64 = 0.5;
/// Speeds of wheels that are nearer are equal, m/s: rounding.
const ROUNDING_M_PER_S: f64 = 1e-6;
/// All sensors are silent for this time between two drives, s.
const MIN_SILENCE_S: f64 = 5.0;
/// The robot is elsewhere, or its counters are where they began, by more than this, m.
const ELSEWHERE_M: f64 = 0.5;

/// Watches for wheels whose readings are always equal.
#[derive(Clone, Debug, Default)]
pub(crate) struct SameSensor {
    /// Pairs of powered wheels at different distances from the middle, while equal.
    pairs: Vec<[usize; 2]>,
    turned: f64,
}

impl SameSensor {
    pub(crate) fn new(robot: &Robot) -> Self {
        let arms = parallel_arms(robot).unwrap_or_default();
        let mut pairs = Vec::new();
        for (index, (wheel, arm)) in arms.iter().enumerate() {
            let others = arms[..index].iter();
            let sided = others.filter(|(_, other)| arm * other < 0.0);
            pairs.extend(sided.map(|(other, _)| [*other, *wheel]));
        }
        Self { pairs, turned: 0.0 }
    }

    /// Takes the speeds of the wheels, m/s, and how far the robot turned since the last ones.
    pub(crate) fn step(&mut self, speeds: &[Option<f64>], turn: f64) {
        let speed = |wheel: usize| speeds.get(wheel).copied().flatten();
        self.pairs.retain(|pair| {
            let [Some(a), Some(b)] = pair.map(speed) else {
                return true;
            };
            (a - b).abs() < ROUNDING_M_PER_S
        });
        let moves = self
            .pairs
            .iter()
            .flatten()
            .any(|wheel| speed(*wheel).is_some_and(|of| of != 0.0));
        if moves && turn.is_finite() {
            self.turned += turn.abs();
        }
    }

    /// The wheels that show one sensor, bit by bit in the robot's order.
    pub(crate) fn found(&self) -> Option<u64> {
        let bits = |pair: &[usize; 2]| 1_u64 << pair[0] | 1 << pair[1];
        let any = self
            .pairs
            .iter()
            .map(bits)
            .fold(0, |mask, pair| mask | pair);
        // wheels of one side show the same speed
        let all = self
            .pairs
            .iter()
            .map(bits)
            .fold(u64::MAX, |mask, pair| mask & pair);
        let mask = if self.pairs.len() > 1 && all != 0 {
            all
        } else {
            any
        };
        (mask != 0 && self.turned > MIN_TURN_RAD).then_some(mask)
    }
}

/// Readings that alternate: each is closer to the last but one than to the last by this factor, in this share of all and so often.
/// Limits: a sensor that follows a motion is closer to its last, and one with nothing but noise is so in a fifth.
const ALTERNATING: f64 = 0.3;
const ALTERNATING_SHARE: f64 = 0.3;
const MIN_ALTERNATING: u32 = 50;

/// Watches for readings of one sensor that alternate between two series, as two programs write them.
#[derive(Clone, Debug, Default)]
pub(crate) struct TwoSources {
    /// Of the wheels, and of the reference's place last.
    tracks: Vec<Alternation>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Alternation {
    last: [Option<[f64; 2]>; 2],
    all: u32,
    alternating: u32,
}

impl TwoSources {
    pub(crate) fn new(robot: &Robot) -> Self {
        Self {
            tracks: vec![Alternation::default(); robot.wheels().len() + 1],
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        let (index, reading) = match sample.measurement {
            // a rate alternates where a coarse encoder counts in every other row
            Measurement::WheelAngle { wheel, angle } => (wheel, [angle, 0.0]),
            Measurement::WheelCount { wheel, raw } => (wheel, [raw as f64, 0.0]),
            Measurement::Pose { x, y, .. } | Measurement::Position { x, y } => {
                (self.tracks.len() - 1, [x, y])
            }
            _ => return,
        };
        let Some(track) = self.tracks.get_mut(index) else {
            return;
        };
        if let [Some(before), Some(last)] = track.last {
            let distance = |from: [f64; 2]| Real::hypot(reading[0] - from[0], reading[1] - from[1]);
            track.all = track.all.saturating_add(1);
            if distance(before) < ALTERNATING * distance(last) {
                track.alternating = track.alternating.saturating_add(1);
            }
        }
        track.last = [track.last[1], Some(reading)];
    }

    pub(crate) fn found(&self) -> Option<Mistake> {
        let alternates = |of: &Alternation| {
            of.alternating >= MIN_ALTERNATING
                && f64::from(of.alternating) > ALTERNATING_SHARE * f64::from(of.all)
        };
        let index = self.tracks.iter().position(alternates)?;
        let wheel = Some(index).filter(|index| index + 1 < self.tracks.len());
        Some(Mistake::TwoSources(wheel))
    }
}

/// Watches for a drive that begins after another one.
#[derive(Clone, Debug, Default)]
pub(crate) struct SecondDrive {
    start_ns: Option<i64>,
    last_ns: i64,
    /// Of the first powered wheel: its first and last reading, and that before a silence.
    first: Option<Measurement>,
    reading: Option<Measurement>,
    place: Option<[f64; 2]>,
    /// When a silence ended, with the reading and the place before it.
    silence: Option<(i64, Option<Measurement>, Option<[f64; 2]>)>,
    found_s: Option<f64>,
}

impl SecondDrive {
    pub(crate) fn take(&mut self, robot: &Robot, sample: &Sample) {
        let now_ns = sample.time_ns;
        let start_ns = *self.start_ns.get_or_insert(now_ns);
        let last_ns = std::mem::replace(&mut self.last_ns, now_ns);
        let seconds = |from: i64, to: i64| to.saturating_sub(from) as f64 * 1e-9;
        if start_ns != now_ns && seconds(last_ns, now_ns) > MIN_SILENCE_S {
            self.silence = Some((now_ns, self.reading, self.place));
        }
        let mut wheels = robot.wheels().iter();
        let first = wheels.position(|wheel| wheel.role == WheelRole::Powered);
        match sample.measurement {
            Measurement::Pose { x, y, .. } | Measurement::Position { x, y } => {
                self.place = Some([x, y]);
            }
            of if of.is_rotation() && of.wheel() == first => {
                self.first.get_or_insert(of);
                self.reading = Some(of);
            }
            _ => return,
        }
        let Some((resumed_ns, reading, place)) = self.silence else {
            return;
        };
        let Some(wheel) = first.map(|index| &robot.wheels()[index]) else {
            return;
        };
        let way = |from: Option<Measurement>, to: Option<Measurement>| {
            let (from, to) = (from?, to?);
            // a rate tells nothing of the time of silence
            let is_counted = !matches!(to, Measurement::WheelRate { .. });
            is_counted.then(|| wheel_travel(wheel, &from, &to, 0.0).abs())
        };
        let passed = way(reading, self.reading).filter(|_| reading != self.reading);
        let moved = place
            .zip(self.place)
            .map(|(a, b)| Real::hypot(b[0] - a[0], b[1] - a[1]));
        let is_elsewhere = match (moved, passed) {
            (Some(moved), passed) => moved > ELSEWHERE_M + passed.unwrap_or(0.0),
            _ => false,
        };
        let is_restarted = way(self.first, self.reading).is_some_and(|way| way < 0.1 * ELSEWHERE_M)
            && way(self.first, reading).is_some_and(|way| way > ELSEWHERE_M);
        let has_both = self.reading != reading && (self.place != place || place.is_none());
        if is_restarted || (has_both && is_elsewhere) {
            self.found_s.get_or_insert(seconds(start_ns, resumed_ns));
        }
        if has_both {
            self.silence = None;
        }
    }

    /// When the second drive began, s from the start of the log.
    pub(crate) const fn found_s(&self) -> Option<f64> {
        self.found_s
    }
}
