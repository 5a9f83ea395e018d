//! Directions of chords between places, beside those of the same paths by the wheels and by the yaw.

use grouser_real::{Real, wrap_angle};
use grouser_slip::{Measurement, Reference, Sample};

use crate::comparison::{Comparison, Direction};

/// The shortest chord, m, and in standard deviations of a place: noise turns it by less than 0.1 rad.
const MIN_CHORD_M: f64 = 0.5;
const CHORD_SIGMAS: f64 = 20.0;
/// The longest time of a chord, s: a robot that hardly moves shows noise. Limit.
const MAX_CHORD_TIME_S: f64 = 20.0;
/// Chords by the wheels are up to this number of times as long, or as short: beyond, the reference jumped. Limit.
const MAX_CHORD_SCALE: f64 = 5.0;
/// A longer turn within a chord is no bend, rad. Limit.
const MAX_BEND_RAD: f64 = 1.0;
/// Nothing is known of a path between two readings of the wheels that are further apart, s. Limit.
const MAX_GAP_S: f64 = 1.0;
/// Chords that a drift on a side slope (0.3 rad), and the arm of a sensor (0.3 m), are known by beforehand. Prior.
const DRIFT_PRIOR: f64 = 0.03;

/// Where a chord begins: the places by reference, wheels, and wheels along the yaw; the yaw.
#[derive(Clone, Copy, Debug)]
struct Begun {
    time_ns: i64,
    places: [[f64; 2]; 3],
    yaw: f64,
}

/// The chords of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Courses {
    min_chord: f64,
    speed: f64,
    stepped_ns: Option<i64>,
    /// Is the place by the reference the sum of its displacements or speeds, with the gyro where they have no turn?
    is_summed: bool,
    /// The turn by the gyro since the last of them, rad, and its last reading.
    gyro_turn: f64,
    gyro: Option<(i64, f64)>,
    moved_ns: Option<i64>,
    /// Place by the reference, and by the wheels, each with its heading.
    reference: [f64; 3],
    wheels: [f64; 3],
    /// Place by the wheels' speed along the yaw of the reference.
    along_yaw: [f64; 2],
    begun: Option<Begun>,
    /// The directions of the last chord, by reference, wheels and yaw.
    last: Option<[f64; 3]>,
    last_turn: Option<f64>,
    /// Change of direction from chord to chord: by the wheels beside the places, by the yaw beside them, and the places' own beside the
    /// one before.
    pub(crate) wheels_course: Comparison,
    pub(crate) yaw_course: Comparison,
    pub(crate) next_course: Comparison,
    /// The direction of the places compared with that of the yaw.
    pub(crate) from_yaw: Direction,
}

