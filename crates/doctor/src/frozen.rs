//! A reference that stops while the robot drives on: tracking is lost, and a driver repeats the last pose.

use grouser_files::robot::WheelSensor;
use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample, Wheel, WheelRole};

use crate::mistake::Mistake;
use crate::motion::wheel_travel;

/// A place within this distance is the same, m: noise of a tracker.
const SAME_PLACE_M: f64 = 0.05;
/// The wheels run this far meanwhile, m. Then the reference jumps by this, m, and by this multiple of what they ran since its last
/// reading: a robot that digs in drives on from where it was. Limits.
const MIN_RUN_M: f64 = 1.0;
const MIN_JUMP_M: f64 = 0.3;
const JUMP_RUNS: f64 = 3.0;
/// A reference scatters where this number of readings differed while the wheels were stationary, and more than those that did not by
/// this factor. Then it never repeats a reading, dug in or not. Prior: a share of four fifths.
const MIN_SCATTERED: u32 = 10;
const SCATTERED_TO_EQUAL: u32 = 4;
/// Wheels that run no further between two readings are stationary, m. Limit.
const STATIONARY_M: f64 = 1e-4;
/// A wheel that is read less often is not known in between, s. Limit.
const MAX_GAP_S: f64 = 1.0;

/// Spans in which the places of a reference are constant while the wheels turn, found before a run that leaves them out.
///
/// ```
/// use grouser_doctor::Frozen;
/// use grouser_files::robot::WheelSensor;
/// use grouser_slip::{Measurement, Robot, Sample, Wheel};
///
/// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").radius(0.1)])?;
/// let mut frozen = Frozen::new(&robot, WheelSensor::Angle);
/// let place = |row: i64| Sample {
///     time_ns: row * 100_000_000,
///     // lost from 5 s to 15 s
///     measurement: Measurement::Position { x: if (50..150).contains(&row) { 2.5 } else { 0.05 * row as f64 }, y: 0.0 },
/// };
/// for row in 0..300 {
///     let angle = Measurement::WheelAngle { wheel: 0, angle: 0.5 * row as f64 };
///     frozen.take(&Sample { measurement: angle, ..place(row) });
///     frozen.take(&place(row));
/// }
/// let kept = (0..300).filter(|row| frozen.keeps(&place(*row))).count();
/// assert_eq!(kept, 300 - 99); // the first one is where the robot was
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Frozen {
    sensor: WheelSensor,
    /// The powered wheels with their last reading; `None` of the others.
    wheels: Vec<Option<(Wheel, Option<Sample>)>>,
    powered: f64,
    /// Mean distance by the powered wheels so far, without its sign, m.
    ran: f64,
    start_ns: Option<i64>,
    end_ns: i64,
    /// Where the reference has been since when, and how far the wheels had run then.
    anchor: Option<([f64; 2], i64, f64)>,
    /// Since when it has had one reading, and how far the wheels had run then.
    equal: Option<(i64, f64)>,
    last: Option<([f64; 2], f64)>,
    /// Readings while the wheels were stationary that differed from the one before, and that did not.
    scattered: u32,
    unscattered: u32,
    has_changed: bool,
    /// Readings between the two times are none, ns.
    spans: Vec<[i64; 2]>,
}

impl Frozen {
    /// For a robot whose wheels are measured by `sensor`.
    #[must_use]
    pub fn new(robot: &Robot, sensor: WheelSensor) -> Self {
        let of = |wheel: &Wheel| (wheel.role == WheelRole::Powered).then(|| (wheel.clone(), None));
        let wheels: Vec<_> = robot.wheels().iter().map(of).collect();
        Self {
            sensor,
            powered: wheels.iter().flatten().count() as f64,
            wheels,
            ran: 0.0,
            start_ns: None,
            end_ns: i64::MIN,
            anchor: None,
            equal: None,
            last: None,
            scattered: 0,
            unscattered: 0,
            has_changed: false,
            spans: Vec::new(),
        }
    }

