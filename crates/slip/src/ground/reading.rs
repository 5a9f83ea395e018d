//! One reading of a wheel that tells something of the soil's strength.

use grouser_real::OutOfRange;
use grouser_terra::Slip;

use super::entry::Uncertain;
use crate::fault::Fault;

/// Slip, load, sinkage and torque of one wheel at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelReading {
    /// When, ns.
    pub time_ns: i64,
    /// Which of the identifier's wheels.
    pub wheel: usize,
    /// Slip, in [−1, 1].
    pub slip: Uncertain,
    /// Vertical load, N.
    pub load: Uncertain,
    /// Sinkage, m.
    pub sinkage: Uncertain,
    /// Torque on the wheel, N m, after the gear's and the bearing's friction.
    pub torque: Uncertain,
}

impl WheelReading {
    pub(crate) fn check(&self, radius: f64) -> Result<Slip, Fault> {
        self.slip
            .check("slip", "sigma of the slip", (-1.0, 1.0), "1")?;
        self.load
            .check("load", "sigma of the load", (0.0, 1e7), "N")?;
        self.sinkage
            .check("sinkage", "sigma of the sinkage", (0.0, radius), "m")?;
        self.torque
            .check("torque", "sigma of the torque", (-1e7, 1e7), "N m")?;
        Slip::new(self.slip.value).map_err(|_| {
            Fault::OutOfRange(OutOfRange {
                field: "slip",
                value: self.slip.value,
                low: -1.0,
                high: 1.0,
                unit: "1",
            })
        })
    }
}
