//! What a robot file says of the robot's body, for simulation: masses, links, motors. All of it may be left out.
//!
//! ```toml
//! [chassis]
//! mass_kg = 9.0
//! cg_x_m = 0.0                 # centre of gravity; z from the ground on which the wheels stand
//! cg_y_m = 0.0
//! cg_z_m = 0.25
//! inertia_xx_kg_m2 = 0.20
//! inertia_yy_kg_m2 = 0.35
//! inertia_zz_kg_m2 = 0.45
//!
//! [[link]]                     # a rocker, bogie or arm: turns about an axis across the robot
//! name = "left_rocker"
//! on = "chassis"               # or another link
//! pivot_x_m = 0.0
//! pivot_y_m = 0.25
//! pivot_z_m = 0.20
//! mass_kg = 0.8
//! opposite = "right_rocker"    # a differential: the other's angle is the negative of this one's
//! stiffness_nm_per_rad = 0.0   # about the pose of the file; with damping_nms_per_rad and preload_nm
//! range_deg = 25.0
//!
//! [[motor]]
//! name = "drive"
//! resistance_ohm = 0.6
//! constant_nm_per_a = 0.03
//! voltage_v = 24.0
//! current_a = 6.0
//! rotor_inertia_kg_m2 = 6e-6
//! gear_efficiency = 0.85
//!
//! [[wheel]]                    # beside what the estimator reads
//! on = "left_rocker"           # the chassis by default
//! z_m = 0.15                   # centre above the ground; its radius by default
//! mass_kg = 0.7
//! spin_inertia_kg_m2 = 0.008
//! motor = "drive"
//! bearing_nm = 0.0
//! camber_deg = 0.0             # leans: top to the left
//! caster_deg = 0.0             # steering axis leans back
//! steer_range_deg = 0.0        # 0: not steered
//! steer_rate_deg_per_s = 60.0
//! ```

use grouser_slip::onboard::{CarrierLink, MAX_CARRIER_LINKS, WheelCarrier};
use grouser_slip::{Robot, Wheel};

use crate::actuator::{ActuatorFile, read_actuator};
use crate::error::{Error, Result};
use crate::section::Section;
use crate::suspension::SuspensionJoint;

/// The body of a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyFile {
    /// The chassis without its links and wheels.
    pub chassis: MassFile,
    /// Links in the order of the file.
    pub links: Vec<LinkFile>,
    /// Motors in the order of the file.
    pub motors: Vec<MotorFile>,
    /// Actuators of the chassis in the order of the file.
    pub actuators: Vec<ActuatorFile>,
    /// One for each wheel of the robot, in its order.
    pub wheels: Vec<WheelBody>,
}

/// A mass: kg, m, kg m² about its own centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MassFile {
    /// kg.
    pub mass: f64,
    /// Centre of gravity, m.
    pub centre: [f64; 3],
    /// xx, yy, zz in kg m².
    pub inertia: [f64; 3],
}

/// A link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkFile {
    /// Its name.
    pub name: String,
    /// The link that carries it; `None`: the chassis.
    pub on: Option<String>,
    /// Its pivot, m.
    pub pivot: [f64; 3],
    /// Its mass, without wheels and links that it carries.
    pub mass: MassFile,
    /// The link that a differential turns the other way.
    pub opposite: Option<String>,
    /// N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    pub damping: f64,
    /// N m, positive presses the front of the link down.
    pub preload: f64,
    /// How far it turns either way, rad.
    pub range: f64,
}

/// A DC motor.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotorFile {
    /// Its name.
    pub name: String,
    /// Ω.
    pub resistance: f64,
    /// N m/A, and V s/rad.
    pub constant: f64,
    /// Greatest voltage, V.
    pub voltage: f64,
    /// Greatest current, A.
    pub current: f64,
    /// kg m².
    pub rotor_inertia: f64,
    /// Share of the torque that the gear passes on.
    pub gear_efficiency: f64,
}

