//! All comparisons over one log.

use std::ops::RangeInclusive;

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_real::Real;
use grouser_slip::window::{WindowBody, WindowSettings};
use grouser_slip::{Reference, Robot, Sample, WheelRole};

use crate::causes::{Cause, Fault, MIN_CORRELATION, Row, SENSORS, Signal, weigh};
use crate::comparison::Line;
use crate::courses::Courses;
use crate::distance::DistanceCheck;
use crate::findings::{AxisCheck, Findings, Uses};
use crate::frozen::FrozenWatch;
use crate::mistake::{Mistake, PoseFault, SteeringFault};
use crate::reference_delay::Tracks;
use crate::speeds::Speeds;
use crate::steering::Angles;
use crate::turning::Turning;
use crate::turns::TurnWatch;
use crate::wiring::{SameSensor, SecondDrive};

/// A reference whose distance is this multiple of the wheels' in the median has another unit: feet are 3.3. Limit.
const MAX_SCALE: f64 = 3.0;
/// Wheels turn by such multiples of the robot's turn: those of a skid-steered robot by more. Limit.
const FIXED_WHEELS: RangeInclusive<f64> = 0.5..=10.0;
/// And steered ones, at the speed over ground: they skid sideways in bends. Limit.
const STEERED_WHEELS: RangeInclusive<f64> = 0.67..=1.54;
/// An exchanged wheel turns the robot by this multiple of what it should at least: slip in bends changes the multiple. Limit.
const MAX_EXCHANGED_SCALE: f64 = -0.5;
/// Angles beyond these are a wrong description, rad (35° and 5°): robots on side slopes drift by less. The second holds where several
/// headings show the drift. Limits.
const MAX_ANGLE_RAD: f64 = 0.61;
const MAX_OFFSET_RAD: f64 = 0.087;
/// Motions that point one way are this long in the mean. Limit.
const MIN_LENGTH: f64 = 0.6;
/// Accelerations are these multiples of the change of the wheels' speed, which slip changes too. Limit.
const ACCELERATIONS: RangeInclusive<f64> = 0.2..=5.0;
/// A shorter distance shows no sign, m. Sensor noise.
const MIN_DISTANCE_M: f64 = 1.0;
/// Turns by wheels are a multiple of the robot's with this correlation. Limit.
const MIN_TRACK_CORRELATION: f64 = 0.95;
/// Causes that are named at most.
const MAX_CAUSES: usize = 3;
/// A robot that goes this many times as far as its wheels is none. Limit.
const MAX_WAY_SHARE: f64 = 2.0;

/// Compares the sensors of a log with each other.
///
/// It takes every sample in the order of time ([`Doctor::take`]), the means over windows after all samples of one time
/// ([`Doctor::step`]), and answers at the end ([`Doctor::findings`]).
#[derive(Clone, Debug)]
pub struct Doctor {
    robot: Robot,
    tracks: Tracks,
    angles: Angles,
    turning: Turning,
    courses: Courses,
    speeds: Speeds,
    same_sensor: SameSensor,
    second_drive: SecondDrive,
    frozen: FrozenWatch,
    /// `None` of a robot that steers by one angle: it turns otherwise than by the speeds of its sides.
    turns: Option<TurnWatch>,
}

/// What is known when all samples of one time have come.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    /// The time, ns.
    pub now_ns: i64,
    /// The same from the log's start, s.
    pub time_s: f64,
    /// Means over the window that ended last.
    pub body: &'a WindowBody,
    /// The speed of each wheel over it in the robot's order, m/s.
    pub wheel_speeds: &'a [Option<f64>],
}

impl Doctor {
    /// For a robot whose means are taken by `settings`.
    #[must_use]
    pub fn new(file: &RobotFile, settings: &WindowSettings, sensor: WheelSensor) -> Self {
        let (robot, low_speed) = (&file.robot, settings.low_speed);
        let steering = file.steering.as_ref();
        let by_sides = steering.is_none();
        Self {
            tracks: Tracks::new(file, settings.reference, sensor).with_room(),
            angles: Angles::new(steering),
            turning: Turning::new(robot, !by_sides),
            courses: Courses::new(settings.position_sigma),
            speeds: Speeds::new(robot, low_speed, by_sides),
            same_sensor: SameSensor::new(robot),
            second_drive: SecondDrive::default(),
            frozen: FrozenWatch::default(),
            turns: (by_sides.then(|| TurnWatch::new(robot, low_speed, settings.window))).flatten(),
            robot: robot.clone(),
        }
    }

