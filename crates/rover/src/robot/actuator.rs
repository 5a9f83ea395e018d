//! Actuators of the chassis, and the posture in which they hold it.

use grouser_files::actuator::{ActuatedFile, ActuatorFile};
use grouser_files::body::BodyFile;

use crate::body::Linkage;
use crate::error::{Error, Result, find};
use crate::vector::Vector;

/// Minimum stiffness of a link that an actuator holds, N m/rad: 10 N at an arm of 0.1 m bend it by 1 rad.
const MIN_STIFFNESS_NM_PER_RAD: f64 = 1.0;

/// An actuator of the chassis. Positions are in rad of a link or m of a mass, 0 in the pose of the description.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Actuator {
    /// Its name.
    pub name: String,
    /// What it moves.
    pub moves: Actuated,
    /// Minimum and maximum position.
    pub range: (f64, f64),
    /// Maximum speed, 1/s.
    pub speed: f64,
    /// Maximum electrical power, W.
    pub power: f64,
    /// Share of the electrical power that becomes mechanical.
    pub efficiency: f64,
    /// Where it is now.
    pub position: f64,
}

/// What an actuator moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuated {
    /// A link: its freedom, and +1, or −1 for the other side of a differential.
    Link {
        /// The freedom.
        freedom: usize,
        /// Sign of the link.
        sign: f64,
    },
    /// A mass on the chassis.
    Mass {
        /// The direction of positive positions, a unit vector.
        along: Vector,
        /// kg.
        mass: f64,
    },
}

impl Actuator {
    /// Is it an angle, in rad? Else a distance, in m.
    #[must_use]
    pub const fn is_angle(&self) -> bool {
        matches!(self.moves, Actuated::Link { .. })
    }
}

/// The actuators of a body; the links that they hold become driven.
pub(super) fn actuators(body: &BodyFile, linkage: &mut Linkage) -> Result<Vec<Actuator>> {
    let of_file = |file: &ActuatorFile| {
        let of = format!("actuator \"{}\"", file.name);
        let moves = match &file.moves {
            ActuatedFile::Link(name) => {
                let names = body.links.iter().map(|link| link.name.as_str());
                let link = linkage.links()[find(&of, name, names)?];
                let (freedom, sign) = (link.freedom, link.sign);
                let hold = linkage.holds()[freedom];
                if hold.driven.is_some() {
                    return Err(Error::TooMany {
                        what: "actuators of one link",
                        count: 2,
                        limit: 1,
                    });
                }
                let at_link = format!("link \"{name}\" of {of}");
                let stiff = (MIN_STIFFNESS_NM_PER_RAD, f64::MAX);
                let stiffness = hold.stiffness;
                Error::check(
                    &at_link,
                    "stiffness_nm_per_rad",
                    stiffness,
                    stiff,
                    "N m/rad",
                )?;
                // as the file has them: to 1e-9 deg
                let degrees = |angle: f64| (1e9 * angle.to_degrees()).round() / 1e9;
                let reach = degrees(hold.range);
                for (field, angle) in [("min_deg", file.range.0), ("max_deg", file.range.1)] {
                    Error::check(&of, field, degrees(angle), (-reach, reach), "deg")?;
                }
                linkage.drive(freedom, 0.0);
                Actuated::Link { freedom, sign }
            }
            ActuatedFile::Mass { axis, mass } => {
                Error::check(&of, "mass_kg", *mass, (0.0, body.chassis.mass), "kg")?;
                let along = Vector::AXES[*axis];
                Actuated::Mass { along, mass: *mass }
            }
        };
        Ok(Actuator {
            name: file.name.clone(),
            moves,
            range: file.range,
            speed: file.speed,
            power: file.power,
            efficiency: file.efficiency,
            position: 0.0,
        })
    };
    body.actuators.iter().map(of_file).collect()
}
