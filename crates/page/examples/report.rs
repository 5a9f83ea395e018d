//! A simulated drive as one HTML file on standard output, which plays without a server or network.
//! `cargo run --release -p grouser-page --example report > drive.html`

use std::io::Write as _;

use grouser_page::Document;
use grouser_page::run::{Drive, DriveRecorder};
use grouser_rover::drive::{Pilot, Simulation, read_scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/scenarios/sandbox.toml"
    );
    let scenario = read_scenario(file.as_ref())?;
    let (pilot, optimum, seed) = (Pilot::Controller, scenario.slip_setpoint()?, scenario.seed);
    let mut seen = DriveRecorder::default();
    let result = Simulation::new(&scenario, pilot, optimum, seed)?.run(|frame| {
        seen.add(frame);
        true
    });
    let run = seen.object(&Drive {
        scenario: &scenario,
        pilot,
        seed,
        optimum,
        result: &result,
    });
    let report = serde_json::json!({ "title": scenario.name, "runs": [run] });
    let html = Document::of_report("drive.json", &report).html()?;
    std::io::stdout().write_all(html.as_bytes())?;
    Ok(())
}
