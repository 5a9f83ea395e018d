//! What the controller receives, and the robot as a whole that follows from it.

use super::finite;
use super::wheel_controller::WheelController;
use crate::filter::SlipPrior;
use crate::state::{Health, Invalid, Motion};

/// A powered wheel slower than this share of the mean rim speed counts as standing: the others then slip more on any
/// ground. Tuned on the shipped scenarios (`crates/rover/tests/drive.rs`).
const STANDING_RIM_SHARE: f64 = 0.2;
/// One wheel's firmness counts only as far as the next softest wheel's is at most this much greater: a single sensor may
/// be wrong. Tuned on the shipped scenarios.
const FIRMNESS_AGREEMENT: f64 = 0.15;
/// Loads outside these limits are no loads of a wheel, N.
const LOAD_LIMITS_N: (f64, f64) = (1e-3, 1e9);

/// Angles beyond this are no angles, rad: their fraction of a turn is lost in rounding, and differences could overflow.
const MAX_ANGLE_RAD: f64 = 1e6;
/// Requested speeds are limited to this before anything is computed of them, m/s.
const MAX_SPEED_M_PER_S: f64 = 1e6;

/// An angle that can be computed with.
fn angle(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.abs() <= MAX_ANGLE_RAD)
}

/// What is known of a wheel. Numbers that are NaN or infinite count as absent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelObservation {
    /// Its slip as estimated.
    pub slip: Option<f64>,
    /// Standard deviation of its slip.
    pub sigma: Option<f64>,
    /// How far it can be trusted.
    pub health: Health,
    /// How it moves.
    pub motion: Option<Motion>,
    /// Speed of its centre along its heading, m/s.
    pub forward_speed: Option<f64>,
    /// Speed of its rim by its own encoder, m/s.
    pub rim_speed: Option<f64>,
    /// Torque over the motor's greatest, signed, from its current.
    pub torque_share: Option<f64>,
    /// Torque over what the known soil would take at the wheel's slip and load: well below 1 on softer ground.
    pub firmness: Option<f64>,
    /// Load that it carries, N, as known or measured.
    pub load: f64,
}

impl WheelObservation {
    /// A wheel of which only its load (N) is known.
    ///
    /// ```
    /// use grouser_slip::control::WheelObservation;
    ///
    /// let mut wheel = WheelObservation::unknown(60.0); // N
    /// wheel.rim_speed = Some(0.2); // m/s
    /// assert_eq!((wheel.load, wheel.slip), (60.0, None));
    /// ```
    #[must_use]
    pub const fn unknown(load: f64) -> Self {
        Self {
            slip: None,
            sigma: None,
            health: Health::Uninitialised,
            motion: None,
            forward_speed: None,
            rim_speed: None,
            torque_share: None,
            firmness: None,
            load,
        }
    }
}

/// The motion that is requested of the robot. Where a number that counts is NaN or infinite, or a heading beyond 10⁶ rad,
/// the robot stands, with a decision to say so.
///
/// ```
/// use grouser_slip::control::Request;
///
/// let to_the_north = Request { speed: 0.3, heading: 1.57, ..Request::default() }; // m/s, rad
/// let arc = Request { speed: 0.3, yaw_rate: Some(0.1), ..Request::default() }; // rad/s
/// assert_eq!((to_the_north.yaw_rate, arc.heading), (None, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Request {
    /// Forward speed, m/s; negative: backwards.
    pub speed: f64,
    /// Heading, rad.
    pub heading: f64,
    /// Yaw rate, to the left positive, rad/s; the robot then turns at it and `heading` does not count. `None`: it holds
    /// the heading.
    pub yaw_rate: Option<f64>,
}

impl Request {
    /// +1 where the robot is to drive forwards, −1 backwards.
    pub(crate) const fn direction(&self) -> f64 {
        if self.speed < 0.0 { -1.0 } else { 1.0 }
    }

    /// How many of the numbers that count are invalid.
    pub(super) fn invalid_numbers(&self) -> u8 {
        let is_turned = match self.yaw_rate {
            Some(rate) => rate.is_finite(),
            None => angle(Some(self.heading)).is_some(),
        };
        u8::from(!self.speed.is_finite()) + u8::from(!is_turned)
    }
}

/// What is known at one moment, and what is requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlInput<'a> {
    /// Now, ns on any clock.
    pub time_ns: i64,
    /// One per wheel, in the robot's order.
    pub wheels: &'a [WheelObservation],
    /// Forward speed of the robot by its reference, m/s.
    pub speed: Option<f64>,
    /// Heading, rad.
    pub heading: Option<f64>,
    /// Pitch, nose down positive, rad.
    pub pitch: Option<f64>,
    /// Roll, right side down positive, rad.
    pub roll: Option<f64>,
    /// The slip that soil and slope demand as far as they are known; ground that takes much more is another soil.
    pub slip_demand: Option<SlipPrior>,
    /// The requested motion.
    pub request: Request,
}

/// The robot as the supervisor sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RobotObservation {
    /// Slip of the powered wheels, weighted by load.
    pub(super) slip: Option<f64>,
    /// Its standard deviation: what measures the robot's speed is off for all wheels alike.
    pub(super) slip_sigma: f64,
    /// How much softer the ground is on the left than on the right: difference of slip and firmness, 1.
    pub(super) side_difference: f64,
    /// Firmness of the ground: the least under any powered wheel that the next softest confirms.
    pub(super) firmness: f64,
    /// What soil and slope demand.
    pub(super) slip_demand: Option<SlipPrior>,
    /// Forward speed, m/s.
    pub(super) speed: Option<f64>,
    /// Mean speed of the powered rims, m/s.
    pub(super) rim_speed: f64,
    /// rad.
    pub(super) heading: Option<f64>,
    /// rad.
    pub(super) pitch: Option<f64>,
    /// rad.
    pub(super) roll: Option<f64>,
    /// Finite.
    pub(super) request: Request,
    /// Are the speed and at least one powered wheel measured?
    pub(super) is_measured: bool,
}

