//! The answer to a plan: a way, what it costs, where it is decided, and other ways.

use super::lattice::{Lattice, PlanSettings};
use super::plan_map::PlanMap;
use super::search::{Task, search};
use crate::error::{Error, Result};

/// Cells beside an earlier way that an alternative avoids, as a share of the distance from start to goal.
const CORRIDOR_SHARE: f64 = 0.05;
const MIN_CORRIDOR_CELLS: usize = 2;
/// Factor of the energy in an earlier way's corridor.
const CORRIDOR_PENALTY: f32 = 1.5;
/// An alternative shares at most this part of its cells with every earlier way.
const MAX_SHARED: f64 = 0.7;

/// A place on a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Cell of the map.
    pub cell: usize,
    /// Index of the heading.
    pub heading: usize,
    /// m, in the map's coordinates.
    pub x: f64,
    /// m.
    pub y: f64,
    /// Since the start, J.
    pub energy: f64,
    /// Since the start, s.
    pub time: f64,
    /// Along the ground since the start, m.
    pub length: f64,
    /// Slip here.
    pub slip: f64,
    /// Probability to be immobilised here or in a cell that the step to it passes, at most.
    pub risk: f64,
}

/// A way.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Route {
    /// From the start to the goal; a turn repeats its cell.
    pub waypoints: Vec<Waypoint>,
    /// J.
    pub energy: f64,
    /// The CVaR of the energy over the soil draws at the map's level, at most, J: the sum of its cells'. It
    /// is the CVaR itself where the draws have the same order in all cells.
    pub energy_cvar: f64,
    /// s.
    pub time: f64,
    /// Along the ground, m.
    pub length: f64,
    /// Probability to be immobilised anywhere on the way, at most: the greatest of its cells' on each soil, because the draws
    /// of one soil are ordered alike everywhere, summed over the soils.
    pub risk: f64,
    /// The least tip-over margin, deg.
    pub tip_over_deg: f64,
    /// Turns by one heading.
    pub turns: usize,
    /// Share of its waypoints at which a wheel sinks by more than a sixth of its diameter, where the laws lose their grip.
    pub deep_share: f64,
}

/// What planning found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Plan {
    /// The way of least energy, and others by energy.
    Found {
        /// The cheapest.
        route: Route,
        /// Others, which share at most 70 % of their cells with each one before.
        alternatives: Vec<Route>,
    },
    /// No way keeps the bound.
    NoWay {
        /// The smallest bound that some way keeps; `None` where no way exists at any risk.
        least_risk: Option<f64>,
    },
}