/// What a wheel is to the body.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WheelBody {
    /// The link that carries it; `None`: the chassis.
    pub on: Option<String>,
    /// Height of its centre above the ground, m; `None`: its radius.
    pub z: Option<f64>,
    /// kg.
    pub mass: f64,
    /// About its axle, kg m²; `None`: that of a thin ring of its mass.
    pub spin_inertia: Option<f64>,
    /// Its motor.
    pub motor: Option<String>,
    /// Friction of its bearing, N m.
    pub bearing: f64,
    /// rad, top to the left.
    pub camber: f64,
    /// rad.
    pub caster: f64,
    /// rad; 0: not steered.
    pub steer_range: f64,
    /// rad/s.
    pub steer_rate: f64,
}

impl BodyFile {
    /// For each link the number of the joint that turns it, and +1 or -1 where the joint's angle turns it nose down or up: links that
    /// a differential joins share one joint.
    #[must_use]
    pub fn joints(&self) -> Vec<(usize, f64)> {
        let mut joints: Vec<(usize, f64)> = Vec::with_capacity(self.links.len());
        let mut count = 0;
        for link in &self.links {
            let before = &self.links[..joints.len()];
            let other = (link.opposite.as_ref())
                .and_then(|other| before.iter().position(|link| link.name == *other));
            joints.push(if let Some(other) = other {
                let (joint, sign) = joints[other];
                (joint, -sign)
            } else {
                count += 1;
                (count - 1, 1.0)
            });
        }
        joints
    }

    /// Its joints, by the links that they turn.
    pub(crate) fn suspension(&self) -> Vec<SuspensionJoint> {
        let links = self.links.iter().zip(self.joints());
        let named = links.map(|(link, (joint, sign))| SuspensionJoint {
            link: link.name.clone(),
            joint,
            sign,
        });
        named.collect()
    }

    /// What carries each wheel of the robot. A link that is not described carries like the chassis.
    #[must_use]
    pub fn carriers(&self, robot: &Robot) -> Vec<WheelCarrier> {
        let joints = self.joints();
        let of_wheel = |(wheel, body): (&Wheel, &WheelBody)| {
            let mut chain = Vec::new();
            let mut on = body.on.as_ref();
            while let Some(index) =
                on.and_then(|on| self.links.iter().position(|link| link.name == *on))
                && chain.len() < MAX_CARRIER_LINKS
            {
                let link = &self.links[index];
                let (joint, sign) = joints[index];
                let pivot = [link.pivot[0], link.pivot[2]];
                chain.push(CarrierLink { joint, sign, pivot });
                on = link.on.as_ref();
            }
            let centre = [wheel.x, body.z.unwrap_or(wheel.radius)];
            (chain.into_iter().rev())
                .fold(WheelCarrier::on_chassis(centre), WheelCarrier::with_link)
        };
        robot
            .wheels()
            .iter()
            .zip(&self.wheels)
            .map(of_wheel)
            .collect()
    }
}

const LENGTH: (f64, f64) = (-100.0, 100.0);
const MASS: (f64, f64) = (1e-6, 1e6);
const INERTIA: (f64, f64) = (1e-12, 1e9);

/// Reads the body's tables; `None` where the file has no chassis.
pub(crate) fn read(root: &Section<'_>, wheels: Vec<WheelBody>) -> Result<Option<BodyFile>> {
    let chassis = root.section("chassis", |section| {
        Ok::<_, Error>(MassFile {
            mass: section.number("mass_kg", MASS)?,
            centre: point(section, ["cg_x_m", "cg_y_m", "cg_z_m"])?,
            inertia: inertia(section)?,
        })
    })?;
    let links = root.sections("link", read_link)?;
    let motors = root.sections("motor", read_motor)?;
    let actuators = root.sections("actuator", read_actuator)?;
    Ok(chassis.map(|chassis| BodyFile {
        chassis,
        links,
        motors,
        actuators,
        wheels,
    }))
}

