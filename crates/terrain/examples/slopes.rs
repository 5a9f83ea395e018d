//! What a six-wheeled robot needs on slopes of dry sand: slip, energy and sinkage.
//! `cargo run --release -p grouser-terrain --example slopes`

use std::io::Write as _;

use grouser_rover::robot::RobotModel;
use grouser_terra::catalogue;
use grouser_terrain::{Demand, DemandSolver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/rocker-bogie.toml"
    );
    let soil = catalogue::find("dry-sand").ok_or("no such soil")?.soil()?;
    let solver = DemandSolver::new(RobotModel::read(file.as_ref())?, soil)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "slope °   slip  energy J/m  sinkage mm")?;
    for degrees in (-5..=20).step_by(5).map(f64::from) {
        match solver.demand(degrees.to_radians(), 0.0)? {
            Demand::Drives(driving) => writeln!(
                out,
                "{degrees:7}  {:5.2}  {:10.1}  {:10.1}",
                driving.slip,
                driving.energy_per_metre(),
                1e3 * driving.sinkage
            )?,
            other => writeln!(out, "{degrees:7}  {other:?}")?,
        }
    }
    Ok(())
}
