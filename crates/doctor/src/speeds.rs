//! Speeds and their changes: by the wheels, by the reference, and by the accelerometer.

use grouser_real::Real;
use grouser_slip::{Measurement, Reference, Robot, Sample, SensorSettings, Wheel, WheelRole};

use crate::comparison::{Comparison, Direction, PART_S};
use crate::motion::{common_heading, displacement};
use crate::passed::Passed;
use crate::window::Window;

/// Changes of speed are compared over this time, s, and not over a break: long against a sample, short against a manoeuvre. Prior.
const CHANGE_S: f64 = 0.5;
const MAX_CHANGE_S: f64 = 0.8;
/// A larger change is an outlier of the reference, m/s. Limit.
const MAX_CHANGE_M_PER_S: f64 = 2.0;
/// Displacements turn by less than this, rad: a sensor far from the robot's origin moves sideways in turns. Limit.
const MAX_TURN_RAD: f64 = 0.05;
/// Wheels whose headings differ by less (cosine) drive one way: 35°. Limit.
const PARALLEL_COSINE: f64 = 0.82;
/// And these, exactly one way. Limit.
const EQUAL_COSINE: f64 = 0.9998;

/// Speeds over a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Speeds {
    /// The direction in which all powered wheels drive; `None` where they point in several.
    pub(crate) along: Option<[f64; 2]>,
    /// The same of wheels that point there exactly and are not steered.
    pub(crate) heading: Option<[f64; 2]>,
    low_speed: f64,
    reference: Option<Reference>,
    speed: f64,
    pose: Option<[f64; 3]>,
    /// By the gyro, rad/s.
    yaw_rate: f64,
    reference_ns: Option<i64>,
    /// Begin of the open change, ns, and the wheels' speed then, m/s; the sum of accelerations since, and their number; the distance
    /// along the robot by the reference, m, and its time, s.
    begun: Option<(i64, f64)>,
    force: [f64; 3],
    passed: [f64; 2],
    /// Of the change before: the accelerations, since the wheels' speed is a mean that lags, and the speed by the reference.
    force_before: Option<[f64; 2]>,
    speed_before: Option<f64>,
    /// The acceleration beside the change of the wheels' speed, and of the reference's.
    pub(crate) force_by_wheels: Direction,
    pub(crate) force_by_reference: Direction,
    /// The motion by the reference beside its length with the sign of the wheels.
    pub(crate) reference_by_wheels: Direction,
    /// The motion by the reference compared with its turn: a sensor away from the origin moves by the turn.
    pub(crate) by_turn: Direction,
    /// Displacement (m) and turn (rad) of the reference along its own axes since they were compared with those of the wheels.
    moved: [f64; 3],
    /// A block: its time, s, and the distances by reference and wheels, m.
    block: [f64; 3],
    /// Speed by the wheels beside that by the reference; of each powered wheel that is not steered the speed beside that by the
    /// reference.
    pub(crate) wheels_speed: Comparison,
    /// The same over blocks: the noise of places is no reverse.
    pub(crate) block_speed: Comparison,
    pub(crate) by_wheel: Vec<Option<([f64; 3], Comparison)>>,
    pub(crate) have_wheels_sign: bool,
}

impl Speeds {
    pub(crate) fn new(robot: &Robot, settings: &SensorSettings, is_fixed_robot: bool) -> Self {
        let is_fixed =
            |wheel: &&Wheel| wheel.role == WheelRole::Powered && wheel.steers_about.is_none();
        let wheels = robot.wheels().iter();
        let are_fixed = is_fixed_robot
            && (wheels.clone()).all(|wheel| wheel.role != WheelRole::Powered || is_fixed(&wheel));
        let of = |wheel: &Wheel| (wheel.speed_row(), Comparison::default());
        Self {
            along: common_heading(robot, PARALLEL_COSINE),
            heading: common_heading(robot, EQUAL_COSINE).filter(|_| are_fixed),
            low_speed: settings.low_speed,
            reference: Some(settings.reference),
            by_wheel: (wheels.map(|wheel| Some(wheel).filter(is_fixed).map(of))).collect(),
            ..Self::default()
        }
    }

