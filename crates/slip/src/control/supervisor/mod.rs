//! The supervisor: which mode the robot is in, and the setpoints of the robot as a whole that follow from it.
//!
//! Each mode is a file with its own state. What outlives a mode is in the monitors (slip, tilt, soft ground) and in
//! [`Recovery`] (attempts and sides).

mod back_out;
mod detour;
mod forward;
mod recovery;
mod slip_monitor;
mod soft_ground;
mod tilt_monitor;
mod transition;
mod traverse;
mod turn;

use grouser_real::{Real, wrap_angle};

use super::command::MotionCommand;
use super::decision::{Ending, Mode, Reason};
use super::decision_queue::DecisionQueue;
use super::observation::RobotObservation;
use super::settings::{ControlSettings, Decides};
use back_out::BackOut;
use detour::Detour;
use recovery::Recovery;
use slip_monitor::{MAX_ACCEPTED_SLIP, SLIP_ROOM, SLIP_TIME_CONSTANT_S, SlipMonitor};
use soft_ground::SoftGroundMonitor;
use tilt_monitor::TiltMonitor;
use transition::{Next, Transition, View};
use traverse::Traverse;
use turn::{ON_COURSE_RAD, Turn};

/// The robot turns rather than travels far off its heading: at least this share of the speed is left.
const MIN_TURNING_SPEED_SHARE: f64 = 0.2;

/// The mode with its state.
#[derive(Clone, Copy, Debug)]
enum ModeState {
    Forward,
    Traverse(Traverse),
    BackOut(BackOut),
    Detour(Detour),
    Stopped,
}

/// Time and travel since the mode began.
#[derive(Clone, Copy, Debug, Default)]
struct ModeClock {
    time: f64,
    travel: f64,
}

/// Mode and monitors of the robot.
#[derive(Clone, Debug)]
pub(super) struct Supervisor {
    /// Curvature of the sharpest arc, 1/m; infinite for a robot that turns on the spot.
    max_curvature: f64,
    mode: ModeState,
    clock: ModeClock,
    slip: SlipMonitor,
    tilt: TiltMonitor,
    soft_ground: SoftGroundMonitor,
    recovery: Recovery,
    turn: Turn,
    last_heading: f64,
    /// Where the robot headed when it last drove ahead, rad: the requested heading where a yaw rate is requested.
    course: f64,
}

impl Supervisor {
    pub(super) fn new() -> Self {
        Self {
            max_curvature: f64::INFINITY,
            mode: ModeState::Forward,
            clock: ModeClock::default(),
            slip: SlipMonitor::default(),
            tilt: TiltMonitor::default(),
            soft_ground: SoftGroundMonitor::default(),
            recovery: Recovery::default(),
            turn: Turn::default(),
            last_heading: 0.0,
            course: 0.0,
        }
    }

    /// Where a yaw rate is requested, the requested heading is the one that the robot has while it drives ahead.
    pub(super) fn set_requested_heading(&mut self, robot: &mut RobotObservation) {
        if robot.request.yaw_rate.is_none() {
            return;
        }
        if matches!(self.mode, ModeState::Forward) {
            self.course = robot.heading.unwrap_or(self.course);
        }
        robot.request.heading = self.course;
    }

    /// The robot drives arcs of at most this curvature (1/m) in place of turning on the spot.
    pub(super) const fn set_max_curvature(&mut self, curvature: f64) {
        self.max_curvature = curvature;
    }

    pub(super) const fn mode(&self) -> Mode {
        match self.mode {
            ModeState::Forward => Mode::Forward,
            ModeState::Traverse(_) => Mode::Traverse,
            ModeState::BackOut(_) => Mode::BackOut,
            ModeState::Detour(_) => Mode::Detour,
            ModeState::Stopped => Mode::Stopped,
        }
    }

    /// Slip of the powered wheels, smoothed over a second.
    pub(super) const fn slip(&self) -> f64 {
        self.slip.slip()
    }

