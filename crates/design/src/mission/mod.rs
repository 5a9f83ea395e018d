//! The wheel of a robot for a mission: slopes and soils with their shares of the way.
//!
//! A [`MissionProfile`] knows the robot's wheels, what they carry on each slope, the soils, the bounds of the new wheel's sizes and a formula
//! for its mass. [`MissionProfile::evaluate`] computes what one wheel does on it; [`MissionProfile::front`] finds the wheels of least energy
//! per metre for their mass, every one of them with a reserve of pull on every slope and soil.
//!
//! ```
//! use grouser_design::mission::*;
//! use grouser_terra::catalogue;
//!
//! // Four powered wheels, 160 N in all, on the level and on 5 degrees of dry sand.
//! let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
//! let slopes = [(0.0, 0.8), (5.0, 0.2)].map(|(slope_deg, share)| SlopeShare { slope_deg, share });
//! let present = WheelDesign { radius: 0.12, width: 0.10, ..WheelDesign::default() };
//! let mut params = MissionParams::new(
//!     vec![MissionWheel::designed(); 4],
//!     vec![SoilShare { name: "dry-sand".into(), soil, share: 1.0 }],
//!     slopes.to_vec(),
//!     WheelRanges { width: (0.05, 0.2), ..WheelRanges::fixed(&present) },
//! );
//! params.mass_formula = "40 * radius_m * width_m".into();
//! let mission = MissionProfile::new(params, |_, mass, _| {
//!     let weight = 160.0 + 4.0 * 9.81 * mass;
//!     let loads = slopes.iter().map(|s| vec![weight / 4.0 * s.slope_deg.to_radians().cos(); 4]);
//!     Ok::<_, grouser_design::Error>(Standing { weight, loads: loads.collect() })
//! })?;
//! let evaluated = mission.evaluate(&present)?;
//! assert!((evaluated.wheel_mass - 0.48).abs() < 1e-12 && evaluated.least_reserve() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! All powered wheels share one slip, which holds the slope: it is a result, not a variable. Energy is that of the torque at the
//! wheels. What the model does not decide: strength, wear and life of the wheel, obstacles, turning, ruts.

mod evaluation;
mod file;
mod front;
mod functions;
mod profile;
mod stance;
mod station;
mod wheel;
mod write;

use grouser_real::OutOfRange;
use grouser_terra::slope::{MAX_SLIP, MAX_SLIP_LIMITS};
use grouser_terra::{RigidWheel, Settings, WheelOnSoil};

use crate::error::{Error, Result};
use crate::formula::{Formula, VariableNames};
use crate::quantity::Fixed;
use stance::Stance;
use wheel::SIZES;

pub use evaluation::{DesignPoint, StationResult};
pub use file::{MissionFile, parse, shares};
pub use front::{Choice, FrontProgress, FrontSettings, MissionFront};
pub use profile::{MAX_SLOPE_DEG, SlopeShare, SoilShare};
pub use stance::Standing;
pub use wheel::{WheelDesign, WheelRanges};
pub use write::to_toml;

/// The mass of a wheel where the user has no formula, kg: rim and one disc of aluminium sheet of 2 mm (2700 kg/m³), and solid
/// lugs of the same metal. It stands for no real wheel: hub, gear and stiffeners are not in it.
pub const SHEET_WHEEL_MASS_KG: &str = "2700 * (0.002 * (2*pi*radius_m*width_m + pi*radius_m^2) + grouser_count*grouser_height_m*grouser_thickness_m*width_m)";

/// The least reserve of pull where nothing else is given, share of the weight: as much as three degrees of slope.
pub const DEFAULT_MIN_RESERVE: f64 = 0.05;

/// How the energies of several soils become one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SoilMeasure {
    /// The energy on the worst of them (minimax).
    #[default]
    Worst,
    /// Their mean by the soils' shares.
    Mean,
}

