//! The flags that describe a wheel on a soil.

use grouser_files::gravity::GRAVITY_LIMITS_M_PER_S2;
use grouser_rover::robot::RobotModel;
use grouser_terra::slope::{MAX_SLIP, MAX_SLIP_LIMITS};
use grouser_terra::{
    Angle, EARTH_GRAVITY_M_PER_S2, GrouserRule, Grousers, Kinematics, RigidWheel, Settings, Slip,
    WheelOnSoil, gravity_of,
};

use crate::error::{Error, Result};
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
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) radius_m: f64,
    /// Width of the wheel in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) width_m: f64,
    #[command(flatten)]
    pub(crate) grousers: GrouserArguments,
    /// Rebound ratio λ: the soil behind the wheel rises by λ times the sinkage [default: the soil's, or 0]
    #[arg(long, value_name = "X", value_parser = parse_finite, allow_hyphen_values = true)]
    rebound: Option<f64>,
    /// Slip angle in degrees, positive when the wheel drifts to its left
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true, default_value_t = 0.0)]
    pub(crate) slip_angle_deg: f64,
}

/// The lugs of a wheel.
#[derive(clap::Args, Clone, Copy, Debug)]
#[allow(clippy::struct_field_names, reason = "the flags' names")]
pub(crate) struct GrouserArguments {
    /// Height of the lugs (grousers) in m; needs `--grouser-count`
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true, requires = "grouser_count")]
    pub(crate) grouser_height_m: Option<f64>,
    /// Number of lugs on the circumference
    #[arg(long, value_name = "N", requires = "grouser_height_m")]
    pub(crate) grouser_count: Option<u32>,
    /// Thickness of a lug along the circumference in m [default: 0]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true, requires = "grouser_count")]
    pub(crate) grouser_thickness_m: Option<f64>,
}

impl GrouserArguments {
    /// A wheel of this radius and width (m) with these lugs.
    pub(crate) fn on(&self, radius: f64, width: f64) -> grouser_terra::Result<RigidWheel> {
        let bare = RigidWheel::new(radius, width)?;
        match (self.grouser_height_m, self.grouser_count) {
            (Some(height), Some(count)) => bare.with_grousers(lugs(
                height,
                f64::from(count),
                self.grouser_thickness_m.unwrap_or(0.0),
            )),
            _ => Ok(bare),
        }
    }
}

/// `--gravity-m-per-s2`, which precedes what a robot file says.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct GravityArgument {
    /// Gravity in m/s², or earth, moon or mars: what masses weigh [default: the robot file's, else earth]. The
    /// soil's numbers stay as they are
    #[arg(long = "gravity-m-per-s2", value_name = "G", value_parser = parse_gravity)]
    given: Option<f64>,
}

impl GravityArgument {
    /// Gravity of a wheel whose mass may be given, m/s².
    ///
    /// # Errors
    /// A gravity without a mass, which would have no effect.
    pub(crate) fn with_mass(self, has_mass: bool) -> Result<f64> {
        if self.given.is_some() && !has_mass {
            return Err(Error::usage(
                "`--gravity-m-per-s2` has an effect only with `--mass-kg`",
                "a load in N is the weight where the wheel is; give `--mass-kg` in its place, or no gravity",
            ));
        }
        Ok(self.given.unwrap_or(EARTH_GRAVITY_M_PER_S2))
    }

    /// The gravity that was given, m/s².
    pub(crate) const fn given(self) -> Option<f64> {
        self.given
    }

    /// The robot under the gravity that was given, else under its own.
    pub(crate) fn of(self, model: RobotModel) -> RobotModel {
        match self.given {
            Some(gravity) => model.under_gravity(gravity),
            None => model,
        }
    }
}

/// `--max-slip`.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct MaxSlip {
    /// Maximum slip, driving or braking, at which a slope counts as held
    #[arg(long, value_name = "S", value_parser = parse_max_slip, default_value_t = MAX_SLIP)]
    pub(crate) max_slip: f64,
}

impl MaxSlip {
    pub(crate) fn settings(self) -> Settings {
        Settings {
            max_slip: self.max_slip,
            ..Settings::default()
        }
    }
}

fn parse_max_slip(text: &str) -> std::result::Result<f64, String> {
    let slip = parse_finite(text)?;
    let (low, high) = MAX_SLIP_LIMITS;
    if (low..=high).contains(&slip) {
        Ok(slip)
    } else {
        Err(format!("must lie in [{low}, {high}]"))
    }
}

/// Gravity by its value or by the body it is of.
fn parse_gravity(text: &str) -> std::result::Result<f64, String> {
    if let Some(gravity) = gravity_of(text) {
        return Ok(gravity);
    }
    let gravity = parse_finite(text)
        .map_err(|reason| format!("{reason}; a number in m/s² or earth, moon or mars"))?;
    let (low, high) = GRAVITY_LIMITS_M_PER_S2;
    if gravity >= low && gravity <= high {
        Ok(gravity)
    } else {
        Err(format!("must lie in [{low}, {high}] m/s²"))
    }
}

impl WheelArguments {
    /// The wheel on its soil; the soil is noted in the session.
    pub(crate) fn pair(
        &self,
        session: &mut Session,
        settings: Settings,
    ) -> Result<(WheelOnSoil, Chosen)> {
        let refuse = |error| Names::Flags.error(&error);
        let wheel = self
            .grousers
            .on(self.radius_m, self.width_m)
            .map_err(refuse)?;
        let mut chosen = self.soil.choose(session)?;
        if let Some(rebound) = self.rebound {
            chosen.soil = chosen.soil.with_rebound(rebound).map_err(refuse)?;
        }
        let pair = WheelOnSoil::new(wheel, chosen.soil, settings).map_err(refuse)?;
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

/// Lugs by their sizes in m.
pub(crate) fn lugs(height: f64, count: f64, thickness: f64) -> Grousers {
    Grousers {
        height,
        rule: GrouserRule::Lugs { count, thickness },
    }
}
