//! The same displacement by wheels, reference and estimate, between two readings of the reference.

use grouser_real::{Real, wrap_angle};
use grouser_slip::Reference;
use grouser_slip::modes::ModeFilter;
use grouser_slip::motion::{
    Belief, CommonMotion, HEADING, SPEED, Step, TURN_BIAS, Value, WheelStep, common_motion,
};

/// The distance by the wheels is at most this multiple of their displacement, else they ran to and fro: then the displacement
/// shows no distance. Limit.
const MAX_LENGTH_RATIO: f64 = 2.0;
/// Over a longer time between two readings the course is not known, s. Limit.
const MAX_OUTAGE_S: f64 = 5.0;
/// Turns by reference and estimate that differ by more show an outlier of a heading, or a sensor that is described wrongly, rad: the
/// cosine of half of it is 1 % below 1. Limit.
const MAX_TURN_DIFFERENCE: f64 = 0.3;
/// With positions alone an error of the heading changes over about this time, s. Prior.
const HEADING_MEMORY_S: f64 = 10.0;

/// A step of the motion and what is believed after it.
#[derive(Clone, Copy, Debug)]
pub struct KnownStep<'a> {
    /// What the sensors measured.
    pub step: &'a Step,
    /// The belief at its end.
    pub belief: &'a Belief,
    /// The wheels' common motion.
    pub common: &'a CommonMotion,
}

impl<'a> KnownStep<'a> {
    /// A step after which the filter is this one.
    #[must_use]
    pub fn online(step: &'a Step, filter: &'a ModeFilter) -> Self {
        Self {
            step,
            belief: filter.belief(),
            common: filter.common(),
        }
    }

    /// Distance in the direction in which the wheels ran, m.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.belief.mean[SPEED] * self.step.dt.copysign(self.common.distance)
    }

    /// Turn over the step, rad.
    #[must_use]
    pub fn turn(&self) -> f64 {
        self.common.turned - self.belief.mean[TURN_BIAS] * self.step.dt
    }
}

/// What passed between two readings of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Passed {
    /// Time, s.
    pub seconds: f64,
    /// Turn by the estimate, rad.
    pub turn: f64,
    /// Displacement by the wheels in the robot's frame halfway, m.
    pub wheels: [f64; 2],
    /// Displacement by the reference in the same frame, m.
    pub reference: [f64; 2],
    /// The same in the reference's own frame, m.
    pub moved: [f64; 2],
    /// Mean angle from the wheels' displacements to the reference's in the last seconds, rad; 0 where the reference measures a heading.
    pub angle: f64,
    /// Distance by the wheels, forwards and backwards added up, m.
    pub length: f64,
    /// Distance by the estimate in the direction in which the wheels ran, m.
    pub estimate: f64,
}

impl Passed {
    /// Adds what passed next.
    pub(crate) fn add(&mut self, next: &Self) {
        self.seconds += next.seconds;
        self.turn += next.turn;
        for axis in [0, 1] {
            self.wheels[axis] += next.wheels[axis];
            self.reference[axis] += next.reference[axis];
            self.moved[axis] += next.moved[axis];
        }
        self.length += next.length;
        self.estimate += next.estimate;
    }

    /// Distance by the reference in the direction in which the wheels ran, m: its displacement along that of the wheels, times
    /// what the path of the wheels is longer than their displacement. `None` where they ran to and fro or not at all.
    #[must_use]
    pub fn distance_by_reference(&self) -> Option<f64> {
        let product = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let square = product(self.wheels, self.wheels);
        let is_known = MAX_LENGTH_RATIO * MAX_LENGTH_RATIO * square > self.length * self.length;
        let reference = turned(self.reference, -self.angle);
        is_known.then(|| product(reference, self.wheels) / square * self.length)
    }
}

/// Sums since the last reading of the reference; displacements are in its frame.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    seconds: f64,
    turn: f64,
    wheels: [f64; 2],
    /// Displacement by the wheels as if the robot did not turn, in its own frame.
    ahead: [f64; 2],
    length: f64,
    estimate: f64,
    has_hole: bool,
}

impl Sums {
    fn of(known: &KnownStep<'_>) -> Self {
        let turn = known.turn();
        let heading = known.belief.mean[HEADING] - 0.5 * turn;
        let distance = known.common.distance;
        Self {
            seconds: known.step.dt,
            turn,
            wheels: turned([distance, 0.0], heading + known.common.direction),
            ahead: turned([distance, 0.0], known.common.direction),
            length: distance.abs(),
            estimate: known.distance(),
            has_hole: !known.step.has_wheels(),
        }
    }

    fn add(&mut self, step: &Self, share: f64) {
        self.seconds += share * step.seconds;
        self.turn += share * step.turn;
        for axis in [0, 1] {
            self.wheels[axis] += share * step.wheels[axis];
            self.ahead[axis] += share * step.ahead[axis];
        }
        self.length += share * step.length;
        self.estimate += share * step.estimate;
        self.has_hole |= step.has_hole;
    }

