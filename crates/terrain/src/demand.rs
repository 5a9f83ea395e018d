//! What a robot needs to keep moving on a plane: slip, energy, sinkage. The exact solver behind every table.

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::wheel_loads;
use grouser_terra::{Kinematics, Settings, Slip, Soil, WheelOnSoil};

use crate::error::{Error, Result};
use crate::root::{Bracket, golden_section, root};

/// A slip beyond which a robot counts as immobilised: the laws do not count the thrust that churned soil loses, and a
/// wheel at slip 0.9 turns ten times for each of its own circumferences.
pub const MAX_SLIP: f64 = 0.9;
/// Slips at which the pull is sampled before the smallest sufficient one is refined.
const SAMPLES: u32 = 16;
/// A slip is found to this accuracy, far below the tables' bound.
const SLIP_TOLERANCE: f64 = 1e-10;
/// Golden-section steps on a peak of the pull between two samples: to 1e-5 of their distance.
const PEAK_STEPS: u32 = 24;

/// What a robot needs on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// It drives steadily.
    Drives(Driving),
    /// No slip up to [`MAX_SLIP`] gives the pull that the slope takes.
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
}

/// A robot on a plane: what each wheel carries, and what does not depend on the slip of the powered ones.
pub(crate) struct Posed<'a> {
    solver: &'a DemandSolver,
    loads: Vec<f64>,
    /// What the slope takes less the pull of the free wheels, N.
    needed: f64,
    /// Sinkage of the free wheels, m.
    free_sinkage: f64,
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
        })
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
    /// solves it, in [−[`MAX_SLIP`], [`MAX_SLIP`]].
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
        match posed.smallest_slip()? {
            Some(slip) => Ok(Demand::Drives(posed.driving(slip)?)),
            None if posed.surplus(0.0)?.is_some_and(|surplus| surplus > 0.0) => Ok(Demand::Slides),
            None => Ok(Demand::Immobilised),
        }
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
        let (mut pull, mut free_sinkage) = (0.0, 0.0_f64);
        let mut near = std::mem::take(skids).into_iter();
        for ((mount, contact), load) in self
            .model
            .wheels
            .iter()
            .zip(&self.contacts)
            .zip(&loads.loads)
        {
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
            }
        }
        Ok(Some(Posed {
            solver: self,
            loads: loads.loads,
            needed: self.weight * pitch.sin() - pull,
            free_sinkage,
        }))
    }
}

impl Posed<'_> {
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
        let mut work_per_metre = 0.0;
        let mut sinkage = self.free_sinkage;
        for (name, contact, load) in self.powered() {
            let law = |source| of_wheel(name, source);
            let motion = Kinematics::straight(Slip::new(slip).map_err(law)?);
            let solved = contact.under_load(load, &motion).map_err(law)?;
            let point = solved.point();
            work_per_metre += point
                .and_then(|point| point.energy_per_metre())
                .unwrap_or(f64::NAN);
            sinkage = sinkage.max(point.map_or(f64::NAN, |point| point.sinkage));
        }
        Ok(Driving {
            slip,
            work_per_metre,
            sinkage,
        })
    }

    /// The slip of smallest magnitude at which the pull is what is needed.
    fn smallest_slip(&self) -> Result<Option<f64>> {
        let Some(rolling) = self.surplus(0.0)? else {
            return Ok(None);
        };
        if rolling == 0.0 {
            return Ok(Some(0.0));
        }
        // too little pull: more slip; too much, downhill: brake
        let sense = -rolling.signum();
        let step = sense * MAX_SLIP / f64::from(SAMPLES);
        let (mut before, mut best) = ((0.0, rolling), (0.0, rolling));
        for sample in 1..=SAMPLES {
            let slip = f64::from(sample) * step;
            let Some(surplus) = self.surplus(slip)? else {
                break;
            };
            if surplus * rolling <= 0.0 {
                return self
                    .between(before, (slip, surplus), SLIP_TOLERANCE)
                    .map(Some);
            }
            if surplus * sense > best.1 * sense {
                best = (slip, surplus);
            }
            before = (slip, surplus);
        }
        // a peak between samples may reach what no sample does
        let (mut low, mut high) = (
            best.0 - step,
            if (best.0 - sense * MAX_SLIP).abs() < 1e-9 {
                best.0
            } else {
                best.0 + step
            },
        );
        if best.0 == 0.0 {
            low = 0.0;
        }
        for _ in 0..PEAK_STEPS {
            let [a, b] = golden_section(low, high);
            let (Some(at_a), Some(at_b)) = (self.surplus(a)?, self.surplus(b)?) else {
                return Ok(None);
            };
            for at in [(a, at_a), (b, at_b)] {
                if at.1 * rolling <= 0.0 {
                    let from = (best.0 - step).abs().min(best.0.abs()) * sense;
                    let Some(at_from) = self.surplus(from)? else {
                        return Ok(None);
                    };
                    return self.between((from, at_from), at, SLIP_TOLERANCE).map(Some);
                }
            }
            if at_a * sense > at_b * sense {
                high = b;
            } else {
                low = a;
            }
        }
        Ok(None)
    }

    /// The slip between two at which the surplus changes its sign.
    pub(crate) fn between(&self, from: (f64, f64), to: (f64, f64), tolerance: f64) -> Result<f64> {
        root(
            Bracket {
                from,
                to,
                tolerance,
            },
            |slip| Ok(self.surplus(slip)?.unwrap_or(f64::NAN)),
        )
    }
}

pub(crate) fn of_wheel(name: &str, source: grouser_terra::Error) -> Error {
    Error::Law {
        of: format!("wheel \"{name}\""),
        source,
    }
}