    /// Takes a sample, not earlier than those before.
    pub fn take(&mut self, sample: &Sample) {
        self.tracks.take(sample);
        self.second_drive.take(&self.robot, sample);
        self.frozen.take(sample);
        self.angles.take(sample);
        self.turning.take(sample);
        self.courses.take(sample);
        self.speeds.take(sample);
    }

    /// Takes the angle of a wheel as the robot's steering sets it.
    pub fn take_steering(&mut self, sample: &Sample) {
        self.tracks.take(sample);
    }

    /// Takes the means over a window.
    pub fn step(&mut self, window: &Window<'_>) {
        let (body, now_ns) = (window.body, window.now_ns);
        if let Some(turns) = &mut self.turns {
            let speed = |wheel: usize| window.wheel_speeds.get(wheel).copied().flatten();
            turns.take(window.time_s, body, |wheel| speed(wheel).unwrap_or(0.0));
        }
        let wheels = self.robot.wheels().iter().zip(window.wheel_speeds);
        let powered = wheels.filter(|(wheel, _)| wheel.role == WheelRole::Powered);
        let speeds = powered.filter_map(|(_, speed)| *speed);
        let (sum, count) =
            speeds.fold((0.0, 0.0), |(sum, count), speed| (sum + speed, count + 1.0));
        if count > 0.0 {
            let (speed, motion) = (sum / count, self.by_wheels(body));
            self.speeds.step(now_ns, speed);
            self.frozen.step(now_ns, speed);
            (self.turning).step(now_ns, [speed, motion[2]], window.wheel_speeds);
            self.courses.step(now_ns, speed, motion);
        }
        self.speeds.compare_signs(body, window.wheel_speeds);
        let turned = self.turning.take_turned();
        self.same_sensor.step(window.wheel_speeds, turned);
    }

    /// The motion by the wheels; of a robot that turns as its wheels stand, at the speed that the reference shows.
    fn by_wheels(&self, body: &WindowBody) -> [f64; 3] {
        let wheels = body.wheels_motion.map_or([f64::NAN; 3], |of| of.velocity);
        let speed = |[x, y, _]: [f64; 3]| Real::hypot(x, y);
        let by_reference = body.motion.map_or(f64::NAN, |of| speed(of.velocity));
        let share = by_reference / speed(wheels);
        let share = if self.angles.is_steered() && share.is_finite() {
            share.min(MAX_WAY_SHARE)
        } else {
            1.0
        };
        wheels.map(|part| share * part)
    }

    /// The rows of signals that turn, and the wheels that show the other side's bends.
    fn rows(&self) -> (Vec<Row>, u64) {
        let (turning, courses) = (&self.turning, &self.courses);
        let is_steered = self.angles.is_steered();
        let wheels = if is_steered {
            STEERED_WHEELS
        } else {
            FIXED_WHEELS
        };
        let (gyro, yaw, course) = (Signal::Gyro, Signal::Yaw, Signal::Course);
        let all = Signal::Wheels(u64::MAX);
        let mut rows = vec![Row::new([yaw, gyro], &turning.yaw_gyro, &SENSORS, 1.0)];
        let (mut exchanged, mut sides) = (0, [false; 2]);
        if is_steered || turning.sides.is_empty() {
            rows.push(Row::new([gyro, all], &turning.gyro_wheels, &wheels, 1.0));
            rows.push(Row::new([yaw, all], &turning.yaw_wheels, &wheels, 1.0));
        } else {
            let share = 1.0 / turning.sides.len() as f64;
            let both = turning.has_both_bends();
            for side in &turning.sides {
                let of_wheel = Signal::Wheels(1 << side.wheel);
                let mut shows_other_side = None;
                for ((signal, own), has_bends) in
                    [gyro, yaw].into_iter().zip(&side.own_turns).zip(both)
                {
                    let row =
                        Row::new([signal, of_wheel], own, &wheels, share).filter(|_| has_bends);
                    let line = row.as_ref().map(Row::line);
                    shows_other_side = shows_other_side.or(line.map(shows_the_other_side));
                    rows.push(row);
                }
                if shows_other_side == Some(true) {
                    exchanged |= 1 << side.wheel;
                    sides[usize::from(side.arm < 0.0)] = true;
                }
            }
        }
        // outliers of places do not go on turning to one side
        let has_bends = courses
            .next_course
            .line()
            .is_some_and(|line| line.is_above(0.0));
        if has_bends && is_steered {
            rows.push(Row::new(
                [all, course],
                &courses.wheels_course,
                &wheels,
                1.0,
            ));
        }
        if has_bends && self.speeds.along.is_some() && !self.angles.are_wheels_steered {
            rows.push(Row::new([yaw, course], &courses.yaw_course, &SENSORS, 1.0));
        }
        let exchanged = if sides == [true; 2] { exchanged } else { 0 };
        (rows.into_iter().flatten().collect(), exchanged)
    }

