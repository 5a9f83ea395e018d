//! The wheels of least energy for their mass.
//!
//! The ends of the front are the wheel of least mass and that of least energy; between them the energy is minimised (minimax over the
//! soils) at limits of the mass. Every point is solved separately, with multipliers, from the wheel before it and from
//! points spread over the bounds: two objectives need no evolutionary search.

use std::ops::ControlFlow;

use grouser_opt::{Method, MultiStart, Settings, Solution, Status, knee, multi_start_with};

use super::evaluation::DesignPoint;
use super::functions::{Aim, Task};
use super::wheel::COUNT;
use super::{MissionProfile, WheelDesign};
use crate::error::{Error, Result};

/// How a front is searched for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrontSettings {
    /// Points of the front, its two ends among them.
    pub points: usize,
    /// Starts of the solves at the ends.
    pub starts: usize,
    /// Starts of the solves between them, that from the wheel before among them.
    pub starts_between: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// Which wheel of the front is chosen.
    pub choice: Choice,
    /// How exactly each point is solved.
    pub solve: Settings,
}

impl Default for FrontSettings {
    fn default() -> Self {
        let mut solve = Settings::default();
        // Slips and loads are solved to 1e-13; energies are hardly known to a part in a hundred.
        solve.optimality_tolerance = 1e-6;
        solve.max_iterations = 100;
        // Each point has several starts, and its neighbours on the front would show a point that is worse.
        solve.probes = 16;
        Self {
            points: 12,
            starts: 6,
            starts_between: 3,
            seed: 1,
            choice: Choice::Knee,
            solve,
        }
    }
}

/// Which wheel of a front is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// Where the front bends most.
    Knee,
    /// The lightest one that holds every slope.
    Lightest,
    /// That of least energy.
    LeastEnergy,
    /// That of least energy up to this mass of one wheel, kg.
    MaxMass(f64),
}

/// How far the search is: solves that are done, and all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrontProgress {
    /// Solves that are done.
    pub done: usize,
    /// All of them.
    pub of: usize,
}

/// The front of a mission.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MissionFront {
    /// Wheels by mass, none of which another beats in both mass and energy. Empty where no wheel holds every slope.
    pub points: Vec<DesignPoint>,
    /// The place of the chosen one.
    pub chosen: Option<usize>,
    /// The place of the knee, where there is one.
    pub knee: Option<usize>,
    /// Where no wheel has the reserve on every slope and soil: the one whose least reserve is greatest.
    pub nearest: Option<DesignPoint>,
    /// Solves that led to no solution.
    pub unsolved: usize,
    /// Was it stopped? Then the points are those found so far.
    pub stopped: bool,
}

/// A stopped solve whose constraints are met to this is feasible enough to be shown.
const MAX_VIOLATION: f64 = 1e-6;

/// Wheels whose masses differ by less than this share are one point of a front.
const SAME_MASS_SHARE: f64 = 1e-5;

struct Search<'m, 'c> {
    mission: &'m MissionProfile,
    settings: &'m FrontSettings,
    progress: FrontProgress,
    callback: &'c mut dyn FnMut(FrontProgress) -> ControlFlow<()>,
    unsolved: usize,
    stopped: bool,
}

