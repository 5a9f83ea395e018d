//! What a robot needs to keep moving on a plane: slip, energy, sinkage. The exact solver behind every table.

mod wheel_nodes;

use std::cell::RefCell;

use grouser_rover::robot::{RobotModel, WheelMount};
use grouser_rover::statics::wheel_loads;
use grouser_terra::slope::{
    HeldSlip, MAX_SLIP, MAX_SLIP_LIMITS, SlopeSearch, crossing, greatest_surplus, held_slip,
};
use grouser_terra::{Cautions, Kinematics, Settings, Slip, Soil, WheelOnSoil};

use crate::error::{Error, Result};
use wheel_nodes::PosedOnNodes;
pub(crate) use wheel_nodes::{NodeSpacing, WheelNodes};

/// No slope is steeper, rad: loads and sinkage are those of a wheel that is pressed into the ground.
pub const MAX_SLOPE_RAD: f64 = 1.2;

/// What a robot needs on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// It drives steadily.
    Drives(Driving),
    /// No slip up to the greatest gives the pull that the slope takes.
    Immobilised,
    /// Downhill no braking slip holds it.
    Slides,
    /// A wheel loses the ground: the robot does not stand as its description poses it.
    Lifts,
}

/// A robot that drives steadily straight ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driving {
    /// The slip that all powered wheels share; negative where they brake.
    pub slip: f64,
    /// Work of the torque at the powered wheels per metre of travel, J/m; negative where they brake more than they drive.
    pub work_per_metre: f64,
    /// The greatest sinkage of a wheel, m.
    pub sinkage: f64,
    /// What to keep in mind about its wheels.
    pub cautions: Cautions,
}

impl Driving {
    /// Energy per metre of travel that the wheels take from the motors, J/m: braking gives nothing back.
    #[must_use]
    pub fn energy_per_metre(&self) -> f64 {
        self.work_per_metre.max(0.0)
    }
}

/// A robot on one soil.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_terra::catalogue;
/// use grouser_terrain::{Demand, DemandSolver};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let solver = DemandSolver::new(RobotModel::read(file.as_ref())?, soil)?;
/// let Demand::Drives(level) = solver.demand(0.0, 0.0)? else { panic!("it drives on the level") };
/// let Demand::Drives(uphill) = solver.demand(0.1, 0.0)? else { panic!("it climbs 6°") };
/// assert!(0.0 < level.slip && level.slip < uphill.slip);
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct DemandSolver {
    model: RobotModel,
    contacts: Vec<WheelOnSoil>,
    weight: f64,
    max_slip: f64,
}

/// A robot on a plane: what each wheel carries, and what does not depend on the slip of the powered ones.
pub(crate) struct Posed<'a> {
    solver: &'a DemandSolver,
    loads: Vec<f64>,
    /// What the slope takes less the pull of the free wheels, N.
    needed: f64,
    /// Sinkage of the free wheels, m.
    free_sinkage: f64,
    free_cautions: Cautions,
    /// The powered wheels by nodes in place of the exact laws.
    nodes: Option<PosedOnNodes<'a>>,
}

impl DemandSolver {
    /// A robot on a soil, under the robot's gravity.
    ///
    /// # Errors
    /// [`Error::Law`] for a wheel that the laws refuse on this soil, [`Error::DoesNotStand`].
    pub fn new(model: RobotModel, soil: Soil) -> Result<Self> {
        let contacts = model
            .wheels
            .iter()
            .map(|mount| {
                WheelOnSoil::new(mount.wheel, soil, Settings::default())
                    .map_err(|source| of_wheel(&mount.name, source))
            })
            .collect::<Result<Vec<_>>>()?;
        let level = wheel_loads(&model, 0.0, 0.0);
        let least = level.loads.iter().copied().fold(f64::INFINITY, f64::min);
        if !(least >= 0.0) {
            return Err(Error::DoesNotStand {
                name: model.robot.name().to_owned(),
                load: least,
            });
        }
        let weight = model.weight();
        Ok(Self {
            model,
            contacts,
            weight,
            max_slip: MAX_SLIP,
        })
    }

    /// The same, with slopes held at a slip of at most `max_slip` in place of [`MAX_SLIP`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside [`MAX_SLIP_LIMITS`].
    pub fn with_max_slip(mut self, max_slip: f64) -> Result<Self> {
        Error::check("robot", "max_slip", max_slip, MAX_SLIP_LIMITS, "1")?;
        self.max_slip = max_slip;
        Ok(self)
    }

    /// The greatest slip at which a slope is held.
    #[must_use]
    pub const fn max_slip(&self) -> f64 {
        self.max_slip
    }

