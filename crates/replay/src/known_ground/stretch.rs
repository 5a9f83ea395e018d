//! What a stretch of one ground under one command shows.

use crate::effort::EffortUnit;

/// The rollers of the omni wheel that stands most across the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roller {
    /// Share of the robot's speed at which they roll, 1.
    pub across: f64,
    /// The strongest ripple in that wheel's current, Hz.
    pub ripple: f64,
}

/// A stretch of straight drive under one command on one ground, by the motors and wheels alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins, s from the log's start.
    pub from_s: f64,
    /// Where it ends, s from the log's start.
    pub to_s: f64,
    /// Sum of the sizes of what the motors draw, A or N m: always the same unit.
    pub effort: f64,
    /// Speed by the wheels, m/s.
    pub speed: f64,
    /// The rollers' ripple, of a robot with omni wheels and a stretch of at least 6 s.
    pub roller: Option<Roller>,
}

/// A stretch whose slip was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownGround {
    /// The run that it was measured in: stretches of one run are not independent.
    pub run: String,
    /// What its motors showed.
    pub stretch: Stretch,
    /// Its slip.
    pub slip: f64,
    /// Standard deviation of the slip from one second to the next.
    pub scatter: f64,
}

/// The stretches of known slip of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownGrounds {
    /// The robot's name.
    pub robot: String,
    /// The unit of what its motors draw.
    pub unit: EffortUnit,
    /// The stretches.
    pub grounds: Vec<KnownGround>,
    /// Share of the seconds whose slip lies in the 95 % interval by the other runs; `None` of too few runs.
    pub coverage: Option<f64>,
    /// Median half-width of those intervals.
    pub half_width: Option<f64>,
}