    /// Takes a sample of an accelerometer or of a measured motion; others have no effect.
    pub(crate) fn take(&mut self, sample: &Sample) {
        let now_ns = sample.time_ns;
        let last_ns = self.reference_ns.unwrap_or(now_ns);
        let seconds = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        let is_speed = self.reference == Some(Reference::Speed);
        let (passed, turn) = match sample.measurement {
            Measurement::Acceleration { forward, left } if (forward + left).is_finite() => {
                let [x, y, count] = self.force;
                self.force = [x + forward, y + left, count + 1.0];
                return;
            }
            Measurement::YawRate { rate } => {
                self.yaw_rate = rate;
                return;
            }
            Measurement::Speed { forward, left } if is_speed => {
                let passed = [forward, left.unwrap_or(0.0)].map(|speed| speed * seconds);
                (passed, self.yaw_rate * seconds)
            }
            Measurement::Pose { x, y, yaw } if !is_speed => {
                let last = self.pose.replace([x, y, yaw]).unwrap_or([x, y, yaw]);
                displacement(last, [x, y, yaw])
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if !is_speed => ([forward, left], turn.unwrap_or(0.0)),
            _ => return,
        };
        self.reference_ns = Some(now_ns);
        let Some([cos, sin]) = self.along.filter(|_| seconds > 0.0) else {
            return;
        };
        self.passed[0] += cos * passed[0] + sin * passed[1];
        self.passed[1] += seconds;
        for (sum, part) in self.moved.iter_mut().zip([passed[0], passed[1], turn]) {
            *sum += part;
        }
        if turn.abs() < MAX_TURN_RAD && self.speed.abs() > self.low_speed {
            let length = Real::hypot(passed[0], passed[1]).copysign(self.speed);
            (self.reference_by_wheels).add(seconds, length, [], passed);
        }
    }

    /// Takes the mean speed of the powered wheels, m/s, after all samples of one time.
    pub(crate) fn step(&mut self, now_ns: i64, speed: f64) {
        self.speed = speed;
        let (begun_ns, speed_then) = *self.begun.get_or_insert((now_ns, speed));
        let seconds = now_ns.saturating_sub(begun_ns) as f64 * 1e-9;
        if seconds < CHANGE_S {
            return;
        }
        self.begun = Some((now_ns, speed));
        let [x, y, count] = std::mem::take(&mut self.force);
        let force = (count > 0.0 && seconds < MAX_CHANGE_S).then(|| [x / count, y / count]);
        let [passed, time] = std::mem::take(&mut self.passed);
        let forward = (time > 0.0 && time < MAX_CHANGE_S).then(|| passed / time);
        let before = std::mem::replace(&mut self.speed_before, forward);
        if let Some((older, newer)) = self.force_before.zip(force) {
            let gained = [0, 1].map(|i| 0.5 * (older[i] + newer[i]) * seconds);
            let mut add = |of: fn(&mut Self) -> &mut Direction, change: f64| {
                if change.abs() < MAX_CHANGE_M_PER_S {
                    of(self).add(seconds, change, [1.0], gained);
                }
            };
            add(|own| &mut own.force_by_wheels, speed - speed_then);
            if let Some((before, forward)) = before.zip(forward) {
                add(|own| &mut own.force_by_reference, forward - before);
            }
        }
        self.force_before = force;
    }

    /// Notes whether any wheel runs backwards in a window.
    pub(crate) fn see_signs(&mut self, window: &Window) {
        let low_speed = self.low_speed;
        self.have_wheels_sign |= window.speeds().any(|speed| speed < -low_speed);
    }

    /// Compares the motion by the reference with the speeds of the wheels in the same time.
    pub(crate) fn compare_signs(&mut self, passed: &Passed, window: &Window) {
        let low_speed = self.low_speed;
        let seconds = passed.seconds;
        let moves = |x: f64, y: f64| x.abs() > low_speed && y.abs() > low_speed;
        let [x, y] = passed.reference;
        let motion = [x, y, passed.turn].map(|part| part / seconds);
        for (own, wheel) in self.by_wheel.iter_mut().zip(window.speeds()) {
            if let Some((row, comparison)) = own {
                let speed: f64 = row.iter().zip(motion).map(|(row, part)| row * part).sum();
                if moves(speed, wheel) {
                    comparison.add(seconds, speed, [], wheel);
                }
            }
        }
        let own = [passed.reference[0], passed.wheels[0]];
        let moved = std::mem::take(&mut self.moved);
        // of places without a heading none is known
        let is_known = moved != [0.0; 3];
        let [x, y, turn] = if is_known {
            moved.map(|part| part / seconds)
        } else {
            motion
        };
        (self.by_turn).add(seconds, turn, [passed.wheels[0] / seconds], [x, y]);
        let [lasts, speed, wheels] = self.block;
        self.block = [lasts + seconds, speed + own[0], wheels + own[1]];
        let [speed, wheels] = own.map(|way| way / seconds);
        if moves(speed, wheels) {
            (self.wheels_speed).add(seconds, speed, [], wheels);
        }
        if self.block[0] >= PART_S {
            let [lasts, speed, wheels] = std::mem::take(&mut self.block);
            if moves(speed / lasts, wheels / lasts) {
                (self.block_speed).add(lasts, speed / lasts, [], wheels / lasts);
            }
        }
    }
}
