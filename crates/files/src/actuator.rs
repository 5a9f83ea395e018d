//! Actuators of the chassis in a robot file: what reconfigures it while it drives.
//!
//! ```toml
//! [[actuator]]
//! name = "left_shoulder"
//! kind = "link"                # turns a link; needs the link's stiffness_nm_per_rad, which the actuator holds
//! link = "left_front"
//! min_deg = -10.0              # about the pose of the file, nose down positive
//! max_deg = 25.0
//! speed_deg_per_s = 6.0
//! power_w = 30.0               # electrical
//! efficiency = 0.5
//!
//! [[actuator]]
//! name = "battery"
//! kind = "mass"                # slides a part of the chassis' mass
//! along = "y"                  # x: forwards, y: to the left, z: up
//! mass_kg = 4.0
//! min_m = -0.1
//! max_m = 0.1
//! speed_m_per_s = 0.02
//! power_w = 20.0
//! ```

use crate::error::Result;
use crate::section::Section;

/// An actuator of the chassis. Positions are in rad of a link or m of a mass, 0 in the pose of the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ActuatorFile {
    /// Its name.
    pub name: String,
    /// What it moves.
    pub moves: ActuatedFile,
    /// Minimum and maximum position.
    pub range: (f64, f64),
    /// Maximum speed, 1/s.
    pub speed: f64,
    /// Maximum electrical power, W.
    pub power: f64,
    /// Share of the electrical power that becomes mechanical.
    pub efficiency: f64,
}

/// What an actuator moves.
#[derive(Clone, Debug, PartialEq)]
pub enum ActuatedFile {
    /// A link, by its name.
    Link(String),
    /// A mass (kg) on the chassis along the axis x, y or z (0, 1 or 2).
    Mass {
        /// 0, 1 or 2.
        axis: usize,
        /// kg.
        mass: f64,
    },
}

/// The keys of `along`.
pub(crate) const AXES: [(&str, usize); 3] = [("x", 0), ("y", 1), ("z", 2)];
/// No link turns further from the pose of the file, degrees. Limit: a right angle.
const MAX_ANGLE_DEG: f64 = 90.0;
/// No mass slides further, m. Limit: the size of a robot.
const MAX_DISTANCE_M: f64 = 10.0;

/// Reads one actuator.
pub(crate) fn read_actuator(section: &Section<'_>) -> Result<ActuatorFile> {
    let is_link = section.choice("kind", &[("link", true), ("mass", false)])?;
    let (moves, range, speed) = if is_link {
        let limits = [
            section.number("min_deg", (-MAX_ANGLE_DEG, 0.0))?,
            section.number("max_deg", (0.0, MAX_ANGLE_DEG))?,
            section.number("speed_deg_per_s", (1e-3, 1e3))?,
        ];
        let [min, max, speed] = limits.map(f64::to_radians);
        let link = section.text("link")?.into();
        (ActuatedFile::Link(link), (min, max), speed)
    } else {
        let axis = section.choice("along", &AXES)?;
        let mass = section.number("mass_kg", (1e-6, 1e6))?;
        let min = section.number("min_m", (-MAX_DISTANCE_M, 0.0))?;
        let max = section.number("max_m", (0.0, MAX_DISTANCE_M))?;
        let speed = section.number("speed_m_per_s", (1e-5, 10.0))?;
        (ActuatedFile::Mass { axis, mass }, (min, max), speed)
    };
    Ok(ActuatorFile {
        name: section.text("name")?.into(),
        moves,
        range,
        speed,
        power: section.number("power_w", (1e-3, 1e6))?,
        efficiency: section
            .optional_number("efficiency", (0.01, 1.0))?
            .unwrap_or(1.0),
    })
}
