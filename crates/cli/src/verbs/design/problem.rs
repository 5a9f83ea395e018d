//! One wheel on the deciding soil and slope as a problem file.

use grouser_design::mission::{DesignPoint, MissionProfile, WheelDesign};
use grouser_design::{Design, State, Task, to_toml};
use grouser_opt::{ParetoSettings, Variable};

use crate::error::{Error, Result};
use crate::law_error::Names;

/// Size of the search for two objectives over two to four sizes and a slip: seconds.
const POPULATION: usize = 40;
const GENERATIONS: usize = 60;

/// Slip where the slope is not held: the solver begins there.
const START_SLIP: f64 = 0.3;

/// The chosen wheel under its mean share of the weight, where its reserve is least; radius, width, lugs and slip are variables, mass
/// and energy per metre the objectives.
pub(super) fn toml(
    mission: &MissionProfile,
    chosen: &DesignPoint,
    wheels: usize,
) -> Result<String> {
    let params = mission.params();
    let Some((soil, _, station)) = chosen.worst_station() else {
        return Err(Error::usage_without_hint("the mission has no slope"));
    };
    let soil = &params.soils[soil];
    let load = mission.weight(&chosen.wheel) / wheels as f64;
    let slope = station.slope_deg;
    let state = State::under_load(load)
        .slip(station.slip.unwrap_or(START_SLIP))
        .slope_deg(slope);
    let wheel = chosen
        .wheel
        .rigid()
        .map_err(|error| Names::Flags.error(&error))?;
    let mut builder = Design::builder(&wheel, &soil.soil, state)
        .title(format!(
            "One wheel on {} at {slope} deg under its mean share of the weight",
            soil.name
        ))
        .task(Task::Pareto);
    let sizes = WheelDesign::NAMES.into_iter().zip(chosen.wheel.sizes());
    let sizes = sizes.zip(params.ranges.list()).take(WheelDesign::SIZES);
    for ((name, size), (low, high)) in sizes {
        if low < high {
            builder = builder.variable(Variable::bounded(name, size, low, high));
        }
    }
    let slip = station.slip.unwrap_or(START_SLIP);
    let mut pareto = ParetoSettings::default();
    (pareto.population, pareto.generations) = (POPULATION, GENERATIONS);
    let builder = builder
        .pareto(pareto)
        .variable(Variable::bounded("slip", slip, 0.0, params.max_slip))
        .minimise("mass", &params.mass_formula)
        .minimise("energy", "energy_j_per_m")
        .constraint("holds", format!("gradeability_deg >= {slope:?}"));
    to_toml(&builder).map_err(|error| {
        Error::usage(
            format!("a problem file cannot hold this design: {error}"),
            "leave `--problem` out",
        )
    })
}
