//! All comparisons over one log.

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_real::{Real, solve};
use grouser_slip::motion::{WheelStep, add_equation, common_motion};
use grouser_slip::{Reference, Robot, Sample, SensorSettings, WheelRole};

use crate::causes::{Cause, Fault, MIN_CORRELATION, Row, SENSORS, Signal, weigh};
use crate::comparison::{Angle, Line};
use crate::courses::Courses;
use crate::distance::DistanceCheck;
use crate::findings::{AxisCheck, Findings, Uses};
use crate::mistake::{Mistake, PoseFault, SteeringFault};
use crate::passed::{KnownStep, Pairing, Passed};
use crate::reference_delay::Tracks;
use crate::speeds::Speeds;
use crate::steering::Angles;
use crate::turning::Turning;
use crate::turns::TurnWatch;
use crate::window::Window;
use crate::wiring::{SameSensor, SecondDrive, TwoSources};

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
/// A reference that is mounted further from the origin than this changes the slip in bends, m. Limit.
const MAX_ARM_M: f64 = 0.05;
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
/// Slips of soft ground change within this time, and a camera has two readings in it, s. Prior.
const WINDOW_S: f64 = 0.5;
/// Weight of no sideways speed of a steered wheel against its distance: slips differ by a tenth, headings are described to a
/// hundredth. Prior.
const ACROSS_WEIGHT: f64 = 100.0;
/// Samples that wait for their step at most: a second of the fastest sensors.
const MAX_WAITING: usize = 4096;

/// Compares the sensors of a log with each other.
///
/// It takes every sample in the order of time ([`Doctor::take`]), each step of the motion once it is complete
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
    two_sources: TwoSources,
    /// `None` of a robot that steers by one angle: it turns otherwise than by the speeds of its sides.
    turns: Option<TurnWatch>,
    /// Samples that are later than the last step, and whether they are angles that the steering sets.
    waiting: VecDeque<(Sample, bool)>,
    pairing: Pairing,
    /// What passed by the reference in the open window, and its distance over that by the wheels in the last one.
    passed: Passed,
    share: f64,
    /// The open windows of half a second, and of as much between readings of the reference.
    windows: [Window; 2],
    /// The wheels of the last step that agree with the others, and the speeds of all, m/s.
    wheels: Vec<WheelStep>,
    wheel_speeds: Vec<Option<f64>>,
    scratch: Vec<f64>,
}

impl Doctor {
    /// For a robot with these sensors.
    #[must_use]
    pub fn new(file: &RobotFile, settings: &SensorSettings, sensor: WheelSensor) -> Self {
        let (robot, low_speed) = (&file.robot, settings.low_speed);
        let steering = file.steering.as_ref();
        let by_sides = steering.is_none();
        let wheels = robot.wheels().len();
        Self {
            tracks: Tracks::new(file, settings.reference, sensor).with_room(),
            angles: Angles::new(steering),
            turning: Turning::new(robot, !by_sides),
            courses: Courses::new(settings.reference, settings.position_sigma),
            speeds: Speeds::new(robot, settings, by_sides),
            same_sensor: SameSensor::new(robot),
            second_drive: SecondDrive::default(),
            two_sources: TwoSources::new(robot),
            turns: (by_sides.then(|| TurnWatch::new(robot, low_speed))).flatten(),
            waiting: VecDeque::new(),
            pairing: Pairing::new(settings.reference),
            passed: Passed::default(),
            share: 1.0,
            windows: [Window::new(wheels), Window::new(wheels)],
            wheels: Vec::with_capacity(wheels),
            wheel_speeds: Vec::with_capacity(wheels),
            scratch: vec![0.0; wheels],
            robot: robot.clone(),
        }
    }

    /// Takes a sample, not earlier than those before. It waits for the step in which it is.
    pub fn take(&mut self, sample: &Sample) {
        self.wait((*sample, false));
    }

    /// Takes the angle of a wheel as the robot's steering sets it.
    pub fn take_steering(&mut self, sample: &Sample) {
        self.wait((*sample, true));
    }

    fn wait(&mut self, sample: (Sample, bool)) {
        self.waiting.push_back(sample);
        if self.waiting.len() > MAX_WAITING {
            self.pass_on(1);
        }
    }