    /// The steepest slope (rad) that the robot climbs straight on, and its slip; `None` where not even the level is held. It is
    /// at most the slope on which a wheel loses the ground, and [`MAX_SLOPE_RAD`].
    ///
    /// # Errors
    /// [`Error::Law`].
    ///
    /// ```
    /// use grouser_rover::robot::RobotModel;
    /// use grouser_terra::catalogue;
    /// use grouser_terrain::{Demand, DemandSolver};
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
    /// let solver = DemandSolver::new(RobotModel::read(file.as_ref())?, soil)?;
    /// let (slope, slip) = solver.steepest()?.expect("it moves on the level");
    /// assert!(0.19 < slope && slope < 0.2 && slip == 0.6);
    /// assert_eq!(solver.demand(slope + 1e-6, 0.0)?, Demand::Immobilised);
    /// # Ok::<(), grouser_terrain::Error>(())
    /// ```
    pub fn steepest(&self) -> Result<Option<(f64, f64)>> {
        const HALVINGS: u32 = 50;
        let stands = |pitch: f64| wheel_loads(&self.model, pitch, 0.0).stands;
        let (mut low, mut high) = (0.0, MAX_SLOPE_RAD);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if stands(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let skids = RefCell::default();
        let surplus = |pitch: f64, slip: f64| {
            let posed = self.posed_near(pitch, 0.0, &mut skids.borrow_mut())?;
            posed.map_or(Ok(None), |posed| posed.surplus(slip))
        };
        let search = SlopeSearch {
            weight: self.weight,
            slopes: (0.0, low),
            max_slip: self.max_slip,
            near: None,
        };
        search.steepest(surplus, surplus)
    }

    /// The robot.
    #[must_use]
    pub const fn model(&self) -> &RobotModel {
        &self.model
    }

    /// What driving straight ahead takes on a plane tilted by `pitch` (rad, nose up positive) and `roll` (rad, left
    /// side up).
    ///
    /// Equation: Σ drawbar pulls = W sin(pitch), all powered wheels at one slip under the loads of
    /// [`wheel_loads`], free wheels at the skid at which the soil turns their bearing; the smallest slip in magnitude that
    /// solves it, driving or braking up to the greatest slip ([`held_slip`]).
    ///
    /// Assumes: steady motion along the robot's own axis; the drift down a side slope is not counted.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for angles beyond ±60°, [`Error::Law`].
    pub fn demand(&self, pitch: f64, roll: f64) -> Result<Demand> {
        const LIMITS_RAD: (f64, f64) = (-1.05, 1.05);
        Error::check("plane", "pitch", pitch, LIMITS_RAD, "rad")?;
        Error::check("plane", "roll", roll, LIMITS_RAD, "rad")?;
        let Some(posed) = self.posed(pitch, roll)? else {
            return Ok(Demand::Lifts);
        };
        Ok(match posed.held()? {
            HeldSlip::Holds(slip) => Demand::Drives(posed.driving(slip)?),
            HeldSlip::Slides => Demand::Slides,
            HeldSlip::Immobilised(_) => Demand::Immobilised,
        })
    }

    /// The robot on a plane; `None` where a wheel loses the ground.
    pub(crate) fn posed(&self, pitch: f64, roll: f64) -> Result<Option<Posed<'_>>> {
        self.posed_near(pitch, roll, &mut Vec::new())
    }

    /// As [`DemandSolver::posed`], where the skids of the free wheels are known nearly: they are replaced with these ones.
    pub(crate) fn posed_near(
        &self,
        pitch: f64,
        roll: f64,
        skids: &mut Vec<Slip>,
    ) -> Result<Option<Posed<'_>>> {
        let loads = wheel_loads(&self.model, pitch, roll);
        if !loads.stands {
            return Ok(None);
        }
        self.under(pitch, loads.loads, skids).map(Some)
    }

    /// The robot on a plane under given loads; wheels without one neither pull nor resist.
    pub(crate) fn under(
        &self,
        pitch: f64,
        loads: Vec<f64>,
        skids: &mut Vec<Slip>,
    ) -> Result<Posed<'_>> {
        let (mut pull, mut free_sinkage) = (0.0, 0.0_f64);
        let mut free_cautions = Cautions::default();
        let mut near = std::mem::take(skids).into_iter();
        for ((mount, contact), load) in self.model.wheels.iter().zip(&self.contacts).zip(&loads) {
            if mount.motor.is_some() || !(*load > 0.0) {
                continue;
            }
            let law = |source| of_wheel(&mount.name, source);
            // a wheel that cannot turn is dragged, locked
            let skid = match near.next() {
                Some(near) => contact.free_slip_near(*load, mount.bearing, near),
                None => contact.free_slip(*load, mount.bearing),
            };
            let skid = match skid.map_err(law)? {
                Some(skid) => skid,
                None => Slip::new(-1.0).map_err(law)?,
            };
            skids.push(skid);
            let solved = contact
                .under_load(*load, &Kinematics::straight(skid))
                .map_err(law)?;
            if let Some(point) = solved.point() {
                pull += point.forces.drawbar_pull;
                free_sinkage = free_sinkage.max(point.sinkage);
                free_cautions.insert_all(point.cautions);
            }
        }
        Ok(Posed {
            solver: self,
            loads,
            needed: self.weight * pitch.sin() - pull,
            free_sinkage,
            free_cautions,
            nodes: None,
        })
    }

    /// The wheels, each with its contact.
    pub(crate) fn wheels(&self) -> impl Iterator<Item = (&WheelMount, &WheelOnSoil)> {
        self.model.wheels.iter().zip(&self.contacts)
    }
}

