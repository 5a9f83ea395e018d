//! The robot's side of a mission: what it believes of the ground, and the way that follows from it.

use std::time::{Duration, Instant};

use grouser_rover::ground::HeightMap;
use grouser_rover::robot::RobotModel;
use grouser_terra::Soil;

use super::believed_map::{BelievedMap, MissionSettings};
use crate::error::{Error, Result};
use crate::learn::{SoilObservation, SoilTiles, StrengthFamily};
use crate::plan::{PlanMap, PlanSettings, Route, route_within};

/// Where no way keeps the bound on the risk, these are tried one after the other; then the robot stops. The
/// risks are those of a belief that nothing has confirmed yet: of the two in 50 missions
/// (`policies_on_the_relief_of_mars`) in which no way kept 0.6, one arrives by a way that keeps 0.9.
const FURTHER_RISKS: [f64; 3] = [0.3, 0.6, 0.9];

/// How planning went.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Replanning {
    /// Ways planned after the first.
    pub count: usize,
    /// How long each of them took, by the wall clock.
    pub times: Vec<Duration>,
    /// How long the first plan took.
    pub first: Duration,
    /// The greatest risk of the ways that were set out on.
    pub risk: f64,
    /// The greatest bound that was needed to find a way.
    pub bound: f64,
}

/// Believes, plans, learns and replans.
#[derive(Clone, Debug)]
pub struct Navigator {
    family: StrengthFamily,
    tiles: SoilTiles,
    map: BelievedMap,
    settings: PlanSettings,
    goal: usize,
    route: Option<Route>,
    planning: Replanning,
}

/// Two opposite corners, m.
type Area = ((f64, f64), (f64, f64));

impl Navigator {
    /// A navigator that takes the ground for `soil`, known up to the prior of its strength, on the part of the relief from
    /// the first to the second corner of `area` (m), for a way between `ends` (m): places at which no soil lets the robot be
    /// are refused before anything is computed of the soil.
    ///
    /// # Errors
    /// As [`StrengthFamily::new`] and [`SoilTiles::new`]; [`Error::OutOfRange`] for a map that is too large,
    /// [`Error::Place`] for a start or goal off the map or on ground that is unknown or too steep.
    pub fn new(
        relief: &HeightMap,
        (area, ends): (Area, [(f64, f64); 2]),
        model: &RobotModel,
        soil: &Soil,
        settings: &MissionSettings,
    ) -> Result<Self> {
        let map = BelievedMap::new(relief, area, model, settings)?;
        map.check_place("the start", ends[0])?;
        map.check_place("the goal", ends[1])?;
        let family = StrengthFamily::new(model, soil, settings.envelope)?;
        Self::on_map(map, area, family, settings)
    }

    /// The same with a family that is at hand.
    ///
    /// # Errors
    /// As [`Navigator::new`].
    pub fn with_family(
        relief: &HeightMap,
        area: Area,
        model: &RobotModel,
        family: StrengthFamily,
        settings: &MissionSettings,
    ) -> Result<Self> {
        let map = BelievedMap::new(relief, area, model, settings)?;
        Self::on_map(map, area, family, settings)
    }

    fn on_map(
        mut map: BelievedMap,
        (low, high): ((f64, f64), (f64, f64)),
        family: StrengthFamily,
        settings: &MissionSettings,
    ) -> Result<Self> {
        let half = 0.5 * settings.cell;
        let span = ((low.0 - half, low.1 - half), (high.0 + half, high.1 + half));
        let tiles = SoilTiles::new(&family, settings.learn, span)?;
        map.read_levels(&family, &tiles);
        Ok(Self {
            family,
            tiles,
            map,
            settings: settings.plan,
            goal: 0,
            route: None,
            planning: Replanning::default(),
        })
    }

    /// What is believed, as the map that is planned on.
    #[must_use]
    pub const fn plan_map(&self) -> &PlanMap {
        &self.map.plan_map
    }

    /// Has a reading changed what is planned with?
    #[must_use]
    pub const fn has_changed(&self) -> bool {
        self.tiles.has_changed()
    }

    /// What was learnt.
    #[must_use]
    pub const fn tiles(&self) -> &SoilTiles {
        &self.tiles
    }

    /// How planning went.
    #[must_use]
    pub const fn planning(&self) -> &Replanning {
        &self.planning
    }

    /// The way that the robot is on.
    #[must_use]
    pub const fn route(&self) -> Option<&Route> {
        self.route.as_ref()
    }

    /// Plans the first way, from a place with a heading (rad) to a goal; false where there is none.
    ///
    /// # Errors
    /// [`Error::Place`] off the map or on ground that nothing drives on.
    pub fn set_out(&mut self, from: (f64, f64), heading: f64, goal: (f64, f64)) -> Result<bool> {
        self.goal = self.map.plan_map.cell_at("the goal", goal)?;
        let begin = Instant::now();
        let found = self.find(from, heading)?;
        self.planning.first = begin.elapsed();
        Ok(found)
    }

    /// Learns from a reading; `weight` as in [`SoilTiles::observe`].
    ///
    /// # Errors
    /// As [`SoilTiles::observe`].
    pub fn observe(&mut self, reading: &SoilObservation, weight: f64) -> Result<()> {
        self.tiles.observe(&self.family, reading, weight)
    }

    /// Plans anew from where the robot stands, if what it believes has changed or `always`; false where no way is left.
    ///
    /// # Errors
    /// As [`Navigator::set_out`].
    pub fn replan(&mut self, from: (f64, f64), heading: f64, always: bool) -> Result<bool> {
        let begin = Instant::now();
        let changed = self.tiles.take_changed();
        if changed.is_empty() && !always {
            return Ok(self.route.is_some());
        }
        self.map.update(&changed, &self.tiles);
        let found = self.find(from, heading)?;
        self.planning.times.push(begin.elapsed());
        self.planning.count += 1;
        Ok(found)
    }

    fn find(&mut self, from: (f64, f64), heading: f64) -> Result<bool> {
        let start = self.map.plan_map.cell_at("the start", from)?;
        self.map.open(start);
        let headings = self.map.plan_map.layout.headings;
        let mut settings = PlanSettings {
            start_heading: Some(headings.nearest(heading)),
            ..self.settings
        };
        let first = settings.max_risk;
        let further = FURTHER_RISKS.into_iter().filter(|risk| *risk > first);
        self.route = None;
        for bound in std::iter::once(first).chain(further) {
            settings.max_risk = bound;
            // without the search for the smallest bound that some way keeps
            match route_within(&self.map.plan_map, (start, self.goal), &settings) {
                Ok(None) => {}
                Ok(Some(route)) => {
                    self.planning.risk = self.planning.risk.max(route.risk);
                    self.planning.bound = self.planning.bound.max(bound);
                    self.route = Some(route);
                    break;
                }
                Err(Error::Place { of: "the goal", .. }) if self.planning.count > 0 => break,
                Err(error) => {
                    self.map.fill(start, &self.tiles);
                    return Err(error);
                }
            }
        }
        self.map.fill(start, &self.tiles);
        Ok(self.route.is_some())
    }
}
