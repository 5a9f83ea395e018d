//! What the soil model says of a robot before it measures: tables made once, looked up while it drives.

use alloc::{format, string::String, vec::Vec};

use grouser_terra::{
    Angle, Kinematics, RigidWheel, Settings as LawSettings, Slip, Soil, WheelOnSoil,
};

use super::learn::SoilFamily;
use super::settings::WheelSetup;
use crate::error::{Error, Result};
use crate::filter::{FilterSettings, SlipPrior};
use crate::prior::{FreeWheelSkid, SlipDemand, SoilDoubt};
use crate::robot::{Robot, WheelRole};

/// Slopes that the table of slip demand holds, rad either way: 20°, beyond which no shipped soil carries a robot.
const MAX_TABLE_SLOPE_RAD: f64 = 0.35;
/// Points of a torque table, over slips from 0 to 1: linear between them it is off by less than 1 %.
pub const TORQUE_POINTS: usize = 21;
/// No wheel's load is taken below this, N: the laws need a load.
const MIN_LOAD_N: f64 = 0.1;
/// A free wheel's skid is held within this, so that it stays a skid.
const MAX_FREE_SLIP: f64 = 0.9;

/// A wheel's torque (N m) on the known soil under its load, at slips 0, 0.05, … 1.
pub type TorqueTable = [f64; TORQUE_POINTS];

/// What the known soil says of a robot: its free wheels' skid, its slip on a slope, its wheels' torques.
///
/// [`SoilTables::solve`] makes them from the laws of terra, which takes some ten milliseconds on a desktop. A
/// microcontroller takes ready-made ones: every field is plain numbers.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct SoilTables {
    /// Mean skid of the free wheels, over laws and soil; `None`: the filter's default.
    pub free_slip: Option<SlipPrior>,
    /// The slip that holds a slope.
    pub slip_demand: Option<SlipDemand>,
    /// One per wheel in the robot's order; `None` for a free wheel.
    pub torques: Vec<Option<TorqueTable>>,
    /// The soils to choose between, for a robot that learns its soil; [`SoilTables::solve`] leaves it out.
    pub family: Option<SoilFamily>,
}

impl SoilTables {
    /// The tables for `robot` on `soil` that is known up to `doubt`.
    ///
    /// # Errors
    /// [`Error::Law`] where the laws refuse a wheel or a load.
    ///
    /// # Panics
    /// Never.
    pub fn solve(
        robot: &Robot,
        setups: &[WheelSetup],
        soil: &Soil,
        doubt: SoilDoubt,
    ) -> Result<Self> {
        let mut wheels = Vec::new();
        for (wheel, setup) in robot.wheels().iter().zip(setups) {
            let width = wheel.width.unwrap_or(wheel.radius);
            let rigid = wheel.rigid(width).map_err(of(&wheel.name))?;
            wheels.push((wheel, rigid, setup));
        }
        let mut out = Self::default();
        let mut skids = Vec::new();
        let mut powered = Vec::new();
        for (wheel, rigid, setup) in wheels {
            let load = setup.load.max(MIN_LOAD_N);
            if wheel.role == WheelRole::Free {
                let bearing = setup.bearing_torque;
                let skid = FreeWheelSkid::over_laws(rigid, soil, bearing, (load, load), doubt)
                    .map_err(of(&wheel.name))?;
                skids.extend(skid.at(load));
            }
            out.torques.push(if setup.max_torque.is_some() {
                powered.push((&wheel.name, rigid, setup.load));
                Some(torque_table(rigid, soil, load).map_err(of(&wheel.name))?)
            } else {
                None
            });
        }
        out.free_slip = mean_skid(&skids);
        if let Some((name, rigid, _)) = powered.first() {
            let load = powered.iter().map(|wheel| wheel.2).sum::<f64>() / powered.len() as f64;
            let slopes = [-MAX_TABLE_SLOPE_RAD, MAX_TABLE_SLOPE_RAD].map(Angle::from_rad);
            let demand = SlipDemand::new(
                *rigid,
                soil,
                load.max(MIN_LOAD_N),
                (slopes[0], slopes[1]),
                doubt,
            );
            out.slip_demand = Some(demand.map_err(of(name))?);
        }
        Ok(out)
    }
}

fn of(name: &str) -> impl Fn(grouser_terra::Error) -> Error {
    let of: String = format!("wheel \"{name}\"");
    move |source| Error::Law {
        of: of.clone(),
        source,
    }
}

/// The mean over several free wheels; never surer than the filter's default.
fn mean_skid(skids: &[SlipPrior]) -> Option<SlipPrior> {
    let standard = FilterSettings::default().free_slip;
    let count = skids.len() as f64;
    let mean = |of: fn(&SlipPrior) -> f64| skids.iter().map(of).sum::<f64>() / count;
    (!skids.is_empty()).then(|| SlipPrior {
        mean: mean(|skid| skid.mean).clamp(-MAX_FREE_SLIP, MAX_FREE_SLIP),
        sigma: mean(|skid| skid.sigma).max(standard.sigma),
    })
}

fn torque_table(
    wheel: RigidWheel,
    soil: &Soil,
    load: f64,
) -> core::result::Result<TorqueTable, grouser_terra::Error> {
    let contact = WheelOnSoil::new(wheel, *soil, LawSettings::default())?;
    let mut torques = [0.0; TORQUE_POINTS];
    for (index, slot) in torques.iter_mut().enumerate() {
        let slip = Slip::new(index as f64 / (TORQUE_POINTS - 1) as f64)?;
        let found = contact.under_load(load, &Kinematics::straight(slip))?;
        *slot = found.point().map_or(0.0, |point| point.forces.torque);
    }
    Ok(torques)
}