    /// Shows the first samples that waited to all comparisons.
    fn pass_on(&mut self, count: usize) {
        for (sample, is_steering) in self.waiting.drain(..count) {
            self.tracks.take(&sample);
            if is_steering {
                continue;
            }
            self.second_drive.take(&self.robot, &sample);
            self.two_sources.take(&sample);
            self.angles.take(&sample);
            self.turning.take(&sample);
            self.courses.take(&sample);
            self.speeds.take(&sample);
        }
    }

    /// Takes a step of the motion that ended at a time (ns, and s from the log's start). Wheels that are `left_out`, bit by bit,
    /// contradict the others.
    pub fn step(&mut self, (end_ns, time_s): (i64, f64), known: &KnownStep<'_>, left_out: u64) {
        let passed = self.waiting.partition_point(|of| of.0.time_ns <= end_ns);
        self.pass_on(passed);
        let (wheels, dt) = (&known.step.wheels, known.step.dt);
        self.wheel_speeds.clear();
        let speed = |of: &WheelStep| of.distance.map(|distance| (distance - of.swing) / dt);
        self.wheel_speeds.extend(wheels.iter().map(speed));
        let described = self.robot.wheels().iter().zip(&self.wheel_speeds);
        let powered = described.filter(|(wheel, _)| wheel.role == WheelRole::Powered);
        let speeds = powered.filter_map(|(_, speed)| *speed);
        let (sum, count) =
            speeds.fold((0.0, 0.0), |(sum, count), speed| (sum + speed, count + 1.0));
        let speed = sum / count;
        if count > 0.0 {
            let motion = self.by_wheels(wheels, dt, left_out);
            (self.turning).step(end_ns, [speed, motion[2]], &self.wheel_speeds);
            self.courses.step(end_ns, speed, motion);
        }
        let turned = self.turning.take_turned();
        self.same_sensor.step(&self.wheel_speeds, turned);
        for window in &mut self.windows {
            window.add(dt, speed, known.step.turn, &self.wheel_speeds);
        }
        let [of_time, of_readings] = &mut self.windows;
        if of_time.seconds >= WINDOW_S {
            if let Some(turns) = &mut self.turns {
                turns.take(time_s, of_time);
            }
            self.speeds.see_signs(of_time);
            if of_time.speed().is_finite() {
                self.speeds.step(end_ns, of_time.speed());
            }
            of_time.clear();
        }
        if let Some(passed) = self.pairing.take(known) {
            self.passed.add(&passed);
        }
        if self.passed.seconds >= WINDOW_S {
            let [x, y] = self.passed.moved;
            self.share = Real::hypot(x, y) / self.passed.length;
            self.speeds.compare_signs(&self.passed, of_readings);
            self.passed = Passed::default();
            of_readings.clear();
        }
    }

