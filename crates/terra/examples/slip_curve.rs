//! Pull, torque and sinkage of a wheel over slip. `cargo run -p grouser-terra --example slip_curve`

use std::io::Write as _;

use grouser_terra::{BatchColumns, BatchKernel, RigidWheel, SolveStatus, catalogue};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const POINTS: usize = 10;
    let soil = catalogue::find("lunar").ok_or("no such soil")?.soil()?;
    let wheel = RigidWheel::new(0.125, 0.15)?; // radius and width, m
    let slip: [f64; POINTS] = core::array::from_fn(|i| i as f64 / POINTS as f64);
    let [
        mut sinkage,
        mut vertical_force,
        mut drawbar_pull,
        mut torque,
    ] = [[0.0; POINTS]; 4];
    let mut status = [SolveStatus::default(); POINTS];
    let mut columns = BatchColumns {
        sinkage: &mut sinkage,
        vertical_force: &mut vertical_force,
        drawbar_pull: &mut drawbar_pull,
        torque: &mut torque,
        status: &mut status,
    };
    BatchKernel::new(soil).curve(&wheel, 65.0, &slip, &mut columns)?; // 65 N
    let mut out = std::io::stdout().lock();
    writeln!(out, "slip  sinkage mm   pull N  torque N m  status")?;
    for i in 0..POINTS {
        writeln!(
            out,
            "{:4.1}  {:10.2}  {:7.2}  {:10.3}  {}",
            slip[i],
            1e3 * sinkage[i],
            drawbar_pull[i],
            torque[i],
            status[i].key()
        )?;
    }
    Ok(())
}