impl MissionProfile {
    /// The front of wheel mass against energy per metre, with the chosen wheel; `callback` is called for each iteration and may stop the
    /// search.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a limit of the mass that is not positive, and what the optimiser refuses.
    pub fn front(
        &self,
        settings: &FrontSettings,
        callback: &mut dyn FnMut(FrontProgress) -> ControlFlow<()>,
    ) -> Result<MissionFront> {
        let range = |field: &str, value: f64, limits: (f64, f64), unit| {
            grouser_real::OutOfRange::check(field, value, limits, unit).map_err(Error::OutOfRange)
        };
        range("points", settings.points as f64, (2.0, 200.0), "1")?;
        range("starts", settings.starts as f64, (1.0, 10_000.0), "1")?;
        if let Choice::MaxMass(limit) = settings.choice {
            range("max_wheel_mass_kg", limit, (1e-9, 1e9), "kg")?;
        }
        let mut search = Search {
            mission: self,
            settings,
            progress: FrontProgress {
                done: 0,
                of: settings.points + 1,
            },
            callback,
            unsolved: 0,
            stopped: false,
        };
        let points = search.points()?;
        let nearest = if points.is_empty() && !search.stopped {
            let middle = Task::new(self, Aim::Shortage).base;
            search
                .solve(Aim::Shortage, &middle, settings.starts)?
                .map(|found| self.evaluate(&found.wheel))
                .transpose()?
        } else {
            None
        };
        let objectives: Vec<Vec<f64>> = points
            .iter()
            .map(|point| vec![point.wheel_mass, point.energy.unwrap_or(f64::INFINITY)])
            .collect();
        let knee = knee(&objectives);
        let last = points.len().checked_sub(1);
        let chosen = match settings.choice {
            Choice::Knee => knee.or(last),
            Choice::Lightest => last.map(|_| 0),
            Choice::LeastEnergy => last,
            Choice::MaxMass(limit) => points
                .iter()
                .rposition(|point| point.wheel_mass <= limit * (1.0 + 1e-6)),
        };
        Ok(MissionFront {
            chosen,
            knee,
            nearest,
            unsolved: search.unsolved,
            stopped: search.stopped,
            points,
        })
    }
}

/// A wheel that a solve found.
struct Found {
    wheel: WheelDesign,
    utility: f64,
    held_by: Vec<String>,
    /// The multiplier of the limit of the mass, if there is one.
    price: Option<f64>,
}

impl Search<'_, '_> {
    fn points(&mut self) -> Result<Vec<DesignPoint>> {
        let starts = self.settings.starts;
        let middle = Task::new(self.mission, Aim::Mass).base;
        let mut points = Vec::new();
        let Some(lightest) = self.solve(Aim::Mass, &middle, starts)? else {
            return Ok(points);
        };
        self.keep(&mut points, &lightest, None)?;
        let free = Aim::Energy { max_mass: None };
        let Some(heaviest) = self.solve(free, &lightest.wheel, starts)? else {
            return Ok(points);
        };
        self.keep(&mut points, &heaviest, None)?;
        let ends = [&lightest, &heaviest].map(|end| self.mission.wheel_mass(&end.wheel));
        let mut limits: Vec<f64> = (0..self.settings.points.saturating_sub(1))
            .map(|i| ends[0] + (ends[1] - ends[0]) * i as f64 / (self.settings.points - 1) as f64)
            .collect();
        if let Choice::MaxMass(limit) = self.settings.choice
            && limit > ends[0]
            && limit < ends[1]
        {
            limits.push(limit);
        }
        limits.sort_by(f64::total_cmp);
        let mut before = lightest.wheel;
        for limit in limits {
            if self.stopped {
                break;
            }
            // The lightest wheel itself is a corner of the constraints, from where no search moves.
            let max_mass = Some(limit.max(ends[0] * (1.0 + 1e-6)));
            let aim = Aim::Energy { max_mass };
            if let Some(found) = self.solve(aim, &before, self.settings.starts_between)? {
                before = found.wheel;
                self.keep(&mut points, &found, max_mass)?;
            }
        }
        Ok(undominated(points))
    }

    fn keep(
        &self,
        points: &mut Vec<DesignPoint>,
        found: &Found,
        max_mass: Option<f64>,
    ) -> Result<()> {
        let mut point = self.mission.evaluate(&found.wheel)?;
        point.held_by.clone_from(&found.held_by);
        let scale = Task::new(self.mission, Aim::Mass).weight;
        point.energy_per_mass = max_mass
            .zip(found.price)
            .filter(|(_, price)| *price > 0.0)
            .map(|(limit, price)| price * scale / limit);
        points.push(point);
        Ok(())
    }

