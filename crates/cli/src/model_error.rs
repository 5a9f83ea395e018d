//! The model error of a soil's laws, printed with the numbers that follow from them.

use grouser_report::number::rounded;
use grouser_rover::robot::RobotModel;
use grouser_terra::{Kinematics, LawPreset, Slip, Soil};

/// Why there is no interval.
pub(crate) const UNKNOWN: &str = "no interval of the model is known: the soil mixes laws that were not compared with measured wheels";

/// Half of the interval of pull over load that holds 90 % of measurements of wheels that drive straight ahead at `slip`: a slope in
/// radians, or a pull margin. That of the soil where it is largest; `None` where the laws of one were not compared ([`UNKNOWN`]).
pub(crate) fn pull_per_load<'a>(
    soils: impl IntoIterator<Item = &'a Soil>,
    slip: f64,
    has_lugs: bool,
) -> Option<f64> {
    let motion = Kinematics::straight(Slip::new(slip).ok()?);
    let mut largest = 0.0_f64;
    for soil in soils {
        let error = LawPreset::compared(&soil.params().laws)?.model_error(&motion, has_lugs);
        largest = largest.max(error.pull_per_load);
    }
    Some(largest)
}

/// Has any wheel lugs?
pub(crate) fn has_lugs(robot: &RobotModel) -> bool {
    (robot.wheels.iter()).any(|mount| mount.wheel.grousers().is_some())
}

/// The line below a slope.
pub(crate) fn of_slope(error: Option<f64>) -> String {
    error.map_or_else(String::new, |error| {
        let degrees = rounded(error.to_degrees(), 2);
        format!("90 % of measurements lie within ±{degrees}° of that\n")
    })
}
