//! Decisions of the controller, each with its reason.

use core::fmt;

/// Declares the modes: the enum, the list of all, and their names.
macro_rules! modes {
    ($($(#[$attribute:meta])+ $mode:ident,)+) => {
        /// What the robot does.
        ///
        /// ```
        /// assert_eq!(grouser_slip::control::Mode::Forward.name(), "Forward");
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Mode {
            $($(#[$attribute])+ $mode,)+
        }

        impl Mode {
            /// Every mode.
            pub const ALL: &[Self] = &[$(Self::$mode),+];

            /// Its name in tables and files.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$mode => stringify!($mode),)+ }
            }
        }
    };
}

modes! {
    /// It drives as requested.
    #[default]
    Forward,
    /// It crosses a slope at an angle.
    Traverse,
    /// It drives back the way it came.
    BackOut,
    /// It drives round soft ground.
    Detour,
    /// The drive has ended.
    Stopped,
}

/// Why a drive ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Ending {
    /// The wheels turn and the robot does not advance.
    Immobilised,
    /// It leans too far.
    Tipping,
    /// Its sensors are silent.
    SensorsLost,
    /// No way on was found; the robot stands on ground that carries it.
    NoWay,
}

/// What was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Action {
    /// A wheel's torque is reduced until its slip is the setpoint.
    ReduceTorque,
    /// And raised again.
    RaiseTorque,
    /// Slip above the optimum is accepted: torque is raised.
    AcceptSlip,
    /// A wheel's torque is cut to a tenth.
    ShedTorque,
    /// Cross the slope at an angle.
    Traverse,
    /// Cross it towards the other side.
    SwitchSide,
    /// Drive back.
    BackOut,
    /// Drive round soft ground.
    Detour,
    /// Drive on as requested.
    Resume,
    /// Stand until there is a request to drive by.
    Stand,
    /// End the drive.
    End(Ending),
}

/// Why.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Reason {
    /// Slip is above its setpoint or the given limit.
    SlipHigh,
    /// The slip is unknown, and the rim is limited to what the wheel's speed over the ground allows.
    SlipUnknown,
    /// Slip is back at its setpoint.
    SlipRegained,
    /// The slip is steady: slope and soil demand it, and a slower rim does not lower it.
    Demanded,
    /// The ground takes much more slip, or less torque, than the known soil would: it is softer.
    SoftGround,
    /// The robot has moved far enough aside.
    ClearedSoftGround,
    /// The wheels dig in.
    DiggingIn,
    /// The robot does not advance although its rims run.
    NoProgress,
    /// The slope is gentle again.
    SlopeGentle,
    /// A leg of the traverse is completed.
    LegCompleted,
    /// It has backed out far enough.
    BackedOut,
    /// The allowed number of attempts is used.
    AttemptsUsed,
    /// It leans more than it may.
    TiltHigh,
    /// No usable slip or speed for too long.
    SensorTimeout,
    /// A motor pushes and its wheel does not turn.
    Stall,
    /// A wheel turns against its command: its encoder counts the wrong way.
    EncoderReversed,
    /// Numbers of the request are NaN, infinite, or a heading beyond all headings.
    InvalidRequest,
}

/// A decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// When, ns.
    pub time_ns: i64,
    /// What.
    pub action: Action,
    /// Why.
    pub reason: Reason,
    /// The wheel that it is about; `None`: the robot.
    pub wheel: Option<usize>,
    /// The quantity that the reason is about: a slip, a share, an angle in rad, a way in m, a speed in m/s, a time in s
    /// or a number of things.
    pub value: f64,
    /// The limit that it passed.
    pub limit: f64,
}

impl Decision {
    /// A decision about the robot; its time is set when it is reported.
    pub(super) const fn of_robot(
        action: Action,
        reason: Reason,
        (value, limit): (f64, f64),
    ) -> Self {
        Self {
            time_ns: 0,
            action,
            reason,
            wheel: None,
            value,
            limit,
        }
    }

    /// A decision about one wheel.
    pub(super) const fn of_wheel(
        wheel: usize,
        action: Action,
        reason: Reason,
        values: (f64, f64),
    ) -> Self {
        Self {
            wheel: Some(wheel),
            ..Self::of_robot(action, reason, values)
        }
    }
}

impl Action {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ReduceTorque => "reduce torque",
            Self::RaiseTorque => "raise torque",
            Self::AcceptSlip => "accept slip",
            Self::ShedTorque => "shed torque",
            Self::Traverse => "traverse",
            Self::SwitchSide => "switch side",
            Self::BackOut => "back out",
            Self::Detour => "detour",
            Self::Stand => "stand",
            Self::Resume => "resume",
            Self::End(Ending::Immobilised) => "end: immobilised",
            Self::End(Ending::Tipping) => "end: tipping",
            Self::End(Ending::SensorsLost) => "end: sensors lost",
            Self::End(Ending::NoWay) => "end: no route left",
        }
    }
}

impl Reason {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SlipHigh => "slip is high",
            Self::SlipUnknown => {
                "slip is unknown: the wheel speed is limited by the speed over ground, m/s"
            }
            Self::SlipRegained => "slip is back at its setpoint",
            Self::Demanded => "slope and soil demand it, steadily",
            Self::SoftGround => "the ground is softer than the known soil",
            Self::ClearedSoftGround => "the soft ground is cleared",
            Self::DiggingIn => "the wheels dig in",
            Self::NoProgress => "no progress",
            Self::SlopeGentle => "the slope is gentle again",
            Self::LegCompleted => "the leg of the traverse is completed",
            Self::BackedOut => "backed out far enough",
            Self::AttemptsUsed => "the attempts are used",
            Self::TiltHigh => "the robot leans too far",
            Self::SensorTimeout => "no usable slip or speed",
            Self::Stall => "the motor pushes but the wheel is stationary",
            Self::EncoderReversed => "the wheel turns against its command",
            Self::InvalidRequest => "the request has invalid numbers",
        }
    }
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (action, reason) = (self.action.name(), self.reason.name());
        write!(
            f,
            "{action}: {reason} ({:.3}, limit {:.3})",
            self.value, self.limit
        )
    }
}
