//! The moves of a robot on the cells of a map.

use super::plan_map::PlanMap;
use crate::error::{Error, Result};

/// Most straight steps between two turns: the lattice remembers how many were made.
const MAX_STRAIGHT: u32 = 200;

/// What a way must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanSettings {
    /// Bound on the probability to be immobilised anywhere on the way.
    pub max_risk: f64,
    /// Greatest slip that 95 % of the soil draws demand; braking counts by its magnitude.
    pub max_slip: f64,
    /// Least tip-over margin, deg.
    pub min_tip_over_deg: f64,
    /// Speed of the wheels' rims, m/s: the robot is slower by the slip.
    pub rim_speed: f64,
    /// Energy of a turn by one heading, J: the map knows what straight driving takes, not what turning takes.
    pub turn_energy: f64,
    /// Is the CVaR of the energy over the soil draws minimised, instead of the energy on the soil itself?
    pub by_cvar: bool,
    /// The robot's heading at the start (its index); `None`: whichever serves best.
    pub start_heading: Option<usize>,
    /// The robot's heading at the goal.
    pub goal_heading: Option<usize>,
}

impl Default for PlanSettings {
    fn default() -> Self {
        Self {
            max_risk: 0.05,
            max_slip: grouser_terra::slope::MAX_SLIP,
            min_tip_over_deg: 10.0,
            rim_speed: 0.25,
            turn_energy: 0.0,
            by_cvar: false,
            start_heading: None,
            goal_heading: None,
        }
    }
}

impl PlanSettings {
    pub(super) fn check(&self, map: &PlanMap) -> Result<()> {
        let of = "plan";
        Error::check(of, "max_risk", self.max_risk, (0.0, 1.0), "1")?;
        Error::check(
            of,
            "min_tip_over",
            self.min_tip_over_deg,
            (0.0, 90.0),
            "deg",
        )?;
        Error::check(of, "speed", self.rim_speed, (1e-4, 100.0), "m/s")?;
        Error::check(of, "max_slip", self.max_slip, (0.0, 1.0), "1")?;
        Error::check(of, "turn_energy", self.turn_energy, (0.0, 1e9), "J")?;
        let last = (map.layout.headings.count() - 1) as f64;
        for heading in [self.start_heading, self.goal_heading]
            .into_iter()
            .flatten()
        {
            Error::check(of, "heading", heading as f64, (0.0, last), "1")?;
        }
        Ok(())
    }
}

/// A step of a heading, in cells of a map of one width.
#[derive(Clone, Copy, Debug)]
struct Step {
    right: i64,
    up: i64,
    /// Cells that the robot passes on the way, besides both ends.
    between: [(i64, i64); 2],
    /// Do the cells between lie on the way itself, so that their energy counts?
    passes_middle: bool,
    /// m, on the level.
    length: f64,
}

/// The moves on a map, for one set of costs.
pub(super) struct Lattice<'a> {
    map: &'a PlanMap,
    settings: &'a PlanSettings,
    steps: Vec<Step>,
    /// Straight steps of each heading after which the robot may turn.
    pub(super) straight: Vec<u32>,
    /// The greatest of them: a longer straight counts no further.
    pub(super) most: u32,
    /// Factors of the cells' energies, where a search is to avoid earlier ways; empty: 1.
    pub(super) penalty: Vec<f32>,
}

