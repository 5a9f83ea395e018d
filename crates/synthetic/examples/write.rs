//! Writes the example log and its truth: `cargo run -p grouser-synthetic --example write -- DIR`.

use std::fs;
use std::path::PathBuf;

use grouser_synthetic::FiveWheel;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).ok_or("give a folder")?.into();
    let run = FiveWheel::default().generate();
    fs::write(folder.join("log.csv"), run.log_csv())?;
    fs::write(folder.join("log.mcap"), run.log_mcap()?)?;
    fs::write(folder.join("truth.csv"), run.truth_csv())?;
    Ok(())
}