    /// Takes a sample as the robot's, not earlier than those before.
    pub fn take(&mut self, sample: &Sample) {
        self.start_ns.get_or_insert(sample.time_ns);
        self.end_ns = sample.time_ns;
        match sample.measurement {
            Measurement::Pose { x, y, .. } | Measurement::Position { x, y } => {
                self.place(sample.time_ns, [x, y]);
            }
            of if of.is_rotation() && self.sensor.uses(&of) => self.run(sample),
            _ => {}
        }
    }

    fn run(&mut self, sample: &Sample) {
        let index = sample.measurement.wheel();
        let wheel = index.and_then(|index| self.wheels.get_mut(index)?.as_mut());
        let Some((wheel, last)) = wheel else {
            return;
        };
        let Some(before) = last.replace(*sample) else {
            return;
        };
        let passed_s = sample.time_ns.saturating_sub(before.time_ns) as f64 * 1e-9;
        let way = wheel_travel(wheel, &before.measurement, &sample.measurement, passed_s);
        if way.is_finite() && passed_s < MAX_GAP_S {
            self.ran += way.abs() / self.powered;
        }
    }

    fn place(&mut self, now_ns: i64, here: [f64; 2]) {
        let distance = |from: [f64; 2]| Real::hypot(here[0] - from[0], here[1] - from[1]);
        let ran = self.ran;
        let (place, since_ns, ran_then) = *self.anchor.get_or_insert((here, now_ns, ran));
        let (since_equal_ns, ran_equal) = *self.equal.get_or_insert((now_ns, ran));
        let Some((last, last_ran)) = self.last.replace((here, ran)) else {
            return;
        };
        let is_equal = last.map(f64::to_bits) == here.map(f64::to_bits);
        if ran - last_ran < STATIONARY_M {
            let count = if is_equal {
                &mut self.unscattered
            } else {
                &mut self.scattered
            };
            *count = count.saturating_add(1);
        }
        let scatters = self.scattered >= MIN_SCATTERED
            && self.scattered > SCATTERED_TO_EQUAL.saturating_mul(self.unscattered);
        if !is_equal {
            self.has_changed = true;
            self.equal = Some((now_ns, ran));
        } else if scatters && ran - ran_equal > MIN_RUN_M {
            self.leave_out([since_equal_ns, now_ns + 1]);
        }
        if distance(place) < SAME_PLACE_M {
            return;
        }
        let is_jump = distance(last) > MIN_JUMP_M + JUMP_RUNS * (ran - last_ran);
        if is_jump && ran - ran_then > MIN_RUN_M {
            self.leave_out([since_ns, now_ns]);
        }
        self.anchor = Some((here, now_ns, ran));
    }

    /// Adds a span; those that it contains or continues are a part of it.
    fn leave_out(&mut self, [from_ns, to_ns]: [i64; 2]) {
        while self.spans.last().is_some_and(|of| of[0] >= from_ns) {
            self.spans.pop();
        }
        self.spans.push([from_ns, to_ns]);
    }

    /// The log is over.
    pub fn finish(&mut self) {
        if let Some(start_ns) = self.start_ns
            && self.last.is_some()
            && !self.has_changed
            && self.ran > MIN_RUN_M
        {
            self.spans = vec![[start_ns, i64::MAX]];
        }
    }

    /// Is a sample none of those that are left out?
    #[must_use]
    pub fn keeps(&self, sample: &Sample) -> bool {
        if !matches!(
            sample.measurement,
            Measurement::Pose { .. } | Measurement::Position { .. }
        ) {
            return true;
        }
        let next = self.spans.partition_point(|of| of[1] <= sample.time_ns);
        (self.spans.get(next)).is_none_or(|of| sample.time_ns <= of[0])
    }

    /// What was found; are the readings left out?
    #[must_use]
    pub fn found(&self, is_left_out: bool) -> Option<Mistake> {
        let start_ns = self.start_ns?;
        let seconds =
            |time_ns: i64| time_ns.min(self.end_ns).saturating_sub(start_ns) as f64 * 1e-9;
        Some(Mistake::Frozen {
            span_s: self.spans.first()?.map(seconds),
            more: self.spans.len() - 1,
            is_left_out,
        })
    }
}