impl Route {
    /// The waypoints that decide: of greatest risk, of greatest slip, of greatest energy per metre, and of least tip-over
    /// margin.
    #[must_use]
    pub fn deciding(&self, map: &PlanMap) -> [(&'static str, Waypoint); 4] {
        let pose = |point: &Waypoint| point.cell * map.layout.headings.count() + point.heading;
        let by = |value: &dyn Fn(&Waypoint) -> f64| {
            let mut best = self.waypoints[0];
            for point in &self.waypoints {
                if value(point) > value(&best) {
                    best = *point;
                }
            }
            best
        };
        [
            ("maximum risk", by(&|point| point.risk)),
            ("maximum slip", by(&|point| point.slip.abs())),
            (
                "maximum energy per metre",
                by(&|point| f64::from(map.energy[pose(point)])),
            ),
            (
                "minimum tip-over margin",
                by(&|point| -f64::from(map.tip_over[pose(point)])),
            ),
        ]
    }
}

/// The way of least energy from one cell to another, and up to `alternatives` others.
///
/// ```
/// use grouser_terrain::plan::{Plan, PlanMap, PlanSettings, plan};
/// # use grouser_terrain::{Headings, MapLayout};
/// # let layout = MapLayout::plain(5, 3, 2.0, Headings::new(8)?);
/// // five by three cells of 2 m, all level
/// let mut map = PlanMap::unknown(layout);
/// map.energy.fill(10.0); // J/m
/// map.slip.fill(0.1);
/// map.slip_high.fill(0.2);
/// map.risk.fill(0.0);
/// map.tip_over.fill(40.0);
/// map.pitch.fill(0.0);
/// let Plan::Found { route, .. } = plan(&map, (5, 9), &PlanSettings::default(), 0)? else { panic!("a way exists") };
/// assert!((route.energy - 4.0 * 2.0 * 10.0).abs() < 1e-9); // four steps to the right
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
///
/// # Errors
/// [`Error::Place`] for a start or goal at which the robot cannot be within the bound, [`Error::OutOfRange`].
pub fn plan(
    map: &PlanMap,
    (from, to): (usize, usize),
    settings: &PlanSettings,
    alternatives: usize,
) -> Result<Plan> {
    let mut lattice = checked(map, (from, to), settings)?;
    let task = Task {
        from,
        to,
        max_risk: settings.max_risk,
    };
    let Some(route) = bounded(&lattice, settings, &task)? else {
        return Ok(Plan::NoWay {
            least_risk: least_risk(&lattice, settings, task)?,
        });
    };
    let mut others: Vec<Route> = Vec::new();
    lattice.penalty = vec![1.0; map.cells()];
    for _ in 0..alternatives {
        let before = others.last().unwrap_or(&route);
        penalise(map, before, (from, to), &mut lattice.penalty);
        let Some(other) = bounded(&lattice, settings, &task)? else {
            break;
        };
        let is_new = std::iter::once(&route)
            .chain(&others)
            .all(|earlier| shared(&other, earlier) <= MAX_SHARED);
        if is_new {
            others.push(other);
        }
    }
    others.sort_by(|a, b| {
        let of = |route: &Route| {
            if settings.by_cvar {
                route.energy_cvar
            } else {
                route.energy
            }
        };
        of(a).total_cmp(&of(b))
    });
    Ok(Plan::Found {
        route,
        alternatives: others,
    })
}

/// The way of least energy within the bounds, without alternatives and without the search for a bound that some way keeps:
/// for planning anew while the robot drives.
///
/// # Errors
/// As [`plan`].
pub fn route_within(
    map: &PlanMap,
    (from, to): (usize, usize),
    settings: &PlanSettings,
) -> Result<Option<Route>> {
    let lattice = checked(map, (from, to), settings)?;
    let task = Task {
        from,
        to,
        max_risk: settings.max_risk,
    };
    bounded(&lattice, settings, &task)
}

/// The lattice of a plan whose settings and ends are usable.
fn checked<'a>(
    map: &'a PlanMap,
    (from, to): (usize, usize),
    settings: &'a PlanSettings,
) -> Result<Lattice<'a>> {
    settings.check(map)?;
    let last = (map.cells() - 1) as f64;
    for cell in [from, to] {
        Error::check("plan", "cell", cell as f64, (0.0, last), "1")?;
    }
    let lattice = Lattice::new(map, settings)?;
    let drives = |pose: usize| map.energy[pose] >= 0.0;
    check_place("the start", map, from, drives)?;
    check_place("the goal", map, to, drives)?;
    Ok(lattice)
}

/// The cheapest way whose risk, summed over its soils, keeps the bound. Where the way of the whole bound for each soil does
/// not, every soil gets an equal share of it: such a way keeps the bound, but a cheaper one may exist.
fn bounded(lattice: &Lattice<'_>, settings: &PlanSettings, task: &Task) -> Result<Option<Route>> {
    let Some(way) = search(lattice, settings, task)? else {
        return Ok(None);
    };
    let route = measured(lattice, settings, &way);
    if route.risk <= task.max_risk {
        return Ok(Some(route));
    }
    let map = lattice.map();
    let risky = map
        .soil
        .iter()
        .zip(&map.risk)
        .filter(|(_, risk)| **risk > 0.0 && f64::from(**risk) <= task.max_risk);
    let soils: std::collections::BTreeSet<u8> = risky.map(|(soil, _)| *soil).collect();
    let shared = Task {
        max_risk: task.max_risk / soils.len().max(1) as f64,
        ..*task
    };
    let way = search(lattice, settings, &shared)?;
    Ok(way.map(|way| measured(lattice, settings, &way)))
}

/// A start or a goal must be known ground on which some heading `drives` at all.
pub(crate) fn check_place(
    of: &'static str,
    map: &PlanMap,
    cell: usize,
    drives: impl Fn(usize) -> bool,
) -> Result<()> {
    let count = map.layout.headings.count();
    let (x, y) = map.place_of(cell);
    let refuse = |why: &str| {
        Err(Error::Place {
            of,
            x,
            y,
            why: why.to_owned(),
        })
    };
    if (0..count).all(|heading| map.pitch[cell * count + heading].is_nan()) {
        return refuse("lies on ground whose height is not known");
    }
    if !(0..count).any(|heading| drives(cell * count + heading)) {
        return refuse("lies where no heading can be driven");
    }
    Ok(())
}

