//! The section `[steering]` of a robot file: how one angle steers several wheels.
//!
//! ```toml
//! [steering]
//! kind = "ackermann"
//! wheels = ["front_left", "front_right"]    # the steered ones; one wheel: a tricycle
//! ```

use grouser_slip::Robot;

use crate::error::Result;
use crate::section::Section;
use crate::suggestion::nearest;

/// Wheels that one angle steers: all turn about one point on the line of the other wheels, and the angle is that of a wheel in
/// the middle of the steered axle. With one wheel it is a tricycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Steering {
    /// The indices of the steered wheels.
    pub wheels: Vec<usize>,
}

/// The origin may be off the line of the wheels that are not steered by this share of the wheelbase: there the robot moves
/// sideways in a bend, which the estimator does not expect.
const MAX_ORIGIN_SHARE: f64 = 0.05;

/// The names of the steered wheels, before the robot is known.
pub(crate) fn read_names(section: &Section<'_>) -> Result<Vec<String>> {
    section.choice("kind", &[("ackermann", ())])?;
    let wheels = section.texts("wheels")?;
    Ok(wheels.into_iter().map(str::to_owned).collect())
}

/// Finds the wheels; the message of what is wrong otherwise.
pub(crate) fn resolve(names: &[String], robot: &Robot) -> std::result::Result<Steering, String> {
    let wheels = robot.wheels();
    let mut steered = Vec::new();
    for name in names {
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
    Ok(Steering { wheels: steered })
}
