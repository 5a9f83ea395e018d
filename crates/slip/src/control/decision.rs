//! Decisions of the controller, each with its reason.

use core::fmt;

/// What the robot does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Mode {
    /// It goes where it is asked to.
    #[default]
    Forward,
    /// It crosses a slope at an angle.
    Traverse,
    /// It goes back the way it came.
    BackOut,
    /// It goes round soft ground.
    Detour,
    /// The drive has ended.
    Stopped,
}

/// Why a drive ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Ending {
    /// The wheels turn and the robot does not come on.
    Immobilised,
    /// It leans too far.
    Tipping,
    /// Its sensors fell silent.
    SensorsLost,
    /// It found no way on, and stands on ground that carries it.
    NoWay,
}

/// What was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Action {
    /// A wheel's torque is reduced until its slip is the optimum.
    ReduceTorque,
    /// And raised again.
    RaiseTorque,
    /// Slip above the optimum is accepted: torque is raised.
    AcceptSlip,
    /// A wheel's torque is cut to a tenth.
    ShedTorque,
    /// Cross the slope at an angle.
    Traverse,
    /// Cross it the other way.
    Tack,
    /// Go back.
    BackOut,
    /// Go round.
    Detour,
    /// Go on as asked.
    Resume,
    /// End the drive.
    End(Ending),
}

/// Why.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Reason {
    /// Slip stands above its optimum (or the limit given).
    SlipHigh,
    /// Slip is back at its optimum.
    SlipRegained,
    /// The slip is steady: slope and soil demand it, and running slower does not lower it.
    Demanded,
    /// The ground takes much more slip than the known soil would on this slope: it is softer.
    SoftGround,
    /// It has gone far enough aside.
    Aside,
    /// The wheels dig in.
    DiggingIn,
    /// The robot does not come on although its rims run.
    NoProgress,
    /// The slope is gentle again.
    SlopeGentle,
    /// A board of the traverse is done.
    BoardDone,
    /// It has backed out far enough.
    BackedOut,
    /// Backing out did not help, again and again.
    AttemptsUsed,
    /// It leans more than it may.
    TiltHigh,
    /// No slip or no speed is known.
    Blind,
    /// A motor pushes and its wheel does not turn.
    Stall,
    /// A wheel turns against its order: its encoder counts the wrong way.
    EncoderReversed,
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
    /// What was seen: a slip, a share, an angle in rad, a time in s, as the reason has it.
    pub value: f64,
    /// The limit that it passed.
    pub limit: f64,
}

impl Mode {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "Forward",
            Self::Traverse => "Traverse",
            Self::BackOut => "BackOut",
            Self::Detour => "Detour",
            Self::Stopped => "Stopped",
        }
    }
}

impl Ending {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Immobilised => "Immobilised",
            Self::Tipping => "Tipping",
            Self::SensorsLost => "SensorsLost",
            Self::NoWay => "NoWay",
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
            Self::Tack => "tack",
            Self::BackOut => "back out",
            Self::Detour => "detour",
            Self::Resume => "resume",
            Self::End(Ending::Immobilised) => "end: immobilised",
            Self::End(Ending::Tipping) => "end: tipping",
            Self::End(Ending::SensorsLost) => "end: sensors lost",
            Self::End(Ending::NoWay) => "end: no way on",
        }
    }
}

impl Reason {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SlipHigh => "slip is high",
            Self::SlipRegained => "slip is back at its optimum",
            Self::Demanded => "slope and soil demand it, steadily",
            Self::SoftGround => "the ground is softer than the soil that is known",
            Self::Aside => "far enough aside",
            Self::DiggingIn => "the wheels dig in",
            Self::NoProgress => "no progress",
            Self::SlopeGentle => "the slope is gentle again",
            Self::BoardDone => "the board is done",
            Self::BackedOut => "backed out far enough",
            Self::AttemptsUsed => "backing out did not help",
            Self::TiltHigh => "the robot leans too far",
            Self::Blind => "slip or speed unknown",
            Self::Stall => "the motor pushes, the wheel stands",
            Self::EncoderReversed => "the wheel turns against its order",
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

/// Decisions of one step that have not been told yet; a full list forgets the newest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pending {
    list: [Option<Decision>; 16],
}

impl Pending {
    pub(crate) fn push(
        &mut self,
        action: Action,
        reason: Reason,
        wheel: Option<usize>,
        (value, limit): (f64, f64),
    ) {
        if let Some(free) = self.list.iter_mut().find(|entry| entry.is_none()) {
            *free = Some(Decision {
                time_ns: 0,
                action,
                reason,
                wheel,
                value,
                limit,
            });
        }
    }

    /// The oldest one, stamped with now.
    pub(crate) fn take(&mut self, time_ns: i64) -> Option<Decision> {
        let first = self.list[0].take()?;
        self.list.rotate_left(1);
        Some(Decision { time_ns, ..first })
    }
}
