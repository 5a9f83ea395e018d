//! How the robot's computer works, and what it knows of the robot beside its description.

use alloc::vec::Vec;

use super::carrier::WheelCarrier;
use super::learn::SoilLearnSettings;
use super::soil_tables::SoilTables;
use crate::control::ControlSettings;
use crate::detect::DetectSettings;
use crate::error::{Result, check_range};
use crate::filter::FilterSettings;
use crate::robot::Robot;
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

/// What is known of one wheel beside its description.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelSetup {
    /// Load that it carries on the level, N.
    pub load: f64,
    /// Greatest torque of its motor on the wheel, N m; `None` without a motor.
    pub max_torque: Option<f64>,
    /// How far it steers either way, rad; 0: not at all.
    pub max_steering_angle: f64,
    /// Friction of its bearing, N m.
    pub bearing_torque: f64,
    /// What carries it.
    pub carrier: WheelCarrier,
}

/// What happens where the sensors contradict the robot's description at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StartPolicy {
    /// The sensors are not checked.
    Off,
    /// A contradiction is reported by [`OnBoard::start_fault`](super::OnBoard::start_fault).
    #[default]
    Report,
    /// The robot does not drive until gravity has been seen where it should be, and stops for a contradiction.
    Refuse,
}

/// How [`OnBoard`](super::OnBoard) works.
///
/// ```
/// use grouser_slip::onboard::{OnBoard, OnBoardSettings};
/// use grouser_slip::{Robot, Wheel};
///
/// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
/// let mut settings = OnBoardSettings::new(&robot);
/// settings.gravity = 1.62; // on the moon, m/s²
/// settings.wheels[0].max_torque = Some(5.0); // N m
/// assert!(OnBoard::new(&robot, settings).is_ok());
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OnBoardSettings {
    /// The filter's settings.
    pub filter: FilterSettings,
    /// The detector's settings.
    pub detect: DetectSettings,
    /// The controller's settings.
    pub control: ControlSettings,
    /// Gravity where the robot drives, m/s².
    pub gravity: f64,
    /// Heading at the start, rad.
    pub heading: f64,
    /// For this long after the first sample the filter waits while the attitude is found, s; at most the controller's
    /// `blind_time`.
    pub warm_up: f64,
    /// Are poses used? Where a camera measures displacements the fixes of a receiver only add their noise.
    pub uses_poses: bool,
    /// What happens where the sensors contradict the description.
    pub start_policy: StartPolicy,
    /// One per wheel in the robot's order.
    pub wheels: Vec<WheelSetup>,
    /// What the known soil says of the robot.
    pub soil: SoilTables,
    /// How soil is learnt while driving, among the family of `soil`; `None`: it stays the known soil.
    pub learn: Option<SoilLearnSettings>,
}

impl OnBoardSettings {
    /// Settings for `robot` with what its description has of the wheels: rigid, without steering, on unknown soil.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let wheels = robot.wheels().iter().map(|wheel| WheelSetup {
            load: wheel.load.unwrap_or(1.0),
            carrier: WheelCarrier::on_chassis([wheel.x, wheel.radius]),
            ..WheelSetup::default()
        });
        Self {
            filter: FilterSettings::default(),
            detect: DetectSettings::default(),
            control: ControlSettings::default(),
            gravity: EARTH_GRAVITY_M_PER_S2,
            heading: 0.0,
            warm_up: 0.5,
            uses_poses: true,
            start_policy: StartPolicy::default(),
            wheels: wheels.collect(),
            soil: SoilTables::default(),
            learn: None,
        }
    }

    /// Checks what the parts do not check themselves.
    pub(super) fn check(&self, robot: &Robot) -> Result<()> {
        let of = "onboard";
        let wheels = robot.wheels().len() as f64;
        let setups = self.wheels.len() as f64;
        check_range(of, "number of wheels", setups, (wheels, wheels), "1")?;
        check_range(of, "gravity", self.gravity, (0.01, 100.0), "m/s²")?;
        check_range(of, "heading", self.heading, (-1e6, 1e6), "rad")?;
        // without slips for longer the controller ends the drive
        let blind_time = self.control.blind_time.min(100.0);
        check_range(of, "warm_up", self.warm_up, (0.0, blind_time), "s")?;
        for (wheel, setup) in robot.wheels().iter().zip(&self.wheels) {
            let of = wheel.name.as_str();
            check_range(of, "load", setup.load, (-1e7, 1e7), "N")?;
            let bearing = setup.bearing_torque;
            check_range(of, "bearing_torque", bearing, (0.0, 1e6), "N m")?;
            let steering = (0.0, core::f64::consts::FRAC_PI_2);
            let angle = setup.max_steering_angle;
            check_range(of, "max_steering_angle", angle, steering, "rad")?;
            if let Some(torque) = setup.max_torque {
                check_range(of, "max_torque", torque, (1e-9, 1e7), "N m")?;
            }
        }
        Ok(())
    }
}