impl SoilMeasure {
    /// Every measure with its name in files and flags.
    pub const ALL: [(&'static str, Self); 2] = [("worst", Self::Worst), ("mean", Self::Mean)];

    /// Its name in files and flags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

/// One wheel of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MissionWheel {
    /// The wheel that stays; `None`: it becomes the designed one.
    pub kept: Option<RigidWheel>,
    /// Friction of the bearing of a free wheel, N m; `None`: powered.
    pub bearing: Option<f64>,
}

impl MissionWheel {
    /// A powered wheel that becomes the designed one.
    #[must_use]
    pub const fn designed() -> Self {
        Self {
            kept: None,
            bearing: None,
        }
    }

    /// A wheel that stays as it is; free with the friction of its bearing (N m), else powered.
    #[must_use]
    pub const fn kept(wheel: RigidWheel, bearing: Option<f64>) -> Self {
        Self {
            kept: Some(wheel),
            bearing,
        }
    }
}

/// What a mission consists of.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MissionParams {
    /// The robot's wheels.
    pub wheels: Vec<MissionWheel>,
    /// The soils.
    pub soils: Vec<SoilShare>,
    /// The slopes.
    pub slopes: Vec<SlopeShare>,
    /// The bounds of the new wheel.
    pub ranges: WheelRanges,
    /// A radius outside the bounds that can be evaluated too, m: that of the present wheel.
    pub also_radius: Option<f64>,
    /// The mass of one wheel in kg, over [`WheelDesign::NAMES`].
    pub mass_formula: String,
    /// Where the formula was written, for messages.
    pub mass_place: String,
    /// How the soils are joined.
    pub measure: SoilMeasure,
    /// Least reserve of pull on every slope and soil, share of the weight.
    pub min_reserve: f64,
    /// No slip above this counts.
    pub max_slip: f64,
}

impl MissionParams {
    /// A mission with [`SHEET_WHEEL_MASS_KG`], the worst soil, [`DEFAULT_MIN_RESERVE`] and [`MAX_SLIP`].
    #[must_use]
    pub fn new(
        wheels: Vec<MissionWheel>,
        soils: Vec<SoilShare>,
        slopes: Vec<SlopeShare>,
        ranges: WheelRanges,
    ) -> Self {
        Self {
            wheels,
            soils,
            slopes,
            ranges,
            also_radius: None,
            mass_formula: SHEET_WHEEL_MASS_KG.to_owned(),
            mass_place: "the formula of the mass".to_owned(),
            measure: SoilMeasure::default(),
            min_reserve: DEFAULT_MIN_RESERVE,
            max_slip: MAX_SLIP,
        }
    }
}

/// Wheels that are alike and always carry alike.
#[derive(Clone, Debug)]
struct Group {
    /// One of them, by its place in the stance.
    wheel: usize,
    count: f64,
    kept: Option<RigidWheel>,
    bearing: Option<f64>,
    /// By soil: what the sizes of the new wheel are put into.
    fixed: Vec<Fixed>,
    /// By soil, of a wheel that stays.
    kept_on_soil: Vec<Option<WheelOnSoil>>,
}

/// A checked mission.
#[derive(Clone, Debug)]
pub struct MissionProfile {
    params: MissionParams,
    mass: Formula,
    stance: Stance,
    groups: Vec<Group>,
}

/// The interpolated loads are within this share of the weight, or the mission is refused.
const MAX_LOAD_ERROR: f64 = 1e-6;

impl MissionProfile {
    /// Checks everything, and samples what the wheels carry: `stand` gives it for a radius (m) and a mass (kg) of the new wheel and a shift of the
    /// chassis' mass forwards (m), by slope and by wheel in the order of the parameters.
    ///
    /// # Errors
    /// A share, bound, slope or limit out of its range, a wrong formula, wheels that the laws refuse, no designed wheel; what
    /// `stand` returns.
    pub fn new<E: From<Error>>(
        params: MissionParams,
        stand: impl FnMut(f64, f64, f64) -> std::result::Result<Standing, E>,
    ) -> std::result::Result<Self, E> {
        params.check()?;
        if let Some(radius) = params.also_radius {
            OutOfRange::check("also_radius", radius, (1e-3, 1e2), "m")
                .map_err(Error::OutOfRange)?;
        }
        let names = VariableNames::new(WheelDesign::NAMES.into_iter().take(WheelDesign::SIZES));
        let mass =
            Formula::parse(&params.mass_formula, &names).map_err(|source| Error::Formula {
                at: grouser_files::Place {
                    file: params.mass_place.clone(),
                    line: 1,
                    column: 1,
                },
                name: "wheel_mass_kg".to_owned(),
                source,
            })?;
        let (low, high) = params.ranges.radius;
        let also = params.also_radius.unwrap_or(low);
        let radii = (low.min(also), high.max(also));
        let stance = Stance::sample(radii, params.ranges.mass_shift, stand)?;
        if stance.wheels() != params.wheels.len() {
            return Err(Error::Mission(format!(
                "{} wheels have loads, but the mission has {}",
                stance.wheels(),
                params.wheels.len()
            ))
            .into());
        }
        if !(stance.error <= MAX_LOAD_ERROR) {
            return Err(Error::Mission(format!(
                "the wheels' loads are interpolated with an error of {:.1e} of the weight, but must be within \
                 {MAX_LOAD_ERROR:e}: narrow the bounds of radius_m and mass_shift_m",
                stance.error
            ))
            .into());
        }
        let groups = groups(&params, &stance)?;
        let mission = Self {
            params,
            mass,
            stance,
            groups,
        };
        mission.check_mass()?;
        Ok(mission)
    }

