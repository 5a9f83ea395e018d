//! What was found over a log.

use std::ops::RangeInclusive;

use grouser_slip::Reference;

use crate::distance::DistanceCheck;
use crate::mistake::{Mistake, PoseFault};
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

/// How far the axes of sensors are turned against the direction in which the wheels drive, rad, positive to the left; `None`
/// where the axes agree or the log cannot show it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisCheck {
    /// Of the accelerometer.
    pub acceleration: Option<f64>,
    /// Of the displacement, pose or velocity that measures the robot's motion.
    pub reference: Option<f64>,
}

/// What was found of how the sensors of a log are described.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Findings {
    /// Whether wheels and gyro disagree, and which wheel slips; of a robot with a gyro that turns by the speeds of its sides.
    pub turns: Option<TurnCheck>,
    /// Whether accelerometer and reference point in the direction in which the wheels drive.
    pub axes: AxisCheck,
    /// The distance by the reference as a multiple of that by the wheels.
    pub distance: Option<DistanceCheck>,
    /// The mistakes in what the estimate uses, the one first that explains others.
    pub mistakes: Vec<Mistake>,
    /// The turn by the wheels as a multiple of the measured one, where both are alike.
    pub(crate) wheels_turn: Option<f64>,
    /// Does the yaw of the reference turn as the gyro does?
    pub(crate) gyro_agrees: bool,
    /// Where the reference is mounted by its motion in bends, and half of its interval, where it is to the side, m.
    pub(crate) place: Option<[[f64; 2]; 2]>,
    /// Whether the accelerations of the whole log show another scale or sign.
    pub(crate) has_other_acceleration: Option<bool>,
}

/// Distances that are all shorter than this share of the wheels' probably have another unit: the slip of a robot that drives is not
/// as great all the time, and centimetres are the next unit. Limit.
const MIN_SCALE: f64 = 0.125;
/// A distance that is this multiple of that by the wheels at most, or at least, everywhere is an error of a scale or great slip: the
/// next common error is that of diameter and radius. Limits.
const SUSPICIOUS_SCALES: [f64; 2] = [0.6, 1.6];
/// Wheels turn the robot by such multiples of its turn with errors of tyres and tracks. Limit.
const TRACK_SCALES: RangeInclusive<f64> = 0.75..=1.33;

impl Findings {
    /// Distances by the pose that are all far shorter than those of the wheels: another unit, or a robot that is stuck all the time.
    pub(crate) fn small_unit(&self) -> Option<Mistake> {
        let [_, _, high] = self.distance?.scales;
        (high < MIN_SCALE).then_some(Mistake::Pose(PoseFault::Unit(high)))
    }

    /// What may be wrong, or may be slip: the log alone does not decide it.
    #[must_use]
    pub fn possible(&self) -> Vec<Mistake> {
        let [low, middle, high] = self.distance.map_or([1.0; 3], |of| of.scales);
        let [less, more] = SUSPICIOUS_SCALES;
        let is_suspicious = low > 0.0 && (high < less || low > more);
        let scale = if high < less { high } else { low };
        // an error of the wheels' scale, and slip, change distances and turns alike
        let is_other = |turn: &f64| {
            low > 0.0 && (turn * low > *TRACK_SCALES.end() || turn * high < *TRACK_SCALES.start())
        };
        let turn = self.wheels_turn.filter(|_| self.mistakes.is_empty());
        let track = turn.filter(is_other).map(|turn| {
            if turn > 0.0 {
                Mistake::Track(turn * middle)
            } else {
                // or the inner wheels slip by more than the bend
                Mistake::Exchanged {
                    wheels: u64::MAX,
                    is_certain: true,
                    is_whole: true,
                }
            }
        });
        let scale = is_suspicious.then_some(Mistake::Scale(scale));
        let place = self.place.filter(|_| self.mistakes.is_empty());
        let place = place.map(Mistake::ReferencePlace);
        (scale.into_iter().chain(track)).chain(place).collect()
    }
}