    /// The speed by the wheels, m/s and rad/s; of a robot that turns as its wheels stand, at the speed that the reference shows.
    fn by_wheels(&mut self, wheels: &[WheelStep], dt: f64, left_out: u64) -> [f64; 3] {
        self.wheels.clear();
        self.wheels
            .extend(wheels.iter().enumerate().map(|(index, wheel)| WheelStep {
                distance: wheel.distance.filter(|_| left_out >> index & 1 == 0),
                ..*wheel
            }));
        if self.angles.is_steered() {
            let motion = motion_of_steered(&self.wheels, self.share);
            return motion.map_or([f64::NAN; 3], |of| of.map(|part| part / dt));
        }
        let Some(found) = common_motion(&self.wheels, None, 1.0, 0.0, &mut self.scratch) else {
            return [f64::NAN; 3];
        };
        let (sin, cos) = Real::sin_cos(found.direction);
        let turn = found.turn.unwrap_or(f64::NAN);
        [cos * found.distance, sin * found.distance, turn].map(|part| part / dt)
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
    pub fn findings(&mut self, uses: Uses) -> Findings {
        self.pass_on(self.waiting.len());
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
        let (mut axes, reference, has_other_acceleration) = self.axes();
        let reference = reference.filter(|_| uses.has_heading);
        axes.reference = reference.map(|of| of.value);
        let course = (self.course()).filter(|_| uses.has_heading && !has_pose_fault);
        let second_drive = self.second_drive.found_s();
        let [unsigned_speed, unsigned_wheels] = self.without_sign();
        let unsigned_speed = unsigned_speed.filter(|_| uses.reference == Reference::Speed);
        let unsigned_wheels = unsigned_wheels.filter(|_| uses.has_heading && !has_pose_fault);
        let is_used = |of: &Mistake| is_pose || !matches!(of, Mistake::Pose(_));
        // what comes first explains what comes later
        let first = [
            self.two_sources.found(),
            second_drive.map(Mistake::SecondDrive),
            self.same_sensor.found().map(Mistake::SameSensor),
            unsigned_speed.map(Mistake::SpeedWithoutSign),
            unsigned_wheels.map(Mistake::WheelsWithoutSign),
            distance
                .filter(DistanceCheck::is_derived)
                .map(|_| Mistake::Derived),
        ];
        let acceleration = axes.acceleration.filter(|_| uses.has_acceleration);
        let turned = [reference, course].into_iter().flatten();
        let surest = turned.min_by(|a, b| a.half_width.total_cmp(&b.half_width));
        let last = [
            of_unit,
            self.reversed().map(Mistake::Reversed),
            surest.map(|of| Mistake::ReferenceTurned([of.value, of.half_width])),
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
            place: self.place(),
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

    /// The angles of accelerometer and reference, and whether the accelerations have another scale than described.
    fn axes(&self) -> (AxisCheck, Option<Angle>, Option<bool>) {
        let Some(along) = self.speeds.along else {
            return (AxisCheck::default(), None, None);
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
        let is_other = (self.speeds.force_by_wheels.lines()).map(|_| has_other_scale);
        let axes = AxisCheck {
            acceleration: (surest.filter(|of| of.is_beyond(MAX_ANGLE_RAD))).map(|of| of.value),
            reference: None,
        };
        (axes, reference, is_other)
    }

    /// The angle from the yaw of a pose to the course of its places.
    fn course(&self) -> Option<Angle> {
        let along = self.speeds.heading.filter(|_| !self.angles.is_steered())?;
        let found = self.courses.from_yaw.angle(along)?;
        found.is_beyond(MAX_OFFSET_RAD).then_some(found)
    }

    /// Where the reference is mounted by its motion in bends to both sides, with half of its interval, forwards and to the left, m;
    /// where it is not above the origin.
    fn place(&self) -> Option<[[f64; 2]; 2]> {
        let [aside, ahead] = self.speeds.by_turn.lines()?;
        let is_far = |line: &Line| line.is_above(MAX_ARM_M) || line.is_below(-MAX_ARM_M);
        let has_bends = self.turning.has_both_bends() != [false; 2];
        let place = [
            [ahead.slope, -aside.slope],
            [ahead.half_width, aside.half_width],
        ];
        ((is_far(&aside) || is_far(&ahead)) && has_bends && self.speeds.heading.is_some())
            .then_some(place)
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

    /// The turn by the wheels as a multiple of that by gyro or pose, where both turn alike or against each other.
    fn wheels_turn(&self) -> Option<f64> {
        let by_gyro = self.turning.gyro_wheels.line();
        let line = by_gyro.or_else(|| self.turning.yaw_wheels.line())?;
        let is_alike = line.correlation.abs() > MIN_TRACK_CORRELATION && !self.angles.is_steered();
        is_alike.then_some(line.slope)
    }
}

/// Does a wheel turn the robot the other way?
fn shows_the_other_side(line: &Line) -> bool {
    let is_clear = line.is_below(0.0) && line.correlation < -MIN_CORRELATION;
    is_clear && line.slope < MAX_EXCHANGED_SCALE
}

/// Displacement (m) and turn (rad) of powered wheels that are steered: they move along themselves, however much their distances
/// differ. The displacement is `share` of their mean distance: where no motion moves all of them along themselves, that by least
/// squares is the shorter the less they fit.
fn motion_of_steered(wheels: &[WheelStep], share: f64) -> Option<[f64; 3]> {
    let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
    let mut add = |row: [f64; 3], value: f64, weight: f64| {
        add_equation(&mut a, &mut b, row, value, weight);
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for wheel in wheels.iter().filter(|wheel| !wheel.is_free) {
        if let Some(distance) = wheel.distance {
            add(wheel.row, distance - wheel.swing, 1.0);
            (sum, count) = (sum + (distance - wheel.swing).abs(), count + 1.0);
        }
        add(wheel.across, 0.0, ACROSS_WEIGHT);
    }
    let motion = solve(a, b)?;
    let longer = share * sum / count / Real::hypot(motion[0], motion[1]);
    let is_known = longer.is_finite();
    let longer = if is_known {
        longer.min(MAX_WAY_SHARE)
    } else {
        1.0
    };
    Some(motion.map(|part| longer * part))
}
