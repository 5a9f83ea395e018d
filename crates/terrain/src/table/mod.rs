//! What a robot needs on one soil over pitch and roll, from the exact solver on a grid, with a checked error.
//!
//! The slip that a slope demands grows like a square root where the pull reaches its peak, and its derivative jumps
//! where driving becomes braking. Each side is therefore tabulated by itself, over
//! t = √((limit − pitch)/(limit − rolling)), in which the slip is smooth up to the limit; the limits are functions of
//! the roll. Between the nodes runs the cubic through the four nearest ones, in t and in roll.

mod build;
mod check;
mod cubic;
mod envelope;

pub use envelope::Envelope;

use crate::demand::{Demand, DemandSolver};
use crate::error::{Error, Result};
use cubic::{MIN_NODES, Stencil, at};

/// The error in slip that a table promises.
pub const SLIP_BOUND: f64 = 1e-3;

/// Factor between the greatest error that was found between the nodes and the one that is reported: the checks lie in the
/// middle of the cells, where a cubic's error peaks, but not in every cell.
const CHECK_FACTOR: f64 = 5.0;
/// No smaller error in slip is reported. Of six tables with 17 000 random poses each (`tests/table.rs`) the worst true errors
/// were 4.4 and 6.3 times the ones found, which were 0.6e-4 and 0.2e-4; every limit was answered as exactly.
const MIN_SLIP_ERROR: f64 = 5e-4;
const LIMIT_CHECK_FACTOR: f64 = 2.0;

/// What a table knows of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lookup {
    /// It drives, at this slip.
    Drives(Spot),
    /// No slip is enough.
    Immobilised,
    /// It slides downhill.
    Slides,
    /// So near to a limit that only the exact solver knows.
    Marginal,
}

/// Where in a table a pose lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub(crate) slip: f64,
    is_climbing: bool,
    across: Stencil,
    along: Stencil,
}

/// One side of the rolling pitch.
#[derive(Clone, Debug, PartialEq)]
struct Side {
    /// The pitch up to which it drives, for each roll, rad.
    limit: Vec<f64>,
    /// What lies beyond the limit.
    beyond: Beyond,
    /// Slip, [roll][t].
    slip: Vec<f64>,
    /// Work per metre times (1 − slip), J/m, [roll][t].
    work: Vec<f64>,
    /// Sinkage, m, [roll][t].
    sinkage: Vec<f64>,
    /// Error of the limit, rad.
    limit_error: f64,
    /// t below which the error of the limit would pass into the slip.
    marginal: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beyond {
    /// The soil gives no more.
    Soil,
    /// The end of the envelope.
    Envelope,
    /// Some rolls end here, others beyond: the exact solver decides.
    Unknown,
}

/// How well a table agrees with the exact solver between its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableError {
    /// In slip: twice the greatest difference that was found.
    pub slip: f64,
    /// In the pitch at which the robot becomes immobile or slides, rad.
    pub limit: f64,
    /// In energy per metre, as a share of it.
    pub energy: f64,
    /// In sinkage, m.
    pub sinkage: f64,
    /// Places compared with the exact solver.
    pub checks: u64,
}

impl TableError {
    /// The worse of both in everything.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        Self {
            slip: self.slip.max(other.slip),
            limit: self.limit.max(other.limit),
            energy: self.energy.max(other.energy),
            sinkage: self.sinkage.max(other.sinkage),
            checks: self.checks + other.checks,
        }
    }
}

/// What a robot needs on one soil, for every pitch and roll within its envelope.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_terra::catalogue;
/// use grouser_terrain::{Demand, DemandSolver, Envelope, SlipTable};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let solver = DemandSolver::new(RobotModel::read(file.as_ref())?, soil)?;
/// let envelope = Envelope::within(solver.model(), 0.3, 0.2)?;
/// let table = SlipTable::new(&solver, envelope)?;
/// let Demand::Drives(exact) = solver.demand(0.05, 0.1)? else { panic!("it drives") };
/// let Demand::Drives(read) = table.demand(&solver, 0.05, 0.1)? else { panic!("it drives") };
/// assert!((read.slip - exact.slip).abs() < 1e-3);
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlipTable {
    envelope: Envelope,
    rolls: usize,
    /// Nodes along t.
    steps: usize,
    /// The pitch that the robot climbs without roll, rad, by the exact laws.
    steepest: f64,
    /// The pitch at which the robot drives without slip, for each roll, rad.
    rolling: Vec<f64>,
    climbing: Side,
    braking: Side,
    error: TableError,
    /// J/m; 0 where it drives nowhere.
    max_energy: f64,
    /// It drives nowhere, and no list above has anything in it.
    is_closed: bool,
    /// Loads and slips at which wheels were solved for its nodes.
    wheel_solves: usize,
}

impl SlipTable {
    /// The table of a soil on which the robot drives nowhere within the envelope, not even downhill.
    #[must_use]
    pub fn closed(envelope: Envelope) -> Self {
        let nothing = Side {
            limit: Vec::new(),
            beyond: Beyond::Soil,
            slip: Vec::new(),
            work: Vec::new(),
            sinkage: Vec::new(),
            limit_error: 0.0,
            marginal: 0.0,
        };
        Self {
            envelope,
            rolls: 2,
            steps: 2,
            rolling: Vec::new(),
            steepest: -envelope.max_pitch,
            climbing: nothing.clone(),
            braking: nothing,
            error: TableError::default(),
            max_energy: 0.0,
            is_closed: true,
            wheel_solves: 0,
        }
    }