    /// What was found, for an estimate that uses these sensors.
    #[must_use]
    pub fn findings(&self, uses: Uses) -> Findings {
        let (rows, exchanged) = self.rows();
        let is_pose = uses.reference == Reference::Pose;
        let turning = self.of_turning(weigh(&rows, exchanged, self.angles.is_steered()));
        let exchange = turning
            .iter()
            .find(|of| matches!(of, Mistake::Exchanged { .. }));
        let mut turns = self.turns.as_ref().map(TurnWatch::summary);
        if let Some(turns) = turns.as_mut().filter(|_| exchange.is_some()) {
            // The difference is wiring: no wheel slips by it.
            turns.wheel = None;
        }
        let distance = DistanceCheck::of(&self.tracks);
        let scale = distance.map_or(1.0, |of| of.scales[1]);
        let of_unit = Some(Mistake::Pose(PoseFault::Unit(scale)))
            .filter(|_| scale > MAX_SCALE && !self.angles.is_steered());
        let has_pose_fault =
            of_unit.is_some() || turning.iter().any(|of| matches!(of, Mistake::Pose(_)));
        let (mut axes, has_other_acceleration) = self.axes();
        axes.reference = axes.reference.filter(|_| uses.has_heading);
        let course = self.course().filter(|_| is_pose && !has_pose_fault);
        let second_drive = self.second_drive.found_s();
        let frozen = self.frozen.found_s().filter(|_| second_drive.is_none());
        let [unsigned_speed, unsigned_wheels] = self.without_sign();
        let unsigned_speed = unsigned_speed.filter(|_| uses.reference == Reference::Speed);
        let unsigned_wheels = unsigned_wheels.filter(|_| uses.has_heading && !has_pose_fault);
        let is_used = |of: &Mistake| is_pose || !matches!(of, Mistake::Pose(_));
        // what comes first explains what comes later
        let first = [
            second_drive.map(Mistake::SecondDrive),
            frozen.map(Mistake::Frozen),
            self.same_sensor.found().map(Mistake::SameSensor),
            unsigned_speed.map(Mistake::SpeedWithoutSign),
            unsigned_wheels.map(Mistake::WheelsWithoutSign),
            distance
                .filter(DistanceCheck::is_derived)
                .map(|_| Mistake::Derived),
        ];
        let acceleration = axes.acceleration.filter(|_| uses.has_acceleration);
        let last = [
            of_unit,
            self.reversed().map(Mistake::Reversed),
            axes.reference.or(course).map(Mistake::ReferenceTurned),
            acceleration.map(Mistake::AccelerationTurned),
        ];
        let is_between = |row: &&Row| row.is_between(Signal::Yaw, Signal::Gyro);
        Findings {
            turns,
            axes,
            distance,
            wheels_turn: self.wheels_turn().filter(|_| exchange.is_none()),
            gyro_agrees: rows.iter().find(is_between).is_some_and(Row::agrees),
            has_other_acceleration,
            mistakes: (first.into_iter().flatten())
                .chain(turning)
                .chain(last.into_iter().flatten())
                .filter(is_used)
                .collect(),
        }
    }

    /// What causes of turns mean.
    fn of_turning(&self, causes: Vec<Cause>) -> Vec<Mistake> {
        let is_steered = self.angles.is_steered();
        let has_gyro = causes.iter().any(|cause| cause.signal == Signal::Gyro);
        let has_wheels = causes
            .iter()
            .any(|cause| matches!(cause.signal, Signal::Wheels(_)));
        let sides = &self.turning.sides;
        let mistake = |cause: Cause| match (cause.signal, cause.fault) {
            (Signal::Wheels(_), fault) if is_steered => Some(Mistake::Steering(match fault {
                Fault::Factor(scale) if STEERED_WHEELS.contains(&-scale) => SteeringFault::Reversed,
                Fault::Factor(_) | Fault::Unrelated => SteeringFault::Unit,
            })),
            (Signal::Wheels(wheels), _) => Some(Mistake::Exchanged {
                wheels,
                is_certain: !has_gyro,
                is_whole: wheels.count_ones() as usize == sides.len(),
            }),
            (Signal::Gyro, Fault::Unrelated) => Some(Mistake::YawRateConstant),
            // the sentence about exchanged wheels names it
            (Signal::Gyro, Fault::Factor(_)) if has_wheels && !is_steered => None,
            (Signal::Gyro, Fault::Factor(scale)) => Some(Mistake::YawRateScale(scale)),
            (Signal::Yaw, Fault::Unrelated) => Some(Mistake::Pose(PoseFault::YawConstant)),
            (Signal::Yaw, Fault::Factor(scale)) if scale < 0.0 && scale > -2.0 => {
                Some(Mistake::Pose(PoseFault::YawMirrored))
            }
            (Signal::Yaw, Fault::Factor(scale)) => Some(Mistake::Pose(PoseFault::YawUnit(scale))),
            (Signal::Course, _) => Some(Mistake::Pose(PoseFault::PlaceMirrored)),
        };
        if self.angles.have_other_unit() {
            return vec![Mistake::Steering(SteeringFault::Unit)];
        }
        let mut found: Vec<Mistake> = causes.into_iter().filter_map(mistake).collect();
        found.dedup_by_key(|found| std::mem::discriminant(found));
        found.truncate(MAX_CAUSES);
        found
    }