impl<'a> Lattice<'a> {
    pub(super) fn new(map: &'a PlanMap, settings: &'a PlanSettings) -> Result<Self> {
        let headings = map.layout.headings;
        let count = headings.count();
        let steps: Vec<Step> = (0..count)
            .map(|heading| {
                let (right, up) = headings.step(heading);
                let (right, up) = (i64::from(right), i64::from(up));
                let (x, y) = (right.signum(), up.signum());
                let is_knight = right.abs() + up.abs() == 3;
                let between = if is_knight {
                    let long = if right.abs() == 2 { (x, 0) } else { (0, y) };
                    [long, (x, y)]
                } else if x != 0 && y != 0 {
                    [(x, 0), (0, y)]
                } else {
                    [(0, 0), (0, 0)]
                };
                Step {
                    right,
                    up,
                    between,
                    passes_middle: is_knight,
                    length: map.layout.cell * (right as f64).hypot(up as f64),
                }
            })
            .collect();
        let straight = (0..count)
            .map(|heading| {
                let turn = |to: usize| {
                    let off = (headings.angle(to) - headings.angle(heading)).abs();
                    off.min(std::f64::consts::TAU - off)
                };
                let sharpest = turn((heading + 1) % count).max(turn((heading + count - 1) % count));
                // a corner rounded on a radius R takes R tan(angle/2) of both legs, and a leg may have two corners
                let leg = 2.0 * map.layout.turning_radius * (0.5 * sharpest).tan();
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "not negative; the cast saturates"
                )]
                let steps = (leg / steps[heading].length - 1e-9).ceil().max(0.0) as u32;
                steps
            })
            .collect::<Vec<_>>();
        let most = straight.iter().copied().max().unwrap_or(0);
        Error::check(
            "turning radius on cells of this size",
            "straight steps between turns",
            f64::from(most),
            (0.0, f64::from(MAX_STRAIGHT)),
            "1",
        )?;
        Ok(Self {
            map,
            settings,
            steps,
            straight,
            most,
            penalty: Vec::new(),
        })
    }

    pub(super) const fn map(&self) -> &PlanMap {
        self.map
    }

    pub(super) const fn headings(&self) -> usize {
        self.steps.len()
    }

    /// May the robot be here, within a bound on the risk?
    pub(super) fn allows(&self, cell: usize, heading: usize, max_risk: f64) -> bool {
        let pose = cell * self.headings() + heading;
        let map = self.map;
        // NaN, unknown, compares false
        map.energy[pose] >= 0.0
            && self.minimised()[pose] >= 0.0
            && f64::from(map.risk[pose]) <= max_risk
            && f64::from(map.slip_high[pose].abs()) <= self.settings.max_slip
            && f64::from(map.tip_over[pose]) >= self.settings.min_tip_over_deg
    }

    /// The cell at an offset, on the map.
    fn neighbour(&self, cell: usize, (right, up): (i64, i64)) -> Option<usize> {
        let layout = &self.map.layout;
        let columns = i64::from(layout.columns);
        let cell = i64::try_from(cell).ok()?;
        let (row, column) = (cell / columns - up, cell % columns + right);
        let inside = (0..i64::from(layout.rows)).contains(&row) && (0..columns).contains(&column);
        inside.then(|| usize::try_from(row * columns + column).unwrap_or(0))
    }

    /// The cells that a step passes, besides both ends; `None` for one beside the map.
    pub(super) fn passed(
        &self,
        cell: usize,
        heading: usize,
    ) -> impl Iterator<Item = Option<usize>> + '_ {
        let between = self.steps[heading].between.into_iter();
        let passed = between.filter(|offset| *offset != (0, 0));
        passed.map(move |offset| self.neighbour(cell, offset))
    }

    /// Where a step leads, if all that it passes is allowed.
    pub(super) fn ahead(&self, cell: usize, heading: usize, max_risk: f64) -> Option<usize> {
        let step = &self.steps[heading];
        let to = self.neighbour(cell, (step.right, step.up))?;
        let allows =
            |cell: Option<usize>| cell.is_some_and(|cell| self.allows(cell, heading, max_risk));
        (allows(Some(to)) && self.passed(cell, heading).all(allows)).then_some(to)
    }

    /// The cell from which a step leads here.
    pub(super) fn behind(&self, cell: usize, heading: usize) -> Option<usize> {
        let step = &self.steps[heading];
        self.neighbour(cell, (-step.right, -step.up))
    }

    /// The mean of a quantity over a step, by the trapezoidal rule, with the cells between where the way passes them.
    fn mean(
        &self,
        (from, to): (usize, usize),
        heading: usize,
        value: impl Fn(usize) -> f64,
    ) -> f64 {
        let at = |cell: usize| value(cell * self.headings() + heading);
        let ends = at(from) + at(to);
        let step = &self.steps[heading];
        if !step.passes_middle {
            return 0.5 * ends;
        }
        let middle: f64 = step
            .between
            .iter()
            .filter_map(|offset| self.neighbour(from, *offset))
            .map(at)
            .sum();
        0.25 * (ends + middle)
    }

    /// The length of a step along the ground, m.
    pub(super) fn length(&self, ends: (usize, usize), heading: usize) -> f64 {
        let stretch = |pose: usize| 1.0 / f64::from(self.map.pitch[pose]).to_radians().cos();
        self.steps[heading].length * self.mean(ends, heading, stretch)
    }

    /// The energy of a step, J.
    pub(super) fn energy(&self, ends: (usize, usize), heading: usize) -> f64 {
        self.of_step(ends, heading, &self.map.energy)
    }

    /// The CVaR of the energy of a step, J: at most the sum of its cells' CVaRs, and this sum where the soil
    /// draws have the same order in all cells.
    pub(super) fn energy_cvar(&self, ends: (usize, usize), heading: usize) -> f64 {
        self.of_step(ends, heading, &self.map.energy_cvar)
    }

    fn of_step(&self, ends: (usize, usize), heading: usize, per_metre: &[f32]) -> f64 {
        let per_metre = self.mean(ends, heading, |pose| f64::from(per_metre[pose]));
        per_metre * self.length(ends, heading)
    }

    /// What a search minimises, J/m.
    fn minimised(&self) -> &[f32] {
        if self.settings.by_cvar {
            &self.map.energy_cvar
        } else {
            &self.map.energy
        }
    }

    /// What a search minimises: the energy or its CVaR, with penalties.
    pub(super) fn cost(&self, ends: (usize, usize), heading: usize) -> f64 {
        let factor = self.penalty.get(ends.1).copied().unwrap_or(1.0);
        self.of_step(ends, heading, self.minimised()) * f64::from(factor)
    }

    /// The time of a step, s.
    pub(super) fn time(&self, ends: (usize, usize), heading: usize) -> f64 {
        // braking wheels turn slower than the robot moves
        let per_metre = self.mean(ends, heading, |pose| {
            let slip = f64::from(self.map.slip[pose]);
            if slip > 0.0 {
                1.0 / (1.0 - slip)
            } else {
                1.0 + slip
            }
        });
        per_metre * self.length(ends, heading) / self.settings.rim_speed
    }

    /// The least of what is minimised on the map, J/m.
    pub(super) fn least_energy(&self) -> f64 {
        let known = self
            .minimised()
            .iter()
            .copied()
            .filter(|energy| *energy >= 0.0);
        f64::from(known.fold(f32::INFINITY, f32::min))
    }
}
