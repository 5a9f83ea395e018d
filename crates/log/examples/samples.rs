//! Prints the samples of a log: `cargo run --example samples -- LOG [COLUMNS.toml]`; without arguments, the first
//! samples of the five-wheeled robot's log.

use std::io::Write as _;
use std::path::PathBuf;

use grouser_files::{columns, topics::Topics};
use grouser_log::Log;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(PathBuf::from);
    let shipped = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/five-wheel"
    ));
    let (path, map) = match (arguments.next(), arguments.next()) {
        (Some(path), map) => (path, map),
        _ => (shipped.join("log.csv"), Some(shipped.join("columns.toml"))),
    };
    let map = map.map(|map| columns::read(&map)).transpose()?;
    let log = Log::find_any(&[path], map, &Topics::default())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "wheels: {}", log.wheels().join(", "))?;
    for sample in log.samples(&[])?.take(12) {
        let sample = sample?;
        writeln!(out, "{} ns: {:?}", sample.time_ns, sample.measurement)?;
    }
    Ok(())
}
