//! Does a pose turn as gyro and wheels do, does its place move where its yaw points, and as far as the wheels drive?
//!
//! A pose whose axes, yaw or unit are described wrongly makes slips of turns and of straight ways; here the fault itself is
//! measured, so that the output can name the cause.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use grouser_files::steering::{Steering, SteeringKind};
use grouser_real::{Real, wrap_angle};
use grouser_slip::window::WindowBody;
use grouser_slip::{Measurement, Robot, Sample, WheelRole};

use crate::motion::common_heading;
use crate::paths::{MIN_PATH_M, Paths};
use crate::steering::{SteeringFault, steering_fault};
use crate::turn_pair::{GyroTurn, MIN_CORRELATION, TurnPair};

/// Turns are compared over this time, s: long against the delay of a reference; and not over a longer one than the second.
const TURN_TIME_S: f64 = 3.0;
const MAX_TURN_TIME_S: f64 = 6.0;
/// Wheels that slip in bends show the sense of the turn.
const MIN_WHEELS_CORRELATION: f64 = 0.4;
/// A gyro whose turns have this correlation with those of the reference has the right sign.
const MIN_GYRO_CORRELATION: f64 = 0.5;
/// Multiples of the wheels' turn that a robot turns by: wheels of a skid-steered one turn it by less than without slip.
const WHEELS_SCALES: RangeInclusive<f64> = 0.1..=2.0;
/// A turn over that time is a bend beyond this, rad: the bias of a gyro lies below.
const MIN_BEND_RAD: f64 = 0.15;
/// Turns by wheels are a multiple of the robot's with this correlation.
const MIN_TRACK_CORRELATION: f64 = 0.95;
/// No robot turns by more between two poses, rad: a yaw that was turned round does.
const MAX_JUMP_RAD: f64 = 2.5;
/// A sensor in degrees that is taken for one in radians turns by this multiple, within this share: wheels show turns no better.
const DEGREES_PER_RADIAN: f64 = 180.0 / PI;
const DEGREES_TOLERANCE: f64 = 0.2;
/// Courses of places that are compared with the steering: their length in standard deviations of a place, so that two differ by 0.12 rad
/// at most by noise. The path of the wheels is up to the second number of times as long or as short.
const COURSE_SIGMAS: f64 = 20.0;
const MAX_PATH_SCALE: f64 = 5.0;
/// A robot that goes this many times as far as its wheels is none.
const MAX_WAY_SHARE: f64 = 2.0;
/// Nothing is known of a path between two readings of the wheels that are further apart, s.
const MAX_PATH_GAP_S: f64 = 1.0;
/// No steering turns the wheels of one angle as far, rad (86°), and no wheel that is steered by itself: such angles have another unit.
/// One in as many readings is an outlier.
const MAX_STEERING_RAD: f64 = 1.5;
const MAX_WHEEL_STEERING_RAD: f64 = 7.0;
const READINGS_PER_OUTLIER: i64 = 50;
/// How a pose disagrees with the robot's other sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PoseFault {
    /// Its yaw stays the same while the gyro turns.
    YawConstant,
    /// Its yaw turns against the gyro.
    YawMirrored,
    /// Its yaw turns by this multiple of the gyro's or the wheels' turn.
    YawUnit(f64),
    /// Its place turns against its yaw: an axis is mirrored, or both are exchanged.
    PlaceMirrored,
    /// Its ways are this many times those of the wheels.
    Unit(f64),
}

/// What was found of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseCheck {
    /// How it disagrees with other sensors.
    pub fault: Option<PoseFault>,
    /// The gyro's turn as a multiple of the pose's, where wheels and pose agree and the gyro does not.
    pub gyro_scale: Option<f64>,
    /// The angle from its yaw to the course of straight ways, rad, where it is clear.
    pub course: Option<f64>,
    /// Does its yaw turn as the gyro does?
    pub(crate) gyro_agrees: bool,
}

