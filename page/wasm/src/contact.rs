//! A wheel on a soil out of a request, as the command reads them from flags and a soil file.

use grouser_files::{Document, soil};
use grouser_terra::catalogue::Completion;
use grouser_terra::{
    Angle, GrouserRule, Grousers, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil,
};

use crate::request::{Problem, Request};

/// The wheel of `radius_m`, `width_m` and its lugs on the soil of the soil file in `soil`.
pub(crate) fn contact(request: &Request<'_>) -> Result<WheelOnSoil, Problem> {
    let document = Document::from_text("soil.toml", request.text("soil")?.to_owned())?;
    let soil = soil::parse(&document)?.completed(&Completion::default())?;
    Ok(WheelOnSoil::new(
        wheel(request)?,
        soil,
        Settings::default(),
    )?)
}

fn wheel(request: &Request<'_>) -> Result<RigidWheel, Problem> {
    let bare = RigidWheel::new(request.number("radius_m")?, request.number("width_m")?)?;
    let height = request.optional_number("grouser_height_m")?;
    let count = request.optional_number("grouser_count")?;
    match (height, count) {
        (Some(height), Some(count)) => {
            let thickness = request
                .optional_number("grouser_thickness_m")?
                .unwrap_or(0.0);
            Ok(bare.with_grousers(Grousers {
                height,
                rule: GrouserRule::Lugs { count, thickness },
            })?)
        }
        _ => Ok(bare),
    }
}

/// The motion at a slip, with the request's slip angle.
pub(crate) fn kinematics(request: &Request<'_>, slip: f64) -> Result<Kinematics, Problem> {
    let slip = Slip::new(slip)?;
    let angle = request.optional_number("slip_angle_deg")?.unwrap_or(0.0);
    if angle == 0.0 {
        return Ok(Kinematics::straight(slip));
    }
    Ok(Kinematics::with_slip_angle(slip, Angle::from_deg(angle))?)
}
