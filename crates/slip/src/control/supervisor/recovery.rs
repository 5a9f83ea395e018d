//! Attempts to get past ground that does not carry the robot: how many, and on which side.

use grouser_real::{Real, wrap_angle};

use super::super::decision::{Action, Ending, Reason};
use super::super::observation::RobotObservation;
use super::super::settings::{ControlSettings, Decides};
use super::slip_monitor::SlipMonitor;
use super::soft_ground::SoftGroundMonitor;
use super::transition::{Next, Transition, View};

/// Left and right wheels' slips and firmnesses that differ by more than this tell on which side the ground is softer: half
/// of the band in which a slip counts as steady.
const SIDE_DIFFERENCE: f64 = 0.015;
/// Heading of a detour beside the requested one, what each further try adds, and its greatest value, rad: 69°, 17°, 120°.
const DETOUR_ANGLE_RAD: f64 = 1.2;
const DETOUR_ANGLE_STEP_RAD: f64 = 0.3;
const MAX_DETOUR_ANGLE_RAD: f64 = 2.1;
/// Soft ground is forgotten after this much progress, m: several lengths of the shipped robots.
const FORGET_DISTANCE_M: f64 = 4.0;
/// The robot counts as stuck after this multiple of the time that counts as digging.
const STUCK_TIME_FACTOR: f64 = 2.0;

/// What outlives the modes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recovery {
    /// Progress along the requested heading since the last attempt, m.
    progress: f64,
    attempts: u32,
    /// Side of the last traverse: +1 left, −1 right, 0 none yet.
    traverse_side: f64,
    /// Side of the detours about the present soft ground, likewise, as one looks in the direction of the drive.
    detour_side: f64,
    detours: u32,
}

impl Recovery {
    /// One step of a robot that drives ahead.
    pub(super) fn advance(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        step: f64,
    ) {
        let speed = robot.speed_ahead().unwrap_or(0.0);
        let ahead = robot.heading.map_or(1.0, |now| {
            Real::cos(wrap_angle(now - robot.request.heading))
        });
        self.progress += step * speed.max(0.0) * ahead;
        if self.progress > settings.progress {
            self.attempts = 0;
        }
        if self.progress > FORGET_DISTANCE_M {
            self.detours = 0;
            self.detour_side = 0.0;
        }
    }

    pub(super) const fn attempts(&self) -> u32 {
        self.attempts
    }

    /// Counts one more attempt; progress begins anew.
    pub(super) const fn begin_attempt(&mut self) {
        self.attempts += 1;
        self.progress = 0.0;
    }

    /// The side of the traverse that begins now: the other one than last time, if `switches`.
    pub(super) fn choose_traverse_side(&mut self, switches: bool) -> f64 {
        self.traverse_side = if self.traverse_side == 0.0 {
            1.0
        } else if switches {
            -self.traverse_side
        } else {
            self.traverse_side
        };
        self.traverse_side
    }

    /// Heading of a detour beside the requested one, rad: further away with every try.
    pub(super) fn detour_angle(&self) -> f64 {
        let further = DETOUR_ANGLE_STEP_RAD * f64::from(self.detours.max(1) - 1);
        self.detour_side * (DETOUR_ANGLE_RAD + further).min(MAX_DETOUR_ANGLE_RAD)
    }

    pub(super) const fn detour_side(&self) -> f64 {
        self.detour_side
    }

    /// How far the robot is to move aside, m: further with every try.
    pub(super) fn detour_width(&self, settings: &ControlSettings) -> f64 {
        settings.soft_across * (0.5 + 0.5 * f64::from(self.detours.max(1)))
    }

    /// One more detour; the side is the firmer one, as one looks in the `direction` of the drive (+1 forwards, −1 backwards).
    fn begin_detour(&mut self, soft_ground: &mut SoftGroundMonitor, direction: f64) {
        self.detours += 1;
        soft_ground.reset_timers();
        if self.detour_side == 0.0 {
            self.detour_side = if direction * soft_ground.side_difference() > SIDE_DIFFERENCE {
                -1.0
            } else {
                1.0
            };
        }
    }

    /// Softer ground than the known soil: back out before the wheels dig, and drive round it.
    pub(super) fn leave_soft_ground(
        &mut self,
        view: &View<'_>,
        slip: &mut SlipMonitor,
        soft_ground: &mut SoftGroundMonitor,
    ) -> Option<Transition> {
        let settings = view.settings;
        if !soft_ground.is_soft(settings) {
            return None;
        }
        let values = soft_ground.values(settings);
        self.begin_detour(soft_ground, view.robot.request.direction());
        if self.detours > settings.max_attempts && settings.decides == Decides::Everything {
            return Some(Transition::end(Ending::NoWay, Reason::SoftGround, values));
        }
        self.progress = 0.0;
        slip.forget_accepted();
        let back = soft_ground.take_back_length(settings);
        Some(Transition::to(
            Next::BackOut {
                detour_length: Some(back),
            },
            Action::BackOut,
            Reason::SoftGround,
            values,
        ))
    }

    /// Digging in or standing still: back out, if there are attempts left.
    pub(super) fn leave_standstill(
        &mut self,
        view: &View<'_>,
        slip: &SlipMonitor,
        soft_ground: &mut SoftGroundMonitor,
    ) -> Option<Transition> {
        let settings = view.settings;
        let stuck_time = STUCK_TIME_FACTOR * settings.dig_time;
        let (reason, values) = if slip.dig_time() >= settings.dig_time {
            (Reason::DiggingIn, (slip.slip(), settings.dig_slip))
        } else if slip.stuck_time() >= stuck_time {
            (Reason::NoProgress, (slip.stuck_time(), stuck_time))
        } else {
            return None;
        };
        if self.attempts >= settings.max_attempts && settings.decides == Decides::Everything {
            return Some(self.attempts_used(settings));
        }
        self.begin_attempt();
        let mut detour_length = None;
        // on the level the soil holds the robot
        if view.tilt < settings.steep {
            detour_length = Some(soft_ground.take_back_length(settings));
            self.begin_detour(soft_ground, view.robot.request.direction());
        }
        Some(Transition::to(
            Next::BackOut { detour_length },
            Action::BackOut,
            reason,
            values,
        ))
    }

    /// The end of a drive whose attempts are used.
    fn attempts_used(&self, settings: &ControlSettings) -> Transition {
        let values = (f64::from(self.attempts), f64::from(settings.max_attempts));
        Transition::end(Ending::Immobilised, Reason::AttemptsUsed, values)
    }
}
