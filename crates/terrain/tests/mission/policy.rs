//! Ways to a goal that are compared.

use grouser_terrain::Result;
use grouser_terrain::mission::{MissionSettings, Navigator, Replanning};
use grouser_terrain::plan::{Route, route_within};

use super::oracle::{close, open, true_map};
use super::robot::{Ended, Moved, Robot};
use super::world::World;

/// How far the robot backs out of soft ground, m: as the controller does.
const BACK_LENGTH_M: f64 = 1.0;
/// How often it backs out further where no way leads on.
const FURTHER_BACK: u32 = 3;
/// The controller's detour: way aside at the first attempt, what each further one adds, its heading beside the goal's and what
/// each further one adds, its attempts, and the progress after which they count anew (`ControlSettings`, `recovery`).
const ASIDE_M: f64 = 2.2;
const ASIDE_STEP_SHARE: f64 = 0.5;
const ASIDE_ANGLE_RAD: f64 = 1.2;
const ASIDE_ANGLE_STEP_RAD: f64 = 0.3;
const MAX_ASIDE_ANGLE_RAD: f64 = 2.1;
const MAX_ATTEMPTS: u32 = 5;
const FORGET_DISTANCE_M: f64 = 4.0;
/// Slopes that differ by less are the same: the side of a detour does not hang on rounding.
const SAME_SLOPE_RAD: f64 = 1e-6;
/// A goal is reached within this distance, m.
const GOAL_RADIUS_M: f64 = 0.75;
/// Longest way, as a multiple of the distance to the goal: what takes longer is lost.
const MAX_WAY_FACTOR: f64 = 20.0;
/// Plans of one drive at most.
const MAX_PLANS: usize = 400;
/// A metre of ground without an earlier reading counts as one; readings of a step count less.
const READING_WEIGHT: f64 = 0.25;
/// A robot that does not come on has spent seconds to find out.
const BLOCKED_WEIGHT: f64 = 4.0;

/// How a robot gets to its goal.
#[derive(Clone, Copy)]
pub(super) enum Policy {
    /// Straight at the goal; stops where it does not come on.
    Straight,
    /// Straight at the goal; backs out of soft ground and drives round it, as the controller does.
    Reactive,
    /// Along the plan with the prior soil; stops where it does not come on.
    PlanPrior,
    /// Plans, learns, and plans anew.
    PlanLearn,
    /// Plans with the true soils and law.
    Oracle,
}

impl Policy {
    /// All of them.
    pub(super) const ALL: [Self; 5] = [
        Self::Straight,
        Self::Reactive,
        Self::PlanPrior,
        Self::PlanLearn,
        Self::Oracle,
    ];

    /// Its name in tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Reactive => "reactive detour",
            Self::PlanPrior => "plan, prior soil",
            Self::PlanLearn => "plan and learn",
            Self::Oracle => "oracle",
        }
    }
}

/// What came of a drive.
pub(super) struct MissionResult {
    /// How it ended.
    pub(super) ended: Ended,
    /// At the wheels, J.
    pub(super) energy: f64,
    /// m.
    pub(super) way: f64,
    /// How often it did not come on.
    pub(super) blocked: u32,
    /// How planning went.
    pub(super) planning: Replanning,
}

/// A drive from a start to a goal.
pub(super) struct Mission<'a> {
    /// m.
    pub(super) start: (f64, f64),
    /// m.
    pub(super) goal: (f64, f64),
    /// What is planned with.
    pub(super) settings: &'a MissionSettings,
    /// A navigator that has learnt nothing yet.
    pub(super) navigator: &'a Navigator,
    /// Seed of the sensors' noise.
    pub(super) seed: u64,
}

