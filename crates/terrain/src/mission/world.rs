//! A world to compare policies in: relief, soils in patches, and what driving takes there by the exact solver.
//!
//! Quasi-static: at every quarter of a metre the robot stands in the pose of the relief under its wheels, each wheel on the
//! soil at its place, and the demand of that pose is what driving takes. Not in it: dynamics, ruts, drift, turning.

use grouser_rover::ground::{HeightMap, Place};

use crate::demand::{Demand, DemandSolver, Driving};
use crate::error::Result;
use crate::pose::{SurfacePose, WheelPlane};
use crate::table::SlipTable;

/// A pose is solved anew after this way, m.
pub(super) const STEP_M: f64 = 0.25;
/// A robot whose controller sees this slip stops before it digs in.
pub(super) const DIG_SLIP: f64 = 0.8;

/// A soil of the world, for one robot under the world's law of shear.
#[derive(Clone, Debug)]
pub struct WorldSoil {
    /// The exact solver.
    pub solver: DemandSolver,
    /// Its table, for poses with all wheels on it.
    pub table: SlipTable,
}

/// A relief with soils.
#[derive(Clone, Debug)]
pub struct World<'a> {
    relief: &'a HeightMap,
    soils: &'a [WorldSoil],
    base: usize,
    patches: Vec<(Place, usize)>,
    plane: WheelPlane,
    mixed: DemandSolver,
}

/// What a pose takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taken {
    pub(super) pose: SurfacePose,
    pub(super) demand: Demand,
}

impl Taken {
    /// The driving, if the robot comes on without digging.
    pub(super) fn driving(&self) -> Option<Driving> {
        match self.demand {
            Demand::Drives(driving) if driving.slip <= DIG_SLIP => Some(driving),
            _ => None,
        }
    }
}

impl<'a> World<'a> {
    /// Ground of the soil `base` with patches of others, later ones upon earlier ones.
    #[must_use]
    pub fn new(
        relief: &'a HeightMap,
        soils: &'a [WorldSoil],
        base: usize,
        patches: Vec<(Place, usize)>,
    ) -> Self {
        let mixed = soils[base].solver.clone();
        Self {
            plane: WheelPlane::new(mixed.model()),
            relief,
            soils,
            base,
            patches,
            mixed,
        }
    }

    pub(super) const fn soils(&self) -> &[WorldSoil] {
        self.soils
    }

    /// The soil at a place.
    pub(super) fn soil_at(&self, (x, y): (f64, f64)) -> usize {
        let patch = self
            .patches
            .iter()
            .rev()
            .find(|(place, _)| place.holds(x, y));
        patch.map_or(self.base, |(_, soil)| *soil)
    }

    /// The soils under the wheels of a robot.
    pub(super) fn soils_under(
        &self,
        place: (f64, f64),
        heading: f64,
    ) -> impl Iterator<Item = usize> + '_ {
        let places: Vec<_> = self.plane.places(place, heading).collect();
        places.into_iter().map(|at| self.soil_at(at))
    }

    pub(super) fn pose(&self, place: (f64, f64), heading: f64) -> Option<SurfacePose> {
        self.plane.pose(self.relief, place, heading)
    }

    pub(super) fn front(&self) -> f64 {
        self.plane.front()
    }

    /// How much weaker the ground is on the left than on the right: the difference of the slopes that the soils let climb.
    pub(super) fn left_is_weaker(&self, place: (f64, f64), heading: f64) -> f64 {
        let (sin, cos) = heading.sin_cos();
        let places = self.plane.places(place, heading);
        places
            .map(|at| {
                let left = -(at.0 - place.0) * sin + (at.1 - place.1) * cos;
                -left.signum() * self.soils[self.soil_at(at)].table.steepest()
            })
            .sum()
    }

    /// What a robot takes at a place, forwards or backwards; `None` off the known ground.
    pub(super) fn take(
        &mut self,
        place: (f64, f64),
        heading: f64,
        is_forward: bool,
    ) -> Result<Option<Taken>> {
        let Some(pose) = self.plane.pose(self.relief, place, heading) else {
            return Ok(None);
        };
        let under: Vec<usize> = self.soils_under(place, heading).collect();
        let SurfacePose { pitch, roll } = pose;
        let is_one = under.iter().all(|soil| *soil == under[0]);
        let demand = if is_one && is_forward {
            let WorldSoil { solver, table } = &self.soils[under[0]];
            table.demand(solver, pitch, roll)?
        } else {
            for (wheel, soil) in under.iter().enumerate() {
                self.mixed.put_wheel(wheel, &self.soils[*soil].solver);
            }
            if is_forward {
                self.mixed.demand(pitch, roll)?
            } else {
                self.mixed.demand_backwards(pitch, roll)?
            }
        };
        Ok(Some(Taken { pose, demand }))
    }
}
