//! Which of the slips that are called optimal the controller runs at.

use grouser_report::number::shown;
use grouser_rover::drive::Scenario;

/// Which of the slips that are called optimal this is.
pub(crate) fn meaning(scenario: &Scenario) -> String {
    if scenario.optimum.is_some() {
        return "as the scenario sets it".to_owned();
    }
    let Some((wheel, load)) = scenario.typical_wheel() else {
        return "maximum tractive efficiency".to_owned();
    };
    format!(
        "maximum tractive efficiency of wheel {} under {} N on {}",
        scenario.robot.wheels[wheel].name,
        shown(load),
        scenario.ground.soils[0].name,
    )
}
