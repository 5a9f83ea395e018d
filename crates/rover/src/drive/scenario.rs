//! What a drive is: robot, ground, way, sensors, faults, controller.

use std::path::PathBuf;

use grouser_files::nearest;
use grouser_slip::control::ControlSettings;
use grouser_slip::filter::SlipFilter;
use grouser_slip::onboard::OnBoardSettings;
use grouser_terra::{Angle, Settings, ShearLaw, Soil, SoilParams, WheelOnSoil, catalogue};

use crate::error::{Error, Result};
use crate::ground::{Ground, HeightFile, HeightMap, Packing, Place, Rocks, Shape, read_heights};
use crate::robot::RobotModel;
use crate::sensors::{Schedule, SensorSettings};

/// Limits of a setpoint that is computed. Below, the wheels' own scatter of slip is larger than the setpoint; above, a
/// wheel digs in faster than a controller can react.
const MIN_SETPOINT_SLIP: f64 = 0.01;
const MAX_SETPOINT_SLIP: f64 = 0.8;
/// The first slip of a wheel at rest is known after this number of windows: four in which it has few ticks, and the next reading.
const FIRST_SLIP_STEPS: f64 = 5.0;

/// One stretch of the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Requested speed, m/s; negative: backwards.
    pub speed: f64,
    /// Requested heading, rad.
    pub heading: f64,
    /// It ends after this progress along the heading, m.
    pub distance: Option<f64>,
    /// It ends after this time, s.
    pub duration: Option<f64>,
}

impl Leg {
    /// A leg at a speed (m/s) along a heading (rad) over a distance (m).
    #[must_use]
    pub const fn over(speed: f64, heading: f64, distance: f64) -> Self {
        Self {
            speed,
            heading,
            distance: Some(distance),
            duration: None,
        }
    }
}

/// A drive that plans its way itself, in place of legs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanSpec {
    /// Where it leads, m.
    pub goal: (f64, f64),
    /// Requested speed, m/s.
    pub speed: f64,
    /// Size of the cells that are planned on, m.
    pub cell: f64,
    /// Directions that are planned with: 4, 8 or 16.
    pub headings: u8,
    /// Bound on the probability that a place of the way cannot be left again.
    pub max_risk: f64,
    /// Energy of a turn by one of 8 headings, J.
    pub turn_energy: f64,
    /// How far beyond the rectangle of start and goal the robot may go, m.
    pub margin: f64,
}

/// Soil that is learnt while driving; without it the robot takes the first soil of the scenario for known. A drive that plans
/// its way learns by tiles, one along legs a single soil that follows the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LearnSpec {
    /// Side of a tile of a drive that plans its way, m.
    pub tile: f64,
    /// The robot uses a new belief once it differs from the one in use by this probability.
    pub hysteresis: f64,
}

/// The shape of the ground.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GroundShape {
    /// Generated, over an extent along x and y (m) with cells of a size (m).
    Generated {
        /// The shape.
        shape: Shape,
        /// m.
        size: (f64, f64),
        /// m.
        cell: f64,
    },
    /// Read from a file.
    File(HeightFile),
}

/// A soil by its name.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilSpec {
    /// The name that regions use.
    pub name: String,
    /// Where its numbers come from.
    pub origin: SoilOrigin,
    /// What the scenario gives in place of those numbers.
    pub changes: SoilChanges,
    /// The soil.
    pub soil: Soil,
    /// Where its numbers come from, in words.
    pub source: String,
}

/// Where the numbers of a scenario's soil come from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SoilOrigin {
    /// The catalogue's soil of this key.
    Catalogue(String),
    /// A soil file.
    File(PathBuf),
}

/// Numbers that a scenario gives in place of a soil's own, in the order and the units of [`KEYS`](Self::KEYS).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SoilChanges(pub [Option<f64>; 9]);

impl SoilChanges {
    /// The keys, as in a scenario's `[[soil]]`.
    pub const KEYS: [&'static str; 9] = [
        "k_shear_m",
        "c_1",
        "c_2",
        "unit_weight_n_per_m3",
        "n_1",
        "n_2",
        "phi_deg",
        "cohesion_kpa",
        "rebound",
    ];
}

