//! The robot's computer in a simulation: what its settings say of robot, soil and sensors.

use grouser_slip::control::ControlSettings;
use grouser_slip::filter::FilterSettings;
use grouser_slip::onboard::{
    OnBoard, OnBoardSettings, SoilFamily, SoilLearnSettings, SoilTables, WheelSetup,
};
use grouser_slip::prior::SoilDoubt;
use grouser_terra::Soil;

use crate::body::Motor;
use crate::error::Result;
use crate::robot::RobotModel;
use crate::sensors::SensorSettings;

/// A sensor is never described as better than this, m: variances must not vanish.
const MIN_POSITION_SIGMA_M: f64 = 1e-6;

/// What the computer knows of its wheels under `loads` (N).
fn wheel_setups(model: &RobotModel, loads: &[f64]) -> Vec<WheelSetup> {
    let setups = model.wheels.iter().zip(loads);
    let setups = setups.map(|(mount, load)| WheelSetup {
        load: *load,
        max_torque: mount.motor.as_ref().map(Motor::max_torque),
        max_steering_angle: mount.steer_range,
        bearing_torque: mount.bearing,
        carrier: model.linkage.carrier(mount.link, mount.centre),
    });
    setups.collect()
}

/// What the computer of `model` under `loads` (N) knows of the soil, with a family to choose from where it `learns`.
pub(super) fn soil_tables(
    model: &RobotModel,
    loads: &[f64],
    soil: &Soil,
    learns: bool,
) -> Result<SoilTables> {
    let setups = wheel_setups(model, loads);
    let mut tables = SoilTables::solve(&model.robot, &setups, soil, SoilDoubt::default())?;
    if learns {
        tables.family = Some(SoilFamily::solve(&model.robot, &setups, soil)?);
    }
    Ok(tables)
}

/// The computer of `model` under `loads` (N), which knows the soil on which it starts, its heading (rad) and its sensors.
pub(super) fn on_board(
    model: &RobotModel,
    (loads, tables, heading): (&[f64], &SoilTables, f64),
    sensors: &SensorSettings,
    (control, learn): (&ControlSettings, Option<SoilLearnSettings>),
) -> Result<OnBoard> {
    let mut settings = OnBoardSettings::new(&model.robot);
    settings.wheels = wheel_setups(model, loads);
    settings.filter = filter_settings(model, sensors);
    settings.control = *control;
    settings.gravity = model.linkage.gravity();
    settings.heading = heading;
    settings.uses_poses = sensors.camera_rate <= 0.0;
    settings.soil = tables.clone();
    settings.learn = learn;
    Ok(OnBoard::new(&model.robot, settings)?)
}

/// What the robot's file and the sensors' data sheets say.
pub(super) fn filter_settings(model: &RobotModel, sensors: &SensorSettings) -> FilterSettings {
    let file = model.settings;
    let sigma = if sensors.camera_rate > 0.0 {
        sensors.camera_sigma
    } else {
        sensors.gnss_sigma
    };
    FilterSettings {
        max_speed: file.max_speed,
        position_sigma: sigma.max(MIN_POSITION_SIGMA_M),
        // Pictures and fixes are stamped when they are taken: the filter takes late ones up to a second.
        reference_latency: 0.0,
        ..FilterSettings::default()
    }
}
