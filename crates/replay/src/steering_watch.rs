//! Does the robot turn as its steering angle says?

use grouser_real::Real;
use grouser_slip::{Measurement, Sample};

use crate::steering::WheelSteering;
use crate::turn_pair::{GyroTurn, TurnPair};

/// No steering turns a wheel as far, rad (86°): such angles have another unit. More often than in this share of the readings
/// they are no outliers.
const MAX_ANGLE_RAD: f64 = 1.5;
const MAX_BEYOND_SHARE: f64 = 0.02;
/// Turns are compared over this time, s.
const TURN_TIME_S: f64 = 2.0;
/// A gyro that turns by more than this multiple of what the steering says shows another unit.
const MAX_SCALE: f64 = 10.0;

/// How a steering angle disagrees with the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SteeringFault {
    /// Its sign.
    Reversed,
    /// Its unit.
    Unit,
}

/// Compares the turn by the steering, Ω = v tan δ / L, with that by the gyro.
#[derive(Clone, Debug)]
pub(crate) struct SteeringWatch {
    wheelbase: f64,
    angle: f64,
    /// Readings of the angle, and those that no steering has.
    count: f64,
    beyond: f64,
    gyro: GyroTurn,
    turn: f64,
    stepped_ns: Option<i64>,
    begun_ns: Option<i64>,
    turns: TurnPair,
}

impl SteeringWatch {
    /// `None` of a robot whose bodies are steered: its turn depends on their rate too.
    pub(crate) fn new(steering: &WheelSteering) -> Option<Self> {
        let wheelbase = steering.ackermann_wheelbase()?;
        Some(Self {
            wheelbase,
            angle: 0.0,
            count: 0.0,
            beyond: 0.0,
            gyro: GyroTurn::default(),
            turn: 0.0,
            stepped_ns: None,
            begun_ns: None,
            turns: TurnPair::default(),
        })
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        match sample.measurement {
            Measurement::YawRate { rate } => self.gyro.take(sample.time_ns, rate),
            Measurement::Steering { angle } if angle.is_finite() => {
                self.angle = angle;
                self.count += 1.0;
                self.beyond += f64::from(angle.abs() > MAX_ANGLE_RAD);
            }
            _ => {}
        }
    }

    /// Takes the mean speed of the powered rims, m/s.
    pub(crate) fn step(&mut self, now_ns: i64, rim: f64) {
        let seconds = |from: i64| now_ns.saturating_sub(from) as f64 * 1e-9;
        if let Some(last_ns) = self.stepped_ns.replace(now_ns) {
            self.turn += rim * Real::tan(self.angle) / self.wheelbase * seconds(last_ns);
        }
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        if seconds(begun_ns) >= TURN_TIME_S {
            self.begun_ns = Some(now_ns);
            self.turns
                .add(self.gyro.pass(), std::mem::take(&mut self.turn));
        }
    }

    pub(crate) fn fault(&self) -> Option<SteeringFault> {
        let turns = &self.turns;
        if self.beyond > MAX_BEYOND_SHARE * self.count {
            return Some(SteeringFault::Unit);
        }
        if !turns.is_known() {
            return None;
        }
        if turns.agrees(-1.0) {
            return Some(SteeringFault::Reversed);
        }
        let is_small = turns.agrees_but_for_scale() && turns.scale().abs() < 1.0 / MAX_SCALE;
        is_small.then_some(SteeringFault::Unit)
    }
}
