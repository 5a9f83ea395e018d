//! What came of a drive.

use grouser_slip::control::Decision;
use grouser_slip::onboard::SoilEstimate;

use crate::dynamics::Ledger;
use crate::ground::UndeclaredNoData;

/// How a drive ended.
///
/// ```
/// use grouser_rover::drive::Outcome;
///
/// assert!(Outcome::Arrived < Outcome::TimeOut);
/// assert_eq!(Outcome::OffMap.name(), "off-map");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Outcome {
    /// Every leg was driven.
    Arrived,
    /// The wheels turned and the robot did not come on, or the controller found so.
    Immobilised,
    /// It fell over, or the controller stopped it before it did.
    Tipped,
    /// The controller stopped it because its sensors fell silent.
    SensorsLost,
    /// The controller found no way on, and stopped it before it dug in.
    NoWay,
    /// It drove off the map.
    OffMap,
    /// The time was over.
    TimeOut,
    /// It could not begin on the ground of its seed ([`DriveResult::refused`]).
    Refused,
}

impl Outcome {
    /// Its name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Immobilised => "immobilised",
            Self::Tipped => "tipped",
            Self::SensorsLost => "sensors-lost",
            Self::NoWay => "no-way",
            Self::OffMap => "off-map",
            Self::TimeOut => "time-out",
            Self::Refused => "refused",
        }
    }
}

/// A decision with where it was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDecision {
    /// Seconds since the start.
    pub time: f64,
    /// The decision.
    pub decision: Decision,
    /// Where the robot was, m.
    pub place: (f64, f64),
}

/// How far estimated slips lay from the true ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SlipScore {
    /// How many were compared.
    pub count: u64,
    /// Root of the mean square.
    pub rmse: Option<f64>,
    /// The same without each wheel's first second of motion.
    pub settled: Option<f64>,
    /// Mean of estimate less truth.
    pub bias: Option<f64>,
    /// Mean of the squared error over the variance that was said with it: 1 is honest, less is cautious.
    pub nees: Option<f64>,
    /// The longest time that any wheel's slip with health `Ok` was further off than four sigma, s.
    pub longest_wrong: f64,
}

/// What came of a drive.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DriveResult {
    /// How it ended.
    pub outcome: Outcome,
    /// Seconds that it took.
    pub duration: f64,
    /// Progress along its legs, m.
    pub distance: f64,
    /// Length of its way, m.
    pub way: f64,
    /// Length of the way at the requested speeds, m.
    pub requested_way: f64,
    /// Electrical energy with the electronics', J.
    pub energy: f64,
    /// Where it went.
    pub ledger: Ledger,
    /// What the books of energy lack, over what was turned over; at least what lifts the robot by a centimetre.
    pub energy_error: f64,
    /// Estimated against true slip.
    pub slip: SlipScore,
    /// Greatest load-weighted true slip that lasted a second.
    pub worst_slip: f64,
    /// Minimum margin against tipping over, rad, of a chassis with actuators.
    pub min_tip_over_margin: Option<f64>,
    /// Greatest share of the time that a loaded wheel was sunk so deep that the laws lose their grip
    /// ([`Caution::DeepSinkage`](grouser_terra::Caution::DeepSinkage)).
    pub deep_share: f64,
    /// What of its ground's file was read as unknown, although the file does not declare it.
    pub undeclared: Option<UndeclaredNoData>,
    /// Decisions with their reasons, the first thousand.
    pub decisions: Vec<NamedDecision>,
    /// Decisions in all.
    pub decision_count: u64,
    /// Samples that the estimator refused.
    pub refused: u64,
    /// The place where it ended, m.
    pub end: (f64, f64),
    /// What the robot's computer has learnt of the soil, where it learns.
    pub soil: Option<SoilEstimate>,
}

impl DriveResult {
    /// The row of a drive that could not begin, among others of a sweep: nothing was driven, and nothing estimated.
    ///
    /// ```
    /// use grouser_rover::drive::DriveResult;
    ///
    /// let row = DriveResult::refused();
    /// assert!(row.outcome.name() == "refused" && row.energy_per_metre().is_none());
    /// ```
    #[must_use]
    pub fn refused() -> Self {
        Self {
            outcome: Outcome::Refused,
            duration: 0.0,
            distance: 0.0,
            way: 0.0,
            requested_way: 0.0,
            energy: 0.0,
            ledger: Ledger::default(),
            energy_error: 0.0,
            slip: SlipScore::default(),
            worst_slip: 0.0,
            min_tip_over_margin: None,
            deep_share: 0.0,
            undeclared: None,
            decisions: Vec::new(),
            decision_count: 0,
            refused: 0,
            end: (0.0, 0.0),
            soil: None,
        }
    }

    /// Mean speed as a share of the mean requested speed; 1 where the robot did not move.
    #[must_use]
    pub fn pace(&self) -> f64 {
        let share = self.way / self.requested_way;
        if share > 0.0 && share.is_finite() {
            share
        } else {
            1.0
        }
    }

    /// Mean speed of its progress along its legs, m/s.
    #[must_use]
    pub fn mean_speed(&self) -> f64 {
        self.distance / self.duration
    }

    /// J per metre of progress; `None` where there was none to speak of (a centimetre).
    #[must_use]
    pub fn energy_per_metre(&self) -> Option<f64> {
        (self.distance > 0.01).then(|| self.energy / self.distance)
    }
}