impl Mission<'_> {
    pub(super) fn drive(&self, world: &World<'_>, policy: Policy) -> Result<MissionResult> {
        let to_goal = (self.goal.1 - self.start.1).atan2(self.goal.0 - self.start.0);
        let turn_energy = self.settings.plan.turn_energy;
        let mut robot = Robot::new(self.start, to_goal, turn_energy, self.seed);
        let mut navigator = self.navigator.clone();
        let mut blocked = 0;
        let ended = match policy {
            Policy::Straight => {
                let moved = robot.drive_to(world, self.goal, |_| Ok(()))?;
                ended(world, &mut robot, moved, &mut blocked)?
            }
            Policy::Reactive => self.reactive(world, &mut robot, &mut blocked)?,
            Policy::PlanPrior => {
                if navigator.set_out(self.start, to_goal, self.goal)? {
                    let route = navigator.route().map(places);
                    let moved = along(world, &mut robot, &route.unwrap_or_default())?;
                    ended(world, &mut robot, moved, &mut blocked)?
                } else {
                    Ended::Stopped
                }
            }
            Policy::PlanLearn => self.learning(world, &mut robot, &mut navigator, &mut blocked)?,
            Policy::Oracle => self.oracle(world, &mut robot, &mut blocked)?,
        };
        Ok(MissionResult {
            ended,
            energy: robot.energy,
            way: robot.way,
            blocked,
            planning: navigator.planning().clone(),
        })
    }

    fn to_go(&self, robot: &Robot) -> f64 {
        (self.goal.0 - robot.place.0).hypot(self.goal.1 - robot.place.1)
    }

    fn reactive(&self, world: &World<'_>, robot: &mut Robot, blocked: &mut u32) -> Result<Ended> {
        let (mut attempts, mut side, mut since) = (0, 0.0, self.to_go(robot));
        let max_way = MAX_WAY_FACTOR * self.to_go(robot);
        while robot.way < max_way {
            let before = self.to_go(robot);
            if before < GOAL_RADIUS_M {
                return Ok(Ended::Arrived);
            }
            if since - before > FORGET_DISTANCE_M {
                (attempts, side) = (0, 0.0);
            }
            // a metre at a time, so that progress is seen
            let (x, y) = (self.goal.0 - robot.place.0, self.goal.1 - robot.place.1);
            let share = (1.0 / before).min(1.0);
            let to = (robot.place.0 + share * x, robot.place.1 + share * y);
            match robot.drive_to(world, to, |_| Ok(()))? {
                Moved::There => continue,
                Moved::Lost => return Ok(Ended::Immobilised),
                Moved::Blocked => {}
            }
            // aside; what holds it there counts as a further attempt
            loop {
                *blocked += 1;
                attempts += 1;
                if side == 0.0 {
                    let is_left =
                        world.left_is_weaker(robot.place, robot.heading) <= SAME_SLOPE_RAD;
                    side = if is_left { 1.0 } else { -1.0 };
                }
                if !robot.back_out(world, BACK_LENGTH_M)? {
                    return Ok(Ended::Immobilised);
                }
                if attempts > MAX_ATTEMPTS {
                    return Ok(Ended::Stopped);
                }
                since = self.to_go(robot);
                let further = f64::from(attempts - 1);
                let angle =
                    (ASIDE_ANGLE_RAD + ASIDE_ANGLE_STEP_RAD * further).min(MAX_ASIDE_ANGLE_RAD);
                let (x, y) = (self.goal.0 - robot.place.0, self.goal.1 - robot.place.1);
                let heading = y.atan2(x) + side * angle;
                let width = ASIDE_M * (1.0 + ASIDE_STEP_SHARE * further);
                let length = width / angle.sin();
                let to = (
                    robot.place.0 + length * heading.cos(),
                    robot.place.1 + length * heading.sin(),
                );
                match robot.drive_to(world, to, |_| Ok(()))? {
                    Moved::There => break,
                    Moved::Lost => return Ok(Ended::Immobilised),
                    Moved::Blocked => {}
                }
            }
        }
        Ok(Ended::Stopped)
    }

    fn learning(
        &self,
        world: &World<'_>,
        robot: &mut Robot,
        navigator: &mut Navigator,
        blocked: &mut u32,
    ) -> Result<Ended> {
        if !navigator.set_out(robot.place, robot.heading, self.goal)? {
            return Ok(Ended::Stopped);
        }
        while navigator.planning().count < MAX_PLANS {
            let Some(route) = navigator.route() else {
                return Ok(Ended::Stopped);
            };
            let way = places(route);
            let mut is_held = false;
            for place in &way {
                let moved = robot.drive_to(world, *place, |reading| {
                    let weight = if reading.slip < 1.0 {
                        READING_WEIGHT
                    } else {
                        BLOCKED_WEIGHT
                    };
                    navigator.observe(reading, weight)
                })?;
                match moved {
                    Moved::There => {}
                    Moved::Lost => return Ok(Ended::Immobilised),
                    Moved::Blocked => {
                        *blocked += 1;
                        is_held = true;
                        if !robot.back_out(world, BACK_LENGTH_M)? {
                            return Ok(Ended::Immobilised);
                        }
                    }
                }
                if is_held || navigator.has_changed() {
                    break;
                }
            }
            if self.to_go(robot) < GOAL_RADIUS_M {
                return Ok(Ended::Arrived);
            }
            let mut found = navigator.replan(robot.place, robot.heading, is_held)?;
            // room to turn
            for _ in 0..FURTHER_BACK {
                if found {
                    break;
                }
                if !robot.back_out(world, BACK_LENGTH_M)? {
                    return Ok(Ended::Immobilised);
                }
                found = navigator.replan(robot.place, robot.heading, true)?;
            }
            if !found {
                return Ok(Ended::Stopped);
            }
        }
        Ok(Ended::Stopped)
    }

    fn oracle(&self, world: &World<'_>, robot: &mut Robot, blocked: &mut u32) -> Result<Ended> {
        let mut map = true_map(world, self.navigator.plan_map(), self.settings)?;
        let goal = map.cell_at("the goal", self.goal)?;
        for _ in 0..MAX_PLANS {
            let start = map.cell_at("the start", robot.place)?;
            let mut settings = self.settings.plan;
            settings.start_heading = Some(map.layout.headings.nearest(robot.heading));
            open(&mut map, start);
            let Ok(Some(route)) = route_within(&map, (start, goal), &settings) else {
                return Ok(Ended::Stopped);
            };
            match along(world, robot, &places(&route))? {
                Moved::There => return Ok(Ended::Arrived),
                Moved::Lost => return Ok(Ended::Immobilised),
                Moved::Blocked => {
                    // the cells of its map are coarser than the world
                    *blocked += 1;
                    close(&mut map, robot.place);
                    if !robot.back_out(world, BACK_LENGTH_M)? {
                        return Ok(Ended::Immobilised);
                    }
                }
            }
        }
        Ok(Ended::Stopped)
    }
}

/// The end of a drive that does not go on after it was held.
fn ended(world: &World<'_>, robot: &mut Robot, moved: Moved, blocked: &mut u32) -> Result<Ended> {
    Ok(match moved {
        Moved::There => Ended::Arrived,
        Moved::Lost => Ended::Immobilised,
        Moved::Blocked => {
            *blocked += 1;
            if robot.back_out(world, BACK_LENGTH_M)? {
                Ended::Stopped
            } else {
                Ended::Immobilised
            }
        }
    })
}

/// The places of a route where the robot passes, without those at which it only turns.
fn places(route: &Route) -> Vec<(f64, f64)> {
    let points = route.waypoints.iter();
    let mut places: Vec<_> = points.map(|point| (point.x, point.y)).collect();
    places.dedup();
    places
}

/// Drives along places; the first is where the robot stands.
fn along(world: &World<'_>, robot: &mut Robot, places: &[(f64, f64)]) -> Result<Moved> {
    for place in places {
        match robot.drive_to(world, *place, |_| Ok(()))? {
            Moved::There => {}
            other => return Ok(other),
        }
    }
    Ok(Moved::There)
}
