//! A soil at several strengths and stiffnesses.

use grouser_rover::robot::RobotModel;
use grouser_terra::{Angle, Bekker, Pressure, Reece, Soil, SoilParams};

use crate::demand::DemandSolver;
use crate::error::{Error, Result};
use crate::table::{Envelope, SlipTable};

/// Cohesion and tan φ as multiples of the known soil's. The catalogue's tan φ lie between 0.23 and 0.76, dry sand's is 0.58.
const STRENGTHS: [f64; 4] = [0.45, 0.7, 1.0, 1.4];
/// Pressure-sinkage moduli as multiples of the known soil's. At 2 cm, snow of the catalogue has 0.02 of the pressure of dry
/// sand, sandy loam 4 times as much.
const STIFFNESSES: [f64; 4] = [0.05, 0.25, 1.0, 4.0];

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
/// Equation: cohesion ρ c, tan φ' = ρ tan φ, pressure-sinkage moduli κ k; n, K, c_1, c_2 and the laws are the known soil's.
/// Assumes: soil of another kind is described well enough by the mixture of levels that demands the same slip and energy.
/// Strength alone does not do: firm ground with a short contact mobilises less of its strength than loose sand, and climbs
/// less, but takes less energy.
#[derive(Clone, Debug)]
pub struct StrengthFamily {
    levels: Vec<Level>,
}

impl StrengthFamily {
    /// The levels of `soil` for a robot.
    ///
    /// # Errors
    /// [`Error::Law`] where the laws refuse a level, [`Error::DoesNotStand`].
    pub fn new(model: &RobotModel, soil: &Soil, envelope: Envelope) -> Result<Self> {
        let mut levels = Vec::with_capacity(STRENGTHS.len() * STIFFNESSES.len());
        for strength in STRENGTHS {
            for stiffness in STIFFNESSES {
                let scaled = scaled(soil, strength, stiffness).map_err(|source| Error::Law {
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

/// The soil at another strength and stiffness.
fn scaled(soil: &Soil, ratio: f64, modulus: f64) -> Result<Soil, grouser_terra::Error> {
    let p = *soil.params();
    Soil::new(SoilParams {
        cohesion: ratio * p.cohesion,
        phi: Angle::from_rad((ratio * p.phi.rad().tan()).atan()),
        pressure: match p.pressure {
            Pressure::Bekker(Bekker { k_c, k_phi }) => Pressure::Bekker(Bekker {
                k_c: modulus * k_c,
                k_phi: modulus * k_phi,
            }),
            Pressure::Reece(Reece {
                k_c_prime,
                k_phi_prime,
            }) => Pressure::Reece(Reece {
                k_c_prime: modulus * k_c_prime,
                k_phi_prime: modulus * k_phi_prime,
            }),
            other => other,
        },
        ..p
    })
}
