//! Speeds and their changes: by the wheels, by the reference, and by the accelerometer.

use grouser_real::Real;
use grouser_slip::window::WindowBody;
use grouser_slip::{Measurement, Robot, Sample, Wheel, WheelRole};

use crate::comparison::{Comparison, Direction, PART_S};
use crate::motion::{common_heading, displacement};

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
    speed: f64,
    pose: Option<[f64; 3]>,
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
    until_ns: Option<i64>,
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
    pub(crate) fn new(robot: &Robot, low_speed: f64, is_fixed_robot: bool) -> Self {
        let is_fixed =
            |wheel: &&Wheel| wheel.role == WheelRole::Powered && wheel.steers_about.is_none();
        let wheels = robot.wheels().iter();
        let are_fixed = is_fixed_robot
            && (wheels.clone()).all(|wheel| wheel.role != WheelRole::Powered || is_fixed(&wheel));
        let of = |wheel: &Wheel| (wheel.speed_row(), Comparison::default());
        Self {
            along: common_heading(robot, PARALLEL_COSINE),
            heading: common_heading(robot, EQUAL_COSINE).filter(|_| are_fixed),
            low_speed,
            by_wheel: (wheels.map(|wheel| Some(wheel).filter(is_fixed).map(of))).collect(),
            ..Self::default()
        }
    }

    /// Takes a sample of an accelerometer or of a measured motion; others have no effect.
    pub(crate) fn take(&mut self, sample: &Sample) {
        let (passed, turn) = match sample.measurement {
            Measurement::Acceleration { forward, left } if (forward + left).is_finite() => {
                let [x, y, count] = self.force;
                self.force = [x + forward, y + left, count + 1.0];
                return;
            }
            Measurement::Pose { x, y, yaw } => {
                let last = self.pose.replace([x, y, yaw]).unwrap_or([x, y, yaw]);
                displacement(last, [x, y, yaw])
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => ([forward, left], turn.unwrap_or(0.0)),
            _ => return,
        };
        let now_ns = sample.time_ns;
        let last_ns = self.reference_ns.replace(now_ns).unwrap_or(now_ns);
        let seconds = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        let Some([cos, sin]) = self.along.filter(|_| seconds > 0.0) else {
            return;
        };
        self.passed[0] += cos * passed[0] + sin * passed[1];
        self.passed[1] += seconds;
        if turn.abs() < MAX_TURN_RAD && self.speed.abs() > self.low_speed {
            let length = Real::hypot(passed[0], passed[1]).copysign(self.speed);
            (self.reference_by_wheels).add(seconds, length, [0.0; 2], passed);
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
                    of(self).add(seconds, change, [1.0, 0.0], gained);
                }
            };
            add(|own| &mut own.force_by_wheels, speed - speed_then);
            if let Some((before, forward)) = before.zip(forward) {
                add(|own| &mut own.force_by_reference, forward - before);
            }
        }
        self.force_before = force;
    }

    /// Takes the window that ended at `body.until_ns`, once, with the speeds of the wheels over it, m/s.
    pub(crate) fn compare_signs(&mut self, body: &WindowBody, wheels: &[Option<f64>]) {
        let low_speed = self.low_speed;
        self.have_wheels_sign |= wheels.iter().flatten().any(|speed| *speed < -low_speed);
        let last_ns = std::mem::replace(&mut self.until_ns, body.until_ns);
        let (Some(last_ns), Some(until_ns), Some(motion)) = (last_ns, body.until_ns, &body.motion)
        else {
            return;
        };
        let seconds = (until_ns.saturating_sub(last_ns) as f64 * 1e-9).min(1.0);
        let moves = |x: f64, y: f64| x.abs() > low_speed && y.abs() > low_speed;
        for (own, wheel) in self.by_wheel.iter_mut().zip(wheels) {
            if let (Some((row, comparison)), Some(wheel)) = (own, wheel) {
                let speed = motion.along(*row).value;
                if moves(speed, *wheel) {
                    comparison.add(seconds, speed, [0.0; 2], *wheel);
                }
            }
        }
        if let Some(by_wheels) = &body.wheels_motion {
            let own = [motion, by_wheels].map(|motion| seconds * motion.velocity[0]);
            let [lasts, speed, wheels] = self.block;
            self.block = [lasts + seconds, speed + own[0], wheels + own[1]];
            let [speed, wheels] = own.map(|way| way / seconds);
            if moves(speed, wheels) {
                (self.wheels_speed).add(seconds, speed, [0.0; 2], wheels);
            }
        }
        if self.block[0] >= PART_S {
            let [lasts, speed, wheels] = std::mem::take(&mut self.block);
            if moves(speed / lasts, wheels / lasts) {
                (self.block_speed).add(lasts, speed / lasts, [0.0; 2], wheels / lasts);
            }
        }
    }
}