/// Is it the scale of degrees that are taken for radians?
fn is_degrees(scale: f64) -> bool {
    (scale.abs() / DEGREES_PER_RADIAN - 1.0).abs() < DEGREES_TOLERANCE
}

/// Compares a pose with gyro and wheels over a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct PoseWatch {
    /// Heading of wheels that all point one way and are not steered, rad.
    heading: Option<f64>,
    /// Does one angle steer wheels of one body?
    is_ackermann: bool,
    gyro: GyroTurn,
    has_gyro: bool,
    /// Mean speed of the wheels, m/s, the turn by them, rad, and when they were read.
    speed: f64,
    wheels: f64,
    stepped_ns: Option<i64>,
    /// Time and yaw of the last pose; begin of the turn, and the pose's turn since.
    last_yaw: Option<f64>,
    turn_ns: Option<i64>,
    turn: f64,
    gyro_pose: TurnPair,
    gyro_wheels: TurnPair,
    wheels_pose: TurnPair,
    course_wheels: TurnPair,
    /// Readings of steering angles that no steering has, each less those that may pass for outliers; `None` without readings.
    beyond: Option<i64>,
    /// |Turn| in bends by gyro or pose since it was taken last, rad.
    turned: f64,
    /// Place, m, and heading, rad, by wheels without slip; where the last course began by places and by wheels; the courses by both.
    path: [f64; 3],
    course_from: Option<[[f64; 2]; 2]>,
    course: Option<[f64; 2]>,
    min_course: f64,
    paths: Paths,
}

impl PoseWatch {
    pub(crate) fn new(
        robot: &Robot,
        steering: Option<&Steering>,
        low_speed: f64,
        sigma: f64,
    ) -> Self {
        let mut wheels = robot.wheels().iter();
        let is_fixed = steering.is_none()
            && wheels.all(|wheel| wheel.role != WheelRole::Powered || wheel.steers_about.is_none());
        let along = common_heading(robot, Real::cos(0.02));
        let heading = along.filter(|_| is_fixed);
        Self {
            is_ackermann: steering.is_some_and(|steering| steering.kind == SteeringKind::Ackermann),
            heading: heading.map(|[cos, sin]| Real::atan2(sin, cos)),
            min_course: MIN_PATH_M.max(COURSE_SIGMAS * sigma),
            paths: Paths::new(low_speed, sigma),
            ..Self::default()
        }
    }

    /// Takes a reading of the gyro, a pose, or that wheels are steered; others have no effect.
    pub(crate) fn take(&mut self, sample: &Sample) {
        match sample.measurement {
            Measurement::YawRate { rate } => {
                self.has_gyro = true;
                self.gyro.take(sample.time_ns, rate);
            }
            Measurement::Pose { x, y, yaw } if (x + y + yaw).is_finite() => {
                self.take_turn(sample.time_ns, yaw);
                self.paths.take(sample.time_ns, [x, y], yaw);
                self.take_course([x, y]);
            }
            Measurement::Displacement {
                turn: Some(turn), ..
            } if turn.is_finite() => {
                self.take_turn(sample.time_ns, self.last_yaw.unwrap_or(0.0) + turn);
            }
            Measurement::Position { x, y } if (x + y).is_finite() => self.take_course([x, y]),
            Measurement::SteeringAngle { angle, .. } => {
                self.heading = None;
                self.take_angle(angle, MAX_WHEEL_STEERING_RAD);
            }
            Measurement::Steering { angle } if self.is_ackermann => {
                self.take_angle(angle, MAX_STEERING_RAD);
            }
            _ => {}
        }
    }

