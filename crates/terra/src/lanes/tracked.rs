//! One wheel in a control loop.

use crate::contact::ladder::Step;
use crate::error::Result;
use crate::kinematics::Kinematics;
use crate::settings::Accuracy;
use crate::sinkage::LoadStatus;
use crate::slip::Slip;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchForces;
use super::machine::Level;
use super::nodes::{NodeRule, Single, Track};
use super::plan::Prepared;

/// One wheel on one soil, asked again and again, as a control loop does: forces and sinkages of a wheel that
/// rolls straight ahead, to the accuracy of [`WheelOnSoil`] and several times as fast.
///
/// The nodes of the integrals stand side by side in the machine's vectors, and the search for a sinkage
/// begins where the last one ended: one or two evaluations while load and slip move little. What lanes do
/// not serve (a braked wheel, a sinkage above half the radius, a load on soil that rises behind the wheel,
/// a wheel with grousers, n(s), the reference mode) goes through [`WheelOnSoil`]. Nothing is allocated.
///
/// ```
/// use grouser_terra::{RigidWheel, Settings, Slip, TrackedWheel, WheelOnSoil, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let pair = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
/// let mut wheel = TrackedWheel::new(pair);
/// let first = wheel.under_load(80.0, Slip::new(0.2)?)?;
/// let next = wheel.under_load(80.5, Slip::new(0.201)?)?;
/// assert!(next.evaluations <= 2 && next.evaluations < first.evaluations);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct TrackedWheel {
    pair: WheelOnSoil,
    prepared: Option<(Prepared, [NodeRule; Step::COUNT])>,
    level: Level,
    track: Option<Track>,
}

/// A wheel under its load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedSolution {
    /// How the search for the sinkage ended.
    pub status: LoadStatus,
    /// Sinkage, forces and torque; `None` unless solved.
    pub forces: Option<BatchForces>,
    /// Evaluations of the stress integrals.
    pub evaluations: u32,
}

impl TrackedWheel {
    /// Prepares a wheel on its soil.
    #[must_use]
    pub fn new(pair: WheelOnSoil) -> Self {
        let lean =
            pair.settings().accuracy == Accuracy::Standard && pair.wheel().grousers().is_none();
        let prepared = if lean {
            Prepared::new(pair.soil()).map(|prepared| {
                let rules = NodeRule::all(&prepared.tables);
                (prepared, rules)
            })
        } else {
            None
        };
        Self {
            pair,
            prepared,
            level: Level::best(),
            track: None,
        }
    }

    /// The same wheel without the machine's vector instructions, to compare.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.level = Level::Portable;
        self
    }

    /// The wheel on its soil.
    #[must_use]
    pub const fn pair(&self) -> &WheelOnSoil {
        &self.pair
    }

    /// Forgets the last solution: the next search begins from nothing.
    pub const fn forget(&mut self) {
        self.track = None;
    }

    /// Forces at a sinkage (m).
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_at`].
    pub fn forces(&self, sinkage: f64, slip: Slip) -> Result<BatchForces> {
        let radius = self.pair.wheel().radius();
        let lean = self
            .single(slip)
            .and_then(|single| self.level.single_forces(&single, sinkage / radius));
        match lean {
            Some([vertical_force, drawbar_pull, torque]) => Ok(BatchForces {
                sinkage,
                vertical_force,
                drawbar_pull,
                torque: torque * radius,
            }),
            None => self.general(sinkage, slip),
        }
    }

    /// Sinkage and forces under a load (N), from the last solution on.
    ///
    /// Its bits depend on where the last search ended, its figures only within 1e-9.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    pub fn under_load(&mut self, load: f64, slip: Slip) -> Result<TrackedSolution> {
        let radius = self.pair.wheel().radius();
        let mut track = self.track;
        let carried = self
            .single(slip)
            .and_then(|single| self.level.single_load(&single, load, &mut track));
        if let Some(carried) = carried {
            self.track = track;
            return Ok(TrackedSolution {
                status: LoadStatus::Solved,
                forces: Some(BatchForces {
                    sinkage: carried.z_over_r * radius,
                    vertical_force: load,
                    drawbar_pull: carried.pull * load,
                    torque: carried.turn * load * radius,
                }),
                evaluations: carried.evaluations,
            });
        }
        self.track = None;
        let found = self.pair.sinkage_under(load, &Kinematics::straight(slip))?;
        let forces = match found.sinkage {
            Some(sinkage) => Some(self.general(sinkage, slip)?),
            None => None,
        };
        Ok(TrackedSolution {
            status: found.status,
            forces,
            evaluations: found.evaluations + 1,
        })
    }

    fn single(&self, slip: Slip) -> Option<Single<'_>> {
        let wheel = self.pair.wheel();
        self.prepared.as_ref().map(|(prepared, rules)| Single {
            prepared,
            rules,
            radius: wheel.radius(),
            width: wheel.width(),
            rebound: self.pair.soil().params().rebound,
            slip: slip.value(),
        })
    }

    fn general(&self, sinkage: f64, slip: Slip) -> Result<BatchForces> {
        let f = self.pair.forces_at(sinkage, &Kinematics::straight(slip))?;
        Ok(BatchForces {
            sinkage,
            vertical_force: f.vertical_force,
            drawbar_pull: f.drawbar_pull,
            torque: f.torque,
        })
    }
}