    /// Updates the monitors and decides. `silence` is the time without usable slip or speed, s.
    pub(super) fn update(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        silence: f64,
        step: f64,
        decisions: &mut DecisionQueue,
    ) {
        if matches!(self.mode, ModeState::Stopped) {
            return;
        }
        self.monitor(settings, robot, step);
        if settings.decides == Decides::Nothing {
            return;
        }
        if let Some(end) = self.safety_stop(settings, silence) {
            self.apply(end, decisions);
            return;
        }
        if settings.decides == Decides::Stops {
            return;
        }
        if !matches!(self.mode, ModeState::BackOut(_))
            && let Some(decision) = self.slip.accept(settings)
        {
            decisions.push(decision);
        }
        if let Some(transition) = self.decide(settings, robot, step) {
            self.apply(transition, decisions);
        }
    }

    fn monitor(&mut self, settings: &ControlSettings, robot: &RobotObservation, step: f64) {
        self.slip.filter(robot.slip, step);
        self.tilt.update(settings, robot, step);
        let ahead = robot.speed_ahead().unwrap_or(0.0);
        let heading_error = self.heading_error(robot);
        self.clock.time += step;
        self.clock.travel += match self.mode {
            ModeState::BackOut(_) => -step * ahead,
            ModeState::Forward
            | ModeState::Traverse(_)
            | ModeState::Detour(_)
            | ModeState::Stopped => step * ahead.abs(),
        };
        let on_course = heading_error.abs() < ON_COURSE_RAD;
        self.turn.update(heading_error, step);
        match &mut self.mode {
            ModeState::BackOut(mode) => mode.monitor(settings, robot, step),
            ModeState::Traverse(mode) => mode.monitor(on_course, step),
            ModeState::Forward | ModeState::Detour(_) | ModeState::Stopped => {}
        }
        // A robot that turns on the spot, or of which nothing is requested, shows nothing of the ground ahead.
        let is_driving = robot.request.speed != 0.0
            && !self.turns_by_slip()
            && self.clock.time >= SLIP_TIME_CONSTANT_S;
        let is_backing_out = matches!(self.mode, ModeState::BackOut(_));
        let is_level = self.tilt.greatest() < settings.steep;
        self.soft_ground.update(
            settings,
            robot,
            (is_driving && is_level, is_backing_out),
            step,
        );
        if !is_driving {
            self.slip.reset_timers();
            self.slip.reset_steady();
            return;
        }
        self.slip
            .update_timers(settings, robot, self.tilt.tilt() < settings.steep, step);
        if !is_backing_out {
            self.recovery.advance(settings, robot, step);
        }
    }

    fn safety_stop(&self, settings: &ControlSettings, silence: f64) -> Option<Transition> {
        if self.tilt.is_exceeded() {
            let values = (self.tilt.now(), settings.max_tilt);
            return Some(Transition::end(Ending::Tipping, Reason::TiltHigh, values));
        }
        (silence > settings.blind_time).then(|| {
            let values = (silence, settings.blind_time);
            Transition::end(Ending::SensorsLost, Reason::SensorTimeout, values)
        })
    }

    fn decide(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        step: f64,
    ) -> Option<Transition> {
        let view = View {
            settings,
            robot,
            tilt: self.tilt.tilt(),
            time: self.clock.time,
            travel: self.clock.travel,
            step,
        };
        let (slip, soft, recovery) = (&mut self.slip, &mut self.soft_ground, &mut self.recovery);
        if let ModeState::BackOut(mode) = &self.mode {
            return mode.decide(&view, recovery);
        }
        // in every mode that goes ahead soft ground comes first
        if let Some(transition) = recovery.leave_soft_ground(&view, slip, soft) {
            return Some(transition);
        }
        if matches!(self.mode, ModeState::Forward)
            && settings.decides == Decides::Everything
            && let Some(transition) = forward::turn_aside(&view, slip, recovery)
        {
            return Some(transition);
        }
        if let Some(transition) = recovery.leave_standstill(&view, slip, soft) {
            return Some(transition);
        }
        match &mut self.mode {
            ModeState::Traverse(mode) => mode.decide(&view, slip, recovery),
            ModeState::Detour(mode) => mode.decide(&view, recovery),
            ModeState::Forward | ModeState::BackOut(_) | ModeState::Stopped => None,
        }
    }

    fn apply(&mut self, transition: Transition, decisions: &mut DecisionQueue) {
        if let Some(next) = transition.next {
            self.mode = match next {
                Next::Forward => ModeState::Forward,
                Next::Traverse { side, angle } => ModeState::Traverse(Traverse::new(side, angle)),
                Next::BackOut { detour_length } => {
                    ModeState::BackOut(BackOut::new(self.last_heading, detour_length))
                }
                Next::Detour => ModeState::Detour(Detour::default()),
                Next::Stopped => ModeState::Stopped,
            };
            self.clock = ModeClock::default();
            self.slip.reset_timers();
            self.soft_ground.reset_rolling();
        }
        decisions.push(transition.decision);
    }