    /// Angles of accelerometer and reference, and whether the accelerations have another scale than described.
    fn axes(&self) -> (AxisCheck, Option<bool>) {
        let Some(along) = self.speeds.along else {
            return (AxisCheck::default(), None);
        };
        let by_wheels = self.speeds.force_by_wheels.angle(along);
        let reference = (self.speeds.reference_by_wheels.angle(along))
            .filter(|of| of.is_beyond(MAX_ANGLE_RAD) && of.length > MIN_LENGTH);
        // Where slip changes, the reference shows the robot's speeding up and the wheels do not.
        let by_reference =
            (self.speeds.force_by_reference.angle(along)).filter(|_| reference.is_none());
        let acceleration = [by_wheels, by_reference].into_iter().flatten();
        let surest = acceleration.min_by(|a, b| a.half_width.total_cmp(&b.half_width));
        let has_other_scale =
            by_wheels.is_some_and(|of| !ACCELERATIONS.contains(&(of.length * Real::cos(of.value))));
        let is_other = (self.speeds.force_by_wheels.is_known()).then_some(has_other_scale);
        let axes = AxisCheck {
            acceleration: (surest.filter(|of| of.is_beyond(MAX_ANGLE_RAD))).map(|of| of.value),
            reference: reference.map(|of| of.value),
        };
        (axes, is_other)
    }

    /// The angle from the yaw of a pose to the course of its places.
    fn course(&self) -> Option<f64> {
        let along = self.speeds.heading.filter(|_| !self.angles.is_steered())?;
        let found = self.courses.from_yaw.angle(along)?;
        found.is_beyond(MAX_OFFSET_RAD).then_some(found.value)
    }

    /// How far the wheels ran backwards beside a speed that is never negative, m, and how far the robot went backwards beside wheels that
    /// never do.
    fn without_sign(&self) -> [Option<f64>; 2] {
        let [[_, wheels_backwards], [backwards, neither]] = *self.speeds.wheels_speed.by_sign();
        let is_size = backwards[0] == 0.0 && neither[0] == 0.0;
        let [[both, _], [speed_backwards, _]] = *self.speeds.block_speed.by_sign();
        let is_counted = both[0] > MIN_DISTANCE_M && !self.speeds.have_wheels_sign;
        [
            Some(wheels_backwards[1]).filter(|way| is_size && *way > MIN_DISTANCE_M),
            Some(speed_backwards[0]).filter(|way| is_counted && *way > MIN_DISTANCE_M),
        ]
    }

    /// The wheels that turn against the motion, bit by bit in the robot's order, where others turn with it.
    fn reversed(&self) -> Option<u64> {
        let (mut reversed, mut is_sound) = (0, false);
        for (index, own) in self.speeds.by_wheel.iter().enumerate() {
            let Some(line) = own.as_ref().and_then(|(_, comparison)| comparison.line()) else {
                continue;
            };
            is_sound |= line.is_above(0.0);
            if line.is_below(0.0) && line.correlation < -MIN_CORRELATION {
                reversed |= 1 << index;
            }
        }
        (reversed != 0 && is_sound).then_some(reversed)
    }

    /// The turn by the wheels as a multiple of that by gyro or pose, where both turn alike.
    fn wheels_turn(&self) -> Option<f64> {
        let by_gyro = self.turning.gyro_wheels.line();
        let line = by_gyro.or_else(|| self.turning.yaw_wheels.line())?;
        let is_alike = line.correlation > MIN_TRACK_CORRELATION && !self.angles.is_steered();
        is_alike.then_some(line.slope)
    }
}

/// Does a wheel turn the robot the other way?
fn shows_the_other_side(line: &Line) -> bool {
    let is_clear = line.is_below(0.0) && line.correlation < -MIN_CORRELATION;
    is_clear && line.slope < MAX_EXCHANGED_SCALE
}
