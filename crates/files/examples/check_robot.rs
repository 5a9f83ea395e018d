//! Checks a robot file and prints it in its shortest form: `cargo run --example check_robot -- ROBOT.toml`.

use std::io::Write as _;
use std::path::PathBuf;

use grouser_files::robot;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shipped = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/kobuki/robot.toml"
    );
    let path = std::env::args_os().nth(1).unwrap_or_else(|| shipped.into());
    let file = robot::read(&PathBuf::from(path))?;
    std::io::stdout().write_all(robot::to_toml(&file).as_bytes())?;
    Ok(())
}
