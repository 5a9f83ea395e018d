//! From one angle of the steering to the angles of the wheels.

use grouser_files::steering::{Steering, SteeringKind};
use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample};

use crate::pose_watch::{GyroTurn, TurnPair};

/// Steers the wheels of a robot by one angle.
#[derive(Clone, Debug)]
pub(crate) struct WheelSteering {
    kind: SteeringKind,
    /// Index and position of each steered wheel, m.
    wheels: Vec<(usize, f64, f64)>,
    /// Position of the unsteered wheels along the robot, and that of the steered ones from there, m.
    rear: f64,
    wheelbase: f64,
}

impl WheelSteering {
    pub(crate) fn new(steering: &Steering, robot: &Robot) -> Self {
        let all = robot.wheels().iter().enumerate();
        let (wheels, others): (Vec<_>, Vec<_>) = all
            .map(|(index, wheel)| (index, wheel.x, wheel.y))
            .partition(|(index, _, _)| steering.wheels.contains(index));
        let mean = |of: &[(usize, f64, f64)]| {
            of.iter().map(|wheel| wheel.1).sum::<f64>() / of.len() as f64
        };
        let rear = mean(&others);
        Self {
            kind: steering.kind,
            rear,
            wheelbase: mean(&wheels) - rear,
            wheels,
        }
    }

    /// The angles of the wheels that a sample of the steering means; nothing for other samples.
    pub(crate) fn angles(&self, sample: &Sample) -> impl Iterator<Item = Sample> {
        let angle = match sample.measurement {
            Measurement::Steering { angle } => Some(angle).filter(|angle| angle.is_finite()),
            _ => None,
        };
        let time_ns = sample.time_ns;
        angle.into_iter().flat_map(move |angle| {
            self.wheels.iter().map(move |&(wheel, x, y)| Sample {
                time_ns,
                measurement: Measurement::SteeringAngle {
                    wheel,
                    angle: self.wheel_angle(angle, x, y),
                },
            })
        })
    }

    /// With Ackermann's steering all wheels turn about one point on the line of the unsteered ones, at R = L / tan δ to the left:
    /// tan δ_i = (x_i − x_r) / (R − y_i). The wheels of an articulated robot's other body turn with it.
    fn wheel_angle(&self, angle: f64, x: f64, y: f64) -> f64 {
        if matches!(self.kind, SteeringKind::Articulated { .. }) {
            return angle;
        }
        let tan = Real::tan(angle);
        Real::atan(tan * (x - self.rear) / (self.wheelbase - y * tan))
    }
}

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
        matches!(steering.kind, SteeringKind::Ackermann).then(|| Self {
            wheelbase: steering.wheelbase,
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