/// A bound on the risk that some way keeps: the smallest one where the ground is one soil.
fn least_risk(
    lattice: &Lattice<'_>,
    settings: &PlanSettings,
    mut task: Task,
) -> Result<Option<f64>> {
    // unknown ground, NaN, compares false
    let risks = lattice.map().risk.iter().copied();
    let mut levels: Vec<f32> = risks.filter(|risk| *risk >= 0.0).collect();
    levels.sort_by(f32::total_cmp);
    levels.dedup();
    let mut way = |level: f32| {
        task.max_risk = f64::from(level);
        search(lattice, settings, &task)
    };
    match levels.last() {
        Some(greatest) if way(*greatest)?.is_some() => {}
        _ => return Ok(None),
    }
    let (mut low, mut high) = (0, levels.len() - 1);
    while low < high {
        let middle = usize::midpoint(low, high);
        if way(levels[middle])?.is_some() {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Ok(way(levels[high])?.map(|way| measured(lattice, settings, &way).risk))
}

/// The costs of a way.
fn measured(lattice: &Lattice<'_>, settings: &PlanSettings, way: &[(usize, usize)]) -> Route {
    let map = lattice.map();
    let mut route = Route {
        waypoints: Vec::with_capacity(way.len()),
        energy: 0.0,
        energy_cvar: 0.0,
        time: 0.0,
        length: 0.0,
        risk: 0.0,
        tip_over_deg: f64::INFINITY,
        turns: 0,
        deep_share: 0.0,
    };
    let mut deep = 0_usize;
    let mut before: Option<usize> = None;
    let mut risks = std::collections::BTreeMap::<u8, f64>::new();
    for (cell, heading) in way.iter().copied() {
        match before {
            Some(last) if last == cell => {
                route.turns += 1;
                route.energy += settings.turn_energy;
                route.energy_cvar += settings.turn_energy;
            }
            Some(last) => {
                route.energy += lattice.energy((last, cell), heading);
                route.energy_cvar += lattice.energy_cvar((last, cell), heading);
                route.time += lattice.time((last, cell), heading);
                route.length += lattice.length((last, cell), heading);
            }
            None => {}
        }
        let passed = before.filter(|last| *last != cell);
        let passed = passed
            .into_iter()
            .flat_map(|last| lattice.passed(last, heading));
        let mut risk = 0.0_f64;
        for cell in passed.flatten().chain([cell]) {
            let pose = cell * lattice.headings() + heading;
            let own = f64::from(map.risk[pose]);
            let greatest = risks.entry(map.soil[pose]).or_default();
            *greatest = greatest.max(own);
            risk = risk.max(own);
            route.tip_over_deg = route.tip_over_deg.min(f64::from(map.tip_over[pose]));
        }
        before = Some(cell);
        let pose = cell * lattice.headings() + heading;
        deep += usize::from(map.deep[pose]);
        let (x, y) = map.place_of(cell);
        route.waypoints.push(Waypoint {
            cell,
            heading,
            x,
            y,
            energy: route.energy,
            time: route.time,
            length: route.length,
            slip: f64::from(map.slip[pose]),
            risk,
        });
    }
    route.risk = risks.values().sum::<f64>().min(1.0);
    route.deep_share = deep as f64 / way.len().max(1) as f64;
    route
}

/// Makes the corridor of a way dearer, but for the surroundings of start and goal.
fn penalise(map: &PlanMap, route: &Route, (from, to): (usize, usize), penalty: &mut [f32]) {
    let (columns, rows) = (map.layout.columns as usize, map.layout.rows as usize);
    let off = |a: usize, b: usize| {
        let down = (a / columns).abs_diff(b / columns) as f64;
        down.hypot((a % columns).abs_diff(b % columns) as f64)
    };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of the map's size"
    )]
    let reach = ((CORRIDOR_SHARE * off(from, to)) as usize).max(MIN_CORRIDOR_CELLS);
    let mut marked = vec![false; penalty.len()];
    for point in &route.waypoints {
        let (row, column) = (point.cell / columns, point.cell % columns);
        for row in row.saturating_sub(reach)..(row + reach + 1).min(rows) {
            for column in column.saturating_sub(reach)..(column + reach + 1).min(columns) {
                let cell = row * columns + column;
                let is_end = off(cell, from).min(off(cell, to)) <= 2.0 * reach as f64;
                if !marked[cell] && !is_end {
                    marked[cell] = true;
                    penalty[cell] *= CORRIDOR_PENALTY;
                }
            }
        }
    }
}

/// The part of a way's cells that lie on another one.
fn shared(route: &Route, other: &Route) -> f64 {
    let cells: std::collections::BTreeSet<usize> =
        other.waypoints.iter().map(|point| point.cell).collect();
    let common = route
        .waypoints
        .iter()
        .filter(|point| cells.contains(&point.cell))
        .count();
    common as f64 / route.waypoints.len().max(1) as f64
}
