//! Every wheel of a front in the solver of `climb`, and whether the robot stands on its slopes.

use std::collections::BTreeMap;

use grouser_design::mission::{DesignPoint, MissionFront, MissionProfile};
use grouser_terra::Caution;
use grouser_terrain::{DemandSolver, climb};

use super::carrier::Carrier;
use crate::error::Result;

/// The two solvers differ by less than this share of the energy: loads are interpolated to 1e-6 and slips found to 1e-9.
pub(super) const MAX_DIFFERENCE: f64 = 1e-4;

/// What the check found.
pub(super) struct Checked {
    /// The greatest difference of an energy, share of it.
    pub(super) difference: f64,
    /// Of the chosen wheel: the least angle to tipping over, rad.
    pub(super) tip_over: Option<f64>,
    /// Of the chosen wheel: the lowest slope on which a wheel loses the ground, degrees.
    pub(super) lifts_at: Option<f64>,
    /// Of the chosen wheel: each caution, with the first soil and slope (degrees) where it applies.
    pub(super) cautions: BTreeMap<Caution, (String, f64)>,
}

impl Checked {
    pub(super) fn new(
        carrier: &Carrier,
        mission: &MissionProfile,
        front: &MissionFront,
    ) -> Result<Self> {
        let mut checked = Self {
            difference: 0.0,
            tip_over: None,
            lifts_at: None,
            cautions: BTreeMap::new(),
        };
        let nearest = front.nearest.iter();
        let shown = front
            .chosen
            .or(Some(0))
            .filter(|_| !front.points.is_empty());
        for (index, point) in front.points.iter().chain(nearest).enumerate() {
            let is_shown = front.points.is_empty() || shown == Some(index);
            checked.compare(carrier, mission, point, is_shown)?;
        }
        Ok(checked)
    }

    fn compare(
        &mut self,
        carrier: &Carrier,
        mission: &MissionProfile,
        point: &DesignPoint,
        is_shown: bool,
    ) -> Result<()> {
        let model = carrier.model(&point.wheel, point.wheel_mass)?;
        let params = mission.params();
        let slopes: Vec<f64> = params
            .slopes
            .iter()
            .map(|slope| slope.slope_deg.to_radians())
            .collect();
        for (soil, row) in params.soils.iter().zip(&point.stations) {
            let solver =
                DemandSolver::new(model.clone(), soil.soil)?.with_max_slip(params.max_slip)?;
            let steps = climb(&solver, &slopes)?;
            for (step, ours) in steps.iter().zip(row) {
                let theirs = step.energy_per_metre;
                self.difference = match (ours.energy, theirs) {
                    (Some(ours), Some(theirs)) => self.difference.max((ours / theirs - 1.0).abs()),
                    (Some(_), None) => f64::INFINITY,
                    (None, _) => self.difference,
                };
                if is_shown {
                    for caution in step.cautions.iter() {
                        let here = || (soil.name.clone(), ours.slope_deg);
                        self.cautions.entry(caution).or_insert_with(here);
                    }
                    self.tip_over = Some(
                        self.tip_over
                            .map_or(step.tip_over, |t| t.min(step.tip_over)),
                    );
                    if step.lifts && self.lifts_at.is_none_or(|at| ours.slope_deg < at) {
                        self.lifts_at = Some(ours.slope_deg);
                    }
                }
            }
        }
        Ok(())
    }

    /// Does the robot with the chosen wheel tip over, or a wheel lose the ground?
    pub(super) fn falls(&self) -> bool {
        self.lifts_at.is_some() || self.tip_over.is_some_and(|margin| !(margin > 0.0))
    }
}