impl SoilSpec {
    /// A soil of the catalogue or of a soil file, with `changes`.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a key that the catalogue does not have; what the soil file has wrong; [`Error::Law`] for numbers
    /// that the laws refuse.
    ///
    /// ```
    /// use grouser_rover::drive::{SoilChanges, SoilOrigin, SoilSpec};
    ///
    /// let origin = SoilOrigin::Catalogue("dry-sand".to_owned());
    /// let sand = SoilSpec::new("sand", origin, SoilChanges::default())?;
    /// assert_eq!(sand.soil.params().n, 1.1);
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    pub fn new(name: &str, origin: SoilOrigin, changes: SoilChanges) -> Result<Self> {
        let of = |source| Error::Law {
            of: format!("soil \"{name}\""),
            source,
        };
        let [
            k_shear,
            c_1,
            c_2,
            unit_weight,
            n_1,
            n_2,
            phi,
            cohesion,
            rebound,
        ] = changes.0;
        let completion = catalogue::Completion {
            k_shear,
            c_1,
            c_2,
            unit_weight,
        };
        let (whole, from) = match &origin {
            SoilOrigin::File(path) => {
                let file = grouser_files::soil::read(path)?;
                (
                    file.completed(&completion),
                    format!("{} ({})", file.name, file.source),
                )
            }
            SoilOrigin::Catalogue(key) => {
                let entry = catalogue::find(key).ok_or_else(|| {
                    let keys = catalogue::entries().iter().map(|entry| entry.key);
                    Error::Unknown {
                        of: format!("soil \"{name}\""),
                        name: key.clone(),
                        meant: nearest(key, keys).map(Into::into),
                    }
                })?;
                (
                    entry.completed(&completion),
                    format!("{key} ({})", entry.source),
                )
            }
        };
        let p = *whole.map_err(of)?.params();
        let soil = Soil::new(SoilParams {
            n_1: n_1.unwrap_or(p.n_1),
            n_2: n_2.unwrap_or(p.n_2),
            phi: phi.map_or(p.phi, Angle::from_deg),
            cohesion: cohesion.map_or(p.cohesion, |kpa| 1e3 * kpa),
            rebound: rebound.unwrap_or(p.rebound),
            ..p
        })
        .map_err(of)?;
        // Slip changes the exponent: both ends must stay inside the law.
        let p = soil.params();
        for n in [p.n + p.n_1, p.n + p.n_2] {
            let of = format!("soil \"{name}\"");
            Error::check(&of, "n at full slip", n, (0.1, 3.0), "1")?;
        }
        Ok(Self {
            name: name.to_owned(),
            origin,
            changes,
            soil,
            source: if changes == SoilChanges::default() {
                from
            } else {
                format!("{from}, completed by the scenario")
            },
        })
    }
}

/// A soil in a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Index of the soil.
    pub soil: usize,
    /// Where.
    pub place: Place,
    /// The place is moved by up to this much along x and y, m, by the seed.
    pub wander: f64,
}

/// The ground of a scenario.
///
/// ```
/// use grouser_rover::drive::read_scenario;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
/// let spec = read_scenario(file.as_ref())?.ground;
/// let (one, two) = (spec.build(1)?, spec.build(2)?);
/// assert_ne!(one.at(5.0, 0.0).height, two.at(5.0, 0.0).height); // the dunes depend on the seed
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GroundSpec {
    /// Its shape.
    pub shape: GroundShape,
    /// Its soils, the first where no region lies.
    pub soils: Vec<SoilSpec>,
    /// Regions, later ones upon earlier ones.
    pub regions: Vec<Region>,
    /// Packing and scatter.
    pub packing: Packing,
    /// Rocks, if any.
    pub rocks: Option<Rocks>,
    /// The law of shear that the simulated ground obeys, where it is another one than that of the soils, by which the
    /// robot's computer estimates.
    pub world_laws: Option<ShearLaw>,
}

