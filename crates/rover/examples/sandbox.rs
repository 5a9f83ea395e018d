//! A five-wheeled robot drives over dry sand, open loop and with its slip controller.
//! `cargo run --release -p grouser-rover --example sandbox`

use std::io::Write as _;

use grouser_rover::drive::{Pilot, Simulation, read_scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/scenarios/sandbox.toml"
    );
    let scenario = read_scenario(file.as_ref())?;
    let optimum = scenario.slip_setpoint()?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "the slip setpoint is {optimum:.2}")?;
    for pilot in [Pilot::OpenLoop, Pilot::Controller] {
        let mut drive = Simulation::new(&scenario, pilot, optimum, scenario.seed)?;
        let result = drive.run(|_frame| true);
        writeln!(
            out,
            "{}: {} after {:.1} s and {:.2} m, greatest slip {:.2}, {:.0} J",
            pilot.name(),
            result.outcome.name(),
            result.duration,
            result.distance,
            result.worst_slip,
            result.energy
        )?;
    }
    Ok(())
}