impl<'a> Posed<'a> {
    /// A robot whose wheels are read from nodes; `free` is pull (N) and sinkage (m) of its free wheels.
    pub(crate) fn on_nodes(
        solver: &'a DemandSolver,
        (pitch, loads): (f64, Vec<f64>),
        free: (f64, f64),
        nodes: PosedOnNodes<'a>,
    ) -> Self {
        Self {
            solver,
            loads,
            needed: solver.weight * pitch.sin() - free.0,
            free_sinkage: free.1,
            free_cautions: Cautions::default(),
            nodes: Some(nodes),
        }
    }

    fn powered(&self) -> impl Iterator<Item = (&str, &WheelOnSoil, f64)> {
        let mounts = self.solver.model.wheels.iter();
        mounts
            .zip(&self.solver.contacts)
            .zip(&self.loads)
            .filter(|((mount, _), load)| mount.motor.is_some() && **load > 0.0)
            .map(|((mount, contact), load)| (mount.name.as_str(), contact, *load))
    }

    /// Pull of the powered wheels at this slip less what is needed, N; `None` where a wheel is not carried.
    pub(crate) fn surplus(&self, slip: f64) -> Result<Option<f64>> {
        if let Some(nodes) = &self.nodes {
            let pull = nodes.pull(slip)?;
            if !pull.is_nan() {
                return Ok((pull > f64::NEG_INFINITY).then_some(pull - self.needed));
            }
        }
        let mut sum = -self.needed;
        for (name, contact, load) in self.powered() {
            let law = |source| of_wheel(name, source);
            let motion = Kinematics::straight(Slip::new(slip).map_err(law)?);
            let solved = contact.under_load(load, &motion).map_err(law)?;
            let Some(point) = solved.point() else {
                return Ok(None);
            };
            sum += point.forces.drawbar_pull;
        }
        Ok(Some(sum))
    }

    /// Everything at a slip; NaN where a wheel is not carried.
    pub(crate) fn driving(&self, slip: f64) -> Result<Driving> {
        if let Some(nodes) = &self.nodes {
            let (work_per_metre, sinkage) = nodes.work_and_sinkage(slip)?;
            if work_per_metre.is_finite() {
                return Ok(Driving {
                    slip,
                    work_per_metre,
                    sinkage: sinkage.max(self.free_sinkage),
                    cautions: self.free_cautions,
                });
            }
        }
        let mut work_per_metre = 0.0;
        let (mut sinkage, mut cautions) = (self.free_sinkage, self.free_cautions);
        for (name, contact, load) in self.powered() {
            let law = |source| of_wheel(name, source);
            let motion = Kinematics::straight(Slip::new(slip).map_err(law)?);
            let solved = contact.under_load(load, &motion).map_err(law)?;
            let point = solved.point();
            work_per_metre += point
                .and_then(|point| point.energy_per_metre())
                .unwrap_or(f64::NAN);
            sinkage = sinkage.max(point.map_or(f64::NAN, |point| point.sinkage));
            cautions.insert_all(point.map(|point| point.cautions).unwrap_or_default());
        }
        Ok(Driving {
            slip,
            work_per_metre,
            sinkage,
            cautions,
        })
    }

    /// What slip holds the robot.
    pub(crate) fn held(&self) -> Result<HeldSlip> {
        held_slip(self.solver.max_slip, |slip| self.surplus(slip))
    }

    /// The greatest surplus of driving wheels, N; `None` where none is carried.
    pub(crate) fn reserve(&self) -> Result<Option<f64>> {
        let found = greatest_surplus(self.solver.max_slip, |slip| self.surplus(slip))?;
        Ok(found.map(|best| best.1))
    }

    /// The slip between two at which the surplus changes its sign.
    pub(crate) fn between(&self, from: (f64, f64), to: (f64, f64), tolerance: f64) -> Result<f64> {
        let (low, high) = if from.0 < to.0 {
            (from, to)
        } else {
            (to, from)
        };
        crossing(low, high, tolerance, |slip| self.surplus(slip))
    }
}

pub(crate) fn of_wheel(name: &str, source: grouser_terra::Error) -> Error {
    Error::Law {
        of: format!("wheel \"{name}\""),
        source,
    }
}