/// A scenario.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scenario {
    /// Its name, from its file.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// The robot's file.
    pub robot_file: PathBuf,
    /// The robot.
    pub robot: RobotModel,
    /// Seed of ground and noise.
    pub seed: u64,
    /// It ends at the latest after this time, s.
    pub duration: f64,
    /// Step of the simulation, s; else as long as the robot and its ground allow.
    pub step: Option<f64>,
    /// x, y (m) and heading (rad) of the start.
    pub start: (f64, f64, f64),
    /// The ground.
    pub ground: GroundSpec,
    /// The way; one leg straight to the goal where the drive plans its way.
    pub legs: Vec<Leg>,
    /// How it plans its way, where it does.
    pub plan: Option<PlanSpec>,
    /// How it learns its soil, where it does.
    pub learn: Option<LearnSpec>,
    /// The sensors.
    pub sensors: SensorSettings,
    /// The faults.
    pub faults: Schedule,
    /// The controller.
    pub control: ControlSettings,
    /// The slip setpoint that the file gives; else the optimiser's.
    pub optimum: Option<f64>,
    /// Power that electronics draw all the time, W.
    pub hotel: f64,
}

impl GroundSpec {
    /// A ground of one soil, without rocks, scatter and packing.
    #[must_use]
    pub fn new(shape: GroundShape, soil: SoilSpec) -> Self {
        Self {
            shape,
            soils: vec![soil],
            regions: Vec::new(),
            packing: Packing::default(),
            rocks: None,
            world_laws: None,
        }
    }

    /// The ground with everything that the seed decides.
    ///
    /// # Errors
    /// What its file, its sizes or its soils have wrong.
    pub fn build(&self, seed: u64) -> Result<Ground> {
        let map = match &self.shape {
            GroundShape::Generated { shape, size, cell } => {
                let half = 0.5 * size.1;
                let rocks = self.rocks.map_or_else(Vec::new, |rocks| {
                    rocks.strew(seed, (0.0, -half), (size.0, half), 1.5)
                });
                HeightMap::from_lines(*size, *cell, |y| {
                    let (mut height, rocks) = (shape.along(seed, y), &rocks);
                    move |x| height(x) + Rocks::height(rocks, x, y)
                })?
            }
            GroundShape::File(file) => read_heights(file)?,
        };
        let soils: Result<Vec<Soil>> = self.soils.iter().map(|spec| self.in_world(spec)).collect();
        let mut ground = Ground::new(map, soils?)?;
        let mut noise = crate::ground::Noise::new(seed, 50);
        for region in &self.regions {
            let mut move_by = || region.wander * (2.0 * noise.uniform() - 1.0);
            let (right, up) = (move_by(), move_by());
            ground.lay(region.soil, &region.place.moved(right, up))?;
        }
        ground.pack(self.packing, seed)?;
        Ok(ground)
    }
}

impl GroundSpec {
    /// A soil as the simulated ground obeys it.
    fn in_world(&self, spec: &SoilSpec) -> Result<Soil> {
        let Some(law) = self.world_laws else {
            return Ok(spec.soil);
        };
        let mut laws = spec.soil.params().laws;
        laws.shear = Some(law);
        Soil::new(SoilParams {
            laws,
            ..*spec.soil.params()
        })
        .map_err(|source| Error::Law {
            of: format!("soil \"{}\"", spec.name),
            source,
        })
    }
}

impl Scenario {
    /// A scenario without legs, of usual sensors and controller, that ends after `duration` (s) at the latest.
    #[must_use]
    pub fn new(
        title: &str,
        robot: (PathBuf, RobotModel),
        ground: GroundSpec,
        duration: f64,
    ) -> Self {
        let (robot_file, robot) = robot;
        Self {
            name: String::new(),
            title: title.to_owned(),
            robot_file,
            robot,
            seed: 1,
            duration,
            step: None,
            start: (0.0, 0.0, 0.0),
            ground,
            legs: Vec::new(),
            plan: None,
            learn: None,
            sensors: SensorSettings::default(),
            faults: Schedule::default(),
            control: ControlSettings::default(),
            optimum: None,
            hotel: 0.0,
        }
    }

