//! What was found over a log.

use std::ops::RangeInclusive;

use grouser_slip::Reference;

use crate::axes::AxisCheck;
use crate::distance::DistanceCheck;
use crate::exchange::ExchangeCheck;
use crate::mistake::Mistake;
use crate::pose::{PoseCheck, PoseFault};
use crate::steering::SteeringFault;
use crate::turns::TurnCheck;

/// What an estimate uses of a log: a mistake in what it leaves alone is none of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uses {
    /// What measures the robot's motion.
    pub reference: Reference,
    /// Does the reference have a heading? Places alone do not show that the robot begins forwards.
    pub has_heading: bool,
    /// Are accelerations used?
    pub has_acceleration: bool,
}

/// What was found of how the sensors of a log are described.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Findings {
    /// Whether wheels and gyro disagree, and which wheel slips; of a robot with a gyro that turns by the speeds of its sides.
    pub turns: Option<TurnCheck>,
    /// Wheels that show the bends of the other side: their encoders are exchanged. `None` without, and without bends to both
    /// sides.
    pub exchange: Option<ExchangeCheck>,
    /// Whether accelerometer and reference point in the direction in which the wheels drive.
    pub axes: AxisCheck,
    /// Whether the accelerations of the whole log show another scale or sign.
    pub(crate) has_other_acceleration: Option<bool>,
    /// Whether the pose turns as gyro and wheels do, and moves where its yaw points.
    pub pose: PoseCheck,
    /// How far the wheels ran backwards beside a speed over ground that has no sign, m.
    pub speed_without_sign_m: Option<f64>,
    /// How far the robot drove backwards while its wheels, which never turn backwards, turned forwards, m.
    pub wheels_without_sign_m: Option<f64>,
    /// Wheels that turn against the reference while others turn with it, bit by bit in the robot's order.
    pub reversed: Option<u64>,
    /// How the angle of the steering disagrees with the robot's turns.
    pub steering: Option<SteeringFault>,
    /// The distance by the reference as a multiple of that by the wheels.
    pub distance: Option<DistanceCheck>,
    /// Wheels of both sides that always show equal readings, bit by bit in the robot's order.
    pub same_sensor: Option<u64>,
    /// When the log goes on elsewhere after a silence, s from its start.
    pub second_drive_s: Option<f64>,
    /// When the reference first stood while the wheels ran, and then jumped, s from the start of the log.
    pub frozen_s: Option<[f64; 2]>,
    /// Does the gyro show no turn while pose and wheels do?
    pub is_gyro_constant: bool,
    /// The turn by the wheels as a multiple of the measured one, where it is another one and both are alike.
    pub wheels_turn: Option<f64>,
    pub(crate) uses: Uses,
}

/// Distances that are all shorter than this share of the wheels' probably have another unit: the slip of a robot that drives is not
/// as great all the time, and centimetres are the next unit.
const MIN_SCALE: f64 = 0.125;
/// A distance that is this multiple of that by the wheels at most, or at least, everywhere is an error of a scale or great slip: the
/// next common error is that of diameter and radius.
const SUSPICIOUS_SCALES: [f64; 2] = [0.6, 1.6];
/// The multiple of a reference that is derived from the wheels is near 1 and the same in half of the blocks, within this: with motion
/// capture the quartiles differ by 0.003 to 0.008, with satellites on grass by 0.0011, of a filter over wheels by 0.0007: a choice between
/// the last two, made on these logs.
const DERIVED_SCALES: RangeInclusive<f64> = 0.97..=1.03;
const DERIVED_SPREAD: f64 = 0.0008;
/// And its residual is below this, m: that of motion capture is 0.3 to 0.7 mm, that of a filter over wheels up to 0.2 mm.
const DERIVED_NOISE_M: f64 = 2.5e-4;
/// Wheels turn the robot by such multiples of its turn with errors of tyres and tracks.
const TRACK_SCALES: RangeInclusive<f64> = 0.75..=1.33;

impl Findings {
    /// Paths of the pose that are all far shorter than those of the wheels: another unit, or a robot that is stuck all the time.
    pub(crate) fn small_unit(&self) -> Option<Mistake> {
        let [_, _, high] = self.distance?.scales;
        (high < MIN_SCALE).then_some(Mistake::Pose(PoseFault::Unit(high)))
    }

    /// A reference that follows the wheels everywhere.
    fn derived(&self) -> Option<Mistake> {
        let of = self.distance?;
        let [low, high] = of.quartiles;
        let is_even = high - low < DERIVED_SPREAD && DERIVED_SCALES.contains(&of.scales[1]);
        (is_even && of.noise_m < DERIVED_NOISE_M).then_some(Mistake::Derived)
    }

    /// What may be wrong, or may be slip: the log alone does not decide it.
    #[must_use]
    pub fn possible(&self) -> Vec<Mistake> {
        let scale = self.distance.and_then(|distance| {
            let [low, _, high] = distance.scales;
            let [less, more] = SUSPICIOUS_SCALES;
            let scale = if high < less { high } else { low };
            (low > 0.0 && (high < less || low > more)).then_some(Mistake::Scale(scale))
        });
        // an error of the wheels' scale, and slip, change distances and turns alike
        let [low, middle, high] = self.distance.map_or([1.0; 3], |of| of.scales);
        let is_other =
            |turn: &f64| turn * low > *TRACK_SCALES.end() || turn * high < *TRACK_SCALES.start();
        let track = (self.wheels_turn.filter(is_other))
            .filter(|_| self.mistakes().is_empty())
            .map(|turn| turn * middle);
        scale.into_iter().chain(track.map(Mistake::Track)).collect()
    }

    /// The mistakes in what the estimate uses, the one first that explains others.
    #[must_use]
    pub fn mistakes(&self) -> Vec<Mistake> {
        let (exchange, is_pose) = (
            self.exchange.as_ref(),
            self.uses.reference == Reference::Pose,
        );
        let course = self.pose.course.filter(|_| is_pose);
        let acceleration = (self.axes.acceleration).filter(|_| self.uses.has_acceleration);
        let all = [
            self.second_drive_s.map(Mistake::SecondDrive),
            self.frozen_s.map(Mistake::Frozen),
            self.same_sensor.map(Mistake::SameSensor),
            self.speed_without_sign_m.map(Mistake::SpeedWithoutSign),
            self.wheels_without_sign_m.map(Mistake::WheelsWithoutSign),
            self.derived(),
            exchange.map(|found| Mistake::Exchanged {
                is_certain: found.is_certain,
                is_whole: found.is_whole,
            }),
            self.is_gyro_constant.then_some(Mistake::YawRateConstant),
            self.pose.fault.filter(|_| is_pose).map(Mistake::Pose),
            (self.pose.gyro_scale)
                .filter(|_| exchange.is_none())
                .map(Mistake::YawRateScale),
            self.steering.map(Mistake::Steering),
            self.reversed.map(Mistake::Reversed),
            self.axes.reference.or(course).map(Mistake::ReferenceTurned),
            acceleration.map(Mistake::AccelerationTurned),
        ];
        all.into_iter().flatten().collect()
    }
}
