//! What a slope costs a robot that climbs it straight on: slip, energy and what is left in reserve.

use grouser_real::Real;
use grouser_terra::{Cautions, Kinematics, Settings, Slip, Soil, WheelOnSoil};

use super::loads::wheel_loads;
use super::margins::stability_margins;
use crate::error::{Error, Result};
use crate::robot::RobotModel;

/// Slips between 0 and 1 at which the pull is sampled before the smallest sufficient slip is refined.
const SAMPLES: u32 = 32;

/// Bisections of a slip: to 1e-12 of it.
const BISECTIONS: u32 = 40;

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
    /// The most pull there is at any slip, less what the slope takes, N: negative where the robot slides.
    pub reserve: f64,
    /// How much further the robot may tilt before it tips over, rad: negative where it does.
    pub tip_over: f64,
    /// Does a wheel lose the ground on this slope?
    pub lifts: bool,
    /// What to keep in mind about its wheels.
    pub cautions: Cautions,
}

/// All wheels of a robot at one slip.
struct Pulled {
    pull: f64,
    energy_per_metre: f64,
    sinkage: f64,
    cautions: Cautions,
}

/// The slip, the energy and the margins of `model` on `soil` on each of `slopes` (rad), under the robot's gravity
/// ([`RobotModel::under_gravity`]).
///
/// All powered wheels slip alike (their rims turn equally fast, and a rigid robot that drives straight moves them
/// alike). Free wheels roll at the skid at which the soil turns their bearing. Loads follow the slope.
///
/// # Errors
/// [`Error::Law`](crate::Error::Law) for a wheel that the laws refuse on this soil.
pub fn climb(model: &RobotModel, soil: &Soil, slopes: &[f64]) -> Result<Vec<ClimbStep>> {
    let pairs = model
        .wheels
        .iter()
        .map(|mount| {
            WheelOnSoil::new(mount.wheel, *soil, Settings::default())
                .map_err(|source| of(&mount.name, source))
        })
        .collect::<Result<Vec<_>>>()?;
    slopes
        .iter()
        .map(|slope| step(model, &pairs, *slope))
        .collect()
}

fn step(model: &RobotModel, pairs: &[WheelOnSoil], slope: f64) -> Result<ClimbStep> {
    let stand = wheel_loads(model, slope, 0.0);
    let needed = model.weight() * Real::sin(slope);
    let at = |slip: f64| pulled(model, pairs, &stand.loads, slip);
    let (mut best, mut before, mut found) = (f64::NEG_INFINITY, None, None);
    for sample in 0..=SAMPLES {
        let slip = f64::from(sample) / f64::from(SAMPLES);
        let Some(now) = at(slip)? else {
            before = None;
            continue;
        };
        best = best.max(now.pull);
        if now.pull >= needed && found.is_none() {
            found = Some((before.unwrap_or(slip), slip));
        }
        before = Some(slip);
    }
    let slip = match found {
        None => None,
        Some((mut low, mut high)) => {
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if at(middle)?.is_some_and(|now| now.pull >= needed) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            Some(high)
        }
    };
    let here = slip.map(at).transpose()?.flatten();
    Ok(ClimbStep {
        slope,
        slip,
        energy_per_metre: here.as_ref().map(|here| here.energy_per_metre),
        sinkage: here.as_ref().map(|here| here.sinkage),
        reserve: best - needed,
        tip_over: stability_margins(model, slope, 0.0).tip_over,
        lifts: !stand.stands,
        cautions: here.map(|here| here.cautions).unwrap_or_default(),
    })
}

/// Pull and energy of all wheels where the powered ones slip by `slip`; `None` where a wheel is not carried.
fn pulled(
    model: &RobotModel,
    pairs: &[WheelOnSoil],
    loads: &[f64],
    slip: f64,
) -> Result<Option<Pulled>> {
    let mut sum = Pulled {
        pull: 0.0,
        energy_per_metre: 0.0,
        sinkage: 0.0,
        cautions: Cautions::default(),
    };
    for ((mount, pair), load) in model.wheels.iter().zip(pairs).zip(loads) {
        if !(*load > 0.0) {
            continue;
        }
        let law = |source| of(&mount.name, source);
        let slip = if mount.motor.is_some() {
            Slip::new(slip).map_err(law)?
        } else {
            match pair.free_slip(*load, mount.bearing).map_err(law)? {
                Some(skid) => skid,
                None => return Ok(None),
            }
        };
        let solved = pair
            .under_load(*load, &Kinematics::straight(slip))
            .map_err(law)?;
        let Some(point) = solved.point() else {
            return Ok(None);
        };
        sum.pull += point.forces.drawbar_pull;
        sum.sinkage = sum.sinkage.max(point.sinkage);
        sum.cautions.insert_all(point.cautions);
        if mount.motor.is_some() {
            sum.energy_per_metre += point.energy_per_metre().unwrap_or(f64::INFINITY);
        }
    }
    Ok(Some(sum))
}

fn of(name: &str, source: grouser_terra::Error) -> Error {
    Error::Law {
        of: format!("wheel \"{name}\""),
        source,
    }
}
