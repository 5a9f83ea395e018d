//! What one wheel does on a mission.

use grouser_real::Real;
use grouser_real::Scalar;
use grouser_terra::{Settings, WheelOnSoil};

use super::station::{Axle, Station, StationState};
use super::wheel::{PARAMETERS, SHIFT, SIZES};
use super::{MissionProfile, SoilMeasure, WheelDesign};
use crate::error::{Error, Result};
use crate::quantity::{Inputs, NoValue};

/// The robot on one soil and one slope.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StationResult {
    /// Degrees.
    pub slope_deg: f64,
    /// The least slip that holds the slope; `None` where none up to the greatest does.
    pub slip: Option<f64>,
    /// Energy at the wheels per metre of travel, J/m; `None` where the slope is not held.
    pub energy: Option<f64>,
    /// The greatest sinkage of a wheel, m.
    pub sinkage: f64,
    /// The greatest pull up to the greatest slip, less what the slope takes, as a share of the weight: negative where the robot
    /// is immobilised.
    pub reserve: f64,
}

/// A wheel with what it does on a mission.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DesignPoint {
    /// The wheel.
    pub wheel: WheelDesign,
    /// Its mass by the formula, kg.
    pub wheel_mass: f64,
    /// Energy per metre over the way, J/m: of the worst soil or of their mean. `None` where a slope is not held.
    pub energy: Option<f64>,
    /// Energy per metre over the way on each soil, J/m.
    pub soil_energies: Vec<Option<f64>>,
    /// What each wheel of the robot carries on the mission's first slope, N.
    pub loads: Vec<f64>,
    /// By soil, then by slope.
    pub stations: Vec<Vec<StationResult>>,
    /// What keeps the wheel where it is: limits that it meets exactly. Empty for a wheel that was not searched for.
    pub held_by: Vec<String>,
    /// Energy saved per kg more of each wheel, J/m/kg, where the limit of the mass holds it.
    pub energy_per_mass: Option<f64>,
}

impl DesignPoint {
    /// The least reserve of pull over soils and slopes, share of the weight.
    #[must_use]
    pub fn least_reserve(&self) -> f64 {
        self.worst_station()
            .map_or(f64::NAN, |(.., station)| station.reserve)
    }

    /// Soil, slope and state where the reserve is least.
    #[must_use]
    pub fn worst_station(&self) -> Option<(usize, usize, &StationResult)> {
        let all = self.stations.iter().enumerate();
        all.flat_map(|(soil, row)| row.iter().enumerate().map(move |(s, one)| (soil, s, one)))
            .min_by(|a, b| a.2.reserve.total_cmp(&b.2.reserve))
    }
}

impl MissionProfile {
    /// What `wheel` does on this mission; its sizes may lie outside the bounds, but its radius counts in the loads as sampled.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a radius outside the bounds, [`Error::Mission`] where the laws have no value for the wheel.
    pub fn evaluate(&self, wheel: &WheelDesign) -> Result<DesignPoint> {
        let (low, high) = self.stance.radii;
        let (back, front) = self.stance.shifts;
        grouser_real::OutOfRange::check("radius_m", wheel.radius, (low, high), "m")
            .and_then(|()| {
                let limits = (back.min(0.0), front.max(0.0));
                grouser_real::OutOfRange::check("mass_shift_m", wheel.mass_shift, limits, "m")
            })
            .map_err(Error::OutOfRange)?;
        let sizes = wheel.sizes();
        let mass = self.mass.evaluate(&sizes);
        let weight = self.stance.weight(mass);
        let mut stations = Vec::new();
        for (index, soil) in self.params.soils.iter().enumerate() {
            let row = self
                .states(index, &sizes)
                .map_err(|reason| Error::Mission(format!("on {}: {reason}", soil.name)))?;
            let row: Vec<StationResult> = row
                .iter()
                .zip(&self.params.slopes)
                .map(|(state, slope)| StationResult {
                    slope_deg: slope.slope_deg,
                    slip: state.is_held.then_some(state.slip),
                    energy: state.is_held.then_some(state.energy),
                    sinkage: state.sinkage,
                    reserve: state.reserve / weight,
                })
                .collect();
            stations.push(row);
        }
        let soil_energies: Vec<Option<f64>> = stations
            .iter()
            .map(|row| {
                let shares = row.iter().zip(&self.params.slopes);
                shares
                    .map(|(station, slope)| Some(station.energy? * slope.share))
                    .sum()
            })
            .collect();
        let all: Option<Vec<f64>> = soil_energies.iter().copied().collect();
        Ok(DesignPoint {
            wheel: *wheel,
            wheel_mass: mass,
            energy: all.map(|energies| match self.params.measure {
                SoilMeasure::Worst => energies.into_iter().fold(f64::NEG_INFINITY, f64::max),
                SoilMeasure::Mean => {
                    let soils = energies.iter().zip(&self.params.soils);
                    soils.map(|(energy, soil)| energy * soil.share).sum()
                }
            }),
            soil_energies,
            loads: (0..self.params.wheels.len())
                .map(|place| {
                    self.stance
                        .load(0, place, (wheel.radius, mass, wheel.mass_shift))
                })
                .collect(),
            stations,
            held_by: Vec::new(),
            energy_per_mass: None,
        })
    }

    /// The robot with a wheel of these sizes on one soil, on every slope.
    pub(super) fn states<R: Scalar>(
        &self,
        soil: usize,
        sizes: &[R; SIZES],
    ) -> std::result::Result<Vec<StationState<R>>, NoValue> {
        let mass = self.mass.evaluate(sizes);
        let weight = self.stance.weight(mass);
        let mut axles = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
            let mut inputs = Inputs::<R>::new(&group.fixed[soil]);
            if group.kept.is_none() {
                for (parameter, size) in PARAMETERS.into_iter().zip(sizes) {
                    inputs.values[parameter as usize] = *size;
                }
            }
            axles.push((group, inputs));
        }
        let new = axles.iter().find(|(group, _)| group.kept.is_none());
        let Some((_, inputs)) = new else {
            return Err(NoValue::Undefined("no wheel is designed"));
        };
        let law = &self.params.soils[soil].soil;
        let designed = WheelOnSoil::new(inputs.plain().wheel()?, *law, Settings::default())?;
        let mut out = Vec::with_capacity(self.params.slopes.len());
        for (index, slope) in self.params.slopes.iter().enumerate() {
            let own: Vec<Axle<'_, R>> = axles
                .iter()
                .map(|(group, inputs)| Axle {
                    inputs: *inputs,
                    wheel_on_soil: group.kept_on_soil[soil].as_ref().unwrap_or(&designed),
                    load: (self.stance).load(index, group.wheel, (sizes[0], mass, sizes[SHIFT])),
                    count: group.count,
                    bearing: group.bearing,
                })
                .collect();
            let station = Station {
                axles: &own,
                required: weight * R::from_f64(Real::sin(slope.slope_deg.to_radians())),
                max_slip: self.params.max_slip,
            };
            out.push(station.state()?);
        }
        Ok(out)
    }
}