    /// The best wheel for an aim; a number of lugs that is no whole number is tried below and above.
    fn solve(&mut self, aim: Aim, start: &WheelDesign, starts: usize) -> Result<Option<Found>> {
        let task = Task::new(self.mission, aim);
        let best = self.solve_task(&task, start, starts)?;
        self.progress.done += 1;
        let Some(best) = best else {
            self.unsolved += usize::from(!self.stopped);
            return Ok(None);
        };
        let count = best.wheel.grouser_count;
        if !task.free.contains(&COUNT) || (count.fract() == 0.0) {
            return Ok(Some(best));
        }
        let mut whole: Option<Found> = None;
        for count in [count.floor(), count.ceil()] {
            let fixed = task.with_count(count);
            let found = if fixed.free.is_empty() {
                self.only_wheel(&fixed)
            } else {
                self.solve_task(&fixed, &best.wheel, 1)?
            };
            let better = |found: &Found| {
                whole
                    .as_ref()
                    .is_none_or(|known| found.utility < known.utility)
            };
            if let Some(found) = found.filter(better) {
                whole = Some(found);
            }
        }
        Ok(whole)
    }

    /// Where the number of lugs is the only free size.
    fn only_wheel(&self, task: &Task<'_>) -> Option<Found> {
        let point = self.mission.evaluate(&task.base).ok()?;
        let is_light = match task.aim {
            Aim::Energy {
                max_mass: Some(limit),
            } => point.wheel_mass <= limit,
            _ => true,
        };
        let holds = point.least_reserve() >= self.mission.params.min_reserve;
        let utility = match task.aim {
            Aim::Energy { .. } => point.energy? / task.weight,
            Aim::Mass => point.wheel_mass / task.mass,
            Aim::Shortage => -point.least_reserve(),
        };
        (is_light && (holds || task.aim == Aim::Shortage)).then(|| Found {
            wheel: task.base,
            utility,
            held_by: vec!["whole number of lugs".to_owned()],
            price: None,
        })
    }

    fn solve_task(
        &mut self,
        task: &Task<'_>,
        start: &WheelDesign,
        starts: usize,
    ) -> Result<Option<Found>> {
        let refuse = |source| Error::Problem {
            file: "the mission".to_owned(),
            source,
        };
        let problem = task.problem(start)?;
        let (progress, callback) = (self.progress, &mut *self.callback);
        let found = multi_start_with(
            &problem,
            &Method::Minimax,
            &self.settings.solve,
            (starts, self.settings.seed),
            &mut |_| callback(progress),
        )
        .map_err(refuse)?;
        self.stopped |= found.stopped;
        Ok(feasible(&found).map(|best| Found {
            wheel: task.wheel(&best.x),
            utility: best.utility,
            held_by: held_by(best, task),
            price: match task.aim {
                Aim::Energy { max_mass: Some(_) } => best.multipliers.inequalities.last().copied(),
                _ => None,
            },
        }))
    }
}

/// The best run whose constraints are met.
fn feasible(found: &MultiStart) -> Option<&Solution> {
    let best = found.best();
    let met = best.kkt.violation <= MAX_VIOLATION;
    // A kink (another place of the greatest pull) or a budget ends a solve at a wheel that is no proven optimum, but holds.
    let usable = best.status.is_solved()
        || (met
            && matches!(
                best.status,
                Status::Stopped | Status::Stalled | Status::Limit(_)
            ));
    usable.then_some(best)
}

fn held_by(solution: &Solution, task: &Task<'_>) -> Vec<String> {
    let is_energy = |name: &&String| !name.starts_with("energy @") && !name.starts_with("mean ");
    let mut names: Vec<String> = solution.active.iter().filter(is_energy).cloned().collect();
    if task.aim == Aim::Mass {
        names.retain(|name| name != "wheel mass");
    }
    if !solution.status.is_solved() {
        names.push(format!("not solved to the end: {}", solution.status.name()));
    }
    names
}

/// By mass, without those that another beats.
fn undominated(mut points: Vec<DesignPoint>) -> Vec<DesignPoint> {
    points.retain(|point| point.energy.is_some());
    points.sort_by(|a, b| a.wheel_mass.total_cmp(&b.wheel_mass));
    let mut out: Vec<DesignPoint> = Vec::new();
    for point in points {
        if out
            .last()
            .is_some_and(|before| before.energy <= point.energy)
        {
            continue;
        }
        let is_same =
            |before: &&DesignPoint| point.wheel_mass <= before.wheel_mass * (1.0 + SAME_MASS_SHARE);
        if out.last().as_ref().is_some_and(is_same) {
            out.pop();
        }
        out.push(point);
    }
    out
}
