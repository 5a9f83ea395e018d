//! The controller: supervisor, feedforward and a slip loop for each wheel.

use alloc::{boxed::Box, vec};

use super::command::{ControlOutput, WheelCommand};
use super::decision::{Action, Decision, Mode, Reason};
use super::decision_queue::DecisionQueue;
use super::feedforward::Feedforward;
use super::finite;
use super::observation::{ControlInput, RobotObservation};
use super::sensor_watchdog::SensorWatchdog;
use super::settings::ControlSettings;
use super::supervisor::Supervisor;
use super::wheel_controller::WheelController;
use crate::error::Result;
use crate::robot::Robot;

/// A slip controller for one robot.
///
/// [`Controller::step`] takes what is known and gives a command for every wheel. It never panics, allocates or
/// reads a clock, and its cost is bounded by the number of wheels. Numbers that are NaN or infinite count as
/// not measured.
///
/// ```
/// use grouser_slip::control::{
///     ControlInput, ControlSettings, Controller, Mode, Request, WheelObservation,
/// };
/// use grouser_slip::{Health, Motion, Robot, Wheel};
///
/// let wheel = Wheel::powered("drive").radius(0.1).ticks_per_turn(1000).load(50.0);
/// let robot = Robot::new("one wheel".into(), vec![wheel])?;
/// let mut settings = ControlSettings::default();
/// settings.optimum = 0.25;
/// let mut controller = Controller::new(&robot, settings)?;
/// let mut rim_speed = 0.0;
/// for step in 0..500_i64 {
///     // sand in which the wheel travels at half its rim's speed
///     let wheels = [WheelObservation {
///         slip: Some(0.5), sigma: Some(0.02), health: Health::Ok, motion: Some(Motion::Driving),
///         forward_speed: Some(0.1), rim_speed: Some(rim_speed), torque_share: Some(0.3),
///         ..WheelObservation::unknown(50.0)
///     }];
///     let output = controller.step(&ControlInput {
///         time_ns: step * 10_000_000, wheels: &wheels, speed: Some(0.1), heading: Some(0.0),
///         pitch: Some(0.0), roll: Some(0.0), slip_demand: None,
///         request: Request { speed: 0.3, ..Request::default() },
///     });
///     rim_speed = output.commands[0].rim_speed;
///     assert_eq!(output.mode, Mode::Forward);
/// }
/// // the slip stays above the optimum whatever the rim does: it runs slower than requested
/// assert!(rim_speed < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Controller {
    settings: ControlSettings,
    wheels: Box<[WheelController]>,
    commands: Box<[WheelCommand]>,
    supervisor: Supervisor,
    feedforward: Feedforward,
    watchdog: SensorWatchdog,
    decisions: DecisionQueue,
    /// Were all numbers of the last request such that the robot can drive by them?
    had_valid_request: bool,
}

impl Controller {
    /// A controller for `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: ControlSettings) -> Result<Self> {
        settings.check()?;
        let wheels = robot.wheels();
        Ok(Self {
            settings,
            commands: vec![WheelCommand::default(); wheels.len()].into_boxed_slice(),
            wheels: wheels.iter().map(WheelController::new).collect(),
            supervisor: Supervisor::new(),
            feedforward: Feedforward::default(),
            watchdog: SensorWatchdog::default(),
            decisions: DecisionQueue::default(),
            had_valid_request: true,
        })
    }

    /// The same controller for a robot whose wheels steer by up to `angles` (rad either way, in the robot's order;
    /// 0 or missing: not at all). It then drives arcs in place of turning on the spot.
    #[must_use]
    pub fn with_steering(mut self, angles: &[f64]) -> Self {
        for (wheel, angle) in self.wheels.iter_mut().zip(angles) {
            let angle = finite(Some(*angle)).unwrap_or(0.0);
            wheel.set_max_steering_angle(angle.clamp(0.0, core::f64::consts::FRAC_PI_2));
        }
        let curvatures = self
            .wheels
            .iter()
            .map(|wheel| wheel.geometry().max_curvature());
        let sharpest = curvatures.flatten().fold(f64::INFINITY, f64::min);
        self.supervisor.set_max_curvature(sharpest);
        self
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
    ///
    /// ```
    /// use grouser_slip::control::{ControlSettings, Controller};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let mut controller = Controller::new(&robot, ControlSettings::default())?;
    /// controller.set_optimum(0.3)?;
    /// assert!(controller.set_optimum(0.0).is_err());
    /// assert_eq!(controller.settings().optimum, 0.3);
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn set_optimum(&mut self, optimum: f64) -> Result<()> {
        let settings = ControlSettings {
            optimum,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        Ok(())
    }

    /// What the robot does now.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.supervisor.mode()
    }

    /// The commands of the last step; wheels at rest before the first.
    #[must_use]
    pub const fn commands(&self) -> &[WheelCommand] {
        &self.commands
    }

    /// Takes what is known and gives a command for every wheel, and the decision that was taken, if any. Of
    /// several decisions in one step the next step gives the next one.
    pub fn step(&mut self, input: &ControlInput<'_>) -> ControlOutput<'_> {
        let step = self.watchdog.step(input.time_ns);
        let mut robot = RobotObservation::new(input, &self.wheels);
        self.supervisor.set_requested_heading(&mut robot);
        self.report_request(input.request.invalid_numbers());
        let silence = self.watchdog.update(robot.is_measured, step);
        self.supervisor
            .update(&self.settings, &robot, silence, step, &mut self.decisions);
        let motion = self.supervisor.motion(&self.settings, &robot);
        let step = if motion.stopped {
            self.watchdog.ramp_step(step)
        } else {
            step
        };
        self.feedforward
            .update(&self.settings, &motion, robot.slip, step);
        for (index, (wheel, command)) in self.wheels.iter_mut().zip(&mut self.commands).enumerate()
        {
            *command = if let Some(observation) = input.wheels.get(index) {
                let setpoint = (&motion, self.feedforward.share());
                let decisions = (index, &mut self.decisions);
                wheel.command(&self.settings, observation, setpoint, step, decisions)
            } else {
                wheel.rest()
            };
        }
        ControlOutput {
            commands: &self.commands,
            mode: self.supervisor.mode(),
            heading: motion.heading,
            slip: self.supervisor.slip(),
            decision: self.decisions.pop(input.time_ns),
        }
    }

    /// Reports that a request cannot be driven by, once.
    fn report_request(&mut self, invalid: u8) {
        let is_valid = invalid == 0;
        if !is_valid && self.had_valid_request && self.mode() != Mode::Stopped {
            let values = (f64::from(invalid), 0.0);
            let decision = Decision::of_robot(Action::Stand, Reason::InvalidRequest, values);
            self.decisions.push(decision);
        }
        self.had_valid_request = is_valid;
    }
}