    /// The table of a soil, or a closed one where the robot does not move on it.
    ///
    /// # Errors
    /// As [`SlipTable::new`], but for [`Error::DoesNotMove`](crate::Error::DoesNotMove).
    pub fn new_or_closed(solver: &DemandSolver, envelope: Envelope) -> Result<Self> {
        match Self::new(solver, envelope) {
            Err(Error::DoesNotMove { .. }) => Ok(Self::closed(envelope)),
            other => other,
        }
    }

    /// A table that is refined until its checked error keeps [`SLIP_BOUND`] or
    /// the finest grid is reached: [`SlipTable::error`] is what was reached.
    ///
    /// # Errors
    /// As [`DemandSolver::demand`]; [`Error::DoesNotMove`](crate::Error::DoesNotMove) where the level is too much.
    pub fn new(solver: &DemandSolver, envelope: Envelope) -> Result<Self> {
        build::refined(solver, envelope)
    }

    /// A table on the coarsest grid, without a check, or a closed one where the robot does not move: for
    /// learning, whose own doubt is far greater. [`SlipTable::error`] has NaN in its slip.
    ///
    /// # Errors
    /// As [`SlipTable::new`], but for [`Error::DoesNotMove`](crate::Error::DoesNotMove).
    pub fn coarse(solver: &DemandSolver, envelope: Envelope) -> Result<Self> {
        match build::coarse(solver, envelope) {
            Err(Error::DoesNotMove { .. }) => Ok(Self::closed(envelope)),
            other => other,
        }
    }

    /// How well it agrees with the exact solver.
    #[must_use]
    pub const fn error(&self) -> &TableError {
        &self.error
    }

    /// Nodes over roll and over t on each side.
    #[must_use]
    pub const fn nodes(&self) -> [usize; 2] {
        [self.rolls, self.steps]
    }

    /// At how many loads and slips the laws of a wheel were solved for its nodes: its cost, but for the checks.
    #[must_use]
    pub const fn wheel_solves(&self) -> usize {
        self.wheel_solves
    }

    /// The pitch that the robot climbs without roll, rad; the end of the envelope downhill where it drives nowhere.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        self.steepest
    }

    /// The roll's place, the same for every table of one robot and grid.
    pub(crate) fn across(&self, roll: f64) -> Stencil {
        let share = (roll + self.envelope.max_roll) / (2.0 * self.envelope.max_roll);
        Stencil::new(share, self.rolls.max(MIN_NODES))
    }

    /// The demand at a pose within the envelope, marginal ones by the exact solver.
    ///
    /// # Errors
    /// As [`DemandSolver::demand`].
    pub fn demand(&self, solver: &DemandSolver, pitch: f64, roll: f64) -> Result<Demand> {
        if !self.envelope.holds(pitch, roll) {
            return solver.demand(pitch, roll);
        }
        Ok(match self.look_up(pitch, self.across(roll)) {
            Lookup::Drives(spot) => Demand::Drives(self.driving(&spot)),
            Lookup::Immobilised => Demand::Immobilised,
            Lookup::Slides => Demand::Slides,
            Lookup::Marginal => return solver.demand(pitch, roll),
        })
    }

    pub(crate) fn look_up(&self, pitch: f64, across: Stencil) -> Lookup {
        if self.is_closed {
            return Lookup::Immobilised;
        }
        let rolling = across.along(&self.rolling);
        let is_climbing = pitch >= rolling;
        let side = if is_climbing {
            &self.climbing
        } else {
            &self.braking
        };
        let limit = across.along(&side.limit);
        let square = (limit - pitch) / (limit - rolling);
        if !(square > 0.0) {
            let over = (pitch - limit).abs();
            return match side.beyond {
                Beyond::Soil if over <= side.limit_error => Lookup::Marginal,
                Beyond::Soil if is_climbing => Lookup::Immobilised,
                Beyond::Soil => Lookup::Slides,
                Beyond::Envelope | Beyond::Unknown => Lookup::Marginal,
            };
        }
        let t = square.sqrt();
        if t < side.marginal {
            return Lookup::Marginal;
        }
        let along = Stencil::new(t, self.steps);
        Lookup::Drives(Spot {
            slip: at(&side.slip, self.steps, &across, &along),
            is_climbing,
            across,
            along,
        })
    }

    const fn side(&self, spot: &Spot) -> &Side {
        if spot.is_climbing {
            &self.climbing
        } else {
            &self.braking
        }
    }

    /// The energy at a place, J/m.
    pub(crate) fn energy_per_metre(&self, spot: &Spot) -> f64 {
        let work = at(&self.side(spot).work, self.steps, &spot.across, &spot.along);
        (work / (1.0 - spot.slip.max(0.0))).max(0.0)
    }

    /// The greatest energy of its nodes, J/m; 0 where it drives nowhere.
    pub(crate) const fn max_energy(&self) -> f64 {
        self.max_energy
    }

    /// The costs at a place.
    pub(crate) fn driving(&self, spot: &Spot) -> crate::demand::Driving {
        let side = self.side(spot);
        let read = |values: &[f64]| at(values, self.steps, &spot.across, &spot.along);
        crate::demand::Driving {
            slip: spot.slip,
            work_per_metre: read(&side.work) / (1.0 - spot.slip.max(0.0)),
            sinkage: read(&side.sinkage),
            cautions: grouser_terra::Cautions::default(),
        }
    }
}
