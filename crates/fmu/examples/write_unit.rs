//! Writes a unit: `cargo run --example write_unit LIBRARY UNIT.fmu`. Without arguments it prints the size of a unit without a
//! library.

use std::io::Write as _;

use grouser_fmu::{Model, package};
use grouser_terra::{RigidWheel, catalogue};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let soil = catalogue::find("dry-sand").ok_or("no such soil")?.soil()?;
    let model = Model::new(RigidWheel::new(0.125, 0.1)?, soil, [80.0, 0.2, 0.0])?;
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let library = match arguments.first() {
        Some(library) => std::fs::read(library)?,
        None => Vec::new(),
    };
    let unit = package(&model, "wheel", ("dry sand", "the catalogue"), &library)?;
    match arguments.get(1) {
        Some(file) => std::fs::write(file, unit)?,
        None => writeln!(std::io::stdout(), "{} bytes", unit.len())?,
    }
    Ok(())
}