impl RobotObservation {
    /// Speed in the requested direction, m/s: of a robot that drives backwards as requested it is positive too.
    pub(super) fn speed_ahead(&self) -> Option<f64> {
        self.speed.map(|speed| speed * self.request.direction())
    }
}

/// A mean weighted by load.
#[derive(Clone, Copy, Default)]
struct LoadMean {
    sum: f64,
    load: f64,
}

impl LoadMean {
    fn add(&mut self, load: f64, value: f64) {
        self.sum += load * value;
        self.load += load;
    }

    fn value(self) -> Option<f64> {
        (self.load > 0.0).then(|| self.sum / self.load)
    }
}

/// The wheels of one side.
#[derive(Clone, Copy)]
struct Side {
    slip: LoadMean,
    firmness: f64,
}

impl RobotObservation {
    /// Combines the wheels' observations.
    pub(super) fn new(input: &ControlInput<'_>, wheels: &[WheelController]) -> Self {
        let [mut slip, mut slip_sigma, mut rim_speed] = [LoadMean::default(); 3];
        let mut sides = [Side {
            slip: LoadMean::default(),
            firmness: 1.0,
        }; 2];
        // the softest and the next softest
        let mut softest = [1.0_f64; 2];
        let mut any_alive = false;
        for (wheel, own) in input.wheels.iter().zip(wheels) {
            if !own.is_powered() {
                continue;
            }
            let alive = !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised);
            any_alive |= alive;
            if wheel.health == Health::Invalid(Invalid::Dropout) {
                continue;
            }
            let load = finite(Some(wheel.load))
                .unwrap_or(0.0)
                .clamp(LOAD_LIMITS_N.0, LOAD_LIMITS_N.1);
            if let Some(rim) = finite(wheel.rim_speed) {
                rim_speed.add(load, rim.abs());
            }
            if wheel.motion == Some(Motion::LiftOff) || !alive {
                continue;
            }
            let [left, right] = &mut sides;
            let side = match own.geometry().y {
                y if y > 0.0 => Some(left),
                y if y < 0.0 => Some(right),
                _ => None,
            };
            // a wheel whose torque is cut takes little torque on any ground
            let firmness = finite(wheel.firmness).filter(|_| !own.is_shed());
            if let Some(firmness) = firmness {
                softest = [
                    softest[0].min(firmness),
                    softest[0].max(firmness).min(softest[1]),
                ];
            }
            let wheel_slip = finite(wheel.slip).map(|slip| slip.clamp(-1.0, 1.0));
            if let Some(wheel_slip) = wheel_slip {
                slip.add(load, wheel_slip);
                slip_sigma.add(load, finite(wheel.sigma).unwrap_or(0.0));
            }
            if let Some(side) = side {
                side.firmness = firmness.map_or(side.firmness, |firm| side.firmness.min(firm));
                if let Some(wheel_slip) = wheel_slip {
                    side.slip.add(load, wheel_slip);
                }
            }
        }
        let mean_rim_speed = rim_speed.value().unwrap_or(0.0);
        let all_turn = input.wheels.iter().zip(wheels).all(|(wheel, own)| {
            let turns = finite(wheel.rim_speed)
                .is_some_and(|rim| rim.abs() >= STANDING_RIM_SHARE * mean_rim_speed);
            !own.is_powered() || turns && !own.is_shed()
        });
        let speed = finite(input.speed);
        let [left, right] = sides;
        let slip_difference = match (left.slip.value(), right.slip.value()) {
            (Some(left), Some(right)) => left - right,
            _ => 0.0,
        };
        Self {
            slip: slip.value(),
            slip_sigma: slip_sigma.value().unwrap_or(0.0),
            side_difference: right.firmness - left.firmness + slip_difference,
            firmness: if all_turn {
                softest[0].max(softest[1] - FIRMNESS_AGREEMENT)
            } else {
                1.0
            },
            slip_demand: input
                .slip_demand
                .filter(|_| all_turn)
                .filter(|demand| demand.mean.is_finite() && demand.sigma.is_finite()),
            speed,
            rim_speed: mean_rim_speed,
            heading: angle(input.heading),
            pitch: angle(input.pitch),
            roll: angle(input.roll),
            request: if input.request.invalid_numbers() > 0 {
                Request::default()
            } else {
                Request {
                    speed: (input.request.speed).clamp(-MAX_SPEED_M_PER_S, MAX_SPEED_M_PER_S),
                    heading: angle(Some(input.request.heading)).unwrap_or(0.0),
                    ..input.request
                }
            },
            is_measured: any_alive && speed.is_some(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_has_its_limit() {
        let most = MAX_ANGLE_RAD;
        assert_eq!(
            [Some(most), Some(-most)].map(angle),
            [Some(most), Some(-most)]
        );
        let none = [
            Some(most.next_up()),
            Some(f64::NAN),
            Some(f64::NEG_INFINITY),
            None,
        ];
        assert_eq!(none.map(angle), [None; 4]);
    }
}
