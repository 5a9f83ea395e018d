//! `robot --stance`: loads, margins and the adjusted posture of a robot at rest.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_report::Table;
use grouser_report::number::{parse_finite, rounded};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{Footing, PostureLimits, StabilityMargins, Standing};
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::input::Input;
use crate::report::{Object, Report};
use crate::session::Session;

#[derive(clap::Args, Debug)]
pub(super) struct Arguments {
    /// Print how the robot stands: loads, margins, tip-over and the adjusted posture
    #[arg(long, conflicts_with = "output")]
    stance: bool,
    /// Slope under the robot in degrees, nose up positive
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_negative_numbers = true, default_value = "0", requires = "stance")]
    pitch_deg: f64,
    /// Slope across the robot in degrees, left side up positive
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_negative_numbers = true, default_value = "0", requires = "stance")]
    roll_deg: f64,
    /// Height of the ground under each wheel in m, in the robot file's order: how its links lie on uneven ground
    #[arg(long, value_name = "M,…", value_parser = parse_finite, allow_negative_numbers = true, value_delimiter = ',', requires = "stance")]
    heights_m: Vec<f64>,
}

/// Stiffness of the ground under a wheel, N/m: dW/dz of dry sand under a wheel of 0.1 m with 50 N; the loads of a robot on
/// rockers hardly depend on it.
const GROUND_STIFFNESS_N_PER_M: f64 = 1e4;

impl Arguments {
    pub(super) const fn is_given(&self) -> bool {
        self.stance
    }
}

pub(super) fn run(path: &Path, arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let mut input = Input::open(path)?;
    std::io::copy(&mut input, &mut std::io::sink())
        .map_err(|error| Error::file("read", path, &error))?;
    session.used_input(input);
    let model = RobotModel::read(path)?;
    let footing = (!arguments.heights_m.is_empty()).then_some(Footing {
        heights: &arguments.heights_m,
        stiffness: GROUND_STIFFNESS_N_PER_M,
    });
    let slope = (
        arguments.pitch_deg.to_radians(),
        arguments.roll_deg.to_radians(),
    );
    let limits = PostureLimits::default();
    let standing = Standing::new(&model, slope, &limits, footing.as_ref())?;
    Ok(Report::done(
        object(&model, arguments, &standing),
        text(&model, &standing),
    ))
}

fn text(model: &RobotModel, standing: &Standing) -> String {
    let mut table = Table::new().text("wheel").number("load, N");
    if standing.stance.is_some() {
        table = table.number("on these heights, N").number("sinkage, m");
    }
    for (index, mount) in model.wheels.iter().enumerate() {
        let mut row = vec![mount.name.clone(), rounded(standing.loads.loads[index], 4)];
        if let Some(stance) = &standing.stance {
            row.push(rounded(stance.loads[index], 4));
            row.push(rounded(stance.sinkages[index], 3));
        }
        table.row(row);
    }
    let mut out = table.render();
    if !standing.loads.stands {
        out.push_str("a negative load would have to hold its wheel down: the robot does not stand like this\n");
    }
    let margins = |what: &str, margins: &StabilityMargins| {
        format!(
            "{what}: tips over after {}° more, {} m inside its support, {} m to lift\n",
            rounded(margins.tip_over.to_degrees(), 3),
            rounded(margins.horizontal, 3),
            rounded(margins.vertical, 3),
        )
    };
    out.push_str(&margins("on the slope", &standing.margins));
    if let Some(stance) = &standing.stance {
        out.push_str(&margins("on these heights", &stance.margins));
    }
    let posture = &standing.posture;
    let [forward, left, down] = posture.moved.map(|part| rounded(part, 3));
    let [lengthen, widen] = posture.factors.map(|factor| rounded(factor, 3));
    let _ = writeln!(
        out,
        "adjusted: centre of gravity {forward} m forwards, {left} m to the left, {down} m down; wheelbase × {lengthen}, \
         stance × {widen}: tips over after {}°, loads differ by {} of their mean (before: {})",
        rounded(posture.tip_over[1].to_degrees(), 3),
        rounded(posture.unevenness[1], 2),
        rounded(posture.unevenness[0], 2),
    );
    out
}

fn object(model: &RobotModel, arguments: &Arguments, standing: &Standing) -> Object {
    let name = |wheel: usize| &model.wheels[wheel].name;
    let margins = |margins: &StabilityMargins| {
        let edges = margins.edges.iter().map(|edge| {
            json!({
                "wheels": edge.wheels.map(name),
                "tip_over_deg": edge.tip_over.to_degrees(),
                "horizontal_m": edge.horizontal,
                "vertical_m": edge.vertical,
            })
        });
        json!({
            "tip_over_deg": margins.tip_over.to_degrees(),
            "horizontal_m": margins.horizontal,
            "vertical_m": margins.vertical,
            "edges": edges.collect::<Vec<_>>(),
        })
    };
    let by_wheel = |values: &[f64]| {
        let pairs = values.iter().enumerate();
        let pairs = pairs.map(|(wheel, value)| (name(wheel).clone(), Value::from(*value)));
        Value::Object(pairs.collect())
    };
    let posture = &standing.posture;
    let stance = standing.stance.as_ref().map(|stance| {
        json!({
            "loads_n": by_wheel(&stance.loads),
            "sinkages_m": by_wheel(&stance.sinkages),
            "pitch_deg": stance.pitch.to_degrees(),
            "roll_deg": stance.roll.to_degrees(),
            "margins": margins(&stance.margins),
            "settled": stance.settled,
        })
    });
    Object::from_iter([
        ("name".to_owned(), Value::from(model.robot.name())),
        ("pitch_deg".to_owned(), Value::from(arguments.pitch_deg)),
        ("roll_deg".to_owned(), Value::from(arguments.roll_deg)),
        ("loads_n".to_owned(), by_wheel(&standing.loads.loads)),
        ("stands".to_owned(), Value::from(standing.loads.stands)),
        ("margins".to_owned(), margins(&standing.margins)),
        (
            "posture".to_owned(),
            json!({
                "forward_m": posture.moved[0],
                "left_m": posture.moved[1],
                "down_m": posture.moved[2],
                "wheelbase_factor": posture.factors[0],
                "stance_factor": posture.factors[1],
                "tip_over_deg": posture.tip_over[1].to_degrees(),
                "load_unevenness": posture.unevenness[1],
                "load_unevenness_before": posture.unevenness[0],
            }),
        ),
        ("on_heights".to_owned(), stance.unwrap_or(Value::Null)),
    ])
}
