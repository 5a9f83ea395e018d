//! The flags that describe a wheel on a soil.

use grouser_terra::{Angle, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil};

use crate::error::Result;
use crate::law_error::Names;
use crate::session::Session;
use crate::soil_choice::{Chosen, SoilArguments};
use grouser_report::number::parse_finite;

/// A wheel, the soil below it, and its drift.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct WheelArguments {
    #[command(flatten)]
    soil: SoilArguments,
    /// Radius of the wheel in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    pub(crate) radius_m: f64,
    /// Width of the wheel in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    pub(crate) width_m: f64,
    /// Rebound ratio λ: the soil behind the wheel rises by λ times the sinkage [default: the soil's, or 0]
    #[arg(long, value_name = "X", value_parser = parse_finite, allow_negative_numbers = true)]
    rebound: Option<f64>,
    /// Slip angle in degrees, positive when the wheel drifts to its left
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_negative_numbers = true, default_value_t = 0.0)]
    pub(crate) slip_angle_deg: f64,
}

impl WheelArguments {
    /// The wheel on its soil; the soil is noted in the session.
    pub(crate) fn pair(&self, session: &mut Session) -> Result<(WheelOnSoil, Chosen)> {
        let refuse = |error| Names::Flags.error(&error);
        let wheel = RigidWheel::new(self.radius_m, self.width_m).map_err(refuse)?;
        let mut chosen = self.soil.choose(session)?;
        if let Some(rebound) = self.rebound {
            chosen.soil = chosen.soil.with_rebound(rebound).map_err(refuse)?;
        }
        let pair = WheelOnSoil::new(wheel, chosen.soil, Settings::default()).map_err(refuse)?;
        Ok((pair, chosen))
    }

    /// Its motion at a slip.
    pub(crate) fn kinematics(&self, slip: f64) -> Result<Kinematics> {
        let refuse = |error| Names::Flags.error(&error);
        let slip = Slip::new(slip).map_err(refuse)?;
        if self.slip_angle_deg == 0.0 {
            return Ok(Kinematics::straight(slip));
        }
        Kinematics::with_slip_angle(slip, Angle::from_deg(self.slip_angle_deg)).map_err(refuse)
    }
}
