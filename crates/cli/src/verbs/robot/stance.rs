//! `robot --stance`: loads, margins and the adjusted posture of a robot at rest.

use std::path::Path;

use grouser_report::number::{parse_finite, rounded, shown};
use grouser_report::{Fields, Table, fields};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{
    Edge, Footing, Posture, PostureLimits, StabilityMargins, Stance, Standing,
};

use crate::error::Result;
use crate::input;
use crate::session::Session;
use crate::verb_report::Report;
use crate::wheel_choice::GravityArgument;

// No group: it would have the name of the group of the verb's own arguments.
#[derive(clap::Args, Debug)]
#[group(skip)]
pub(super) struct Arguments {
    /// Print the static posture: loads, margins, tip-over and the adjusted posture
    #[arg(long, conflicts_with = "output")]
    stance: bool,
    /// Slope under the robot in degrees, nose up positive
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true, default_value = "0", requires = "stance")]
    pitch_deg: f64,
    /// Slope across the robot in degrees, left side up positive
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true, default_value = "0", requires = "stance")]
    roll_deg: f64,
    /// Height of the ground under each wheel in m, in the robot file's order: the posture of its links on uneven ground
    #[arg(long, value_name = "M,M", value_parser = parse_finite, allow_hyphen_values = true, value_delimiter = ',', requires = "stance")]
    heights_m: Vec<f64>,
    #[command(flatten)]
    gravity: GravityArgument,
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
    session.used_file(path)?;
    let model = arguments.gravity.of(input::robot(path)?);
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
        fields().object((&model, arguments, &standing)),
        text(&model, &standing),
    ))
}

fn text(model: &RobotModel, standing: &Standing) -> String {
    let mut out = margins_text("on the slope", &standing.margins);
    if !standing.loads.stands {
        out.push_str("WARNING: a negative load would have to hold its wheel down: the robot is not stable in this posture\n");
    }
    if let Some(stance) = &standing.stance {
        out.push_str(&margins_text("on these heights", &stance.margins));
    }
    out + &posture_text(&standing.posture) + "\n" + &loads_text(model, standing)
}

fn loads_text(model: &RobotModel, standing: &Standing) -> String {
    let mut table = Table::new().text("wheel").number("load N");
    if standing.stance.is_some() {
        table = table.number("on these heights N").number("sinkage m");
    }
    for (index, mount) in model.wheels.iter().enumerate() {
        let mut row = vec![mount.name.clone(), shown(standing.loads.loads[index])];
        if let Some(stance) = &standing.stance {
            row.push(shown(stance.loads[index]));
            row.push(shown(stance.sinkages[index]));
        }
        table.row(row);
    }
    table.render()
}

fn margins_text(what: &str, margins: &StabilityMargins) -> String {
    format!(
        "{what}: tip-over margin {}°, centre of gravity {} m inside the support, {} m to be raised\n",
        shown(margins.tip_over.to_degrees()),
        shown(margins.horizontal),
        shown(margins.vertical),
    )
}

fn posture_text(posture: &Posture) -> String {
    let [forward, left, down] = posture.moved.map(shown);
    let [lengthen, widen] = posture.factors.map(shown);
    format!(
        "adjusted posture: centre of gravity {forward} m forwards, {left} m to the left, {down} m down; wheelbase × {lengthen}, \
         width × {widen}: tip-over margin {}°, standard deviation of the loads {} of their mean (before: {})\n",
        shown(posture.tip_over[1].to_degrees()),
        rounded(posture.unevenness[1], 2),
        rounded(posture.unevenness[0], 2),
    )
}

/// The robot at rest, and the arguments.
type Rest<'a> = (&'a RobotModel, &'a Arguments, &'a Standing);

pub(super) fn fields<'a>() -> Fields<'a, Rest<'a>> {
    fields! { |rest: Rest<'a>|
        "name" "name of the robot" = rest.0.robot.name();
        "pitch_deg" "slope under the robot, nose up" = rest.1.pitch_deg;
        "roll_deg" "slope across the robot, left side up" = rest.1.roll_deg;
        "loads_n" "load of each wheel" values = Some(by_wheel(rest.0, &rest.2.loads.loads));
        "stands" "does no wheel need to be held down" = rest.2.loads.stands;
        "margins" "margins against tipping over" group(margins()) = (rest.0, &rest.2.margins);
        "posture" "the chassis adjusted for the slope" group(posture()) = &rest.2.posture;
        "on_heights" "the robot on the given heights" group(on_heights()) =
            rest.2.stance.as_ref().map(|stance| (rest.0, stance));
    }
}

fn by_wheel<'a>(model: &'a RobotModel, values: &'a [f64]) -> impl Iterator<Item = (&'a str, f64)> {
    let names = model.wheels.iter().map(|mount| mount.name.as_str());
    names.zip(values.iter().copied())
}

fn margins<'a>() -> Fields<'a, (&'a RobotModel, &'a StabilityMargins)> {
    fields! { |of: (&'a RobotModel, &'a StabilityMargins)|
        "tip_over_deg" "tip-over margin" = of.1.tip_over.to_degrees();
        "horizontal_m" "minimum distance of the plumb line from the support's edges" = of.1.horizontal;
        "vertical_m" "minimum height to which the centre of gravity must be raised" = of.1.vertical;
        "edges" "the edges of the support" rows(edge()) =
            of.1.edges.iter().map(move |edge| (of.0, edge));
    }
}

fn edge<'a>() -> Fields<'a, (&'a RobotModel, &'a Edge)> {
    fields! { |of: (&'a RobotModel, &'a Edge)|
        "wheels" "the wheels that stay on the ground" =
            of.1.wheels.iter().map(|wheel| of.0.wheels[*wheel].name.clone()).collect::<Vec<_>>();
        "tip_over_deg" "angle to tipping over it" = of.1.tip_over.to_degrees();
        "horizontal_m" "distance of the plumb line from it" = of.1.horizontal;
        "vertical_m" "height to which the centre of gravity must be raised" = of.1.vertical;
    }
}

fn posture<'a>() -> Fields<'a, &'a Posture> {
    fields! { |posture: &'a Posture|
        "forward_m" "displacement of the centre of gravity forwards" = posture.moved[0];
        "left_m" "to the left" = posture.moved[1];
        "down_m" "and down" = posture.moved[2];
        "wheelbase_factor" "factor of the wheelbase" = posture.factors[0];
        "stance_factor" "factor of the stance" = posture.factors[1];
        "tip_over_deg" "angle to tipping over" = posture.tip_over[1].to_degrees();
        "load_unevenness" "standard deviation of the loads over their mean" = posture.unevenness[1];
        "load_unevenness_before" "the same before" = posture.unevenness[0];
    }
}

fn on_heights<'a>() -> Fields<'a, (&'a RobotModel, &'a Stance)> {
    fields! { |of: (&'a RobotModel, &'a Stance)|
        "loads_n" "load of each wheel" values = Some(by_wheel(of.0, &of.1.loads));
        "sinkages_m" "sinkage of each wheel; negative: it hangs" values = Some(by_wheel(of.0, &of.1.sinkages));
        "pitch_deg" "pitch of the chassis, nose up" = of.1.pitch.to_degrees();
        "roll_deg" "roll of the chassis, left side up" = of.1.roll.to_degrees();
        "margins" "margins against tipping over" group(margins()) = (of.0, &of.1.margins);
        "settled" "do all forces balance" = of.1.settled;
    }
}
