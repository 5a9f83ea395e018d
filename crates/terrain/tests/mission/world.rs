//! A world to compare policies in: relief, soils in patches, and what driving takes there.
//!
//! Quasi-static: at every quarter of a metre the robot stands in the pose of the relief under its wheels, each wheel on the
//! soil at its place, and the demand of that pose is what driving takes. Not in it: dynamics, ruts, drift, turning.
//! Forwards on one soil a table of the exact solver answers; on several, and backwards, the balance of forces below.

use grouser_rover::ground::{HeightMap, Place};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::wheel_loads;
use grouser_terra::{Kinematics, OperatingPoint, Settings, Slip, Soil, WheelOnSoil};
use grouser_terrain::{
    Demand, DemandSolver, Driving, Envelope, MAX_SLIP, Result, SlipTable, SurfacePose,
};

/// A pose is solved anew after this way, m.
pub(super) const STEP_M: f64 = 0.25;
/// A robot whose controller sees this slip stops before it digs in.
pub(super) const DIG_SLIP: f64 = 0.8;
/// Slips at which the pull is sampled, 0.025 apart: a pull that suffices only between two of them is missed.
const SAMPLES: u32 = 36;
/// Bisections of a slip: to 1e-11.
const BISECTIONS: u32 = 32;

/// A soil of the world, for one robot under the world's law of shear.
pub(super) struct WorldSoil {
    /// For poses with all wheels on it.
    pub(super) table: SlipTable,
    solver: DemandSolver,
    wheels: Vec<WheelOnSoil>,
}

/// A relief with soils.
pub(super) struct World<'a> {
    relief: &'a HeightMap,
    pub(super) soils: &'a [WorldSoil],
    base: usize,
    patches: Vec<(Place, usize)>,
    /// Each wheel ahead and to the left of the robot's middle, m, and its share of the load on the level.
    wheels: Vec<([f64; 2], f64)>,
}

/// What a pose takes.
pub(super) struct Taken {
    pub(super) pose: SurfacePose,
    pub(super) demand: Demand,
}

impl Taken {
    /// The driving, if the robot comes on without digging.
    pub(super) fn driving(&self) -> Option<Driving> {
        match self.demand {
            Demand::Drives(driving) if driving.slip <= DIG_SLIP => Some(driving),
            _ => None,
        }
    }
}

impl WorldSoil {
    pub(super) fn new(model: &RobotModel, soil: &Soil, envelope: Envelope) -> Self {
        let solver = DemandSolver::new(model.clone(), *soil).unwrap();
        let wheels = model.wheels.iter();
        Self {
            // 9 x 17 nodes: the world is its own, whatever its tables' error
            table: SlipTable::coarse(&solver, envelope).unwrap(),
            solver,
            wheels: wheels
                .map(|mount| WheelOnSoil::new(mount.wheel, *soil, Settings::default()).unwrap())
                .collect(),
        }
    }

    pub(super) const fn model(&self) -> &RobotModel {
        self.solver.model()
    }

    /// What driving forwards with all wheels on it takes.
    pub(super) fn demand(&self, pose: SurfacePose) -> Result<Demand> {
        self.table.demand(&self.solver, pose.pitch, pose.roll)
    }
}

impl<'a> World<'a> {
    /// Ground of the soil `base` with patches of others, later ones upon earlier ones.
    pub(super) fn new(
        relief: &'a HeightMap,
        soils: &'a [WorldSoil],
        base: usize,
        patches: Vec<(Place, usize)>,
    ) -> Self {
        let model = soils[base].model();
        assert_eq!(model.powered().count(), model.wheels.len());
        let level = wheel_loads(model, 0.0, 0.0).loads;
        let mounts = model.wheels.iter().zip(level);
        Self {
            relief,
            soils,
            base,
            patches,
            wheels: mounts
                .map(|(mount, load)| ([mount.centre.x, mount.centre.y], load / model.weight()))
                .collect(),
        }
    }

