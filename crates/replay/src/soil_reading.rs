//! What the soil model says of a slip that was measured.

use grouser_slip::{Robot, Wheel};
use grouser_terra::{Kinematics, Settings, Slip, Soil, SolveStatus, WheelOnSoil};

use crate::error::{Error, Result};
use crate::summary::{Summary, WheelSummary};

/// The soil model's reading of one wheel's median slip.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilReading {
    /// The wheel's name.
    pub wheel: String,
    /// The slip that was measured: the wheel's median.
    pub slip: f64,
    /// The load that the wheel carries, N.
    pub load: f64,
    /// How the search for the sinkage ended.
    pub status: SolveStatus,
    /// Sinkage, m.
    pub sinkage: Option<f64>,
    /// Drawbar pull, N.
    pub drawbar_pull: Option<f64>,
    /// Torque, N m.
    pub torque: Option<f64>,
    /// Tractive efficiency; `None` where the wheel does not pull.
    pub efficiency: Option<f64>,
    /// The slip of best efficiency under this load; `None` where no slip gives any pull.
    pub best_slip: Option<f64>,
    /// The efficiency there.
    pub best_efficiency: Option<f64>,
    /// How far the measured slip lies above the slip of best efficiency.
    pub above_best: Option<f64>,
    /// The slip if the free wheel that was the reference skids as the model says on this soil
    /// (`Reference::FreeWheel`), where its size and load are known; the truth lies between this and `slip` if the
    /// soil is right.
    pub slip_with_skid: Option<f64>,
    /// What to keep in mind, in words.
    pub cautions: Vec<String>,
}

/// Puts every wheel with a median slip on `soil`: what its slip means in pull, sinkage and torque, and
/// how far it is from the slip of best efficiency.
///
/// # Errors
/// [`Error::NoWheelSize`] for a wheel without width or load; [`Error::Soil`] for what the model refuses.
pub fn soil_readings(summary: &Summary, robot: &Robot, soil: &Soil) -> Result<Vec<SoilReading>> {
    let skid = reference_skid(summary, robot, soil)?;
    summary
        .wheels
        .iter()
        .zip(robot.wheels())
        .filter_map(|(wheel, description)| {
            let slip = wheel.slip.median?;
            Some(reading(wheel, description, slip, (soil, skid)))
        })
        .collect()
}

/// The skid of the free wheels that were the reference, by the soil model: their mean. `None` where there
/// are none, or their width or load is not known, or the soil does not turn them.
///
/// Assumes: no friction in their bearings.
///
/// # Errors
/// [`Error::Soil`] for what the model refuses.
pub fn reference_skid(summary: &Summary, robot: &Robot, soil: &Soil) -> Result<Option<f64>> {
    let (mut sum, mut count) = (0.0, 0.0);
    let wheels = summary.wheels.iter().zip(robot.wheels());
    for (_, wheel) in wheels.filter(|(summary, _)| summary.is_reference) {
        let (Some(width), Some(load)) = (wheel.width, wheel.load) else {
            return Ok(None);
        };
        let rigid = wheel.rigid(width)?;
        let pair = WheelOnSoil::new(rigid, *soil, Settings::default())?;
        let Some(skid) = pair.free_slip(load, 0.0)? else {
            return Ok(None);
        };
        sum += skid.value();
        count += 1.0;
    }
    Ok((count > 0.0).then(|| sum / count))
}

/// The slip against a reference that itself skids by `skid`: v = v_seen/(1 + s_f).
fn with_skid(slip: Slip, skid: f64) -> Result<f64> {
    Ok(Slip::from_speed_ratio(slip.speed_ratio() / (1.0 + skid))?.value())
}

fn reading(
    wheel: &WheelSummary,
    description: &Wheel,
    median: f64,
    (soil, skid): (&Soil, Option<f64>),
) -> Result<SoilReading> {
    let needs = |key| Error::NoWheelSize {
        wheel: wheel.name.clone(),
        key,
    };
    let width = description.width.ok_or_else(|| needs("width_m"))?;
    let load = description.load.ok_or_else(|| needs("load_n"))?;
    let slip = Slip::new(median)?;
    let pair = WheelOnSoil::new(description.rigid(width)?, *soil, Settings::default())?;
    let solution = pair.under_load(load, &Kinematics::straight(slip))?;
    let best = pair.slip_of_maximum_efficiency(load)?;
    let point = solution.point();
    let point = point.as_ref();
    Ok(SoilReading {
        wheel: wheel.name.clone(),
        slip: median,
        load,
        status: solution.outcome.status(),
        sinkage: point.map(|p| p.sinkage),
        drawbar_pull: point.map(|p| p.forces.drawbar_pull),
        torque: point.map(|p| p.forces.torque),
        efficiency: point.and_then(grouser_terra::OperatingPoint::tractive_efficiency),
        best_slip: best.map(|b| b.slip.value()),
        best_efficiency: best.map(|b| b.value),
        above_best: best.map(|b| median - b.slip.value()),
        slip_with_skid: skid.map(|skid| with_skid(slip, skid)).transpose()?,
        cautions: point.map_or_else(Vec::new, |p| {
            p.cautions
                .iter()
                .map(|caution| caution.to_string())
                .collect()
        }),
    })
}