    /// Takes the mean speed of the powered wheels, m/s, and the means over the window.
    pub(crate) fn step(&mut self, now_ns: i64, speed: f64, body: &WindowBody) {
        let before = std::mem::replace(&mut self.speed, speed);
        let last_ns = self.stepped_ns.replace(now_ns);
        let passed = last_ns.map_or(0.0, |last_ns| now_ns.saturating_sub(last_ns) as f64 * 1e-9);
        self.paths.step(speed);
        if last_ns.is_some() {
            let [x, y, turn] = self.by_wheels(body);
            self.wheels += turn * passed;
            // to and fro courses turn by half a turn
            if turn.is_finite() && passed < MAX_PATH_GAP_S && before * speed > 0.0 {
                let (sin, cos) = Real::sin_cos(self.path[2]);
                self.path[0] += (cos * x - sin * y) * passed;
                self.path[1] += (sin * x + cos * y) * passed;
                self.path[2] += turn * passed;
            } else {
                (self.course_from, self.course) = (None, None);
            }
        }
        if self.last_yaw.is_none() {
            self.compare_turns(now_ns);
        }
    }

    /// The motion by the wheels; of a robot that turns as its wheels stand, at the speed that the reference shows.
    fn by_wheels(&self, body: &WindowBody) -> [f64; 3] {
        let wheels = body.wheels_motion.map_or([f64::NAN; 3], |of| of.velocity);
        let speed = |[x, y, _]: [f64; 3]| Real::hypot(x, y);
        let by_reference = body.motion.map_or(f64::NAN, |of| speed(of.velocity));
        let share = by_reference / speed(wheels);
        let share = if self.beyond.is_some() && share.is_finite() {
            share.min(MAX_WAY_SHARE)
        } else {
            1.0
        };
        wheels.map(|part| share * part)
    }

    fn take_angle(&mut self, angle: f64, limit: f64) {
        let is_beyond = angle.abs() > limit;
        *self.beyond.get_or_insert(0) += if is_beyond { READINGS_PER_OUTLIER } else { -1 };
    }

    /// Compares the courses by places and by wheels where a course ends.
    fn take_course(&mut self, place: [f64; 2]) {
        let here = [place, [self.path[0], self.path[1]]];
        let from = *self.course_from.get_or_insert(here);
        let way = |i: usize| [here[i][0] - from[i][0], here[i][1] - from[i][1]];
        let [places, path] = [way(0), way(1)].map(|[x, y]| (Real::hypot(x, y), Real::atan2(y, x)));
        if places.0 < self.min_course {
            return;
        }
        self.course_from = Some(here);
        let is_alike = path.0 < MAX_PATH_SCALE * places.0 && places.0 < MAX_PATH_SCALE * path.0;
        let before = std::mem::replace(&mut self.course, is_alike.then_some([places.1, path.1]));
        if let Some((before, now)) = before.zip(self.course) {
            let [places, path] = [0, 1].map(|i| wrap_angle(now[i] - before[i]));
            self.course_wheels.add(places, path);
        }
    }

    fn take_turn(&mut self, now_ns: i64, yaw: f64) {
        let last = self.last_yaw.replace(yaw).unwrap_or(yaw);
        let turn = wrap_angle(yaw - last);
        // NaN: a turn with a yaw that was turned round is left out
        self.turn += if turn.abs() < MAX_JUMP_RAD {
            turn
        } else {
            f64::NAN
        };
        self.compare_turns(now_ns);
    }

    fn compare_turns(&mut self, now_ns: i64) {
        let passed = self.turn_ns.map_or(f64::INFINITY, |from| {
            now_ns.saturating_sub(from) as f64 * 1e-9
        });
        if passed < TURN_TIME_S {
            return;
        }
        self.turn_ns = Some(now_ns);
        let (pose, gyro) = (std::mem::take(&mut self.turn), self.gyro.pass());
        let wheels = std::mem::take(&mut self.wheels);
        let turn = if self.has_gyro { gyro } else { pose };
        if turn.abs() > MIN_BEND_RAD {
            self.turned += turn.abs();
        }
        if passed < MAX_TURN_TIME_S {
            if self.has_gyro {
                self.gyro_pose.add(gyro, pose);
                self.gyro_wheels.add(gyro, wheels);
            }
            self.wheels_pose.add(wheels, pose);
        }
    }

