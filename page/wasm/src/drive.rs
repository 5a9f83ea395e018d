//! A drive from a scenario, as `grouser drive` simulates it.

use grouser_files::Document;
use grouser_page::run::{Drive, DriveRecorder};
use grouser_rover::drive::{Pilot, Simulation, equal_speed_share, parse_scenario};
use grouser_rover::robot::RobotModel;
use serde_json::Value;

use crate::request::{Problem, Request};

/// Drives the scenario in `scenario` with the robot in `robot`, both as the text of their files; `pilot` and `seed` as
/// of the command.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let document = |name: &str, field: &str| {
        Document::from_text(name, request.text(field)?.to_owned()).map_err(Problem::from_error)
    };
    let robot =
        RobotModel::parse(&document("robot.toml", "robot")?).map_err(Problem::from_error)?;
    let name = request.optional_text("name")?.unwrap_or("scenario");
    let scenario = parse_scenario(&document("scenario.toml", "scenario")?, name, robot)
        .map_err(Problem::from_error)?;
    if scenario.plan.is_some() {
        // its one leg straight to the goal is not the way that the command drives
        return Err(Problem::new(
            "scenario",
            format!(
                "{name} plans its way, which the page does not: `grouser drive SCENARIO --report F.html` drives it and \
                 writes this page with it"
            ),
        ));
    }
    let pilot = match request.optional_text("pilot")? {
        None => Pilot::Controller,
        Some(name) => Pilot::ALL
            .into_iter()
            .find(|pilot| pilot.name() == name)
            .ok_or_else(|| Problem::new("pilot", format!("`{name}` is no driver")))?,
    };
    let seed = match request.optional_number("seed")? {
        Some(_) => u64::from(request.count("seed", u32::MAX)?),
        None => scenario.seed,
    };
    let optimum = scenario.slip_setpoint().map_err(Problem::from_error)?;
    let drive = |scenario, pilot| Simulation::new(scenario, pilot, optimum, seed);
    let scenario = match pilot {
        // the fair baseline, as of the command
        Pilot::OpenLoop => {
            let controlled = drive(&scenario, Pilot::Controller)
                .map_err(Problem::from_error)?
                .run(|_| true);
            let share = equal_speed_share(&controlled, |share| {
                let at_share = scenario.at_pace(share);
                let mut open_loop = Simulation::new(&at_share, Pilot::OpenLoop, optimum, seed)
                    .map_err(Problem::from_error)?;
                Ok::<_, Problem>(open_loop.run(|_| true))
            })?;
            scenario.at_pace(share)
        }
        _ => scenario,
    };
    let mut simulation = drive(&scenario, pilot).map_err(Problem::from_error)?;
    let mut seen = DriveRecorder::default();
    let result = simulation.run(|frame| {
        seen.add(frame);
        true
    });
    Ok(seen.object(&Drive {
        scenario: &scenario,
        pilot,
        seed,
        optimum,
        result: &result,
    }))
}