impl Courses {
    pub(crate) fn new(reference: Reference, sigma: f64) -> Self {
        Self {
            is_summed: matches!(reference, Reference::Displacement | Reference::Speed),
            min_chord: MIN_CHORD_M.max(CHORD_SIGMAS * sigma),
            from_yaw: Direction::with_prior(DRIFT_PRIOR),
            ..Self::default()
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        let now_ns = sample.time_ns;
        let seconds = |last_ns: i64| now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        match sample.measurement {
            Measurement::Pose { x, y, yaw } if !self.is_summed && (x + y + yaw).is_finite() => {
                self.reference = [x, y, yaw];
            }
            Measurement::Position { x, y } if (x + y).is_finite() => {
                self.is_summed = false;
                self.reference = [x, y, self.reference[2]];
            }
            Measurement::YawRate { rate } if rate.is_finite() => {
                let (last_ns, last) = self.gyro.replace((now_ns, rate)).unwrap_or((now_ns, rate));
                self.gyro_turn += 0.5 * (last + rate) * seconds(last_ns);
                return;
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if self.is_summed && (forward + left).is_finite() => {
                self.sum([forward, left], turn);
            }
            Measurement::Speed {
                forward,
                left: Some(left),
            } if self.is_summed && (forward + left).is_finite() => {
                let passed = seconds(self.moved_ns.replace(now_ns).unwrap_or(now_ns));
                self.sum([forward, left].map(|part| part * passed), None);
            }
            _ => return,
        }
        self.compare(now_ns);
    }

    /// Adds a motion along the axes of the reference halfway.
    fn sum(&mut self, [forward, left]: [f64; 2], turn: Option<f64>) {
        let by_gyro = std::mem::take(&mut self.gyro_turn);
        let turn = turn.unwrap_or(by_gyro);
        let [x, y, yaw] = self.reference;
        let (sin, cos) = Real::sin_cos(yaw + 0.5 * turn);
        let moved = [cos * forward - sin * left, sin * forward + cos * left];
        self.reference = [x + moved[0], y + moved[1], yaw + turn];
    }

    /// Takes the mean speed of the powered wheels, m/s, and the motion by the wheels.
    pub(crate) fn step(&mut self, now_ns: i64, speed: f64, [x, y, turn]: [f64; 3]) {
        let before = std::mem::replace(&mut self.speed, speed);
        let Some(last_ns) = self.stepped_ns.replace(now_ns) else {
            return;
        };
        let passed = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        // to and fro directions turn by half a turn
        if !(passed < MAX_GAP_S && before * speed > 0.0) {
            (self.begun, self.last, self.last_turn) = (None, None, None);
            return;
        }
        let (sin, cos) = Real::sin_cos(self.reference[2]);
        self.along_yaw[0] += cos * speed * passed;
        self.along_yaw[1] += sin * speed * passed;
        if turn.is_finite() {
            let (sin, cos) = Real::sin_cos(self.wheels[2]);
            self.wheels[0] += (cos * x - sin * y) * passed;
            self.wheels[1] += (sin * x + cos * y) * passed;
            self.wheels[2] += turn * passed;
        } else if let Some(begun) = &mut self.begun {
            begun.places[1] = [f64::NAN; 2];
        }
    }

    /// Compares directions where a chord ends.
    fn compare(&mut self, now_ns: i64) {
        let [x, y, yaw] = self.reference;
        let [by_wheels_x, by_wheels_y, _] = self.wheels;
        let places = [[x, y], [by_wheels_x, by_wheels_y], self.along_yaw];
        let here = Begun {
            time_ns: now_ns,
            places,
            yaw,
        };
        let begun = *self.begun.get_or_insert(here);
        let seconds = now_ns.saturating_sub(begun.time_ns) as f64 * 1e-9;
        if seconds > MAX_CHORD_TIME_S {
            (self.begun, self.last, self.last_turn) = (Some(here), None, None);
            return;
        }
        let chords = [0, 1, 2].map(|i| [0, 1].map(|j| places[i][j] - begun.places[i][j]));
        let lengths = chords.map(|[x, y]| Real::hypot(x, y));
        if lengths[0] < self.min_chord {
            return;
        }
        self.begun = Some(here);
        let directions = chords.map(|[x, y]| Real::atan2(y, x));
        let is_alike = |length: f64| {
            length < MAX_CHORD_SCALE * lengths[0] && lengths[0] < MAX_CHORD_SCALE * length
        };
        if !is_alike(lengths[2]) {
            (self.last, self.last_turn) = (None, None);
            return;
        }
        let bend = wrap_angle(yaw - begun.yaw);
        if bend.abs() < MAX_BEND_RAD {
            let (sin, cos) = Real::sin_cos(directions[2]);
            let (aside, along) = Real::sin_cos(directions[0] - directions[2]);
            // a sensor away from the robot's origin moves sideways by the turn
            let n = [cos, sin, bend / lengths[0]];
            self.from_yaw.add(seconds, 1.0, n, [along, aside]);
        }
        // a sum has no course but that by its own turns
        if self.is_summed {
            return;
        }
        let Some(last) = self.last.replace(directions) else {
            return;
        };
        let [course, wheels, by_yaw] = [0, 1, 2].map(|i| wrap_angle(directions[i] - last[i]));
        let bias = [1.0];
        self.wheels_course.add(seconds, wheels, bias, course);
        self.yaw_course.add(seconds, by_yaw, bias, course);
        if let Some(before) = self.last_turn.replace(course) {
            self.next_course.add(seconds, before, [], course);
        }
    }
}
