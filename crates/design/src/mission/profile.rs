//! Where a robot drives: slopes with their shares of the way, soils with their shares.

use grouser_real::OutOfRange;
use grouser_terra::Soil;

use crate::error::{Error, Result};

/// Slopes beyond this are refused, degrees: wheels that hardly press on the ground are not what the laws describe.
pub const MAX_SLOPE_DEG: f64 = 60.0;

/// Shares sum to 1 within this.
const SHARE_TOLERANCE: f64 = 1e-6;

/// A slope that is climbed straight on, and its share of the way.
///
/// ```
/// let level = grouser_design::mission::SlopeShare { slope_deg: 0.0, share: 0.8 };
/// assert_eq!(level.share, 0.8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeShare {
    /// Degrees, uphill positive.
    pub slope_deg: f64,
    /// Its share of the way.
    pub share: f64,
}

/// A soil, and the share of the way on it.
#[derive(Clone, Debug, PartialEq)]
pub struct SoilShare {
    /// Its name in reports.
    pub name: String,
    /// The soil.
    pub soil: Soil,
    /// Its share of the way.
    pub share: f64,
}

/// Slopes inside the limits whose shares sum to 1.
pub(super) fn check_slopes(slopes: &[SlopeShare]) -> Result<()> {
    for slope in slopes {
        OutOfRange::check("slope_deg", slope.slope_deg, (0.0, MAX_SLOPE_DEG), "deg")
            .map_err(Error::OutOfRange)?;
    }
    check_shares("slopes", slopes.iter().map(|slope| slope.share))
}

/// Soils of different names whose shares sum to 1.
pub(super) fn check_soils(soils: &[SoilShare]) -> Result<()> {
    for (index, soil) in soils.iter().enumerate() {
        if soils[..index].iter().any(|other| other.name == soil.name) {
            return Err(Error::Mission(format!(
                "soil \"{}\" is named twice",
                soil.name
            )));
        }
    }
    check_shares("soils", soils.iter().map(|soil| soil.share))
}

fn check_shares(of: &str, shares: impl Iterator<Item = f64>) -> Result<()> {
    let (mut sum, mut count) = (0.0, 0);
    for share in shares {
        OutOfRange::check(format!("share of {of}"), share, (0.0, 1.0), "1")
            .map_err(Error::OutOfRange)?;
        sum += share;
        count += 1;
    }
    if count == 0 {
        return Err(Error::Mission(format!("the mission has no {of}")));
    }
    let limits = (1.0 - SHARE_TOLERANCE, 1.0 + SHARE_TOLERANCE);
    OutOfRange::check(format!("sum of the shares of {of}"), sum, limits, "1")
        .map_err(Error::OutOfRange)
}
