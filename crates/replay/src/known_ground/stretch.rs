//! What a stretch of one ground under one command shows.

use super::slip_range::{SlipRange, slip_of};
use crate::error::Result;

/// The unit of what the motors draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortUnit {
    /// Currents whose torque is not known, A.
    Ampere,
    /// Torques on the wheels, N m.
    NewtonMetre,
}

impl EffortUnit {
    /// Its symbol.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Ampere => "A",
            Self::NewtonMetre => "N m",
        }
    }
}

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

impl KnownGrounds {
    /// The slip of any one second of a stretch, by Bayes' rule over these grounds and one that was never met.
    ///
    /// A known ground draws its effort within 5 %. Rollers count if the stretch and at least three grounds have them: their
    /// way per ripple is spread as over the known stretches.
    ///
    /// Assumes: straight, steady drive; slip between 0 and 1; the same robot with the same load on the same slope.
    ///
    /// # Errors
    /// [`Error::TooFewGrounds`](crate::Error::TooFewGrounds) for less than three grounds or numbers that are not positive.
    ///
    /// ```
    /// use grouser_replay::{EffortUnit, KnownGround, KnownGrounds, Roller, Stretch};
    ///
    /// // Three runs with known slip, and one whose current is that of the first.
    /// let grounds = [(1.0, 0.1), (1.4, 0.3), (1.9, 0.5)].map(|(effort, slip)| {
    ///     let ripple = 2.0 * (1.0 - slip); // the rollers follow the true speed
    ///     let roller = Some(Roller { across: 0.5, ripple });
    ///     let stretch = Stretch { from_s: 2.0, to_s: 12.0, effort, speed: 0.2, roller };
    ///     KnownGround { run: effort.to_string(), stretch, slip, scatter: 0.02 }
    /// });
    /// let known = KnownGrounds {
    ///     robot: "omni".into(),
    ///     unit: EffortUnit::Ampere,
    ///     grounds: grounds.to_vec(),
    ///     coverage: None,
    ///     half_width: None,
    /// };
    /// let range = known.slip(&known.grounds[0].stretch)?;
    /// assert!(range.low < 0.1 && 0.1 < range.high && range.median < 0.3);
    /// assert_eq!(range.nearest, 0);
    /// # Ok::<(), grouser_replay::Error>(())
    /// ```
    pub fn slip(&self, stretch: &Stretch) -> Result<SlipRange> {
        let grounds: Vec<&KnownGround> = self.grounds.iter().collect();
        slip_of(stretch, &grounds)
    }
}