fn point(section: &Section<'_>, keys: [&'static str; 3]) -> Result<[f64; 3]> {
    Ok([
        section.number(keys[0], LENGTH)?,
        section.number(keys[1], LENGTH)?,
        section.number(keys[2], LENGTH)?,
    ])
}

fn inertia(section: &Section<'_>) -> Result<[f64; 3]> {
    Ok([
        section.number("inertia_xx_kg_m2", INERTIA)?,
        section.number("inertia_yy_kg_m2", INERTIA)?,
        section.number("inertia_zz_kg_m2", INERTIA)?,
    ])
}

fn carrier(section: &Section<'_>) -> Result<Option<String>> {
    let on = section.optional_text("on")?;
    Ok(on.filter(|on| *on != "chassis").map(Into::into))
}

fn read_link(section: &Section<'_>) -> Result<LinkFile> {
    let pivot = point(section, ["pivot_x_m", "pivot_y_m", "pivot_z_m"])?;
    let mass = section.number("mass_kg", MASS)?;
    let centre = if section.has("cg_x_m") {
        point(section, ["cg_x_m", "cg_y_m", "cg_z_m"])?
    } else {
        pivot
    };
    // a rod of 0.3 m by default: the wheels at its ends weigh more
    let inertia = if section.has("inertia_xx_kg_m2") {
        inertia(section)?
    } else {
        [0.0075 * mass; 3]
    };
    let any = (-1e9, 1e9);
    let positive = (0.0, 1e9);
    let or_zero =
        |key, limits| Ok::<_, Error>(section.optional_number(key, limits)?.unwrap_or(0.0));
    Ok(LinkFile {
        name: section.text("name")?.into(),
        on: carrier(section)?,
        pivot,
        mass: MassFile {
            mass,
            centre,
            inertia,
        },
        opposite: section.optional_text("opposite")?.map(Into::into),
        stiffness: or_zero("stiffness_nm_per_rad", positive)?,
        damping: or_zero("damping_nms_per_rad", positive)?,
        preload: or_zero("preload_nm", any)?,
        range: section
            .optional_number("range_deg", (0.1, 90.0))?
            .unwrap_or(45.0)
            .to_radians(),
    })
}

fn read_motor(section: &Section<'_>) -> Result<MotorFile> {
    let positive = (1e-9, 1e9);
    Ok(MotorFile {
        name: section.text("name")?.into(),
        resistance: section.number("resistance_ohm", positive)?,
        constant: section.number("constant_nm_per_a", positive)?,
        voltage: section.number("voltage_v", positive)?,
        current: section.number("current_a", positive)?,
        rotor_inertia: section
            .optional_number("rotor_inertia_kg_m2", (0.0, 1e6))?
            .unwrap_or(0.0),
        gear_efficiency: section
            .optional_number("gear_efficiency", (0.05, 1.0))?
            .unwrap_or(1.0),
    })
}

/// Reads what a wheel's table says of the body.
pub(crate) fn read_wheel(section: &Section<'_>) -> Result<WheelBody> {
    let angle = |key, limits| {
        Ok::<_, Error>(
            section
                .optional_number(key, limits)?
                .unwrap_or(0.0)
                .to_radians(),
        )
    };
    Ok(WheelBody {
        on: carrier(section)?,
        z: section.optional_number("z_m", LENGTH)?,
        mass: section.optional_number("mass_kg", MASS)?.unwrap_or(0.5),
        spin_inertia: section.optional_number("spin_inertia_kg_m2", INERTIA)?,
        motor: section.optional_text("motor")?.map(Into::into),
        bearing: section
            .optional_number("bearing_nm", (0.0, 1e6))?
            .unwrap_or(0.0),
        camber: angle("camber_deg", (-30.0, 30.0))?,
        caster: angle("caster_deg", (-45.0, 45.0))?,
        steer_range: angle("steer_range_deg", (0.0, 180.0))?,
        steer_rate: section
            .optional_number("steer_rate_deg_per_s", (0.1, 1e4))?
            .unwrap_or(60.0)
            .to_radians(),
    })
}
