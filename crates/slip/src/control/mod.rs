//! The slip controller: what the robot does with what it knows of its slip.
//!
//! After fig. 11 of \[Ani2012\]: the slip that the estimator gives is compared with the optimum; torque is raised or
//! reduced wheel by wheel; where that does not help the robot changes its direction or ends the drive. Each
//! [`Decision`] comes with its reason.
//!
//! ```text
//! rim_i = min( v_i* (1 + x),  v̂_i/(1 − s_i*) )      s_i* = s_opt + k_p e_i + k_i ∫ e_i dt,   e_i = s_opt − ŝ_i
//! ```
//!
//! with v_i* the speed that the drive asks of wheel i, x the cruise control's share, v̂_i and ŝ_i as estimated. The
//! motor driver turns the rim's speed into torque, up to a limit that shares the traction by load: a rim that
//! is told to run slower pulls with less torque.

mod decision;
mod detour;
mod helm;
mod input;
mod settings;
mod wheel_loop;

pub use decision::{Action, Decision, Ending, Mode, Reason};
pub use input::{ControlInput, ControlOutput, WheelOrder, WheelSeen};
pub use settings::ControlSettings;

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;

use crate::error::Result;
use crate::robot::{Robot, WheelRole};
use crate::state::{Health, Invalid, Motion};
use decision::Pending;
use helm::{Course, Helm, Seen};
use wheel_loop::WheelLoop;

/// Angle in (−π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = Real::sin_cos(angle);
    Real::atan2(sin, cos)
}

/// A wheel slower than this share of the mean rim speed stands.
const TURNS: f64 = 0.2;
/// Soft ground under one wheel counts where the next softest is no firmer than this beyond it.
const DENIES: f64 = 0.15;

/// Where a wheel stands, and how far it steers.
#[derive(Clone, Copy, Debug)]
struct WheelPlace {
    x: f64,
    y: f64,
    heading: f64,
    steer_range: f64,
}

impl WheelPlace {
    /// Steering angle and speed along the wheel's heading for a robot that travels at `speed` and turns at `turn`:
    /// the wheel's centre moves by (v − Ω y, Ω x).
    fn order(&self, speed: f64, turn: f64) -> (f64, f64) {
        let (v_x, v_y) = (speed - turn * self.y, turn * self.x);
        let mut steer = 0.0;
        if self.steer_range > 0.0 && (v_x != 0.0 || v_y != 0.0) {
            let sense = if speed < 0.0 { -1.0 } else { 1.0 };
            let wanted = wrapped(Real::atan2(sense * v_y, sense * v_x) - self.heading);
            steer = wanted.clamp(-self.steer_range, self.steer_range);
        }
        let (sin, cos) = Real::sin_cos(self.heading + steer);
        (steer, cos * v_x + sin * v_y)
    }
}

/// A slip controller for one robot.
///
/// [`Controller::step`] takes what is known and gives what every motor is to do. It never panics, allocates or
/// reads a clock, and its cost is bounded by the number of wheels. Numbers that are NaN or infinite count as
/// not measured.
///
/// ```
/// use grouser_slip::control::{ControlInput, ControlSettings, Controller, Mode, WheelSeen};
/// use grouser_slip::{Health, Motion, Robot, Wheel};
///
/// let wheel = Wheel::powered("drive").radius(0.1).ticks_per_turn(1000).load(50.0);
/// let robot = Robot::new("one wheel".into(), vec![wheel])?;
/// let settings = ControlSettings { optimum: 0.25, ..ControlSettings::default() };
/// let mut controller = Controller::new(&robot, settings)?;
/// let mut rim = 0.0;
/// for step in 0..500_i64 {
///     // sand in which the wheel travels at half its rim's speed
///     let seen = [WheelSeen {
///         slip: Some(0.5), sigma: Some(0.02), health: Health::Ok, motion: Some(Motion::Driving),
///         forward_speed: Some(0.1), rim_speed: Some(rim), torque_share: Some(0.3), firmness: None,
///         load: 50.0,
///     }];
///     let output = controller.step(&ControlInput {
///         time_ns: step * 10_000_000, wheels: &seen, speed: Some(0.1), heading: Some(0.0),
///         pitch: Some(0.0), roll: Some(0.0), demanded: None, asked_speed: 0.3, asked_heading: 0.0,
///     });
///     rim = output.orders[0].rim_speed;
///     assert_eq!(output.mode, Mode::Forward);
/// }
/// // the slip stays above the optimum whatever it does: the rim runs slower than asked
/// assert!(rim < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Controller {
    settings: ControlSettings,
    wheels: Box<[WheelLoop]>,
    places: Box<[WheelPlace]>,
    orders: Box<[WheelOrder]>,
    helm: Helm,
    /// Share by which rims run faster than the robot is to travel.
    cruise: f64,
    last_ns: Option<i64>,
    /// Seconds without any usable slip, and of calls that were late.
    blind: f64,
    pending: Pending,
}