    /// Does it turn by the speeds of its rims? A robot that steers travels while it turns.
    const fn turns_by_slip(&self) -> bool {
        self.turn.is_on() && !self.max_curvature.is_finite()
    }

    /// Setpoint of the heading, rad.
    fn heading(&self, robot: &RobotObservation) -> f64 {
        let requested = robot.request.heading;
        match &self.mode {
            ModeState::Traverse(mode) => wrap_angle(requested + mode.angle()),
            ModeState::BackOut(mode) => mode.heading(),
            ModeState::Detour(_) => wrap_angle(requested + self.recovery.detour_angle()),
            ModeState::Forward | ModeState::Stopped => requested,
        }
    }

    /// Setpoint less measured heading, rad; 0 where the heading is not measured.
    fn heading_error(&self, robot: &RobotObservation) -> f64 {
        robot
            .heading
            .map_or(0.0, |now| wrap_angle(self.heading(robot) - now))
    }

    /// The slip that a slope of the known soil needs, with some room: less would only cost time.
    fn needed_slip(&self, robot: &RobotObservation) -> f64 {
        match robot.slip_demand {
            Some(demand) if !matches!(self.mode, ModeState::BackOut(_)) => {
                (demand.mean + SLIP_ROOM).clamp(0.0, MAX_ACCEPTED_SLIP)
            }
            _ => 0.0,
        }
    }

    /// The robot's setpoints in its mode.
    pub(super) fn motion(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
    ) -> MotionCommand {
        let heading = self.heading(robot);
        let requested = robot.request.speed;
        let (backward_speed, pushed_slip) = match &self.mode {
            ModeState::Stopped => {
                return MotionCommand {
                    speed: 0.0,
                    yaw_rate: 0.0,
                    heading,
                    limits_slip: false,
                    stopped: true,
                    slip: settings.optimum,
                    min_speed_share: 0.0,
                };
            }
            ModeState::BackOut(mode) => {
                (Some(-settings.back_speed * requested), mode.pushed_slip())
            }
            ModeState::Forward | ModeState::Traverse(_) | ModeState::Detour(_) => (None, 0.0),
        };
        if backward_speed.is_none() {
            self.last_heading = robot.heading.unwrap_or(robot.request.heading);
        }
        let error = self.heading_error(robot);
        let max_rate = settings.max_turn;
        let requested_rate = match self.mode {
            ModeState::Forward => robot.request.yaw_rate.unwrap_or(0.0),
            ModeState::Traverse(_)
            | ModeState::BackOut(_)
            | ModeState::Detour(_)
            | ModeState::Stopped => 0.0,
        };
        let yaw_rate = (requested_rate + settings.turn_gain * error).clamp(-max_rate, max_rate);
        let (speed, yaw_rate) = if self.max_curvature.is_finite() {
            // a robot that steers turns as it travels
            let speed = backward_speed.unwrap_or(requested);
            let max_rate = speed.abs() * self.max_curvature;
            (speed, yaw_rate.clamp(-max_rate, max_rate))
        } else {
            let ahead = if error.abs() < ON_COURSE_RAD {
                1.0
            } else {
                (Real::cos(error) - 0.5).clamp(MIN_TURNING_SPEED_SHARE, 1.0)
            };
            (backward_speed.unwrap_or(ahead * requested), yaw_rate)
        };
        let turns_on_the_spot = requested == 0.0;
        let idle = turns_on_the_spot && requested_rate == 0.0;
        let gentle = self.tilt.tilt() < settings.steep || backward_speed.is_some();
        MotionCommand {
            speed,
            yaw_rate: if idle { 0.0 } else { yaw_rate },
            heading,
            limits_slip: !self.turns_by_slip() && !turns_on_the_spot,
            stopped: false,
            slip: settings
                .optimum
                .max(self.slip.accepted())
                .max(self.needed_slip(robot))
                + pushed_slip,
            min_speed_share: if gentle {
                settings.crawl
            } else {
                settings.creep
            },
        }
    }
}
