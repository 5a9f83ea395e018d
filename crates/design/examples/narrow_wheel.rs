//! The narrowest wheel that still climbs 5 degrees on dry sand. `cargo run -p grouser-design --example narrow_wheel`

use std::io::Write as _;

use grouser_design::{Answer, Design, State};
use grouser_opt::Variable;
use grouser_terra::{RigidWheel, catalogue};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let soil = catalogue::find("dry-sand").ok_or("no such soil")?.soil()?;
    let wheel = RigidWheel::new(0.125, 0.10)?; // radius and width, m
    let design = Design::builder(&wheel, &soil, State::under_load(60.0)) // N
        .variable(Variable::bounded("width_m", 0.10, 0.03, 0.20))
        .variable(Variable::bounded("slip", 0.3, 0.02, 0.8))
        .minimise("width", "width_m")
        .constraint("climbs", "gradeability_deg >= 5")
        .starts(8, 1)
        .build()?;
    let mut out = std::io::stdout().lock();
    if let Answer::Optimum(optimum) = design.solve()? {
        for (variable, x) in design.variables.iter().zip(&optimum.x) {
            writeln!(out, "{} = {x:.4}", variable.name)?;
        }
        writeln!(
            out,
            "{} from {} starts",
            optimum.status.name(),
            optimum.starts.len()
        )?;
    }
    Ok(())
}