    /// What it consists of.
    #[must_use]
    pub const fn params(&self) -> &MissionParams {
        &self.params
    }

    /// The mass of a wheel by the formula, kg.
    #[must_use]
    pub fn wheel_mass(&self, wheel: &WheelDesign) -> f64 {
        self.mass.evaluate(&wheel.sizes())
    }

    /// Weight of the robot with a wheel, N.
    #[must_use]
    pub fn weight(&self, wheel: &WheelDesign) -> f64 {
        self.stance.weight(self.wheel_mass(wheel))
    }

    /// The formula has a positive mass at the corners and in the middle of the bounds.
    fn check_mass(&self) -> Result<()> {
        let ranges = self.params.ranges.list();
        let at = |pick: &dyn Fn(usize) -> f64| {
            let mut sizes = [0.0; SIZES];
            for (index, (size, (low, high))) in sizes.iter_mut().zip(ranges).enumerate() {
                *size = low + pick(index) * (high - low);
            }
            WheelDesign::from_sizes(sizes)
        };
        let corners = (0..1_usize << SIZES)
            .map(|bits| at(&|index| if bits >> index & 1 == 1 { 1.0 } else { 0.0 }));
        for wheel in corners.chain(std::iter::once(at(&|_| 0.5))) {
            let mass = self.wheel_mass(&wheel);
            let what = format!(
                "wheel_mass_kg at a radius of {} m and a width of {} m",
                wheel.radius, wheel.width
            );
            OutOfRange::check(what, mass, (1e-9, 1e9), "kg").map_err(Error::OutOfRange)?;
        }
        Ok(())
    }
}

impl MissionParams {
    fn check(&self) -> Result<()> {
        profile::check_slopes(&self.slopes)?;
        profile::check_soils(&self.soils)?;
        self.ranges.check()?;
        if self.wheels.iter().all(|wheel| wheel.kept.is_some()) {
            return Err(Error::Mission(
                "no wheel of the robot is to be designed".to_owned(),
            ));
        }
        OutOfRange::check("min_reserve", self.min_reserve, (0.0, 1.0), "1")
            .and_then(|()| OutOfRange::check("max_slip", self.max_slip, MAX_SLIP_LIMITS, "1"))
            .map_err(Error::OutOfRange)
    }
}

fn groups(params: &MissionParams, stance: &Stance) -> Result<Vec<Group>> {
    let mut groups: Vec<Group> = Vec::new();
    for (index, wheel) in params.wheels.iter().enumerate() {
        let alike = groups.iter_mut().find(|group| {
            group.kept == wheel.kept
                && group.bearing == wheel.bearing
                && stance.carry_alike(group.wheel, index)
        });
        if let Some(group) = alike {
            group.count += 1.0;
            continue;
        }
        let (mut fixed, mut kept_on_soil) = (Vec::new(), Vec::new());
        for soil in &params.soils {
            let mut own = Fixed::default();
            own.set_soil(&soil.soil);
            let on_soil = match wheel.kept {
                None => None,
                Some(kept) => {
                    own.set_wheel(&kept);
                    let law = |source| Error::Law {
                        of: format!("wheel {} on {}", index + 1, soil.name),
                        source,
                    };
                    Some(WheelOnSoil::new(kept, soil.soil, Settings::default()).map_err(law)?)
                }
            };
            fixed.push(own);
            kept_on_soil.push(on_soil);
        }
        groups.push(Group {
            wheel: index,
            count: 1.0,
            kept: wheel.kept,
            bearing: wheel.bearing,
            fixed,
            kept_on_soil,
        });
    }
    Ok(groups)
}