impl Controller {
    /// A controller for `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: ControlSettings) -> Result<Self> {
        settings.check()?;
        let wheels: Vec<WheelLoop> = robot
            .wheels()
            .iter()
            .map(|wheel| WheelLoop::new(wheel.role == WheelRole::Powered))
            .collect();
        let places: Vec<WheelPlace> = robot
            .wheels()
            .iter()
            .map(|wheel| WheelPlace {
                x: wheel.x,
                y: wheel.y,
                heading: wheel.heading.rad(),
                steer_range: 0.0,
            })
            .collect();
        let orders: Vec<WheelOrder> = wheels.iter().map(|_| WheelOrder::default()).collect();
        Ok(Self {
            settings,
            orders: orders.into_boxed_slice(),
            wheels: wheels.into_boxed_slice(),
            places: places.into_boxed_slice(),
            helm: Helm::default(),
            cruise: 0.0,
            last_ns: None,
            blind: 0.0,
            pending: Pending::default(),
        })
    }

    /// The same controller for a robot whose wheels steer by up to `ranges` (rad either way, in the robot's order;
    /// 0 or missing: not at all). It then drives arcs in place of turning on the spot.
    #[must_use]
    pub fn steered(mut self, ranges: &[f64]) -> Self {
        for (place, range) in self.places.iter_mut().zip(ranges) {
            place.steer_range = finite(Some(*range))
                .unwrap_or(0.0)
                .clamp(0.0, core::f64::consts::FRAC_PI_2);
        }
        self.helm.sharpest = self.sharpest();
        self
    }

    /// Turning rate per speed in the sharpest arc that the steered wheels can drive; infinite without any.
    fn sharpest(&self) -> f64 {
        let steered = self.places.iter().filter(|place| place.steer_range > 0.0);
        steered
            .map(|place| Real::tan(place.steer_range) / (place.x.abs() + place.y.abs()).max(1e-3))
            .fold(f64::INFINITY, f64::min)
    }

    /// The settings that it works by.
    #[must_use]
    pub const fn settings(&self) -> &ControlSettings {
        &self.settings
    }

    /// Another optimum, where soil or slope have changed.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) outside [0.01, 0.95].
    pub fn set_optimum(&mut self, optimum: f64) -> Result<()> {
        let settings = ControlSettings {
            optimum,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        Ok(())
    }

    /// What it does now.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.helm.mode()
    }

    /// Takes what is known and gives an order for every wheel, and the decision that was taken, if any. Of
    /// several decisions in one step the next step gives the next one.
    pub fn step(&mut self, input: &ControlInput<'_>) -> ControlOutput<'_> {
        let step = self.time_step(input.time_ns);
        let seen = self.look(input, step);
        self.helm
            .steer(&self.settings, &seen, step, &mut self.pending);
        let course = self.helm.course(&self.settings, &seen);
        self.order(input, &course, seen.slip, step);
        ControlOutput {
            orders: &self.orders,
            mode: self.helm.mode(),
            heading: course.heading,
            slip: self.helm.slip(),
            decision: self.pending.take(input.time_ns),
        }
    }

    /// Seconds since the last step, held in [0, 0.1]; what is beyond counts as blindness.
    fn time_step(&mut self, now_ns: i64) -> f64 {
        let passed = self
            .last_ns
            .map_or(0.0, |last| now_ns.saturating_sub(last) as f64 * 1e-9);
        self.last_ns = Some(now_ns);
        if !(passed >= 0.0) {
            return 0.0;
        }
        if passed > 0.1 {
            self.blind += passed - 0.1;
        }
        passed.min(0.1)
    }

    /// What the wheels and the attitude say of the robot as a whole.
    fn look(&mut self, input: &ControlInput<'_>, step: f64) -> Seen {
        let (mut sum, mut weight, mut measured) = (0.0, 0.0, false);
        let (mut left, mut right) = ([0.0; 2], [0.0; 2]);
        let (mut firm_left, mut firm_right) = (1.0_f64, 1.0_f64);
        let mut least = [1.0_f64; 2];
        let mut rims = (0.0, 0.0);
        for ((wheel, own), place) in input.wheels.iter().zip(&self.wheels).zip(&self.places) {
            if !own.powered {
                continue;
            }
            let alive = !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised);
            measured |= alive;
            if wheel.health == Health::Invalid(Invalid::Dropout) {
                continue;
            }
            // no robot weighs more; what says so is no load
            let load = finite(Some(wheel.load)).unwrap_or(0.0).clamp(1e-3, 1e9);
            if let Some(rim) = finite(wheel.rim_speed) {
                rims.0 += load * rim.abs();
                rims.1 += load;
            }
            if wheel.motion == Some(Motion::LiftOff) || !alive {
                continue;
            }
            // a wheel that may not pull takes little torque on any ground
            if let Some(firmness) = finite(wheel.firmness).filter(|_| !own.is_shed()) {
                least = [least[0].min(firmness), least[0].max(firmness).min(least[1])];
                if place.y > 0.0 {
                    firm_left = firm_left.min(firmness);
                } else if place.y < 0.0 {
                    firm_right = firm_right.min(firmness);
                }
            }
            if let Some(slip) = finite(wheel.slip) {
                sum += load * slip.clamp(-1.0, 1.0);
                weight += load;
                let side = if place.y > 0.0 { &mut left } else { &mut right };
                if place.y != 0.0 {
                    side[0] += load * slip.clamp(-1.0, 1.0);
                    side[1] += load;
                }
            }
        }
        // with a wheel that stands or is not measured the others slip more on any ground
        let mean = if rims.1 > 0.0 { rims.0 / rims.1 } else { 0.0 };
        let all_turn = input.wheels.iter().zip(&self.wheels).all(|(wheel, own)| {
            let turns = finite(wheel.rim_speed).is_some_and(|rim| rim.abs() >= TURNS * mean);
            !own.powered || turns && !own.is_shed()
        });
        let speed = finite(input.speed);
        if measured && speed.is_some() {
            self.blind = 0.0;
        } else {
            self.blind += step;
        }
        Seen {
            slip: (weight > 0.0).then(|| sum / weight),
            lean: firm_right - firm_left
                + if left[1] > 0.0 && right[1] > 0.0 {
                    left[0] / left[1] - right[0] / right[1]
                } else {
                    0.0
                },
            // one wheel alone may be wrong
            firmness: if all_turn {
                least[0].max(least[1] - DENIES)
            } else {
                1.0
            },
            demanded: input
                .demanded
                .filter(|_| all_turn)
                .filter(|demanded| demanded.mean.is_finite() && demanded.sigma.is_finite()),
            speed,
            rim: mean,
            heading: finite(input.heading),
            pitch: finite(input.pitch),
            roll: finite(input.roll),
            asked_speed: finite(Some(input.asked_speed)).unwrap_or(0.0),
            asked_heading: finite(Some(input.asked_heading)).unwrap_or(0.0),
            blind: self.blind,
        }
    }

    /// Rim speeds and torque limits for the course.
    fn order(&mut self, input: &ControlInput<'_>, course: &Course, slip: Option<f64>, step: f64) {
        self.run_cruise(course, slip, step);
        let settings = &self.settings;
        for (index, own) in self.wheels.iter_mut().enumerate() {
            let Some(seen) = input.wheels.get(index) else {
                self.orders[index] = WheelOrder::default();
                continue;
            };
            let (steer, asked) = self.places[index].order(course.speed, course.turn);
            let order = own.order(
                settings,
                seen,
                &wheel_loop::Asked {
                    speed: asked,
                    cruise: self.cruise,
                    slip_matters: course.slip_matters,
                    stopped: course.stopped,
                    target: course.target,
                    creep: course.creep,
                },
                step,
                (index, &mut self.pending),
            );
            self.orders[index] = WheelOrder { steer, ..order };
        }
    }

    /// The cruise control: rims run faster by the share x = s/(1 − s) that the slip takes, so that the robot travels as
    /// asked. No integral: one that was wound up on a climb would let the robot race down behind it.
    fn run_cruise(&mut self, course: &Course, slip: Option<f64>, step: f64) {
        let settings = &self.settings;
        let wanted = if course.stopped || course.speed == 0.0 || !course.slip_matters {
            0.0
        } else if let Some(slip) = slip {
            let most = settings.most_cruise / (1.0 + settings.most_cruise);
            let slip = slip.clamp(0.0, most);
            slip / (1.0 - slip)
        } else {
            return;
        };
        let share = (step * settings.cruise_gain).min(1.0);
        self.cruise =
            (self.cruise + share * (wanted - self.cruise)).clamp(0.0, settings.most_cruise);
    }
}

/// A number that is one.
pub(crate) fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}
