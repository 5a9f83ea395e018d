//! A slip map whose soil is what is believed of each tile.

use grouser_rover::ground::{Georeference, HeightMap};
use grouser_rover::robot::RobotModel;

use crate::error::{Error, Result};
use crate::headings::Headings;
use crate::learn::{LearnSettings, SoilTiles, StrengthFamily};
use crate::map::{MapLayout, TipOverTable};
use crate::plan::{PlanMap, PlanSettings, check_place};
use crate::pose::{SurfacePose, WheelPlane};
use crate::table::{Envelope, Lookup};

/// Greatest number of cells times headings times levels: two numbers of each are held.
const MAX_NUMBERS: f64 = 67_108_864.0;
/// A pose that is impassable with more than this probability is not driven.
const MAX_BLOCKED: f64 = 0.9;
/// A robot that is turned back drives this much further, m: back out of a patch and round it.
const DETOUR_LENGTH_M: f64 = 12.0;
/// One turning back for this much way through ground that may turn it back, m: the size of patches.
const TURN_BACK_LENGTH_M: f64 = 12.0;

/// How a mission is planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionSettings {
    /// Directions of the map.
    pub headings: Headings,
    /// Size of its cells, m.
    pub cell: f64,
    /// Poses that are planned through.
    pub envelope: Envelope,
    /// Bounds of each cell; the risk is that of a place which the robot cannot leave again.
    pub plan: PlanSettings,
    /// How soil is learnt.
    pub learn: LearnSettings,
}

/// What the relief and each strength of soil say of every cell and heading, and the plan's map of what is believed.
#[derive(Clone, Debug)]
pub(super) struct BelievedMap {
    /// The map that is planned on.
    pub(super) plan_map: PlanMap,
    levels: usize,
    /// By pose and level: slip, NaN where no slip is enough, −∞ where it slides.
    slip: Vec<f32>,
    /// By pose and level: energy, J/m.
    energy: Vec<f32>,
    /// The tile of each cell.
    tile_of: Vec<u32>,
    /// The cells of each tile.
    cells_of: Vec<Vec<u32>>,
    /// The poses within the envelope, until the demand of every level is read.
    poses: Vec<Option<SurfacePose>>,
}

