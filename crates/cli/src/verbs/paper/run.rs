//! The run on sand: a scenario is driven, and its log estimated.

use grouser_campaign::paper::{SandRun, SandWheel, SlipMoment};
use grouser_replay::Compared;
use grouser_rover::drive::{Scenario, read_scenario};

use super::steps::Steps;
use crate::error::{Error, Result};
use crate::output::OutputFile;
use crate::session::Session;

const SCENARIO: &str = include_str!("../../../templates/scenario.toml");
const ROBOT: &str = include_str!("../../../templates/robot.toml");
/// What the run adds to the shipped scenario: the times of the free wheel's pulses, and a soil that is learnt.
const ADDED: &str = "\n[sensors]\nedge_clock_s = 1e-6        # free wheels report the time of each pulse\n\n[learn]\n";

/// Drives and estimates; the logs stay in the folder.
pub(super) const DRIVE: &str = "grouser drive @scenario.toml --compare open-loop,controller -o @drive.mcap --report @drive.html";
pub(super) const ESTIMATE: &str = "grouser estimate @drive.mcap --robot @robot.toml --soil dry-sand --learn-soil \
     --truth /simulation/truth/slip -o @slip.csv -o @slip.svg --report @estimate.html";

/// Writes the robot and the scenario, with a slip setpoint where one is stated, and reads them.
pub(super) fn scenario(steps: &Steps<'_>, setpoint: Option<f64>) -> Result<Scenario> {
    let control = setpoint.map_or_else(String::new, |slip| {
        format!("\n[control]\noptimum = {slip:?}         # proved by optimum.toml\n")
    });
    let scenario = format!("{SCENARIO}{ADDED}{control}");
    for (name, text) in [("robot.toml", ROBOT), ("scenario.toml", &scenario)] {
        crate::files_in_use::clear();
        OutputFile::create(&steps.folder.join(name))?.write_whole(text.as_bytes())?;
    }
    let path = steps.folder.join("scenario.toml");
    read_scenario(&path).map_err(|error| Error::from(error).in_file(&path))
}

/// What `estimate` found, as figure 13 shows it. A command ran before that has the truth.
pub(super) fn sand_run(
    steps: &mut Steps<'_>,
    scenario: &Scenario,
    session: &mut Session,
) -> Result<SandRun> {
    steps.run(DRIVE, session)?;
    let estimated = steps.run(ESTIMATE, session)?;
    Ok(SandRun {
        wheels: estimated.compared.as_ref().map(wheels).unwrap_or_default(),
        seed: scenario.seed,
        robot: scenario.robot.clone(),
    })
}

fn wheels(compared: &Compared) -> Vec<SandWheel> {
    let errors = compared.errors();
    let mut wheels = Vec::new();
    for (name, slips) in compared.slips() {
        let Some(error) = errors.iter().find(|error| error.wheel == name) else {
            continue;
        };
        if slips.is_empty() {
            continue; // the free wheel is what the others are measured against
        }
        let moment = |slip: &grouser_replay::ComparedSlip| SlipMoment {
            time: slip.time_s,
            slip: slip.slip,
            interval_90: slip.interval_90,
            truth: slip.truth,
        };
        wheels.push(SandWheel {
            name,
            moments: slips.iter().map(moment).collect(),
            rmse: error.rmse,
            bias: error.bias,
            coverage_90: error.coverage_90,
        });
    }
    wheels
}