    /// The soil at a place.
    fn soil_at(&self, (x, y): (f64, f64)) -> usize {
        let patch = self
            .patches
            .iter()
            .rev()
            .find(|(place, _)| place.holds(x, y));
        patch.map_or(self.base, |(_, soil)| *soil)
    }

    /// The places of the wheels of a robot, m.
    fn places(&self, (x, y): (f64, f64), heading: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (sin, cos) = heading.sin_cos();
        let wheels = self.wheels.iter();
        wheels.map(move |([a, l], _)| (x + a * cos - l * sin, y + a * sin + l * cos))
    }

    /// The soils under the wheels of a robot.
    pub(super) fn soils_under(&self, place: (f64, f64), heading: f64) -> Vec<usize> {
        self.places(place, heading)
            .map(|at| self.soil_at(at))
            .collect()
    }

    /// The pose on the plane of least squares through the ground under the wheels, each weighted with its load; `None` off the
    /// known ground.
    pub(super) fn pose(&self, place: (f64, f64), heading: f64) -> Option<SurfacePose> {
        let mut ground = Vec::new();
        for ((x, y), ([ahead, left], share)) in self.places(place, heading).zip(&self.wheels) {
            if !self.relief.known(x, y) {
                return None;
            }
            ground.push(([*ahead, *left, self.relief.height(x, y)], *share));
        }
        let mean = [0, 1, 2].map(|axis| ground.iter().map(|(at, w)| w * at[axis]).sum::<f64>());
        let moment = |i: usize, j: usize| -> f64 {
            let products = ground.iter();
            products
                .map(|(at, w)| w * (at[i] - mean[i]) * (at[j] - mean[j]))
                .sum()
        };
        let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
        let (xz, yz) = (moment(0, 2), moment(1, 2));
        let determinant = xx * yy - xy * xy;
        Some(SurfacePose::on_plane(
            (yy * xz - xy * yz) / determinant,
            (xx * yz - xy * xz) / determinant,
        ))
    }

    /// How far the foremost wheel is ahead of the middle, m.
    pub(super) fn front(&self) -> f64 {
        self.wheels.iter().map(|(at, _)| at[0]).fold(0.0, f64::max)
    }

    /// How much weaker the ground is on the left than on the right: the difference of the slopes that the soils let climb.
    pub(super) fn left_is_weaker(&self, place: (f64, f64), heading: f64) -> f64 {
        let (sin, cos) = heading.sin_cos();
        let places = self.places(place, heading);
        places
            .map(|at| {
                let left = -(at.0 - place.0) * sin + (at.1 - place.1) * cos;
                -left.signum() * self.soils[self.soil_at(at)].table.steepest()
            })
            .sum()
    }

    /// What a robot takes at a place, forwards or backwards; `None` off the known ground.
    pub(super) fn take(
        &self,
        place: (f64, f64),
        heading: f64,
        is_forward: bool,
    ) -> Result<Option<Taken>> {
        let Some(pose) = self.pose(place, heading) else {
            return Ok(None);
        };
        let under = self.soils_under(place, heading);
        let is_one = under.iter().all(|soil| *soil == under[0]);
        let demand = if is_one && is_forward {
            self.soils[under[0]].demand(pose)?
        } else {
            self.balance(pose, &under, is_forward)
        };
        Ok(Some(Taken { pose, demand }))
    }

