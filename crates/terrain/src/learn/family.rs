//! A soil at several strengths and stiffnesses.

use grouser_rover::robot::RobotModel;
use grouser_slip::prior::{STIFFNESSES, STRENGTHS, scaled_soil};
use grouser_terra::Soil;

use crate::demand::DemandSolver;
use crate::error::{Error, Result};
use crate::table::{Envelope, SlipTable};

/// The known soil with another strength and stiffness.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Level {
    /// Cohesion and tan φ as multiples of the known soil's.
    pub strength: f64,
    /// Pressure-sinkage moduli as multiples of the known soil's.
    pub stiffness: f64,
    /// The exact solver.
    pub solver: DemandSolver,
    /// Its table.
    pub table: SlipTable,
}

/// A soil at four strengths and four stiffnesses, ordered by the slope that they let the robot climb.
///
/// Each is the known soil by [`scaled_soil`].
/// Assumes: soil of another kind is described well enough by the mixture of levels that demands the same slip and energy.
/// Strength alone does not do: firm ground with a short contact mobilises less of its strength than loose sand, and climbs
/// less, but takes less energy.
#[derive(Clone, Debug)]
pub struct StrengthFamily {
    levels: Vec<Level>,
}

impl StrengthFamily {
    /// How many levels there are.
    pub(crate) const LEVELS: usize = STRENGTHS.len() * STIFFNESSES.len();

    /// The levels of `soil` for a robot.
    ///
    /// # Errors
    /// [`Error::Law`] where the laws refuse a level, [`Error::DoesNotStand`].
    pub fn new(model: &RobotModel, soil: &Soil, envelope: Envelope) -> Result<Self> {
        let mut levels = Vec::with_capacity(Self::LEVELS);
        for strength in STRENGTHS {
            for stiffness in STIFFNESSES {
                let scaled =
                    scaled_soil(soil, strength, stiffness).map_err(|source| Error::Law {
                        of: format!("soil at strength {strength} and stiffness {stiffness}"),
                        source,
                    })?;
                let solver = DemandSolver::new(model.clone(), scaled)?;
                levels.push(Level {
                    strength,
                    stiffness,
                    table: SlipTable::coarse(&solver, envelope)?,
                    solver,
                });
            }
        }
        levels.sort_by(|a, b| a.table.steepest().total_cmp(&b.table.steepest()));
        Ok(Self { levels })
    }

    /// The levels, the weakest first.
    #[must_use]
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }
}