    /// Checks the numbers against each other.
    ///
    /// # Errors
    /// [`Error::Missing`], [`Error::OutOfRange`].
    pub fn check(&self) -> Result<()> {
        let of = format!("scenario \"{}\"", self.name);
        if self.legs.is_empty() {
            return Err(Error::Missing {
                of,
                what: "a [[leg]] or a [plan]".into(),
            });
        }
        for leg in &self.legs {
            if self.plan.is_none() && leg.distance.is_none() && leg.duration.is_none() {
                return Err(Error::Missing {
                    of: format!("a [[leg]] of {of}"),
                    what: "`distance_m` or `duration_s`".into(),
                });
            }
        }
        Error::check(&of, "duration", self.duration, (0.1, 1e6), "s")?;
        self.sensors.check()?;
        self.control.check()?;
        // until then no wheel has a slip, and the drive would end as one without sensors
        let first_slip =
            OnBoardSettings::new(&self.robot.robot).warm_up + FIRST_SLIP_STEPS * SlipFilter::STEP_S;
        let blind_time = self.control.blind_time;
        Error::check(&of, "blind_time", blind_time, (first_slip, 1e3), "s")
    }

    /// The same at a share of its requested speeds: the baseline of a controller is open loop at the controller's own
    /// mean speed ([`equal_speed_share`](super::equal_speed_share)).
    #[must_use]
    pub fn at_pace(&self, share: f64) -> Self {
        let mut slower = self.clone();
        for leg in &mut slower.legs {
            leg.speed *= share;
        }
        slower
    }

    /// Does the robot's own computer learn the soil? A drive that plans its way leaves that to the navigator.
    #[must_use]
    pub const fn learns_on_board(&self) -> bool {
        self.learn.is_some() && self.plan.is_none()
    }

    /// Mean load of the robot's powered wheels on the level, N, and the first of them.
    ///
    /// ```
    /// use grouser_rover::drive::read_scenario;
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
    /// let (wheel, load) = read_scenario(file.as_ref())?.typical_wheel().expect("a powered wheel");
    /// assert!(wheel == 0 && load > 10.0); // N
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    #[must_use]
    pub fn typical_wheel(&self) -> Option<(usize, f64)> {
        let loads = crate::statics::wheel_loads(&self.robot, 0.0, 0.0);
        let powered: Vec<usize> = self.robot.powered().collect();
        let first = *powered.first()?;
        let sum: f64 = powered.iter().map(|index| loads.loads[*index]).sum();
        Some((first, sum / powered.len() as f64))
    }

    /// The slip that the controller runs at: the scenario's `optimum`; without one that of the greatest tractive
    /// efficiency of the [typical wheel](Self::typical_wheel) on the first soil, within 0.01 to 0.8.
    ///
    /// ```
    /// use grouser_rover::drive::read_scenario;
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
    /// let slip = read_scenario(file.as_ref())?.slip_setpoint()?;
    /// assert!(0.2 < slip && slip < 0.6);
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Missing`] where the robot has no powered wheel, [`Error::NoSlipSetpoint`] where no slip gives any pull.
    pub fn slip_setpoint(&self) -> Result<f64> {
        if let Some(slip) = self.optimum {
            return Ok(slip);
        }
        let (wheel, load) = self.typical_wheel().ok_or_else(|| Error::Missing {
            of: "the robot".to_owned(),
            what: "a powered wheel".to_owned(),
        })?;
        let (mount, ground) = (&self.robot.wheels[wheel], &self.ground.soils[0]);
        let best = WheelOnSoil::new(mount.wheel, ground.soil, Settings::default())
            .and_then(|contact| contact.slip_of_maximum_efficiency(load))
            .map_err(|source| Error::Law {
                of: format!("wheel \"{}\"", mount.name),
                source,
            })?
            .ok_or_else(|| Error::NoSlipSetpoint {
                wheel: mount.name.clone(),
                soil: ground.name.clone(),
                load,
            })?;
        Ok(best
            .slip
            .value()
            .clamp(MIN_SETPOINT_SLIP, MAX_SETPOINT_SLIP))
    }
}
