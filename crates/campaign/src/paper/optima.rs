//! The four slips that are called optimal: what each optimises, on which soil, under which load.

use grouser_design::{Answer, parse};
use grouser_files::Document;
use grouser_report::number::{exact, rounded};
use grouser_report::{Fields, fields};
use grouser_rover::drive::Scenario;
use grouser_terra::{BestSlip, RigidWheel, Settings, Soil, WheelOnSoil};

use super::problem::PRINTED_SLIP;
use crate::error::Result;

/// The slope that the setpoint of a robot on the level keeps within reach, degrees.
const RESERVE_DEG: f64 = 3.0;

/// A slip that is called optimal.
#[derive(Clone, Debug, PartialEq)]
pub struct SlipOptimum {
    /// Its name.
    pub name: &'static str,
    /// What it optimises.
    pub optimises: String,
    /// Wheel, soil and load that it holds for.
    pub of: String,
    /// The slip; `None` where there is none.
    pub slip: Option<f64>,
    /// What computes it.
    pub command: String,
}

/// The problem file of the slip of maximum tractive efficiency of a wheel under `load` (N) on the soil `key` of the
/// catalogue, with a slope of `reserve_deg` within reach where one is stated.
///
/// ```
/// use grouser_campaign::paper::setpoint_problem;
/// use grouser_terra::RigidWheel;
///
/// let text = setpoint_problem(&RigidWheel::new(0.15, 0.12)?, "dry-sand", 28.0, None);
/// assert!(text.contains("tractive_efficiency"));
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[must_use]
pub fn setpoint_problem(
    wheel: &RigidWheel,
    key: &str,
    load: f64,
    reserve_deg: Option<f64>,
) -> String {
    let constraint = reserve_deg.map_or_else(String::new, |slope| {
        format!("\n[constraints]\nreserve = \"gradeability_deg >= {slope:?}\"\n")
    });
    format!(
        "# The slip setpoint of the robot's powered wheels: maximum tractive efficiency.\n\
         format = 1\ntitle = \"The slip of maximum tractive efficiency\"\nmethod = \"minimax\"\n\n\
         [variables]\nslip = {{ start = 0.2, lower = 0.01, upper = 0.8 }}\n\n\
         [wheel]\nradius_m = {}\nwidth_m = {}\n\n[soil]\nkey = \"{key}\"\n\n[state]\nload_n = {}\n\n\
         [objectives]\nefficiency = {{ maximise = \"tractive_efficiency\" }}\n{constraint}",
        exact(wheel.radius()),
        exact(wheel.width()),
        exact(load)
    )
}

/// A wheel in words.
fn wheel_under(wheel: &RigidWheel, load: f64, key: &str) -> String {
    format!(
        "wheel of {} by {} mm under {} N on {key}",
        rounded(1e3 * wheel.radius(), 3),
        rounded(1e3 * wheel.width(), 3),
        rounded(load, 3)
    )
}

/// The slip that solves a problem of [`setpoint_problem`].
fn solved(text: &str) -> Result<Option<f64>> {
    let document = Document::from_text("the slip setpoint", text.to_owned())?;
    Ok(match parse(&document)?.solve()? {
        Answer::Optimum(optimum) if optimum.status.is_solved() => optimum.x.first().copied(),
        _ => None,
    })
}

/// The four optima, three of them for the typical powered wheel of a scenario.
///
/// # Errors
/// What the laws or the problem refuse.
pub(super) fn optima(scenario: &Scenario) -> Result<Vec<SlipOptimum>> {
    let (Some((index, load)), Some(ground)) =
        (scenario.typical_wheel(), scenario.ground.soils.first())
    else {
        return Ok(Vec::new());
    };
    let (wheel, soil): (RigidWheel, Soil) = (scenario.robot.wheels[index].wheel, ground.soil);
    let key = ground.name.as_str();
    let pair = WheelOnSoil::new(wheel, soil, Settings::default())?;
    let value = |best: Option<BestSlip>| best.map(|best| best.slip.value());
    let efficient = value(pair.slip_of_maximum_efficiency(load)?);
    let pulling = value(pair.slip_of_maximum_pull(load)?);
    // the wheel of examples/problems/running-slip.toml, whose load is that of a heavier robot
    let heavy = (RigidWheel::new(0.125, 0.10)?, 60.0);
    let reserve = solved(&setpoint_problem(
        &heavy.0,
        "dry-sand",
        heavy.1,
        Some(RESERVE_DEG),
    ))?;
    let own_reserve = solved(&setpoint_problem(&wheel, key, load, Some(RESERVE_DEG)))?;
    let of = wheel_under(&wheel, load, key);
    let curve = format!(
        "grouser wheel --soil {key} --radius-m {} --width-m {} --load-n {} --slip 0:0.9",
        exact(wheel.radius()),
        exact(wheel.width()),
        rounded(load, 3)
    );
    Ok(vec![
        SlipOptimum {
            name: "the paper's",
            optimises: "τ_max, T(θ) and S_0 by minimax over wheel, soil and sinkage: no slip of a running wheel".to_owned(),
            of: "the soil is part of the variables; no load; printed in the paper, not reproduced".to_owned(),
            slip: Some(PRINTED_SLIP),
            command: "grouser paper".to_owned(),
        },
        SlipOptimum {
            name: "maximum efficiency",
            optimises: "tractive efficiency: the setpoint of the controller".to_owned(),
            of: of.clone(),
            slip: efficient,
            command: curve.clone(),
        },
        SlipOptimum {
            name: "running slip",
            optimises: format!(
                "tractive efficiency with a slope of 3° within reach; {} for the robot's wheel, where the slope decides nothing",
                own_reserve.map_or_else(|| "none".to_owned(), |slip| rounded(slip, 4))
            ),
            of: wheel_under(&heavy.0, heavy.1, "dry-sand"),
            slip: reserve,
            command: "grouser optimize examples/problems/running-slip.toml".to_owned(),
        },
        SlipOptimum {
            name: "maximum pull",
            optimises: "drawbar pull, at any energy".to_owned(),
            of,
            slip: pulling,
            command: curve,
        },
    ])
}

impl SlipOptimum {
    /// The same for programs.
    #[must_use]
    pub fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |optimum: &'a Self|
            "name" "name" = optimum.name;
            "slip" "slip" = optimum.slip;
            "optimises" "what it optimises" = optimum.optimises.as_str();
            "of" "wheel, soil and load" = optimum.of.as_str();
            "command" "what computes it" = optimum.command.as_str();
        }
    }

    /// A row of a table.
    pub(super) fn row(&self) -> Vec<String> {
        let slip = self
            .slip
            .map_or_else(|| "-".to_owned(), |slip| rounded(slip, 4));
        vec![
            self.name.to_owned(),
            slip,
            self.optimises.clone(),
            self.of.clone(),
            format!("`{}`", self.command),
        ]
    }

    pub(super) const HEADER: [&'static str; 5] = [
        "optimum",
        "slip",
        "what it optimises",
        "wheel, soil, load",
        "command",
    ];
}
