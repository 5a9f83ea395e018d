//! The robot's computer driven by a recorded log: what it would have known and commanded.
//!
//! ```text
//! cargo run --release -p grouser-replay --example onboard_log
//! ```

use std::io::Write as _;
use std::path::Path;

use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_slip::control::Request;
use grouser_slip::onboard::{OnBoard, OnBoardSettings};

/// The control loop runs at 50 Hz, as the log's rows come.
const PERIOD_NS: i64 = 20_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/five-wheel");
    let file = robot::read(&folder.join("robot.toml"))?;
    let map = columns::read(&folder.join("columns.toml"))?;
    let log = Log::find(&[folder.join("log.csv")], map)?;

    // samples name their wheels by the log's columns, which here have the robot's order
    let names = file.robot.wheels().iter().map(|wheel| &wheel.name);
    assert!(names.eq(log.wheels()), "the columns have another order");
    let mut settings = OnBoardSettings::new(&file.robot);
    settings.filter = file.filter;
    let mut on_board = OnBoard::new(&file.robot, settings)?;
    let request = Request {
        speed: 0.3,
        heading: 0.0,
        yaw_rate: None,
    };
    let mut out = std::io::stdout().lock();
    let mut next_tick = None;
    for sample in log.samples(&[])? {
        let sample = sample?;
        let due = *next_tick.get_or_insert(sample.time_ns);
        if sample.time_ns > due {
            on_board.tick(due, request);
            next_tick = Some(due + PERIOD_NS);
            if due % 2_000_000_000 == 0 {
                let line = state(&file.robot, &on_board);
                writeln!(out, "{:>5.1} s  {line}", due as f64 * 1e-9)?;
            }
        }
        on_board.update(sample);
    }
    let slip = on_board.observations()[0].slip;
    writeln!(out, "slip of the first wheel at the end: {slip:?}")?;
    Ok(())
}

/// The first wheel, and what the computer does.
fn state(robot: &grouser_slip::Robot, on_board: &OnBoard) -> String {
    let wheel = on_board.observations()[0];
    let slip = wheel.slip.map_or("—".into(), |slip| format!("{slip:.3}"));
    let (name, mode) = (&robot.wheels()[0].name, on_board.mode().name());
    format!("{name}: slip {slip}, {}, {mode}", wheel.health)
}