    /// With the reference's displacement in its own frame, at a heading of the robot of `heading`.
    fn passed(&self, reference: [f64; 2], heading: f64) -> Option<Passed> {
        let back = 0.5 * self.turn - heading;
        (!self.has_hole).then(|| Passed {
            seconds: self.seconds,
            turn: self.turn,
            wheels: turned(self.wheels, back),
            reference: turned(reference, back),
            angle: 0.0,
            moved: reference,
            length: self.length,
            estimate: self.estimate,
        })
    }
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = Real::sin_cos(angle);
    [cos * x - sin * y, sin * x + cos * y]
}

/// Finds what passed from step to step.
#[derive(Clone, Debug)]
pub struct Pairing {
    reference: Reference,
    last: Option<Value>,
    /// Its time, s.
    last_time: f64,
    /// Heading by the reference at its last reading, rad.
    heading: Option<f64>,
    sums: Sums,
    /// Of a reference without a heading: sums of the products of its displacements with those of the wheels, along and across.
    rotation: [f64; 2],
    free: Vec<WheelStep>,
    scratch: Vec<f64>,
}

impl Pairing {
    /// By this reference.
    #[must_use]
    pub fn new(reference: Reference) -> Self {
        Self {
            reference,
            last: None,
            last_time: 0.0,
            sums: Sums::default(),
            heading: None,
            rotation: [0.0; 2],
            free: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Takes a step; gives what passed up to its last reading since the one before.
    pub fn take(&mut self, known: &KnownStep<'_>) -> Option<Passed> {
        let step = known.step;
        let own = Sums::of(known);
        let heading = known.belief.mean[HEADING];
        if self.reference == Reference::FreeWheel {
            let middle = heading - 0.5 * own.turn;
            return own.passed(turned(self.by_free_wheels(known)?, middle), heading);
        }
        if step.frame.is_some() {
            self.last = None;
        }
        let is_used = |of: &Value| matches!(of, Value::Place(_) | Value::Speed(_));
        let mut readings = step.readings.iter().rev();
        let Some(reading) = readings.find(|of| is_used(&of.value)) else {
            self.sums.add(&own, 1.0);
            return None;
        };
        let first = step.readings.first().unwrap_or(reading);
        let gap = step.time - first.since - self.last_time;
        self.last_time = step.time - reading.since;
        let rest = (reading.since / step.dt).clamp(0.0, 1.0);
        self.sums.add(&own, 1.0 - rest);
        let mut sums = Sums::default();
        sums.add(&own, rest);
        let sums = std::mem::replace(&mut self.sums, sums);
        let heading = heading - rest * own.turn;
        let of_heading = step.readings.iter().find_map(|of| match of.value {
            Value::Heading(heading) if of.since == reading.since => Some(heading),
            _ => None,
        });
        let by_reference = std::mem::replace(&mut self.heading, of_heading).zip(of_heading);
        let moved = match (self.last.replace(reading.value)?, reading.value) {
            (Value::Place(from), Value::Place(to)) => [to[0] - from[0], to[1] - from[1]],
            (Value::Speed(from), Value::Speed(to)) => {
                let forward = 0.5 * (from + to) * sums.seconds;
                turned([forward, 0.0], heading - 0.5 * sums.turn)
            }
            _ => return None,
        };
        let passed = (sums.passed(moved, heading)).filter(|_| gap <= MAX_OUTAGE_S);
        if let (Some((from, to)), Value::Place(_)) = (by_reference, reading.value) {
            // no other sensor's heading is needed
            let turn = wrap_angle(to - from);
            let is_clear = wrap_angle(turn - sums.turn).abs() <= MAX_TURN_DIFFERENCE;
            return passed.filter(|_| is_clear).map(|passed| Passed {
                turn,
                wheels: sums.ahead,
                reference: turned(moved, -from - 0.5 * turn),
                ..passed
            });
        }
        if matches!(reading.value, Value::Speed(_)) {
            return passed;
        }
        let Some(passed) = passed else {
            self.rotation = [0.0; 2];
            return None;
        };
        Some(self.along_wheels(passed))
    }

    /// With the mean angle between the displacements: positions alone show no error of the heading otherwise.
    fn along_wheels(&mut self, passed: Passed) -> Passed {
        let kept = Real::exp(-passed.seconds / HEADING_MEMORY_S);
        let ([x, y], [w_x, w_y]) = (passed.reference, passed.wheels);
        let sum = [x * w_x + y * w_y, y * w_x - x * w_y];
        self.rotation = [0, 1].map(|i| kept * self.rotation[i] + sum[i]);
        Passed {
            angle: Real::atan2(self.rotation[1], self.rotation[0]),
            ..passed
        }
    }

    /// Displacement in the robot's frame by the free wheels, m.
    fn by_free_wheels(&mut self, known: &KnownStep<'_>) -> Option<[f64; 2]> {
        let free = known.step.wheels.iter().filter(|wheel| wheel.is_free);
        self.free.clear();
        (self.free).extend(free.map(|wheel| WheelStep {
            is_free: false,
            ..*wheel
        }));
        self.scratch.resize(self.free.len(), 0.0);
        let direction = known.common.direction;
        let turn = Some(known.turn());
        let found = common_motion(&self.free, turn, 1.0, direction, &mut self.scratch)?;
        Some(turned([found.distance, 0.0], found.direction))
    }
}
