//! The section `[steering]` of a robot file: how one angle steers several wheels.
//!
//! ```toml
//! [steering]
//! kind = "ackermann"
//! wheels = ["front_left", "front_right"]    # the steered ones; one wheel: a tricycle
//! # kind = "articulated"                    # the wheels of a body behind a vertical joint, whose angle it is
//! # joint_x_m = 0.7                         # the joint, forwards of the robot's origin
//! ```

use grouser_slip::{Robot, Wheel};

use crate::error::Result;
use crate::section::Section;
use crate::suggestion::nearest;

/// What one angle does to the steered wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SteeringKind {
    /// All turn about one point on the line of the other wheels, and the angle is that of a wheel in the middle of the
    /// steered axle. With one wheel it is a tricycle.
    Ackermann,
    /// They are on a body of their own, which turns by the angle about a vertical joint: [`Wheel::steers_about`](grouser_slip::Wheel)
    /// is the joint.
    Articulated {
        /// Position of the joint, forwards of the robot's origin, m.
        joint_x: f64,
    },
}

/// Wheels that one angle steers.
#[derive(Clone, Debug, PartialEq)]
pub struct Steering {
    /// What the angle does.
    pub kind: SteeringKind,
    /// The indices of the steered wheels.
    pub wheels: Vec<usize>,
}

/// The origin may be off the line of the wheels that are not steered by this share of the wheelbase: there the robot moves
/// sideways in a bend, which the estimator does not expect.
const MAX_ORIGIN_SHARE: f64 = 0.05;

/// The section, before the robot is known.
pub(crate) struct SteeringSection {
    kind: SteeringKind,
    names: Vec<String>,
}

pub(crate) fn read_section(section: &Section<'_>) -> Result<SteeringSection> {
    let is_articulated = section.choice("kind", &[("ackermann", false), ("articulated", true)])?;
    let kind = if is_articulated {
        let joint_x = section.number("joint_x_m", (-100.0, 100.0))?;
        SteeringKind::Articulated { joint_x }
    } else {
        SteeringKind::Ackermann
    };
    let wheels = section.texts("wheels")?;
    Ok(SteeringSection {
        kind,
        names: wheels.into_iter().map(str::to_owned).collect(),
    })
}

/// Puts the joint of an articulated robot into its wheels.
pub(crate) fn put_joint(section: Option<&SteeringSection>, wheels: &mut [Wheel]) {
    let Some(section) = section else { return };
    if let SteeringKind::Articulated { joint_x } = section.kind {
        for wheel in wheels {
            if section.names.contains(&wheel.name) {
                wheel.steers_about = Some([joint_x, 0.0]);
            }
        }
    }
}

/// Finds the wheels; the message of what is wrong otherwise.
pub(crate) fn resolve(
    section: &SteeringSection,
    robot: &Robot,
) -> std::result::Result<Steering, String> {
    let wheels = robot.wheels();
    let mut steered = Vec::new();
    for name in &section.names {
        let Some(index) = robot.wheel_index(name) else {
            let known = nearest(name, wheels.iter().map(|wheel| wheel.name.as_str()));
            let meant =
                known.map_or_else(String::new, |known| format!("; did you mean \"{known}\"?"));
            return Err(format!("there is no wheel \"{name}\"{meant}"));
        };
        if !steered.contains(&index) {
            steered.push(index);
        }
    }
    if steered.is_empty() || steered.len() >= wheels.len() {
        return Err("`wheels` must name some of the wheels, but not all".into());
    }
    let mean = |is_steered: bool| {
        let chosen = wheels.iter().enumerate();
        let xs = chosen.filter(|(index, _)| steered.contains(index) == is_steered);
        let xs: Vec<f64> = xs.map(|(_, wheel)| wheel.x).collect();
        xs.iter().sum::<f64>() / xs.len() as f64
    };
    let (front, rear) = (mean(true), mean(false));
    if !(rear.abs() <= MAX_ORIGIN_SHARE * (front - rear).abs() && front != rear) {
        return Err(format!(
            "the robot's origin must be on the line of the wheels that are not steered, where it does not move sideways, and \
             the steered ones off it: the mean `x_m` are {rear} and {front}"
        ));
    }
    Ok(Steering {
        kind: section.kind,
        wheels: steered,
    })
}