impl BelievedMap {
    /// The map of a part of the relief, from `low` to `high` (m), of which only poses are known: what the soil demands
    /// follows by [`BelievedMap::read_levels`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a map that is too large.
    pub(super) fn new(
        relief: &HeightMap,
        (low, high): ((f64, f64), (f64, f64)),
        model: &RobotModel,
        settings: &MissionSettings,
    ) -> Result<Self> {
        let cell = settings.cell;
        Error::check("[plan]", "cell", cell, (0.01, 100.0), "m")?;
        let count = |from: f64, to: f64| ((to - from) / cell + 1e-9).floor() + 1.0;
        let (columns, rows) = (count(low.0, high.0), count(low.1, high.1));
        let (headings, levels) = (settings.headings, StrengthFamily::LEVELS);
        let numbers = columns * rows * (headings.count() * levels) as f64;
        Error::check(
            "[plan]",
            "cells × headings × levels",
            numbers,
            (4.0, MAX_NUMBERS),
            "1",
        )?;
        Error::check("[plan]", "columns", columns, (2.0, 65_535.0), "1")?;
        Error::check("[plan]", "rows", rows, (2.0, 65_535.0), "1")?;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "limited just above"
        )]
        let (columns, rows) = (columns as u32, rows as u32);
        let mut layout = MapLayout::plain(columns, rows, cell, headings);
        let top = low.1 + (f64::from(rows) - 0.5) * cell;
        layout.georeference = Georeference::of_grid(cell, [low.0 - 0.5 * cell, top]);
        layout.turning_radius = crate::map::turning_radius(model);
        layout.gravity = model.gravity();
        let mut out = Self {
            plan_map: PlanMap::unknown(layout),
            levels,
            slip: Vec::new(),
            energy: Vec::new(),
            tile_of: Vec::new(),
            cells_of: Vec::new(),
            poses: Vec::new(),
        };
        out.read_relief(relief, model, settings);
        Ok(out)
    }

    /// Poses and margins.
    fn read_relief(&mut self, relief: &HeightMap, model: &RobotModel, settings: &MissionSettings) {
        let plane = WheelPlane::new(model);
        let headings = settings.headings;
        let map = &mut self.plan_map;
        self.poses = vec![None; map.cells() * headings.count()];
        for cell in 0..map.cells() {
            let place = map.place_of(cell);
            for heading in 0..headings.count() {
                let Some(at) = plane.pose(relief, place, headings.angle(heading)) else {
                    continue;
                };
                let pose = cell * headings.count() + heading;
                map.pitch[pose] = to_f32(at.pitch.to_degrees());
                if settings.envelope.holds(at.pitch, at.roll) {
                    self.poses[pose] = Some(at);
                }
            }
        }
        let poses = self.poses.iter().flatten().map(|at| (at.pitch, at.roll));
        let tip_over = TipOverTable::of_poses(model, settings.envelope, poses);
        for (margin, at) in map.tip_over.iter_mut().zip(&self.poses) {
            if let Some(at) = at {
                *margin = to_f32(tip_over.margin(at.pitch, at.roll).to_degrees());
            }
        }
    }

    /// Refuses a place at which no soil lets the robot be.
    ///
    /// # Errors
    /// [`Error::Place`].
    pub(super) fn check_place(&self, of: &'static str, at: (f64, f64)) -> Result<()> {
        let cell = self.plan_map.cell_at(of, at)?;
        let map = &self.plan_map;
        check_place(of, map, cell, |pose| map.tip_over[pose] > 0.0)
    }

    /// The demand of every level, and what is believed of it.
    pub(super) fn read_levels(&mut self, family: &StrengthFamily, tiles: &SoilTiles) {
        let poses = std::mem::take(&mut self.poses);
        self.slip = vec![f32::NAN; poses.len() * self.levels];
        self.energy = self.slip.clone();
        for (pose, at) in poses.into_iter().enumerate() {
            let Some(at) = at else { continue };
            for (level, soil) in family.levels().iter().enumerate() {
                let table = &soil.table;
                let number = pose * self.levels + level;
                match table.look_up(at.pitch, table.across(at.roll)) {
                    Lookup::Drives(spot) => {
                        self.slip[number] = to_f32(spot.slip);
                        let driving = table.driving(&spot);
                        self.energy[number] = to_f32(driving.energy_per_metre());
                    }
                    Lookup::Slides => self.slip[number] = f32::NEG_INFINITY,
                    Lookup::Immobilised | Lookup::Marginal => {}
                }
            }
        }
        for index in 0..self.plan_map.cells() {
            let tile = tiles.tile_at(self.plan_map.place_of(index)).unwrap_or(0);
            self.tile_of.push(u32::try_from(tile).unwrap_or(0));
            if self.cells_of.len() <= tile {
                self.cells_of.resize(tile + 1, Vec::new());
            }
            self.cells_of[tile].push(u32::try_from(index).unwrap_or(0));
            self.fill(index, tiles);
        }
    }

    /// Takes up the beliefs of tiles that have changed.
    pub(super) fn update(&mut self, changed: &[usize], tiles: &SoilTiles) {
        for tile in changed {
            let cells = self.cells_of.get(*tile).map(Vec::len).unwrap_or_default();
            for index in 0..cells {
                let cell = self.cells_of[*tile][index] as usize;
                self.fill(cell, tiles);
            }
        }
    }

    /// What is believed of a cell becomes what is planned with.
    ///
    /// Energy: the mean over the levels that drive, and the price of being turned back. Risk: the probability that the robot
    /// cannot leave the place backwards either, or slides.
    pub(super) fn fill(&mut self, cell: usize, tiles: &SoilTiles) {
        let belief = tiles.belief(self.tile_of[cell] as usize);
        let count = self.plan_map.layout.headings.count();
        for heading in 0..count {
            let pose = cell * count + heading;
            if !(self.plan_map.tip_over[pose] > 0.0) {
                continue;
            }
            let back = cell * count + (heading + count / 2) % count;
            let [ahead, behind] =
                [pose, back].map(|pose| &self.slip[pose * self.levels..][..self.levels]);
            let energies = &self.energy[pose * self.levels..][..self.levels];
            let (mut drives, mut energy, mut slip, mut lost) = (0.0_f32, 0.0, 0.0, 0.0);
            for (((w, s), b), e) in belief.iter().zip(ahead).zip(behind).zip(energies) {
                if s.is_finite() {
                    drives += w;
                    energy += w * e;
                    slip += w * s;
                }
                if b.is_nan() || *s == f32::NEG_INFINITY {
                    lost += w;
                }
            }
            let blocked = 1.0 - drives;
            let map = &mut self.plan_map;
            if f64::from(blocked) > MAX_BLOCKED {
                map.energy[pose] = f32::NAN;
                continue;
            }
            let mean = energy / drives;
            // turned back as often as it takes
            let turns = to_f32(DETOUR_LENGTH_M / TURN_BACK_LENGTH_M) * blocked / drives;
            map.energy[pose] = (1.0 + turns) * mean;
            map.slip[pose] = slip / drives;
            map.risk[pose] = lost;
            // that a slip may be too high is in the price
            map.slip_high[pose] = map.slip[pose];
        }
    }

    /// A robot may leave a cell that it stands on, whatever is believed of it.
    pub(super) fn open(&mut self, cell: usize) {
        let count = self.plan_map.layout.headings.count();
        let map = &mut self.plan_map;
        for pose in cell * count..(cell + 1) * count {
            if map.tip_over[pose] > 0.0 {
                map.energy[pose] = if map.energy[pose] >= 0.0 {
                    map.energy[pose]
                } else {
                    0.0
                };
                map.risk[pose] = 0.0;
                map.slip[pose] = 0.0;
                map.slip_high[pose] = 0.0;
            }
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
fn to_f32(value: f64) -> f32 {
    value as f32
}
