//! The stress under a wheel as SVG on standard output. `cargo run -p grouser-campaign --example stress > stress.svg`

use std::io::Write as _;

use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let soil = catalogue::find("lunar").ok_or("no such soil")?.soil()?;
    let wheel = RigidWheel::new(0.125, 0.15)?; // radius and width, m
    let contact = WheelOnSoil::new(wheel, soil, Settings::default())?;
    let motion = Kinematics::straight(Slip::new(0.25)?);
    let solution = contact.under_load(65.0, &motion)?;
    let point = solution.point().ok_or("nothing carries 65 N")?;
    let figure = grouser_campaign::stress::draw(&contact, &point, "lunar");
    std::io::stdout().write_all(figure.svg().as_bytes())?;
    Ok(())
}
