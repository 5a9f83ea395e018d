//! A wheel by the libraries alone: its slip of best efficiency under a load.
//! `cargo run -p grouser --no-default-features --example library`

use std::io::Write as _;

use grouser::terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let soil = catalogue::find("dry-sand").ok_or("no such soil")?.soil()?;
    let wheel = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "slip  sinkage mm  pull N  efficiency")?;
    for slip in (1..=9).map(|tenths| f64::from(tenths) / 10.0) {
        let solution = wheel.under_load(60.0, &Kinematics::straight(Slip::new(slip)?))?;
        let point = solution.point().ok_or("no sinkage carries the load")?;
        writeln!(
            out,
            "{slip:4.1}  {:10.1}  {:6.1}  {:10.3}",
            1e3 * point.sinkage,
            point.forces.drawbar_pull,
            point
                .tractive_efficiency()
                .ok_or("the wheel does not turn")?
        )?;
    }
    Ok(())
}
