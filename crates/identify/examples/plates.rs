//! Moduli of a soil from two plates. `cargo run -p grouser-identify --example plates`

use std::io::Write as _;

use grouser_identify::plate::{Plate, PlateSettings, PlateTest, fit_plates};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // p = (k_c/b + k_phi) zⁿ with n = 1.1, k_c = 1 kN/m^2.1 and k_phi = 1500 kN/m^3.1, read at 40 depths
    let mut tests = Vec::new();
    for diameter in [0.06, 0.10] {
        let plate = Plate::disc(diameter)?;
        let depth: Vec<f64> = (1..=40).map(|i| 1e-3 * f64::from(i)).collect();
        let modulus = 1e3 / plate.width + 1500e3;
        let force = depth
            .iter()
            .map(|z| modulus * z.powf(1.1) * plate.area)
            .collect();
        tests.push(PlateTest {
            name: format!("{} mm disc", 1e3 * diameter),
            plate,
            depth,
            force,
        });
    }
    let found = fit_plates(&tests, &PlateSettings::default())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "n = {:.3}", found.n)?;
    writeln!(
        out,
        "k_c = {:.2} kN/m^(n+1), k_phi = {:.1} kN/m^(n+2)",
        found.k_c / 1e3,
        found.k_phi / 1e3
    )?;
    Ok(())
}
