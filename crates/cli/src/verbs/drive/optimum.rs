//! The slip that the controller runs at: the running-slip problem for this wheel, load and soil.

use std::fmt::Write as _;
use std::ops::ControlFlow;

use grouser_design::{Answer, parse};
use grouser_files::Document;
use grouser_rover::drive::Scenario;
use grouser_terra::Pressure;

use crate::error::{Error, Result};

/// The slip of the greatest tractive efficiency that leaves a reserve of three degrees, or none where the soil has none.
const PROBLEM: &str = "\
format = 1
title = \"The slip to run at\"
method = \"minimax\"
[variables]
slip = { start = 0.2, lower = 0.01, upper = 0.8 }
[objectives]
efficiency = \"-tractive_efficiency\"
";

/// Solves it.
pub(crate) fn running_slip(scenario: &Scenario) -> Result<f64> {
    let lacks = |what: &str| {
        Error::usage(
            format!("the slip to run at cannot be found: {what}"),
            "give `optimum` under `[control]` in the scenario",
        )
    };
    let (wheel, load) = scenario
        .typical_wheel()
        .ok_or_else(|| lacks("the robot has no powered wheel"))?;
    let rigid = scenario.robot.wheels[wheel].wheel;
    let soil = scenario.ground.soils[0].soil.params();
    let Pressure::Bekker(law) = soil.pressure else {
        return Err(lacks("the soil is not described by Bekker's moduli"));
    };
    let mut text = PROBLEM.to_owned();
    let rows = [
        ("[wheel]\nradius_m", rigid.radius()),
        ("width_m", rigid.width()),
        ("[soil]\nn", soil.n),
        ("n_1", soil.n_1),
        ("n_2", soil.n_2),
        ("k_c_kn_per_m_n1", law.k_c / 1e3),
        ("k_phi_kn_per_m_n2", law.k_phi / 1e3),
        ("cohesion_kpa", soil.cohesion / 1e3),
        ("phi_deg", soil.phi.deg()),
        ("k_shear_m", soil.k_shear),
        ("c_1", soil.c_1),
        ("c_2", soil.c_2),
        ("rebound", soil.rebound),
        ("[state]\nload_n", load),
    ];
    for (key, value) in rows {
        // writing to a string cannot fail
        let _ = writeln!(text, "{key} = {value:?}");
    }
    let document = Document::from_text("the running-slip problem", text)?;
    let design = parse(&document).map_err(|error| lacks(&error.to_string()))?;
    let answer = design
        .solve(&mut |_| ControlFlow::Continue(()))
        .map_err(|error| lacks(&error.to_string()))?;
    match answer {
        Answer::Optimum(optimum) => optimum
            .x
            .first()
            .copied()
            .ok_or_else(|| lacks("it has no variable")),
        _ => Err(lacks("it has several answers")),
    }
}