    /// The smallest slip at which the wheels, all of them powered and each on its soil, pull what the slope takes.
    ///
    /// Backwards the loads and the laws of a wheel are the same; what was uphill is downhill.
    fn balance(&self, pose: SurfacePose, under: &[usize], is_forward: bool) -> Demand {
        let model = self.soils[self.base].model();
        let stand = wheel_loads(model, pose.pitch, pose.roll);
        if !stand.stands {
            return Demand::Lifts;
        }
        // the wheels at a slip; `None` where one is not carried
        let at = |slip: f64| -> Option<Vec<OperatingPoint>> {
            let motion = Kinematics::straight(Slip::new(slip).unwrap());
            let loaded = under.iter().zip(&stand.loads).enumerate();
            loaded
                .filter(|(_, (_, load))| **load > 0.0)
                .map(|(wheel, (soil, load))| {
                    let contact = &self.soils[*soil].wheels[wheel];
                    contact.under_load(*load, &motion).unwrap().point()
                })
                .collect()
        };
        let uphill = if is_forward { 1.0 } else { -1.0 };
        let needed = uphill * model.weight() * pose.pitch.sin();
        let surplus = |slip: f64| {
            let pulls = at(slip)?.into_iter().map(|point| point.forces.drawbar_pull);
            Some(pulls.sum::<f64>() - needed)
        };
        let Some(rolling) = surplus(0.0) else {
            return Demand::Immobilised;
        };
        // too little pull: more slip; too much, downhill: brake
        let sense = if rolling > 0.0 { -1.0 } else { 1.0 };
        let is_enough = |slip: f64| surplus(sense * slip).map(|pull| pull * sense >= 0.0);
        let (mut low, mut high) = (0.0, None);
        for sample in 1..=SAMPLES {
            let slip = MAX_SLIP * f64::from(sample) / f64::from(SAMPLES);
            match is_enough(slip) {
                Some(false) => low = slip,
                Some(true) => {
                    high = Some(slip);
                    break;
                }
                None => break,
            }
        }
        let Some(mut high) = high else {
            return if rolling > 0.0 {
                Demand::Slides
            } else {
                Demand::Immobilised
            };
        };
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if is_enough(middle) == Some(true) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let slip = sense * high;
        let points = at(slip).unwrap();
        let works = points.iter().map(|point| point.energy_per_metre().unwrap());
        Demand::Drives(Driving {
            slip,
            work_per_metre: works.sum(),
            cautions: grouser_terra::Cautions::default(),
            sinkage: points.iter().map(|point| point.sinkage).fold(0.0, f64::max),
        })
    }
}

/// The world's balance agrees with the library's solver on one soil, forwards; a robot that is alike at both ends takes
/// backwards what it takes forwards on the opposite slope.
#[test]
fn the_balance_of_the_world_is_the_demand_of_its_soil() {
    let model = super::robot_model("skid-steer");
    let envelope = Envelope::within(&model, 0.45, 0.35).unwrap();
    let soils = [WorldSoil::new(
        &model,
        &super::catalogued("clayey-soil"),
        envelope,
    )];
    let relief = HeightMap::from_shape((10.0, 10.0), 1.0, |_, _| 0.0).unwrap();
    let world = World::new(&relief, &soils, 0, Vec::new());
    let under = vec![0; model.wheels.len()];
    let mut kinds = [0; 4];
    for (i, j) in (-8..=8).flat_map(|i| (-2..=2).map(move |j| (i, j))) {
        let pose = SurfacePose {
            pitch: 0.1 * f64::from(i),
            roll: 0.12 * f64::from(j),
        };
        let expected = soils[0].solver.demand(pose.pitch, pose.roll).unwrap();
        let opposite = SurfacePose {
            pitch: -pose.pitch,
            ..pose
        };
        for found in [
            world.balance(pose, &under, true),
            world.balance(opposite, &under, false),
        ] {
            match (found, expected) {
                (Demand::Drives(found), Demand::Drives(expected)) => {
                    let scale = expected.work_per_metre.abs().max(1.0);
                    assert!((found.slip - expected.slip).abs() < 1e-8, "{pose:?}");
                    assert!((found.work_per_metre - expected.work_per_metre).abs() < 1e-6 * scale);
                    assert!((found.sinkage - expected.sinkage).abs() < 1e-9);
                    kinds[0] += 1;
                }
                (Demand::Immobilised, Demand::Immobilised) => kinds[1] += 1,
                (Demand::Slides, Demand::Slides) => kinds[2] += 1,
                (Demand::Lifts, Demand::Lifts) => kinds[3] += 1,
                _ => panic!("{pose:?}: {found:?} for {expected:?}"),
            }
        }
    }
    assert!(kinds.iter().all(|count| *count > 0), "{kinds:?}");
}
