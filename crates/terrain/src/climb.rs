//! What a slope costs a robot that climbs it straight on: slip, energy and what is left in reserve.

use grouser_rover::statics::{stability_margins, wheel_loads};
use grouser_terra::Cautions;
use grouser_terra::slope::HeldSlip;

use crate::demand::DemandSolver;
use crate::error::Result;

/// One slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClimbStep {
    /// The slope, rad.
    pub slope: f64,
    /// The slip that all powered wheels share; `None` where no slip holds the slope.
    pub slip: Option<f64>,
    /// Energy at the wheels per metre of travel, J/m.
    pub energy_per_metre: Option<f64>,
    /// The greatest sinkage of a wheel, m.
    pub sinkage: Option<f64>,
    /// The greatest pull up to the greatest slip, less what the slope takes, N: negative where the robot slides.
    pub reserve: f64,
    /// How much further the robot may tilt before it tips over, rad: negative where it does.
    pub tip_over: f64,
    /// Does a wheel lose the ground on this slope?
    pub lifts: bool,
    /// What to keep in mind about its wheels.
    pub cautions: Cautions,
}

/// The slip, the energy and the margins of a robot on each of `slopes` (rad).
///
/// All powered wheels slip alike (their rims turn equally fast, and a rigid robot that drives straight moves them
/// alike). Free wheels roll at the skid at which the soil turns their bearing. Loads follow the slope.
///
/// # Errors
/// [`Error::Law`](crate::Error::Law) for a wheel that the laws refuse on this soil.
pub fn climb(solver: &DemandSolver, slopes: &[f64]) -> Result<Vec<ClimbStep>> {
    slopes.iter().map(|slope| step(solver, *slope)).collect()
}

fn step(solver: &DemandSolver, slope: f64) -> Result<ClimbStep> {
    let rest = wheel_loads(solver.model(), slope, 0.0);
    let posed = solver.under(slope, rest.loads, &mut Vec::new())?;
    let driving = match posed.held()? {
        HeldSlip::Holds(slip) => Some(posed.driving(slip)?),
        _ => None,
    };
    Ok(ClimbStep {
        slope,
        slip: driving.map(|driving| driving.slip),
        energy_per_metre: driving.map(|driving| driving.work_per_metre),
        sinkage: driving.map(|driving| driving.sinkage),
        reserve: posed.reserve()?.unwrap_or(f64::NEG_INFINITY),
        tip_over: stability_margins(solver.model(), slope, 0.0).tip_over,
        lifts: !rest.stands,
        cautions: driving.map(|driving| driving.cautions).unwrap_or_default(),
    })
}
