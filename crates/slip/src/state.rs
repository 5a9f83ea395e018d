//! The state of a wheel: how it moves, and how far the estimate of it can be trusted.

use core::fmt;

/// How a wheel moves. One part of a wheel's state; [`Health`] is the other.
///
/// ```
/// use grouser_slip::Motion;
///
/// assert_eq!(Motion::RollBack.name(), "RollBack");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Motion {
    /// The rim runs at least as fast as the wheel travels: slip in [0, 1].
    Driving,
    /// The wheel travels faster than its rim runs: slip in [−1, 0).
    Braking,
    /// Both speeds are below their noise.
    Standstill,
    /// The wheel travels against its own rotation.
    RollBack,
    /// The wheel spins without load.
    LiftOff,
    /// The motor pushes and nothing turns.
    Stall,
}

impl Motion {
    /// Every motion, in the order in which tables list them.
    pub const ALL: [Self; 6] = [
        Self::Driving,
        Self::Braking,
        Self::Standstill,
        Self::RollBack,
        Self::LiftOff,
        Self::Stall,
    ];

    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Driving => "Driving",
            Self::Braking => "Braking",
            Self::Standstill => "Standstill",
            Self::RollBack => "RollBack",
            Self::LiftOff => "LiftOff",
            Self::Stall => "Stall",
        }
    }
}

/// How far an estimate can be trusted.
///
/// ```
/// use grouser_slip::{Degraded, Health};
///
/// // A program that drives on `Ok` alone is safe against causes that are added later.
/// let health = Health::Degraded(Degraded::ReferenceLost);
/// assert_ne!(health, Health::Ok);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Health {
    /// Not enough has been measured yet.
    Uninitialised,
    /// The slip and its sigma hold.
    Ok,
    /// There is an estimate, or part of one, with this reservation.
    Degraded(Degraded),
    /// There is no estimate, for this reason.
    Invalid(Invalid),
}

/// What lowers the trust in an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Degraded {
    /// The wheel moves, but too slowly for its slip to mean anything.
    LowSpeed,
    /// The sensors' resolution alone makes sigma exceed its limit.
    Quantised,
    /// The reference has fallen silent.
    ReferenceLost,
    /// Nothing measures how fast the robot travels: the slip that the wheels have in common is the prior's, and only the
    /// differences between them are measured.
    Relative,
    /// The wheel's sensor may be wrong: it stands while the robot moves, not yet for long enough to be sure.
    Suspect,
}

/// What makes an estimate impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Invalid {
    /// The wheel's sensor has fallen silent.
    Dropout,
    /// No reference measures the robot's speed.
    NoReference,
    /// The wheel's sensor contradicts the others: stuck, or turning the other way.
    Inconsistent,
}

impl Degraded {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LowSpeed => "LowSpeed",
            Self::Quantised => "Quantised",
            Self::ReferenceLost => "ReferenceLost",
            Self::Relative => "Relative",
            Self::Suspect => "Suspect",
        }
    }
}

impl Invalid {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dropout => "Dropout",
            Self::NoReference => "NoReference",
            Self::Inconsistent => "Inconsistent",
        }
    }
}

impl fmt::Display for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uninitialised => f.write_str("Uninitialised"),
            Self::Ok => f.write_str("Ok"),
            Self::Degraded(reason) => write!(f, "Degraded({})", reason.name()),
            Self::Invalid(reason) => write!(f, "Invalid({})", reason.name()),
        }
    }
}
