//! The slip that the controller runs at: the running-slip problem for this wheel, load and soil.

use grouser_rover::drive::Scenario;

use crate::error::{Error, Result};
use grouser_report::number::shown;

/// Which of the slips that are called optimal this is.
pub(crate) fn meaning(scenario: &Scenario) -> String {
    if scenario.optimum.is_some() {
        return "as the scenario sets it".to_owned();
    }
    let Some((wheel, load)) = scenario.typical_wheel() else {
        return "greatest tractive efficiency".to_owned();
    };
    format!(
        "greatest tractive efficiency of wheel {} under {} N on {}",
        scenario.robot.wheels[wheel].name,
        shown(load),
        scenario.ground.soils[0].name,
    )
}

/// The slip of a scenario that names none.
pub(crate) fn running_slip(scenario: &Scenario) -> Result<f64> {
    let lacks = |what: &str| {
        Error::usage(
            format!("the slip to run at cannot be found: {what}"),
            "give `optimum` under `[control]` in the scenario",
        )
    };
    let (wheel, load) = scenario
        .typical_wheel()
        .ok_or_else(|| lacks("the robot has no powered wheel"))?;
    let rigid = &scenario.robot.wheels[wheel].wheel;
    let soil = &scenario.ground.soils[0].soil;
    grouser_design::running_slip(rigid, soil, load).map_err(|error| match error {
        grouser_design::Error::NoRunningSlip { reason } => lacks(&reason),
        error => lacks(&error.to_string()),
    })
}