    /// What was found.
    pub(crate) fn summary(&self) -> PoseCheck {
        let (yaw, gyro_scale) = self.yaw();
        let fault = yaw.or_else(|| self.paths.is_mirrored().then_some(PoseFault::PlaceMirrored));
        PoseCheck {
            course: (self.heading.filter(|_| fault.is_none()))
                .and_then(|heading| self.paths.offset(heading)),
            fault,
            gyro_scale,
            gyro_agrees: self.gyro_pose.is_known() && self.gyro_pose.agrees(1.0),
        }
    }

    /// |Turn| in bends since the last call, rad.
    pub(crate) fn take_turned(&mut self) -> f64 {
        std::mem::take(&mut self.turned)
    }

    /// Does the gyro show no turn while pose and wheels turn alike?
    pub(crate) fn is_gyro_constant(&self) -> bool {
        let pose = self.gyro_pose.exchanged();
        let wheels = &self.wheels_pose;
        let wheels_agree = wheels.is_known() && wheels.correlation() > MIN_CORRELATION;
        self.has_gyro && pose.is_known() && wheels_agree && pose.second_is_constant()
    }

    /// The turn by the wheels as a multiple of that by gyro or pose, where both turn alike.
    pub(crate) fn wheels_turn(&self) -> Option<f64> {
        if self.beyond.is_some() {
            return None;
        }
        let pose = self.wheels_pose.exchanged();
        let by = if self.gyro_wheels.is_known() {
            &self.gyro_wheels
        } else {
            &pose
        };
        let is_alike = by.is_known() && by.correlation() > MIN_TRACK_CORRELATION;
        let scale = by.scale();
        (is_alike && scale > 0.0).then_some(scale)
    }

    /// Is the sign of the robot's turns certain: is there no gyro, or one that turns as the reference does?
    pub(crate) fn is_turn_certain(&self) -> bool {
        let gyro_agrees = self.gyro_pose.correlation() > MIN_GYRO_CORRELATION;
        self.last_yaw.is_some() && (gyro_agrees || !self.has_gyro)
    }

    /// The fault of the steering, and the scale of a gyro that alone disagrees with it.
    pub(crate) fn steering(&self) -> (Option<SteeringFault>, Option<f64>) {
        match self.beyond {
            None => return (None, None),
            Some(beyond) if beyond > 0 => return (Some(SteeringFault::Unit), None),
            Some(_) => {}
        }
        let pose_wheels = self.wheels_pose.exchanged();
        steering_fault([&self.gyro_wheels, &pose_wheels, &self.course_wheels])
    }

    /// Does the yaw or the gyro turn otherwise than the others?
    fn yaw(&self) -> (Option<PoseFault>, Option<f64>) {
        let (gyro, wheels) = (&self.gyro_pose, &self.wheels_pose);
        if gyro.is_known() {
            if gyro.agrees(1.0) {
                return (None, None);
            }
            let known = self.gyro_wheels.is_known();
            let wheels_turn = self.gyro_wheels.correlation();
            let is_apart = gyro.agrees_but_for_scale();
            let gyro_scale = 1.0 / gyro.scale();
            let wheels_agree = known && wheels.correlation() > MIN_CORRELATION;
            let is_like_wheels = wheels_agree && WHEELS_SCALES.contains(&wheels.scale());
            if is_apart && (is_degrees(gyro_scale) || is_like_wheels) {
                return (None, Some(gyro_scale));
            }
            if known && !(wheels_turn > MIN_WHEELS_CORRELATION) {
                return (None, None);
            }
        }
        let by = if self.has_gyro { gyro } else { wheels };
        if !by.is_known() {
            return (None, None);
        }
        // wheels that slip unequally turn where a robot drives straight on
        let is_constant = by.second_is_constant();
        if is_constant && !self.has_gyro {
            return (None, None);
        }
        if is_constant && !by.agrees_but_for_scale() {
            (Some(PoseFault::YawConstant), None)
        } else if by.agrees(-1.0) {
            (Some(PoseFault::YawMirrored), None)
        } else if by.agrees_but_for_scale() && is_degrees(by.scale()) {
            (Some(PoseFault::YawUnit(by.scale())), None)
        } else {
            (None, None)
        }
    }
}
